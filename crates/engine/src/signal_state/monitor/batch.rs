//! Rows in time order as they are handed over: one by one, or in columns.

use std::ops::Range;

use crate::log::Nanoseconds;
use crate::signal_state::events::Row;

use super::marks::{Keys, Mark};

/// Rows in time order, however they lie.
pub(super) trait Batch: Copy {
    /// How many.
    fn len(self) -> usize;

    /// The time of one.
    fn time(self, at: usize) -> Option<Nanoseconds>;

    /// One of them.
    fn row(self, at: usize) -> Option<Row>;

    /// The times of several.
    fn times(self, range: Range<usize>) -> impl Iterator<Item = Nanoseconds>;

    /// What stands for the signals of several, and their values.
    fn changes(self, range: Range<usize>) -> impl Iterator<Item = (u32, i64)>;

    /// The marks of what stands for signals, as it goes off and as it goes on; `own` are those of the plant's signals.
    fn marks<'a>(&'a self, own: &'a [[Mark; 2]]) -> &'a [[Mark; 2]];

    /// Several of them.
    fn rows(self, range: Range<usize>) -> impl Iterator<Item = Row> {
        range.map_while(move |at| self.row(at))
    }
}

impl Batch for &[Row] {
    fn len(self) -> usize {
        <[Row]>::len(self)
    }

    #[inline(always)]
    fn time(self, at: usize) -> Option<Nanoseconds> {
        self.get(at).map(|row| row.time)
    }

    #[inline(always)]
    fn row(self, at: usize) -> Option<Row> {
        self.get(at).copied()
    }

    #[inline(always)]
    fn times(self, range: Range<usize>) -> impl Iterator<Item = Nanoseconds> {
        self[range].iter().map(|row| row.time)
    }

    #[inline(always)]
    fn changes(self, range: Range<usize>) -> impl Iterator<Item = (u32, i64)> {
        self[range].iter().map(|row| (row.signal, row.value))
    }

    #[inline(always)]
    fn marks<'a>(&'a self, own: &'a [[Mark; 2]]) -> &'a [[Mark; 2]] {
        own
    }
}

/// Rows in columns of one length.
#[derive(Debug, Clone, Copy)]
pub struct Columns<'a> {
    time: &'a [Nanoseconds],
    key: &'a [u32],
    value: &'a [i64],
    keys: &'a Keys,
}

impl<'a> Columns<'a> {
    /// Times in order, keys and values.
    ///
    /// # Panics
    /// Where they are not of one length; later, where a key is beyond `keys`.
    pub fn new(time: &'a [Nanoseconds], key: &'a [u32], value: &'a [i64], keys: &'a Keys) -> Self {
        assert!(time.len() == key.len() && time.len() == value.len(), "columns of one length");
        Self { time, key, value, keys }
    }

    /// The same, row by row.
    pub fn to_rows(self) -> Vec<Row> {
        self.rows(0..self.time.len()).collect()
    }
}

impl Batch for Columns<'_> {
    fn len(self) -> usize {
        self.time.len()
    }

    #[inline(always)]
    fn time(self, at: usize) -> Option<Nanoseconds> {
        self.time.get(at).copied()
    }

    #[inline(always)]
    fn row(self, at: usize) -> Option<Row> {
        let (&time, &key, &value) = (self.time.get(at)?, self.key.get(at)?, self.value.get(at)?);
        Some(Row { time, signal: self.keys.number(key), value })
    }

    #[inline(always)]
    fn times(self, range: Range<usize>) -> impl Iterator<Item = Nanoseconds> {
        self.time[range].iter().copied()
    }

    #[inline(always)]
    fn changes(self, range: Range<usize>) -> impl Iterator<Item = (u32, i64)> {
        self.key[range.clone()].iter().copied().zip(self.value[range].iter().copied())
    }

    #[inline(always)]
    fn marks<'a>(&'a self, _own: &'a [[Mark; 2]]) -> &'a [[Mark; 2]] {
        self.keys.marks()
    }
}
