//! From an I/O log to an event log (Theis 2019, Algorithm 1).
//!
//! Changes of one class at one time become one activity. Inputs come first in a scan, then
//! memory, then outputs: a program reads, computes and writes, whatever order the file has. A
//! signal that changes twice at one time begins a new activity. (Algorithm 1 as printed updates
//! time and class only where it appends, so that after the first change of time every event would
//! be its own activity; they are updated in both branches here.)
//!
//! The activity that contains the reset opens a trace. What lies before the first reset and after
//! the last one is an incomplete run, and so is a run that a gap interrupts: the rest of it, up to
//! the next reset, is another. Incomplete runs are kept only where asked for.

use hashbrown::HashMap;

use super::event_log::{Activity, ActivityIndex, EventLog};
use super::reset::{Reset, ResetError};
use crate::log::{ChangeLog, Nanoseconds, SignalIndex};
use crate::plant::{Plant, SignalClass};
use crate::signal_state::events::{Meaning, Values, is_image};

/// How an I/O log is cut into runs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Slicing {
    /// What opens a run.
    pub reset: Reset,
    /// Keep incomplete runs as well.
    pub keep_partial: bool,
    /// Signals that take part, by [`SignalIndex`]; empty: all of them.
    pub only: Vec<bool>,
}

impl EventLog {
    /// Cuts a log into runs. `plant` holds the log's signals in the log's order.
    ///
    /// # Errors
    /// The reset never happens.
    pub fn from_change_log(
        log: &ChangeLog,
        plant: &Plant,
        slicing: &Slicing,
    ) -> Result<Self, ResetError> {
        let mut slicer = Slicer::new(log, plant, slicing);
        slicer.read(log);
        slicer.finish(plant)
    }
}

/// A change: class first, so that sorting a scan sorts by class.
type Change = (SignalClass, SignalIndex, i64);

struct Slicer<'s> {
    slicing: &'s Slicing,
    classes: Vec<SignalClass>,
    /// Place of each signal in the order of names: addresses in an activity are sorted.
    rank: Vec<u32>,
    single: HashMap<(SignalIndex, i64), ActivityIndex>,
    several: HashMap<Vec<(SignalIndex, i64)>, ActivityIndex>,
    activities: Vec<Vec<(SignalIndex, i64)>>,
    /// Whether each activity contains the reset.
    opens: Vec<bool>,
    events: EventLog,
    /// First event of the run that is open, and whether it began with the reset.
    open: (usize, bool),
    resets: usize,
    merged: Vec<(SignalIndex, i64)>,
}

impl<'s> Slicer<'s> {
    fn new(log: &ChangeLog, plant: &Plant, slicing: &'s Slicing) -> Self {
        let mut order: Vec<usize> = (0..log.signals.len()).collect();
        order.sort_by_key(|&signal| &log.signals[signal]);
        let mut rank = vec![0; order.len()];
        for (place, &signal) in order.iter().enumerate() {
            rank[signal] = place as u32;
        }
        Self {
            slicing,
            classes: plant.signals.iter().map(|signal| signal.class).collect(),
            rank,
            single: HashMap::new(),
            several: HashMap::new(),
            activities: Vec::new(),
            opens: Vec::new(),
            events: EventLog { bounds: vec![0], ..EventLog::default() },
            open: (0, false),
            resets: 0,
            merged: Vec::new(),
        }
    }

    fn read(&mut self, log: &ChangeLog) {
        let mut values = Values::new(log.signals.len());
        let mut gaps = log.gaps.iter().peekable();
        let mut scan: Vec<Change> = Vec::new();
        let mut row = 0;
        while row < log.len() {
            let time = log.time[row];
            let end = row + log.time[row..].iter().take_while(|&&t| t == time).count();
            // What a gap hid did not happen at the first time after it.
            let mut unseen = row == 0 && is_image(log.value[row..end].iter().copied());
            while gaps.next_if(|gap| gap.end <= time).is_some() {
                self.cut(false);
                values.doubt();
                unseen = true;
            }
            scan.clear();
            for row in row..end {
                let (signal, value) = (log.signal[row], log.value[row]);
                let meaning = values.take(signal, value);
                let takes_part = self.slicing.only.get(signal as usize).copied().unwrap_or(true);
                if meaning == Meaning::Event && takes_part && !unseen {
                    scan.push((self.classes[signal as usize], signal, value));
                }
            }
            if scan.len() > 1 {
                scan.sort_by_key(|change| change.0);
            }
            self.take_scan(time, &scan);
            row = end;
        }
        self.cut(false);
    }

