//! Step 8: join gateways, from the inner fragments outwards.
//!
//! The flows of a bond that arrive at one node are joined as its entry splits them; in a rigid
//! they are joined by an inclusive gateway, which step 9 minimises; a loop is entered by an
//! exclusive one, and what leads back is joined as its exit splits.

use std::collections::BTreeSet;

use super::model::{Kind, ProcessModel};
use super::structure::{Shape, fragments};

/// Gives every join a gateway, but for those that are settled.
pub fn discover(model: &mut ProcessModel, settled: &BTreeSet<usize>) {
    separate(model, settled);
    // Where each flow's tokens arrive now: joined flows are told by the first of them.
    let mut current: Vec<usize> = (0..model.flows.len()).collect();
    let (_, out) = model.ways();
    let splits = |node: usize, model: &ProcessModel| {
        let kind = model.kinds[node];
        (kind.is_gateway() && out.get(node).is_some_and(|out| out.len() > 1)).then_some(kind)
    };
    for fragment in fragments(model) {
        let kind = match fragment.shape {
            Shape::Bond => splits(fragment.entry, model),
            Shape::Loop => splits(fragment.exit, model),
            Shape::Rigid => None,
        };
        for (node, flows) in fragment.arrivals {
            if settled.contains(&node) {
                continue;
            }
            let gateway = model.add(kind.unwrap_or(Kind::Inclusive));
            for &flow in &flows {
                model.flows[current[flow]].1 = gateway;
            }
            current[flows[0]] = model.flows.len();
            model.flows.push((gateway, node));
        }
        let entry = fragment.entry;
        let open = model.kinds[entry].is_gateway() && !settled.contains(&entry);
        if fragment.shape == Shape::Loop && open {
            model.kinds[entry] = Kind::Exclusive;
        }
    }
    model.simplify();
}

/// Every node that several flows enter gets a join of its own before it (step 7).
fn separate(model: &mut ProcessModel, settled: &BTreeSet<usize>) {
    let (into, _) = model.ways();
    for (node, flows) in into.iter().enumerate() {
        if flows.len() < 2 || settled.contains(&node) {
            continue;
        }
        let join = model.add(Kind::Inclusive);
        for &flow in flows {
            model.flows[flow].1 = join;
        }
        model.flows.push((join, node));
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::discover;
    use crate::process::split_miner::model::{END, Kind, ProcessModel, START};

    fn joined(gateways: &[Kind], tasks: u32, flows: &[(usize, usize)]) -> ProcessModel {
        let mut kinds = vec![Kind::Start, Kind::End];
        kinds.extend(gateways);
        kinds.extend((0..tasks).map(Kind::Task));
        let mut model = ProcessModel { kinds, flows: flows.to_vec() };
        discover(&mut model, &BTreeSet::new());
        model
    }

    fn join_kinds(model: &ProcessModel) -> Vec<Kind> {
        let (into, _) = model.ways();
        (0..model.kinds.len()).filter(|&n| into[n].len() > 1).map(|n| model.kinds[n]).collect()
    }

    #[test]
    fn a_bond_is_joined_as_it_was_split() {
        for kind in [Kind::Exclusive, Kind::Parallel] {
            let model = joined(&[kind], 2, &[(START, 2), (2, 3), (2, 4), (3, END), (4, END)]);
            assert_eq!(join_kinds(&model), [kind]);
        }
    }

    #[test]
    fn inner_bonds_are_joined_before_outer_ones() {
        let flows = [(START, 2), (2, 3), (2, 4), (3, 5), (3, 6), (5, END), (6, END), (4, END)];
        let model = joined(&[Kind::Exclusive, Kind::Parallel], 3, &flows);
        // Tasks stand behind the gateways: 4, 5 and 6.
        let mut kinds = join_kinds(&model);
        kinds.sort_by_key(|&kind| kind == Kind::Parallel);
        assert_eq!(kinds, [Kind::Exclusive, Kind::Parallel]);
    }

    #[test]
    fn a_loop_is_entered_by_a_choice() {
        let model = joined(&[Kind::Exclusive], 1, &[(START, 3), (3, 2), (2, 3), (2, END)]);
        assert_eq!(join_kinds(&model), [Kind::Exclusive]);
    }
}
