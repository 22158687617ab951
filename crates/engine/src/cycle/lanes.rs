//! What watching touches at every change: all automata in flat arrays, states and transitions
//! numbered through. Everything else of the model is looked at when something is out of turn.

use super::machine::{Came, Machine, State};
use super::regions::Word;

/// No state.
pub const LOST: u32 = u32::MAX;
const FIRST: u32 = u32::MAX - 1;
const UNKNOWN: u32 = u32::MAX;

/// All automata, flat.
#[derive(Debug, Clone, Default)]
pub struct Lanes {
    /// Where the transitions of each state begin.
    starts: Vec<u32>,
    /// By transition: the word entered, and the state.
    entered: Vec<Word>,
    target: Vec<u32>,
    /// Per region and phase: numbers of its first state and transition.
    bases: Vec<[(u32, u32); 2]>,
}

impl Lanes {
    /// Lays the machines out.
    pub fn of(machines: &[[Machine; 2]]) -> Self {
        let mut lanes = Self::default();
        for of_region in machines {
            let mut bases = [(0, 0); 2];
            for (base, machine) in bases.iter_mut().zip(of_region) {
                let (state, transition) = (lanes.starts.len() as u32, lanes.target.len() as u32);
                *base = (state, transition);
                for from in 0..machine.nodes.len() as State {
                    lanes.starts.push(lanes.target.len() as u32);
                    for t in machine.from(from) {
                        lanes.entered.push(machine.word(t.to));
                        lanes.target.push(state + t.to);
                    }
                }
            }
            lanes.bases.push(bases);
        }
        lanes.starts.push(lanes.target.len() as u32);
        lanes
    }

    /// The transition from a state to a word, and the state it leads to.
    #[inline]
    pub fn step(&self, state: u32, word: Word) -> Option<(u32, u32)> {
        let from = self.starts[state as usize] as usize;
        let to = self.starts[state as usize + 1] as usize;
        let place = self.entered[from..to].iter().position(|&entered| entered == word)?;
        Some(((from + place) as u32, self.target[from + place]))
    }

    /// A machine's own number of a state, and how it was entered.
    pub fn own(&self, region: usize, phase: usize, state: u32, came: u32) -> (State, Came) {
        let (first_state, first_transition) = self.bases[region][phase];
        let came = match came {
            FIRST => Came::First,
            UNKNOWN => Came::Unknown,
            transition => Came::By(transition - first_transition),
        };
        (if state == LOST { LOST } else { state - first_state }, came)
    }

    /// The flat number of a machine's state and transition.
    pub fn flat(&self, region: usize, phase: usize, state: State, came: Came) -> (u32, u32) {
        let (first_state, first_transition) = self.bases[region][phase];
        let came = match came {
            Came::First => FIRST,
            Came::Unknown => UNKNOWN,
            Came::By(transition) => first_transition + transition,
        };
        (if state == LOST { LOST } else { first_state + state }, came)
    }
}
