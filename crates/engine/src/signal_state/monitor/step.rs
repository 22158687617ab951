//! One chain takes one step.

use crate::log::Nanoseconds;
use crate::signal_state::chains::{ChainIndex, ChainKind};
use crate::signal_state::found::{self, Timed};
use crate::signal_state::states::{NO_STATE, StateId};

use super::Monitor;

/// A state is entered.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    pub(super) state: StateId,
    pub(super) time: Nanoseconds,
    /// When the same state was entered before.
    pub(super) before: Nanoseconds,
}

/// From which state to which a chain went.
#[derive(Debug, Clone, Copy)]
pub(super) struct Way {
    pub(super) chain: ChainIndex,
    pub(super) states: [StateId; 2],
}

/// Since when a device had been waiting, and whether another's delay may be the reason.
#[derive(Debug, Clone, Copy)]
pub(super) struct Waiting {
    pub(super) since: Nanoseconds,
    pub(super) inherits: bool,
}

impl Monitor {
    /// One chain moves on to a state.
    #[inline]
    pub(super) fn step(&mut self, chain: ChainIndex, kind: ChainKind, event: Entry) {
        let here = &mut self.watch.here[chain];
        let from = *here;
        here.enter(event.state, event.time);
        if from.state == NO_STATE {
            return;
        }
        match self.lanes.find(kind, from.state, event.state) {
            Some(lane) => {
                let timed = self.timed(lane, from.since, event);
                let in_time = if timed.as_learned {
                    self.take_as_learned(kind, lane, timed)
                } else {
                    self.take_without_trigger(lane, timed)
                };
                if !in_time {
                    let way = Way { chain, states: [from.state, event.state] };
                    self.report_time(self.lanes.rule(lane), way, event.time, timed);
                }
                if from.off_path() {
                    self.known_step(chain, event.state, event.time);
                }
            }
            None if from.off_path() => self.unknown_step(chain, event.state),
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

    #[inline]
    fn take_as_learned(&mut self, kind: ChainKind, lane: usize, timed: Timed) -> bool {
        let usual = match kind {
            ChainKind::Device => self.lanes.usual(lane, timed.took),
            ChainKind::Group => self.lanes.usual_of_group(lane, timed.took),
        };
        if let Some(usual) = usual {
            self.lanes.take(usual);
        }
        usual.is_some()
    }

    /// A known transition that happened without its enabling event, judged by the device's own
    /// times.
    fn take_without_trigger(&mut self, lane: usize, timed: Timed) -> bool {
        let accepted = found::accepted(&self.model, self.lanes.rule(lane), timed.as_learned);
        let seconds = timed.seconds();
        let in_time = accepted.is_empty()
            || accepted.iter().any(|a| seconds >= a.early_s && seconds <= a.late_s);
        if in_time {
            self.lanes.take_untimed(lane);
        }
        in_time
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
