//! The learned controller (Theis 2019, section V-B and Algorithm 2): a Petri net mined from a PLC's
//! inputs and outputs takes the place of its program, or runs beside it and tells where the two
//! disagree.
//!
//! At every scan: wait where only inputs are enabled (rule 1), set the output where it is the only
//! thing enabled (rule 2), decide otherwise (rule 3), by learned guards or by whoever [`Decide`]s.

pub mod controller;
pub mod counters;
pub mod decide;
pub mod error;
pub mod follower;
pub mod guards;
pub mod learn;
pub mod message;
pub mod moves;
pub mod network;
pub mod program;
pub mod shadow;
pub mod situations;
pub mod structured_text;
pub mod tree;
