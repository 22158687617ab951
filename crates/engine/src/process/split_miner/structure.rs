//! The refined process structure tree: the fragments of a model with one way in and one way out,
//! inner ones first.
//!
//! In a model whose nodes either join or split, the fragments are the triconnected components of
//! its undirected graph with the end tied to the start (Polyvyanyy, Vanhatalo & Völzer 2011). They
//! are found by reduction: two flows in a row are one (a polygon), flows that join the same two
//! nodes are one (a bond); where neither is left, the smallest part that two nodes cut off is a
//! rigid, and becomes one flow as well.

use std::collections::{BTreeMap, BTreeSet};

use super::model::{END, ProcessModel, START};

/// What holds a fragment together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// Ways from one node to another, side by side.
    Bond,
    /// A bond in which some ways lead back.
    Loop,
    /// Anything else.
    Rigid,
}

/// A fragment, and which of its flows arrive where.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fragment {
    /// What holds it together.
    pub shape: Shape,
    /// Where its flows begin.
    pub entry: usize,
    /// Where they end.
    pub exit: usize,
    /// Nodes that several of its flows arrive at. Flows that an inner fragment has joined are told
    /// by the first of them.
    pub arrivals: Vec<(usize, Vec<usize>)>,
}

/// A flow, or a fragment that stands for one.
#[derive(Debug, Clone)]
struct Edge {
    ends: [usize; 2],
    /// Flows of it that arrive at each end.
    arrivals: [Vec<usize>; 2],
    /// The tie from end to start.
    is_tie: bool,
}

impl Edge {
    fn other(&self, node: usize) -> usize {
        if self.ends[0] == node { self.ends[1] } else { self.ends[0] }
    }

    fn arrivals_at(&self, node: usize) -> &[usize] {
        &self.arrivals[usize::from(self.ends[1] == node)]
    }
}

/// All bonds, loops and rigids of a model in which every node lies between start and end.
pub fn fragments(model: &ProcessModel) -> Vec<Fragment> {
    let mut reduction = Reduction::of(model);
    reduction.run();
    reduction.found
}

struct Reduction {
    edges: Vec<Option<Edge>>,
    at: Vec<BTreeSet<usize>>,
    /// Nodes that several flows of the model enter.
    joins: Vec<bool>,
    found: Vec<Fragment>,
}

impl Reduction {
    fn of(model: &ProcessModel) -> Self {
        let (into, _) = model.ways();
        let mut reduction = Self {
            edges: Vec::new(),
            at: vec![BTreeSet::new(); model.kinds.len()],
            joins: into.iter().map(|flows| flows.len() > 1).collect(),
            found: Vec::new(),
        };
        for (flow, &(from, to)) in model.flows.iter().enumerate() {
            let arrivals = [Vec::new(), vec![flow]];
            reduction.insert(Edge { ends: [from, to], arrivals, is_tie: false });
        }
        let tie = [Vec::new(), Vec::new()];
        reduction.insert(Edge { ends: [END, START], arrivals: tie, is_tie: true });
        reduction
    }

    fn insert(&mut self, edge: Edge) {
        let number = self.edges.len();
        for end in edge.ends {
            self.at[end].insert(number);
        }
        self.edges.push(Some(edge));
    }

    fn take(&mut self, number: usize) -> Option<Edge> {
        let edge = self.edges[number].take()?;
        for end in edge.ends {
            self.at[end].remove(&number);
        }
        Some(edge)
    }

    fn edge(&self, number: usize) -> Option<&Edge> {
        self.edges[number].as_ref()
    }

    fn run(&mut self) {
        let mut waiting: BTreeSet<usize> = (0..self.at.len()).collect();
        loop {
            while let Some(node) = waiting.pop_first() {
                waiting.extend(self.bond(node));
                waiting.extend(self.polygon(node));
            }
            if self.edges.iter().flatten().filter(|edge| !edge.is_tie).count() < 2 {
                return;
            }
            match self.smallest_rigid() {
                Some((part, ends)) => {
                    self.rigid(&part, ends);
                    waiting.extend(ends);
                }
                None => {
                    let all: BTreeSet<usize> = (0..self.at.len()).collect();
                    self.rigid(&all, [START, END]);
                    return;
                }
            }
        }
    }

    /// Merges edges between `node` and one other; gives the nodes to look at again.
    fn bond(&mut self, node: usize) -> Vec<usize> {
        let mut beside: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for &number in &self.at[node] {
            if let Some(edge) = self.edge(number).filter(|edge| !edge.is_tie) {
                beside.entry(edge.other(node)).or_default().push(number);
            }
        }
        let mut touched = Vec::new();
        for (other, numbers) in beside {
            if numbers.len() > 1 && other != node {
                let edges: Vec<Edge> = numbers.iter().filter_map(|&n| self.take(n)).collect();
                self.close(&edges, [node, other], None);
                touched.extend([node, other]);
            }
        }
        touched
    }

