//! Step 3: short loops. Two activities that follow one another both ways are a loop, and not
//! concurrent, where one was seen to come back right after the other: a bit that goes on and off.

use std::collections::BTreeSet;

use super::follows::{Follows, Node};

/// Pairs `(a, b)` and `(b, a)` of every short loop.
pub fn short_loops(graph: &Follows) -> BTreeSet<(Node, Node)> {
    let mut loops = BTreeSet::new();
    for &(a, b) in graph.returns.keys() {
        let both = graph.frequency(a, b) > 0 && graph.frequency(b, a) > 0;
        if both && !graph.repeats[a] && !graph.repeats[b] {
            loops.extend([(a, b), (b, a)]);
        }
    }
    loops
}

#[cfg(test)]
mod tests {
    use super::short_loops;
    use crate::process::event_log::EventLog;
    use crate::process::split_miner::follows::Follows;

    #[test]
    fn what_comes_back_is_a_loop_and_what_swaps_is_not() {
        let log = EventLog::from_traces([
            vec!["a", "b", "a", "c", "d", "e"],
            vec!["a", "d", "c", "e"],
            vec!["a", "b", "e"],
        ]);
        let loops = short_loops(&Follows::of(&log));
        assert_eq!(loops.into_iter().collect::<Vec<_>>(), [(0, 1), (1, 0)]);
    }

    #[test]
    fn a_self_loop_explains_what_comes_back() {
        let log = EventLog::from_traces([vec!["a", "b", "a", "a", "b"]]);
        assert!(short_loops(&Follows::of(&log)).is_empty());
    }
}
