//! Training: Adam on mean cross entropy, over shuffled batches.
//!
//! Weights, order of samples and dropout come from one seeded generator, and all sums are taken in
//! one order: the same seed gives the same network on every machine.

use thiserror::Error;

use runglight_engine::process::network::Network;

use crate::dense::Dense;
use crate::random::Random;

/// How training goes.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
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
    fn row(&self, sample: usize) -> &[f32] {
        &self.features[sample * self.width..][..self.width]
    }
}

/// Trains a network; `goes_on` is told every epoch and stops everything by `false`.
///
/// # Errors
/// Nothing to learn from, settings that make no sense, or `goes_on` said `false`.
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
    let mut dense = Dense::new(rows.width, class_count, &mut random);
    let mut order: Vec<usize> = (0..rows.classes.len()).collect();
    let mut best: Option<Best> = None;
    for number in 1..=settings.epochs {
        let mut sum = 0.0;
        random.shuffle(&mut order);
        for batch in order.chunks(settings.batch) {
            let samples = batch.iter().map(|&sample| (rows.row(sample), rows.classes[sample]));
            sum += dense.learn(samples, &mut random) * batch.len() as f32;
            dense.step(settings.learning_rate as f32);
        }
        let held_out_loss = held_out.map(|rows| loss(&dense, rows)).transpose()?;
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
            _ => best = Some(Best { loss, number, network: network(&dense)? }),
        }
    }
    best.map_or_else(|| network(&dense), |best| Ok(best.network))
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

/// The network as it is asked later; refused where the numbers ran away.
fn network(dense: &Dense) -> Result<Network, TrainingError> {
    dense.network().ok_or(TrainingError::Diverged)
}

/// Mean cross entropy without dropout.
fn loss(dense: &Dense, rows: Rows<'_>) -> Result<f32, TrainingError> {
    let mut network = network(dense)?;
    let mut sum = 0.0;
    for (sample, &class) in rows.classes.iter().enumerate() {
        let probability = network.probabilities(rows.row(sample))[class as usize];
        sum -= libm::logf(probability.max(f32::MIN_POSITIVE));
    }
    Ok(sum / rows.classes.len().max(1) as f32)
}
