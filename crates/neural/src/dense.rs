//! Fully connected layers while they learn: forwards, backwards, and a step of Adam.

use runglight_engine::process::network::{Layer, Network};

use crate::random::Random;

/// Share of the units that rest in each step, behind every hidden layer.
const DROPOUT: f32 = 0.2;

/// Decay of Adam's two moments, and what keeps it from dividing by nothing (Kingma & Ba 2015).
const MOMENTS: (f32, f32) = (0.9, 0.999);
const EPSILON: f32 = 1e-8;

/// Numbers that are learned, their gradient, and its running moments.
struct Learned {
    value: Vec<f32>,
    gradient: Vec<f32>,
    first: Vec<f32>,
    second: Vec<f32>,
}

impl Learned {
    fn new(value: Vec<f32>) -> Self {
        let nothing = vec![0.0; value.len()];
        Self { gradient: nothing.clone(), first: nothing.clone(), second: nothing, value }
    }

    /// One step of Adam; `rates` are the step size and both corrections for the number of steps.
    fn step(&mut self, (size, first_due, second_due): (f32, f32, f32)) {
        let moments = self.first.iter_mut().zip(&mut self.second);
        let values = self.value.iter_mut().zip(&mut self.gradient);
        for ((value, gradient), (first, second)) in values.zip(moments) {
            *first = MOMENTS.0 * *first + (1.0 - MOMENTS.0) * *gradient;
            *second = MOMENTS.1 * *second + (1.0 - MOMENTS.1) * *gradient * *gradient;
            *value -= size * (*first / first_due) / ((*second / second_due).sqrt() + EPSILON);
            *gradient = 0.0;
        }
    }
}

/// One layer and what the present sample is in it.
struct LearningLayer {
    inputs: usize,
    outputs: usize,
    /// `weights[input * outputs + output]`.
    weights: Learned,
    bias: Learned,
    /// What it gave, after ReLU and dropout where it is hidden.
    given: Vec<f32>,
    /// How the loss changes with each number it gave; behind ReLU and dropout, before them later.
    blame: Vec<f32>,
    /// 0 for units that rest, 1 / (1 − share) for others: sums keep their size.
    mask: Vec<f32>,
}

impl LearningLayer {
    fn forward(&mut self, from: &[f32]) {
        self.given.copy_from_slice(&self.bias.value);
        for (&value, weights) in from.iter().zip(self.weights.value.chunks_exact(self.outputs)) {
            for (sum, &weight) in self.given.iter_mut().zip(weights) {
                *sum += value * weight;
            }
        }
    }

    /// A ReLU, then dropout.
    fn activate(&mut self) {
        for (value, &mask) in self.given.iter_mut().zip(&self.mask) {
            *value = value.max(0.0) * mask;
        }
    }

    /// Adds to the gradients what `blame` says, and passes it on to what it was given.
    fn backward(&mut self, from: &[f32], into: Option<&mut [f32]>) {
        let gradients = self.weights.gradient.chunks_exact_mut(self.outputs);
        for (&value, gradients) in from.iter().zip(gradients) {
            for (gradient, &blame) in gradients.iter_mut().zip(&self.blame) {
                *gradient += value * blame;
            }
        }
        for (gradient, &blame) in self.bias.gradient.iter_mut().zip(&self.blame) {
            *gradient += blame;
        }
        let Some(into) = into else { return };
        for (sum, weights) in into.iter_mut().zip(self.weights.value.chunks_exact(self.outputs)) {
            *sum = weights.iter().zip(&self.blame).map(|(weight, blame)| weight * blame).sum();
        }
    }
}

/// A network that learns.
pub struct Dense {
    layers: Vec<LearningLayer>,
    steps: i32,
}

impl Dense {
    /// Glorot's uniform weights, no bias: what the authors' library begins with.
    pub fn new(width: usize, classes: usize, random: &mut Random) -> Self {
        let mut inputs = width;
        let layers = Network::sizes(width, classes).into_iter().map(|outputs| {
            let limit = (6.0 / (inputs + outputs) as f32).sqrt();
            let weights =
                (0..inputs * outputs).map(|_| (2.0 * random.unit() - 1.0) * limit).collect();
            let layer = LearningLayer {
                inputs,
                outputs,
                weights: Learned::new(weights),
                bias: Learned::new(vec![0.0; outputs]),
                given: vec![0.0; outputs],
                blame: vec![0.0; outputs],
                mask: vec![1.0; outputs],
            };
            inputs = outputs;
            layer
        });
        Self { layers: layers.collect(), steps: 0 }
    }

    /// Adds the gradients of a batch's mean cross entropy, and returns it; every sample has its
    /// own dropout.
    pub fn learn<'a>(
        &mut self,
        samples: impl ExactSizeIterator<Item = (&'a [f32], u32)>,
        random: &mut Random,
    ) -> f32 {
        let share = 1.0 / samples.len() as f32;
        let mut loss = 0.0;
        for (features, class) in samples {
            let hidden = self.layers.len() - 1;
            for layer in &mut self.layers[..hidden] {
                for mask in &mut layer.mask {
                    *mask = if random.unit() < DROPOUT { 0.0 } else { 1.0 / (1.0 - DROPOUT) };
                }
            }
            loss += share * self.forward(features, class as usize);
            self.backward(features, class as usize, share);
        }
        loss
    }

