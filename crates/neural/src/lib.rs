//! Trains the network that foretells a machine's next activity (Theis & Darabi 2019, DREAM-NAP).
//!
//! The only crate that knows a library of neural networks: whoever asks a trained network does so
//! through the engine.

pub mod learn;
mod random;
pub mod training;
