//! Trains the network that foretells a machine's next activity (Theis & Darabi 2019, DREAM-NAP).
//!
//! Training alone: whoever asks a trained network does so through the engine.

mod dense;
pub mod learn;
mod random;
pub mod training;