    /// Merges the two edges at a node that has no others.
    fn polygon(&mut self, node: usize) -> Vec<usize> {
        let numbers: Vec<usize> = self.at[node].iter().copied().collect();
        let [first, second] = numbers[..] else { return Vec::new() };
        let tied = |number| self.edge(number).is_none_or(|edge| edge.is_tie);
        if tied(first) || tied(second) {
            return Vec::new();
        }
        let (Some(mut first), Some(mut second)) = (self.take(first), self.take(second)) else {
            return Vec::new();
        };
        if first.ends[1] != node {
            std::mem::swap(&mut first, &mut second);
        }
        let ends = [first.other(node), second.other(node)];
        let arrivals = [0, 1].map(|side| [&first, &second][side].arrivals_at(ends[side]).to_vec());
        self.insert(Edge { ends, arrivals, is_tie: false });
        ends.to_vec()
    }

    fn rigid(&mut self, part: &BTreeSet<usize>, ends: [usize; 2]) {
        let numbers: BTreeSet<usize> =
            part.iter().flat_map(|&node| self.at[node].iter().copied()).collect();
        let inner: Vec<usize> = numbers
            .into_iter()
            .filter(|&number| self.edge(number).is_some_and(|edge| !edge.is_tie))
            .collect();
        let edges: Vec<Edge> = inner.into_iter().filter_map(|number| self.take(number)).collect();
        self.close(&edges, ends, Some(Shape::Rigid));
    }

    /// Edges become one between `ends`; what they are is told.
    fn close(&mut self, edges: &[Edge], ends: [usize; 2], shape: Option<Shape>) {
        let mut at: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for edge in edges {
            for side in [0, 1] {
                at.entry(edge.ends[side]).or_default().extend(&edge.arrivals[side]);
            }
        }
        for flows in at.values_mut() {
            flows.sort_unstable();
        }
        let arrive = |node: usize| at.get(&node).is_some_and(|flows| !flows.is_empty());
        let [one, other] = ends;
        // In a loop both ends are arrived at; the one that joins is where it is entered.
        let turned = match (arrive(one), arrive(other)) {
            (true, false) => true,
            (true, true) => !self.joins[one] && self.joins[other],
            _ => false,
        };
        let [entry, exit] = if turned { [other, one] } else { ends };
        let around = if arrive(entry) { Shape::Loop } else { Shape::Bond };
        let arrivals = [entry, exit].map(|node| {
            at.get(&node).and_then(|flows| flows.first()).copied().into_iter().collect()
        });
        self.found.push(Fragment {
            shape: shape.unwrap_or(around),
            entry,
            exit,
            arrivals: at.into_iter().filter(|(_, flows)| flows.len() > 1).collect(),
        });
        self.insert(Edge { ends: [entry, exit], arrivals, is_tie: false });
    }

    /// The smallest set of nodes that two others cut off from start and end.
    fn smallest_rigid(&self) -> Option<(BTreeSet<usize>, [usize; 2])> {
        let alive: Vec<usize> =
            (0..self.at.len()).filter(|&node| !self.at[node].is_empty()).collect();
        let mut best: Option<(usize, BTreeSet<usize>, [usize; 2])> = None;
        for &cut in &alive {
            for (second, part) in self.cut_off(cut, &alive) {
                let edges: BTreeSet<usize> =
                    part.iter().flat_map(|&node| self.at[node].iter().copied()).collect();
                if best.as_ref().is_none_or(|(size, ..)| edges.len() < *size) {
                    best = Some((edges.len(), part, [cut, second]));
                }
            }
        }
        best.map(|(_, part, ends)| (part, ends))
    }

