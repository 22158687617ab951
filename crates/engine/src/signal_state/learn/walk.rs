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
    /// Each chain's in the order of first appearance.
    pub(super) rules: Vec<Found>,
    /// Transitions of devices that happened, each device's in the order of the log.
    pub(super) ended: Vec<u32>,
    /// Of the group's chain, in the order of the log.
    pub(super) steps: Vec<Step>,
    pub(super) entries: Entries,
    /// When each run's first event happened.
    pub(super) run_starts: Vec<Nanoseconds>,
    /// Places of the events that ended a device's first transition after a start or gap, ascending.
    pub(super) first_steps: Vec<u32>,
    /// Longest time between two events.
    pub(super) longest_pause: Nanoseconds,
    /// The first state of the group's chain: its return closes a group cycle.
    pub(super) start: StateId,
}

/// Walks through one group after the other: first through all events in order, which are left with
/// their devices, then through those of each device, whose few states are all near. Its tables are
/// kept: states and devices belong to one group only.
pub(super) struct Walker<'a> {
    chains: &'a Chains,
    states: &'a States,
    /// By state: how often it is entered.
    in_all: &'a [u32],
    by_device: ByDevice,
    /// By run: the place of its first event.
    run_places: Vec<u32>,
    known: Known,
    walk: Walk,
}

/// Where a chain is.
#[derive(Clone, Copy)]
struct Here {
    time: Nanoseconds,
    state: StateId,
    /// True while `state` was entered at the first time after a start or gap.
    first: bool,
}

const NOWHERE: Here = Here { time: 0, state: NO_STATE, first: true };

impl Walk {
    /// The transitions in the order of first appearance: an event that is of the group's chain is
    /// first of its device's.
    pub(super) fn in_order(&self, chains: &Chains) -> Vec<usize> {
        let first = |rule: usize| {
            let found = &self.rules[rule];
            (found.first, chains.kind(found.chain) == ChainKind::Group)
        };
        let mut rules: Vec<usize> = (0..self.rules.len()).collect();
        rules.sort_unstable_by_key(|&rule| first(rule));
        rules
    }
}

impl<'a> Walker<'a> {
    pub(super) fn new(chains: &'a Chains, states: &'a States, in_all: &'a [u32]) -> Self {
        let walk = Walk {
            rules: Vec::new(),
            ended: Vec::new(),
            steps: Vec::new(),
            entries: Entries::new(states.len()),
            run_starts: Vec::new(),
            first_steps: Vec::new(),
            longest_pause: 0,
            start: NO_STATE,
        };
        let mut sizes = vec![0; chains.len()];
        for (state, entries) in (0..).zip(in_all) {
            let (signal, _) = states.signal_value(state);
            sizes[chains.device_chain(signal)] += entries;
        }
        let by_device = ByDevice::new(sizes);
        let run_places = Vec::new();
        Self {
            chains,
            states,
            in_all,
            by_device,
            run_places,
            known: Known::new(states.len()),
            walk,
        }
    }

    /// Walks through the events of a group.
    pub(super) fn walk(&mut self, events: &[Happening]) -> &Walk {
        let walk = &mut self.walk;
        walk.rules.clear();
        walk.ended.clear();
        walk.ended.reserve(events.len());
        walk.steps.clear();
        walk.entries.begin(events.len());
        walk.run_starts.clear();
        walk.first_steps.clear();
        (walk.longest_pause, walk.start) = (0, NO_STATE);
        self.run_places.clear();
        self.by_device.begin(events.len());
        self.through_group(events);
        for at in 0..self.by_device.devices.len() {
            self.through_device(self.by_device.devices[at], events);
        }
        self.count();
        self.walk.first_steps.sort_unstable();
        &self.walk
    }

    fn through_group(&mut self, events: &[Happening]) {
        let walk = &mut self.walk;
        let (mut run, mut last, mut here) = (0, 0, NOWHERE);
        for (place, event) in (0..).zip(events) {
            if std::mem::replace(&mut run, event.run()) != event.run() {
                walk.run_starts.push(event.time);
                self.run_places.push(place);
                last = event.time;
                here = NOWHERE;
            }
            walk.longest_pause = walk.longest_pause.max(event.time - last);
            last = event.time;
            let (signal, _) = self.states.signal_value(event.state);
            let left = Left { time: event.time, state: event.state, place };
            self.by_device.leave(self.chains.device_chain(signal), left);
            let Some(chain) = self.chains.group_chain(signal) else { continue };
            if walk.start == NO_STATE {
                walk.start = event.state;
            }
            if event.doubtful() {
                here = NOWHERE;
                continue;
            }
            let rules = &mut walk.rules;
            let of_group = (chain, ChainKind::Group);
            if let Some(taken) = self.known.step(&mut here, of_group, left, rules) {
                walk.steps.push(Step { rule: taken.rule, took: taken.took });
            }
        }
    }

