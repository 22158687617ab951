//! A second look, at what bears the very time of a transition.
//!
//! A PLC often sets an output in the scan in which it reads an input: cause and effect bear the
//! same time, and where nothing says which is which, the first look takes neither for a cause.
//! Once all transitions of a group have had it, most states are explained without what happens
//! beside them; and of two at one instant, the one that is cannot be the effect of the other.

use std::cmp::Reverse;

use crate::log::{Nanoseconds, SECOND};
use crate::plant::{Plant, SignalClass};
use crate::signal_state::states::{NO_STATE, StateId, States};

use super::delays::{self, Wait};
use super::election::LOOK_BACK;
use super::{
    Delayed, EXPLAINED, Entry, Explanation, GAIN, Happenings, INSTANCES_AT_LEAST, SCREENERS,
    TIGHT_RESOLUTIONS, is_tight,
};

/// So many of the screeners must see a state beside them.
const SEEN: usize = 5;
/// Delays that spread over no more than this share of what they usually are are explained.
const STEADY_SHARE: f64 = 0.1;
/// What explains two equally well may leave so much more of the one than of the other.
const EQUALLY: f64 = 1.25;

/// A transition of a device, after the first look.
pub struct Timed<'a> {
    /// The states it leads from and to.
    pub current: StateId,
    /// See `current`.
    pub next: StateId,
    /// Its instances, in the order they happened.
    pub instances: &'a [Entry],
    /// What the first look came to; the second puts its own in this place.
    pub explanation: &'a mut Explanation,
}

/// Looks at what bears the same time, in the happenings of one group.
#[derive(Clone, Copy)]
pub struct Together<'a> {
    /// The group's happenings.
    pub index: Happenings<'a>,
    /// Its devices and signals.
    pub plant: &'a Plant,
    /// Its states.
    pub states: &'a States,
}

/// How a state is explained without what happens beside it.
#[derive(Clone, Copy)]
struct Standing {
    /// What is left unexplained, at the most, in seconds.
    left_s: f64,
    /// Its device's own last event is enough.
    by_itself: bool,
}

/// A state beside a transition that may be its cause.
struct Cause {
    state: StateId,
    /// Letters that the names of the two devices begin with.
    letters: usize,
    /// How many instances it explains.
    explained: usize,
    delays: Vec<f64>,
}

