//! Nets and event logs in a line or two.

use runglight_engine::log::SECOND;
use runglight_engine::process::event_log::{Activity, EventLog};
use runglight_engine::process::petri::{PetriNet, PlaceIndex, Transition};

/// Label, input places, output places.
type Arcs<'a> = (Option<&'a str>, &'a [PlaceIndex], &'a [PlaceIndex]);

/// A net with a token on its first place at the start, and on its last one at the end.
pub fn net_of(places: &[&str], transitions: &[Arcs<'_>]) -> PetriNet {
    let mut initial = vec![0; places.len()];
    let mut last = initial.clone();
    initial[0] = 1;
    last[places.len() - 1] = 1;
    PetriNet {
        name: "net".to_owned(),
        places: places.iter().map(|&place| place.to_owned()).collect(),
        transitions: (0..)
            .zip(transitions)
            .map(|(index, &(label, inputs, outputs))| Transition {
                id: format!("t{index}"),
                label: label.map(str::to_owned),
                class: None,
                inputs: inputs.to_vec(),
                outputs: outputs.to_vec(),
            })
            .collect(),
        initial,
        last,
    }
}

/// Traces of (activity, second).
pub fn log_of(activities: &[&str], traces: &[&[(u32, i64)]]) -> EventLog {
    let activities = activities
        .iter()
        .map(|&name| Activity { name: name.to_owned(), class: None, changes: Vec::new() })
        .collect();
    let mut log = EventLog { activities, bounds: vec![0], ..EventLog::default() };
    for (index, events) in traces.iter().enumerate() {
        log.activity.extend(events.iter().map(|event| event.0));
        log.time.extend(events.iter().map(|event| event.1 * SECOND));
        log.bounds.push(log.activity.len());
        log.names.push(format!("{index}"));
    }
    log
}
