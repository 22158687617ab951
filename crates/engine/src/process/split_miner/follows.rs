//! Step 1: which activity directly follows which, how often, from an artificial start to an
//! artificial end; step 2: self-loops are marked and leave the graph.

use std::collections::BTreeMap;

use crate::process::event_log::EventLog;

/// Number of a node: an activity, or one of the two artificial ones behind them.
pub type Node = usize;

/// The directly-follows graph.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Follows {
    /// Number of activities; the start is the node of this number, the end the next one.
    pub activities: usize,
    /// Frequency of each edge that leaves a node, by its target.
    pub next: Vec<BTreeMap<Node, u64>>,
    /// Frequency of each edge that enters a node, by its source.
    pub previous: Vec<BTreeMap<Node, u64>>,
    /// Activities that directly follow themselves.
    pub repeats: Vec<bool>,
    /// How often `a b a` was seen, by `(a, b)`.
    pub returns: BTreeMap<(Node, Node), u64>,
}

/// From how many activities on pairs are counted in a table instead of a square.
const SQUARE: usize = 1 << 11;

impl Follows {
    /// Counts an event log. Traces without events say nothing of order and are passed over.
    pub fn of(log: &EventLog) -> Self {
        let activities = log.activities.len();
        let (start, end) = (activities, activities + 1);
        let nodes = activities + 2;
        let mut pairs = PairCounts::new(nodes);
        let mut returns = PairCounts::new(nodes);
        for trace in 0..log.traces() {
            let trace = log.trace(trace);
            let Some((&first, &last)) = trace.first().zip(trace.last()) else { continue };
            pairs.add(start, first as Node);
            pairs.add(last as Node, end);
            for pair in trace.windows(2) {
                pairs.add(pair[0] as Node, pair[1] as Node);
            }
            for triple in trace.windows(3) {
                if triple[0] == triple[2] && triple[0] != triple[1] {
                    returns.add(triple[0] as Node, triple[1] as Node);
                }
            }
        }
        let mut graph = Self {
            activities,
            next: vec![BTreeMap::new(); nodes],
            previous: vec![BTreeMap::new(); nodes],
            repeats: vec![false; activities],
            returns: returns.entries().collect(),
        };
        for ((from, to), count) in pairs.entries() {
            if from == to {
                graph.repeats[from] = true;
            } else {
                graph.next[from].insert(to, count);
                graph.previous[to].insert(from, count);
            }
        }
        graph
    }

    /// The artificial start.
    pub fn start(&self) -> Node {
        self.activities
    }

    /// The artificial end.
    pub fn end(&self) -> Node {
        self.activities + 1
    }

    /// Frequency of an edge; 0 where there is none.
    pub fn frequency(&self, from: Node, to: Node) -> u64 {
        self.next[from].get(&to).copied().unwrap_or(0)
    }

    /// Puts an edge in.
    pub fn insert(&mut self, from: Node, to: Node, frequency: u64) {
        self.next[from].insert(to, frequency);
        self.previous[to].insert(from, frequency);
    }

    /// Takes an edge out.
    pub fn remove(&mut self, from: Node, to: Node) {
        self.next[from].remove(&to);
        self.previous[to].remove(&from);
    }

    /// All edges by frequency, source and target: the order in which ties are settled.
    pub fn edges(&self) -> Vec<(u64, Node, Node)> {
        let mut edges: Vec<_> = self
            .next
            .iter()
            .enumerate()
            .flat_map(|(from, next)| next.iter().map(move |(&to, &count)| (count, from, to)))
            .collect();
        edges.sort_unstable();
        edges
    }
}

/// Counts of pairs of nodes.
enum PairCounts {
    Square { nodes: usize, counts: Vec<u64> },
    Table(hashbrown::HashMap<(Node, Node), u64>),
}

impl PairCounts {
    fn new(nodes: usize) -> Self {
        if nodes <= SQUARE {
            Self::Square { nodes, counts: vec![0; nodes * nodes] }
        } else {
            Self::Table(hashbrown::HashMap::new())
        }
    }

    #[inline]
    fn add(&mut self, from: Node, to: Node) {
        match self {
            Self::Square { nodes, counts } => counts[from * *nodes + to] += 1,
            Self::Table(counts) => *counts.entry((from, to)).or_default() += 1,
        }
    }

    fn entries(self) -> Box<dyn Iterator<Item = ((Node, Node), u64)>> {
        match self {
            Self::Square { nodes, counts } => Box::new(
                counts
                    .into_iter()
                    .enumerate()
                    .filter(|&(_, count)| count > 0)
                    .map(move |(pair, count)| ((pair / nodes, pair % nodes), count)),
            ),
            Self::Table(counts) => Box::new(counts.into_iter()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Follows;
    use crate::process::event_log::EventLog;

    #[test]
    fn edges_self_loops_and_returns() {
        let log =
            EventLog::from_traces([vec!["a", "b", "a", "c"], vec!["a", "b", "b", "c"], vec![]]);
        let graph = Follows::of(&log);
        let (a, b, c, start, end) = (0, 1, 2, graph.start(), graph.end());
        assert_eq!(graph.frequency(start, a), 2);
        assert_eq!(graph.frequency(a, b), 2);
        assert_eq!(graph.frequency(c, end), 2);
        assert_eq!(graph.frequency(b, b), 0);
        assert_eq!(graph.repeats, [false, true, false]);
        assert_eq!(graph.returns.get(&(a, b)), Some(&1));
        assert_eq!(graph.edges().first(), Some(&(1, a, c)));
    }
}
