//! The process model on its way to a Petri net: tasks and gateways, as BPMN has them.

use crate::process::event_log::ActivityIndex;

/// What a node of the model is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Where a run begins.
    Start,
    /// Where it ends.
    End,
    /// An activity.
    Task(ActivityIndex),
    /// A gateway: one of several ways.
    Exclusive,
    /// A gateway: all ways at once.
    Parallel,
    /// A gateway: some of the ways.
    Inclusive,
}

impl Kind {
    /// True for gateways.
    pub fn is_gateway(self) -> bool {
        matches!(self, Self::Exclusive | Self::Parallel | Self::Inclusive)
    }
}

/// Tasks, gateways and the flows between them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ProcessModel {
    /// Nodes; the first is the start, the second the end.
    pub kinds: Vec<Kind>,
    /// Flows from node to node; no two are alike.
    pub flows: Vec<(usize, usize)>,
}

/// The start of every model.
pub const START: usize = 0;
/// The end of every model.
pub const END: usize = 1;

impl ProcessModel {
    /// Appends a node.
    pub fn add(&mut self, kind: Kind) -> usize {
        self.kinds.push(kind);
        self.kinds.len() - 1
    }

    /// Flows into and out of every node, by number.
    pub fn ways(&self) -> (Vec<Vec<usize>>, Vec<Vec<usize>>) {
        let mut into = vec![Vec::new(); self.kinds.len()];
        let mut out = vec![Vec::new(); self.kinds.len()];
        for (flow, &(from, to)) in self.flows.iter().enumerate() {
            out[from].push(flow);
            into[to].push(flow);
        }
        (into, out)
    }

    /// Takes gateways out that neither join nor split, and flows that are there twice between
    /// exclusive gateways.
    pub fn simplify(&mut self) {
        loop {
            let (into, out) = self.ways();
            let idle = (0..self.kinds.len()).find(|&node| {
                self.kinds[node].is_gateway() && into[node].len() == 1 && out[node].len() == 1
            });
            let Some(node) = idle else { break };
            let (first, second) = (into[node][0], out[node][0]);
            self.flows[first].1 = self.flows[second].1;
            self.flows.swap_remove(second);
            self.forget(node);
        }
    }

    /// Takes a node without flows out; the last one takes its number.
    fn forget(&mut self, node: usize) {
        let last = self.kinds.len() - 1;
        self.kinds.swap_remove(node);
        for (from, to) in &mut self.flows {
            for end in [from, to] {
                if *end == last {
                    *end = node;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{END, Kind, ProcessModel, START};

    #[test]
    fn idle_gateways_go() {
        let mut model = ProcessModel { kinds: vec![Kind::Start, Kind::End], flows: Vec::new() };
        let gateways = [Kind::Exclusive, Kind::Parallel].map(|kind| model.add(kind));
        let task = model.add(Kind::Task(0));
        model.flows = vec![
            (START, gateways[0]),
            (gateways[0], task),
            (task, gateways[1]),
            (gateways[1], END),
        ];
        model.simplify();
        assert_eq!(model.kinds, [Kind::Start, Kind::End, Kind::Task(0)]);
        let mut flows = model.flows;
        flows.sort_unstable();
        assert_eq!(flows, [(START, 2), (2, END)]);
    }
}