    fn take_scan(&mut self, time: Nanoseconds, scan: &[Change]) {
        let mut class = None;
        let mut merged = std::mem::take(&mut self.merged);
        for &(of, signal, value) in scan {
            if class != Some(of) || merged.iter().any(|&(known, _)| known == signal) {
                self.append(time, &mut merged);
            }
            class = Some(of);
            merged.push((signal, value));
        }
        self.append(time, &mut merged);
        self.merged = merged;
    }

    /// One activity has ended.
    fn append(&mut self, time: Nanoseconds, changes: &mut Vec<(SignalIndex, i64)>) {
        if changes.is_empty() {
            return;
        }
        let activity = self.number(changes);
        changes.clear();
        if self.opens[activity as usize] {
            self.cut(true);
            self.resets += 1;
        }
        self.events.activity.push(activity);
        self.events.time.push(time);
    }

    fn number(&mut self, changes: &mut [(SignalIndex, i64)]) -> ActivityIndex {
        changes.sort_by_key(|change| self.rank[change.0 as usize]);
        let changes = &*changes;
        let known = match changes {
            [only] => self.single.get(only),
            several => self.several.get(several),
        };
        if let Some(&known) = known {
            return known;
        }
        let new = self.activities.len() as ActivityIndex;
        match changes {
            [only] => self.single.insert(*only, new),
            several => self.several.insert(several.to_vec(), new),
        };
        self.opens.push(self.slicing.reset.changes.iter().all(|part| changes.contains(part)));
        self.activities.push(changes.to_vec());
        new
    }

    /// Ends the open run; the next one begins with the reset, or somewhere in its middle.
    fn cut(&mut self, with_reset: bool) {
        let (first, began) =
            std::mem::replace(&mut self.open, (self.events.activity.len(), with_reset));
        let complete = began && with_reset;
        if complete || self.slicing.keep_partial {
            if self.events.activity.len() > first {
                self.events.bounds.push(self.events.activity.len());
            }
        } else {
            self.events.activity.truncate(first);
            self.events.time.truncate(first);
            self.open.0 = first;
        }
    }

    fn finish(mut self, plant: &Plant) -> Result<EventLog, ResetError> {
        if self.resets == 0 {
            return Err(self.never(plant));
        }
        let symbol = |signal: SignalIndex| plant.signals[signal as usize].symbol().to_owned();
        for changes in &self.activities {
            let class = Some(self.classes[changes[0].0 as usize]);
            let changes: Vec<(String, i64)> =
                changes.iter().map(|&(signal, value)| (symbol(signal), value)).collect();
            self.events.activities.push(Activity {
                name: activity_name(&changes),
                class: class.filter(|&class| class != SignalClass::Memory),
                changes,
            });
        }
        self.events.names = (1..=self.events.traces()).map(|number| number.to_string()).collect();
        self.events.forget_unused();
        Ok(self.events)
    }

    fn never(&self, plant: &Plant) -> ResetError {
        let symbol = |signal: SignalIndex| plant.signals[signal as usize].symbol();
        let reset: Vec<(String, i64)> =
            self.slicing.reset.changes.iter().map(|&(s, v)| (symbol(s).to_owned(), v)).collect();
        let signal = self.slicing.reset.changes[0].0;
        let mut to: Vec<i64> =
            self.activities.iter().flatten().filter(|c| c.0 == signal).map(|c| c.1).collect();
        to.sort_unstable();
        to.dedup();
        let taken = match to.as_slice() {
            [] => format!("; {} never changes", symbol(signal)),
            values => {
                let values: Vec<String> = values.iter().take(8).map(i64::to_string).collect();
                format!("; {} changes to {}", symbol(signal), values.join(", "))
            }
        };
        ResetError::Never { reset: activity_name(&reset), taken }
    }
}

/// `%IX0.1=0 & %IX0.2=1`.
pub fn activity_name(changes: &[(String, i64)]) -> String {
    let parts: Vec<String> =
        changes.iter().map(|(signal, value)| format!("{signal}={value}")).collect();
    parts.join(" & ")
}

