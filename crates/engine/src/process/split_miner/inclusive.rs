//! Step 9: inclusive joins are replaced. A flow that leads back makes a join exclusive. Else it is
//! what the splits between it and its dominator are, where they agree; where they do not, flows
//! whose last activities are concurrent are joined as parallel, and the others as exclusive.

use std::collections::BTreeSet;

use super::concurrency::Parallels;
use super::model::{Kind, ProcessModel, START};

/// Replaces every inclusive gateway; gives those whose splits did not agree.
pub fn replace(model: &mut ProcessModel, parallels: &Parallels) -> Vec<usize> {
    detach_loops(model);
    let mut doubtful = Vec::new();
    for node in 0..model.kinds.len() {
        if model.kinds[node] == Kind::Inclusive {
            if let Some(kind) = agreed(model, node) {
                model.kinds[node] = kind;
            } else {
                doubtful.extend(by_concurrency(model, node, parallels));
            }
        }
    }
    doubtful
}

/// Flows that lead back get an exclusive join of their own behind what they loop around.
fn detach_loops(model: &mut ProcessModel) {
    let back = leads_back(model);
    let (into, _) = model.ways();
    for (node, flows) in into.iter().enumerate() {
        let backward = flows.iter().filter(|&&flow| back[flow]).count();
        let forward: Vec<usize> = flows.iter().copied().filter(|&flow| !back[flow]).collect();
        if model.kinds[node] != Kind::Inclusive || backward == 0 {
            continue;
        }
        model.kinds[node] = Kind::Exclusive;
        if forward.len() > 1 {
            let join = model.add(Kind::Inclusive);
            for flow in forward {
                model.flows[flow].1 = join;
            }
            model.flows.push((join, node));
        }
    }
}

/// Flows to a node that a search in depth is still inside of.
fn leads_back(model: &ProcessModel) -> Vec<bool> {
    let (_, out) = model.ways();
    let mut back = vec![false; model.flows.len()];
    let mut seen = vec![false; model.kinds.len()];
    let mut inside = vec![false; model.kinds.len()];
    let mut stack = vec![(START, 0)];
    (seen[START], inside[START]) = (true, true);
    while let Some((node, next)) = stack.last_mut() {
        let node = *node;
        let Some(&flow) = out[node].get(*next) else {
            inside[node] = false;
            stack.pop();
            continue;
        };
        *next += 1;
        let target = model.flows[flow].1;
        back[flow] = inside[target];
        if !std::mem::replace(&mut seen[target], true) {
            inside[target] = true;
            stack.push((target, 0));
        }
    }
    back
}

/// What all splits between a join and its dominator are.
fn agreed(model: &ProcessModel, join: usize) -> Option<Kind> {
    let back = leads_back(model);
    let (into, out) = model.ways();
    let dominator = dominator(model, &back, join);
    let mut kinds = BTreeSet::new();
    let mut seen = BTreeSet::from([join]);
    let mut stack = vec![join];
    while let Some(node) = stack.pop() {
        for &flow in into[node].iter().filter(|&&flow| !back[flow]) {
            let source = model.flows[flow].0;
            if !seen.insert(source) {
                continue;
            }
            if model.kinds[source].is_gateway() && out[source].len() > 1 {
                kinds.insert(model.kinds[source] == Kind::Parallel);
            }
            if Some(source) != dominator {
                stack.push(source);
            }
        }
    }
    match kinds.into_iter().collect::<Vec<_>>()[..] {
        [false] => Some(Kind::Exclusive),
        [true] => Some(Kind::Parallel),
        _ => None,
    }
}

/// The last node before `join` that every way to it passes.
fn dominator(model: &ProcessModel, back: &[bool], join: usize) -> Option<usize> {
    let order = topological(model, back);
    let (into, _) = model.ways();
    let mut rank = vec![usize::MAX; model.kinds.len()];
    for (place, &node) in order.iter().enumerate() {
        rank[node] = place;
    }
    let mut immediate: Vec<Option<usize>> = vec![None; model.kinds.len()];
    for &node in &order {
        let sources =
            into[node].iter().filter(|&&flow| !back[flow]).map(|&flow| model.flows[flow].0);
        immediate[node] = sources.filter(|&source| rank[source] < rank[node]).reduce(|a, b| {
            let (mut a, mut b) = (a, b);
            while a != b {
                let later = if rank[a] > rank[b] { &mut a } else { &mut b };
                match immediate[*later] {
                    Some(up) => *later = up,
                    None => return START,
                }
            }
            a
        });
    }
    immediate[join]
}

/// Nodes so that every flow but those that lead back goes from an earlier to a later one.
fn topological(model: &ProcessModel, back: &[bool]) -> Vec<usize> {
    let (into, out) = model.ways();
    let mut missing: Vec<usize> =
        into.iter().map(|flows| flows.iter().filter(|&&flow| !back[flow]).count()).collect();
    let mut ready: Vec<usize> = vec![START];
    let mut order = Vec::with_capacity(missing.len());
    while let Some(node) = ready.pop() {
        order.push(node);
        for &flow in out[node].iter().filter(|&&flow| !back[flow]) {
            let target = model.flows[flow].1;
            missing[target] -= 1;
            if missing[target] == 0 {
                ready.push(target);
            }
        }
    }
    order
}

