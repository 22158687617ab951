//! Fitness by token replay: how well the runs follow a net (van der Aalst 2016, section 8.2).
//!
//! A replay decides greedily which silent transitions fire. A trace that the net allows some other
//! way fits all the same: its missing and remaining tokens do not count.

use std::collections::HashMap;

use super::event_log::{ActivityIndex, EventLog};
use super::language::Language;
use super::petri::PetriNet;
use super::replay::{TokenReplay, Tokens};

/// Traces replayed token by token; beyond, only whether they fit is looked at. Greedy replays of
/// variants nobody will read are not worth minutes.
const REPLAYED_AT_MOST: usize = 1 << 14;

/// How well an event log follows a net.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fitness {
    /// ½ (1 − missing/consumed) + ½ (1 − remaining/produced), over all traces.
    pub fitness: f64,
    /// Traces without a missing or remaining token.
    pub fitting: usize,
    /// All traces.
    pub traces: usize,
    /// The tokens.
    pub tokens: Tokens,
}

/// Replays every trace.
pub fn fitness(net: &PetriNet, log: &EventLog) -> Fitness {
    let mut language = Language::new(net, &log.activities);
    let mut replay = TokenReplay::of(net, &log.activities);
    let mut tokens = Tokens::default();
    let mut fitting = 0;
    for (count, (trace, times)) in variants(log).into_iter().enumerate() {
        let allowed = language.allows(trace);
        let mut of_trace = if count < REPLAYED_AT_MOST || !allowed {
            replay.trace(trace)
        } else {
            let length = trace.len() as u64 + 1;
            Tokens { produced: length, consumed: length, ..Tokens::default() }
        };
        if allowed {
            (of_trace.missing, of_trace.remaining) = (0, 0);
        } else {
            // An activity the net does not have is an event nothing could be consumed for.
            of_trace.missing += of_trace.unknown;
            of_trace.consumed += of_trace.unknown;
        }
        if of_trace.fits() {
            fitting += times;
        }
        let times = times as u64;
        tokens.add(&Tokens {
            produced: of_trace.produced * times,
            consumed: of_trace.consumed * times,
            missing: of_trace.missing * times,
            remaining: of_trace.remaining * times,
            unknown: of_trace.unknown * times,
        });
    }
    let traces = log.traces();
    let fitness = if traces == 0 { 1.0 } else { tokens.fitness() };
    Fitness { fitness, fitting, traces, tokens }
}

/// Distinct traces in the order of their first occurrence, and how often each occurs.
pub fn variants(log: &EventLog) -> Vec<(&[ActivityIndex], usize)> {
    let mut index: HashMap<&[ActivityIndex], usize> = HashMap::new();
    let mut variants: Vec<(&[ActivityIndex], usize)> = Vec::new();
    for trace in 0..log.traces() {
        let trace = log.trace(trace);
        let place = *index.entry(trace).or_insert(variants.len());
        match variants.get_mut(place) {
            Some((_, times)) => *times += 1,
            None => variants.push((trace, 1)),
        }
    }
    variants
}

#[cfg(test)]
mod tests {
    use super::{fitness, variants};
    use crate::process::event_log::EventLog;
    use crate::process::split_miner::{MiningParameters, mine};

    #[test]
    fn a_trace_that_leaves_an_event_out_misses_a_token_and_keeps_one() {
        let log = EventLog::from_traces([vec!["a", "b", "c"], vec!["a", "c"], vec!["a", "b", "c"]]);
        let net = mine(&log.select(&[0]), &MiningParameters::default())
            .map(|mined| mined.net)
            .unwrap_or_default();
        let found = fitness(&net, &log);
        assert_eq!((found.fitting, found.traces), (2, 3));
        // 3 + 1 tokens are consumed by a fitting trace; the other misses 1 of 3 and keeps 1 of 3.
        assert_eq!((found.tokens.missing, found.tokens.remaining), (1, 1));
        assert_eq!((found.tokens.consumed, found.tokens.produced), (11, 11));
        assert!((found.fitness - (1.0 - 1.0 / 11.0)).abs() < 1e-12);
    }

    #[test]
    fn an_activity_the_net_does_not_have_is_missing() {
        let log = EventLog::from_traces([vec!["a", "b"], vec!["a", "x", "b"]]);
        let net = mine(&log.select(&[0]), &MiningParameters::default())
            .map(|mined| mined.net)
            .unwrap_or_default();
        let found = fitness(&net, &log);
        assert_eq!((found.fitting, found.tokens.missing), (1, 1));
    }

    #[test]
    fn variants_are_counted() {
        let log = EventLog::from_traces([vec!["a"], vec!["b"], vec!["a"]]);
        assert_eq!(variants(&log), [(&[0][..], 2), (&[1][..], 1)]);
    }
}