#[cfg(test)]
mod tests {
    use super::Slicing;
    use crate::log::{ChangeLog, ChangeLogBuilder, Gap};
    use crate::naming::NamingRule;
    use crate::plant::Plant;
    use crate::process::event_log::EventLog;
    use crate::process::reset::{Reset, ResetError};
    use crate::symbols::SymbolTable;

    fn log(rows: &[(i64, &str, i64)]) -> ChangeLog {
        let mut builder = ChangeLogBuilder::default();
        for &(time, signal, value) in rows {
            let signal = builder.intern(signal);
            builder.push(time, signal, value);
        }
        builder.finish()
    }

    fn sliced(log: &ChangeLog, reset: &str, keep_partial: bool) -> Result<EventLog, ResetError> {
        let plant = Plant::arrange(&log.signals, &SymbolTable::default(), &NamingRule::default());
        let reset = Reset::parse(reset, &plant)?;
        EventLog::from_change_log(log, &plant, &Slicing { reset, keep_partial, only: Vec::new() })
    }

    fn runs(log: &EventLog) -> Vec<Vec<&str>> {
        (0..log.traces())
            .map(|t| {
                log.trace(t).iter().map(|&a| log.activities[a as usize].name.as_str()).collect()
            })
            .collect()
    }

    const TANK: [(i64, &str, i64); 12] = [
        (0, "%IX0.1", 1),
        (0, "%QX0.0", 0),
        (1, "%QX0.0", 1),
        (2, "%QX0.0", 1),
        (5, "%QX0.1", 1),
        (5, "%IX0.2", 1),
        (5, "%IX0.1", 0),
        (6, "%IX0.1", 1),
        (9, "%IX0.1", 0),
        (9, "%QX0.1", 0),
        (10, "%IX0.2", 0),
        (11, "%IX0.1", 1),
    ];

    #[test]
    fn changes_of_one_class_and_time_are_one_activity_and_inputs_come_first() {
        let events = sliced(&log(&TANK), "%IX0.1=0", false);
        let events = events.as_ref().map(runs);
        let run = vec!["%IX0.1=0 & %IX0.2=1", "%QX0.1=1", "%IX0.1=1"];
        assert_eq!(events, Ok(vec![run]));
    }

    #[test]
    fn incomplete_runs_are_kept_where_asked_for() {
        let events = sliced(&log(&TANK), "%IX0.1=0", true);
        let lengths = events.as_ref().map(|e| runs(e).iter().map(Vec::len).collect());
        assert_eq!(lengths, Ok(vec![1, 3, 4]));
        let names = events.map(|e| e.activities.iter().map(|a| a.name.clone()).collect::<Vec<_>>());
        assert_eq!(names.map(|n| n[0].clone()), Ok("%QX0.0=1".to_owned()));
    }

    #[test]
    fn the_image_at_the_start_opens_no_run_and_a_gap_ends_one() {
        let mut log = log(&[
            (0, "%IX0.1", 0),
            (1, "%IX0.1", 1),
            (2, "%IX0.1", 0),
            (3, "%IX0.1", 1),
            (9, "%IX0.1", 0),
            (10, "%IX0.1", 1),
            (11, "%IX0.1", 0),
            (12, "%IX0.1", 1),
            (13, "%IX0.1", 0),
        ]);
        log.gaps.push(Gap { start: 3, end: 9 });
        let complete = sliced(&log, "%IX0.1=0", false).map(|e| e.time.clone());
        assert_eq!(complete, Ok(vec![11, 12]));
        let all = sliced(&log, "%IX0.1=0", true).map(|e| e.bounds.clone());
        assert_eq!(all, Ok(vec![0, 1, 3, 4, 6, 7]));
    }

    #[test]
    fn a_signal_that_changes_twice_at_once_is_two_activities() {
        let log = log(&[(0, "A", 0), (1, "A", 1), (1, "A", 0), (1, "B", 1), (2, "A", 1)]);
        let events = sliced(&log, "A=1", false);
        assert_eq!(events.as_ref().map(runs), Ok(vec![vec!["A=1", "A=0 & B=1"]]));
    }

    #[test]
    fn a_reset_that_never_happens_is_an_error() {
        let error = sliced(&log(&TANK), "%IX0.1=7", false).map_err(|e| e.to_string());
        let expected = "reset: the log has no change to %IX0.1=7, so there is no run in it; \
                        %IX0.1 changes to 0, 1";
        assert_eq!(error.err().as_deref(), Some(expected));
    }
}
