//! Watching a plant against its nominal model (Ghosh 2016, section 2.6), as decided in the design.
//!
//! Two verbs: [`Monitor::observe`] takes rows in time order, [`Monitor::advance`] says that time
//! went on. Rows are held until their scan is complete, so any split of a log into batches gives
//! the same findings. All state is plain data and serialises.

mod paths;
mod report;
mod scan;

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::finding::Finding;
use crate::log::{Nanoseconds, SECOND, SignalIndex};
use crate::saved_state;
use crate::timing::limits::Accepted;

use super::chains::{ChainIndex, ChainKind};
use super::events::{Meaning, Row, Values};
use super::incident::Incident;
use super::lanes::{Counters, Lanes};
use super::message;
use super::model::NominalModel;
use super::order::ScanOrder;
use super::parameters::Timing;
use super::snapshot::Snapshot;
use super::states::{NO_STATE, StateId};

/// Values of words nobody learned that are kept apart by number; beyond, they share the last.
const FURTHER_STATES_AT_MOST: usize = 10_000;
/// Signals nobody learned that are named once each; beyond, they pass unnamed.
const UNKNOWN_SIGNALS_AT_MOST: usize = 1_000;
/// Other orders of one scan are tried for up to this many events of one chain.
const REORDER_AT_MOST: usize = 6;
/// Consecutive known transitions after which a device is back on its path.
const KNOWN_TO_RETURN: u8 = 2;
/// Distinct alarm paths offered for confirmation.
const OFFERS_AT_MOST: usize = 10_000;
/// Rows whose lanes are fetched ahead of their turn.
const WARMED_ROWS: usize = 16;
/// Snapshots kept until somebody takes them.
const SNAPSHOTS_AT_MOST: usize = 256;
/// Longest alarm path kept, in states.
const PATH_AT_MOST: usize = 64;

/// Why rows or a saved state were refused.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum MonitorError {
    /// A row older than what has been seen.
    #[error(
        "row {row} of the batch lies {late_s} s before a row already watched; give rows in time order"
    )]
    Order {
        /// Row of the batch, counted from 1.
        row: usize,
        /// How far back, in seconds.
        late_s: String,
    },
    /// The saved state is not one, or of another version.
    #[error("the saved monitor state is damaged or of another version; start without it")]
    Damaged,
    /// The saved state belongs to another model.
    #[error("the saved monitor state belongs to another model; start without it")]
    OtherModel,
}

/// A path off the known transitions that has not returned yet.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct OpenPath {
    chain: ChainIndex,
    finding: Finding,
    path: Vec<StateId>,
    deadline: Nanoseconds,
    known: u8,
}

/// Where a chain stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
struct Here {
    state: StateId,
    since: Nanoseconds,
}

const NOWHERE: Here = Here { state: NO_STATE, since: 0 };

/// Everything that changes while watching, but for the counters in [`Lanes`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Watch {
    values: Values,
    /// Per chain.
    here: Vec<Here>,
    off_path: Vec<bool>,
    group_cycles: Vec<u64>,
    /// Per group: time and state of its latest event of any signal.
    group_last: Vec<Nanoseconds>,
    group_last_state: Vec<StateId>,
    group_stalled: Vec<Option<Finding>>,
    incidents: Vec<Option<Incident>>,
    open: Vec<OpenPath>,
    next_deadline: Nanoseconds,
    /// Rows of the scan that is not complete yet.
    pending: Vec<Row>,
    now: Nanoseconds,
    started: bool,
    resynchronise: bool,
    further: Vec<(SignalIndex, i64)>,
    /// Signals nobody learned, and whether that has been said.
    unknown_signals: Vec<(String, bool)>,
    snapshots: Vec<Snapshot>,
    /// Hashes of the alarm paths offered for confirmation.
    offered: Vec<u64>,
}

/// What [`Monitor::save`] writes.
#[derive(Serialize, Deserialize)]
struct Saved {
    version: u32,
    fingerprint: u64,
    watch: Watch,
    counters: Counters,
}

const STATE_VERSION: u32 = 3;

/// A state is entered.
#[derive(Debug, Clone, Copy)]
struct Entry {
    state: StateId,
    time: Nanoseconds,
    /// When the same state was entered before.
    before: Nanoseconds,
}

/// Since when a device had been waiting, and whether another's delay may be the reason.
#[derive(Debug, Clone, Copy)]
struct Waiting {
    since: Nanoseconds,
    inherits: bool,
}

