//! Step 5: the filter keeps what every node needs at its best, and what is frequent.
//!
//! The threshold is the frequency at rank `round(|B| · η)` among the best edges into and out of
//! each node. Edges below it go, unless they lie on the widest path (the one whose rarest edge is
//! the most frequent) from the start to a node, or from a node to the end. η = 0 keeps everything:
//! a machine's loop-back edge is rare and real.

use std::collections::{BTreeSet, BinaryHeap};

use super::follows::{Follows, Node};

/// Takes rare edges out of the graph.
pub fn filter(graph: &mut Follows, eta: f64) {
    if eta <= 0.0 {
        return;
    }
    let threshold = threshold(graph, eta);
    let mut kept: BTreeSet<(Node, Node)> = widest(graph, true);
    kept.extend(widest(graph, false));
    for (count, from, to) in graph.edges() {
        if count < threshold && !kept.contains(&(from, to)) {
            graph.remove(from, to);
        }
    }
}

fn threshold(graph: &Follows, eta: f64) -> u64 {
    let mut best = BTreeSet::new();
    for node in 0..graph.next.len() {
        best.extend(graph.next[node].iter().map(|(&to, &count)| (count, node, to)).max());
        best.extend(graph.previous[node].iter().map(|(&from, &count)| (count, from, node)).max());
    }
    let best: Vec<u64> = best.into_iter().map(|edge| edge.0).collect();
    let rank = ((best.len() as f64 * eta).round() as usize).min(best.len().saturating_sub(1));
    best.get(rank).copied().unwrap_or(0)
}

/// The edges of the widest paths from the start to every node, or from every node to the end.
fn widest(graph: &Follows, forward: bool) -> BTreeSet<(Node, Node)> {
    let (first, next) = match forward {
        true => (graph.start(), &graph.next),
        false => (graph.end(), &graph.previous),
    };
    let mut by: Vec<Option<Node>> = vec![None; next.len()];
    let mut done = vec![false; next.len()];
    let mut width = vec![0; next.len()];
    width[first] = u64::MAX;
    let mut heap = BinaryHeap::from([(u64::MAX, first)]);
    while let Some((reached, node)) = heap.pop() {
        if std::mem::replace(&mut done[node], true) {
            continue;
        }
        for (&other, &count) in &next[node] {
            let through = reached.min(count);
            if !done[other] && through > width[other] {
                (width[other], by[other]) = (through, Some(node));
                heap.push((through, other));
            }
        }
    }
    let edge = |(node, by): (Node, Option<Node>)| {
        by.map(|by| if forward { (by, node) } else { (node, by) })
    };
    by.into_iter().enumerate().filter_map(edge).collect()
}

#[cfg(test)]
mod tests {
    use super::filter;
    use crate::process::event_log::EventLog;
    use crate::process::split_miner::follows::Follows;

    fn graph() -> Follows {
        let mut traces = vec![vec!["a", "b", "c"]; 8];
        traces.push(vec!["a", "c"]);
        traces.push(vec!["a", "b", "x", "c"]);
        Follows::of(&EventLog::from_traces(traces))
    }

    #[test]
    fn rare_edges_go_but_no_node_is_lost() {
        let mut graph = graph();
        filter(&mut graph, 0.4);
        assert_eq!(graph.frequency(0, 2), 0, "a c was seen once, and nothing needs it");
        assert_eq!(graph.frequency(1, 3), 1, "the only way to x");
        assert_eq!(graph.frequency(3, 2), 1, "the only way from x");
    }

    #[test]
    fn without_a_threshold_everything_stays() {
        let mut filtered = graph();
        filter(&mut filtered, 0.0);
        assert_eq!(filtered, graph());
    }
}