/// Joins flows by what is concurrent: parts that nothing concurrent ties exclude one another,
/// parts that are wholly concurrent run side by side.
fn by_concurrency(model: &mut ProcessModel, join: usize, parallels: &Parallels) -> Vec<usize> {
    let (into, _) = model.ways();
    let last: Vec<BTreeSet<usize>> =
        into[join].iter().map(|&flow| last_tasks(model, &into, flow)).collect();
    let beside = |a: usize, b: usize| {
        last[a].iter().any(|&x| last[b].iter().any(|y| parallels[x].contains(y)))
    };
    let flows = into[join].clone();
    let all: Vec<usize> = (0..flows.len()).collect();
    let mut made = Vec::new();
    model.kinds[join] = Kind::Exclusive;
    compose(model, &flows, &all, join, &beside, &mut made);
    made
}

fn compose(
    model: &mut ProcessModel,
    flows: &[usize],
    members: &[usize],
    join: usize,
    beside: &dyn Fn(usize, usize) -> bool,
    made: &mut Vec<usize>,
) {
    let exclusive = parts(members, &|a, b| beside(a, b));
    let parallel = parts(members, &|a, b| !beside(a, b));
    let (kind, parts) = match (exclusive.len(), parallel.len()) {
        (2.., _) => (Kind::Exclusive, exclusive),
        (_, 2..) => (Kind::Parallel, parallel),
        _ => (Kind::Exclusive, members.iter().map(|&member| vec![member]).collect()),
    };
    model.kinds[join] = kind;
    made.push(join);
    for part in parts {
        match part[..] {
            [only] => model.flows[flows[only]].1 = join,
            _ => {
                let inner = model.add(Kind::Exclusive);
                model.flows.push((inner, join));
                compose(model, flows, &part, inner, beside, made);
            }
        }
    }
}

/// Members that `tied` connects.
pub fn parts(members: &[usize], tied: &dyn Fn(usize, usize) -> bool) -> Vec<Vec<usize>> {
    let mut left: BTreeSet<usize> = members.iter().copied().collect();
    let mut parts = Vec::new();
    while let Some(first) = left.pop_first() {
        let mut part = vec![first];
        let mut next = 0;
        while let Some(&member) = part.get(next) {
            next += 1;
            let near: Vec<usize> =
                left.iter().copied().filter(|&other| tied(member, other)).collect();
            for other in near {
                left.remove(&other);
                part.push(other);
            }
        }
        part.sort_unstable();
        parts.push(part);
    }
    parts
}

/// The activities a flow's tokens can come from without another one between.
fn last_tasks(model: &ProcessModel, into: &[Vec<usize>], flow: usize) -> BTreeSet<usize> {
    let mut tasks = BTreeSet::new();
    let mut seen = BTreeSet::new();
    let mut stack = vec![model.flows[flow].0];
    while let Some(node) = stack.pop() {
        match model.kinds[node] {
            Kind::Task(activity) => {
                tasks.insert(activity as usize);
            }
            _ if seen.insert(node) => {
                stack.extend(into[node].iter().map(|&flow| model.flows[flow].0));
            }
            _ => {}
        }
    }
    tasks
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::replace;
    use crate::process::split_miner::model::{END, Kind, ProcessModel, START};

    /// 2 → 3 and 4; both lead to the tasks 5 and 6, which 7 joins.
    fn crosswise(outer: Kind, inner: Kind) -> ProcessModel {
        let mut kinds = vec![Kind::Start, Kind::End, outer, inner, inner];
        kinds.extend([Kind::Task(0), Kind::Task(1), Kind::Inclusive]);
        kinds.extend([Kind::Exclusive, Kind::Exclusive]);
        let flows = vec![
            (START, 2),
            (2, 3),
            (2, 4),
            (3, 8),
            (3, 9),
            (4, 8),
            (4, 9),
            (8, 5),
            (9, 6),
            (5, 7),
            (6, 7),
            (7, END),
        ];
        ProcessModel { kinds, flows }
    }

    #[test]
    fn splits_that_agree_decide() {
        for kind in [Kind::Exclusive, Kind::Parallel] {
            let mut model = crosswise(kind, kind);
            let none = vec![BTreeSet::new(); 4];
            assert!(replace(&mut model, &none).is_empty());
            assert_eq!(model.kinds[7], kind);
        }
    }

    #[test]
    fn else_concurrency_decides() {
        let together = vec![BTreeSet::from([1]), BTreeSet::from([0])];
        for (parallels, expected) in
            [(together, Kind::Parallel), (vec![BTreeSet::new(); 4], Kind::Exclusive)]
        {
            let mut model = crosswise(Kind::Exclusive, Kind::Parallel);
            assert_eq!(replace(&mut model, &parallels), [7]);
            assert_eq!(model.kinds[7], expected);
        }
    }

    #[test]
    fn a_flow_that_leads_back_makes_a_choice() {
        let kinds = vec![Kind::Start, Kind::End, Kind::Inclusive, Kind::Task(0), Kind::Exclusive];
        let flows = vec![(START, 2), (2, 3), (3, 4), (4, 2), (4, END)];
        let mut model = ProcessModel { kinds, flows };
        assert!(replace(&mut model, &vec![BTreeSet::new(); 3]).is_empty());
        assert_eq!(model.kinds[2], Kind::Exclusive);
    }
}
