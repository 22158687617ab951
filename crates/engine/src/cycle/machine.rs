//! The weighted automaton of one region in one phase: several initial and final states, and how
//! often each transition was seen (section 3.4).

use std::collections::HashMap;

use crate::log::Nanoseconds;

use super::regions::Word;
use super::sequences::Sequence;

/// Number of a state.
pub type State = u32;

/// A transition as it was counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Transition {
    /// State left.
    pub from: State,
    /// State entered.
    pub to: State,
    /// How often.
    pub weight: u64,
    /// The longest time the entered state was kept having come this way.
    pub longest_stay: Nanoseconds,
}

/// A word of a region.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Node {
    /// The word.
    pub word: Word,
    /// How often sequences began with it.
    pub initial: u64,
    /// How often they ended with it.
    pub last: u64,
    /// The longest time it was kept as the first word of a sequence.
    pub longest_first_stay: Nanoseconds,
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
        for sequence in sequences {
            let mut before: Option<State> = None;
            for (place, &(word, time)) in sequence.words.iter().enumerate() {
                let left = sequence.words.get(place + 1).map_or(sequence.end, |next| next.1);
                let stay = left.saturating_sub(time);
                let state = *by_word.entry(word).or_insert_with(|| {
                    nodes.push(Node { word, ..Node::default() });
                    nodes.len() as State - 1
                });
                match before {
                    None => {
                        let node = &mut nodes[state as usize];
                        node.initial += 1;
                        node.longest_first_stay = node.longest_first_stay.max(stay);
                    }
                    Some(from) => {
                        let counted = counted.entry((from, state)).or_insert(Transition {
                            from,
                            to: state,
                            weight: 0,
                            longest_stay: 0,
                        });
                        counted.weight += 1;
                        counted.longest_stay = counted.longest_stay.max(stay);
                    }
                }
                before = Some(state);
            }
            if let Some(last) = before {
                nodes[last as usize].last += 1;
            }
        }
        Self::assemble(nodes, counted.into_values().collect())
    }

    /// From nodes and transitions in any order; every number must be a node's.
    pub fn assemble(nodes: Vec<Node>, mut transitions: Vec<Transition>) -> Self {
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

    /// The transition from a state to a word.
    #[inline]
    pub fn step(&self, state: State, word: Word) -> Option<&Transition> {
        let range = self.range(state);
        let place = self.entered[range.clone()].iter().position(|&entered| entered == word)?;
        self.transitions.get(range.start + place)
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
