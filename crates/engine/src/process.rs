//! Process mining of I/O logs (Theis 2019): event logs of a machine's runs, the Petri net they
//! follow, and what comes next in it.

pub mod event_log;
pub mod petri;
pub mod reset;
pub mod slicing;
