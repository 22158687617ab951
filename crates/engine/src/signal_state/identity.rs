//! What a finding is known by. Its id is a hash over names; many findings are never told, and
//! those need not look the names up.

use std::sync::Arc;

use serde::ser::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::finding::{Kind, StableId};
use crate::log::Nanoseconds;

use super::chains::ChainIndex;
use super::states::{NO_STATE, StateId};
use super::teller::Teller;

/// What, where and when: all that the id is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Identity {
    kind: Kind,
    chain: u32,
    from: StateId,
    to: StateId,
    time: Nanoseconds,
}

impl Identity {
    /// A finding at a chain, from one state ([`NO_STATE`]: none) to another.
    pub fn new(kind: Kind, chain: ChainIndex, [from, to]: [StateId; 2], time: Nanoseconds) -> Self {
        Self { kind, chain: chain as u32, from, to, time }
    }

    /// The id as it is told.
    pub fn id(&self, teller: Teller<'_>) -> String {
        let name = |state| if state == NO_STATE { String::new() } else { teller.state_name(state) };
        self.what_and_where(teller, &name(self.from), &name(self.to)).at(self.time)
    }

    /// All that ids are made of but the time, where the names of the states are at hand.
    pub fn what_and_where(&self, teller: Teller<'_>, from: &str, to: &str) -> StableId {
        StableId::of(self.kind, &teller.place_name(self.chain as ChainIndex), from, to)
    }
}

/// The id of a finding, made or yet to be made.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FindingId {
    /// To be made when it is told; both states are of the model.
    Untold(Identity),
    /// Made.
    Told(Arc<str>),
}

impl FindingId {
    /// The id as it is told.
    pub fn text(&self, teller: Teller<'_>) -> Arc<str> {
        match self {
            Self::Untold(identity) => identity.id(teller).into(),
            Self::Told(text) => Arc::clone(text),
        }
    }
}

impl Serialize for FindingId {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Told(text) => serializer.serialize_str(text),
            Self::Untold(_) => Err(S::Error::custom("an id is made before it is saved")),
        }
    }
}

impl<'de> Deserialize<'de> for FindingId {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Ok(Self::Told(String::deserialize(deserializer)?.into()))
    }
}
