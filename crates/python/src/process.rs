//! Process mining: event logs and Petri nets.

pub mod event_log;
pub mod mining;
pub mod next_activity;
pub mod next_monitor;
pub mod petri_net;
