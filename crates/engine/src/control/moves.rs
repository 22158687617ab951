//! Which visible transitions a marking leads to. Silent transitions fire only towards an enabled
//! visible one (Theis 2019 leaves it open), and a finished run opens the next one.

use std::collections::{HashMap, HashSet, VecDeque};
use std::sync::Arc;

use super::error::ControlError;
use super::program::Program;
use crate::process::petri::{Marking, TransitionIndex};

/// Markings looked at behind silent transitions.
const MOST_MARKINGS: usize = 10_000;

/// One visible transition that can come next.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Move {
    /// What fires.
    pub transition: TransitionIndex,
    /// True where the run before it is over.
    pub restarts: bool,
    /// The marking behind it.
    pub after: Marking,
}

/// The moves of every marking seen so far.
#[derive(Debug, Clone)]
pub struct Moves {
    program: Arc<Program>,
    known: HashMap<Marking, Arc<[Move]>>,
}

impl Moves {
    /// None known yet.
    pub fn new(program: Arc<Program>) -> Self {
        Self { program, known: HashMap::new() }
    }

    /// The moves from a marking, each transition by the shortest way, inside the run if possible.
    ///
    /// # Errors
    /// A net whose silent transitions make tokens without end.
    pub fn from(&mut self, marking: &[u32]) -> Result<Arc<[Move]>, ControlError> {
        if let Some(moves) = self.known.get(marking) {
            return Ok(Arc::clone(moves));
        }
        let moves: Arc<[Move]> = self.search(marking)?.into();
        self.known.insert(marking.to_vec(), Arc::clone(&moves));
        Ok(moves)
    }

    fn search(&self, marking: &[u32]) -> Result<Vec<Move>, ControlError> {
        let net = &self.program.net;
        let mut queue = VecDeque::from([(marking.to_vec(), false)]);
        let mut seen: HashSet<Marking> = HashSet::from([marking.to_vec()]);
        let mut moves: Vec<Move> = Vec::new();
        while let Some((marking, restarts)) = queue.pop_front() {
            if seen.len() > MOST_MARKINGS {
                return Err(ControlError::Unbounded { most: MOST_MARKINGS });
            }
            for (number, transition) in net.transitions.iter().enumerate() {
                let number = number as TransitionIndex;
                if !net.enabled(&marking, number) {
                    continue;
                }
                let mut after = marking.clone();
                net.fire(&mut after, number);
                if transition.label.is_some() {
                    if moves.iter().all(|known| known.transition != number) {
                        moves.push(Move { transition: number, restarts, after });
                    }
                } else if seen.insert(after.clone()) {
                    queue.push_back((after, restarts));
                }
            }
            if marking == net.last && seen.insert(net.initial.clone()) {
                queue.push_back((net.initial.clone(), true));
            }
        }
        Ok(moves)
    }
}
