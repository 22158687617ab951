//! Learning the nominal model from fault-free logs (Ghosh 2016, sections 2.4.1 and 2.4.2).

mod clock;
pub mod context;
pub mod lesson;
pub mod merge;
mod reading;
mod starting;
pub mod survey;
mod timing;
mod walk;

use std::borrow::Borrow;

use thiserror::Error;

use crate::log::{ChangeLog, Nanoseconds};
use crate::naming::{NamingError, NamingRule};
use crate::plant::Plant;
use crate::symbols::SymbolTable;

use super::chains::{ChainKind, Chains};
use super::dispersion;
use super::enabling::{Happening, Happenings};
use super::model::{Learned, NominalModel};
use super::order::ScanOrder;
use super::parameters::{ParameterError, Parameters, Timing};
use super::rules::{Rule, row_of};
use super::states::{NO_STATE, StateId, States};

use reading::Run;
use timing::{Study, Times};
use walk::{Found, Transitions};

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
    reading::mark_words(&mut plant, logs);
    let order = (parameters.timing == Timing::Adaptive).then(|| ScanOrder::of(&plant));
    let mut states = States::new(plant.signals.len());
    let runs: Vec<Vec<Run>> = logs.iter().map(|log| reading::runs(log)).collect();
    let runs = logs.iter().copied().zip(runs.iter().map(Vec::as_slice));
    let events = reading::read_events(runs, &plant, &mut states, order.as_ref());
    if events.happenings.is_empty() {
        return Err(LearnError::NoEvents);
    }
    starting::set_chosen(&mut plant, parameters)?;
    starting::set_first(&mut plant, &events.happenings);
    let resolution = clock::resolution(logs, parameters);
    let taught = teach(&events.happenings, &plant, &states, parameters, resolution);
    let learned = Learned {
        events: events.happenings.len() as u64,
        duration: logs.iter().copied().filter_map(span).sum(),
        resolution,
        scan_window: clock::scan_window(logs, parameters),
        longest_pause: taught.longest_pause,
        group_start: taught.group_start,
    };
    Ok(NominalModel::assemble(plant, states, taught.rules, learned, parameters.clone()))
}

/// What events teach of a plant, or of a part of it.
struct Taught {
    /// In the order of first appearance.
    rules: Vec<Rule>,
    /// By rule: the event it first ended with.
    first: Vec<u32>,
    /// By group.
    longest_pause: Vec<Nanoseconds>,
    group_start: Vec<StateId>,
}

/// Learns from the events of a plant whose starting signals are known.
fn teach(
    events: &[Happening],
    plant: &Plant,
    states: &States,
    parameters: &Parameters,
    resolution: Nanoseconds,
) -> Taught {
    let chains = Chains::of(plant);
    let transitions = walk::walk(events, &chains, states.len());
    let happenings = (parameters.timing == Timing::Adaptive)
        .then(|| Happenings::of(events, plant, states, resolution));
    let study = Study {
        found: &transitions,
        chains: &chains,
        parameters,
        resolution,
        happenings: happenings.as_ref(),
    };
    let rules = rules(&transitions, study.all(), &chains, states.len());
    Taught {
        rules,
        first: transitions.first_events(),
        longest_pause: longest_pauses(events, &chains, plant.groups.len()),
        group_start: group_starts(events, &chains, plant.groups.len()),
    }
}

fn span(log: &ChangeLog) -> Option<Nanoseconds> {
    Some(log.time.last()?.saturating_sub(*log.time.first()?))
}

/// Transitions and their times as rules, with their probabilities.
fn rules(found: &Transitions, times: Vec<Times>, chains: &Chains, states: usize) -> Vec<Rule> {
    let branch_dispersion = branch_dispersion(found, chains, states);
    let mut position = vec![0u32; chains.len()];
    let mut rules = Vec::with_capacity(found.rules.len());
    for (index, (transition, times)) in found.rules.iter().zip(times).enumerate() {
        rules.push(Rule {
            chain: transition.chain,
            current: transition.current,
            next: transition.next,
            count: transition.count,
            uncounted: transition.uncounted,
            probability: 0.0,
            sequence: index as u32,
            position: position[transition.chain],
            dispersion: branch_dispersion[index],
            clusters: times.clusters.into(),
            trigger: times.trigger.map(Box::new),
        });
        position[transition.chain] += 1;
    }
    set_probabilities(&mut rules, chains);
    rules
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

/// Dispersion of every branch: of "this transition was taken" among departures from its state.
fn branch_dispersion(found: &Transitions, chains: &Chains, states: usize) -> Vec<f64> {
    let row = |rule: &Found| row_of(rule.current, chains.kind(rule.chain));
    // Most states are left in one way only.
    let mut ways = vec![0u32; 2 * states];
    for rule in &found.rules {
        ways[row(rule)] += 1;
    }
    let rows: Vec<Option<usize>> =
        found.rules.iter().map(row).map(|row| (ways[row] > 1).then_some(row)).collect();
    let mut departures: Vec<Vec<u32>> = vec![Vec::new(); 2 * states];
    for instance in &found.instances {
        if let Some(row) = rows[instance.rule as usize] {
            departures[row].push(instance.rule);
        }
    }
    rows.iter()
        .zip(0..)
        .map(|(row, index)| row.map_or(1.0, |row| dispersion::of_share(&departures[row], index)))
        .collect()
}

/// Longest time between two events of each group.
fn longest_pauses(events: &[Happening], chains: &Chains, groups: usize) -> Vec<Nanoseconds> {
    let mut last: Vec<Option<Nanoseconds>> = vec![None; groups];
    let mut longest = vec![0; groups];
    let mut run = 0;
    for event in events {
        if std::mem::replace(&mut run, event.run) != event.run {
            last.fill(None);
        }
        let group = chains.group_of(chains.device_chain(event.signal));
        if let Some(last) = last[group] {
            longest[group] = longest[group].max(event.time - last);
        }
        last[group] = Some(event.time);
    }
    longest
}

/// The first signal-state of each group's chain: its return closes a group cycle.
fn group_starts(events: &[Happening], chains: &Chains, groups: usize) -> Vec<StateId> {
    let mut starts = vec![NO_STATE; groups];
    for event in events {
        if let Some(chain) = chains.group_chain(event.signal) {
            let start = &mut starts[chains.group_of(chain)];
            if *start == NO_STATE {
                *start = event.state;
            }
        }
    }
    starts
}
