//! Step 4: concurrency. Two activities that follow one another both ways about as often are
//! concurrent, and neither order is an edge; else the rarer order is noise.
//!
//! A node never loses its only way in or out: then the relation is dropped, and the reverse edge is
//! tried instead.

use std::collections::{BTreeSet, VecDeque};

use super::follows::{Follows, Node};

/// Which activities are concurrent, both ways.
pub type Parallels = Vec<BTreeSet<Node>>;

/// Takes concurrent and noisy edges out of the graph; `epsilon` is the imbalance from which on two
/// orders are not concurrent.
pub fn discover(graph: &mut Follows, loops: &BTreeSet<(Node, Node)>, epsilon: f64) -> Parallels {
    let whole = graph.clone();
    let mut parallels = vec![BTreeSet::new(); graph.next.len()];
    let mut removable = BTreeSet::new();
    for (count, from, to) in graph.edges() {
        let back = graph.frequency(to, from);
        if back == 0 || loops.contains(&(from, to)) {
            continue;
        }
        let imbalance = count.abs_diff(back) as f64 / (count + back) as f64;
        if imbalance < epsilon {
            parallels[from].insert(to);
            removable.insert((count, from, to));
        } else if count < back {
            removable.insert((count, from, to));
        }
    }
    while let Some((_, from, to)) = removable.pop_first() {
        if remove(graph, from, to) {
            continue;
        }
        let reverse = (whole.frequency(to, from), to, from);
        if parallels[from].remove(&to) {
            parallels[to].remove(&from);
            // One of two orders had to stay, so the other one is the noise.
            if graph.frequency(to, from) > 0 {
                removable.remove(&reverse);
                remove(graph, to, from);
            }
        } else if graph.frequency(to, from) > 0 {
            remove(graph, to, from);
        }
    }
    reconnect(graph, &whole, &mut parallels);
    parallels
}

fn remove(graph: &mut Follows, from: Node, to: Node) -> bool {
    let needed = graph.next[from].len() == 1 || graph.previous[to].len() == 1;
    if !needed {
        graph.remove(from, to);
    }
    !needed
}

/// Every node lies on a way from start to end: where a way was lost, the most frequent edge that
/// restores it comes back. (The published algorithm leaves such nodes in islands.)
fn reconnect(graph: &mut Follows, whole: &Follows, parallels: &mut Parallels) {
    for forward in [true, false] {
        loop {
            let reached = reachable(graph, forward);
            let lost = whole.edges().into_iter().rev().find(|&(_, from, to)| {
                let (near, far) = if forward { (from, to) } else { (to, from) };
                reached[near] && !reached[far]
            });
            let Some((count, from, to)) = lost else { break };
            graph.insert(from, to, count);
            parallels[from].remove(&to);
            parallels[to].remove(&from);
        }
    }
}

/// Nodes on a way from the start, or to the end.
pub fn reachable(graph: &Follows, forward: bool) -> Vec<bool> {
    let (first, next) = match forward {
        true => (graph.start(), &graph.next),
        false => (graph.end(), &graph.previous),
    };
    let mut reached = vec![false; next.len()];
    reached[first] = true;
    let mut queue = VecDeque::from([first]);
    while let Some(node) = queue.pop_front() {
        for &other in next[node].keys() {
            if !std::mem::replace(&mut reached[other], true) {
                queue.push_back(other);
            }
        }
    }
    reached
}

#[cfg(test)]
mod tests {
    use super::{discover, reachable};
    use crate::process::event_log::EventLog;
    use crate::process::split_miner::follows::Follows;
    use crate::process::split_miner::short_loops::short_loops;

    fn mined(traces: &[&str], epsilon: f64) -> (Follows, Vec<(usize, usize)>) {
        let traces = traces.iter().map(|trace| trace.split("").filter(|name| !name.is_empty()));
        let mut graph = Follows::of(&EventLog::from_traces(traces));
        let loops = short_loops(&graph);
        let parallels = discover(&mut graph, &loops, epsilon);
        let pairs = parallels
            .iter()
            .enumerate()
            .flat_map(|(a, with)| with.iter().map(move |&b| (a, b)))
            .collect();
        (graph, pairs)
    }

    #[test]
    fn balanced_orders_are_concurrent() {
        let (graph, pairs) = mined(&["abcd", "acbd"], 0.5);
        assert_eq!(pairs, [(1, 2), (2, 1)]);
        assert_eq!((graph.frequency(1, 2), graph.frequency(2, 1)), (0, 0));
    }

    #[test]
    fn a_rare_order_is_noise() {
        let (graph, pairs) = mined(&["abcd", "abcd", "abcd", "abcd", "acbd"], 0.5);
        assert!(pairs.is_empty());
        assert_eq!((graph.frequency(1, 2), graph.frequency(2, 1)), (4, 0));
    }

    #[test]
    fn the_only_way_in_or_out_stays() {
        // b is entered from c only and c from b only, but for the start.
        let (graph, pairs) = mined(&["bc", "cb"], 0.5);
        assert!(reachable(&graph, true).iter().all(|&reached| reached));
        assert!(reachable(&graph, false).iter().all(|&reached| reached));
        assert_eq!(pairs, [(0, 1), (1, 0)]);
        let (graph, pairs) = mined(&["abcb"], 0.9);
        assert!(reachable(&graph, true).iter().all(|&reached| reached), "{pairs:?}");
    }
}
