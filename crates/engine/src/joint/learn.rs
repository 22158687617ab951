//! Learning all models of a plant from the same logs.

use std::borrow::Borrow;
use std::collections::{HashMap, HashSet};

use thiserror::Error;

use crate::cycle::learn::{self as cycle, CycleError};
use crate::cycle::model::CycleModel;
use crate::cycle::parameters::{CycleParameters, ModeSpec, RegionSpecs};
use crate::cycle::regions::Directory;
use crate::log::{ChangeLog, SignalIndex};
use crate::naming::{NamingError, NamingRule};
use crate::plant::Plant;
use crate::signal_state::learn::{self as signal_state, LearnError};
use crate::signal_state::model::NominalModel;
use crate::signal_state::parameters::Parameters;
use crate::symbols::SymbolTable;

use super::aside::Aside;

/// Why nothing can be learned.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum JointError {
    /// Of devices and groups.
    #[error(transparent)]
    SignalState(#[from] LearnError),
    /// Of the cycle machine.
    #[error(transparent)]
    Cycle(#[from] CycleError),
    /// A naming rule that is none.
    #[error(transparent)]
    Naming(#[from] NamingError),
}

/// What a user says of the cycle machine: `[modes]`, `[regions]`, `[cycle]`.
pub type CycleSpec<'a> = (&'a ModeSpec, &'a RegionSpecs, &'a CycleParameters);

/// Learns the signal-state models, and with mode bits the cycle machine.
///
/// # Errors
/// What either model says of its logs and parameters.
pub fn learn<L: Borrow<ChangeLog>>(
    logs: &[L],
    table: &SymbolTable,
    parameters: &Parameters,
    spec: Option<CycleSpec<'_>>,
) -> Result<(NominalModel, Option<CycleModel>), JointError> {
    let Some((modes, regions, cycle_parameters)) = spec else {
        return Ok((signal_state::learn(logs, table, parameters)?, None));
    };
    let rule = NamingRule::parse(&parameters.naming)?;
    let mut known = HashSet::new();
    let symbols: Vec<String> = logs
        .iter()
        .flat_map(|log| &log.borrow().signals)
        .filter(|symbol| known.insert(symbol.as_str()))
        .cloned()
        .collect();
    let plant = Plant::arrange(&symbols, table, &rule);
    let mode_bits = Directory::of(&plant).modes(modes)?;
    let number_of: HashMap<&str, SignalIndex> =
        plant.signals.iter().map(|signal| signal.symbol()).zip(0..).collect();
    let by_itself: Vec<ChangeLog> = logs
        .iter()
        .map(|log| {
            let log: &ChangeLog = log.borrow();
            let signals: Vec<SignalIndex> =
                log.signals.iter().map(|symbol| number_of[symbol.as_str()]).collect();
            Aside::new(&mode_bits, plant.signals.len()).by_itself(log, &signals)
        })
        .collect();
    let model = signal_state::learn(&by_itself, table, parameters)?;
    let cycle = cycle::learn(logs, &model.plant, modes, regions, cycle_parameters)?;
    Ok((model, Some(cycle)))
}
