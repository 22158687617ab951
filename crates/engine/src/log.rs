//! The change log: all events of a plant in time order, as columns.
//!
//! An *event* is one change of value of one signal. A row that repeats the value its signal
//! already has is a *sample*: it proves that time went on, and is no event. Rows keep the order
//! of their file; times never go backwards.

use std::collections::HashMap;
use std::ops::Range;

use thiserror::Error;

/// Nanoseconds since the Unix epoch, UTC, or a difference of two such times.
pub type Nanoseconds = i64;

/// Nanoseconds in one second.
pub const SECOND: Nanoseconds = 1_000_000_000;

/// Dense number of a signal inside one log.
pub type SignalIndex = u32;

/// A stretch of time in which nothing was recorded: not a fault, and not evidence either.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Gap {
    /// Time of the last row before the gap.
    pub start: Nanoseconds,
    /// Time of the first row after it.
    pub end: Nanoseconds,
}

/// Why columns are not a change log.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum LogError {
    /// The columns differ in length.
    #[error(
        "a change log needs columns of one length: time has {time} rows, signal {signal}, value {value}"
    )]
    Lengths {
        /// Rows of the time column.
        time: usize,
        /// Rows of the signal column.
        signal: usize,
        /// Rows of the value column.
        value: usize,
    },
    /// A row names a signal that is not in the dictionary.
    #[error("row {row} names signal number {signal}, but there are {signals} signals")]
    Signal {
        /// Row, counted from 1.
        row: usize,
        /// The number found.
        signal: SignalIndex,
        /// Size of the dictionary.
        signals: usize,
    },
    /// A row lies before an earlier row by more than the reorder window.
    #[error(
        "row {row} lies {late_s:.3} s before an earlier row, more than the reorder window of {reorder_s:.3} s; sort the log by time or widen the window"
    )]
    Order {
        /// Row, counted from 1.
        row: usize,
        /// How far back it lies, in seconds.
        late_s: f64,
        /// The window, in seconds.
        reorder_s: f64,
    },
}

/// A change log in memory: parallel columns, signals interned to dense numbers.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ChangeLog {
    /// Name or address of each signal, by [`SignalIndex`].
    pub signals: Vec<String>,
    /// Time of each row; never decreasing once the log is [validated](Self::sort_within).
    pub time: Vec<Nanoseconds>,
    /// Signal of each row.
    pub signal: Vec<SignalIndex>,
    /// Value of each row; booleans are 0 and 1.
    pub value: Vec<i64>,
    /// Time between two scans or samples of the source, where the source tells.
    pub scan_interval: Option<Nanoseconds>,
    /// Stretches in which nothing was recorded, in time order.
    pub gaps: Vec<Gap>,
}

impl ChangeLog {
    /// Number of rows.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// True where there is no row.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// The gaps that go with some of the rows: each goes with the first row after it.
    pub fn gaps_among(&self, rows: Range<usize>) -> impl Iterator<Item = &Gap> {
        let before = rows.start.checked_sub(1).map(|row| self.time[row]);
        let last = (rows.end > rows.start).then(|| self.time[rows.end - 1]);
        self.gaps.iter().filter(move |gap| {
            before.is_none_or(|before| gap.end > before) && last.is_some_and(|last| gap.end <= last)
        })
    }

    /// Checks the columns and sorts rows that lie at most `reorder` before an earlier row.
    /// The sort is stable: rows of one time keep the order of the file.
    ///
    /// # Errors
    /// Columns of different length, an unknown signal number, or a row older than the window.
    pub fn sort_within(&mut self, reorder: Nanoseconds) -> Result<(), LogError> {
        if self.time.len() != self.signal.len() || self.time.len() != self.value.len() {
            return Err(LogError::Lengths {
                time: self.time.len(),
                signal: self.signal.len(),
                value: self.value.len(),
            });
        }
        if let Some(row) = self.signal.iter().position(|&s| s as usize >= self.signals.len()) {
            return Err(LogError::Signal {
                row: row + 1,
                signal: self.signal[row],
                signals: self.signals.len(),
            });
        }
        let mut newest = Nanoseconds::MIN;
        let mut sorted = true;
        for (row, &time) in self.time.iter().enumerate() {
            if time < newest {
                sorted = false;
                let late = newest.saturating_sub(time);
                if late > reorder {
                    return Err(LogError::Order {
                        row: row + 1,
                        late_s: late as f64 / SECOND as f64,
                        reorder_s: reorder as f64 / SECOND as f64,
                    });
                }
            }
            newest = newest.max(time);
        }
        if !sorted {
            let mut order: Vec<usize> = (0..self.len()).collect();
            order.sort_by_key(|&row| self.time[row]);
            self.time = order.iter().map(|&row| self.time[row]).collect();
            self.signal = order.iter().map(|&row| self.signal[row]).collect();
            self.value = order.iter().map(|&row| self.value[row]).collect();
        }
        Ok(())
    }
}

/// Builds a change log row by row, interning signal names.
#[derive(Debug, Default)]
pub struct ChangeLogBuilder {
    log: ChangeLog,
    index: HashMap<String, SignalIndex>,
}

impl ChangeLogBuilder {
    /// The dense number of a signal, new or known.
    pub fn intern(&mut self, signal: &str) -> SignalIndex {
        if let Some(&known) = self.index.get(signal) {
            return known;
        }
        let new = self.log.signals.len() as SignalIndex;
        self.log.signals.push(signal.to_owned());
        self.index.insert(signal.to_owned(), new);
        new
    }

    /// Appends one row.
    pub fn push(&mut self, time: Nanoseconds, signal: SignalIndex, value: i64) {
        self.log.time.push(time);
        self.log.signal.push(signal);
        self.log.value.push(value);
    }

    /// The log so far.
    pub fn finish(self) -> ChangeLog {
        self.log
    }
}
