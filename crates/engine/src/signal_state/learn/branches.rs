//! States that are left in more than one way: how probable each way is, and how its share wanders.

use crate::signal_state::dispersion;
use crate::signal_state::enabling::NO_RULE;

use super::walk::Walk;

/// One of the ways out of a state.
#[derive(Clone, Copy)]
pub(super) struct Way {
    /// Share of the departures from its state.
    pub(super) probability: f64,
    /// Dispersion of "this transition was taken" among them.
    pub(super) dispersion: f64,
}

/// Most states are left in one way only.
const ONLY: Way = Way { probability: 1.0, dispersion: 1.0 };

/// By transition of a group.
pub(super) fn ways(walk: &Walk) -> Vec<Way> {
    let rules = &walk.rules;
    let mut ways = vec![ONLY; rules.len()];
    let (branch_of, sizes) = branches(walk);
    let mut departures: Vec<Vec<u32>> = sizes.into_iter().map(Vec::with_capacity).collect();
    for rule in walk.ended.iter().copied().chain(walk.steps.iter().map(|step| step.rule)) {
        let branch = branch_of[rule as usize];
        if branch != NO_BRANCH {
            departures[branch as usize].push(rule);
        }
    }
    for ((way, &branch), (rule, found)) in ways.iter_mut().zip(&branch_of).zip((0..).zip(rules)) {
        if let Some(departures) = departures.get(branch as usize) {
            way.probability = f64::from(found.count) / departures.len() as f64;
            way.dispersion = dispersion::of_share(departures, rule);
        }
    }
    ways
}

const NO_BRANCH: u32 = u32::MAX;

/// By transition: the branch it is one way of; and by branch: how many departures there are.
fn branches(walk: &Walk) -> (Vec<u32>, Vec<usize>) {
    let rules = &walk.rules;
    let mut branch_of = vec![NO_BRANCH; rules.len()];
    let mut sizes = Vec::new();
    // The newest of siblings comes first.
    for newest in (0..rules.len()).rev() {
        if rules[newest].sibling == NO_RULE || branch_of[newest] != NO_BRANCH {
            continue;
        }
        let mut size = 0;
        let mut rule = newest as u32;
        while rule != NO_RULE {
            branch_of[rule as usize] = sizes.len() as u32;
            size += rules[rule as usize].count as usize;
            rule = rules[rule as usize].sibling;
        }
        sizes.push(size);
    }
    (branch_of, sizes)
}
