//! Event logs: the runs of a machine, each a sequence of activities.
//!
//! An *activity* is a set of changes of one class at one time (Theis 2019, Algorithm 1):
//! `%IX0.1=0 & %IX0.2=1`, addresses sorted. A *trace* is one run, opened by the reset activity.

use std::collections::HashMap;

use super::reset::{class_of_name, parse_changes};
use crate::log::{Nanoseconds, SECOND};
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

impl Activity {
    /// An activity of an event log that knows its name only; `%IX0.1=0` tells its changes itself.
    pub fn named(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            class: class_of_name(name),
            changes: parse_changes(name).unwrap_or_default(),
        }
    }
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

    /// Number of events.
    pub fn len(&self) -> usize {
        self.activity.len()
    }

    /// True where there is no event.
    pub fn is_empty(&self) -> bool {
        self.activity.is_empty()
    }

    /// Some of the traces, in the order given; activities keep their numbers.
    pub fn select(&self, traces: &[usize]) -> Self {
        let mut selected =
            Self { activities: self.activities.clone(), bounds: vec![0], ..Self::default() };
        for &trace in traces {
            selected.activity.extend_from_slice(self.trace(trace));
            selected.time.extend_from_slice(self.times(trace));
            selected.bounds.push(selected.activity.len());
            selected.names.push(self.names[trace].clone());
        }
        selected
    }

    /// Traces of names without times: their events are one second apart.
    pub fn from_traces<'n, Trace>(traces: impl IntoIterator<Item = Trace>) -> Self
    where
        Trace: IntoIterator<Item = &'n str>,
    {
        let mut builder = EventLogBuilder::default();
        for trace in traces {
            for (second, name) in trace.into_iter().enumerate() {
                builder.push(name, second as Nanoseconds * SECOND);
            }
            builder.end_trace(None);
        }
        builder.finish()
    }

    /// Numbers the activities anew: only those that happen, in the order of their first event.
    pub(crate) fn forget_unused(&mut self) {
        const UNSEEN: ActivityIndex = ActivityIndex::MAX;
        let mut number = vec![UNSEEN; self.activities.len()];
        let mut order = Vec::new();
        for activity in &mut self.activity {
            let new = &mut number[*activity as usize];
            if *new == UNSEEN {
                *new = order.len() as ActivityIndex;
                order.push(*activity);
            }
            *activity = *new;
        }
        self.activities = order.iter().map(|&old| self.activities[old as usize].clone()).collect();
    }
}

/// Builds an event log trace by trace from names.
#[derive(Debug, Default)]
pub struct EventLogBuilder {
    log: EventLog,
    index: HashMap<String, ActivityIndex>,
}

impl EventLogBuilder {
    /// Appends an event to the open trace. An activity whose name tells changes carries them.
    pub fn push(&mut self, name: &str, time: Nanoseconds) {
        let known = self.index.get(name).copied();
        let activity = known.unwrap_or_else(|| {
            let new = self.log.activities.len() as ActivityIndex;
            self.log.activities.push(Activity::named(name));
            self.index.insert(name.to_owned(), new);
            new
        });
        self.log.activity.push(activity);
        self.log.time.push(time);
    }

    /// Sets γ of the activity called `name`, where it is known.
    pub fn set_class(&mut self, name: &str, class: Option<SignalClass>) {
        if let Some(&index) = self.index.get(name) {
            self.log.activities[index as usize].class = class;
        }
    }

    /// Ends the open trace: events of it are put in time order, ties as they came.
    pub fn end_trace(&mut self, name: Option<String>) {
        if self.log.bounds.is_empty() {
            self.log.bounds.push(0);
        }
        let start = self.log.bounds.last().copied().unwrap_or(0);
        if !self.log.time[start..].is_sorted() {
            let mut order: Vec<usize> = (start..self.log.time.len()).collect();
            order.sort_by_key(|&event| self.log.time[event]);
            let time: Vec<_> = order.iter().map(|&event| self.log.time[event]).collect();
            let activity: Vec<_> = order.iter().map(|&event| self.log.activity[event]).collect();
            self.log.time[start..].copy_from_slice(&time);
            self.log.activity[start..].copy_from_slice(&activity);
        }
        self.log.bounds.push(self.log.activity.len());
        let number = self.log.bounds.len() - 1;
        self.log.names.push(name.unwrap_or_else(|| number.to_string()));
    }

    /// The log so far.
    pub fn finish(mut self) -> EventLog {
        if self.log.bounds.is_empty() {
            self.log.bounds.push(0);
        }
        self.log
    }
}

#[cfg(test)]
mod tests {
    use super::{EventLog, EventLogBuilder};
    use crate::log::SECOND;
    use crate::plant::SignalClass;

    #[test]
    fn traces_of_names() {
        let log = EventLog::from_traces([vec!["a", "b"], vec![], vec!["b"]]);
        assert_eq!((log.traces(), log.len()), (3, 3));
        assert_eq!(log.trace(2), [1]);
        assert_eq!(log.times(0), [0, SECOND]);
        assert_eq!(log.names, ["1", "2", "3"]);
    }

    #[test]
    fn some_of_the_traces() {
        let log = EventLog::from_traces([vec!["a"], vec!["b"], vec!["c", "a"]]);
        let selected = log.select(&[2, 0]);
        assert_eq!((selected.trace(0), selected.trace(1)), (&[2, 0][..], &[0][..]));
        assert_eq!(selected.names, ["3", "1"]);
    }

    #[test]
    fn events_of_a_trace_are_put_in_order_and_names_tell_changes() {
        let mut builder = EventLogBuilder::default();
        builder.push("%QX0.1=1", 5);
        builder.push("%IX0.1=1", 3);
        builder.end_trace(Some("first".to_owned()));
        let log = builder.finish();
        assert_eq!((log.trace(0), log.times(0)), (&[1, 0][..], &[3, 5][..]));
        assert_eq!(log.activities[0].class, Some(SignalClass::Output));
        assert_eq!(log.activities[1].changes, [("%IX0.1".to_owned(), 1)]);
    }
}