/// A transition and how long it took.
#[derive(Debug, Clone, Copy)]
struct Timed {
    /// Since when it was due.
    since: Nanoseconds,
    took: Nanoseconds,
    /// Measured as the rule's times were learned.
    as_learned: bool,
}

impl Timed {
    #[inline]
    fn new(since: Nanoseconds, time: Nanoseconds, as_learned: bool) -> Self {
        // In a scan whose order was mended, time may seem to run backwards.
        Self { since, took: time.saturating_sub(since).max(0), as_learned }
    }

    fn seconds(self) -> f64 {
        self.took as f64 / SECOND as f64
    }
}

/// Watches one plant.
#[derive(Debug, Clone)]
pub struct Monitor {
    model: Arc<NominalModel>,
    order: Option<ScanOrder>,
    lanes: Lanes,
    stall_after: Vec<Nanoseconds>,
    fresh_for: Nanoseconds,
    watch: Watch,
    findings: Vec<Finding>,
    scratch: Vec<(ChainIndex, Entry)>,
}

impl Monitor {
    /// A monitor that has seen nothing yet.
    pub fn new(model: Arc<NominalModel>) -> Self {
        let signals = model.plant.signals.len();
        let chains = model.chains.len();
        let groups = model.plant.groups.len();
        let watch = Watch {
            values: Values::new(signals),
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
            further: Vec::new(),
            unknown_signals: Vec::new(),
            snapshots: Vec::new(),
            offered: Vec::new(),
        };
        Self {
            order: (model.parameters.timing == Timing::Adaptive)
                .then(|| ScanOrder::of(&model.plant)),
            stall_after: (0..groups).map(|group| model.stall_after(group)).collect(),
            fresh_for: (model.parameters.return_within_s * SECOND as f64) as Nanoseconds,
            lanes: model.fresh_lanes(),
            watch,
            findings: Vec::new(),
            scratch: Vec::new(),
            model,
        }
    }

    /// The signal's number for rows: the model's, or a number beyond for a signal nobody learned.
    pub fn signal_index(&mut self, symbol: &str, known: Option<SignalIndex>) -> SignalIndex {
        if let Some(known) = known {
            return known;
        }
        let beyond = self.model.plant.signals.len();
        let unknown = &mut self.watch.unknown_signals;
        let place = unknown.iter().position(|(s, _)| s == symbol).unwrap_or_else(|| {
            if unknown.len() < UNKNOWN_SIGNALS_AT_MOST {
                unknown.push((symbol.to_owned(), false));
                unknown.len() - 1
            } else {
                UNKNOWN_SIGNALS_AT_MOST
            }
        });
        (beyond + place) as SignalIndex
    }

    /// Takes rows in time order and returns what they show.
    ///
    /// # Errors
    /// A row older than one already watched; nothing of the batch is taken then.
    pub fn observe(&mut self, rows: &[Row]) -> Result<Vec<Finding>, MonitorError> {
        self.take_rows(rows)?;
        Ok(self.take_findings())
    }

    /// What [`Self::observe`] does, but for the findings: they wait for [`Self::take_findings`].
    ///
    /// # Errors
    /// A row older than one already watched; nothing of the batch is taken then.
    pub fn take_rows(&mut self, rows: &[Row]) -> Result<(), MonitorError> {
        self.check_order(rows)?;
        let mut taken = 0;
        for start in (0..rows.len()).step_by(WARMED_ROWS) {
            let end = rows.len().min(start + WARMED_ROWS);
            self.warm(&rows[start..end]);
            while taken < end {
                taken += self.take_next(&rows[taken..]);
            }
        }
        Ok(())
    }

    /// All findings not taken yet.
    pub fn take_findings(&mut self) -> Vec<Finding> {
        std::mem::take(&mut self.findings)
    }

    /// Takes rows that say how signals stand, not that they changed: what a live source reads
    /// first after its start or a gap, or when it meets a signal.
    ///
    /// # Errors
    /// A row older than one already watched; nothing of the batch is taken then.
    pub fn image(&mut self, rows: &[Row]) -> Result<Vec<Finding>, MonitorError> {
        self.check_order(rows)?;
        let (Some(first), Some(last)) = (rows.first(), rows.last()) else {
            return Ok(Vec::new());
        };
        self.complete_scan();
        self.pass_deadlines(first.time);
        if std::mem::replace(&mut self.watch.resynchronise, false) {
            self.resume_clocks(last.time);
        }
        self.watch.started = true;
        self.watch.now = last.time;
        for &row in rows {
            if row.signal as usize >= self.model.plant.signals.len() {
                self.report_unknown_signal(row);
            } else if self.watch.values.take(row.signal, row.value) != Meaning::Sample {
                self.lose_sight(row.signal);
            }
        }
        Ok(std::mem::take(&mut self.findings))
    }

