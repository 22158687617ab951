//! The next-activity network as whoever decides (Theis 2019, rule 3).

use super::decide::{Decide, Fired};
use super::program::Program;
use crate::process::decay::DecayState;
use crate::process::next_activity::{NextActivity, Predictor};
use crate::process::petri::TransitionIndex;
use crate::process::replay::TokenReplay;

/// A trained network and the replay that makes its samples.
///
/// The run so far is replayed as the training was, so that the network sees what it has learned
/// from; the sample is taken at the last event's time, as in training.
pub struct Predicted {
    next: NextActivity,
    replay: TokenReplay,
    state: DecayState,
    /// By activity of the network.
    transitions: Vec<Option<TransitionIndex>>,
    /// By transition: its activity among those of the network.
    activities: Vec<Option<u32>>,
}

impl Predicted {
    /// Over the net the network was trained with.
    pub fn new(program: &Program, next: NextActivity) -> Self {
        let net = &program.net;
        let replay = TokenReplay::new(net, next.activities().iter().map(String::as_str));
        let label = |index: &String| net.labelled(index);
        let transitions = next.activities().iter().map(label).collect();
        let activities = net
            .transitions
            .iter()
            .map(|transition| next.index(transition.label.as_deref()?).map(|index| index as u32))
            .collect();
        Self { state: DecayState::new(net), next, replay, transitions, activities }
    }
}

impl Decide for Predicted {
    fn next(&mut self, run: &[Fired]) -> Vec<(Option<TransitionIndex>, f64)> {
        let Some(first) = run.first() else { return Vec::new() };
        self.replay.restart();
        self.state.restart(self.replay.net(), first.time);
        for fired in run {
            let Some(activity) = self.activities[fired.transition as usize] else { continue };
            let moved = self.replay.step(activity);
            let touched = self.replay.touched(&moved);
            self.state.follow(touched, self.replay.marking(), fired.time);
        }
        let time = self.state.time();
        let probabilities = self.next.probabilities(&self.state, time);
        self.transitions
            .iter()
            .zip(probabilities)
            .filter_map(|(transition, &chance)| Some((Some((*transition)?), f64::from(chance))))
            .collect()
    }
}
