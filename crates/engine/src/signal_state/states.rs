//! Signal-states: a signal and its value, numbered densely.
//!
//! The states of signal `s` at 0 and 1 are `2·s` and `2·s + 1`; other values of words get the
//! numbers after those, in the order they are met. Names are looked up once, never while watching.

use std::hash::BuildHasher;

use hashbrown::{DefaultHashBuilder, HashMap, HashTable};

use crate::log::SignalIndex;
use crate::plant::Plant;

/// Dense number of a signal-state.
pub type StateId = u32;

/// No state: nothing has been seen yet, or sight was lost.
pub const NO_STATE: StateId = StateId::MAX;

/// All signal-states of a plant.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct States {
    signals: u32,
    /// Values of words beyond 0 and 1.
    further: Vec<(SignalIndex, i64)>,
    by_value: HashMap<(SignalIndex, i64), StateId>,
}

impl States {
    /// The states of `signals` signals, none with a value beyond 0 and 1 so far.
    pub fn new(signals: usize) -> Self {
        Self { signals: signals as u32, ..Self::default() }
    }

    /// Number of states.
    pub fn len(&self) -> usize {
        2 * self.signals as usize + self.further.len()
    }

    /// True where there is no signal.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The state of a signal at a value, if it is known.
    #[inline]
    pub fn find(&self, signal: SignalIndex, value: i64) -> Option<StateId> {
        if value & !1 == 0 {
            Some(2 * signal + value as u32)
        } else {
            self.by_value.get(&(signal, value)).copied()
        }
    }

    /// The state of a signal at a value, numbered now if it is new.
    pub fn intern(&mut self, signal: SignalIndex, value: i64) -> StateId {
        self.find(signal, value).unwrap_or_else(|| {
            let state = self.len() as StateId;
            self.further.push((signal, value));
            self.by_value.insert((signal, value), state);
            state
        })
    }

    /// Values of words beyond 0 and 1, in the order they were numbered.
    pub fn further(&self) -> &[(SignalIndex, i64)] {
        &self.further
    }

    /// Signal and value of a state.
    pub fn signal_value(&self, state: StateId) -> (SignalIndex, i64) {
        if state < 2 * self.signals {
            (state / 2, i64::from(state % 2))
        } else {
            self.further[(state - 2 * self.signals) as usize]
        }
    }
}

/// The value as a state name ends: `_ON`, `_OFF`, or `=12` for words.
pub fn value_suffix(word: bool, value: i64) -> String {
    match value {
        1 if !word => "_ON".to_owned(),
        0 if !word => "_OFF".to_owned(),
        _ => format!("={value}"),
    }
}

fn push_value_suffix(name: &mut String, word: bool, value: i64) {
    match value {
        1 if !word => name.push_str("_ON"),
        0 if !word => name.push_str("_OFF"),
        _ => name.push_str(&value_suffix(word, value)),
    }
}

/// `Group1-Device2-Signal2_ON`.
pub fn full_state_name(plant: &Plant, signal: SignalIndex, value: i64) -> String {
    let parts = plant.name_parts(signal);
    let mut full = String::with_capacity(parts.iter().map(|part| part.len()).sum::<usize>() + 8);
    for part in parts {
        full.push_str(part);
    }
    push_value_suffix(&mut full, plant.signals[signal as usize].word, value);
    full
}

/// `Signal2_ON`, as it reads inside its device.
pub fn short_state_name(plant: &Plant, signal: SignalIndex, value: i64) -> String {
    let signal = &plant.signals[signal as usize];
    let mut short = String::with_capacity(signal.name().len() + 8);
    short.push_str(signal.name());
    push_value_suffix(&mut short, signal.word, value);
    short
}

/// Finds signal and value by a full state name.
pub struct StateNames<'a> {
    plant: &'a Plant,
    signals: HashTable<SignalIndex>,
    hasher: DefaultHashBuilder,
}

impl<'a> StateNames<'a> {
    /// Reads the names of a plant.
    pub fn of(plant: &'a Plant) -> Self {
        let hasher = DefaultHashBuilder::default();
        let mut hashes = Vec::with_capacity(plant.signals.len());
        let mut name = String::new();
        for signal in 0..plant.signals.len() as SignalIndex {
            name.clear();
            for part in plant.name_parts(signal) {
                name.push_str(part);
            }
            hashes.push(hasher.hash_one(name.as_str()));
        }
        let mut signals = HashTable::with_capacity(hashes.len());
        // Of two with one name, the last is found.
        for (signal, &hash) in (0..hashes.len() as SignalIndex).zip(&hashes).rev() {
            signals.insert_unique(hash, signal, |&other: &SignalIndex| hashes[other as usize]);
        }
        Self { plant, signals, hasher }
    }

    fn find(&self, name: &str) -> Option<SignalIndex> {
        let is_it = |&signal: &SignalIndex| {
            let parts = self.plant.name_parts(signal);
            let rest = parts.into_iter().try_fold(name, |rest, part| rest.strip_prefix(part));
            rest == Some("")
        };
        self.signals.find(self.hasher.hash_one(name), is_it).copied()
    }

    /// Signal and value of `Group1-Device2-Signal2_ON` or `…-STEP=12`; `None` for another plant's.
    pub fn parse(&self, name: &str) -> Option<(SignalIndex, i64)> {
        let boolean = name
            .strip_suffix("_ON")
            .map(|signal| (signal, 1))
            .or_else(|| name.strip_suffix("_OFF").map(|signal| (signal, 0)));
        let word = || {
            let (signal, value) = name.rsplit_once('=')?;
            Some((self.find(signal)?, value.parse().ok()?))
        };
        boolean.and_then(|(signal, value)| Some((self.find(signal)?, value))).or_else(word)
    }
}
