//! Event logs: the runs of a machine, each a sequence of activities.
//!
//! An *activity* is a set of changes of one class at one time (Theis 2019, Algorithm 1):
//! `%IX0.1=0 & %IX0.2=1`, addresses sorted. A *trace* is one run, opened by the reset activity.

use crate::log::Nanoseconds;
use crate::plant::SignalClass;

/// Dense number of an activity inside one event log.
pub type ActivityIndex = u32;

/// One kind of event: what changed, and on which side of the PLC.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Activity {
    /// `%IX0.1=0 & %IX0.2=1`, or the name of an event of another event log.
    pub name: String,
    /// γ of Theis 2019, section III-D: input, output, or ⊥ where the event log does not tell.
    pub class: Option<SignalClass>,
    /// The changes it stands for, by address; none where the event log is not of a PLC.
    pub changes: Vec<(String, i64)>,
}

/// The runs of a machine as columns: one entry of `activity` and `time` per event.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct EventLog {
    /// Every activity, by [`ActivityIndex`].
    pub activities: Vec<Activity>,
    /// Activity of each event, trace after trace.
    pub activity: Vec<ActivityIndex>,
    /// Time of each event; never decreasing inside a trace.
    pub time: Vec<Nanoseconds>,
    /// First event of each trace, and behind the last one the number of events.
    pub bounds: Vec<usize>,
    /// Name of each trace.
    pub names: Vec<String>,
}

impl EventLog {
    /// Number of traces.
    pub fn traces(&self) -> usize {
        self.bounds.len().saturating_sub(1)
    }

    /// The activities of trace number `trace`, in order.
    pub fn trace(&self, trace: usize) -> &[ActivityIndex] {
        &self.activity[self.bounds[trace]..self.bounds[trace + 1]]
    }

    /// The times of the events of trace number `trace`.
    pub fn times(&self, trace: usize) -> &[Nanoseconds] {
        &self.time[self.bounds[trace]..self.bounds[trace + 1]]
    }
}
