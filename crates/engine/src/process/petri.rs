//! Labelled Petri nets with an initial and a final marking, and the token game on them.

use crate::plant::SignalClass;

/// Dense number of a place inside one net.
pub type PlaceIndex = u32;

/// Dense number of a transition inside one net.
pub type TransitionIndex = u32;

/// Tokens on each place, by [`PlaceIndex`].
pub type Marking = Vec<u32>;

/// What a transition stands for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Transition {
    /// Identifier inside the net, unique.
    pub id: String,
    /// Name of the activity; none for a silent transition (τ).
    pub label: Option<String>,
    /// γ of Theis 2019: input, output, or ⊥.
    pub class: Option<SignalClass>,
    /// Places a token is taken from, ascending; every arc weighs 1.
    pub inputs: Vec<PlaceIndex>,
    /// Places a token is put on, ascending.
    pub outputs: Vec<PlaceIndex>,
}

/// A labelled Petri net.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct PetriNet {
    /// Name told to readers of the file.
    pub name: String,
    /// Identifier of each place, by [`PlaceIndex`].
    pub places: Vec<String>,
    /// Transitions, by [`TransitionIndex`].
    pub transitions: Vec<Transition>,
    /// Tokens before the first event.
    pub initial: Marking,
    /// Tokens after the last one.
    pub last: Marking,
}

impl PetriNet {
    /// True where every input place of `transition` holds a token.
    pub fn enabled(&self, marking: &[u32], transition: TransitionIndex) -> bool {
        self.transitions[transition as usize].inputs.iter().all(|&p| marking[p as usize] > 0)
    }

    /// Moves the tokens. `transition` must be enabled.
    pub fn fire(&self, marking: &mut [u32], transition: TransitionIndex) {
        let transition = &self.transitions[transition as usize];
        for &place in &transition.inputs {
            marking[place as usize] -= 1;
        }
        for &place in &transition.outputs {
            marking[place as usize] += 1;
        }
    }

    /// The first transition labelled `label`.
    pub fn labelled(&self, label: &str) -> Option<TransitionIndex> {
        let found = self.transitions.iter().position(|t| t.label.as_deref() == Some(label));
        found.map(|index| index as TransitionIndex)
    }
}
