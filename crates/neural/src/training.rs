//! Training a small network of fully connected layers with candle.
//!
//! Weights, order of samples and dropout come from one seeded generator of our own: candle's on
//! the processor cannot be seeded.

use candle_core::{Device, Tensor, Var};
use candle_nn::loss::cross_entropy;
use candle_nn::{AdamW, Optimizer, ParamsAdamW};
use thiserror::Error;

use runglight_engine::process::network::{Layer, Network};

use crate::random::Random;

/// Share of the units that rest in each step, behind every hidden layer.
const DROPOUT: f32 = 0.2;

/// How training goes.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Settings {
    /// Passes over the samples; at most so many with early stopping.
    pub epochs: usize,
    /// Samples per step.
    pub batch: usize,
    /// Step size of Adam.
    pub learning_rate: f64,
    /// The same seed gives the same network.
    pub seed: u64,
    /// Stop when what is held out has not got better for so many epochs, and keep the best.
    pub patience: Option<usize>,
}

impl Default for Settings {
    fn default() -> Self {
        Self { epochs: 5, batch: 64, learning_rate: 1e-3, seed: 0, patience: None }
    }
}

/// How training stands after an epoch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Epoch {
    /// Number of the epoch, from 1.
    pub number: usize,
    /// Mean cross entropy over the epoch, with dropout.
    pub loss: f32,
    /// Cross entropy of what is held out, where there is any.
    pub held_out_loss: Option<f32>,
}

/// Why there is no network.
#[derive(Debug, Error)]
pub enum TrainingError {
    /// Nothing to learn from.
    #[error("there is nothing to learn from: no trace has two events; check the reset activity")]
    NoSamples,
    /// The settings make no sense.
    #[error("{name} is {value}, and must be {expected}")]
    Setting {
        /// Which.
        name: &'static str,
        /// As given.
        value: String,
        /// What it can be.
        expected: &'static str,
    },
    /// The caller asked to stop.
    #[error("training was interrupted")]
    Interrupted,
    /// The library refused.
    #[error("training failed: {0}")]
    Library(#[from] candle_core::Error),
    /// Training ran away.
    #[error("training ran away: the weights are no numbers any more; take a smaller learning rate")]
    Diverged,
}

/// Samples as rows, and the class of each.
#[derive(Debug, Clone, Copy)]
pub struct Rows<'a> {
    /// Features, sample after sample.
    pub features: &'a [f32],
    /// Numbers per sample.
    pub width: usize,
    /// Class of each sample.
    pub classes: &'a [u32],
}

impl Rows<'_> {
    fn tensors(&self, samples: &[usize]) -> candle_core::Result<(Tensor, Tensor)> {
        let row = |&sample: &usize| &self.features[sample * self.width..][..self.width];
        let features: Vec<f32> = samples.iter().flat_map(row).copied().collect();
        let classes: Vec<u32> = samples.iter().map(|&sample| self.classes[sample]).collect();
        let shape = (samples.len(), self.width);
        Ok((
            Tensor::from_vec(features, shape, &Device::Cpu)?,
            Tensor::from_vec(classes, samples.len(), &Device::Cpu)?,
        ))
    }
}

/// Trains a network; `goes_on` is told every epoch and stops everything by `false`.
pub fn train(
    rows: Rows<'_>,
    held_out: Option<Rows<'_>>,
    class_count: usize,
    settings: &Settings,
    mut goes_on: impl FnMut(Epoch) -> bool,
) -> Result<Network, TrainingError> {
    check(settings)?;
    if rows.classes.is_empty() || rows.width == 0 {
        return Err(TrainingError::NoSamples);
    }
    let mut random = Random::new(settings.seed);
    let trained = Trained::new(rows.width, class_count, &mut random)?;
    let adam = ParamsAdamW { lr: settings.learning_rate, weight_decay: 0.0, ..Default::default() };
    let mut optimizer = AdamW::new(trained.variables(), adam)?;
    let mut order: Vec<usize> = (0..rows.classes.len()).collect();
    let mut best: Option<Best> = None;
    for number in 1..=settings.epochs {
        let mut sum = 0.0;
        random.shuffle(&mut order);
        for batch in order.chunks(settings.batch) {
            let (features, classes) = rows.tensors(batch)?;
            let loss = cross_entropy(&trained.forward(&features, Some(&mut random))?, &classes)?;
            optimizer.backward_step(&loss)?;
            sum += loss.to_scalar::<f32>()? * batch.len() as f32;
        }
        let held_out_loss = held_out.map(|rows| trained.loss(rows)).transpose()?;
        let epoch = Epoch { number, loss: sum / order.len() as f32, held_out_loss };
        if !goes_on(epoch) {
            return Err(TrainingError::Interrupted);
        }
        let (Some(loss), Some(patience)) = (held_out_loss, settings.patience) else { continue };
        match &best {
            Some(best) if loss >= best.loss => {
                if number - best.number >= patience {
                    break;
                }
            }
            _ => best = Some(Best { loss, number, network: trained.network()? }),
        }
    }
    best.map_or_else(|| trained.network(), |best| Ok(best.network))
}

