//! Process mining: event logs and Petri nets.

pub mod event_log;
pub mod petri_net;
