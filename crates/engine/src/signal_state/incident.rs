//! Findings that one cause explains share an incident.
//!
//! Inside one group, a finding joins the open incident while that is fresh. It is a *consequence*,
//! told as a notice, where the cause already explains it: the group's chain repeats what a device's
//! chain has said, and whoever waited for a device that was late or lost is late as well.

use serde::{Deserialize, Serialize};

use crate::finding::Kind;
use crate::log::Nanoseconds;

use super::chains::{ChainIndex, ChainKind};
use super::identity::FindingId;

/// The open incident of a group.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Incident {
    /// Id of its first finding.
    pub id: FindingId,
    cause: ChainIndex,
    cause_is_device: bool,
    /// When the trouble began: for a late transition, when it was due at the earliest.
    began: Nanoseconds,
    /// Time of its latest finding.
    pub last: Nanoseconds,
}

/// What is needed to place a finding.
#[derive(Debug, Clone)]
pub struct Occurrence {
    /// The finding's own id.
    pub id: FindingId,
    /// What it is.
    pub kind: Kind,
    /// The chain that found it.
    pub chain: ChainIndex,
    /// Device or group.
    pub chain_kind: ChainKind,
    /// True where another device's delay may be the reason: the device waited, and not for an
    /// event that is known.
    pub inherits: bool,
    /// Since when its device had been waiting.
    pub waiting_since: Nanoseconds,
    /// When it was found.
    pub time: Nanoseconds,
}

/// Where a finding belongs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Placement {
    /// The incident's id.
    pub incident: FindingId,
    /// True where the cause already explains it.
    pub consequence: bool,
}

impl Incident {
    /// Places a finding in the open incident of its group, or opens a new one.
    pub fn place(
        open: &mut Option<Self>,
        occurrence: Occurrence,
        fresh_for: Nanoseconds,
    ) -> Placement {
        let joined = open.as_mut().filter(|incident| {
            // What waits has been waiting since before it is told: a stop belongs to what went wrong
            // shortly before the group's last event.
            let began =
                if is_delay(occurrence.kind) { occurrence.waiting_since } else { occurrence.time };
            began.saturating_sub(incident.last) <= fresh_for
        });
        if let Some(incident) = joined {
            let consequence = incident.explains(&occurrence);
            incident.last = occurrence.time;
            return Placement { incident: incident.id.clone(), consequence };
        }
        *open = Some(Self {
            id: occurrence.id.clone(),
            cause: occurrence.chain,
            cause_is_device: occurrence.chain_kind == ChainKind::Device,
            began: occurrence.waiting_since,
            last: occurrence.time,
        });
        Placement { incident: occurrence.id, consequence: false }
    }

    fn explains(&self, occurrence: &Occurrence) -> bool {
        // A stopped line is never a side note.
        if occurrence.chain == self.cause || occurrence.kind == Kind::Stall {
            return false;
        }
        let echoed = self.cause_is_device && occurrence.chain_kind == ChainKind::Group;
        let inherited = occurrence.inherits
            && occurrence.waiting_since <= self.last
            && occurrence.time >= self.began;
        echoed || inherited
    }
}

fn is_delay(kind: Kind) -> bool {
    matches!(kind, Kind::Late | Kind::Stall | Kind::Early)
}
