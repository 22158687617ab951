//! The weighted automaton of one region in one phase: several initial and final states, and how
//! often each transition was seen (section 3.4).

use std::borrow::Cow;
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, HashMap};

use crate::log::Nanoseconds;

use super::regions::Word;
use super::sequences::Sequence;

/// Number of a state.
pub type State = u32;

/// What followed, for one way a state was entered.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Then {
    /// State entered next.
    pub to: State,
    /// How often.
    pub count: u64,
    /// The shortest stay before it.
    pub shortest: Nanoseconds,
    /// The longest time nothing at all had changed before it.
    pub longest_quiet: Nanoseconds,
    /// Where among all changes of the machine in a sequence it came, and how often: what tells
    /// which of several awaited changes comes first.
    pub positions: BTreeMap<u32, u64>,
}

/// Positions that lie further apart belong to different moments of the sequence.
const ONE_MOMENT: u32 = 6;

/// Passes from which on one way of entering a state speaks for itself.
const EVIDENCE: u64 = 30;

impl Then {
    fn add(&mut self, other: &Self) {
        self.count += other.count;
        self.shortest = self.shortest.min(other.shortest);
        self.longest_quiet = self.longest_quiet.max(other.longest_quiet);
        for (&position, &count) in &other.positions {
            *self.positions.entry(position).or_default() += count;
        }
    }

    /// When it is next due after a position: the mean of that moment, and how often it was.
    /// `None` where it only ever came earlier.
    pub fn due(&self, now: Option<u32>) -> Option<(f64, u64)> {
        let mut moment: Option<(u32, f64, u64)> = None;
        for (&position, &count) in &self.positions {
            let weighted = f64::from(position) * count as f64;
            moment = match moment {
                Some((last, sum, counted)) if position - last <= ONE_MOMENT => {
                    Some((position, sum + weighted, counted + count))
                }
                Some((last, ..)) if now.is_none_or(|now| last + ONE_MOMENT >= now) => break,
                _ => Some((position, weighted, count)),
            };
        }
        let (last, sum, counted) = moment?;
        let due = now.is_none_or(|now| last + ONE_MOMENT >= now);
        due.then(|| (sum / counted.max(1) as f64, counted))
    }
}

/// A transition as it was counted.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Transition {
    /// State left.
    pub from: State,
    /// State entered.
    pub to: State,
    /// How often.
    pub weight: u64,
    /// The longest time the entered state was kept having come this way.
    pub longest_stay: Nanoseconds,
    /// What followed having come this way, most frequent first.
    pub then: Vec<Then>,
}

/// A word of a region.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Node {
    /// The word.
    pub word: Word,
    /// How often sequences began with it.
    pub initial: u64,
    /// How often they ended with it.
    pub last: u64,
    /// The longest time it was kept as the first word of a sequence.
    pub longest_first_stay: Nanoseconds,
    /// What followed where a sequence began with it.
    pub then: Vec<Then>,
}

/// How a state was entered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Came {
    /// Nobody knows.
    Unknown,
    /// The sequence began with it.
    First,
    /// By a transition, by number.
    By(u32),
}

/// What is known of a stay in a state.
#[derive(Debug, Clone)]
pub struct Outlook<'a> {
    /// How often the state was entered so.
    pub passes: u64,
    /// The longest stay.
    pub stay: Nanoseconds,
    /// What followed.
    pub then: Cow<'a, [Then]>,
}

/// Share of passes that another change must have followed, for it to be awaited: elsewhere the
/// sequence may as well end here.
const AWAITED_SHARE: f64 = 0.95;

impl Outlook<'_> {
    /// True where the region itself goes on from here.
    pub fn goes_on(&self) -> bool {
        let followed: u64 = self.then.iter().map(|then| then.count).sum();
        followed as f64 >= AWAITED_SHARE * self.passes as f64
    }
}

/// The automaton.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Machine {
    /// By number, in the order first seen.
    pub nodes: Vec<Node>,
    /// By state left, heaviest first.
    pub transitions: Vec<Transition>,
    /// Where the transitions of each state begin; one longer than the states.
    starts: Vec<u32>,
    /// Words entered, beside `transitions`: what the hot loop compares.
    entered: Vec<Word>,
    by_word: HashMap<Word, State>,
}

