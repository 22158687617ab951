//! What a network is trained with: scaled samples, the class of each, and what scaled them.

use super::decay::{Decay, Samples};
use super::event_log::{ActivityIndex, EventLog};
use super::next_activity::{NextActivity, Predictor, Scaling, most_probable};
use super::petri::PetriNet;
use super::replay::TokenReplay;
use super::succession::Succession;

/// The training part of an event log, replayed.
#[derive(Debug, Clone)]
pub struct Lesson {
    /// Activities that can be foretold: those of the net, then others the log has.
    pub activities: Vec<String>,
    /// How the places decay.
    pub decay: Decay,
    /// How features are scaled.
    pub scaling: Scaling,
    /// Scaled features and, as `next`, the number of the class among `activities`.
    pub samples: Samples,
}

impl Lesson {
    /// Everything, the decays and the scaling too, is learned from these traces alone.
    pub fn prepare(
        net: &PetriNet,
        log: &EventLog,
        traces: &[usize],
        succession: Succession,
    ) -> Self {
        let mut activities: Vec<String> = Vec::new();
        let labels = net.transitions.iter().filter_map(|transition| transition.label.as_ref());
        let logged = traces.iter().flat_map(|&trace| log.trace(trace));
        let logged = logged.map(|&activity| &log.activities[activity as usize].name);
        let openings = traces.iter().filter_map(|&trace| {
            let last = log.trace(trace).len().checked_sub(1)?;
            let (trace, event) = succession.next(log, trace, last)?;
            Some(&log.activities[log.trace(trace)[event] as usize].name)
        });
        for name in labels.chain(distinct(logged.chain(openings))) {
            if !activities.contains(name) {
                activities.push(name.clone());
            }
        }
        let mut replay = TokenReplay::of(net, &log.activities);
        let decay = Decay::fit(&mut replay, log, traces);
        let mut samples = Samples::take(&mut replay, &decay, log, traces, succession);
        let scaling = Scaling::fit(&samples);
        scaling.apply(&mut samples.features);
        let classes = classes(log, &activities);
        for next in &mut samples.next {
            *next = classes[*next as usize].unwrap_or_default() as u32;
        }
        Self { activities, decay, scaling, samples }
    }
}

fn distinct<'a>(names: impl Iterator<Item = &'a String>) -> impl Iterator<Item = &'a String> {
    let mut seen = std::collections::HashSet::new();
    names.filter(move |name| seen.insert(*name))
}

/// The class of each activity of a log, where it has one.
fn classes(log: &EventLog, activities: &[String]) -> Vec<Option<usize>> {
    let class = |name: &str| activities.iter().position(|known| known == name);
    log.activities.iter().map(|activity| class(&activity.name)).collect()
}

/// One event as it was foretold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foretold {
    /// Trace the event belongs to.
    pub trace: usize,
    /// Its place in the trace.
    pub event: usize,
    /// The most probable activity, among those of the network.
    pub expected: usize,
    /// What came, among the activities of the log.
    pub came: ActivityIndex,
    /// The probability of what came; 0 for an activity the network does not know.
    pub probability: f32,
    /// What came was the most probable.
    pub right: bool,
}

/// Foretells what follows each event of some traces.
pub fn foretell(
    next: &mut NextActivity,
    net: &PetriNet,
    log: &EventLog,
    traces: &[usize],
    succession: Succession,
) -> Vec<Foretold> {
    let mut replay = TokenReplay::of(net, &log.activities);
    let samples = Samples::take(&mut replay, next.decay(), log, traces, succession);
    let classes = classes(log, next.activities());
    let rows = samples.features.chunks_exact(samples.width().max(1));
    rows.zip(samples.next.iter().zip(&samples.event))
        .map(|(row, (&came, &(trace, event)))| {
            let probabilities = next.of_sample(row);
            let expected = most_probable(probabilities).unwrap_or_default();
            let class = classes[came as usize];
            let probability = class.map_or(0.0, |class| probabilities[class]);
            let right = class == Some(expected);
            Foretold { trace, event, expected, came, probability, right }
        })
        .collect()
}
