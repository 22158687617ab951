//! Every transition of a group's chains, in the order of the log.

use crate::log::Nanoseconds;
use crate::signal_state::chains::{ChainIndex, ChainKind, Chains};
use crate::signal_state::enabling::{Entries, Entry, Happening, NO_RULE};
use crate::signal_state::rules::row_of;
use crate::signal_state::states::{NO_STATE, StateId, States};

/// One transition.
pub(super) struct Found {
    pub(super) chain: ChainIndex,
    pub(super) current: StateId,
    pub(super) next: StateId,
    pub(super) count: u32,
    pub(super) uncounted: u32,
    /// The event it first ended with, by its place in the group.
    pub(super) first: u32,
    /// Another transition out of the same state, found before; [`NO_RULE`] where there is none.
    pub(super) sibling: u32,
}

/// One time a transition of the group's chain happened.
#[derive(Clone, Copy)]
pub(super) struct Step {
    pub(super) rule: u32,
    pub(super) took: Nanoseconds,
}

/// What was met on the way through a group's events.
pub(super) struct Walk {
    /// In the order of first appearance.
    pub(super) rules: Vec<Found>,
    /// By event: the transition of its device it ended; [`NO_RULE`] where it ended none.
    pub(super) ended: Vec<u32>,
    /// Of the group's chain, in the order of the log.
    pub(super) steps: Vec<Step>,
    pub(super) entries: Entries,
    /// When each run's first event happened.
    pub(super) run_starts: Vec<Nanoseconds>,
    /// Longest time between two events.
    pub(super) longest_pause: Nanoseconds,
    /// The first state of the group's chain: its return closes a group cycle.
    pub(super) start: StateId,
}

/// Walks through one group after the other. Its tables are kept: states and chains belong to one
/// group only.
pub(super) struct Walker<'a> {
    chains: &'a Chains,
    states: &'a States,
    /// By state: how often it is entered.
    in_all: &'a [u32],
    /// By chain.
    here: Vec<Here>,
    known: Known,
    walk: Walk,
}

/// Where a chain is.
#[derive(Clone, Copy)]
struct Here {
    time: Nanoseconds,
    state: StateId,
    /// Twice the run, and one more while `state` was entered at the first time after a start or
    /// gap.
    mark: u32,
}

const NOWHERE: Here = Here { time: 0, state: NO_STATE, mark: 0 };

impl<'a> Walker<'a> {
    pub(super) fn new(chains: &'a Chains, states: &'a States, in_all: &'a [u32]) -> Self {
        let walk = Walk {
            rules: Vec::new(),
            ended: Vec::new(),
            steps: Vec::new(),
            entries: Entries::new(states.len()),
            run_starts: Vec::new(),
            longest_pause: 0,
            start: NO_STATE,
        };
        let here = vec![NOWHERE; chains.len()];
        Self { chains, states, in_all, here, known: Known::new(states.len()), walk }
    }

    /// Walks through the events of a group.
    pub(super) fn walk(&mut self, events: &[Happening]) -> &Walk {
        self.begin(events.len());
        let (mut run, mut last) = (0, 0);
        for (place, event) in (0..).zip(events) {
            if std::mem::replace(&mut run, event.run()) != event.run() {
                self.walk.run_starts.push(event.time);
                last = event.time;
            }
            self.walk.longest_pause = self.walk.longest_pause.max(event.time - last);
            last = event.time;
            let (signal, _) = self.states.signal_value(event.state);
            let (rule, took) =
                self.step(self.chains.device_chain(signal), ChainKind::Device, event, place);
            self.walk.ended.push(rule);
            let entry = Entry { time: event.time, took, place, rule };
            self.walk.entries.enter(event.state, self.in_all[event.state as usize], entry);
            if let Some(chain) = self.chains.group_chain(signal) {
                if self.walk.start == NO_STATE {
                    self.walk.start = event.state;
                }
                let (rule, took) = self.step(chain, ChainKind::Group, event, place);
                if rule != NO_RULE {
                    self.walk.steps.push(Step { rule, took });
                }
            }
        }
        self.count();
        &self.walk
    }

    fn begin(&mut self, events: usize) {
        let walk = &mut self.walk;
        walk.rules.clear();
        walk.ended.clear();
        walk.ended.reserve(events);
        walk.steps.clear();
        walk.entries.begin(events);
        walk.run_starts.clear();
        (walk.longest_pause, walk.start) = (0, NO_STATE);
    }

    /// One step of a chain: the transition, where it is one, and how long it took.
    #[inline(always)]
    fn step(
        &mut self,
        chain: ChainIndex,
        kind: ChainKind,
        event: &Happening,
        place: u32,
    ) -> (u32, Nanoseconds) {
        let here = &mut self.here[chain];
        if event.doubtful() {
            *here = NOWHERE;
            return (NO_RULE, 0);
        }
        let before = *here;
        let known = before.state != NO_STATE && before.mark >> 1 == event.run();
        // Signals that were ON when the log began were all written at its first time.
        let before_first = before.mark & 1 == 1;
        let first = !known || (before_first && before.time == event.time);
        let mark = event.run() << 1 | u32::from(first);
        *here = Here { time: event.time, state: event.state, mark };
        if !known {
            return (NO_RULE, 0);
        }
        let rules = &mut self.walk.rules;
        let rule = self.known.rule(before.state, kind, event.state, rules, |sibling| Found {
            chain,
            current: before.state,
            next: event.state,
            count: 0,
            uncounted: 0,
            first: place,
            sibling,
        });
        if before_first {
            rules[rule as usize].uncounted += 1;
        }
        (rule, event.time - before.time)
    }

    fn count(&mut self) {
        let walk = &mut self.walk;
        let mut counts = vec![0u32; walk.rules.len()];
        let of_devices = walk.ended.iter().copied().filter(|&rule| rule != NO_RULE);
        for rule in of_devices.chain(walk.steps.iter().map(|step| step.rule)) {
            counts[rule as usize] += 1;
        }
        for (rule, count) in walk.rules.iter_mut().zip(counts) {
            rule.count = count;
        }
    }
}

/// The transitions met so far. Nearly all states are entered from one other only, so the last
/// transition into a state is tried first.
struct Known {
    /// By row of the state entered: where from, and the transition.
    last: Vec<(StateId, u32)>,
    /// By row of the state left: the newest transition; the others are its siblings.
    newest: Vec<u32>,
}

impl Known {
    fn new(states: usize) -> Self {
        Self { last: vec![(NO_STATE, NO_RULE); 2 * states], newest: vec![NO_RULE; 2 * states] }
    }

    /// A transition, which is made with its sibling where it is met for the first time.
    #[inline]
    fn rule(
        &mut self,
        current: StateId,
        kind: ChainKind,
        next: StateId,
        rules: &mut Vec<Found>,
        make: impl FnOnce(u32) -> Found,
    ) -> u32 {
        let last = &mut self.last[row_of(next, kind)];
        if last.0 != current {
            let newest = &mut self.newest[row_of(current, kind)];
            let mut rule = *newest;
            while rule != NO_RULE && rules[rule as usize].next != next {
                rule = rules[rule as usize].sibling;
            }
            if rule == NO_RULE {
                rule = rules.len() as u32;
                rules.push(make(*newest));
                *newest = rule;
            }
            *last = (current, rule);
        }
        last.1
    }
}
