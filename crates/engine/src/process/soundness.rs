//! Soundness of a net (van der Aalst 1997): whatever happens, a run can end, nothing is left over
//! when it does, and every transition can happen. Found by walking through all markings; where a net
//! is not sound, the way to the fault is told in activities.

use hashbrown::HashMap;

use super::petri::{Marking, PetriNet, PlaceIndex, TransitionIndex};

/// Markings looked at before the question is left open.
const MARKINGS_AT_MOST: usize = 100_000;
/// Problems told of each kind.
const TOLD_AT_MOST: usize = 3;

/// What is wrong, and how the net gets there: labels of the activities before it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Problem {
    /// Nothing can happen, and the run has not ended.
    Stuck {
        /// Activities on the way.
        after: Vec<String>,
        /// Places that hold tokens.
        waiting: Vec<String>,
        /// Activities that wait for tokens they will not get.
        blocked: Vec<String>,
    },
    /// Something can happen forever, but the run can never end.
    NeverEnds {
        /// Activities on the way.
        after: Vec<String>,
    },
    /// The run has ended and tokens are left.
    LeftOver {
        /// Activities on the way.
        after: Vec<String>,
        /// Places that still hold tokens.
        places: Vec<String>,
    },
    /// Tokens pile up without end.
    Unbounded {
        /// Activities on the way.
        after: Vec<String>,
        /// Where they pile up.
        places: Vec<String>,
    },
    /// An activity, or a silent transition by its identifier, that can never happen.
    Dead {
        /// Its name.
        name: String,
    },
}

/// The answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Soundness {
    /// None where the net has more markings than were looked at, and none of these is wrong.
    pub sound: Option<bool>,
    /// What is wrong with it.
    pub problems: Vec<Problem>,
    /// Markings looked at.
    pub markings: usize,
}

impl std::fmt::Display for Problem {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let list = |names: &[String]| -> String {
            const SHOWN: usize = 8;
            let from = names.len().saturating_sub(SHOWN);
            let before = if from > 0 { "…, " } else { "" };
            format!("{before}{}", names[from..].join(", "))
        };
        let way = |after: &[String]| match after {
            [] => "at the start".to_owned(),
            after => format!("after {}", list(after)),
        };
        match self {
            Self::Stuck { after, waiting, blocked } if blocked.is_empty() => {
                write!(f, "{} the run is stuck: tokens wait in {}", way(after), list(waiting))
            }
            Self::Stuck { after, blocked, .. } => {
                write!(
                    f,
                    "{} the run is stuck: {} waits for something that will not come",
                    way(after),
                    list(blocked)
                )
            }
            Self::NeverEnds { after } => write!(f, "{} the run can no longer end", way(after)),
            Self::LeftOver { after, places } => {
                write!(
                    f,
                    "{} the run has ended, but tokens are left in {}",
                    way(after),
                    list(places)
                )
            }
            Self::Unbounded { after, places } => {
                write!(f, "{} tokens pile up in {} without end", way(after), list(places))
            }
            Self::Dead { name } => write!(f, "{name} can never happen"),
        }
    }
}

/// Checks a net.
pub fn soundness(net: &PetriNet) -> Soundness {
    let mut space = Space::of(net);
    space.walk();
    let problems = space.problems();
    let sound = match (problems.is_empty(), space.complete) {
        (false, _) => Some(false),
        (true, true) => Some(true),
        (true, false) => None,
    };
    Soundness { sound, problems, markings: space.markings.len() }
}

struct Space<'n> {
    net: &'n PetriNet,
    markings: Vec<Marking>,
    numbers: HashMap<Marking, usize>,
    /// How each marking was first come by.
    by: Vec<Option<(usize, TransitionIndex)>>,
    next: Vec<Vec<usize>>,
    fired: Vec<bool>,
    unbounded: Option<(usize, Vec<PlaceIndex>)>,
    complete: bool,
}

impl<'n> Space<'n> {
    fn of(net: &'n PetriNet) -> Self {
        Self {
            net,
            markings: vec![net.initial.clone()],
            numbers: HashMap::from_iter([(net.initial.clone(), 0)]),
            by: vec![None],
            next: vec![Vec::new()],
            fired: vec![false; net.transitions.len()],
            unbounded: None,
            complete: true,
        }
    }

