//! What can be said of a row before its turn, whatever comes before it. It is found for many rows
//! in one sweep, in which no row waits for another, and says at once which rows are the usual ones.

use std::ops::Range;

use crate::log::{Nanoseconds, SignalIndex};
use crate::signal_state::chains::ChainIndex;
use crate::signal_state::lanes::Lanes;
use crate::signal_state::model::NominalModel;
use crate::signal_state::states::StateId;

use super::batch::Batch;

/// The state that a row leads to, the chain of its device, and what is particular about it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mark(u64);

impl Mark {
    /// Where the number of the chain begins; below it is the state.
    const DEVICE: u32 = 32;
    /// The most frequent transition into its state waits for another event.
    const WAITS: u64 = 1 << 60;
    /// A step of its group's chain, too.
    const STARTS: u64 = 1 << 61;
    /// The row after it is of the same scan, or not known yet.
    const SHARES: u64 = 1 << 62;
    /// Never a usual row: no boolean value that somebody learned, or a cycle ends with it.
    const ODD: u64 = 1 << 63;

    /// Of rows of which nothing is known.
    const UNKNOWN: Self = Self(Self::ODD);

    #[inline(always)]
    fn is(self, what: u64) -> bool {
        self.0 & what != 0
    }

    /// True for a scan of its own that may be usual.
    #[inline(always)]
    pub(super) fn is_alone(self) -> bool {
        self.0 < Self::SHARES
    }

    /// True where the most frequent transition into its state waits for another event.
    #[inline(always)]
    pub(super) fn waits(self) -> bool {
        self.is(Self::WAITS)
    }

    /// True where the row after it is of the same scan, or not known yet.
    #[inline(always)]
    pub(super) fn shares(self) -> bool {
        self.is(Self::SHARES)
    }

    /// True where it is never usual: its state may mean nothing.
    #[inline(always)]
    pub(super) fn is_odd(self) -> bool {
        self.is(Self::ODD)
    }

    /// True where it is a step of its group's chain, too.
    #[inline(always)]
    pub(super) fn starts(self) -> bool {
        self.is(Self::STARTS)
    }

    /// The state it leads to.
    #[inline(always)]
    pub(super) fn state(self) -> StateId {
        self.0 as StateId
    }

    /// The chain of its device.
    #[inline(always)]
    pub(super) fn device(self) -> ChainIndex {
        ((self.0 & (Self::WAITS - 1)) >> Self::DEVICE) as ChainIndex
    }
}

/// What keys of rows stand for.
#[derive(Debug, Clone, Default)]
pub struct Keys {
    numbers: Vec<SignalIndex>,
    /// Of each key, as it goes off and as it goes on.
    marks: Vec<[Mark; 2]>,
}

impl Keys {
    fn new(numbers: Vec<SignalIndex>, own: &[[Mark; 2]]) -> Self {
        let two = |&number: &SignalIndex| own.get(number as usize).copied();
        let marks = numbers.iter().map(|number| two(number).unwrap_or([Mark::UNKNOWN; 2]));
        Self { marks: marks.collect(), numbers }
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

    pub(super) fn marks(&self) -> &[[Mark; 2]] {
        &self.marks
    }
}

/// The marks of a plant's signals, each as it goes off and as it goes on.
#[derive(Debug, Clone)]
pub(super) struct Marks {
    by_signal: Vec<[Mark; 2]>,
}

impl Marks {
    pub(super) fn of(model: &NominalModel, lanes: &Lanes) -> Self {
        let chains = &model.chains;
        let mark = |state: StateId| {
            let device = chains.device_chain(state / 2);
            let closes = model.learned.group_start[chains.group_of(device)] == state;
            let traits = [
                (Mark::STARTS, lanes.starts(state)),
                (Mark::WAITS, lanes.waits(state as usize)),
                (Mark::ODD, closes && lanes.starts(state)),
            ];
            let traits = traits.iter().filter(|(_, has)| *has).map(|(what, _)| what);
            Mark(traits.sum::<u64>() | (device as u64) << Mark::DEVICE | u64::from(state))
        };
        let signals = 0..model.plant.signals.len() as SignalIndex;
        Self { by_signal: signals.map(|signal| [2 * signal, 2 * signal + 1].map(mark)).collect() }
    }

    /// What keys stand for that stand for signals by their numbers.
    pub(super) fn keys(&self, numbers: Vec<SignalIndex>) -> Keys {
        Keys::new(numbers, &self.by_signal)
    }

    /// Marks some rows of a batch, one at least, and so many unknown ones behind the last of the
    /// batch that `range` is full; a scan is over after so much time.
    #[inline(never)]
    pub(super) fn mark<B: Batch>(
        &self,
        batch: B,
        range: Range<usize>,
        scan: Nanoseconds,
        marked: &mut Vec<Mark>,
    ) {
        marked.clear();
        let marks = batch.marks(&self.by_signal);
        // What comes after the last of all is not known yet.
        let last = range.end.min(batch.len() - 1);
        let times = batch.times(range.start..last).zip(batch.times(range.start + 1..last + 1));
        let changes = batch.changes(range.start..last);
        marked.extend(times.zip(changes).map(|((time, next), (key, value))| {
            let two = marks.get(key as usize);
            let mark = two.and_then(|two| two.get(value as usize)).unwrap_or(&Mark::UNKNOWN);
            let shares = next.wrapping_sub(time) < scan;
            Mark(mark.0 | if shares { Mark::SHARES } else { 0 })
        }));
        marked.resize(range.len(), Mark::UNKNOWN);
    }
}
