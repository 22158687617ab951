//! From rows of a change log to events: samples and the first image of the plant are no events.
//!
//! A row that repeats its signal's value is a sample. When the rows at the very first time of a
//! log hold any value 0, they are an image of the plant, since nothing can *change* to 0 before
//! it was anything else: they set values, and what follows has no predecessor. A first time with
//! values other than 0 only is what PLAT's logger writes (the signals that are ON), and those
//! rows are events: the paper's first cycle begins `RET_ON → PRT_CHK_ON`.

use std::collections::BTreeMap;

use crate::log::SignalIndex;

/// One row on its way to being an event.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Row {
    /// Nanoseconds since the Unix epoch.
    pub time: i64,
    /// Signal.
    pub signal: SignalIndex,
    /// Its value from now on.
    pub value: i64,
}

/// What a row means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Meaning {
    /// The signal changed.
    Event,
    /// The signal still has the value it had.
    Sample,
    /// After a gap: the signal has the value it had before, and may have changed in between or
    /// even just now, from a value nobody saw.
    Doubtful,
}

/// The last value of every signal: a byte for the values nearly all of them have.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Values {
    /// 0, 1, [`UNKNOWN`] or [`WORD`], and [`DOUBTED`].
    last: Vec<u8>,
    /// Values other than 0 and 1.
    words: BTreeMap<SignalIndex, i64>,
}

const UNKNOWN: u8 = 2;
const WORD: u8 = 3;
/// Not seen again since a gap.
const DOUBTED: u8 = 4;

impl Values {
    /// No value known yet.
    pub fn new(signals: usize) -> Self {
        Self { last: vec![UNKNOWN; signals], words: BTreeMap::new() }
    }

    /// Takes a row in and says what it means.
    #[inline]
    pub fn take(&mut self, signal: SignalIndex, value: i64) -> Meaning {
        let byte = if value & !1 == 0 { value as u8 } else { WORD };
        let last = std::mem::replace(&mut self.last[signal as usize], byte);
        let same =
            last & !DOUBTED == byte && (byte != WORD || self.words.get(&signal) == Some(&value));
        if byte == WORD && !same {
            self.words.insert(signal, value);
        }
        match (same, last & DOUBTED != 0) {
            (false, _) => Meaning::Event,
            (true, true) => Meaning::Doubtful,
            (true, false) => Meaning::Sample,
        }
    }

    /// True where a signal's value changes by coming to one of its two states as a boolean.
    #[inline(always)]
    pub fn changes(&self, state: u32) -> bool {
        // Also from a value nobody knew, or from a word.
        self.last
            .get(state as usize / 2)
            .is_some_and(|last| u32::from(last & !DOUBTED) != state % 2)
    }

    /// Takes such a change in.
    #[inline(always)]
    pub fn take_change(&mut self, state: u32) {
        if let Some(last) = self.last.get_mut(state as usize / 2) {
            *last = state as u8 & 1;
        }
    }

    /// A gap: every signal may have changed unseen.
    pub fn doubt(&mut self) {
        self.last.iter_mut().for_each(|last| *last |= DOUBTED);
    }
}

/// True where the rows of a log's first time are an image of the plant.
pub fn is_image(first_rows: impl IntoIterator<Item = i64>) -> bool {
    first_rows.into_iter().any(|value| value == 0)
}
