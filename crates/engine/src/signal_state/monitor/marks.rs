//! What can be said of a row before its turn, whatever comes before it. It is found for many rows
//! in one sweep, in which no row waits for another, and says at once which rows are the usual ones.

use std::ops::Range;

use crate::log::{Nanoseconds, SignalIndex};
use crate::signal_state::chains::{ChainIndex, Chains};
use crate::signal_state::lanes::Lanes;
use crate::signal_state::states::StateId;

use super::batch::Batch;

/// The state that a row leads to, the chain of its device, and what is particular about it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mark(u64);

impl Mark {
    /// Where the number of the chain begins; below it is the state.
    const DEVICE: u32 = 32;
    /// The row after it is of the same scan, or not known yet.
    const SHARES: u64 = 1 << 60;
    /// Not a boolean value that somebody learned.
    const ODD: u64 = 1 << 61;
    /// A step of its group's chain, too.
    const STARTS: u64 = 1 << 62;
    /// The most frequent transition into its state waits for another event.
    const WAITS: u64 = 1 << 63;

    /// True for a scan of its own that is a step of its device alone.
    #[inline(always)]
    pub(super) fn is_plain(self) -> bool {
        self.0 & !Self::WAITS < Self::SHARES
    }

    /// True where the most frequent transition into its state waits for another event.
    #[inline(always)]
    pub(super) fn waits(self) -> bool {
        self.0 & Self::WAITS != 0
    }

    /// True where the row after it is of the same scan, or not known yet.
    #[inline(always)]
    pub(super) fn shares(self) -> bool {
        self.0 & Self::SHARES != 0
    }

    /// True where it is no boolean value that somebody learned: its state means nothing.
    #[inline(always)]
    pub(super) fn is_odd(self) -> bool {
        self.0 & Self::ODD != 0
    }

    /// True where it is a step of its group's chain, too.
    #[inline(always)]
    pub(super) fn starts(self) -> bool {
        self.0 & Self::STARTS != 0
    }

    /// The state it leads to.
    #[inline(always)]
    pub(super) fn state(self) -> StateId {
        self.0 as StateId
    }

    /// The chain of its device.
    #[inline(always)]
    pub(super) fn device(self) -> ChainIndex {
        ((self.0 & (Self::SHARES - 1)) >> Self::DEVICE) as ChainIndex
    }
}

/// What keys of rows stand for.
#[derive(Debug, Clone, Default)]
pub struct Keys {
    numbers: Vec<SignalIndex>,
    /// Of each key, as it goes off and as it goes on.
    marks: Vec<Mark>,
}

impl Keys {
    fn new(numbers: Vec<SignalIndex>, by_state: &[Mark]) -> Self {
        let mark = |state: usize| by_state.get(state).copied().unwrap_or(Mark(Mark::ODD));
        let two = |&number: &SignalIndex| [0, 1].map(|value| mark(2 * number as usize + value));
        Self { marks: numbers.iter().flat_map(two).collect(), numbers }
    }

    /// Of monitors that mark nothing.
    pub(crate) fn unmarked(numbers: Vec<SignalIndex>) -> Self {
        Self::new(numbers, &[])
    }

    /// The number of the signal that a key stands for.
    #[inline(always)]
    pub fn number(&self, key: u32) -> SignalIndex {
        self.numbers[key as usize]
    }

    /// Gives a key that stood for no signal that anybody learned another number of that kind.
    pub fn renumber(&mut self, key: u32, number: SignalIndex) {
        self.numbers[key as usize] = number;
    }

    pub(super) fn marks(&self) -> &[Mark] {
        &self.marks
    }
}

/// The marks of a plant's signals, each as it goes off and as it goes on.
#[derive(Debug, Clone)]
pub(super) struct Marks {
    by_state: Vec<Mark>,
}

impl Marks {
    pub(super) fn of(chains: &Chains, lanes: &Lanes, signals: usize) -> Self {
        let mark = |state: StateId| {
            let device = (chains.device_chain(state / 2) as u64) << Mark::DEVICE;
            let starts = if lanes.starts(state) { Mark::STARTS } else { 0 };
            let waits = if lanes.waits(state as usize) { Mark::WAITS } else { 0 };
            Mark(u64::from(state) | device | starts | waits)
        };
        Self { by_state: (0..2 * signals as StateId).map(mark).collect() }
    }

    /// What keys stand for that stand for signals by their numbers.
    pub(super) fn keys(&self, numbers: Vec<SignalIndex>) -> Keys {
        Keys::new(numbers, &self.by_state)
    }

    /// Marks some rows of a batch, one at least; a scan is over after so much time.
    #[inline(never)]
    pub(super) fn mark<B: Batch>(
        &self,
        batch: B,
        range: Range<usize>,
        scan: Nanoseconds,
        marked: &mut Vec<Mark>,
    ) {
        marked.clear();
        let marks = batch.marks(&self.by_state);
        // What comes after the last of all is not known yet.
        let last = range.end.min(batch.len() - 1);
        let times = batch.times(range.start..last).zip(batch.times(range.start + 1..last + 1));
        let changes = batch.changes(range.start..last);
        marked.extend(times.zip(changes).map(|((time, next), (key, value))| {
            let place = 2 * key as usize + (value & 1) as usize;
            let mark = marks.get(place).map_or(Mark::ODD, |mark| mark.0);
            let shares = next.wrapping_sub(time) < scan;
            let odd = value & !1 != 0;
            Mark(mark | if shares { Mark::SHARES } else { 0 } | if odd { Mark::ODD } else { 0 })
        }));
        marked.resize(range.len(), Mark(Mark::SHARES | Mark::ODD));
    }
}