    fn through_device(&mut self, device: u32, events: &[Happening]) {
        let walk = &mut self.walk;
        let mut here = NOWHERE;
        let mut begins = 0;
        let mut run_places = self.run_places.iter().copied().peekable();
        for &left in self.by_device.of(device) {
            while let Some(place) = run_places.next_if(|&place| place <= left.place) {
                here = NOWHERE;
                begins = place;
            }
            // Nothing is in doubt before the first gap.
            let step = if begins > 0 && events[left.place as usize].doubtful() {
                here = NOWHERE;
                None
            } else {
                let chain = (device as usize, ChainKind::Device);
                self.known.step(&mut here, chain, left, &mut walk.rules)
            };
            walk.ended.extend(step.as_ref().map(|taken| taken.rule));
            let Left { time, state, place } = left;
            let Taken { rule, took, first } = step.unwrap_or(NOT_TAKEN);
            if first {
                walk.first_steps.push(place);
            }
            let in_all = self.in_all[state as usize];
            walk.entries.enter(state, in_all, Entry { time, took, place, rule });
        }
    }

    fn count(&mut self) {
        let walk = &mut self.walk;
        let mut counts = vec![0u32; walk.rules.len()];
        for rule in walk.ended.iter().copied().chain(walk.steps.iter().map(|step| step.rule)) {
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

    /// One step of a chain.
    #[inline(always)]
    fn step(
        &mut self,
        here: &mut Here,
        (chain, kind): (ChainIndex, ChainKind),
        left: Left,
        rules: &mut Vec<Found>,
    ) -> Option<Taken> {
        let Left { time, state, place } = left;
        let before = *here;
        // Signals that were ON when the log began were all written at its first time.
        let first = before.state == NO_STATE || (before.first && before.time == time);
        *here = Here { time, state, first };
        if before.state == NO_STATE {
            return None;
        }
        let rule = self.rule((before.state, state), kind, rules, |sibling| Found {
            chain,
            current: before.state,
            next: state,
            count: 0,
            uncounted: 0,
            first: place,
            sibling,
        });
        if before.first {
            rules[rule as usize].uncounted += 1;
        }
        Some(Taken { rule, took: time - before.time, first: before.first })
    }

    /// A transition, which is made with its sibling where it is met for the first time.
    #[inline]
    fn rule(
        &mut self,
        (current, next): (StateId, StateId),
        kind: ChainKind,
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

/// A step of a chain: the transition, how long it took, whether it was the first after a start or
/// gap.
struct Taken {
    rule: u32,
    took: Nanoseconds,
    first: bool,
}

const NOT_TAKEN: Taken = Taken { rule: NO_RULE, took: 0, first: false };

/// An event that was left with its device.
#[derive(Clone, Copy, Default)]
struct Left {
    time: Nanoseconds,
    state: StateId,
    place: u32,
}

/// The events of each device side by side, in order.
struct ByDevice {
    /// By device: how many events it has in all.
    sizes: Vec<u32>,
    /// By device: where its events of this group end so far.
    ends: Vec<u32>,
    /// Those that were met.
    devices: Vec<u32>,
    taken: u32,
    left: Vec<Left>,
}

const NOT_MET: u32 = u32::MAX;

impl ByDevice {
    fn new(sizes: Vec<u32>) -> Self {
        let ends = vec![NOT_MET; sizes.len()];
        Self { sizes, ends, devices: Vec::new(), taken: 0, left: Vec::new() }
    }

    fn begin(&mut self, events: usize) {
        self.devices.clear();
        self.taken = 0;
        if self.left.len() < events {
            self.left.resize(events, Left::default());
        }
    }

    #[inline]
    fn leave(&mut self, device: usize, left: Left) {
        let end = &mut self.ends[device];
        if *end == NOT_MET {
            *end = self.taken;
            self.taken += self.sizes[device];
            self.devices.push(device as u32);
        }
        self.left[*end as usize] = left;
        *end += 1;
    }

    fn of(&self, device: u32) -> &[Left] {
        let end = self.ends[device as usize] as usize;
        &self.left[end - self.sizes[device as usize] as usize..end]
    }
}