    /// One step of Adam along the gradients, which are nothing again.
    pub fn step(&mut self, size: f32) {
        self.steps += 1;
        let due = |decay: f32| (1.0 - f64::from(decay).powi(self.steps)) as f32;
        let rates = (size, due(MOMENTS.0), due(MOMENTS.1));
        for layer in &mut self.layers {
            layer.weights.step(rates);
            layer.bias.step(rates);
        }
    }

    /// The network as it is asked; `None` where a weight is no number any more.
    pub fn network(&self) -> Option<Network> {
        let layers = self.layers.iter().map(|layer| {
            let (weights, bias) = (layer.weights.value.clone(), layer.bias.value.clone());
            let sound = weights.iter().chain(&bias).all(|value| value.is_finite());
            Layer::new(layer.inputs, layer.outputs, weights, bias).filter(|_| sound)
        });
        Network::new(layers.collect::<Option<_>>()?)
    }

    /// Cross entropy of one sample; the last layer then holds its probabilities.
    fn forward(&mut self, features: &[f32], class: usize) -> f32 {
        let last = self.layers.len() - 1;
        for index in 0..=last {
            let (before, rest) = self.layers.split_at_mut(index);
            let layer = &mut rest[0];
            layer.forward(before.last().map_or(features, |before| &before.given));
            if index < last {
                layer.activate();
            }
        }
        let given = &mut self.layers[last].given;
        let largest = given.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let sum: f32 = given.iter().map(|&logit| libm::expf(logit - largest)).sum();
        let loss = libm::logf(sum) - (given[class] - largest);
        for value in given.iter_mut() {
            *value = libm::expf(*value - largest) / sum;
        }
        loss
    }

    /// Adds one sample's gradients, weighed by `share`.
    fn backward(&mut self, features: &[f32], class: usize, share: f32) {
        let last = self.layers.len() - 1;
        let layer = &mut self.layers[last];
        for (index, (blame, &probability)) in layer.blame.iter_mut().zip(&layer.given).enumerate() {
            *blame = share * (probability - if index == class { 1.0 } else { 0.0 });
        }
        for index in (0..=last).rev() {
            let (before, rest) = self.layers.split_at_mut(index);
            match before.last_mut() {
                None => rest[0].backward(features, None),
                Some(before) => {
                    rest[0].backward(&before.given, Some(&mut before.blame));
                    let units = before.blame.iter_mut().zip(&before.given).zip(&before.mask);
                    for ((blame, &given), &mask) in units {
                        *blame = if given > 0.0 { *blame * mask } else { 0.0 };
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wake(dense: &mut Dense) {
        for layer in &mut dense.layers {
            layer.mask.fill(1.0);
        }
    }

    /// Every gradient against the slope of the loss itself.
    #[test]
    fn gradients_are_the_slopes_of_the_loss() {
        let mut dense = Dense::new(7, 3, &mut Random::new(5));
        // Some units rest, as in training.
        dense.layers[0].mask[2] = 0.0;
        dense.layers[1].mask.fill(1.25);
        let features = [0.9, 0.1, 0.5, 0.7, 0.2, 1.0, 0.4];
        let loss = dense.forward(&features, 1);
        dense.backward(&features, 1, 1.0);
        assert!(loss > 0.0);
        let step = 1e-2;
        let mut checked = 0;
        for layer in 0..dense.layers.len() {
            for index in 0..dense.layers[layer].weights.value.len() {
                let told = dense.layers[layer].weights.gradient[index];
                let at = dense.layers[layer].weights.value[index];
                let mut loss_at = |value: f32| {
                    dense.layers[layer].weights.value[index] = value;
                    dense.forward(&features, 1)
                };
                let slope = (loss_at(at + step) - loss_at(at - step)) / (2.0 * step);
                loss_at(at);
                assert!((slope - told).abs() < 3e-3, "layer {layer}, {index}: {slope} {told}");
                checked += usize::from(told.abs() > 1e-2);
            }
        }
        assert!(checked > 20, "only {checked} gradients were worth a check");
    }

    #[test]
    fn the_first_step_of_adam_is_the_step_size_against_the_gradient() {
        let mut learned = Learned::new(vec![1.0, 1.0, 1.0]);
        learned.gradient = vec![0.5, -20.0, 0.0];
        learned.step((0.01, 0.1, 0.001));
        let wanted = [0.99, 1.01, 1.0];
        assert!(learned.value.iter().zip(wanted).all(|(is, wanted)| (is - wanted).abs() < 1e-5));
        assert_eq!(learned.gradient, [0.0; 3]);
    }

    #[test]
    fn what_was_learned_is_what_is_asked() {
        let mut dense = Dense::new(7, 3, &mut Random::new(5));
        wake(&mut dense);
        let features = [0.9, 0.1, 0.5, 0.7, 0.2, 1.0, 0.4];
        dense.forward(&features, 0);
        let given = dense.layers[4].given.clone();
        let network = dense.network();
        let asked = network.map(|mut network| network.probabilities(&features).to_vec());
        let close = |asked: Vec<f32>| asked.iter().zip(&given).all(|(a, b)| (a - b).abs() < 1e-6);
        assert!(asked.is_some_and(close));
    }
}
