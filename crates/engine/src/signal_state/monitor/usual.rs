//! The usual case, and the only one that must be fast: a boolean changes, its chains know the
//! transition, and nothing departs. Nothing is changed before that is certain; whatever is not
//! usual goes the long way through [`Monitor::take_next`], which comes to the same.

use crate::log::Nanoseconds;
use crate::signal_state::chains::{ChainIndex, ChainKind};
use crate::signal_state::events::Row;
use crate::signal_state::found::Timed;
use crate::signal_state::lanes::Usual;
use crate::signal_state::states::StateId;

use super::Monitor;
use super::watch::Here;

/// How many rows before its turn a row's lane is fetched, and what stands beside the lane. The
/// memory behind a big plant's lanes is the cost of watching it, unless it is asked for in time.
const FAR: usize = 16;
const NEAR: usize = 8;

/// What one usual row comes to.
#[derive(Clone, Copy)]
struct Step {
    state: StateId,
    device: ChainIndex,
    clock: u32,
    of_device: Usual,
    /// Where the group's chain moves too.
    of_group: Option<(ChainIndex, Usual)>,
}

impl Monitor {
    /// Takes rows from one on, as long as all is usual; returns the place of the first not taken.
    pub(super) fn take_usual_rows(&mut self, rows: &[Row], from: usize) -> usize {
        if !self.watch.pending.is_empty() || !self.watch.started || self.watch.resynchronise {
            return from;
        }
        let scan = self.model.learned.scan_window.max(1) as u64;
        let over = |first: &Row, after: &Row| after.time.wrapping_sub(first.time) as u64 >= scan;
        let mut at = from;
        // The end of a scan shows in the row after it.
        while let Some([row, next]) = rows.get(at..at + 2) {
            self.fetch(rows, at);
            if over(row, next) {
                if !self.take_plain(*row) && !self.take_particular(*row) {
                    break;
                }
                at += 1;
            } else {
                let pair = rows.get(at + 2).is_some_and(|after| over(row, after));
                if !pair || !self.take_pair(*row, *next) {
                    break;
                }
                self.fetch(rows, at + 1);
                at += 2;
            }
        }
        if let Some(last) = rows[from..at].last() {
            self.watch.now = last.time;
        }
        at
    }

    /// At the turn of a row, fetches what rows to come will need: the first rows of all, which
    /// nothing was fetched for, are few.
    #[inline(always)]
    fn fetch(&self, rows: &[Row], at: usize) {
        let Some(far) = rows.get(at + FAR) else { return };
        self.lanes.fetch(boolean_state(far));
        self.lanes.fetch_side(boolean_state(&rows[at + NEAR]));
    }

    /// Takes a row that is a scan of its own and a step of its device alone, by the most frequent
    /// rule into its state; false, and nothing taken, where it is not.
    #[inline(always)]
    fn take_plain(&mut self, row: Row) -> bool {
        let Self { model, lanes, watch, .. } = self;
        if row.time >= watch.next_deadline {
            return false;
        }
        let Some(change) = watch.values.change(row.signal, row.value) else { return false };
        let state = 2 * row.signal + row.value as u32;
        let Some(lane) = lanes.plain(state) else { return false };
        let here = &mut watch.here[model.chains.device_chain(row.signal)];
        let Some(clock) = watch.clocks.get_mut(here.clock as usize) else { return false };
        let Some(since) = lane.since(here.since) else { return false };
        let took = row.time.wrapping_sub(since);
        // A time below zero is longer than can be told, or of a scan whose order was mended.
        if !clock.runs || took < 0 || !lane.take(here.state, row.time, took) {
            return false;
        }
        here.enter(state, row.time);
        (clock.last, clock.state) = (row.time, state);
        change.take();
        true
    }

    /// Takes any other usual row that is a scan of its own; false, and nothing taken, where it is not.
    #[inline(never)]
    fn take_particular(&mut self, row: Row) -> bool {
        let Some(state) = self.usual_state(row) else { return false };
        let Some(step) = self.usual_step(row, state, self.lanes.last_entry(state)) else {
            return false;
        };
        self.lanes.enter(state, row.time);
        self.take_step(row, step);
        true
    }

