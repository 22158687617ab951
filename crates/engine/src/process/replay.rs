//! Token replay: a net follows a sequence of activities, whether it allows them or not.
//!
//! A transition that is not enabled first tries the shortest way of silent firings; where none
//! enables it, the tokens it lacks are added and counted as missing. Which marking follows which
//! by which activity is worked out once and remembered: a machine repeats itself, so replaying a
//! long log is a walk through a table.

use hashbrown::HashMap;

use super::event_log::Activity;
use super::petri::{PetriNet, PlaceIndex, TransitionIndex};
use super::silent;

/// Markings remembered; where a net that is not sound piles up tokens, remembering starts anew.
const MARKINGS_AT_MOST: usize = 1 << 14;

const UNKNOWN: u32 = u32::MAX;

/// What one event moved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Moved {
    /// Tokens taken, by silent transitions too.
    pub consumed: u32,
    /// Tokens put down, by silent transitions too.
    pub produced: u32,
    /// Tokens that had to be added.
    pub missing: u32,
    /// The net has a transition for the activity.
    pub known: bool,
    next: u32,
    first_touched: u32,
    touched: u32,
}

/// Tokens of one whole trace (van der Aalst, Process Mining, section 8.2).
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Tokens {
    /// Put down, the initial marking counted.
    pub produced: u64,
    /// Taken, the final marking counted.
    pub consumed: u64,
    /// Added, because a transition lacked them.
    pub missing: u64,
    /// Left over at the end.
    pub remaining: u64,
    /// Events of activities the net does not have.
    pub unknown: u64,
}

impl Tokens {
    /// 1 where nothing was missing and nothing remained.
    pub fn fitness(&self) -> f64 {
        let share = |part: u64, whole: u64| {
            if whole == 0 { 0.0 } else { part as f64 / whole as f64 }
        };
        let missing = share(self.missing, self.consumed);
        let remaining = share(self.remaining, self.produced);
        0.5 * (1.0 - missing) + 0.5 * (1.0 - remaining)
    }

    /// The net allows the trace as it stands.
    pub fn fits(&self) -> bool {
        self.missing == 0 && self.remaining == 0 && self.unknown == 0
    }

    /// Sums over traces.
    pub fn add(&mut self, other: &Self) {
        self.produced += other.produced;
        self.consumed += other.consumed;
        self.missing += other.missing;
        self.remaining += other.remaining;
        self.unknown += other.unknown;
    }
}

/// A net and where its tokens are.
#[derive(Debug, Clone)]
pub struct TokenReplay {
    net: PetriNet,
    /// Transitions of each activity, and the silent ones that can help to enable them.
    candidates: Vec<(Vec<TransitionIndex>, Vec<TransitionIndex>)>,
    /// Markings by their number, one after another.
    markings: Vec<u32>,
    numbers: HashMap<Vec<u32>, u32>,
    /// Number of the move by marking and activity.
    table: Vec<u32>,
    moves: Vec<Moved>,
    touched: Vec<PlaceIndex>,
    current: u32,
}

