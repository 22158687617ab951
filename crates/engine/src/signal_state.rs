//! Signal-state models (Ghosh 2016): per device and group a Markov chain of signal-states with
//! clustered transition times, learned from logs and watched in real time.

pub mod budget;
pub mod chains;
pub mod check;
pub mod confirm;
pub mod dispersion;
pub mod dot;
pub mod enabling;
pub mod events;
pub mod evidence;
pub mod found;
pub mod identity;
pub mod incident;
pub mod lanes;
pub mod learn;
pub mod leaving;
pub mod message;
pub mod model;
pub mod monitor;
pub mod oddity;
pub mod order;
pub mod parameters;
pub mod part;
pub mod rules;
pub mod shares;
pub mod sisters;
pub mod snapshot;
pub mod states;
pub mod teller;
pub mod telling;
pub mod ways;
