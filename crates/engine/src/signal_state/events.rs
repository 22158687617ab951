//! From rows of a change log to events: samples and the first image of the plant are no events.
//!
//! A row that repeats its signal's value is a sample. When the rows at the very first time of a
//! log hold any value 0, they are an image of the plant, since nothing can *change* to 0 before
//! it was anything else: they set values, and what follows has no predecessor. A first time with
//! values other than 0 only is what PLAT's logger writes (the signals that are ON), and those
//! rows are events: the paper's first cycle begins `RET_ON → PRT_CHK_ON`.

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

/// The last value of every signal.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Values {
    last: Vec<Option<i64>>,
}

impl Values {
    /// No value known yet.
    pub fn new(signals: usize) -> Self {
        Self { last: vec![None; signals] }
    }

    /// Takes a row in; true where it is an event.
    #[inline]
    pub fn changed(&mut self, signal: SignalIndex, value: i64) -> bool {
        let last = &mut self.last[signal as usize];
        if *last == Some(value) {
            return false;
        }
        *last = Some(value);
        true
    }

    /// The present value of a signal, where known.
    pub fn get(&self, signal: SignalIndex) -> Option<i64> {
        self.last.get(signal as usize).copied().flatten()
    }
}

/// True where the rows of a log's first time are an image of the plant.
pub fn is_image(first_rows: impl IntoIterator<Item = i64>) -> bool {
    first_rows.into_iter().any(|value| value == 0)
}
