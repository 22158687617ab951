//! Sisters: transitions and states that are called alike but for numbers.
//!
//! `Group1-WeldGun039-Overheat_ON → Overheat_OFF` and the same of every other weld gun are of one
//! make, so that what one does now and then the others may do as well. A plant whose names carry
//! no numbers has no sisters, and every transition stands for itself.

use crate::log::SignalIndex;
use crate::plant::Plant;

use super::chains::{ChainKind, Chains};
use super::rules::Rule;
use super::states::{StateId, States};

/// What sisters have in common.
pub type Family = u64;

/// Where a plant's names are, to tell sisters by.
#[derive(Clone, Copy)]
pub struct Names<'a> {
    /// Its signals and devices.
    pub plant: &'a Plant,
    /// Its signal-states.
    pub states: &'a States,
    /// Which chain is a device's.
    pub chains: &'a Chains,
    /// [`stem`] of every signal, where many are asked for; empty where few are.
    pub stems: &'a [u64],
}

/// What a signal's and its device's names have in common with those of sisters.
pub fn stem(plant: &Plant, signal: SignalIndex) -> u64 {
    let mut hash = xxhash_rust::xxh3::Xxh3::new();
    for name in [plant.device_of(signal).name.as_str(), plant.signals[signal as usize].name()] {
        for part in name.split(|c: char| c.is_ascii_digit()) {
            hash.update(part.as_bytes());
        }
        hash.update(&[0]);
    }
    hash.digest()
}

/// The numbers in a signal's and its device's names, which tell sisters apart.
pub fn numbers(plant: &Plant, signal: SignalIndex) -> Vec<i64> {
    let names = [plant.device_of(signal).name.as_str(), plant.signals[signal as usize].name()];
    let parts = names.into_iter().flat_map(|name| name.split(|c: char| !c.is_ascii_digit()));
    // What is too long to be counted is an address or a serial number, and stands for itself.
    let number = |part: &str| part.parse::<u32>().map_or(i64::MAX / 2, i64::from);
    parts.filter(|part| !part.is_empty()).map(number).collect()
}

impl Names<'_> {
    /// The family of a transition.
    pub fn of_rule(&self, rule: &Rule) -> Family {
        let next = self.states.signal_value(rule.next);
        self.of_transition(rule.current, next, self.chains.kind(rule.chain))
    }

    /// The family of a transition to a signal's value, be it one never learned.
    pub fn of_transition(
        &self,
        current: StateId,
        next: (SignalIndex, i64),
        kind: ChainKind,
    ) -> Family {
        let mut hash = xxhash_rust::xxh3::Xxh3::new();
        self.add(&mut hash, current, kind);
        self.add_value(&mut hash, next, kind);
        hash.digest()
    }

    /// The family of a state in the chain of a kind.
    pub fn of_state(&self, state: StateId, kind: ChainKind) -> Family {
        let mut hash = xxhash_rust::xxh3::Xxh3::new();
        self.add(&mut hash, state, kind);
        hash.digest()
    }

    fn add(&self, hash: &mut xxhash_rust::xxh3::Xxh3, state: StateId, kind: ChainKind) {
        // A state first met while watching has no sisters.
        if state as usize >= self.states.len() {
            return;
        }
        self.add_value(hash, self.states.signal_value(state), kind);
    }

    fn add_value(
        &self,
        hash: &mut xxhash_rust::xxh3::Xxh3,
        (signal, value): (SignalIndex, i64),
        kind: ChainKind,
    ) {
        let stem = match self.stems.get(signal as usize) {
            Some(&stem) => stem,
            None => stem(self.plant, signal),
        };
        hash.update(&stem.to_le_bytes());
        hash.update(&value.to_le_bytes());
        hash.update(&[u8::from(kind == ChainKind::Group)]);
    }
}