impl Machine {
    /// Counts sequences, each a row of a training file.
    pub fn of<'a>(sequences: impl IntoIterator<Item = &'a Sequence>) -> Self {
        let mut by_word: HashMap<Word, State> = HashMap::new();
        let mut nodes: Vec<Node> = Vec::new();
        let mut counted: HashMap<(State, State), Transition> = HashMap::new();
        let mut then: HashMap<(Option<State>, State, State), Then> = HashMap::new();
        for sequence in sequences {
            let mut before: Option<State> = None;
            let mut here: Option<(State, Nanoseconds)> = None;
            for (place, entered) in sequence.words.iter().enumerate() {
                let left = sequence.words.get(place + 1).map_or(sequence.end, |next| next.time);
                let stay = left.saturating_sub(entered.time);
                let state = *by_word.entry(entered.word).or_insert_with(|| {
                    nodes.push(Node { word: entered.word, ..Node::default() });
                    nodes.len() as State - 1
                });
                match here {
                    None => {
                        let node = &mut nodes[state as usize];
                        node.initial += 1;
                        node.longest_first_stay = node.longest_first_stay.max(stay);
                    }
                    Some((from, since)) => {
                        let counted = counted.entry((from, state)).or_insert(Transition {
                            from,
                            to: state,
                            weight: 0,
                            longest_stay: 0,
                            then: Vec::new(),
                        });
                        counted.weight += 1;
                        counted.longest_stay = counted.longest_stay.max(stay);
                        let then = then.entry((before, from, state)).or_insert(Then {
                            to: state,
                            count: 0,
                            shortest: Nanoseconds::MAX,
                            longest_quiet: 0,
                            positions: BTreeMap::new(),
                        });
                        then.count += 1;
                        then.shortest = then.shortest.min(entered.time.saturating_sub(since));
                        then.longest_quiet = then.longest_quiet.max(entered.quiet);
                        *then.positions.entry(entered.position).or_default() += 1;
                        before = Some(from);
                    }
                }
                here = Some((state, entered.time));
            }
            if let Some((last, _)) = here {
                nodes[last as usize].last += 1;
            }
        }
        for ((before, here, _), then) in then {
            match before {
                None => nodes[here as usize].then.push(then),
                Some(before) => {
                    if let Some(transition) = counted.get_mut(&(before, here)) {
                        transition.then.push(then);
                    }
                }
            }
        }
        Self::assemble(nodes, counted.into_values().collect())
    }

    /// From nodes and transitions in any order; every number must be a node's.
    pub fn assemble(mut nodes: Vec<Node>, mut transitions: Vec<Transition>) -> Self {
        let of_nodes = nodes.iter_mut().map(|node| &mut node.then);
        for then in of_nodes.chain(transitions.iter_mut().map(|t| &mut t.then)) {
            then.sort_by_key(|then| (std::cmp::Reverse(then.count), then.to));
        }
        transitions.sort_by_key(|t| (t.from, std::cmp::Reverse(t.weight), t.to));
        let starts = (0..=nodes.len() as State)
            .map(|state| transitions.partition_point(|t| t.from < state) as u32)
            .collect();
        let entered = transitions.iter().map(|t| nodes[t.to as usize].word).collect();
        let by_word = (0..).zip(&nodes).map(|(state, node)| (node.word, state)).collect();
        Self { nodes, transitions, starts, entered, by_word }
    }

    /// The state of a word.
    pub fn find(&self, word: Word) -> Option<State> {
        self.by_word.get(&word).copied()
    }

    /// The word of a state.
    pub fn word(&self, state: State) -> Word {
        self.nodes[state as usize].word
    }

    /// Transitions out of a state, heaviest first.
    pub fn from(&self, state: State) -> &[Transition] {
        &self.transitions[self.range(state)]
    }

    fn range(&self, state: State) -> std::ops::Range<usize> {
        self.starts[state as usize] as usize..self.starts[state as usize + 1] as usize
    }

    /// The number of the transition from a state to a word.
    #[inline]
    pub fn step(&self, state: State, word: Word) -> Option<u32> {
        let range = self.range(state);
        let place = self.entered[range.clone()].iter().position(|&entered| entered == word)?;
        Some((range.start + place) as u32)
    }

    /// What followed a state entered in some way.
    pub fn then(&self, state: State, came: Came) -> &[Then] {
        match came {
            Came::Unknown => &[],
            Came::First => &self.nodes[state as usize].then,
            Came::By(transition) => &self.transitions[transition as usize].then,
        }
    }

    /// Words that can follow a state, and how often each did: of the way it was entered where that
    /// was seen often enough to tell, else of all ways together. The words are the same.
    pub fn weights(&self, state: State, came: Came) -> Vec<(Word, u64)> {
        let passes = match came {
            Came::By(transition) => self.transitions[transition as usize].weight,
            Came::First => self.nodes[state as usize].initial,
            Came::Unknown => 0,
        };
        let then = self.then(state, came);
        let so = |to: State| then.iter().find(|then| then.to == to).map_or(0, |then| then.count);
        self.from(state)
            .iter()
            .map(|t| (self.word(t.to), if passes >= EVIDENCE { so(t.to) } else { t.weight }))
            .collect()
    }

    /// What followed a state and how long it was kept at most: of the way it was entered, or, where
    /// that was seen too seldom to tell, of all ways together.
    pub fn outlook(&self, state: State, came: Came) -> Outlook<'_> {
        let node = &self.nodes[state as usize];
        let (passes, stay) = match came {
            Came::By(transition) => {
                let transition = &self.transitions[transition as usize];
                (transition.weight, transition.longest_stay)
            }
            Came::First => (node.initial, node.longest_first_stay),
            Came::Unknown => (0, 0),
        };
        if passes >= EVIDENCE {
            return Outlook { passes, stay, then: Cow::Borrowed(self.then(state, came)) };
        }
        let mut passes = node.initial;
        let mut stay = node.longest_first_stay;
        let mut pooled: BTreeMap<State, Then> = BTreeMap::new();
        let mut pool = |all: &[Then]| {
            for then in all {
                match pooled.entry(then.to) {
                    Entry::Vacant(vacant) => {
                        vacant.insert(then.clone());
                    }
                    Entry::Occupied(mut occupied) => occupied.get_mut().add(then),
                }
            }
        };
        pool(&node.then);
        for transition in self.transitions.iter().filter(|t| t.to == state) {
            pool(&transition.then);
            passes += transition.weight;
            stay = stay.max(transition.longest_stay);
        }
        Outlook { passes, stay, then: Cow::Owned(pooled.into_values().collect()) }
    }

    /// Transitions out of a state, with their numbers; those that followed it when it was entered
    /// so come first, most frequent first. Where nothing is known of that, all count alike.
    pub fn onwards(&self, state: State, came: Came) -> Vec<(u32, &Transition)> {
        let then = self.then(state, came);
        let rank = |to: State| then.iter().position(|then| then.to == to);
        let range = self.range(state);
        let mut onwards: Vec<(u32, &Transition)> =
            (range.start as u32..).zip(&self.transitions[range]).collect();
        if !then.is_empty() {
            onwards.retain(|(_, t)| rank(t.to).is_some());
            onwards.sort_by_key(|(_, t)| rank(t.to));
        }
        onwards
    }

    /// True where a sequence was seen to begin so.
    pub fn is_initial(&self, state: State) -> bool {
        self.nodes[state as usize].initial > 0
    }

    /// True where a sequence was seen to end so.
    pub fn is_final(&self, state: State) -> bool {
        self.nodes[state as usize].last > 0
    }

    /// True where nothing was learned.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cycle::image::Phase;
    use crate::cycle::sequences::Entered;

    fn sequence(words: &[Word]) -> Sequence {
        let words = words
            .iter()
            .zip(0..)
            .map(|(&word, time)| Entered { word, time, quiet: 1, position: 0 })
            .collect();
        Sequence { phase: Phase::Work, words, end: 100 }
    }

    /// A byte comes by 0 on its way out, and again on its way back.
    fn there_and_back(cycles: usize) -> Machine {
        let sequences = vec![sequence(&[2, 0, 1, 0, 2]); cycles];
        Machine::of(&sequences)
    }

    #[test]
    fn what_follows_depends_on_the_way_in_where_that_is_seen_often() {
        let machine = there_and_back(40);
        let out = machine.find(2).unwrap_or_default();
        let between = machine.find(0).unwrap_or_default();
        let came = Came::By(machine.step(out, 0).unwrap_or_default());
        let mut weights = machine.weights(between, came);
        weights.sort_unstable();
        assert_eq!(weights, [(1, 40), (2, 0)]);
        let mut pooled = machine.weights(between, Came::Unknown);
        pooled.sort_unstable();
        assert_eq!(pooled, [(1, 40), (2, 40)]);
    }

    #[test]
    fn a_way_in_that_is_seen_seldom_tells_nothing() {
        let machine = there_and_back(10);
        let out = machine.find(2).unwrap_or_default();
        let between = machine.find(0).unwrap_or_default();
        let came = Came::By(machine.step(out, 0).unwrap_or_default());
        let mut weights = machine.weights(between, came);
        weights.sort_unstable();
        assert_eq!(weights, [(1, 10), (2, 10)]);
    }
}
