//! The usual case, and the only one that must be fast: a boolean changes, its chains know the
//! transition, and nothing departs. Nothing is changed before that is certain; whatever is not
//! usual goes the long way through [`Monitor::take_next`], which comes to the same.

use std::ops::Range;

use crate::log::Nanoseconds;
use crate::signal_state::chains::ChainIndex;
use crate::signal_state::found::Timed;
use crate::signal_state::lanes::{Lanes, Usual};
use crate::signal_state::model::NominalModel;
use crate::signal_state::order::ScanOrder;

use super::Monitor;
use super::batch::Batch;
use super::marks::Mark;
use super::watch::{Here, Watch};

/// How many rows ahead of its turn a row's lane is fetched, and what stands beside the lane. The
/// memory behind a big plant's lanes is the cost of watching it, unless it is asked for in time.
const FAR: usize = 16;
const NEAR: usize = 8;
/// Rows that are marked at once.
const BLOCK: usize = 1024;

/// What one usual row comes to.
#[derive(Clone, Copy)]
struct Step {
    group: u32,
    of_device: Usual,
    /// Where the group's chain moves too.
    of_group: Option<Usual>,
}

/// A usual step of a group's chain.
#[derive(Debug, Clone, Copy, Default)]
struct GroupStep {
    chain: ChainIndex,
    usual: Usual,
}

impl Monitor {
    /// Takes rows in time order, none of them before one already watched.
    pub(super) fn take_batch<B: Batch>(&mut self, batch: B) {
        let scan = self.shortest_scan();
        let mut marked = std::mem::take(&mut self.marked);
        let mut at = 0;
        while at < batch.len() {
            let block = at..batch.len().min(at + BLOCK);
            self.marks.mark(batch, at..block.end + FAR, scan, &mut marked);
            while at < block.end {
                let to = self.take_usual_rows(batch, at..block.end, &marked[at - block.start..]);
                if let Some(time) = batch.time(to.wrapping_sub(1)).filter(|_| to > at) {
                    self.watch.now = time;
                }
                at = to;
                if at < block.end {
                    at += self.take_next(batch, at);
                }
            }
        }
        self.marked = marked;
    }

    /// Takes rows as long as all is usual; returns the place of the first not taken.
    fn take_usual_rows<B: Batch>(
        &mut self,
        batch: B,
        range: Range<usize>,
        marks: &[Mark],
    ) -> usize {
        let Range { start, end } = range;
        if !self.watch.pending.is_empty() || !self.watch.started || self.watch.resynchronise {
            return start;
        }
        let mut at = start;
        while at < end {
            let until = self.before_deadline(batch, at..end);
            at = self.take_rows_in_turn(batch, at..until, &marks[at - start..]);
            let &[mark, after, ..] = &marks[at - start..] else { return at };
            let two = at < until && mark.shares() && self.are_two(batch, at);
            if !two || !self.take_two(batch, at, [mark, after]) {
                return at;
            }
            at += 2;
        }
        at
    }

    /// How far rows go before something else is due.
    fn before_deadline<B: Batch>(&self, batch: B, Range { start, end }: Range<usize>) -> usize {
        let due = |at| batch.time(at).is_some_and(|time| time >= self.watch.next_deadline);
        if !due(end - 1) {
            return end;
        }
        let (mut low, mut high) = (start, end - 1);
        while low < high {
            let middle = low.midpoint(high);
            if due(middle) { high = middle } else { low = middle + 1 }
        }
        low
    }

    /// True where a scan is over after the second of its rows.
    #[inline(always)]
    fn are_two<B: Batch>(&self, batch: B, at: usize) -> bool {
        let times = batch.time(at).zip(batch.time(at + 2));
        times.is_some_and(|(first, third)| self.is_over(first, third))
    }

    /// Takes rows one after the other as long as all is usual; returns the place of the first not
    /// taken. `marks` go [`FAR`] beyond the rows.
    #[inline(never)]
    fn take_rows_in_turn<B: Batch>(
        &mut self,
        batch: B,
        range: Range<usize>,
        marks: &[Mark],
    ) -> usize {
        let Self { model, lanes, watch, order, .. } = self;
        let Watch { values, here, clocks, .. } = watch;
        let (here, clocks) = (here.as_mut_slice(), clocks.as_mut_slice());
        // Told once for all rows: an option for each would cost a twentieth.
        let mut of_group = GroupStep::default();
        let rows = marks.windows(FAR + 1).zip(batch.times(range.clone()));
        for ((marks, time), at) in rows.zip(range.clone()) {
            let mark = marks[0];
            lanes.fetch(marks[FAR].state());
            lanes.fetch_side(marks[NEAR].state());
            let state = mark.state();
            if !values.changes(state) {
                return at;
            }
            if !mark.is_alone()
                && !are_pair((model, lanes), order.as_ref(), (batch, at), [mark, marks[1]])
            {
                return at;
            }
            if mark.starts() {
                let chain = model.chains.chain_of_group(model.chains.group_of(mark.device()));
                let step = usual_of_group(lanes, here[chain], mark, time);
                let Some(usual) = step else { return at };
                of_group = GroupStep { chain, usual };
            }
            let Some(stands) = here.get_mut(mark.device()) else { return at };
            let Some(clock) = clocks.get_mut(stands.clock as usize) else { return at };
            if !clock.runs {
                return at;
            }
            let since = if mark.waits() {
                lanes.due(state as usize, lanes.last_entry(state), stands.since)
            } else {
                Some(stands.since)
            };
            // A time below zero is longer than can be told, or of a scan whose order was mended.
            let took = since.map(|since| time.wrapping_sub(since)).filter(|&took| took >= 0);
            let first = took.is_some_and(|took| lanes.take_first(state, stands.state, time, took));
            // A rarer transition may wait for the other of its pair.
            if !first && (mark.shares() || !lanes.take_any(stands.state, state, stands.since, time))
            {
                return at;
            }
            values.take_change(state);
            stands.enter(state, time);
            (clock.last, clock.state) = (time, state);
            if mark.starts() {
                lanes.take(of_group.usual);
                here[of_group.chain].enter(state, time);
            }
        }
        range.end
    }

