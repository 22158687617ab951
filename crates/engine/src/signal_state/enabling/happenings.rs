//! The events of one group of the learning logs, and where they are found.

use crate::log::Nanoseconds;
use crate::signal_state::states::StateId;

use super::entries::Entries;

/// One event of the learning logs.
#[derive(Debug, Clone, Copy)]
pub struct Happening {
    /// When; never earlier than what happened before, and later than all of an earlier run.
    pub time: Nanoseconds,
    /// The state entered.
    pub state: StateId,
    /// Twice its run, and one more where it is doubtful: a plant has millions of these.
    mark: u32,
}

impl Happening {
    /// `doubtful` where this is no event, but its device's state is in doubt after a gap.
    #[inline]
    pub fn new(time: Nanoseconds, state: StateId, run: u32, doubtful: bool) -> Self {
        Self { time, state, mark: run << 1 | u32::from(doubtful) }
    }

    /// Run it belongs to: logs, and the stretches between gaps, each begin a new one.
    #[inline]
    pub fn run(&self) -> u32 {
        self.mark >> 1
    }

    /// True where this is no event, but its device's state is in doubt after a gap.
    #[inline]
    pub fn doubtful(&self) -> bool {
        self.mark & 1 == 1
    }
}

/// The events of a group, in order and by state.
#[derive(Clone, Copy)]
pub struct Happenings<'a> {
    /// In order.
    pub happenings: &'a [Happening],
    /// By state.
    pub entries: &'a Entries,
    /// When each run's first event happened, ascending.
    pub run_starts: &'a [Nanoseconds],
    /// By state: whether it is an output's.
    pub is_output: &'a [bool],
    /// Smallest time difference that means something, in seconds.
    pub resolution_s: f64,
}
