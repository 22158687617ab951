//! Step 10: from tasks and gateways to a Petri net.
//!
//! Activities are visible transitions, exclusive gateways places, parallel gateways silent
//! transitions. Two places in a row are one, unless the first has other ways out and the second
//! other ways in, or the first is the start of a run and can be come back to: then a silent
//! transition stands between.

use super::model::{END, Kind, ProcessModel, START};
use crate::process::event_log::Activity;
use crate::process::petri::{PetriNet, PlaceIndex, Transition};

/// The net of a model; silent transitions are called `tau1`, `tau2`, …
pub fn to_net(model: &ProcessModel, activities: &[Activity]) -> PetriNet {
    let (into, out) = model.ways();
    let mut merged: Vec<usize> = (0..model.kinds.len()).collect();
    let holds = |node: usize| !matches!(model.kinds[node], Kind::Task(_) | Kind::Parallel);
    // Places that tokens must not come back to, or leave.
    let closed = |a: usize, b: usize| {
        (a == START && into[b].len() > 1)
            || (b == END && out[a].len() > 1)
            || (a == START && b == END)
    };
    let mut between = Vec::new();
    for (flow, &(from, to)) in model.flows.iter().enumerate() {
        if !holds(from) || !holds(to) {
            continue;
        }
        let free = out[from].len() == 1 || into[to].len() == 1;
        let (a, b) = (root(&merged, from), root(&merged, to));
        let ends = [root(&merged, START), root(&merged, END)];
        let joins_ends = (a == ends[0] && b == ends[1]) || (a == ends[1] && b == ends[0]);
        if free && !closed(from, to) && !joins_ends && a != b {
            merged[a] = b;
        } else {
            between.push(flow);
        }
    }
    let mut net = Builder::default();
    let mut places = vec![None; model.kinds.len()];
    for node in 0..model.kinds.len() {
        let used = node == START || node == END || !into[node].is_empty();
        if holds(node) && used && root(&merged, node) == node {
            places[node] = Some(net.place());
        }
    }
    let place_of = |node: usize| places[root(&merged, node)].unwrap_or_default();
    let mut transitions = vec![None; model.kinds.len()];
    for node in 0..model.kinds.len() {
        match model.kinds[node] {
            Kind::Task(activity) if !into[node].is_empty() => {
                transitions[node] = Some(net.visible(&activities[activity as usize]));
            }
            Kind::Parallel => transitions[node] = Some(net.silent()),
            _ => {}
        }
    }
    for (flow, &(from, to)) in model.flows.iter().enumerate() {
        match (transitions[from], transitions[to]) {
            (Some(source), Some(target)) => {
                let place = net.place();
                net.put(source, place);
                net.take(target, place);
            }
            (Some(source), None) => net.put(source, place_of(to)),
            (None, Some(target)) => net.take(target, place_of(from)),
            (None, None) if between.contains(&flow) => {
                let (source, target) = (place_of(from), place_of(to));
                let silent = net.silent();
                net.take(silent, source);
                net.put(silent, target);
            }
            (None, None) => {}
        }
    }
    net.finish(place_of(START), place_of(END))
}

fn root(merged: &[usize], mut node: usize) -> usize {
    while merged[node] != node {
        node = merged[node];
    }
    node
}

#[derive(Default)]
struct Builder {
    places: usize,
    transitions: Vec<Transition>,
}

impl Builder {
    fn place(&mut self) -> PlaceIndex {
        self.places += 1;
        self.places as PlaceIndex - 1
    }

    fn visible(&mut self, activity: &Activity) -> usize {
        self.add(Some(activity.name.clone()), activity.class)
    }

    fn silent(&mut self) -> usize {
        self.add(None, None)
    }

    fn add(&mut self, label: Option<String>, class: Option<crate::plant::SignalClass>) -> usize {
        let (id, inputs, outputs) = (String::new(), Vec::new(), Vec::new());
        self.transitions.push(Transition { id, label, class, inputs, outputs });
        self.transitions.len() - 1
    }

    /// A token for `place`. Every arc weighs 1: a second token goes a way of its own.
    fn put(&mut self, transition: usize, place: PlaceIndex) {
        if !self.transitions[transition].outputs.contains(&place) {
            self.transitions[transition].outputs.push(place);
            return;
        }
        let detour = self.place();
        let silent = self.silent();
        self.transitions[transition].outputs.push(detour);
        self.transitions[silent].inputs.push(detour);
        self.transitions[silent].outputs.push(place);
    }

    fn take(&mut self, transition: usize, place: PlaceIndex) {
        if !self.transitions[transition].inputs.contains(&place) {
            self.transitions[transition].inputs.push(place);
            return;
        }
        let detour = self.place();
        let silent = self.silent();
        self.transitions[transition].inputs.push(detour);
        self.transitions[silent].inputs.push(place);
        self.transitions[silent].outputs.push(detour);
    }

    fn finish(mut self, start: PlaceIndex, end: PlaceIndex) -> PetriNet {
        let (mut visible, mut silent) = (0, 0);
        for transition in &mut self.transitions {
            let (name, number) = match transition.label {
                Some(_) => ("t", &mut visible),
                None => ("tau", &mut silent),
            };
            *number += 1;
            transition.id = format!("{name}{number}");
            transition.inputs.sort_unstable();
            transition.outputs.sort_unstable();
        }
        let mut net = PetriNet {
            name: String::new(),
            places: (1..=self.places).map(|number| format!("p{number}")).collect(),
            transitions: self.transitions,
            initial: vec![0; self.places],
            last: vec![0; self.places],
        };
        net.initial[start as usize] = 1;
        net.last[end as usize] = 1;
        net.places[start as usize] = "start".to_owned();
        net.places[end as usize] = "end".to_owned();
        net
    }
}

#[cfg(test)]
mod tests {
    use super::to_net;
    use crate::process::event_log::Activity;
    use crate::process::split_miner::model::{END, Kind, ProcessModel, START};

    #[test]
    fn a_repeated_activity_stands_between_two_places_of_its_own() {
        // start → join → task → split → end, and from the split back to the join.
        let kinds = vec![Kind::Start, Kind::End, Kind::Exclusive, Kind::Task(0), Kind::Exclusive];
        let flows = vec![(START, 2), (2, 3), (3, 4), (4, 2), (4, END)];
        let net = to_net(&ProcessModel { kinds, flows }, &[Activity::named("a")]);
        let arcs: Vec<_> = net
            .transitions
            .iter()
            .map(|t| (t.id.as_str(), t.inputs.len(), t.outputs.len()))
            .collect();
        assert_eq!(arcs.len(), 4, "{net:?}");
        assert!(arcs.iter().all(|&(_, inputs, outputs)| (inputs, outputs) == (1, 1)));
        let start = net.initial.iter().position(|&tokens| tokens == 1).map(|place| place as u32);
        assert!(net.transitions.iter().all(|t| !t.outputs.iter().any(|&p| Some(p) == start)));
        assert_eq!(net.places.len(), 4);
    }

    #[test]
    fn a_way_past_everything_is_silent() {
        let kinds = vec![Kind::Start, Kind::End];
        let net = to_net(&ProcessModel { kinds, flows: vec![(START, END)] }, &[]);
        assert_eq!((net.places.len(), net.transitions.len()), (2, 1));
        assert_eq!(net.transitions[0].label, None);
    }
}