    /// Time went on to `now` without a change: completes the running scan, finds stalls and paths
    /// that did not return.
    pub fn advance(&mut self, now: Nanoseconds) -> Vec<Finding> {
        // What is due is judged when all rows before it are: the running scan may hold the very
        // event a group was waiting for.
        if self.scan_is_over(now) || now >= self.watch.next_deadline {
            self.complete_scan();
        }
        if now > self.watch.now {
            self.watch.now = now;
            self.pass_deadlines(now);
        }
        std::mem::take(&mut self.findings)
    }

    /// The newest time that was observed or advanced to; None before the first.
    pub fn now(&self) -> Option<Nanoseconds> {
        (self.watch.now != Nanoseconds::MIN).then_some(self.watch.now)
    }

    /// Nothing was recorded from `start` to `end`: what follows has no predecessor.
    pub fn gap(&mut self, start: Nanoseconds, end: Nanoseconds) -> Vec<Finding> {
        self.complete_scan();
        let watch = &mut self.watch;
        watch.now = watch.now.max(end);
        watch.here.fill(NOWHERE);
        watch.off_path.fill(false);
        watch.open.clear();
        watch.group_last.fill(Nanoseconds::MAX);
        for (stalled, last) in watch.group_stalled.iter_mut().zip(&mut watch.group_last_state) {
            // A stop that has been told is not told again after the gap.
            if stalled.take().is_some() {
                *last = NO_STATE;
            }
        }
        watch.next_deadline = Nanoseconds::MAX;
        watch.resynchronise = true;
        watch.values.doubt();
        self.lanes.forget_entries();
        let finding = message::gap(start, end);
        self.findings.push(finding);
        std::mem::take(&mut self.findings)
    }

    /// The log has ended: completes the running scan. Open paths stay suspected.
    pub fn finish(&mut self) -> Vec<Finding> {
        self.complete_scan();
        std::mem::take(&mut self.findings)
    }

    /// Snapshots of the whole plant made since the last call.
    pub fn take_snapshots(&mut self) -> Vec<Snapshot> {
        std::mem::take(&mut self.watch.snapshots)
    }

    /// Everything needed to go on later, compactly.
    pub fn save(&self) -> Vec<u8> {
        let saved = Saved {
            version: STATE_VERSION,
            fingerprint: self.model.fingerprint(),
            watch: self.watch.clone(),
            counters: self.lanes.counters(),
        };
        saved_state::sealed(&saved)
    }

    /// Goes on from a saved state.
    ///
    /// # Errors
    /// Damaged bytes, another version, or the state of another model.
    pub fn restore(model: Arc<NominalModel>, bytes: &[u8]) -> Result<Self, MonitorError> {
        let body = saved_state::unsealed(bytes).ok_or(MonitorError::Damaged)?;
        let saved: Saved = postcard::from_bytes(body).map_err(|_| MonitorError::Damaged)?;
        if saved.version != STATE_VERSION {
            return Err(MonitorError::Damaged);
        }
        if saved.fingerprint != model.fingerprint() {
            return Err(MonitorError::OtherModel);
        }
        let mut monitor = Self::new(model);
        monitor.watch = saved.watch;
        if !monitor.lanes.set_counters(&saved.counters) {
            return Err(MonitorError::Damaged);
        }
        Ok(monitor)
    }

    fn check_order(&self, rows: &[Row]) -> Result<(), MonitorError> {
        let mut newest = self.watch.now;
        for (index, row) in rows.iter().enumerate() {
            if row.time < newest {
                let late_s = newest.saturating_sub(row.time) as f64 / SECOND as f64;
                return Err(MonitorError::Order { row: index + 1, late_s: format!("{late_s:.3}") });
            }
            newest = row.time;
        }
        Ok(())
    }

    /// After a gap, a group that was moving before it is given its time to stall anew: a machine
    /// that stopped unseen would otherwise never be told.
    fn resume_clocks(&mut self, time: Nanoseconds) {
        let watch = &mut self.watch;
        for (group, last) in watch.group_last.iter_mut().enumerate() {
            if *last == Nanoseconds::MAX && watch.group_last_state[group] != NO_STATE {
                *last = time;
                let deadline = time.saturating_add(self.stall_after[group]);
                watch.next_deadline = watch.next_deadline.min(deadline);
            }
        }
    }

