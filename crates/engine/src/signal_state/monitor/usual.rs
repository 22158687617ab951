//! The usual case, and the only one that must be fast: a signal flips, its chains know the
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

/// Rows whose lanes are fetched ahead of their turn. The memory behind a big plant's lanes is the
/// cost of watching it, unless it is asked for in time.
const ROWS_AHEAD: usize = 24;
/// Rows before their turn whose lanes are looked at for what they lead on to.
const ROWS_AHEAD_FURTHER: usize = 10;

/// What one usual row comes to.
#[derive(Clone, Copy)]
struct Step {
    state: StateId,
    device: ChainIndex,
    of_device: Usual,
    /// The group's chain moves too.
    starting: bool,
    group_chain: ChainIndex,
    of_group: Usual,
    waits: bool,
}

impl Monitor {
    /// Takes rows from the first on, as long as all is usual; returns how many.
    pub(super) fn take_usual_rows(&mut self, rows: &[Row]) -> usize {
        if !self.watch.pending.is_empty() || !self.watch.started || self.watch.resynchronise {
            return 0;
        }
        let scan = self.model.learned.scan_window.max(1);
        for row in rows.iter().take(ROWS_AHEAD) {
            self.lanes.fetch(boolean_state(row));
        }
        let mut at = 0;
        // The end of a scan shows in the row after it.
        while let Some([row, next]) = rows.get(at..at + 2) {
            self.fetch(rows, at);
            if next.time.saturating_sub(row.time) >= scan {
                let Some(step) = self.usual_step(*row) else { break };
                self.take_step(*row, step);
                at += 1;
            } else {
                let over = rows.get(at + 2).map(|after| after.time.saturating_sub(row.time));
                if over.is_none_or(|over| over < scan) || !self.take_pair(*row, *next) {
                    break;
                }
                self.fetch(rows, at + 1);
                at += 2;
            }
        }
        at
    }

    /// Fetches what the rows will need that come some time after one.
    #[inline(always)]
    fn fetch(&self, rows: &[Row], at: usize) {
        if let Some(row) = rows.get(at + ROWS_AHEAD) {
            self.lanes.fetch(boolean_state(row));
        }
        if let Some(row) = rows.get(at + ROWS_AHEAD_FURTHER) {
            self.lanes.fetch_further(boolean_state(row));
        }
    }

    /// Two rows of one scan, of two devices that have nothing to do with one another; false, and
    /// nothing taken, where they have.
    #[inline(never)]
    fn take_pair(&mut self, row: Row, next: Row) -> bool {
        let (Some(one), Some(other)) = (self.usual_step(row), self.usual_step(next)) else {
            return false;
        };
        let together = one.device == other.device || one.starting && other.starting;
        if together || one.waits || other.waits {
            return false;
        }
        // Their group remembers the last.
        let swapped = self.order.as_ref().is_some_and(|order| order.swaps(&row, &next));
        let steps = if swapped { [(next, other), (row, one)] } else { [(row, one), (next, other)] };
        for (row, step) in steps {
            self.take_step(row, step);
        }
        self.watch.now = next.time;
        true
    }

    /// What a row comes to that is a scan of its own; `None` where anything about it is not usual.
    #[inline(always)]
    fn usual_step(&self, row: Row) -> Option<Step> {
        let watch = &self.watch;
        if row.time >= watch.next_deadline || !watch.values.flips(row.signal, row.value) {
            return None;
        }
        let state = 2 * row.signal + row.value as u32;
        let place = self.lanes.place(state)?;
        let (lane, since) = self.known(place.device, ChainKind::Device, state)?;
        let waits = self.lanes.waits(lane);
        let since =
            if waits { self.lanes.due(lane, self.lanes.last_entry(state), since)? } else { since };
        let of_device = self.lanes.usual(lane, Timed::new(since, row.time, true).took)?;
        let group = self.model.chains.group_of(place.device);
        if watch.group_stalled[group].is_some() {
            return None;
        }
        let (group_chain, of_group) = if place.starting {
            // The return to the first state closes a cycle.
            if state == self.model.learned.group_start[group] {
                return None;
            }
            let chain = self.model.chains.chain_of_group(group);
            let (lane, since) = self.known(chain, ChainKind::Group, state)?;
            let took = Timed::new(since, row.time, true).took;
            (chain, self.lanes.usual(lane, took)?)
        } else {
            (place.device, of_device)
        };
        let (device, starting) = (place.device, place.starting);
        Some(Step { state, device, of_device, starting, group_chain, of_group, waits })
    }

    /// The lane of a chain's known transition to a state, and since when the chain stood where it
    /// stands; `None` off the path.
    #[inline(always)]
    fn known(
        &self,
        chain: ChainIndex,
        kind: ChainKind,
        state: StateId,
    ) -> Option<(usize, Nanoseconds)> {
        if self.watch.off_path[chain] {
            return None;
        }
        let Here { state: from, since } = self.watch.here[chain];
        Some((self.lanes.find(kind, from, state)?, since))
    }

    #[inline(always)]
    fn take_step(&mut self, row: Row, step: Step) {
        self.lanes.take(step.of_device);
        self.lanes.keep_entry(step.state, row.time);
        let watch = &mut self.watch;
        watch.now = row.time;
        watch.values.flip(row.signal);
        let here = Here { state: step.state, since: row.time };
        watch.here[step.device] = here;
        if step.starting {
            self.lanes.take(step.of_group);
            watch.here[step.group_chain] = here;
        }
        let group = self.model.chains.group_of(step.device);
        watch.group_last[group] = row.time;
        watch.group_last_state[group] = step.state;
        let deadline = row.time.saturating_add(self.stall_after[group]);
        watch.next_deadline = watch.next_deadline.min(deadline);
    }
}

/// The state a row of a boolean leads to; the few words come as they come.
#[inline(always)]
fn boolean_state(row: &Row) -> usize {
    2 * row.signal as usize + (row.value & 1) as usize
}
