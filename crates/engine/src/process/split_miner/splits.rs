//! Steps 6 and 7: split gateways, and self-loops as loops of gateways.
//!
//! The successors of a node are items: what each covers (its past) and what runs beside it (its
//! future). Items with equal futures exclude one another; items whose past and future together are
//! equal run side by side. The rest of the choice is forced: the two items that differ least.
//!
//! Concurrent activities that lead to the same several successors have no choice of their own: each
//! would have to make the same one. They are joined first, and the choice is made once. (The
//! published algorithm joins only behind the choices, which a rigid then cannot undo.)
//!
//! A node that joins and splits is separated: what joins stands before it, what splits behind.

use std::collections::{BTreeMap, BTreeSet};

use super::concurrency::Parallels;
use super::follows::{Follows, Node};
use super::inclusive::parts;
use super::model::{Kind, ProcessModel};
use crate::process::event_log::ActivityIndex;

/// A way out of the node being split.
#[derive(Debug, Clone)]
struct Item {
    target: usize,
    past: BTreeSet<Node>,
    future: BTreeSet<Node>,
}

impl Item {
    fn whole(&self) -> BTreeSet<Node> {
        &self.past | &self.future
    }
}

/// A model whose splits are gateways, with the joins that are settled already; other joins are still
/// nodes that several flows enter. The node of activity `a` is `a + 2`.
pub fn discover(graph: &Follows, parallels: &Parallels) -> (ProcessModel, BTreeSet<usize>) {
    let mut model = ProcessModel { kinds: vec![Kind::Start, Kind::End], flows: Vec::new() };
    for activity in 0..graph.activities {
        model.add(Kind::Task(activity as ActivityIndex));
    }
    let place = |node: Node| match node {
        node if node == graph.start() => 0,
        node if node == graph.end() => 1,
        activity => activity + 2,
    };
    let mut repeats = graph.repeats.clone();
    let mut settled = BTreeSet::new();
    let mut done = BTreeSet::new();
    let mut sources = vec![0; graph.next.len()];
    for (node, first) in sources.iter_mut().enumerate() {
        let mut source = place(node);
        if let Some(true) = repeats.get_mut(node).map(|repeat| std::mem::replace(repeat, false)) {
            // The way back begins at a gateway of its own and ends at the task itself, which its
            // join will precede.
            let split = model.add(Kind::Exclusive);
            model.flows.extend([(source, split), (split, source)]);
            source = split;
        }
        *first = source;
    }
    for part in shared_choices(graph, parallels) {
        let beside = |a: Node, b: Node| parallels[a].contains(&b);
        let joined = compose(&mut model, &part, Kind::Parallel, &beside, &sources, &mut settled);
        split_into(joined, items_of(graph, parallels, part[0], &place), &mut model);
        done.extend(part);
    }
    for node in (0..graph.next.len()).filter(|node| !done.contains(node)) {
        let items = items_of(graph, parallels, node, &place);
        split_into(sources[node], items, &mut model);
    }
    (model, settled)
}

fn items_of(
    graph: &Follows,
    parallels: &Parallels,
    node: Node,
    place: &dyn Fn(Node) -> usize,
) -> Vec<Item> {
    let successors: BTreeSet<Node> = graph.next[node].keys().copied().collect();
    let item = |&successor: &Node| Item {
        target: place(successor),
        past: BTreeSet::from([successor]),
        future: &parallels[successor] & &successors,
    };
    successors.iter().map(item).collect()
}

fn split_into(source: usize, mut items: Vec<Item>, model: &mut ProcessModel) {
    while items.len() > 1 {
        exclusive(&mut items, model);
        if items.len() > 1 && !parallel(&mut items, model) {
            forced(&mut items, model);
        }
    }
    model.flows.extend(items.first().map(|only| (source, only.target)));
}

/// Activities that lead to the same several successors and run side by side, as wholes.
fn shared_choices(graph: &Follows, parallels: &Parallels) -> Vec<Vec<Node>> {
    let mut alike: BTreeMap<Vec<Node>, Vec<Node>> = BTreeMap::new();
    for node in 0..graph.activities {
        let successors: Vec<Node> = graph.next[node].keys().copied().collect();
        if successors.len() > 1 {
            alike.entry(successors).or_default().push(node);
        }
    }
    let beside = |a: Node, b: Node| parallels[a].contains(&b);
    let parts = alike.into_values().flat_map(|members| parts(&members, &beside));
    parts.filter(|part| part.len() > 1 && is_composed(part, true, &beside)).collect()
}

/// True where members fall apart into wholly concurrent and wholly exclusive parts, all the way.
fn is_composed(members: &[Node], concurrent: bool, beside: &dyn Fn(Node, Node) -> bool) -> bool {
    let smaller = parts(members, &|a, b| beside(a, b) != concurrent);
    members.len() == 1
        || (smaller.len() > 1 && smaller.iter().all(|part| is_composed(part, !concurrent, beside)))
}

/// Joins members as they were seen to run; gives the node that all of them have led to.
fn compose(
    model: &mut ProcessModel,
    members: &[Node],
    kind: Kind,
    beside: &dyn Fn(Node, Node) -> bool,
    sources: &[usize],
    settled: &mut BTreeSet<usize>,
) -> usize {
    if let [only] = members {
        return sources[*only];
    }
    let concurrent = kind == Kind::Parallel;
    let other = if concurrent { Kind::Exclusive } else { Kind::Parallel };
    let gateway = model.add(kind);
    settled.insert(gateway);
    for part in parts(members, &|a, b| beside(a, b) != concurrent) {
        let joined = compose(model, &part, other, beside, sources, settled);
        model.flows.push((joined, gateway));
    }
    gateway
}

