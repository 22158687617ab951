//! Watching a plant against its nominal model (Ghosh 2016, section 2.6), as decided in the design.
//!
//! Two verbs: [`Monitor::observe`] takes rows in time order, [`Monitor::advance`] says that time
//! went on. Rows are held until their scan is complete, so any split of a log into batches gives
//! the same findings. All state is plain data and serialises.

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::finding::{Expected, Finding, Kind, Model, Severity, State, stable_id};
use crate::log::{Nanoseconds, SECOND, SignalIndex};
use crate::timing::limits::Accepted;

use super::chains::{ChainIndex, ChainKind};
use super::enabling::Trigger;
use super::events::{Meaning, Row, Values, is_image};
use super::incident::{Incident, Occurrence};
use super::lanes::{Counters, Lanes};
use super::message;
use super::model::NominalModel;
use super::order::ScanOrder;
use super::parameters::Timing;
use super::rules::row_of;
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
/// A state not entered since the start or a gap.
const NEVER: Nanoseconds = Nanoseconds::MIN;
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
    /// Per state: when it was last entered, for transitions it enables.
    entered: Vec<Nanoseconds>,
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

const STATE_VERSION: u32 = 1;

/// A state is entered.
#[derive(Debug, Clone, Copy)]
struct Entry {
    state: StateId,
    time: Nanoseconds,
    /// When the same state was entered before.
    before: Nanoseconds,
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
    scratch: Vec<(ChainIndex, u32)>,
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
            entered: vec![NEVER; model.states.len()],
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
            lanes: Lanes::of(&model),
            watch,
            findings: Vec::new(),
            scratch: Vec::new(),
            model,
        }
    }

    /// The model it watches against.
    pub fn model(&self) -> &Arc<NominalModel> {
        &self.model
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
        let mut newest = self.watch.now;
        for (index, row) in rows.iter().enumerate() {
            if row.time < newest {
                let late_s = newest.saturating_sub(row.time) as f64 / SECOND as f64;
                return Err(MonitorError::Order { row: index + 1, late_s: format!("{late_s:.3}") });
            }
            newest = row.time;
        }
        let mut rest = rows;
        while let [row, after @ ..] = rest {
            match after {
                [next, ..] if self.stands_alone(*row, *next) => self.take_alone(*row),
                _ => self.take(*row),
            }
            rest = after;
        }
        Ok(std::mem::take(&mut self.findings))
    }

    /// Time went on to `now` without a change: completes the running scan, finds stalls and paths
    /// that did not return.
    pub fn advance(&mut self, now: Nanoseconds) -> Vec<Finding> {
        if self.scan_is_over(now) {
            self.complete_scan();
        }
        if now > self.watch.now {
            self.watch.now = now;
            self.pass_deadlines(now);
        }
        std::mem::take(&mut self.findings)
    }

    /// Nothing was recorded from `start` to `end`: what follows has no predecessor.
    pub fn gap(&mut self, start: Nanoseconds, end: Nanoseconds) -> Vec<Finding> {
        self.complete_scan();
        let watch = &mut self.watch;
        watch.now = watch.now.max(end);
        watch.here.fill(NOWHERE);
        watch.entered.fill(NEVER);
        watch.off_path.fill(false);
        watch.open.clear();
        watch.group_last.fill(Nanoseconds::MAX);
        watch.group_stalled.fill(None);
        watch.next_deadline = Nanoseconds::MAX;
        watch.resynchronise = true;
        watch.values.doubt();
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
        let mut bytes = postcard::to_stdvec(&saved).unwrap_or_default();
        let checksum = xxhash_rust::xxh3::xxh3_64(&bytes);
        bytes.extend_from_slice(&checksum.to_le_bytes());
        bytes
    }

    /// Goes on from a saved state.
    ///
    /// # Errors
    /// Damaged bytes, another version, or the state of another model.
    pub fn restore(model: Arc<NominalModel>, bytes: &[u8]) -> Result<Self, MonitorError> {
        let (body, checksum) = bytes.split_last_chunk::<8>().ok_or(MonitorError::Damaged)?;
        if xxhash_rust::xxh3::xxh3_64(body) != u64::from_le_bytes(*checksum) {
            return Err(MonitorError::Damaged);
        }
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

    /// True where a row is a scan of its own and nothing else is due before it.
    #[inline]
    fn stands_alone(&self, row: Row, next: Row) -> bool {
        let age = next.time.saturating_sub(row.time);
        self.watch.pending.is_empty()
            && age > 0
            && age >= self.model.learned.scan_window
            && row.time < self.watch.next_deadline
            && self.watch.started
            && !self.watch.resynchronise
            && (row.signal as usize) < self.model.plant.signals.len()
    }

    /// What [`Self::take`] comes to for a row that stands alone.
    #[inline]
    fn take_alone(&mut self, row: Row) {
        self.watch.now = row.time;
        match self.watch.values.take(row.signal, row.value) {
            Meaning::Event => self.step_event(row),
            Meaning::Doubtful => self.lose_sight(row.signal),
            Meaning::Sample => {}
        }
    }

    fn take(&mut self, row: Row) {
        if self.scan_is_over(row.time) {
            self.complete_scan();
        }
        if row.time > self.watch.now {
            self.watch.now = row.time;
        }
        if row.time >= self.watch.next_deadline {
            // Whatever is due before this row is older than it, so the running scan is over too.
            self.complete_scan();
            self.pass_deadlines(row.time);
        }
        self.watch.pending.push(row);
    }

    fn scan_is_over(&self, time: Nanoseconds) -> bool {
        let window = self.model.learned.scan_window;
        self.watch.pending.first().is_some_and(|first| {
            let age = time.saturating_sub(first.time);
            age > 0 && age >= window
        })
    }

    /// Processes the rows of the running scan.
    fn complete_scan(&mut self) {
        let mut rows = std::mem::take(&mut self.watch.pending);
        let Some(first) = rows.first().copied() else {
            return;
        };
        if !self.watch.started {
            self.watch.started = true;
            let of_first_time = rows.iter().take_while(|row| row.time == first.time);
            self.watch.resynchronise = is_image(of_first_time.map(|row| row.value));
        }
        let resynchronise_until = self.watch.resynchronise.then_some(first.time);
        self.watch.resynchronise = false;
        let known = self.model.plant.signals.len() as SignalIndex;
        let mut events = 0;
        for index in 0..rows.len() {
            let row = rows[index];
            if row.signal >= known {
                self.report_unknown_signal(row);
                continue;
            }
            match self.watch.values.take(row.signal, row.value) {
                Meaning::Event if resynchronise_until != Some(row.time) => {
                    rows[events] = row;
                    events += 1;
                }
                Meaning::Doubtful => self.lose_sight(row.signal),
                Meaning::Event | Meaning::Sample => {}
            }
        }
        rows.truncate(events);
        if let Some(order) = &self.order {
            order.sort(&mut rows);
        }
        match rows.as_slice() {
            [] => {}
            [only] => self.step_event(*only),
            _ => self.step_scan(&rows),
        }
        rows.clear();
        self.watch.pending = rows;
    }

    /// The state of a signal's device is in doubt: what follows has no predecessor.
    fn lose_sight(&mut self, signal: SignalIndex) {
        let device = self.model.chains.device_chain(signal);
        for chain in [Some(device), self.model.chains.group_chain(signal)].into_iter().flatten() {
            self.watch.here[chain] = NOWHERE;
        }
    }

    fn step_event(&mut self, row: Row) {
        let entry = self.enter(row);
        let group = self.model.chains.group_chain(row.signal);
        self.step(self.model.chains.device_chain(row.signal), ChainKind::Device, entry);
        if let Some(chain) = group {
            self.step(chain, ChainKind::Group, entry);
        }
    }

    /// Several events of one scan: each chain may take its own in whichever order it knows.
    fn step_scan(&mut self, rows: &[Row]) {
        let mut by_chain = std::mem::take(&mut self.scratch);
        by_chain.clear();
        let entries: Vec<Entry> = rows.iter().map(|row| self.enter(*row)).collect();
        for (index, row) in (0..).zip(rows) {
            by_chain.push((self.model.chains.device_chain(row.signal), index));
            by_chain.extend(self.model.chains.group_chain(row.signal).map(|chain| (chain, index)));
        }
        by_chain.sort_by_key(|(chain, _)| *chain);
        for run in by_chain.chunk_by(|a, b| a.0 == b.0) {
            let chain = run[0].0;
            let kind = self.model.chains.kind(chain);
            if let [(_, only)] = run {
                self.step(chain, kind, entries[*only as usize]);
                continue;
            }
            let mut events: Vec<Entry> =
                run.iter().map(|&(_, index)| entries[index as usize]).collect();
            if self.order.is_some() {
                self.reorder(chain, kind, &mut events);
            }
            for event in events {
                self.step(chain, kind, event);
            }
        }
        self.scratch = by_chain;
    }

    /// Puts the events of one scan into an order the chain knows, if there is one.
    fn reorder(&self, chain: ChainIndex, kind: ChainKind, events: &mut [Entry]) {
        if events.len() < 2 || events.len() > REORDER_AT_MOST || self.knows(chain, kind, events) {
            return;
        }
        let mut order: Vec<usize> = Vec::with_capacity(events.len());
        if self.find_order(self.watch.here[chain].state, kind, events, &mut order) {
            let found: Vec<_> = order.iter().map(|&index| events[index]).collect();
            events.copy_from_slice(&found);
        }
    }

    fn knows(&self, chain: ChainIndex, kind: ChainKind, events: &[Entry]) -> bool {
        let mut state = self.watch.here[chain].state;
        events.iter().all(|event| {
            let known = state == NO_STATE
                || self.model.table.find(row_of(state, kind), event.state).is_some();
            state = event.state;
            known
        })
    }

    /// Depth-first over the orders in which every transition is known; rows of one signal keep
    /// their order.
    fn find_order(
        &self,
        state: StateId,
        kind: ChainKind,
        events: &[Entry],
        order: &mut Vec<usize>,
    ) -> bool {
        if order.len() == events.len() {
            return true;
        }
        for index in 0..events.len() {
            let next = events[index].state;
            let signal = self.signal_value(next).0;
            let waits = (0..index).any(|earlier| {
                !order.contains(&earlier) && self.signal_value(events[earlier].state).0 == signal
            });
            let known =
                state == NO_STATE || self.model.table.find(row_of(state, kind), next).is_some();
            if order.contains(&index) || waits || !known {
                continue;
            }
            order.push(index);
            if self.find_order(next, kind, events, order) {
                return true;
            }
            order.pop();
        }
        false
    }

    fn intern(&mut self, signal: SignalIndex, value: i64) -> StateId {
        if let Some(state) = self.model.states.find(signal, value) {
            return state;
        }
        let known = self.model.states.len();
        let further = &mut self.watch.further;
        let place = further.iter().position(|&f| f == (signal, value)).unwrap_or_else(|| {
            if further.len() < FURTHER_STATES_AT_MOST {
                further.push((signal, value));
            }
            further.len() - 1
        });
        (known + place) as StateId
    }

    /// Keeps when a state was entered, and when and where its group last moved.
    #[inline]
    fn enter(&mut self, row: Row) -> Entry {
        let state = self.intern(row.signal, row.value);
        let before = if self.lanes.tracks(state) {
            std::mem::replace(&mut self.watch.entered[state as usize], row.time)
        } else {
            NEVER
        };
        let chains = &self.model.chains;
        let group = chains.group_of(chains.device_chain(row.signal));
        self.watch.group_last[group] = row.time;
        self.watch.group_last_state[group] = state;
        let deadline = row.time.saturating_add(self.stall_after[group]);
        if deadline < self.watch.next_deadline {
            self.watch.next_deadline = deadline;
        }
        if self.watch.group_stalled[group].is_some() {
            self.stall_returned(group, row.time);
        }
        Entry { state, time: row.time, before }
    }

    #[cold]
    fn stall_returned(&mut self, group: usize, time: Nanoseconds) {
        if let Some(mut stall) = self.watch.group_stalled[group].take() {
            stall.state = State::Returned;
            stall.time = time;
            stall.message = message::stall_returned(&stall);
            self.findings.push(stall);
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
        match self.lanes.find(self.model.table.row(row_of(from.state, kind)), event.state) {
            Some(rule) => {
                let timed = self.timed(rule, from.since, event);
                let in_time = if timed.as_learned {
                    self.lanes.take(rule, timed.took)
                } else {
                    self.take_without_trigger(rule, timed)
                };
                if !in_time {
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
    fn timed(&self, rule: usize, own: Nanoseconds, event: Entry) -> Timed {
        if !self.lanes.waits(rule) {
            return Timed::new(own, event.time, true);
        }
        match Trigger::due(self.lanes.trigger(rule), &self.watch.entered, event.before, own) {
            Some(due) => Timed::new(due, event.time, true),
            None => Timed::new(own, event.time, false),
        }
    }

    /// A transition that happened without its enabling event, judged by the device's own times.
    fn take_without_trigger(&mut self, rule: usize, timed: Timed) -> bool {
        let accepted = self.accepted(rule, timed);
        let seconds = timed.seconds();
        let in_time = accepted.is_empty()
            || accepted.iter().any(|a| seconds >= a.early_s && seconds <= a.late_s);
        if in_time {
            self.lanes.take_untimed(rule);
        }
        in_time
    }

    /// Accepted times of a rule: since its enabling event, or without one.
    fn accepted(&self, rule: usize, timed: Timed) -> &[Accepted] {
        if timed.as_learned {
            &self.model.accepted[rule]
        } else {
            self.model.accepted_without.get(&rule).map_or(&[], Vec::as_slice)
        }
    }

    fn nearest_maximum(&self, rule: usize, seconds: f64) -> Option<usize> {
        let clusters = &self.model.rules[rule].clusters;
        (0..clusters.len()).min_by(|&a, &b| {
            let distance = |c: usize| (clusters[c].maximum_s - seconds).abs();
            distance(a).total_cmp(&distance(b))
        })
    }

    fn report_time(
        &mut self,
        chain: ChainIndex,
        kind: ChainKind,
        rule: usize,
        time: Nanoseconds,
        timed: Timed,
    ) {
        let model = Arc::clone(&self.model);
        let seconds = timed.seconds();
        let (found, limit_s) = match model.parameters.timing {
            Timing::Plat => {
                let limits = &model.accepted[rule];
                let cluster = self.nearest_maximum(rule, seconds);
                (Kind::Late, cluster.map_or(f64::INFINITY, |cluster| limits[cluster].late_s))
            }
            Timing::Adaptive => broken_limit(self.accepted(rule, timed), seconds),
        };
        let affordable = model.parameters.timing == Timing::Plat
            || model.evidence.odd_time(&model.rules[rule], seconds) <= model.budget.per_time;
        let mut finding = self.at(found, chain, kind, model.rules[rule].next, time);
        finding.severity = if affordable { Severity::Anomaly } else { Severity::Notice };
        finding.from = Some(self.state_name(model.rules[rule].current));
        finding.expected = vec![Expected {
            state: self.state_name(model.rules[rule].next),
            probability: model.rules[rule].probability,
            limit_s: self.accepted(rule, timed).iter().map(|a| a.late_s).reduce(f64::max),
        }];
        finding.observed_s = Some(seconds);
        finding.limit_s = Some(limit_s);
        finding.suspects = message::time_suspects(&model, rule);
        finding.message = message::time(&model, rule, timed.as_learned, &finding);
        self.place(finding, chain, kind, timed.since);
    }

    fn report_unknown(
        &mut self,
        chain: ChainIndex,
        kind: ChainKind,
        Here { state: from, since }: Here,
        Entry { state: to, time, .. }: Entry,
    ) {
        let model = Arc::clone(&self.model);
        let unseen = if model.parameters.timing == Timing::Plat {
            0.0
        } else {
            model.evidence.unknown_transition(&model.rules, &model.table, chain, kind, from)
        };
        let mut finding = self.at(Kind::Transition, chain, kind, to, time);
        finding.severity =
            if unseen <= model.budget.per_transition { Severity::Fault } else { Severity::Notice };
        finding.state = State::Suspected;
        finding.from = Some(self.state_name(from));
        finding.expected = self.expected_from(from, kind);
        finding.observed_s = Some(time.saturating_sub(since).max(0) as f64 / SECOND as f64);
        finding.path = vec![self.state_name(from), self.state_name(to)];
        finding.suspects = message::transition_suspects(&model, from, self.signal_value(to), kind);
        finding.message = message::transition(&model, from, &finding, kind);
        finding.id = stable_id(
            finding.kind,
            &self.place_name(chain),
            finding.from.as_deref().unwrap_or_default(),
            finding.to.as_deref().unwrap_or_default(),
            time,
        );
        let deadline = time.saturating_add(self.fresh_for);
        let placed = self.place(finding, chain, kind, since);
        self.watch.off_path[chain] = true;
        self.watch.next_deadline = self.watch.next_deadline.min(deadline);
        self.watch.open.push(OpenPath {
            chain,
            finding: placed,
            path: vec![from, to],
            deadline,
            known: 0,
        });
    }

    /// Expected successors of a state, most probable first.
    fn expected_from(&self, state: StateId, kind: ChainKind) -> Vec<Expected> {
        self.model
            .table
            .row(row_of(state, kind))
            .map(|rule| Expected {
                state: self.state_name(self.model.rules[rule].next),
                probability: self.model.rules[rule].probability,
                limit_s: self.model.latest_s(rule),
            })
            .collect()
    }

    /// A known transition while off the path: perhaps the device is back.
    fn known_step(&mut self, chain: ChainIndex, state: StateId, time: Nanoseconds) {
        let Some(index) = self.watch.open.iter().position(|open| open.chain == chain) else {
            self.watch.off_path[chain] = false;
            return;
        };
        let open = &mut self.watch.open[index];
        open.known += 1;
        if open.known < KNOWN_TO_RETURN {
            if open.path.len() < PATH_AT_MOST {
                open.path.push(state);
            }
            return;
        }
        let open = self.watch.open.remove(index);
        self.watch.off_path[chain] = false;
        // The known steps are no part of the alarm path.
        let path = &open.path[..open.path.len() - usize::from(open.known) + 1];
        let names: Vec<String> = path.iter().map(|&s| self.state_name(s)).collect();
        let mut returned = open.finding;
        returned.state = State::Returned;
        returned.time = time;
        returned.path = names;
        returned.message = message::returned(&returned);
        self.findings.push(returned.clone());
        self.offer(returned, chain);
    }

    /// Offers the path of an alarm for confirmation, each path once.
    fn offer(&mut self, returned: Finding, chain: ChainIndex) {
        if returned.severity == Severity::Notice {
            return;
        }
        let names = returned.path.join(" → ");
        let hash = xxhash_rust::xxh3::xxh3_64(names.as_bytes());
        if self.watch.offered.contains(&hash) || self.watch.offered.len() >= OFFERS_AT_MOST {
            return;
        }
        self.watch.offered.push(hash);
        let mut offer = returned;
        offer.kind = Kind::AlarmPath;
        offer.severity = Severity::Notice;
        offer.id = stable_id(offer.kind, &self.place_name(chain), &names, "", offer.time);
        offer.to = offer.path.last().cloned();
        offer.snapshot_id = None;
        offer.suspects.clear();
        offer.message = message::alarm_path(&offer);
        self.findings.push(offer);
    }

    /// Another unknown transition while off the path: the path grows, no new finding.
    fn unknown_step(&mut self, chain: ChainIndex, state: StateId) {
        if let Some(open) = self.watch.open.iter_mut().find(|open| open.chain == chain) {
            open.known = 0;
            if open.path.len() < PATH_AT_MOST {
                open.path.push(state);
            }
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

    fn confirm_path(&mut self, due: Nanoseconds) {
        let Some(index) = self.watch.open.iter().position(|open| open.deadline == due) else {
            return;
        };
        let open = self.watch.open.remove(index);
        self.watch.off_path[open.chain] = false;
        let mut finding = open.finding;
        finding.state = State::Confirmed;
        finding.time = due;
        finding.path = open.path.iter().map(|&s| self.state_name(s)).collect();
        finding.message = message::not_returned(&finding, self.model.parameters.return_within_s);
        self.findings.push(finding);
    }

    fn report_stall(&mut self, group: usize, due: Nanoseconds) {
        let model = Arc::clone(&self.model);
        let last = self.watch.group_last_state[group];
        let signal = self.signal_value(last).0;
        let device = model.chains.device_chain(signal);
        let since = self.watch.group_last[group];
        let mut finding = self.at(Kind::Stall, device, ChainKind::Device, last, due);
        finding.model = Model::Group;
        finding.severity = Severity::Fault;
        finding.from = Some(self.state_name(last));
        finding.to = None;
        finding.expected = self.expected_from(last, ChainKind::Device);
        let waited = self.stall_after[group] as f64 / SECOND as f64;
        finding.observed_s = Some(waited);
        finding.limit_s = Some(waited);
        finding.path = vec![self.state_name(last)];
        finding.suspects = message::stall_suspects(&model, last, signal);
        finding.message = message::stall(&finding);
        let placed = self.place(finding, device, ChainKind::Device, since);
        self.watch.group_stalled[group] = Some(placed);
    }

    fn report_unknown_signal(&mut self, row: Row) {
        let beyond = row.signal as usize - self.model.plant.signals.len();
        if let Some((name, named)) = self.watch.unknown_signals.get_mut(beyond)
            && !std::mem::replace(named, true)
        {
            let id = stable_id(Kind::UnknownSignal, name, "", "", row.time);
            self.findings.push(message::unknown_signal(name, id, row.time));
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

    fn check(&mut self, group: usize, time: Nanoseconds) {
        let model = Arc::clone(&self.model);
        let departures = super::check::departures(&model, group, &self.lanes);
        for departure in departures {
            let rule = &model.rules[departure.rule];
            let kind = model.chains.kind(rule.chain);
            let mut finding = self.at(departure.kind, rule.chain, kind, rule.next, time);
            finding.severity = Severity::Anomaly;
            finding.from = Some(self.state_name(rule.current));
            finding.expected = self.expected_from(rule.current, kind);
            finding.observed_s = Some(departure.observed);
            finding.limit_s = Some(departure.learned);
            finding.message = message::departure(&model, &departure, &finding);
            self.place(finding, rule.chain, kind, time);
        }
        for index in 0..model.rules.len() {
            if model.chains.group_of(model.rules[index].chain) == group {
                self.lanes.reset(index);
            }
        }
    }

    /// A finding of a kind at a chain, its state's signal filled in.
    fn at(
        &self,
        kind: Kind,
        chain: ChainIndex,
        chain_kind: ChainKind,
        state: StateId,
        time: Nanoseconds,
    ) -> Finding {
        let plant = &self.model.plant;
        let index = self.signal_value(state).0;
        let signal = &plant.signals[index as usize];
        Finding {
            id: String::new(),
            incident: String::new(),
            time,
            kind,
            severity: Severity::Notice,
            state: State::Confirmed,
            model: match chain_kind {
                ChainKind::Device => Model::Device,
                ChainKind::Group => Model::Group,
            },
            group: Some(self.model.group_name(chain).to_owned()),
            device: Some(plant.device_of(index).name.clone()),
            signal: Some(signal.name.clone()),
            address: signal.address.clone(),
            from: None,
            to: Some(self.state_name(state)),
            expected: Vec::new(),
            observed_s: None,
            limit_s: None,
            rank: None,
            suspects: Vec::new(),
            path: Vec::new(),
            snapshot_id: None,
            message: String::new(),
        }
    }

    fn place_name(&self, chain: ChainIndex) -> String {
        format!("{}/{}", self.model.group_name(chain), self.model.device_name(chain).unwrap_or(""))
    }

    /// Gives a finding its id and incident, makes the snapshot, and reports it.
    fn place(
        &mut self,
        mut finding: Finding,
        chain: ChainIndex,
        kind: ChainKind,
        waiting_since: Nanoseconds,
    ) -> Finding {
        if finding.id.is_empty() {
            finding.id = stable_id(
                finding.kind,
                &self.place_name(chain),
                finding.from.as_deref().unwrap_or_default(),
                finding.to.as_deref().unwrap_or_default(),
                finding.time,
            );
        }
        let group = self.model.chains.group_of(chain);
        let occurrence = Occurrence {
            id: &finding.id,
            kind: finding.kind,
            chain,
            chain_kind: kind,
            waiting_since,
            time: finding.time,
        };
        // What is no alarm itself explains none.
        let worth = finding.severity != Severity::Notice;
        let placement = if worth || self.watch.incidents[group].is_some() {
            Incident::place(&mut self.watch.incidents[group], occurrence, self.fresh_for)
        } else {
            super::incident::Placement { incident: finding.id.clone(), consequence: false }
        };
        if placement.consequence && self.order.is_some() {
            finding.severity = Severity::Notice;
        }
        let first = placement.incident == finding.id;
        finding.incident = placement.incident;
        if first && worth && matches!(finding.kind, Kind::Transition | Kind::Stall) {
            let snapshot = Snapshot::of(&self.model, &finding, |chain| {
                let here = self.watch.here[chain];
                (here.state != NO_STATE).then(|| (self.state_name(here.state), here.since))
            });
            finding.snapshot_id = Some(snapshot.id.clone());
            self.watch.snapshots.push(snapshot);
        }
        self.findings.push(finding.clone());
        finding
    }
}

/// Which limit a time broke, and where that limit lies.
fn broken_limit(accepted: &[Accepted], seconds: f64) -> (Kind, f64) {
    let late = accepted.iter().map(|a| a.late_s).filter(|&limit| limit < seconds).reduce(f64::max);
    let early =
        accepted.iter().map(|a| a.early_s).filter(|&limit| limit > seconds).reduce(f64::min);
    match (late, early) {
        (Some(late), Some(early)) if early - seconds < seconds - late => (Kind::Early, early),
        (Some(late), _) => (Kind::Late, late),
        (None, early) => (Kind::Early, early.unwrap_or(0.0)),
    }
}
