//! The shortest way to a wanted marking by silent transitions alone.

use std::collections::HashSet;

use super::petri::{PetriNet, TransitionIndex};

/// Markings looked at before a search settles for the best one found. A net that is not sound can
/// have infinitely many.
const MARKINGS_AT_MOST: usize = 4096;

/// A way of silent firings, and what is still amiss at its end.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SilentPath {
    /// Silent transitions in the order they fire; none where nothing is gained by firing.
    pub transitions: Vec<TransitionIndex>,
    /// What the cost function says of the marking it leads to; 0 where the aim is reached.
    pub cost: u32,
}

/// The silent transitions that can, one after another, bring a token to an input place of one of
/// `targets`; the shortest way to enable a target holds no others.
pub fn helpful(net: &PetriNet, targets: &[TransitionIndex]) -> Vec<TransitionIndex> {
    let mut wanted = vec![false; net.places.len()];
    for &target in targets {
        for &place in &net.transitions[target as usize].inputs {
            wanted[place as usize] = true;
        }
    }
    let mut helpful = vec![false; net.transitions.len()];
    loop {
        let mut grown = false;
        for (index, transition) in net.transitions.iter().enumerate() {
            let helps = transition.outputs.iter().any(|&place| wanted[place as usize]);
            if transition.label.is_some() || helpful[index] || !helps {
                continue;
            }
            helpful[index] = true;
            grown = true;
            for &place in &transition.inputs {
                wanted[place as usize] = true;
            }
        }
        if !grown {
            return numbers(&helpful);
        }
    }
}

/// All silent transitions.
pub fn all(net: &PetriNet) -> Vec<TransitionIndex> {
    numbers(&net.transitions.iter().map(|t| t.label.is_none()).collect::<Vec<_>>())
}

fn numbers(marked: &[bool]) -> Vec<TransitionIndex> {
    (0..).zip(marked).filter(|(_, marked)| **marked).map(|(index, _)| index).collect()
}

/// One marking met in a search, and how it was come by.
struct Step {
    marking: Vec<u32>,
    from: usize,
    by: TransitionIndex,
}

/// Breadth first from `start`: the fewest firings of `silent` to the marking of least `cost`.
pub fn shortest(
    net: &PetriNet,
    start: &[u32],
    silent: &[TransitionIndex],
    cost: impl Fn(&[u32]) -> u32,
) -> SilentPath {
    let mut best = (0, cost(start));
    let mut steps = vec![Step { marking: start.to_vec(), from: 0, by: 0 }];
    let mut seen: HashSet<Vec<u32>> = HashSet::from([start.to_vec()]);
    let mut next = 0;
    while best.1 > 0 && next < steps.len() && steps.len() < MARKINGS_AT_MOST {
        for &by in silent {
            if !net.enabled(&steps[next].marking, by) {
                continue;
            }
            let mut marking = steps[next].marking.clone();
            net.fire(&mut marking, by);
            if !seen.insert(marking.clone()) {
                continue;
            }
            let amiss = cost(&marking);
            steps.push(Step { marking, from: next, by });
            if amiss < best.1 {
                best = (steps.len() - 1, amiss);
            }
        }
        next += 1;
    }
    let mut transitions = Vec::new();
    let mut at = best.0;
    while at > 0 {
        transitions.push(steps[at].by);
        at = steps[at].from;
    }
    transitions.reverse();
    SilentPath { transitions, cost: best.1 }
}
