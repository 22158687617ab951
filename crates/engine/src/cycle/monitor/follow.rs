//! Following the automata: readings, edges of the work-complete bit, steps.

use std::sync::Arc;

use crate::cycle::image::Phase;
use crate::cycle::lanes::LOST;
use crate::cycle::machine::{Came, Machine, State};
use crate::cycle::order;
use crate::cycle::regions::Word;
use crate::log::Nanoseconds;

use super::report::Departure;
use super::{Here, Monitor, NOWHERE, Stand};

impl Monitor {
    /// Judges the reading that is complete.
    #[inline]
    pub(super) fn judge(&mut self) {
        let Some(time) = self.watch.reading.take() else {
            return;
        };
        let may_differ = self.watch.image.complete(&self.model.wiring);
        if !self.watch.image.dirty.is_empty() {
            self.watch.position = self.watch.position.map(|position| position + 1);
        }
        if may_differ || !self.watch.started {
            self.judge_modes(time);
        } else {
            self.step_all(time);
        }
        if !self.watch.image.dirty.is_empty() || self.watch.sequence_since == Some(time) {
            self.watch.last_change = time;
            self.watch.image.dirty.clear();
        }
        if !self.fresh.is_empty() {
            self.settle(time, false);
        }
    }

    #[inline]
    fn step_all(&mut self, time: Nanoseconds) {
        if self.watch.paused {
            return;
        }
        let Some(phase) = self.watch.phase else {
            return;
        };
        for place in 0..self.watch.image.dirty.len() {
            let region = self.watch.image.dirty[place] as usize;
            self.step(region, phase, time);
        }
    }

    #[inline]
    fn step(&mut self, region: usize, phase: Phase, time: Nanoseconds) {
        let here = &mut self.watch.here[region];
        if here.state != LOST && !here.ahead {
            let word = self.watch.image.words[region];
            if let Some((transition, state)) = self.lanes.step(here.state, word) {
                *here = Stand {
                    state,
                    came: transition,
                    since: time,
                    before_state: here.state,
                    before_came: here.came,
                    before_since: here.since,
                    ahead: false,
                };
                if !self.watch.open.is_empty() {
                    self.known_step(region, time);
                }
                return;
            }
        }
        self.step_aside(region, phase, time);
    }

    /// What is no known transition of the whole word.
    #[cold]
    fn step_aside(&mut self, region: usize, phase: Phase, time: Nanoseconds) {
        let model = Arc::clone(&self.model);
        let machine = model.machine(region, phase);
        let here = self.here(region, phase);
        let word = self.word(region);
        if here.state == LOST {
            if !self.watch.await_edge {
                self.synchronise(region, phase, time);
            }
            return;
        }
        if machine.word(here.state) == word {
            self.watch.here[region].ahead = false;
            return;
        }
        if self.element {
            if order::skipped(machine, here.state, word)
                && let Some(state) = machine.find(word)
            {
                self.stand(region, phase, state, Came::Unknown, time);
                if !self.watch.open.is_empty() {
                    self.known_step(region, time);
                }
                return;
            }
            let independence = &model.independence[region][phase.index()];
            if order::before_its_turn(machine, independence, here.state, word) {
                self.watch.here[region].ahead = true;
                return;
            }
        }
        self.report(region, phase, time, Departure::Transition { from: here.state });
        self.synchronise(region, phase, time);
    }

    /// Stands where the word says, if it is known.
    pub(super) fn synchronise(&mut self, region: usize, phase: Phase, time: Nanoseconds) {
        let word = self.word(region);
        match self.model.machine(region, phase).find(word) {
            Some(state) => self.stand(region, phase, state, Came::Unknown, time),
            None => self.watch.here[region] = NOWHERE,
        }
    }

    fn synchronise_all(&mut self, time: Nanoseconds) {
        self.watch.here.fill(NOWHERE);
        if let Some(phase) = self.watch.phase.filter(|_| !self.watch.await_edge) {
            for region in 0..self.watch.here.len() {
                self.synchronise(region, phase, time);
            }
        }
    }

