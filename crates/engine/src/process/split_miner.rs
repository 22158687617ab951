//! Split Miner (Augusto, Conforti, Dumas, La Rosa & Polyvyanyy 2018): from an event log to a
//! process model of gateways, and from there to a Petri net.
//!
//! Every step is a file: [`follows`] counts, [`short_loops`] and [`concurrency`] tell loops from
//! order, [`filter`] takes rare edges out, [`splits`] and [`joins`] (over the model's
//! [`structure`]) make gateways, [`inclusive`] settles the doubtful ones, [`to_net`] gives the net.

pub mod concurrency;
pub mod filter;
pub mod follows;
pub mod inclusive;
pub mod joins;
pub mod model;
pub mod repair;
pub mod short_loops;
pub mod splits;
pub mod structure;
pub mod to_net;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::event_log::EventLog;
use super::fitness::fitness;
use super::petri::PetriNet;
use super::precision::precision;
use super::soundness::soundness;
use follows::Follows;
use model::ProcessModel;

/// How much is filtered, and what counts as concurrent.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MiningParameters {
    /// η: share of the nodes' best edges whose frequency an edge must reach; 0 filters nothing.
    pub eta: f64,
    /// ε: imbalance of two orders from which on they are not concurrent.
    pub epsilon: f64,
}

impl Default for MiningParameters {
    fn default() -> Self {
        Self { eta: 0.0, epsilon: 0.5 }
    }
}

/// Why nothing was mined.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MiningError {
    /// There is nothing to mine.
    #[error(
        "the event log has no event; without --keep-partial only runs between two resets count"
    )]
    Empty,
    /// A parameter is no share.
    #[error("{name} is {found}, expected a number from 0 to 1")]
    Share {
        /// `eta` or `epsilon`.
        name: &'static str,
        /// The number given.
        found: f64,
    },
}

/// What was mined.
#[derive(Debug, Clone, PartialEq)]
pub struct Mined {
    /// Tasks and gateways.
    pub model: ProcessModel,
    /// The same as a Petri net.
    pub net: PetriNet,
    /// ε it was mined with: the one asked for, unless that gave a net that is not sound.
    pub epsilon: f64,
}

/// What is tried where the ε asked for gives a net that is not sound. With 0 nothing is concurrent,
/// and a net without concurrency is always sound.
const OTHER_EPSILONS: [f64; 7] = [0.9, 0.7, 0.6, 0.4, 0.3, 0.15, 0.0];

/// Mines an event log. Where the net is not sound, the best sound one of another ε is taken.
///
/// # Errors
/// A log without events, or a parameter that is no share.
pub fn mine(log: &EventLog, parameters: &MiningParameters) -> Result<Mined, MiningError> {
    for (name, found) in [("eta", parameters.eta), ("epsilon", parameters.epsilon)] {
        if !(0.0..=1.0).contains(&found) {
            return Err(MiningError::Share { name, found });
        }
    }
    if log.is_empty() {
        return Err(MiningError::Empty);
    }
    let counted = Follows::of(log);
    let asked = with_epsilon(&counted, log, parameters.eta, parameters.epsilon);
    if soundness(&asked.net).sound != Some(false) {
        return Ok(asked);
    }
    let others = OTHER_EPSILONS.map(|epsilon| with_epsilon(&counted, log, parameters.eta, epsilon));
    let sound = others.into_iter().filter(|mined| soundness(&mined.net).sound == Some(true));
    let scored = sound.map(|mined| (score(&mined.net, log), mined));
    let best = scored.max_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, mined)| mined);
    Ok(best.unwrap_or(asked))
}

fn with_epsilon(counted: &Follows, log: &EventLog, eta: f64, epsilon: f64) -> Mined {
    let mut graph = counted.clone();
    let loops = short_loops::short_loops(&graph);
    let parallels = concurrency::discover(&mut graph, &loops, epsilon);
    filter::filter(&mut graph, eta);
    let (mut model, settled) = splits::discover(&graph, &parallels);
    joins::discover(&mut model, &settled);
    let doubtful = inclusive::replace(&mut model, &parallels);
    let model = repair::repair(model, &doubtful, log);
    let net = to_net::to_net(&model, &log.activities);
    Mined { model, net, epsilon }
}

/// The harmonic mean of fitness and precision.
fn score(net: &PetriNet, log: &EventLog) -> f64 {
    let (fitness, precision) = (fitness(net, log).fitness, precision(net, log));
    2.0 * fitness * precision / (fitness + precision).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::{MiningError, MiningParameters, mine};
    use crate::process::event_log::EventLog;
    use crate::process::fitness::fitness;
    use crate::process::petri::PetriNet;
    use crate::process::soundness::soundness;

    fn log(traces: &[&str]) -> EventLog {
        let traces = traces.iter().map(|trace| trace.split("").filter(|name| !name.is_empty()));
        EventLog::from_traces(traces)
    }

    /// Mines traces whose events are single letters; the net must be sound and allow all of them.
    fn mined(traces: &[&str]) -> PetriNet {
        let log = log(traces);
        let mined = mine(&log, &MiningParameters::default());
        let net = mined.map(|mined| mined.net).unwrap_or_default();
        let told = soundness(&net);
        assert_eq!(told.sound, Some(true), "{traces:?}: {:?}", told.problems);
        assert_eq!(fitness(&net, &log).fitness, 1.0, "{traces:?}: {net:?}");
        net
    }

    fn silent(net: &PetriNet) -> usize {
        net.transitions.iter().filter(|t| t.label.is_none()).count()
    }

    #[test]
    fn a_sequence_needs_no_silent_transition() {
        let net = mined(&["abc"]);
        assert_eq!((net.places.len(), net.transitions.len(), silent(&net)), (4, 3, 0));
    }

    #[test]
    fn choices_loops_and_concurrency() {
        for traces in [
            &["abd", "acd"][..],
            &["ad", "abd"],
            &["abcd", "acbd"],
            &["abde", "adbe", "acde", "adce"],
            &["abc", "abbbc"],
            &["a", "aa"],
            &["abcd", "abcbcd"],
            &["abcabc", "abc"],
            &["abababac"],
            &["axby", "xaby", "xayb", "axyb"],
            &["abcdef", "abdcef", "aef"],
            &["ab", "cb", "ad", "cd"],
            &["abc", "bac", "abd", "bad"],
            &["ab", "ba", "abcab", "bacba", "abdba", "badab"],
        ] {
            mined(traces);
        }
    }

    #[test]
    fn the_order_of_activities_numbers_is_not_that_of_time() {
        let net = mined(&["ba", "bca"]);
        assert_eq!(net.transitions.iter().filter(|t| t.label.is_some()).count(), 3);
    }

    #[test]
    fn activities_that_do_not_happen_are_left_out() {
        let log = log(&["ab", "c"]).select(&[0]);
        let net = mine(&log, &MiningParameters::default()).map(|mined| mined.net);
        assert_eq!(net.map(|net| net.transitions.len()), Ok(2));
    }

    #[test]
    fn what_cannot_be_mined_is_said() {
        let parameters = MiningParameters { eta: 1.5, epsilon: 0.5 };
        let error = mine(&log(&["a"]), &parameters).map(|_| ());
        assert_eq!(error, Err(MiningError::Share { name: "eta", found: 1.5 }));
        let empty = mine(&log(&[""]), &MiningParameters::default()).map(|_| ());
        assert_eq!(empty, Err(MiningError::Empty));
    }
}
