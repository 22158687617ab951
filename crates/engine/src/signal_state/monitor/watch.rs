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
    pub(super) state: StateId,
    pub(super) since: Nanoseconds,
}

pub(super) const NOWHERE: Here = Here { state: NO_STATE, since: 0 };

/// Everything that changes while watching, but for the counters in the lanes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Watch {
    pub(super) values: Values,
    /// Per chain.
    pub(super) here: Vec<Here>,
    pub(super) off_path: Vec<bool>,
    pub(super) group_cycles: Vec<u64>,
    /// Per group: time and state of its latest event of any signal.
    pub(super) group_last: Vec<Nanoseconds>,
    pub(super) group_last_state: Vec<StateId>,
    pub(super) group_stalled: Vec<Option<Finding>>,
    pub(super) incidents: Vec<Option<Incident>>,
    pub(super) open: Vec<OpenPath>,
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
            here: vec![NOWHERE; chains],
            off_path: vec![false; chains],
            group_cycles: vec![0; groups],
            group_last: vec![Nanoseconds::MAX; groups],
            group_last_state: vec![NO_STATE; groups],
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
