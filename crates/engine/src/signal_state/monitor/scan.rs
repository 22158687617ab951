//! From rows to steps: a scan is complete, its events have no order, each chain takes its own.

use crate::log::{Nanoseconds, SignalIndex};
use crate::signal_state::chains::{ChainIndex, ChainKind};
use crate::signal_state::events::{Meaning, Row, is_image};
use crate::signal_state::rules::row_of;
use crate::signal_state::states::{NO_STATE, StateId};

use super::batch::Batch;
use super::step::Entry;
use super::watch::Clock;
use super::{FURTHER_STATES_AT_MOST, Monitor, REORDER_AT_MOST};

impl Monitor {
    /// Takes the first of the rows, and those of its scan where that is complete; returns how many.
    #[inline]
    pub(super) fn take_next<B: Batch>(&mut self, batch: B, at: usize) -> usize {
        let Some(row) = batch.row(at) else { return 1 };
        if self.scan_is_over(row.time) {
            self.complete_scan();
        }
        let watch = &self.watch;
        if watch.pending.is_empty() && watch.started && !watch.resynchronise {
            let length = self.scan_length(batch, at, row.time);
            if length > 0
                && let Some(last) = batch.time(at + length - 1)
                && last < watch.next_deadline
            {
                if length == 1 && (row.signal as usize) < self.model.plant.signals.len() {
                    self.take_alone(row);
                } else {
                    self.watch.now = last;
                    self.watch.pending.extend(batch.rows(at..at + length));
                    self.complete_scan();
                }
                return length;
            }
        }
        self.take(row);
        1
    }

    /// Number of rows in the first scan of the rows; zero where they do not show its end.
    #[inline]
    fn scan_length<B: Batch>(&self, batch: B, at: usize, first: Nanoseconds) -> usize {
        let over = |time| self.is_over(first, time);
        batch.times(at..batch.len()).position(over).unwrap_or_default()
    }

    /// What [`Self::take`] comes to for a row that is a scan of its own.
    #[inline]
    fn take_alone(&mut self, row: Row) {
        self.watch.now = row.time;
        match self.watch.values.take(row.signal, row.value) {
            Meaning::Event => self.step_event(row),
            Meaning::Doubtful => self.lose_sight(row.signal),
            Meaning::Sample => {}
        }
    }

