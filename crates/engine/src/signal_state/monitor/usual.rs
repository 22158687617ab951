//! The usual case, and the only one that must be fast: a boolean changes, its chains know the
//! transition, and nothing departs. Nothing is changed before that is certain; whatever is not
//! usual goes the long way through [`Monitor::take_next`], which comes to the same.

use std::ops::Range;

use crate::log::Nanoseconds;
use crate::signal_state::chains::ChainKind;
use crate::signal_state::found::Timed;
use crate::signal_state::lanes::Usual;
use crate::signal_state::order::ScanOrder;

use super::Monitor;
use super::batch::Batch;
use super::marks::Mark;
use super::watch::Watch;

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

impl Monitor {
    /// Takes rows in time order, none of them before one already watched.
    pub(super) fn take_batch<B: Batch>(&mut self, batch: B) {
        let scan = self.shortest_scan();
        let mut marked = std::mem::take(&mut self.marked);
        let mut at = 0;
        while at < batch.len() {
            let block = at..batch.len().min(at + BLOCK);
            self.marks.mark(batch, at..batch.len().min(block.end + FAR), scan, &mut marked);
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
        loop {
            at = self.take_plain_rows(batch, at..end, &marks[at - start..]);
            if at >= end {
                return at;
            }
            let (mark, after) = (marks[at - start], marks.get(at - start + 1));
            let Some(time) = batch.time(at) else { return at };
            let rows = if !mark.shares() {
                usize::from(self.take_one(mark, time))
            } else if let Some(&after) = after.filter(|_| self.are_two(batch, at)) {
                2 * usize::from(self.take_two(batch, at, [mark, after]))
            } else {
                0
            };
            if rows == 0 {
                return at;
            }
            at += rows;
        }
    }

    /// True where a scan is over after the second of its rows.
    #[inline(always)]
    fn are_two<B: Batch>(&self, batch: B, at: usize) -> bool {
        let times = batch.time(at).zip(batch.time(at + 2));
        times.is_some_and(|(first, third)| self.is_over(first, third))
    }

    /// Takes plain rows that go by the most frequent rule into their state; returns the place of
    /// the first that is none or does not.
    #[inline(never)]
    fn take_plain_rows<B: Batch>(
        &mut self,
        batch: B,
        range: Range<usize>,
        marks: &[Mark],
    ) -> usize {
        let mut lanes = self.lanes.first();
        let Watch { values, here, clocks, next_deadline, .. } = &mut self.watch;
        let (here, clocks, deadline) = (here.as_mut_slice(), clocks.as_mut_slice(), *next_deadline);
        for (turn, (at, &mark)) in range.clone().zip(marks).enumerate() {
            if let Some(far) = marks.get(turn + FAR) {
                lanes.fetch(far.state());
                lanes.fetch_side(marks[turn + NEAR].state());
            }
            if !mark.is_plain() {
                return at;
            }
            let Some(time) = batch.time(at).filter(|&time| time < deadline) else { return at };
            let state = mark.state();
            if !values.changes(state) {
                return at;
            }
            let Some(here) = here.get_mut(mark.device()) else { return at };
            let Some(clock) = clocks.get_mut(here.clock as usize) else { return at };
            let since = if mark.waits() { lanes.due(state, here.since) } else { Some(here.since) };
            let Some(since) = since else { return at };
            let took = time.wrapping_sub(since);
            // A time below zero is longer than can be told, or of a scan whose order was mended.
            if !clock.runs || took < 0 || !lanes.take(state, here.state, time, took) {
                return at;
            }
            values.take_change(state);
            here.enter(state, time);
            (clock.last, clock.state) = (time, state);
        }
        range.end
    }

    /// Takes any other usual row that is a scan of its own; false, and nothing taken, where it is
    /// not.
    #[inline(never)]
    fn take_one(&mut self, mark: Mark, time: Nanoseconds) -> bool {
        let Some(step) = self.usual_step(mark, time, self.lanes.last_entry(mark.state())) else {
            return false;
        };
        self.lanes.enter(mark.state(), time);
        self.take_step(mark, time, step);
        true
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
        let lane = lanes.find(ChainKind::Device, stands.state, state)?;
        let waits = lanes.waits(lane);
        let since = if waits { lanes.due(lane, before, stands.since)? } else { stands.since };
        let of_device = lanes.usual(lane, Timed::new(since, time, true).took)?;
        let of_group = if mark.starts() {
            // The return to the first state closes a cycle.
            if state == model.learned.group_start[group as usize] {
                return None;
            }
            let there = watch.here[model.chains.chain_of_group(group as usize)];
            if there.off_path() {
                return None;
            }
            let lane = lanes.find(ChainKind::Group, there.state, state)?;
            Some(lanes.usual_of_group(lane, Timed::new(there.since, time, true).took)?)
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