    fn walk(&mut self) {
        let mut current = 0;
        while current < self.markings.len() && self.unbounded.is_none() {
            for transition in 0..self.net.transitions.len() as TransitionIndex {
                if !self.net.enabled(&self.markings[current], transition) {
                    continue;
                }
                self.fired[transition as usize] = true;
                let mut after = self.markings[current].clone();
                self.net.fire(&mut after, transition);
                let number = match self.numbers.get(&after) {
                    Some(&known) => known,
                    None if self.markings.len() >= MARKINGS_AT_MOST => {
                        self.complete = false;
                        return;
                    }
                    None => self.add(after, current, transition),
                };
                self.next[current].push(number);
            }
            current += 1;
        }
    }

    fn add(&mut self, marking: Marking, from: usize, by: TransitionIndex) -> usize {
        let new = self.markings.len();
        // More than one token somewhere is the only way to tokens without end: else skip the walk up.
        if marking.iter().any(|&tokens| tokens > 1) {
            let mut above = Some(from);
            while let Some(earlier) = above {
                let covered = self.markings[earlier].iter().zip(&marking).all(|(a, b)| a <= b);
                if covered {
                    let grown = (0..marking.len())
                        .filter(|&place| marking[place] > self.markings[earlier][place])
                        .map(|place| place as PlaceIndex);
                    self.unbounded = Some((new, grown.collect()));
                    break;
                }
                above = self.by[earlier].map(|(before, _)| before);
            }
        }
        self.numbers.insert(marking.clone(), new);
        self.markings.push(marking);
        self.by.push(Some((from, by)));
        self.next.push(Vec::new());
        new
    }

    fn problems(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        if let Some((marking, places)) = &self.unbounded {
            let after = self.way(*marking);
            problems.push(Problem::Unbounded { after, places: self.names(places) });
            return problems;
        }
        let last = &self.net.last;
        let is_over = |marking: &Marking| marking.iter().zip(last).all(|(is, end)| is >= end);
        for (number, marking) in self.markings.iter().enumerate() {
            if marking != last && is_over(marking) {
                let left = (0..marking.len())
                    .filter(|&place| marking[place] > last[place])
                    .map(|place| place as PlaceIndex)
                    .collect::<Vec<_>>();
                let (after, places) = (self.way(number), self.names(&left));
                problems.push(Problem::LeftOver { after, places });
                if problems.len() == TOLD_AT_MOST {
                    break;
                }
            }
        }
        if !self.complete {
            return problems;
        }
        problems.extend(self.ends());
        if problems.is_empty() || self.fired.iter().any(|&fired| fired) {
            let dead = self.net.transitions.iter().zip(&self.fired).filter(|(_, fired)| !**fired);
            problems.extend(dead.take(TOLD_AT_MOST).map(|(transition, _)| Problem::Dead {
                name: transition.label.clone().unwrap_or_else(|| transition.id.clone()),
            }));
        }
        problems
    }

    /// Markings from which the final one cannot be reached.
    fn ends(&self) -> Vec<Problem> {
        let mut before = vec![Vec::new(); self.markings.len()];
        for (from, next) in self.next.iter().enumerate() {
            for &to in next {
                before[to].push(from);
            }
        }
        let mut can_end = vec![false; self.markings.len()];
        let mut waiting: Vec<usize> =
            self.numbers.get(&self.net.last).copied().into_iter().collect();
        for &end in &waiting {
            can_end[end] = true;
        }
        while let Some(marking) = waiting.pop() {
            for &earlier in &before[marking] {
                if !std::mem::replace(&mut can_end[earlier], true) {
                    waiting.push(earlier);
                }
            }
        }
        let over = |number: usize| {
            self.markings[number].iter().zip(&self.net.last).all(|(is, end)| is >= end)
        };
        let lost = (0..self.markings.len()).filter(|&number| !can_end[number] && !over(number));
        let (stuck, living): (Vec<usize>, Vec<usize>) =
            lost.partition(|&number| self.next[number].is_empty());
        if stuck.is_empty() {
            let first =
                living.first().map(|&number| Problem::NeverEnds { after: self.way(number) });
            return first.into_iter().collect();
        }
        stuck
            .into_iter()
            .take(TOLD_AT_MOST)
            .map(|number| Problem::Stuck {
                after: self.way(number),
                waiting: self.names(&self.held(number)),
                blocked: self.blocked(number),
            })
            .collect()
    }

