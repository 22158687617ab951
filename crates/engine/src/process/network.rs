//! A small network of fully connected layers, run forwards.
//!
//! Sums are taken in one order, so that every machine gives the same probabilities, bit for bit.

/// One fully connected layer.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// Numbers it takes.
    pub inputs: usize,
    /// Numbers it gives.
    pub outputs: usize,
    /// `weights[input * outputs + output]`.
    pub weights: Vec<f32>,
    /// One per output.
    pub bias: Vec<f32>,
}

impl Layer {
    /// `None` where the numbers of weights and of biases do not fit the layer's size.
    pub fn new(inputs: usize, outputs: usize, weights: Vec<f32>, bias: Vec<f32>) -> Option<Self> {
        let fits = Some(weights.len()) == inputs.checked_mul(outputs) && bias.len() == outputs;
        fits.then_some(Self { inputs, outputs, weights, bias })
    }

    fn forward(&self, from: &[f32], into: &mut [f32]) {
        into.copy_from_slice(&self.bias);
        if self.outputs == 0 {
            return;
        }
        for (&value, weights) in from.iter().zip(self.weights.chunks_exact(self.outputs)) {
            // Half of the units of a layer behind a ReLU are at rest.
            if value != 0.0 {
                for (sum, &weight) in into.iter_mut().zip(weights) {
                    *sum += value * weight;
                }
            }
        }
    }
}

/// Layers with a ReLU after each but the last, a softmax after that.
#[derive(Debug, Clone)]
pub struct Network {
    layers: Vec<Layer>,
    /// What each layer gave last.
    given: Vec<Vec<f32>>,
}

impl Network {
    /// `None` where there is no layer, or one does not take what the one before gives.
    pub fn new(layers: Vec<Layer>) -> Option<Self> {
        let chained = layers.windows(2).all(|pair| pair[0].outputs == pair[1].inputs);
        let given = layers.iter().map(|layer| vec![0.0; layer.outputs]).collect();
        (chained && !layers.is_empty()).then_some(Self { layers, given })
    }

    /// Units of each layer of Theis & Darabi 2019 over `features`: n, ⌊1.2n⌋, ⌊0.6n⌋, ⌊0.3n⌋, and
    /// one per class.
    pub fn sizes(features: usize, classes: usize) -> [usize; 5] {
        // In tenths, so that no rounding of a fraction decides.
        [features, features * 12 / 10, features * 6 / 10, features * 3 / 10, classes]
            .map(|units| units.max(1))
    }

    /// The layers, first to last.
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// Numbers the first layer takes.
    pub fn inputs(&self) -> usize {
        self.layers.first().map_or(0, |layer| layer.inputs)
    }

    /// Classes the last layer tells apart.
    pub fn outputs(&self) -> usize {
        self.layers.last().map_or(0, |layer| layer.outputs)
    }

    /// The probability of each class. `features` holds [`Self::inputs`] numbers.
    pub fn probabilities(&mut self, features: &[f32]) -> &[f32] {
        let last = self.layers.len() - 1;
        for (index, layer) in self.layers.iter().enumerate() {
            let (before, rest) = self.given.split_at_mut(index);
            let from = before.last().map_or(features, Vec::as_slice);
            layer.forward(from, &mut rest[0]);
            if index < last {
                for value in &mut rest[0] {
                    *value = value.max(0.0);
                }
            }
        }
        softmax(&mut self.given[last]);
        &self.given[last]
    }
}

fn softmax(values: &mut [f32]) {
    let largest = values.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let mut sum = 0.0;
    for value in values.iter_mut() {
        *value = libm::expf(*value - largest);
        sum += *value;
    }
    for value in values {
        *value /= sum;
    }
}
