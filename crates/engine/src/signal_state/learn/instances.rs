//! The instances of every transition of a group side by side, each in the order they happened.

use std::ops::Range;

use crate::log::Nanoseconds;
use crate::signal_state::chains::{ChainKind, Chains};
use crate::signal_state::enabling::{Entry, NO_RULE};

use super::walk::Walk;

/// Where the instances of a transition are.
#[derive(Clone)]
enum Place {
    /// The entries of the state it leads to: nearly all states are entered in one way only.
    State,
    /// Among those that were sorted out.
    Sorted(Range<usize>),
    /// Among the steps of the group's chain.
    Steps(Range<usize>),
}

/// Instances by transition. Kept from one group to the next.
#[derive(Default)]
pub(super) struct Instances {
    places: Vec<Place>,
    sorted: Vec<Entry>,
    steps: Vec<Nanoseconds>,
}

/// The instances of one transition.
#[derive(Clone, Copy)]
pub(super) enum OfRule<'a> {
    /// Of a device's chain.
    Device(&'a [Entry]),
    /// Of the group's chain: how long each took.
    Group(&'a [Nanoseconds]),
}

impl Instances {
    /// Sorts out those of a group.
    pub(super) fn sort(&mut self, walk: &Walk, chains: &Chains) {
        self.places.clear();
        let (mut sorted, mut steps) = (0, 0);
        let next = |end: &mut usize, count: u32| {
            let start = *end;
            *end += count as usize;
            start..*end
        };
        let mut mixed = Vec::new();
        for rule in &walk.rules {
            self.places.push(match chains.kind(rule.chain) {
                ChainKind::Group => Place::Steps(next(&mut steps, rule.count)),
                ChainKind::Device if walk.entries.of(rule.next).len() == rule.count as usize => {
                    Place::State
                }
                ChainKind::Device => {
                    mixed.push(rule.next);
                    Place::Sorted(next(&mut sorted, rule.count))
                }
            });
        }
        mixed.sort_unstable();
        mixed.dedup();
        let mut ends: Vec<usize> = self.places.iter().map(Place::start).collect();
        let mut end = |rule: u32| {
            let end = &mut ends[rule as usize];
            *end += 1;
            *end - 1
        };
        self.sorted.resize(sorted, Entry::default());
        for state in mixed {
            for entry in walk.entries.of(state).iter().filter(|entry| entry.rule != NO_RULE) {
                self.sorted[end(entry.rule)] = *entry;
            }
        }
        self.steps.resize(steps, 0);
        for step in &walk.steps {
            self.steps[end(step.rule)] = step.took;
        }
    }

    /// Those of one transition.
    pub(super) fn of<'a>(&'a self, walk: &'a Walk, rule: usize) -> OfRule<'a> {
        match &self.places[rule] {
            Place::State => OfRule::Device(walk.entries.of(walk.rules[rule].next)),
            Place::Sorted(range) => OfRule::Device(&self.sorted[range.clone()]),
            Place::Steps(range) => OfRule::Group(&self.steps[range.clone()]),
        }
    }
}

impl Place {
    fn start(&self) -> usize {
        match self {
            Self::State => 0,
            Self::Sorted(range) | Self::Steps(range) => range.start,
        }
    }
}
