//! Process mining of I/O logs (Theis 2019): event logs of a machine's runs, the Petri net they
//! follow, and what comes next in it.

pub mod baseline;
pub mod decay;
pub mod drawing;
pub mod event_log;
pub mod fitness;
pub mod language;
pub mod lesson;
pub mod network;
pub mod next_activity;
pub mod petri;
pub mod precision;
pub mod replay;
pub mod reset;
pub mod silent;
pub mod slicing;
pub mod soundness;
pub mod split_miner;
pub mod succession;
pub mod watching;
