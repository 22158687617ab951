//! Signal-states: a signal and its value, numbered densely.
//!
//! The states of signal `s` at 0 and 1 are `2·s` and `2·s + 1`; other values of words get the
//! numbers after those, in the order they are met. Names are looked up once, never while watching.

use hashbrown::HashMap;

use crate::log::SignalIndex;
use crate::plant::{Plant, Signal};

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
    let Signal { name, device, word, .. } = &plant.signals[signal as usize];
    let device = &plant.devices[*device];
    let group = &plant.groups[device.group].name;
    let mut full = String::with_capacity(group.len() + device.name.len() + name.len() + 8);
    for part in [group, "-", &device.name, "-", name] {
        full.push_str(part);
    }
    push_value_suffix(&mut full, *word, value);
    full
}

/// `Signal2_ON`, as it reads inside its device.
pub fn short_state_name(plant: &Plant, signal: SignalIndex, value: i64) -> String {
    let signal = &plant.signals[signal as usize];
    let mut short = String::with_capacity(signal.name.len() + 8);
    short.push_str(&signal.name);
    push_value_suffix(&mut short, signal.word, value);
    short
}

/// Finds signal and value by a full state name.
pub struct StateNames {
    signals: HashMap<String, SignalIndex>,
}

impl StateNames {
    /// Reads the names of a plant.
    pub fn of(plant: &Plant) -> Self {
        let signals =
            (0..plant.signals.len() as SignalIndex).map(|s| (plant.full_name(s), s)).collect();
        Self { signals }
    }

    /// Signal and value of `Group1-Device2-Signal2_ON` or `…-STEP=12`; `None` for another plant's.
    pub fn parse(&self, name: &str) -> Option<(SignalIndex, i64)> {
        let boolean = name
            .strip_suffix("_ON")
            .map(|signal| (signal, 1))
            .or_else(|| name.strip_suffix("_OFF").map(|signal| (signal, 0)));
        let word = || {
            let (signal, value) = name.rsplit_once('=')?;
            Some((*self.signals.get(signal)?, value.parse().ok()?))
        };
        boolean.and_then(|(signal, value)| Some((*self.signals.get(signal)?, value))).or_else(word)
    }
}