    fn held(&self, number: usize) -> Vec<PlaceIndex> {
        let tokens = self.markings[number].iter().enumerate().filter(|(_, tokens)| **tokens > 0);
        tokens.map(|(place, _)| place as PlaceIndex).collect()
    }

    /// Activities, or those behind a silent transition, that have some of their tokens.
    fn blocked(&self, number: usize) -> Vec<String> {
        let held = self.held(number);
        let partly =
            self.net.transitions.iter().filter(|t| t.inputs.iter().any(|p| held.contains(p)));
        let mut names: Vec<String> = Vec::new();
        for transition in partly {
            match &transition.label {
                Some(label) => names.push(label.clone()),
                None => {
                    let behind = self.net.transitions.iter().filter(|later| {
                        later.inputs.iter().any(|place| transition.outputs.contains(place))
                    });
                    names.extend(behind.filter_map(|later| later.label.clone()));
                }
            }
        }
        names.sort_unstable();
        names.dedup();
        names
    }

    /// Labels on the first way found to a marking.
    fn way(&self, number: usize) -> Vec<String> {
        let mut labels = Vec::new();
        let mut current = number;
        while let Some((before, transition)) = self.by[current] {
            labels.extend(self.net.transitions[transition as usize].label.clone());
            current = before;
        }
        labels.reverse();
        labels
    }

    fn names(&self, places: &[PlaceIndex]) -> Vec<String> {
        places.iter().map(|&place| self.net.places[place as usize].clone()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::soundness;
    use crate::process::petri::{PetriNet, Transition};

    /// `(label or "", inputs, outputs)`; place 0 is the start, place 1 the end.
    fn net(places: usize, transitions: &[(&str, &[u32], &[u32])]) -> PetriNet {
        let mut net = PetriNet {
            places: (0..places).map(|place| format!("p{place}")).collect(),
            initial: vec![0; places],
            last: vec![0; places],
            ..PetriNet::default()
        };
        (net.initial[0], net.last[1]) = (1, 1);
        for (number, &(label, inputs, outputs)) in transitions.iter().enumerate() {
            net.transitions.push(Transition {
                id: format!("t{number}"),
                label: (!label.is_empty()).then(|| label.to_owned()),
                class: None,
                inputs: inputs.to_vec(),
                outputs: outputs.to_vec(),
            });
        }
        net
    }

    fn told(net: &PetriNet) -> (Option<bool>, Vec<String>) {
        let found = soundness(net);
        (found.sound, found.problems.iter().map(ToString::to_string).collect())
    }

    #[test]
    fn a_sound_net() {
        let net = net(4, &[("a", &[0], &[2, 3]), ("b", &[2, 3], &[1])]);
        assert_eq!(told(&net), (Some(true), vec![]));
    }

    #[test]
    fn a_choice_that_is_joined_as_if_it_were_none_is_stuck() {
        let net = net(4, &[("a", &[0], &[2]), ("b", &[0], &[3]), ("c", &[2, 3], &[1])]);
        let (sound, problems) = told(&net);
        assert_eq!(sound, Some(false));
        assert_eq!(
            problems[0],
            "after a the run is stuck: c waits for something that will not come"
        );
        assert!(problems.contains(&"c can never happen".to_owned()), "{problems:?}");
    }

    #[test]
    fn concurrency_that_is_joined_as_a_choice_leaves_tokens() {
        let net = net(4, &[("a", &[0], &[2, 3]), ("b", &[2], &[1]), ("c", &[3], &[1])]);
        let (sound, problems) = told(&net);
        assert_eq!(sound, Some(false));
        assert_eq!(problems[0], "after a, b the run has ended, but tokens are left in p3");
    }

    #[test]
    fn tokens_without_end() {
        let net = net(3, &[("a", &[0], &[0, 2]), ("b", &[0], &[1])]);
        let (sound, problems) = told(&net);
        assert_eq!(sound, Some(false));
        assert_eq!(problems, ["after a, a tokens pile up in p2 without end"]);
    }

    #[test]
    fn a_run_that_cannot_end() {
        let net = net(3, &[("a", &[0], &[1]), ("b", &[0], &[2]), ("c", &[2], &[2])]);
        assert_eq!(told(&net), (Some(false), vec!["after b the run can no longer end".to_owned()]));
    }
}
