//! Every transition of every chain, in the order of the log.

use crate::log::Nanoseconds;
use crate::signal_state::chains::{ChainIndex, ChainKind, Chains};
use crate::signal_state::enabling::Happening;
use crate::signal_state::rules::row_of;
use crate::signal_state::states::{NO_STATE, StateId};

/// Every transition of every chain, and the instances of each in the order they happened.
pub(super) struct Transitions {
    pub(super) rules: Vec<Found>,
    /// In the order of the log.
    pub(super) instances: Vec<Instance>,
}

impl Transitions {
    /// By rule: the event it first ended with.
    pub(super) fn first_events(&self) -> Vec<u32> {
        let mut first = vec![0; self.rules.len()];
        for instance in self.instances.iter().rev() {
            first[instance.rule as usize] = instance.event;
        }
        first
    }
}

/// One time a transition happened.
#[derive(Clone, Copy)]
pub(super) struct Instance {
    pub(super) rule: u32,
    /// The event it ended with.
    event: u32,
    took: Nanoseconds,
}

/// One transition.
pub(super) struct Found {
    pub(super) chain: ChainIndex,
    pub(super) current: StateId,
    pub(super) next: StateId,
    pub(super) count: u32,
    pub(super) uncounted: u32,
}

#[derive(Clone, Copy)]
struct Here {
    state: StateId,
    time: Nanoseconds,
    /// True while `state` was entered at the first time after a start or gap.
    first: bool,
}

pub(super) fn walk(events: &[Happening], chains: &Chains, states: usize) -> Transitions {
    let nowhere = Here { state: NO_STATE, time: 0, first: true };
    let mut here = vec![nowhere; chains.len()];
    let mut known = Known::new(states);
    let mut found =
        Transitions { rules: Vec::new(), instances: Vec::with_capacity(events.len() * 5 / 4) };
    let mut run = 0;
    for (index, event) in (0..).zip(events) {
        if std::mem::replace(&mut run, event.run) != event.run {
            here.fill(nowhere);
        }
        let group = chains.group_chain(event.signal).map(|chain| (chain, ChainKind::Group));
        let device = (chains.device_chain(event.signal), ChainKind::Device);
        for (chain, kind) in std::iter::once(device).chain(group) {
            if event.doubtful {
                here[chain] = nowhere;
                continue;
            }
            let before = here[chain];
            // Signals that were ON when the log began were all written at its first time.
            let first = before.state == NO_STATE || (before.first && before.time == event.time);
            here[chain] = Here { state: event.state, time: event.time, first };
            if before.state == NO_STATE {
                continue;
            }
            let new = found.rules.len() as u32;
            let rule = known.rule(before.state, kind, event.state, new);
            if rule == new {
                found.rules.push(Found {
                    chain,
                    current: before.state,
                    next: event.state,
                    count: 0,
                    uncounted: 0,
                });
            }
            if before.first {
                found.rules[rule as usize].uncounted += 1;
            }
            let took = event.time - before.time;
            found.instances.push(Instance { rule, event: index, took });
        }
    }
    let mut counts = vec![0u32; found.rules.len()];
    for instance in &found.instances {
        counts[instance.rule as usize] += 1;
    }
    for (rule, count) in found.rules.iter_mut().zip(counts) {
        rule.count = count;
    }
    found
}

/// The transitions met so far. Nearly all states are entered from one other only, so the last
/// transition into a state is tried first.
struct Known {
    /// By row of the state entered: where from, and the rule.
    last: Vec<(StateId, u32)>,
    by_row: Vec<Vec<(StateId, u32)>>,
}

impl Known {
    fn new(states: usize) -> Self {
        Self { last: vec![(NO_STATE, 0); 2 * states], by_row: vec![Vec::new(); 2 * states] }
    }

    /// The rule of a transition, which is `new` where it is met for the first time.
    #[inline]
    fn rule(&mut self, current: StateId, kind: ChainKind, next: StateId, new: u32) -> u32 {
        let last = &mut self.last[row_of(next, kind)];
        if last.0 != current {
            let row = &mut self.by_row[row_of(current, kind)];
            let known = row.iter().find(|(to, _)| *to == next).map(|&(_, rule)| rule);
            *last = (current, known.unwrap_or(new));
            if known.is_none() {
                row.push((next, new));
            }
        }
        last.1
    }
}

/// The instances of every rule side by side, each in the order they happened.
pub(super) struct ByRule {
    end: Vec<usize>,
    pub(super) took: Vec<Nanoseconds>,
    pub(super) events: Vec<u32>,
}

impl ByRule {
    pub(super) fn of(found: &Transitions) -> Self {
        let mut end = vec![0usize; found.rules.len() + 1];
        for (rule, transition) in found.rules.iter().enumerate() {
            end[rule + 1] = end[rule] + transition.count as usize;
        }
        let mut place = end.clone();
        let mut took = vec![0; found.instances.len()];
        let mut events = vec![0u32; found.instances.len()];
        for instance in &found.instances {
            let at = &mut place[instance.rule as usize];
            took[*at] = instance.took;
            events[*at] = instance.event;
            *at += 1;
        }
        Self { end, took, events }
    }

    pub(super) fn range(&self, rule: usize) -> std::ops::Range<usize> {
        self.end[rule]..self.end[rule + 1]
    }
}