    /// Two rows of one scan that are steps of different chains; false, and nothing taken, where they
    /// are not.
    #[inline(never)]
    fn take_two<B: Batch>(&mut self, batch: B, at: usize, [mark, other]: [Mark; 2]) -> bool {
        let (Some(time), Some(later)) = (batch.time(at), batch.time(at + 1)) else { return false };
        if mark.device() == other.device() {
            return false;
        }
        // Either may wait for the other: both are entered before either is judged.
        let before = self.lanes.enter(mark.state(), time);
        let before_other = self.lanes.enter(other.state(), later);
        let step = self.usual_step(mark, time, before);
        let steps = step.zip(self.usual_step(other, later, before_other));
        let one_group = |(step, other): &(Step, Step)| {
            step.group == other.group && step.of_group.is_some() && other.of_group.is_some()
        };
        let Some((step, other_step)) = steps.filter(|steps| !one_group(steps)) else {
            self.lanes.enter(other.state(), before_other);
            self.lanes.enter(mark.state(), before);
            return false;
        };
        // Their group remembers the last.
        let swaps =
            |order: &ScanOrder| order.swaps((time, mark.state() / 2), (later, other.state() / 2));
        if self.order.as_ref().is_some_and(swaps) {
            self.take_step(other, later, other_step);
            self.take_step(mark, time, step);
        } else {
            self.take_step(mark, time, step);
            self.take_step(other, later, other_step);
        }
        true
    }

    /// What a row comes to whose state was entered before at `before`; `None` where anything about
    /// it is not usual, or something else is due before it.
    #[inline(always)]
    fn usual_step(&self, mark: Mark, time: Nanoseconds, before: Nanoseconds) -> Option<Step> {
        let Self { model, lanes, watch, .. } = self;
        let state = mark.state();
        let stands = *watch.here.get(mark.device())?;
        let group = stands.clock;
        let clock = watch.clocks.get(group as usize)?;
        if mark.is_odd()
            || !clock.runs
            || time >= watch.next_deadline
            || !watch.values.changes(state)
        {
            return None;
        }
        let times = [before, stands.since, time];
        let of_device = lanes.usual_of_device(stands.state, state, times)?;
        let of_group = if mark.starts() {
            let from = watch.here[model.chains.chain_of_group(group as usize)];
            Some(usual_of_group(lanes, from, mark, time)?)
        } else {
            None
        };
        Some(Step { group, of_device, of_group })
    }

    /// Takes a row whose state has been entered.
    #[inline(always)]
    fn take_step(&mut self, mark: Mark, time: Nanoseconds, step: Step) {
        let (state, group) = (mark.state(), step.group as usize);
        self.lanes.take(step.of_device);
        let watch = &mut self.watch;
        watch.values.take_change(state);
        watch.here[mark.device()].enter(state, time);
        if let Some(of_group) = step.of_group {
            self.lanes.take(of_group);
            watch.here[self.model.chains.chain_of_group(group)].enter(state, time);
        }
        // Its clock runs already, and what it is to stall by is not earlier than it was.
        let clock = &mut watch.clocks[group];
        (clock.last, clock.state) = (time, state);
    }
}

/// True where the rows at a place and after it are a scan of their own and can be taken one after
/// the other: they are of different devices, the first does not wait for the second, and their
/// group's clock and chain see them in the order they are in.
#[inline(never)]
fn are_pair<B: Batch>(
    (model, lanes): (&NominalModel, &Lanes),
    order: Option<&ScanOrder>,
    (batch, at): (B, usize),
    [one, other]: [Mark; 2],
) -> bool {
    let at_once = batch.time(at) == batch.time(at + 1);
    if one.is_odd() || !other.is_alone() || !at_once || one.device() == other.device() {
        return false;
    }
    if one.waits() && lanes.waits_for(one.state(), other.state()) {
        return false;
    }
    let group = |mark: Mark| model.chains.group_of(mark.device());
    let both_start = one.starts() && other.starts();
    let swaps = |order: &ScanOrder| order.swaps((0, one.state() / 2), (0, other.state() / 2));
    group(one) != group(other) || !(both_start || order.is_some_and(swaps))
}

/// The step of a group's chain that stands somewhere, in a row.
#[inline(never)]
fn usual_of_group(lanes: &Lanes, from: Here, mark: Mark, time: Nanoseconds) -> Option<Usual> {
    if from.off_path() {
        return None;
    }
    let lane = lanes.find_starting(mark.device(), from.state, mark.state())?;
    lanes.usual_of_group(lane, Timed::new(from.since, time, true).took)
}
