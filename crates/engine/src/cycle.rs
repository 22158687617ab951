//! The cycle machine (Guim & Dias 2023): regions of bits watched as words, the sequences of words
//! between two edges of the work-complete bit, and the weighted automaton they make.
//!
//! The engine follows the paper to the letter in mode `word`; mode `element` goes past the
//! weaknesses the paper lists itself (section 5).

pub mod address;
pub mod auto;
pub mod dot;
pub mod image;
pub mod lanes;
pub mod learn;
pub mod localise;
pub mod machine;
pub mod message;
pub mod model;
pub mod monitor;
pub mod order;
pub mod parameters;
pub mod rate;
pub mod regions;
pub mod sequences;
pub mod stops;
pub mod witnesses;
