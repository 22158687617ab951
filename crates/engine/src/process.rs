//! Process mining of I/O logs (Theis 2019): event logs of a machine's runs, the Petri net they
//! follow, and what comes next in it.

pub mod drawing;
pub mod event_log;
pub mod fitness;
pub mod language;
pub mod petri;
pub mod precision;
pub mod replay;
pub mod reset;
pub mod silent;
pub mod slicing;
pub mod soundness;
pub mod split_miner;