    /// A reading in which the mode bits may say something else, or the first one.
    #[cold]
    fn judge_modes(&mut self, time: Nanoseconds) {
        let mode = self.watch.image.mode;
        let first = !std::mem::replace(&mut self.watch.started, true);
        let alarm_before = std::mem::replace(&mut self.watch.alarm, mode.alarm);
        let alarm_rose = mode.alarm && !alarm_before;
        let phase_before = std::mem::replace(&mut self.watch.phase, mode.phase);
        if !mode.alarm {
            self.watch.alarm_handled = false;
        } else if mode.manual || first {
            self.watch.alarm_handled = true;
        }
        let paused = mode.manual || (mode.alarm && self.watch.alarm_handled);
        let paused_before = std::mem::replace(&mut self.watch.paused, paused);
        self.watch.by_hand |= mode.manual;
        if mode.manual {
            self.watch.held.clear();
        }
        if paused {
            self.watch.here.fill(NOWHERE);
            self.watch.sequence_since = None;
            return;
        }
        let by_hand = std::mem::take(&mut self.watch.by_hand);
        let edge = !first && phase_before != mode.phase;
        if edge {
            self.watch.sequences += 1;
        }
        // Whole words are followed from the first of a sequence on, and a sequence in which somebody
        // moved the machine by hand is left out, as in learning; `element` joins anywhere.
        if self.element {
            self.watch.await_edge = false;
        } else if by_hand {
            self.watch.await_edge = true;
        } else if edge {
            self.watch.await_edge = false;
        }
        if edge || paused_before || first {
            self.watch.sequence_since = mode.phase.map(|_| time);
            self.watch.position = (edge && !paused_before).then_some(0);
            self.watch.never_ends_told = false;
            self.watch_the_clock();
        } else if alarm_before && !mode.alarm {
            self.watch.sequence_since = mode.phase.map(|_| time);
            self.watch_the_clock();
        }
        if edge && !self.watch.await_edge {
            let followed = !paused_before;
            for region in 0..self.watch.here.len() {
                let ended = !followed || self.end(region, phase_before, time);
                self.begin(region, time, ended);
            }
            if followed {
                self.sequence_over(time);
            }
        } else if paused_before || first {
            self.synchronise_all(time);
        } else {
            self.step_all(time);
        }
        if alarm_rose {
            self.settle(time, true);
        }
    }

    /// The sequence of a region ends; true where it may end so.
    fn end(&mut self, region: usize, phase: Option<Phase>, time: Nanoseconds) -> bool {
        let Some(phase) = phase.filter(|_| self.watch.here[region].state != LOST) else {
            return true;
        };
        let here = self.here(region, phase);
        let model = Arc::clone(&self.model);
        let machine = model.machine(region, phase);
        if machine.is_final(here.state) && !here.ahead
            || self.element && one_change_from_the_end(machine, here, self.word(region))
        {
            return true;
        }
        self.report(region, phase, time, Departure::End { at: here.state });
        false
    }

    /// The sequence of a region begins.
    fn begin(&mut self, region: usize, time: Nanoseconds, may_tell: bool) {
        let Some(phase) = self.watch.phase else {
            self.watch.here[region] = NOWHERE;
            return;
        };
        let model = Arc::clone(&self.model);
        let machine = model.machine(region, phase);
        let word = self.word(region);
        let state = machine.find(word);
        if let Some(state) = state.filter(|&state| machine.is_initial(state)) {
            self.stand(region, phase, state, Came::First, time);
            return;
        }
        // Nothing was learned of this phase: nothing can be said of it.
        let known = machine.is_empty()
            || self.element && state.is_some_and(|state| one_change_from_a_start(machine, state));
        if may_tell && !known {
            self.report(region, phase, time, Departure::Start);
        }
        self.synchronise(region, phase, time);
    }
}

/// The edge and a change of the region may have met in another order than learned.
fn one_change_from_the_end(machine: &Machine, here: Here, word: Word) -> bool {
    let is_final = |state: State| machine.is_final(state);
    if machine.find(word).is_some_and(is_final) {
        return true;
    }
    let onwards = machine.from(here.state).iter().any(|t| is_final(t.to));
    let back = || machine.transitions.iter().any(|t| t.to == here.state && is_final(t.from));
    onwards || back()
}

fn one_change_from_a_start(machine: &Machine, state: State) -> bool {
    machine.transitions.iter().any(|t| {
        t.to == state && machine.is_initial(t.from) || t.from == state && machine.is_initial(t.to)
    })
}
