//! Every marking a net can rest in, with the values its terminals have there: what a controller
//! that is switched on in the middle of the work looks itself up in.

use std::collections::{HashMap, VecDeque};
use std::sync::Arc;

use super::error::ControlError;
use super::moves::Moves;
use super::program::Program;
use crate::process::petri::{Marking, TransitionIndex};

/// Situations looked at.
const MOST: usize = 50_000;

/// A marking and the values of all terminals, as far as the events on the way told them.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Situation {
    /// Where the tokens are.
    pub marking: Marking,
    /// By terminal; `None` where no event has told.
    pub values: Vec<Option<i64>>,
    /// The activity it came from; `None` at the beginning.
    pub after: Option<TransitionIndex>,
    /// True where that activity opened a run.
    pub opens: bool,
}

/// All situations within reach, nearest to the beginning of a run first.
///
/// # Errors
/// A net that is not bounded, or gets stuck.
pub fn explore(program: &Arc<Program>, moves: &mut Moves) -> Result<Vec<Situation>, ControlError> {
    let first = Situation {
        marking: program.net.initial.clone(),
        values: vec![None; program.terminals.len()],
        after: None,
        opens: false,
    };
    let mut found = vec![first.clone()];
    let mut known = HashMap::from([((first.marking.clone(), first.values.clone()), 0)]);
    let mut queue = VecDeque::from([0]);
    while let Some(number) = queue.pop_front() {
        if found.len() >= MOST {
            break;
        }
        let from = found[number].clone();
        let ways = moves.from(&from.marking)?;
        if ways.is_empty() {
            let after = from.after.map_or("the beginning", |t| program.label(t)).to_owned();
            return Err(ControlError::Stuck { after });
        }
        for way in ways.iter() {
            let Some(activity) = program.changes_of(way.transition) else { continue };
            // An event is a change: what has its value already cannot change to it.
            if activity.changes.iter().any(|&(t, value)| from.values[t] == Some(value)) {
                continue;
            }
            let mut values = from.values.clone();
            for &(terminal, value) in &activity.changes {
                values[terminal] = Some(value);
            }
            let key = (way.after.clone(), values);
            if !known.contains_key(&key) {
                known.insert(key.clone(), found.len());
                queue.push_back(found.len());
                let (marking, values) = key;
                let opens = way.restarts || from.after.is_none();
                found.push(Situation { marking, values, after: Some(way.transition), opens });
            }
        }
    }
    Ok(found)
}