impl TokenReplay {
    /// At the initial marking. Activities are numbered as in `activities`.
    pub fn new<'a>(net: &PetriNet, activities: impl IntoIterator<Item = &'a str>) -> Self {
        let mut by_label: HashMap<&str, Vec<TransitionIndex>> = HashMap::new();
        for (index, transition) in (0..).zip(&net.transitions) {
            if let Some(label) = &transition.label {
                by_label.entry(label).or_default().push(index);
            }
        }
        let candidates = activities
            .into_iter()
            .map(|name| {
                let transitions = by_label.get(name).cloned().unwrap_or_default();
                let helpful = silent::helpful(net, &transitions);
                (transitions, helpful)
            })
            .collect();
        let mut replay = Self {
            net: net.clone(),
            candidates,
            markings: Vec::new(),
            numbers: HashMap::new(),
            table: Vec::new(),
            moves: Vec::new(),
            touched: Vec::new(),
            current: 0,
        };
        replay.restart();
        replay
    }

    /// Over the activities of an event log.
    pub fn of(net: &PetriNet, activities: &[Activity]) -> Self {
        Self::new(net, activities.iter().map(|activity| activity.name.as_str()))
    }

    /// The net that is replayed.
    pub fn net(&self) -> &PetriNet {
        &self.net
    }

    /// Back to the initial marking.
    pub fn restart(&mut self) {
        let initial = self.net.initial.clone();
        self.current = self.number(&initial);
    }

    /// Tokens on each place.
    pub fn marking(&self) -> &[u32] {
        self.marking_of(self.current)
    }

    /// Puts the tokens as they stand elsewhere. `marking` has one entry per place.
    pub fn place(&mut self, marking: &[u32]) {
        self.current = self.number(marking);
    }

    /// Follows one event; no allocation where the same was met before.
    pub fn step(&mut self, activity: u32) -> Moved {
        let cell = self.current as usize * self.candidates.len() + activity as usize;
        let mut index = self.table[cell];
        if index == UNKNOWN {
            index = self.work_out(activity);
        }
        let moved = self.moves[index as usize];
        self.current = moved.next;
        moved
    }

    /// The places an event activated: those it put a token on, and those whose count it changed.
    pub fn touched(&self, moved: &Moved) -> &[PlaceIndex] {
        let first = moved.first_touched as usize;
        &self.touched[first..first + moved.touched as usize]
    }

    /// Follows a whole trace from the initial marking to the final one.
    pub fn trace(&mut self, activities: &[u32]) -> Tokens {
        self.restart();
        let initial = self.net.initial.iter().map(|&tokens| u64::from(tokens)).sum();
        let mut tokens = Tokens { produced: initial, ..Tokens::default() };
        for &activity in activities {
            let moved = self.step(activity);
            tokens.produced += u64::from(moved.produced);
            tokens.consumed += u64::from(moved.consumed);
            tokens.missing += u64::from(moved.missing);
            tokens.unknown += u64::from(!moved.known);
        }
        tokens.add(&self.end());
        tokens
    }

    /// What it takes from the present marking to the final one: silent firings first.
    pub fn end(&self) -> Tokens {
        let wanted = &self.net.last;
        let amiss = |marking: &[u32]| -> u32 {
            marking.iter().zip(wanted).map(|(is, wanted)| is.abs_diff(*wanted)).sum()
        };
        let path = silent::shortest(&self.net, self.marking(), &silent::all(&self.net), amiss);
        let mut marking = self.marking().to_vec();
        let mut tokens = Tokens::default();
        for &transition in &path.transitions {
            self.net.fire(&mut marking, transition);
            tokens.consumed += self.net.transitions[transition as usize].inputs.len() as u64;
            tokens.produced += self.net.transitions[transition as usize].outputs.len() as u64;
        }
        for (&is, &wanted) in marking.iter().zip(wanted) {
            tokens.consumed += u64::from(wanted);
            tokens.missing += u64::from(wanted.saturating_sub(is));
            tokens.remaining += u64::from(is.saturating_sub(wanted));
        }
        tokens
    }

    fn marking_of(&self, number: u32) -> &[u32] {
        let places = self.net.places.len();
        &self.markings[number as usize * places..][..places]
    }

    /// The number of a marking, given now where it is new.
    fn number(&mut self, marking: &[u32]) -> u32 {
        if let Some(&number) = self.numbers.get(marking) {
            return number;
        }
        if self.numbers.len() == MARKINGS_AT_MOST {
            self.forget();
        }
        let number = self.numbers.len() as u32;
        self.numbers.insert(marking.to_vec(), number);
        self.markings.extend_from_slice(marking);
        self.table.resize(self.numbers.len() * self.candidates.len(), UNKNOWN);
        number
    }

    fn forget(&mut self) {
        self.markings.clear();
        self.numbers.clear();
        self.table.clear();
        self.moves.clear();
        self.touched.clear();
    }

    /// Works out what an activity moves at the present marking, and remembers it.
    fn work_out(&mut self, activity: u32) -> u32 {
        let before = self.marking().to_vec();
        let mut after = before.clone();
        let fired = self.fire(activity, &mut after);
        if self.numbers.len() == MARKINGS_AT_MOST && !self.numbers.contains_key(&after) {
            self.forget();
            self.current = self.number(&before);
        }
        let next = self.number(&after);
        let first_touched = self.touched.len() as u32;
        let touched = (0..after.len())
            .filter(|&place| fired.entered[place] || before[place] != after[place])
            .map(|place| place as PlaceIndex);
        self.touched.extend(touched);
        self.moves.push(Moved {
            consumed: fired.consumed,
            produced: fired.produced,
            missing: fired.missing,
            known: !self.candidates[activity as usize].0.is_empty(),
            next,
            first_touched,
            touched: self.touched.len() as u32 - first_touched,
        });
        let index = self.moves.len() as u32 - 1;
        self.table[self.current as usize * self.candidates.len() + activity as usize] = index;
        index
    }

    fn fire(&self, activity: u32, marking: &mut [u32]) -> Fired {
        let (transitions, helpful) = &self.candidates[activity as usize];
        let mut fired = Fired { entered: vec![false; marking.len()], ..Fired::default() };
        let lacking = |marking: &[u32], transition: TransitionIndex| -> u32 {
            let inputs = &self.net.transitions[transition as usize].inputs;
            inputs.iter().filter(|&&place| marking[place as usize] == 0).count() as u32
        };
        let least =
            |marking: &[u32]| transitions.iter().map(|&t| lacking(marking, t)).min().unwrap_or(0);
        for transition in silent::shortest(&self.net, marking, helpful, least).transitions {
            fired.fire(&self.net, marking, transition);
        }
        if let Some(&transition) = transitions.iter().min_by_key(|&&t| lacking(marking, t)) {
            for &place in &self.net.transitions[transition as usize].inputs {
                if marking[place as usize] == 0 {
                    marking[place as usize] = 1;
                    fired.missing += 1;
                }
            }
            fired.fire(&self.net, marking, transition);
        }
        fired
    }
}

/// What firing moved so far.
#[derive(Default)]
struct Fired {
    consumed: u32,
    produced: u32,
    missing: u32,
    entered: Vec<bool>,
}

impl Fired {
    fn fire(&mut self, net: &PetriNet, marking: &mut [u32], transition: TransitionIndex) {
        net.fire(marking, transition);
        let transition = &net.transitions[transition as usize];
        self.consumed += transition.inputs.len() as u32;
        self.produced += transition.outputs.len() as u32;
        for &place in &transition.outputs {
            self.entered[place as usize] = true;
        }
    }
}
