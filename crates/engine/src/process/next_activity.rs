//! What comes next in a running trace, and how surely (Theis & Darabi 2019, DREAM-NAP).

use super::decay::{Decay, DecayState, Samples};
use super::network::Network;
use crate::log::Nanoseconds;

/// Brings each feature to [0, 1] as it ran on the training part.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Scaling {
    /// Least value of each feature.
    pub minimum: Vec<f32>,
    /// Largest less least value of each feature; 0 for one that never changed.
    pub span: Vec<f32>,
}

impl Scaling {
    /// From the samples of the training part.
    pub fn fit(samples: &Samples) -> Self {
        let width = samples.width();
        let mut minimum = vec![f32::INFINITY; width];
        let mut maximum = vec![f32::NEG_INFINITY; width];
        for row in samples.features.chunks_exact(width.max(1)) {
            for (index, &value) in row.iter().enumerate() {
                minimum[index] = minimum[index].min(value);
                maximum[index] = maximum[index].max(value);
            }
        }
        let span = minimum.iter().zip(maximum).map(|(least, largest)| largest - least).collect();
        Self { minimum, span }
    }

    /// Scales samples in place, one after another. A feature that never changed becomes 0.
    pub fn apply(&self, features: &mut [f32]) {
        for row in features.chunks_exact_mut(self.span.len().max(1)) {
            for ((value, &minimum), &span) in row.iter_mut().zip(&self.minimum).zip(&self.span) {
                *value = if span > 0.0 { (*value - minimum) / span } else { 0.0 };
            }
        }
    }
}

/// Tells what comes next, at every scan of a controller or at every event of a log.
pub trait Predictor {
    /// Names of the activities it can foretell, in the order of the probabilities.
    fn activities(&self) -> &[String];

    /// The probability of each activity to be the next event. `now` is the time the decays are
    /// taken at; [`DecayState::time`], the last event's own, is what the network was trained with.
    fn probabilities(&mut self, state: &DecayState, now: Nanoseconds) -> &[f32];
}

/// A trained network with all it takes to ask it.
#[derive(Debug, Clone)]
pub struct NextActivity {
    activities: Vec<String>,
    decay: Decay,
    scaling: Scaling,
    network: Network,
    features: Vec<f32>,
}

impl NextActivity {
    /// `None` where the parts are not of one size.
    pub fn new(
        activities: Vec<String>,
        decay: Decay,
        scaling: Scaling,
        network: Network,
    ) -> Option<Self> {
        let width = DecayState::features(decay.rate_per_s.len());
        let fits = network.inputs() == width
            && scaling.minimum.len() == width
            && scaling.span.len() == width
            && network.outputs() == activities.len();
        fits.then(|| Self { activities, decay, scaling, network, features: vec![0.0; width] })
    }

    /// How the places of the net decay.
    pub fn decay(&self) -> &Decay {
        &self.decay
    }

    /// How features are scaled.
    pub fn scaling(&self) -> &Scaling {
        &self.scaling
    }

    /// The network itself.
    pub fn network(&self) -> &Network {
        &self.network
    }

    /// Number of an activity among the probabilities.
    pub fn index(&self, activity: &str) -> Option<usize> {
        self.activities.iter().position(|name| name == activity)
    }

    /// The probabilities for one sample as [`DecayState::sample`] writes it.
    pub fn of_sample(&mut self, sample: &[f32]) -> &[f32] {
        self.features.copy_from_slice(sample);
        self.scaling.apply(&mut self.features);
        self.network.probabilities(&self.features)
    }
}

impl Predictor for NextActivity {
    fn activities(&self) -> &[String] {
        &self.activities
    }

    fn probabilities(&mut self, state: &DecayState, now: Nanoseconds) -> &[f32] {
        state.sample(&self.decay, now, &mut self.features);
        self.scaling.apply(&mut self.features);
        self.network.probabilities(&self.features)
    }
}

/// The most probable class; the first of several.
pub fn most_probable(probabilities: &[f32]) -> Option<usize> {
    let mut best: Option<(usize, f32)> = None;
    for (index, &probability) in probabilities.iter().enumerate() {
        if best.is_none_or(|(_, largest)| probability > largest) {
            best = Some((index, probability));
        }
    }
    best.map(|(index, _)| index)
}