    pub(super) fn take(&mut self, row: Row) {
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

    pub(super) fn scan_is_over(&self, time: Nanoseconds) -> bool {
        self.watch.pending.first().is_some_and(|first| self.is_over(first.time, time))
    }

    /// True where a scan whose first row is of one time is over at another.
    #[inline(always)]
    pub(super) fn is_over(&self, first: Nanoseconds, time: Nanoseconds) -> bool {
        time.saturating_sub(first) >= self.shortest_scan()
    }

    /// How long after the first row of a scan a row is of another.
    #[inline(always)]
    pub(super) fn shortest_scan(&self) -> Nanoseconds {
        self.model.learned.scan_window.max(1)
    }

    /// Processes the rows of the running scan.
    pub(super) fn complete_scan(&mut self) {
        let mut rows = std::mem::take(&mut self.watch.pending);
        let Some(first) = rows.first().copied() else {
            return;
        };
        if !self.watch.started {
            self.watch.started = true;
            let of_first_time = rows.iter().take_while(|row| row.time == first.time);
            self.watch.resynchronise = is_image(of_first_time.map(|row| row.value));
        }
        let begins = self.watch.begins.take().unwrap_or(first.time);
        let resynchronise_until = self.watch.resynchronise.then_some(begins);
        if std::mem::replace(&mut self.watch.resynchronise, false) {
            self.resume_clocks(begins);
        }
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
    pub(super) fn lose_sight(&mut self, signal: SignalIndex) {
        let device = self.model.chains.device_chain(signal);
        for chain in [Some(device), self.model.chains.group_chain(signal)].into_iter().flatten() {
            self.watch.here[chain].forget();
        }
    }

    pub(super) fn step_event(&mut self, row: Row) {
        let (entry, device, group) = self.enter(row);
        self.step(device, ChainKind::Device, entry);
        if let Some(chain) = group {
            self.step(chain, ChainKind::Group, entry);
        }
    }

    /// Several events of one scan: each chain may take its own in whichever order it knows.
    pub(super) fn step_scan(&mut self, rows: &[Row]) {
        let mut steps = std::mem::take(&mut self.scratch);
        steps.clear();
        for row in rows {
            let (entry, device, group) = self.enter(*row);
            steps.push((device, entry));
            steps.extend(group.map(|chain| (chain, entry)));
        }
        steps.sort_by_key(|(chain, _)| *chain);
        let mut start = 0;
        while start < steps.len() {
            let (chain, entry) = steps[start];
            let kind = self.model.chains.kind(chain);
            let length = steps[start..].iter().take_while(|(other, _)| *other == chain).count();
            if length == 1 {
                self.step(chain, kind, entry);
            } else {
                self.step_together(chain, kind, &steps[start..start + length]);
            }
            start += length;
        }
        self.scratch = steps;
    }

    fn step_together(&mut self, chain: ChainIndex, kind: ChainKind, steps: &[(ChainIndex, Entry)]) {
        let mut events: Vec<Entry> = steps.iter().map(|(_, entry)| *entry).collect();
        if self.order.is_some() {
            self.reorder(chain, kind, &mut events);
        }
        for event in events {
            self.step(chain, kind, event);
        }
    }

    /// Puts the events of one scan into an order the chain knows, if there is one.
    pub(super) fn reorder(&self, chain: ChainIndex, kind: ChainKind, events: &mut [Entry]) {
        if events.len() < 2 || events.len() > REORDER_AT_MOST || self.knows(chain, kind, events) {
            return;
        }
        let mut order: Vec<usize> = Vec::with_capacity(events.len());
        if self.find_order(self.watch.here[chain].state, kind, events, &mut order) {
            let found: Vec<_> = order.iter().map(|&index| events[index]).collect();
            events.copy_from_slice(&found);
        }
    }

    pub(super) fn knows(&self, chain: ChainIndex, kind: ChainKind, events: &[Entry]) -> bool {
        let mut state = self.watch.here[chain].state;
        events.iter().all(|event| {
            let known = state == NO_STATE
                || self
                    .model
                    .table
                    .find(&self.model.rules, row_of(state, kind), event.state)
                    .is_some();
            state = event.state;
            known
        })
    }

    /// Depth-first over the orders in which every transition is known; rows of one signal keep
    /// their order.
    pub(super) fn find_order(
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
            let signal = self.teller().signal_value(next).0;
            let waits = (0..index).any(|earlier| {
                !order.contains(&earlier)
                    && self.teller().signal_value(events[earlier].state).0 == signal
            });
            let known = state == NO_STATE
                || self.model.table.find(&self.model.rules, row_of(state, kind), next).is_some();
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

    pub(super) fn intern(&mut self, signal: SignalIndex, value: i64) -> StateId {
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

    /// Keeps when a state was entered, and when and where its group last moved. Returns the chains
    /// that move with it, too.
    #[inline]
    pub(super) fn enter(&mut self, row: Row) -> (Entry, ChainIndex, Option<ChainIndex>) {
        let state = self.intern(row.signal, row.value);
        let before = self.lanes.enter(state, row.time);
        let chains = &self.model.chains;
        let device = chains.device_chain(row.signal);
        let group = chains.group_of(device);
        let group_chain = chains.group_chain(row.signal);
        self.watch.clocks[group] = Clock { last: row.time, state, runs: true };
        let deadline = row.time.saturating_add(self.stall_after[group]);
        if deadline < self.watch.next_deadline {
            self.watch.next_deadline = deadline;
        }
        if self.watch.group_stalled[group].is_some() {
            self.stall_returned(group, row.time);
        }
        (Entry { state, time: row.time, before }, device, group_chain)
    }
}