    /// Name of a state, also of one first met while watching.
    pub(super) fn state_name(&self, state: StateId) -> String {
        let (signal, value) = self.signal_value(state);
        super::states::full_state_name(&self.model.plant, signal, value)
    }

    fn signal_value(&self, state: StateId) -> (SignalIndex, i64) {
        let known = self.model.states.len();
        if (state as usize) < known {
            self.model.states.signal_value(state)
        } else {
            self.watch.further[state as usize - known]
        }
    }

    /// One chain moves on to a state.
    #[inline]
    fn step(&mut self, chain: ChainIndex, kind: ChainKind, event: Entry) {
        let here = &mut self.watch.here[chain];
        let from = std::mem::replace(here, Here { state: event.state, since: event.time });
        if from.state == NO_STATE {
            return;
        }
        match self.lanes.find(kind, from.state, event.state) {
            Some(lane) => {
                let timed = self.timed(lane, from.since, event);
                let in_time = if timed.as_learned {
                    self.lanes.take(lane, timed.took)
                } else {
                    self.take_without_trigger(lane, timed)
                };
                if !in_time {
                    let rule = self.lanes.rule(lane);
                    self.report_time(chain, kind, rule, event.time, timed);
                }
                if self.watch.off_path[chain] {
                    self.known_step(chain, event.state, event.time);
                }
            }
            None if self.watch.off_path[chain] => self.unknown_step(chain, event.state),
            None => self.report_unknown(chain, kind, from, event),
        }
        if kind == ChainKind::Group {
            self.close_cycle(chain, event.state, event.time);
        }
    }

    /// How long a transition took: since what enables it, or, where that has not happened afresh,
    /// since the device's own last event.
    #[inline]
    fn timed(&self, lane: usize, own: Nanoseconds, event: Entry) -> Timed {
        if !self.lanes.waits(lane) {
            return Timed::new(own, event.time, true);
        }
        match self.lanes.due(lane, event.before, own) {
            Some(due) => Timed::new(due, event.time, true),
            None => Timed::new(own, event.time, false),
        }
    }

    /// A known transition that happened without its enabling event, judged by the device's own
    /// times.
    fn take_without_trigger(&mut self, lane: usize, timed: Timed) -> bool {
        let accepted = self.accepted(self.lanes.rule(lane), timed);
        let seconds = timed.seconds();
        let in_time = accepted.is_empty()
            || accepted.iter().any(|a| seconds >= a.early_s && seconds <= a.late_s);
        if in_time {
            self.lanes.take_untimed(lane);
        }
        in_time
    }

    /// Accepted times of a rule: since its enabling event, or without one.
    fn accepted(&self, rule: usize, timed: Timed) -> Vec<Accepted> {
        if timed.as_learned {
            self.model.accepted(rule)
        } else {
            self.model.accepted_without_trigger(rule)
        }
    }

    /// Paths that did not return in time, and groups that have stopped, in the order they fell due.
    fn pass_deadlines(&mut self, now: Nanoseconds) {
        if now < self.watch.next_deadline {
            return;
        }
        loop {
            let path = self.watch.open.iter().map(|open| open.deadline).min();
            let stall = (0..self.stall_after.len())
                .filter(|&g| self.watch.group_last[g] != Nanoseconds::MAX)
                .filter(|&g| self.watch.group_stalled[g].is_none())
                .map(|g| (self.watch.group_last[g].saturating_add(self.stall_after[g]), g))
                .min();
            match (path, stall) {
                (Some(due), later) if due <= now && later.is_none_or(|(t, _)| due <= t) => {
                    self.confirm_path(due);
                }
                (_, Some((due, group))) if due <= now => self.report_stall(group, due),
                (path, stall) => {
                    let next = [path, stall.map(|(due, _)| due)];
                    self.watch.next_deadline =
                        next.into_iter().flatten().min().unwrap_or(Nanoseconds::MAX);
                    return;
                }
            }
        }
    }

    /// A group cycle may have closed: then probabilities and averages may be due for a check.
    fn close_cycle(&mut self, chain: ChainIndex, state: StateId, time: Nanoseconds) {
        let group = self.model.chains.group_of(chain);
        if state != self.model.learned.group_start[group] {
            return;
        }
        self.watch.group_cycles[group] += 1;
        if self.watch.group_cycles[group]
            .is_multiple_of(u64::from(self.model.parameters.check_every))
        {
            self.check(group, time);
        }
    }
}