/// Merges all items of equal futures.
fn exclusive(items: &mut Vec<Item>, model: &mut ProcessModel) {
    let mut merged: Vec<(Item, Vec<usize>)> = Vec::new();
    for item in items.drain(..) {
        match merged.iter_mut().find(|(known, _)| known.future == item.future) {
            Some((known, targets)) => {
                known.past.extend(&item.past);
                targets.push(item.target);
            }
            None => {
                let targets = vec![item.target];
                merged.push((item, targets));
            }
        }
    }
    items.extend(
        merged.into_iter().map(|(item, targets)| gateway(item, targets, Kind::Exclusive, model)),
    );
}

/// Merges the first group of items that run side by side; false where there is none.
fn parallel(items: &mut Vec<Item>, model: &mut ProcessModel) -> bool {
    let wholes: Vec<_> = items.iter().map(Item::whole).collect();
    let group = (0..items.len())
        .map(|first| (first..items.len()).filter(|&other| wholes[other] == wholes[first]).collect())
        .find(|group: &Vec<usize>| group.len() > 1);
    match group {
        Some(group) => {
            join(items, &group, model);
            true
        }
        None => false,
    }
}

/// Merges the two items that differ least as if they ran side by side.
fn forced(items: &mut Vec<Item>, model: &mut ProcessModel) {
    let wholes: Vec<_> = items.iter().map(Item::whole).collect();
    let differ = |&(a, b): &(usize, usize)| (&wholes[a] ^ &wholes[b]).len();
    let pairs = (0..items.len()).flat_map(|a| (a + 1..items.len()).map(move |b| (a, b)));
    if let Some((a, b)) = pairs.min_by_key(differ) {
        join(items, &[a, b], model);
    }
}

fn join(items: &mut Vec<Item>, group: &[usize], model: &mut ProcessModel) {
    let members: Vec<Item> = group.iter().rev().map(|&member| items.remove(member)).collect();
    let mut merged = members[0].clone();
    for member in &members[1..] {
        merged.past.extend(&member.past);
        merged.future = &merged.future & &member.future;
    }
    let targets = members.iter().rev().map(|member| member.target).collect();
    items.push(gateway(merged, targets, Kind::Parallel, model));
}

fn gateway(item: Item, targets: Vec<usize>, kind: Kind, model: &mut ProcessModel) -> Item {
    if targets.len() == 1 {
        return item;
    }
    let split = model.add(kind);
    model.flows.extend(targets.into_iter().map(|target| (split, target)));
    Item { target: split, ..item }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::discover;
    use crate::process::event_log::EventLog;
    use crate::process::split_miner::concurrency;
    use crate::process::split_miner::follows::Follows;
    use crate::process::split_miner::model::{Kind, ProcessModel};

    fn split(traces: &[&str]) -> ProcessModel {
        let traces = traces.iter().map(|trace| trace.split("").filter(|name| !name.is_empty()));
        let mut graph = Follows::of(&EventLog::from_traces(traces));
        let parallels = concurrency::discover(&mut graph, &BTreeSet::new(), 0.5);
        discover(&graph, &parallels).0
    }

    fn gateways(model: &ProcessModel) -> Vec<Kind> {
        model.kinds.iter().copied().filter(|kind| kind.is_gateway()).collect()
    }

    fn targets(model: &ProcessModel, node: usize) -> Vec<Kind> {
        let flows = model.flows.iter().filter(|flow| flow.0 == node);
        flows.map(|&(_, to)| model.kinds[to]).collect()
    }

    #[test]
    fn one_of_two() {
        let model = split(&["abd", "acd"]);
        assert_eq!(gateways(&model), [Kind::Exclusive]);
        assert_eq!(targets(&model, 2), [Kind::Exclusive]);
    }

    #[test]
    fn both_at_once() {
        let model = split(&["abcd", "acbd"]);
        assert_eq!(gateways(&model), [Kind::Parallel]);
    }

    #[test]
    fn a_choice_beside_a_third() {
        let model = split(&["abde", "adbe", "acde", "adce"]);
        assert_eq!(gateways(&model), [Kind::Exclusive, Kind::Parallel]);
        let outer = model.kinds.iter().position(|&kind| kind == Kind::Parallel);
        assert_eq!(outer.map(|node| targets(&model, node).len()), Some(2));
    }

    #[test]
    fn concurrent_activities_choose_together() {
        let model = split(&["abc", "bac", "abd", "bad"]);
        let mut kinds = gateways(&model);
        kinds.sort_by_key(|&kind| kind == Kind::Exclusive);
        // A split and a join of a and b, and one choice of what follows.
        assert_eq!(kinds, [Kind::Parallel, Kind::Parallel, Kind::Exclusive]);
    }

    #[test]
    fn a_repeated_activity_is_a_loop_of_its_own() {
        let model = split(&["abbc", "abc"]);
        assert_eq!(gateways(&model), [Kind::Exclusive]);
        let split = model.kinds.len() - 1;
        assert_eq!(targets(&model, split), [Kind::Task(1), Kind::Task(2)]);
    }
}
