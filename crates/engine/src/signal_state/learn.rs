//! Learning the nominal model from fault-free logs (Ghosh 2016, sections 2.4.1 and 2.4.2).

mod branches;
mod clock;
pub mod context;
mod instances;
mod kinship;
pub mod lesson;
pub mod merge;
mod partners;
mod reading;
mod share_out;
mod starting;
pub mod survey;
mod teach;
mod timing;
mod walk;

use std::borrow::Borrow;

use thiserror::Error;

use crate::log::{ChangeLog, Nanoseconds};
use crate::naming::{NamingError, NamingRule};
use crate::plant::Plant;
use crate::symbols::SymbolTable;

use super::chains::{ChainKind, Chains};
use super::model::{Learned, NominalModel};
use super::order::ScanOrder;
use super::parameters::{ParameterError, Parameters, Timing};
use super::rules::Rule;
use super::states::{StateId, States};

use reading::Source;

/// Why nothing can be learned.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum LearnError {
    /// No event in any log.
    #[error("nothing to learn from: the log holds no change of any signal")]
    NoEvents,
    /// A parameter out of range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A naming rule that is none.
    #[error(transparent)]
    Naming(#[from] NamingError),
    /// `starting` names a device the logs do not have.
    #[error("starting signal '{device}={signal}': {problem}")]
    Starting {
        /// `Group-Device` as given.
        device: String,
        /// Signal as given.
        signal: String,
        /// What is wrong.
        problem: String,
    },
}

/// Learns from one or more logs of the same plant, each a run of its own.
///
/// # Errors
/// No event at all, a parameter out of range, an unknown starting signal, a naming rule that is
/// none.
pub fn learn<L: Borrow<ChangeLog>>(
    logs: &[L],
    table: &SymbolTable,
    parameters: &Parameters,
) -> Result<NominalModel, LearnError> {
    parameters.validate()?;
    let logs: Vec<&ChangeLog> = logs.iter().map(Borrow::borrow).collect();
    let logs = logs.as_slice();
    let rule = NamingRule::parse(&parameters.naming)?;
    let symbols = reading::all_symbols(logs);
    let mut plant = Plant::arrange(&symbols, table, &rule);
    let numbers: Vec<_> = logs.iter().map(|log| reading::numbers(log, &plant)).collect();
    let runs: Vec<_> = logs.iter().map(|log| reading::runs(log)).collect();
    let sources = logs.iter().zip(&runs).zip(&numbers);
    let sources: Vec<Source<'_>> =
        sources.map(|((&log, runs), numbers)| Source { log, runs, numbers }).collect();
    for source in &sources {
        reading::mark_words(&mut plant, source);
    }
    let order = (parameters.timing == Timing::Adaptive).then(|| ScanOrder::of(&plant));
    let mut states = States::new(plant.signals.len());
    let events = reading::read_events(&sources, &plant, &mut states, order.as_ref());
    if events.number == 0 {
        return Err(LearnError::NoEvents);
    }
    starting::set_chosen(&mut plant, parameters)?;
    starting::set_first(&mut plant, &events.first);
    let resolution = clock::resolution(logs, parameters);
    let taught = teach::teach(&events, &plant, &states, parameters, resolution);
    let learned = Learned {
        events: u64::from(events.number),
        duration: logs.iter().copied().filter_map(span).sum(),
        resolution,
        scan_window: clock::scan_window(logs, parameters),
        longest_pause: taught.longest_pause,
        group_start: taught.group_start,
    };
    Ok(NominalModel::assemble(plant, states, taught.rules, learned, parameters.clone()))
}

fn span(log: &ChangeLog) -> Option<Nanoseconds> {
    Some(log.time.last()?.saturating_sub(*log.time.first()?))
}

/// Shares of each transition among those out of its state.
pub(super) fn set_probabilities(rules: &mut [Rule], chains: &Chains) {
    let mut out = hashbrown::HashMap::<(ChainKind, StateId), u64>::new();
    for rule in rules.iter() {
        *out.entry((chains.kind(rule.chain), rule.current)).or_default() += u64::from(rule.count);
    }
    for rule in rules.iter_mut() {
        let total = out[&(chains.kind(rule.chain), rule.current)];
        rule.probability = f64::from(rule.count) / total as f64;
    }
}
