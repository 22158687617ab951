//! Everything that changes while watching, but for the counters in the lanes.

use serde::{Deserialize, Serialize};

use crate::finding::Finding;
use crate::log::{Nanoseconds, SignalIndex};
use crate::signal_state::chains::ChainIndex;
use crate::signal_state::events::{Row, Values};
use crate::signal_state::incident::Incident;
use crate::signal_state::model::NominalModel;
use crate::signal_state::snapshot::Snapshot;
use crate::signal_state::states::{NO_STATE, StateId};

/// A path off the known transitions that has not returned yet.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct OpenPath {
    pub(super) chain: ChainIndex,
    pub(super) finding: Finding,
    pub(super) path: Vec<StateId>,
    pub(super) deadline: Nanoseconds,
    pub(super) known: u8,
}

/// Where a chain stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Here {
    pub(super) since: Nanoseconds,
    pub(super) state: StateId,
    /// The clock of its group; none there is while it is off its path, where nothing is usual.
    pub(super) clock: u32,
}

const OFF_PATH: u32 = 1 << 31;

impl Here {
    /// Nowhere yet.
    fn of(group: usize) -> Self {
        Self { since: 0, state: NO_STATE, clock: group as u32 }
    }

    pub(super) fn off_path(&self) -> bool {
        self.clock & OFF_PATH != 0
    }

    pub(super) fn leave_path(&mut self) {
        self.clock |= OFF_PATH;
    }

    pub(super) fn return_to_path(&mut self) {
        self.clock &= !OFF_PATH;
    }

    #[inline(always)]
    pub(super) fn enter(&mut self, state: StateId, time: Nanoseconds) {
        (self.state, self.since) = (state, time);
    }

    /// Its state is not known any more.
    pub(super) fn forget(&mut self) {
        self.enter(NO_STATE, 0);
    }
}

/// The latest event of a group.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Clock {
    pub(super) last: Nanoseconds,
    pub(super) state: StateId,
    /// The group has moved since the start or a gap, and no stop of it has been told: its time to
    /// stall is among the deadlines.
    pub(super) runs: bool,
}

/// The clock of a group that has not moved.
pub(super) const NEVER_MOVED: Clock = Clock { last: 0, state: NO_STATE, runs: false };

/// Everything that changes while watching, but for the counters in the lanes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Watch {
    pub(super) values: Values,
    /// Per chain.
    pub(super) here: Vec<Here>,
    pub(super) group_cycles: Vec<u64>,
    /// Per group.
    pub(super) clocks: Vec<Clock>,
    pub(super) group_stalled: Vec<Option<Finding>>,
    pub(super) incidents: Vec<Option<Incident>>,
    pub(super) open: Vec<OpenPath>,
    /// Not later than any of [`Self::open`], nor than any running clock's time to stall.
    pub(super) next_deadline: Nanoseconds,
    /// Rows of the scan that is not complete yet.
    pub(super) pending: Vec<Row>,
    pub(super) now: Nanoseconds,
    pub(super) started: bool,
    pub(super) resynchronise: bool,
    /// Where it is told: when the plant's rows began, or went on after a gap.
    pub(super) begins: Option<Nanoseconds>,
    pub(super) further: Vec<(SignalIndex, i64)>,
    /// Signals nobody learned, and whether that has been said.
    pub(super) unknown_signals: Vec<(String, bool)>,
    pub(super) snapshots: Vec<Snapshot>,
    /// Hashes of the alarm paths offered for confirmation.
    pub(super) offered: Vec<u64>,
}

impl Watch {
    /// Nothing has been seen yet.
    pub(super) fn of(model: &NominalModel) -> Self {
        let chains = model.chains.len();
        let groups = model.plant.groups.len();
        Self {
            values: Values::new(model.plant.signals.len()),
            here: (0..chains).map(|chain| Here::of(model.chains.group_of(chain))).collect(),
            group_cycles: vec![0; groups],
            clocks: vec![NEVER_MOVED; groups],
            group_stalled: vec![None; groups],
            incidents: vec![None; groups],
            open: Vec::new(),
            next_deadline: Nanoseconds::MAX,
            pending: Vec::new(),
            now: Nanoseconds::MIN,
            started: false,
            resynchronise: false,
            begins: None,
            further: Vec::new(),
            unknown_signals: Vec::new(),
            snapshots: Vec::new(),
            offered: Vec::new(),
        }
    }
}
