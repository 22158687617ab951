//! The runglight engine: learns how a PLC-controlled machine normally behaves from its inputs and
//! outputs, and finds what departs from it.
//!
//! Pure computation on columns: no Python, no sockets, no files of its own accord.

pub mod bits;
pub mod control;
pub mod cycle;
pub mod finding;
pub mod identify;
pub mod joint;
pub mod log;
pub mod naming;
pub mod plant;
pub mod plant_part;
pub mod process;
mod saved_state;
pub mod signal_state;
pub mod stem;
pub mod symbol_index;
pub mod symbols;
pub mod timing;
pub mod timing_diagram;