    /// What each node cuts off together with `removed`: parts without start and end, by one search
    /// in depth (Tarjan's low points).
    fn cut_off(&self, removed: usize, alive: &[usize]) -> Vec<(usize, BTreeSet<usize>)> {
        let root = if removed == START { END } else { START };
        const UNSEEN: usize = usize::MAX;
        let mut order = vec![UNSEEN; self.at.len()];
        let mut low = vec![UNSEEN; self.at.len()];
        let mut sequence = Vec::with_capacity(alive.len());
        let mut parts = Vec::new();
        let neighbours = |node: usize| -> Vec<usize> {
            let edges = self.at[node].iter().filter_map(|&number| self.edge(number));
            edges.map(|edge| edge.other(node)).filter(|&other| other != removed).collect()
        };
        order[root] = 0;
        low[root] = 0;
        sequence.push(root);
        let mut stack = vec![(root, UNSEEN, neighbours(root).into_iter())];
        while let Some((node, parent, next)) = stack.last_mut() {
            let (node, parent) = (*node, *parent);
            match next.next() {
                Some(other) if order[other] == UNSEEN => {
                    order[other] = sequence.len();
                    low[other] = order[other];
                    sequence.push(other);
                    stack.push((other, node, neighbours(other).into_iter()));
                }
                Some(other) if other != parent => low[node] = low[node].min(order[other]),
                Some(_) => {}
                None => {
                    stack.pop();
                    if parent == UNSEEN {
                        continue;
                    }
                    low[parent] = low[parent].min(low[node]);
                    if low[node] >= order[parent] {
                        let part: BTreeSet<usize> =
                            sequence[order[node]..].iter().copied().collect();
                        // All that was found since `node` hangs on it.
                        if !part.contains(&START) && !part.contains(&END) {
                            parts.push((parent, part));
                        }
                    }
                }
            }
        }
        parts.retain(|(_, part)| part.len() > 1);
        parts
    }
}

#[cfg(test)]
mod tests {
    use super::{Shape, fragments};
    use crate::process::split_miner::model::{END, Kind, ProcessModel, START};

    fn model(nodes: usize, flows: &[(usize, usize)]) -> ProcessModel {
        let mut kinds = vec![Kind::Start, Kind::End];
        kinds.resize(nodes, Kind::Exclusive);
        ProcessModel { kinds, flows: flows.to_vec() }
    }

    #[test]
    fn a_sequence_has_no_fragment() {
        assert!(fragments(&model(3, &[(START, 2), (2, END)])).is_empty());
    }

    #[test]
    fn bonds_lie_in_one_another() {
        // 2 splits to 3 and 4, 3 splits to 5 and 6 that join in 7; 7 and 4 join in 8.
        let flows =
            [(START, 2), (2, 3), (2, 4), (3, 5), (3, 6), (5, 7), (6, 7), (7, 8), (4, 8), (8, END)];
        let found = fragments(&model(9, &flows));
        let told: Vec<_> = found.iter().map(|f| (f.shape, f.entry, f.exit)).collect();
        assert_eq!(told, [(Shape::Bond, 3, 7), (Shape::Bond, 2, 8)]);
        assert_eq!(found[0].arrivals, [(7, vec![5, 6])]);
        assert_eq!(found[1].arrivals, [(8, vec![7, 8])]);
    }

    #[test]
    fn several_ways_of_an_inner_bond_arrive_at_the_same_join() {
        // The inner split's ways end at the outer join: told by the first of them outside.
        let flows = [(START, 2), (2, 3), (2, 4), (3, 5), (3, 6), (5, 7), (6, 7), (4, 7), (7, END)];
        let found = fragments(&model(8, &flows));
        assert_eq!(found[0].arrivals, [(7, vec![5, 6])]);
        assert_eq!(
            (found[1].shape, found[1].arrivals.clone()),
            (Shape::Bond, vec![(7, vec![5, 7])])
        );
    }

    #[test]
    fn a_loop_is_entered_where_it_joins() {
        let flows = [(START, 2), (2, 3), (3, 4), (4, 2), (4, END)];
        let found = fragments(&model(5, &flows));
        let told: Vec<_> = found.iter().map(|f| (f.shape, f.entry, f.exit)).collect();
        assert_eq!(told, [(Shape::Loop, 2, 4)]);
    }

    #[test]
    fn what_is_neither_is_rigid() {
        // 2 → 3, 4; 3 → 5, 6; 4 → 6, 5 crosswise; joined again in 7; a bond 8..9 behind it.
        let flows = [
            (START, 2),
            (2, 3),
            (2, 4),
            (3, 5),
            (3, 6),
            (4, 5),
            (4, 6),
            (5, 7),
            (6, 7),
            (7, 8),
            (8, 10),
            (8, 11),
            (10, 9),
            (11, 9),
            (9, END),
        ];
        let found = fragments(&model(12, &flows));
        let told: Vec<_> = found.iter().map(|f| (f.shape, f.entry, f.exit)).collect();
        assert!(told.contains(&(Shape::Bond, 8, 9)), "{told:?}");
        assert!(told.contains(&(Shape::Rigid, 2, 7)), "{told:?}");
        let rigid = found.iter().find(|fragment| fragment.shape == Shape::Rigid);
        let nodes: Option<Vec<usize>> = rigid.map(|f| f.arrivals.iter().map(|a| a.0).collect());
        assert_eq!(nodes, Some(vec![5, 6, 7]));
    }
}
