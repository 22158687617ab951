//! What a net allows, as a deterministic automaton that is worked out where it is walked.
//!
//! Its states are the sets of markings that silent transitions cannot be told apart by. A walk
//! along a trace is exact: it fails only where no way of silent firings allows the trace.

use std::collections::BTreeSet;

use hashbrown::HashMap;

use super::event_log::{Activity, ActivityIndex};
use super::petri::{Marking, PetriNet, TransitionIndex};

/// Markings in one state before the automaton gives up: the net is not sound, or too concurrent.
const MARKINGS_AT_MOST: usize = 1 << 12;
/// States kept.
const STATES_AT_MOST: usize = 1 << 16;

const UNKNOWN: u32 = u32::MAX;
const NOWHERE: u32 = u32::MAX - 1;

/// A state of the automaton.
pub type State = u32;

/// The automaton of a net, over the activities of an event log.
pub struct Language<'n> {
    net: &'n PetriNet,
    /// Visible transitions of each activity of the log.
    of_activity: Vec<Vec<TransitionIndex>>,
    silent: Vec<TransitionIndex>,
    states: Vec<Vec<Marking>>,
    numbers: HashMap<Vec<Marking>, State>,
    next: Vec<u32>,
    /// Names enabled in each state, of the log or not: how many, and which of the log's.
    enabled: Vec<Option<(usize, Vec<ActivityIndex>)>>,
    gave_up: bool,
}

impl<'n> Language<'n> {
    /// Nothing is worked out yet but the start.
    pub fn new(net: &'n PetriNet, activities: &[Activity]) -> Self {
        let by_name: HashMap<&str, usize> =
            activities.iter().enumerate().map(|(index, a)| (a.name.as_str(), index)).collect();
        let mut of_activity = vec![Vec::new(); activities.len()];
        let mut silent = Vec::new();
        for (index, transition) in net.transitions.iter().enumerate() {
            match &transition.label {
                Some(label) => {
                    if let Some(&activity) = by_name.get(label.as_str()) {
                        of_activity[activity].push(index as TransitionIndex);
                    }
                }
                None => silent.push(index as TransitionIndex),
            }
        }
        let mut language = Self {
            net,
            of_activity,
            silent,
            states: Vec::new(),
            numbers: HashMap::new(),
            next: Vec::new(),
            enabled: Vec::new(),
            gave_up: false,
        };
        language.number(BTreeSet::from([net.initial.clone()]));
        language
    }

    /// The state before the first event.
    pub fn start(&self) -> State {
        0
    }

    /// True where the automaton became too large to be exact: what it denies then may be allowed.
    pub fn gave_up(&self) -> bool {
        self.gave_up
    }

    /// Where an activity leads; none where it is not allowed.
    pub fn step(&mut self, state: State, activity: ActivityIndex) -> Option<State> {
        let cell = state as usize * self.of_activity.len() + activity as usize;
        if self.next[cell] == UNKNOWN {
            self.next[cell] = self.work_out(state, activity);
        }
        Some(self.next[cell]).filter(|&next| next != NOWHERE)
    }

    /// True where a run may end.
    pub fn accepts(&self, state: State) -> bool {
        self.states[state as usize].contains(&self.net.last)
    }

    /// How many activities are allowed, and which of them the log has.
    pub fn enabled(&mut self, state: State) -> &(usize, Vec<ActivityIndex>) {
        let (net, markings) = (self.net, &self.states[state as usize]);
        let of_activity = &self.of_activity;
        self.enabled[state as usize].get_or_insert_with(|| {
            let is_enabled = |&t: &TransitionIndex| markings.iter().any(|m| net.enabled(m, t));
            let names: BTreeSet<&str> = (0..net.transitions.len() as TransitionIndex)
                .filter(is_enabled)
                .filter_map(|t| net.transitions[t as usize].label.as_deref())
                .collect();
            let of_log = (0..of_activity.len())
                .filter(|&activity| of_activity[activity].iter().any(is_enabled))
                .map(|activity| activity as ActivityIndex);
            (names.len(), of_log.collect())
        })
    }

    /// True where the net allows the whole trace.
    pub fn allows(&mut self, trace: &[ActivityIndex]) -> bool {
        let mut state = self.start();
        for &activity in trace {
            match self.step(state, activity) {
                Some(next) => state = next,
                None => return false,
            }
        }
        self.accepts(state)
    }

    fn work_out(&mut self, state: State, activity: ActivityIndex) -> u32 {
        let mut reached = BTreeSet::new();
        for marking in &self.states[state as usize] {
            for &transition in &self.of_activity[activity as usize] {
                if self.net.enabled(marking, transition) {
                    let mut after = marking.clone();
                    self.net.fire(&mut after, transition);
                    reached.insert(after);
                }
            }
        }
        if reached.is_empty() {
            return NOWHERE;
        }
        if self.states.len() >= STATES_AT_MOST {
            self.gave_up = true;
            return NOWHERE;
        }
        self.number(reached)
    }

    /// The state of some markings and all that silent transitions make of them.
    fn number(&mut self, mut markings: BTreeSet<Marking>) -> State {
        let mut waiting: Vec<Marking> = markings.iter().cloned().collect();
        while let Some(marking) = waiting.pop() {
            for &transition in &self.silent {
                if self.net.enabled(&marking, transition) {
                    let mut after = marking.clone();
                    self.net.fire(&mut after, transition);
                    if markings.len() >= MARKINGS_AT_MOST {
                        self.gave_up = true;
                        waiting.clear();
                        break;
                    }
                    if markings.insert(after.clone()) {
                        waiting.push(after);
                    }
                }
            }
        }
        let markings: Vec<Marking> = markings.into_iter().collect();
        if let Some(&known) = self.numbers.get(&markings) {
            return known;
        }
        let new = self.states.len() as State;
        self.states.push(markings.clone());
        self.numbers.insert(markings, new);
        self.enabled.push(None);
        self.next.resize(self.states.len() * self.of_activity.len(), UNKNOWN);
        new
    }
}

#[cfg(test)]
mod tests {
    use super::Language;
    use crate::process::event_log::EventLog;
    use crate::process::split_miner::{MiningParameters, mine};

    #[test]
    fn a_net_allows_what_it_was_mined_from_and_no_more() {
        let log = EventLog::from_traces([
            vec!["a", "b", "c", "d"],
            vec!["a", "c", "b", "d"],
            vec!["a", "b", "d"],
            vec!["d"],
        ]);
        let net = mine(&log.select(&[0, 1]), &MiningParameters::default())
            .map(|mined| mined.net)
            .unwrap_or_default();
        let mut language = Language::new(&net, &log.activities);
        let allowed: Vec<bool> = (0..4).map(|trace| language.allows(log.trace(trace))).collect();
        assert_eq!(allowed, [true, true, false, false]);
        assert_eq!(language.enabled(0), &(1, vec![0]));
        assert!(!language.gave_up());
    }
}