    /// Two rows of one scan that are steps of different chains; false, and nothing taken, where they
    /// are not.
    #[inline(never)]
    fn take_pair(&mut self, row: Row, next: Row) -> bool {
        let (Some(state), Some(other)) = (self.usual_state(row), self.usual_state(next)) else {
            return false;
        };
        let chains = &self.model.chains;
        let [devices, groups] = [
            [row, next].map(|row| Some(chains.device_chain(row.signal))),
            [row, next].map(|row| chains.group_chain(row.signal)),
        ];
        if [devices, groups].iter().any(|[one, other]| one.is_some() && one == other) {
            return false;
        }
        // Either may wait for the other: both are entered before either is judged.
        let before = self.lanes.enter(state, row.time);
        let before_other = self.lanes.enter(other, next.time);
        let steps = self.usual_step(row, state, before);
        let steps = steps.zip(self.usual_step(next, other, before_other));
        let Some((step, other_step)) = steps else {
            self.lanes.enter(other, before_other);
            self.lanes.enter(state, before);
            return false;
        };
        // Their group remembers the last.
        let swapped = self.order.as_ref().is_some_and(|order| order.swaps(&row, &next));
        let (first, second) = ((row, step), (next, other_step));
        for (row, step) in if swapped { [second, first] } else { [first, second] } {
            self.take_step(row, step);
        }
        true
    }

    /// The state that a boolean's change leads to; `None` where a row is none, or something else
    /// is due before it.
    #[inline(always)]
    fn usual_state(&mut self, row: Row) -> Option<StateId> {
        let watch = &mut self.watch;
        if row.time >= watch.next_deadline {
            return None;
        }
        watch.values.change(row.signal, row.value)?;
        Some(2 * row.signal + row.value as u32)
    }

    /// What a row comes to that leads to `state`, entered before at `before`; `None` where anything
    /// about it is not usual.
    #[inline(always)]
    fn usual_step(&self, row: Row, state: StateId, before: Nanoseconds) -> Option<Step> {
        let device = self.model.chains.device_chain(row.signal);
        let here = self.watch.here[device];
        let (lane, since) = self.known(here, ChainKind::Device, state)?;
        let waits = self.lanes.waits(lane);
        let since = if waits { self.lanes.due(lane, before, since)? } else { since };
        let of_device = self.lanes.usual(lane, Timed::new(since, row.time, true).took)?;
        let of_group = if self.lanes.starts(state) {
            let group = here.clock as usize;
            // The return to the first state closes a cycle.
            if state == self.model.learned.group_start[group] {
                return None;
            }
            let chain = self.model.chains.chain_of_group(group);
            let (lane, since) = self.known(self.watch.here[chain], ChainKind::Group, state)?;
            let took = Timed::new(since, row.time, true).took;
            Some((chain, self.lanes.usual_of_group(lane, took)?))
        } else {
            None
        };
        Some(Step { state, device, clock: here.clock, of_device, of_group })
    }

    /// The lane of a chain's known transition to a state, and since when the chain stood where it
    /// stands; `None` off the path, and where its group's clock does not run.
    #[inline(always)]
    fn known(&self, here: Here, kind: ChainKind, state: StateId) -> Option<(usize, Nanoseconds)> {
        self.watch.clocks.get(here.clock as usize).filter(|clock| clock.runs)?;
        Some((self.lanes.find(kind, here.state, state)?, here.since))
    }

    /// Takes a row whose state has been entered.
    #[inline(always)]
    fn take_step(&mut self, row: Row, step: Step) {
        self.lanes.take(step.of_device);
        let watch = &mut self.watch;
        if let Some(change) = watch.values.change(row.signal, row.value) {
            change.take();
        }
        watch.here[step.device].enter(step.state, row.time);
        if let Some((chain, of_group)) = step.of_group {
            self.lanes.take(of_group);
            watch.here[chain].enter(step.state, row.time);
        }
        // Its clock runs already, and what it is to stall by is not earlier than it was.
        let clock = &mut watch.clocks[step.clock as usize];
        (clock.last, clock.state) = (row.time, step.state);
    }
}

/// The state a row of a boolean leads to; the few words come as they come.
#[inline(always)]
fn boolean_state(row: &Row) -> usize {
    2 * row.signal as usize + (row.value & 1) as usize
}
