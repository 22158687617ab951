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
    last: Vec<u8>,
    /// Values other than 0 and 1.
    words: BTreeMap<SignalIndex, i64>,
    /// Signals not seen again since a gap; empty where there was none.
    doubted: Vec<bool>,
}

const UNKNOWN: u8 = 2;
const WORD: u8 = 3;

impl Values {
    /// No value known yet.
    pub fn new(signals: usize) -> Self {
        Self { last: vec![UNKNOWN; signals], words: BTreeMap::new(), doubted: Vec::new() }
    }

    /// Takes a row in and says what it means.
    #[inline]
    pub fn take(&mut self, signal: SignalIndex, value: i64) -> Meaning {
        let doubted = match self.doubted.get_mut(signal as usize) {
            Some(doubted) => std::mem::replace(doubted, false),
            None => false,
        };
        let byte = if value & !1 == 0 { value as u8 } else { WORD };
        let last = std::mem::replace(&mut self.last[signal as usize], byte);
        let same = last == byte && (byte != WORD || self.words.get(&signal) == Some(&value));
        if byte == WORD && !same {
            self.words.insert(signal, value);
        }
        match (same, doubted) {
            (false, _) => Meaning::Event,
            (true, true) => Meaning::Doubtful,
            (true, false) => Meaning::Sample,
        }
    }

    /// True where the signal is known to have the opposite boolean value: an event, beyond doubt.
    #[inline(always)]
    pub fn flips(&self, signal: SignalIndex, value: i64) -> bool {
        let doubted = self.doubted.get(signal as usize).is_some_and(|&doubted| doubted);
        let last = self.last.get(signal as usize).copied().unwrap_or(UNKNOWN);
        // Neither an unknown value nor a word is the opposite of 0 or 1.
        i64::from(last ^ 1) == value && value & !1 == 0 && !doubted
    }

    /// Takes a row in that [flips](Self::flips) its signal.
    #[inline(always)]
    pub fn flip(&mut self, signal: SignalIndex) {
        if let Some(last) = self.last.get_mut(signal as usize) {
            *last ^= 1;
        }
    }

    /// A gap: every signal may have changed unseen.
    pub fn doubt(&mut self) {
        self.doubted.clear();
        self.doubted.resize(self.last.len(), true);
    }
}

/// True where the rows of a log's first time are an image of the plant.
pub fn is_image(first_rows: impl IntoIterator<Item = i64>) -> bool {
    first_rows.into_iter().any(|value| value == 0)
}