impl Together<'_> {
    /// Explains the transitions of a group, in the order of first appearance, by what happens at
    /// the same time where that explains more than was found, and returns which. None ever waits for
    /// one that waits for it.
    pub fn explain(&self, timed: &mut [Timed<'_>]) -> Vec<usize> {
        let into = Into::of(timed);
        let causes: Vec<(usize, Vec<Cause>)> = (0..timed.len())
            .filter(|&at| self.is_open(&timed[at]))
            .map(|at| (at, self.causes(timed, &into, at)))
            .filter(|(_, causes)| !causes.is_empty())
            .collect();
        let mut changed = Vec::new();
        for (at, causes) in causes {
            let next = timed[at].next;
            let free = |cause: &Cause| !self.follows(timed, &into, cause.state, next);
            if let Some(cause) = causes.into_iter().find(free) {
                let explanation = &mut *timed[at].explanation;
                let first = std::mem::replace(explanation, Explanation::NONE);
                let found = Delayed { states: [cause.state, NO_STATE], delays: cause.delays };
                *explanation = first.or_waits_for(found, self.index.resolution_s);
                changed.push(at);
            }
        }
        changed
    }

    /// Whether the first look left something to explain, which a program may have done.
    fn is_open(&self, timed: &Timed<'_>) -> bool {
        let &Explanation { own_s, usual_s, exact, .. } = &*timed.explanation;
        let (signal, _) = self.states.signal_value(timed.next);
        timed.instances.len() >= INSTANCES_AT_LEAST
            && !is_tight(own_s, usual_s, self.index.resolution_s)
            && exact < EXPLAINED
            && self.plant.signals[signal as usize].class != SignalClass::Input
    }

    /// What a transition may have waited for, the likeliest first.
    fn causes(&self, timed: &[Timed<'_>], into: &Into, at: usize) -> Vec<Cause> {
        let of = &timed[at];
        let device = self.device(of.next);
        let mut waits: Vec<Wait> = Vec::new();
        let mut room = Vec::new();
        let mut causes = Vec::new();
        for state in self.beside(of.instances) {
            let other = self.device(state);
            if other == device
                || !self
                    .standing(timed, into, state)
                    .is_some_and(|it| it.excels(of.explanation, self.index.resolution_s))
            {
                continue;
            }
            if waits.is_empty() {
                waits = delays::waits(self.index, of.instances, of.next);
            }
            let Some(delays) = delays::sorted(self.index, &waits, [state, NO_STATE], &mut room)
            else {
                continue;
            };
            let explained = delays.partition_point(|&delay| delay <= self.index.resolution_s);
            if explained as f64 >= EXPLAINED * waits.len() as f64 {
                let letters = self.letters(device, other);
                causes.push(Cause { state, letters, explained, delays });
            }
        }
        causes.sort_by_key(|it| (Reverse((it.explained, it.letters)), it.state));
        causes
    }

    /// States that most of a few instances see beside them.
    fn beside(&self, instances: &[Entry]) -> Vec<StateId> {
        let mut seen: Vec<StateId> = Vec::new();
        let mut alone = 0;
        for screener in 0..SCREENERS {
            let instance = &instances[screener * instances.len() / SCREENERS];
            let before = seen.len();
            self.look_beside(instance, &mut seen);
            alone += usize::from(seen.len() == before);
            // Nearly always there is nothing.
            if alone > SCREENERS - SEEN {
                return Vec::new();
            }
        }
        seen.sort_unstable();
        seen.chunk_by(|a, b| a == b).filter(|of| of.len() >= SEEN).map(|of| of[0]).collect()
    }

    /// States entered with an instance, or the least time before it.
    fn look_beside(&self, &Entry { time, place, .. }: &Entry, seen: &mut Vec<StateId>) {
        let (earlier, later) = self.index.happenings.split_at(place as usize);
        let least = (self.index.resolution_s * SECOND as f64) as Nanoseconds;
        let earlier = earlier.iter().rev().take_while(|other| time - other.time <= least);
        let later = later[1..].iter().take_while(|other| other.time == time);
        let first = seen.len();
        seen.extend(earlier.take(LOOK_BACK).chain(later.take(LOOK_BACK)).map(|it| it.state));
        seen[first..].sort_unstable();
        let mut kept = first;
        for at in first..seen.len() {
            if kept == first || seen[kept - 1] != seen[at] {
                seen[kept] = seen[at];
                kept += 1;
            }
        }
        seen.truncate(kept);
    }

    /// How a state is explained; `None` where it is not, or not by what happened earlier.
    fn standing(&self, timed: &[Timed<'_>], into: &Into, state: StateId) -> Option<Standing> {
        let frequent = |it: &&Timed<'_>| it.instances.len() >= INSTANCES_AT_LEAST;
        let echoes =
            |it: &Timed<'_>| frequent(&it) && it.explanation.usual_s <= self.index.resolution_s;
        let mut of = into.of_state(state).map(|at| &timed[at]).filter(frequent);
        // What only ever follows its device's last event at once is as well known as that event;
        // what does so at times says nothing by it.
        let at = match (of.next(), of.next()) {
            (Some(only), None) if echoes(only) => only.current,
            _ => state,
        };
        let mut standing = Standing { left_s: 0.0, by_itself: true };
        let (mut all, mut known) = (0, 0);
        for it in into.of_state(at).map(|at| &timed[at]).filter(|it| !echoes(it)) {
            all += it.instances.len();
            let &Explanation { left_s, usual_s, ref trigger, .. } = &*it.explanation;
            let steady = (TIGHT_RESOLUTIONS * self.index.resolution_s).max(STEADY_SHARE * usual_s);
            let is_known = trigger.is_some() || self.is_answer(it.current, state);
            if frequent(&it) && left_s <= steady && is_known {
                known += it.instances.len();
                standing.left_s = standing.left_s.max(left_s);
                standing.by_itself &= trigger.is_none();
            }
        }
        (known > 0 && known as f64 >= EXPLAINED * all as f64).then_some(standing)
    }

    /// Whether a state of a device answers to another. What ends a pulse of the program's is not
    /// known: it may well be the sensor of another device.
    fn is_answer(&self, before: StateId, state: StateId) -> bool {
        let [before, signal] = [before, state].map(|state| self.states.signal_value(state).0);
        before != signal || self.plant.signals[signal as usize].class == SignalClass::Input
    }

    /// Whether a state waits for another one without any time between, or for one that does.
    fn follows(&self, timed: &[Timed<'_>], into: &Into, state: StateId, other: StateId) -> bool {
        let mut open = vec![state];
        let mut seen = vec![state];
        while let Some(state) = open.pop() {
            if state == other {
                return true;
            }
            for it in into.of_state(state).map(|at| &timed[at]) {
                for next in self.causes_at_once(it) {
                    if !seen.contains(&next) {
                        seen.push(next);
                        open.push(next);
                    }
                }
            }
        }
        false
    }

    /// What a transition waits for without any time between; unless another event is known, that is
    /// its device's own last one.
    fn causes_at_once(&self, timed: &Timed<'_>) -> Vec<StateId> {
        let Explanation { at_once, trigger, .. } = &*timed.explanation;
        if *at_once <= 1.0 - EXPLAINED {
            return Vec::new();
        }
        trigger.as_ref().map_or_else(|| vec![timed.current], |it| it.states().collect())
    }

    fn device(&self, state: StateId) -> usize {
        let (signal, _) = self.states.signal_value(state);
        self.plant.signals[signal as usize].device()
    }

    fn letters(&self, one: usize, other: usize) -> usize {
        let [one, other] = [one, other].map(|device| self.plant.devices[device].name.chars());
        one.zip(other).take_while(|(one, other)| one == other).count()
    }
}

impl Standing {
    /// Whether a state of this standing is so much better explained than what happens beside it
    /// that it may be the cause.
    fn excels(&self, other: &Explanation, resolution_s: f64) -> bool {
        if self.by_itself {
            self.left_s <= EQUALLY * other.left_s + resolution_s
                && self.left_s <= GAIN * other.own_s
        } else {
            other.left_s > resolution_s && self.left_s <= GAIN * other.left_s
        }
    }
}

/// Transitions by the state they lead to.
struct Into(Vec<(StateId, u32)>);

impl Into {
    fn of(timed: &[Timed<'_>]) -> Self {
        let mut into: Vec<_> = timed.iter().map(|it| it.next).zip(0..).collect();
        into.sort_unstable();
        Self(into)
    }

    fn of_state(&self, state: StateId) -> impl Iterator<Item = usize> + '_ {
        let start = self.0.partition_point(|&(of, _)| of < state);
        let of_state = self.0[start..].iter().take_while(move |&&(of, _)| of == state);
        of_state.map(|&(_, at)| at as usize)
    }
}
