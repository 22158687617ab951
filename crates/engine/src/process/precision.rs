//! Precision by escaping edges (Muñoz-Gama & Carmona 2010): how much a net allows that never
//! happened. After every beginning of a run that was seen, what the net allows next is compared with
//! what came next; each is weighed by how often the beginning was seen.

use hashbrown::HashMap;

use super::event_log::{ActivityIndex, EventLog};
use super::fitness::variants;
use super::language::{Language, State};
use super::petri::PetriNet;

/// A beginning of runs: a node of the tree of all traces.
struct Beginning {
    /// Where the net is after it; none where the net does not allow it.
    state: Option<State>,
    /// Events that followed it, over all traces.
    followed: u64,
    /// Distinct activities that followed it and that the net allows.
    allowed: usize,
}

/// 1 − escaping / allowed; 1 where nothing is allowed. Beginnings that the net does not allow are
/// passed over, and so are ends.
pub fn precision(net: &PetriNet, log: &EventLog) -> f64 {
    let mut language = Language::new(net, &log.activities);
    let start = language.start();
    let mut beginnings = vec![Beginning { state: Some(start), followed: 0, allowed: 0 }];
    let mut tree: HashMap<(usize, ActivityIndex), usize> = HashMap::new();
    for (trace, times) in variants(log) {
        let mut node = 0;
        for &activity in trace {
            beginnings[node].followed += times as u64;
            node = match tree.get(&(node, activity)) {
                Some(&known) => known,
                None => {
                    let state = beginnings[node].state;
                    let next = state.and_then(|state| language.step(state, activity));
                    beginnings[node].allowed += usize::from(next.is_some());
                    let new = beginnings.len();
                    tree.insert((node, activity), new);
                    beginnings.push(Beginning { state: next, followed: 0, allowed: 0 });
                    new
                }
            };
        }
    }
    let (mut allowed, mut escaping) = (0, 0);
    for beginning in &beginnings {
        let Some(state) = beginning.state.filter(|_| beginning.followed > 0) else { continue };
        let enabled = language.enabled(state).0;
        allowed += beginning.followed * enabled as u64;
        escaping += beginning.followed * (enabled.saturating_sub(beginning.allowed)) as u64;
    }
    if allowed == 0 { 1.0 } else { 1.0 - escaping as f64 / allowed as f64 }
}

#[cfg(test)]
mod tests {
    use super::precision;
    use crate::process::event_log::EventLog;
    use crate::process::split_miner::{MiningParameters, mine};

    #[test]
    fn what_never_happened_escapes() {
        let log =
            EventLog::from_traces([vec!["a", "b", "d"], vec!["a", "c", "d"], vec!["a", "b", "d"]]);
        let net = mine(&log, &MiningParameters::default()).map(|m| m.net).unwrap_or_default();
        assert_eq!(precision(&net, &log), 1.0);
        // Only b was seen: of a, {b, c}, d (each once) one of four escapes.
        let found = precision(&net, &log.select(&[0]));
        assert!((found - 0.75).abs() < 1e-12, "{found}");
    }
}
