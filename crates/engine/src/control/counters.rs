//! The counts that guards ask for, kept while a net runs.

use std::collections::HashMap;

use super::error::ControlError;
use super::guards::Guards;
use super::program::Program;
use super::tree::{Counter, Tree};
use crate::process::petri::{Marking, TransitionIndex};

#[derive(Debug, Clone, PartialEq, Eq)]
struct Counting {
    counts: TransitionIndex,
    reset_by: Option<TransitionIndex>,
    /// `None` where the counting began before anybody looked.
    value: Option<u32>,
}

/// What a tree comes to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Choice {
    /// Rests on a count that is not known.
    Unknown,
    /// Wait for an input.
    Wait,
    /// Fire an output when the marking has lasted so long, in seconds.
    Output(TransitionIndex, f64),
}

/// Guards made ready for one net, and the counts they stand on.
#[derive(Debug, Clone)]
pub struct Counters {
    points: HashMap<Marking, usize>,
    guards: Guards,
    number: HashMap<Counter, usize>,
    counting: Vec<Counting>,
    transitions: HashMap<String, TransitionIndex>,
}

impl Counters {
    /// Checks that the guards fit the net.
    ///
    /// # Errors
    /// Guards that name what the net does not have.
    pub fn new(program: &Program, guards: Guards) -> Result<Self, ControlError> {
        let mut ready = Self {
            points: HashMap::new(),
            guards,
            number: HashMap::new(),
            counting: Vec::new(),
            transitions: HashMap::new(),
        };
        let find = |id: &str| {
            program.transition(id).ok_or_else(|| ControlError::Foreign { id: id.to_owned() })
        };
        for (number, point) in ready.guards.points.iter().enumerate() {
            let marking = program.marking(&point.marked).ok_or_else(|| {
                let unknown = |place: &&String| !program.net.places.contains(place);
                let id = point.marked.iter().find(unknown).cloned().unwrap_or_default();
                ControlError::Foreign { id }
            })?;
            ready.points.insert(marking, number);
            let Some(tree) = &point.choice else { continue };
            for id in tree.outputs() {
                let found = find(&id)?;
                ready.transitions.insert(id, found);
            }
            let mut counters = Vec::new();
            tree.each_count(&mut |counter, _| counters.push(counter.clone()));
            for counter in counters {
                if ready.number.contains_key(&counter) {
                    continue;
                }
                let reset_by = counter.reset_by.as_deref().map(find).transpose()?;
                ready.number.insert(counter.clone(), ready.counting.len());
                ready.counting.push(Counting {
                    counts: find(&counter.counts)?,
                    reset_by,
                    value: Some(0),
                });
            }
        }
        Ok(ready)
    }

    /// A visible transition has fired; with `restarts`, as the first of a new run.
    pub fn fired(&mut self, transition: TransitionIndex, restarts: bool) {
        for counter in &mut self.counting {
            if counter.reset_by == Some(transition) || (restarts && counter.reset_by.is_none()) {
                counter.value = Some(0);
            }
            if counter.counts == transition {
                counter.value = counter.value.map(|value| value.saturating_add(1));
            }
        }
    }

    /// Nothing has been counted.
    pub fn clear(&mut self) {
        for counter in &mut self.counting {
            counter.value = Some(0);
        }
    }

    /// Nobody knows what has been counted.
    pub fn forget(&mut self) {
        for counter in &mut self.counting {
            counter.value = None;
        }
    }

    /// What the guards say at a marking; `None` where they say nothing.
    pub fn choice(&self, marking: &[u32]) -> Option<Choice> {
        let point = &self.guards.points[*self.points.get(marking)?];
        point.choice.as_ref().map(|tree| self.walk(tree))
    }

    /// What the guards say at a marking, as it was learned.
    pub fn tree(&self, marking: &[u32]) -> Option<&Tree> {
        self.guards.points[*self.points.get(marking)?].choice.as_ref()
    }

    /// Whether the guards decide at a marking.
    pub fn decides(&self, marking: &[u32]) -> bool {
        self.points.get(marking).is_some_and(|&number| self.guards.points[number].choice.is_some())
    }

    /// The longest that the learned log rested at a marking, in seconds.
    pub fn longest_s(&self, marking: &[u32]) -> Option<f64> {
        self.points.get(marking).map(|&number| self.guards.points[number].longest_s)
    }

    /// The guards.
    pub fn guards(&self) -> &Guards {
        &self.guards
    }

    fn walk(&self, tree: &Tree) -> Choice {
        match tree {
            Tree::Wait => Choice::Wait,
            Tree::Output { transition, after_s } => {
                Choice::Output(self.transitions[transition.as_str()], *after_s)
            }
            Tree::Count { counter, preset, reached, below } => {
                match self.counting[self.number[counter]].value {
                    Some(value) if value >= *preset => self.walk(reached),
                    Some(_) => self.walk(below),
                    None => Choice::Unknown,
                }
            }
        }
    }
}
