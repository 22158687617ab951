//! A net ready to control: its transitions taken apart into changes of terminals.

use super::error::ControlError;
use crate::plant::SignalClass;
use crate::process::petri::{Marking, PetriNet, TransitionIndex};
use crate::process::reset::parse_changes;

/// Dense number of a terminal: an input or output of the PLC that the net speaks of.
pub type TerminalIndex = usize;

/// An input or output of the PLC.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Terminal {
    /// What the log calls it: `%IX0.1`.
    pub address: String,
    /// True where the controller writes it.
    pub output: bool,
}

/// What a visible transition stands for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Activity {
    /// True where the controller does it.
    pub output: bool,
    /// Each terminal and the value it changes to.
    pub changes: Vec<(TerminalIndex, i64)>,
}

/// A net and what its transitions do.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Program {
    /// As it was mined.
    pub net: PetriNet,
    /// Inputs by address, then outputs by address.
    pub terminals: Vec<Terminal>,
    /// By transition; `None` for silent ones.
    pub activities: Vec<Option<Activity>>,
}

impl Program {
    /// Takes a net apart.
    ///
    /// # Errors
    /// A visible transition that is no change of inputs or of outputs, or a net without outputs.
    pub fn new(net: PetriNet) -> Result<Self, ControlError> {
        let mut parsed = Vec::new();
        for transition in &net.transitions {
            let Some(label) = &transition.label else {
                parsed.push(None);
                continue;
            };
            let changes = parse_changes(label).unwrap_or_default();
            if changes.is_empty() {
                return Err(ControlError::NoChanges { label: label.clone() });
            }
            let is_output = |address: &str| SignalClass::guess(address) == SignalClass::Output;
            let output = match transition.class {
                Some(class) => class == SignalClass::Output,
                None => is_output(&changes[0].0),
            };
            if transition.class.is_none()
                && changes.iter().any(|(address, _)| is_output(address) != output)
            {
                return Err(ControlError::MixedClasses { label: label.clone() });
            }
            parsed.push(Some((output, changes)));
        }
        let mut terminals: Vec<Terminal> = Vec::new();
        for (output, changes) in parsed.iter().flatten() {
            for (address, _) in changes {
                match terminals.iter().find(|t| t.address == *address) {
                    Some(known) if known.output != *output => {
                        return Err(ControlError::MixedClasses { label: address.clone() });
                    }
                    Some(_) => {}
                    None => {
                        terminals.push(Terminal { address: address.clone(), output: *output });
                    }
                }
            }
        }
        terminals.sort_by(|a, b| (a.output, &a.address).cmp(&(b.output, &b.address)));
        if terminals.iter().all(|terminal| !terminal.output) {
            return Err(ControlError::NoOutputs);
        }
        let number = |address: &str| terminals.iter().position(|t| t.address == address);
        let activities = parsed
            .into_iter()
            .map(|activity| {
                activity.map(|(output, changes)| Activity {
                    output,
                    changes: changes
                        .into_iter()
                        .filter_map(|(address, value)| Some((number(&address)?, value)))
                        .collect(),
                })
            })
            .collect();
        Ok(Self { net, terminals, activities })
    }

    /// Number of the terminal called `address`.
    pub fn terminal(&self, address: &str) -> Option<TerminalIndex> {
        self.terminals.iter().position(|terminal| terminal.address == address)
    }

    /// Name of a visible transition's activity; of a silent one, its identifier.
    pub fn label(&self, transition: TransitionIndex) -> &str {
        let transition = &self.net.transitions[transition as usize];
        transition.label.as_deref().unwrap_or(&transition.id)
    }

    /// True where the controller does it itself.
    pub fn is_output(&self, transition: TransitionIndex) -> bool {
        self.changes_of(transition).is_some_and(|activity| activity.output)
    }

    /// What a transition changes; none for a silent one.
    pub fn changes_of(&self, transition: TransitionIndex) -> Option<&Activity> {
        self.activities[transition as usize].as_ref()
    }

    /// A marking as the identifiers of its marked places, one for each token.
    pub fn marked(&self, marking: &[u32]) -> Vec<String> {
        let mut marked = Vec::new();
        for (place, &tokens) in self.net.places.iter().zip(marking) {
            marked.extend(std::iter::repeat_n(place.clone(), tokens as usize));
        }
        marked
    }

    /// The marking of places named; `None` for a place the net does not have.
    pub fn marking(&self, marked: &[String]) -> Option<Marking> {
        let mut marking = vec![0; self.net.places.len()];
        for id in marked {
            marking[self.net.places.iter().position(|place| place == id)?] += 1;
        }
        Some(marking)
    }

    /// The transition with an identifier.
    pub fn transition(&self, id: &str) -> Option<TransitionIndex> {
        let found = self.net.transitions.iter().position(|transition| transition.id == id);
        found.map(|index| index as TransitionIndex)
    }
}