fn check(settings: &Settings) -> Result<(), TrainingError> {
    let wrong =
        |name, value: String, expected| Err(TrainingError::Setting { name, value, expected });
    if settings.epochs == 0 {
        return wrong("epochs", "0".to_owned(), "at least 1");
    }
    if settings.batch == 0 {
        return wrong("batch", "0".to_owned(), "at least 1");
    }
    let rate = settings.learning_rate;
    if !(rate > 0.0 && rate <= 1.0) {
        return wrong("learning_rate", rate.to_string(), "above 0 and at most 1");
    }
    Ok(())
}

/// The best network seen so far.
struct Best {
    loss: f32,
    number: usize,
    network: Network,
}

/// Layers as candle's variables: weights of shape (inputs, outputs), and biases.
struct Trained {
    layers: Vec<(Var, Var)>,
}

impl Trained {
    /// Glorot's uniform weights, no bias: what the authors' library begins with.
    fn new(width: usize, classes: usize, random: &mut Random) -> candle_core::Result<Self> {
        let mut inputs = width;
        let mut layers = Vec::new();
        for outputs in Network::sizes(width, classes) {
            let limit = (6.0 / (inputs + outputs) as f32).sqrt();
            let weights: Vec<f32> =
                (0..inputs * outputs).map(|_| (2.0 * random.unit() - 1.0) * limit).collect();
            let weights = Tensor::from_vec(weights, (inputs, outputs), &Device::Cpu)?;
            let bias = Tensor::from_vec(vec![0f32; outputs], outputs, &Device::Cpu)?;
            layers.push((Var::from_tensor(&weights)?, Var::from_tensor(&bias)?));
            inputs = outputs;
        }
        Ok(Self { layers })
    }

    fn variables(&self) -> Vec<Var> {
        self.layers.iter().flat_map(|(weights, bias)| [weights.clone(), bias.clone()]).collect()
    }

    /// Logits; with dropout where random numbers are given.
    fn forward(
        &self,
        features: &Tensor,
        mut random: Option<&mut Random>,
    ) -> candle_core::Result<Tensor> {
        let mut values = features.clone();
        for (index, (weights, bias)) in self.layers.iter().enumerate() {
            values = values.matmul(weights)?.broadcast_add(bias)?;
            if index + 1 < self.layers.len() {
                values = values.relu()?;
                if let Some(random) = random.as_deref_mut() {
                    values = (&values * mask(values.dims2()?, random)?)?;
                }
            }
        }
        Ok(values)
    }

    fn loss(&self, rows: Rows<'_>) -> candle_core::Result<f32> {
        let all: Vec<usize> = (0..rows.classes.len()).collect();
        let (features, classes) = rows.tensors(&all)?;
        cross_entropy(&self.forward(&features, None)?, &classes)?.to_scalar()
    }

    fn network(&self) -> Result<Network, TrainingError> {
        let mut layers = Vec::new();
        for (weights, bias) in &self.layers {
            let (inputs, outputs) = weights.dims2()?;
            let (weights, bias) = (weights.flatten_all()?.to_vec1()?, bias.to_vec1()?);
            layers.extend(Layer::new(inputs, outputs, weights, bias));
        }
        let sound = layers.iter().all(|layer| layer.weights.iter().all(|w| w.is_finite()));
        Network::new(layers).filter(|_| sound).ok_or(TrainingError::Diverged)
    }
}

/// 0 for units that rest, and 1 / (1 − share) for the others: sums keep their size.
fn mask((rows, units): (usize, usize), random: &mut Random) -> candle_core::Result<Tensor> {
    let keep = 1.0 / (1.0 - DROPOUT);
    let mask: Vec<f32> =
        (0..rows * units).map(|_| if random.unit() < DROPOUT { 0.0 } else { keep }).collect();
    Tensor::from_vec(mask, (rows, units), &Device::Cpu)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What candle computes in training is what the engine computes when asked.
    #[test]
    fn the_engine_runs_the_network_candle_trained() -> Result<(), TrainingError> {
        let trained = Trained::new(24, 4, &mut Random::new(3))?;
        let features: Vec<f32> = (0..24).map(|at| (at * 7 % 24) as f32 / 23.0).collect();
        let input = Tensor::from_slice(&features, (1, 24), &Device::Cpu)?;
        let logits = trained.forward(&input, None)?;
        let wanted = candle_nn::ops::softmax(&logits, candle_core::D::Minus1)?
            .flatten_all()?
            .to_vec1::<f32>()?;
        let mut network = trained.network()?;
        let given = network.probabilities(&features);
        assert!(given.iter().zip(&wanted).all(|(is, wanted)| (is - wanted).abs() < 1e-6));
        assert!(wanted.iter().any(|&p| (p - 0.25).abs() > 1e-3), "nothing to tell apart");
        Ok(())
    }
}
