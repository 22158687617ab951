//! The user's budget of false alarms, split over what can cause one.
//!
//! A budget of one alarm a day, on a machine with so many transitions a day, is a probability per
//! transition: an alarm is raised where a healthy machine would do the same no more often.

use crate::log::SECOND;

use super::chains::{ChainKind, Chains};
use super::model::Learned;
use super::parameters::Parameters;
use super::rules::Rule;

const DAY_S: f64 = 86_400.0;
/// Shares of the budget.
const FOR_TRANSITIONS: f64 = 0.5;
const FOR_TIMES: f64 = 0.3;
const FOR_CHECKS: f64 = 0.2;

/// Probability at which each kind of alarm is affordable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Budget {
    /// Per transition, for unknown ones.
    pub per_transition: f64,
    /// Per transition, for odd times.
    pub per_time: f64,
    /// Per share or average compared in a periodic check.
    pub per_check: f64,
}

impl Budget {
    /// Splits the user's budget at the rates seen while learning.
    pub fn of(parameters: &Parameters, learned: &Learned, rules: &[Rule], chains: &Chains) -> Self {
        let days = (learned.duration as f64 / SECOND as f64 / DAY_S).max(1.0 / DAY_S);
        let transitions = rules.iter().map(|rule| rule.count).sum::<u64>() as f64 / days;
        let checks = checks(learned, rules, chains) / f64::from(parameters.check_every) / days;
        let alarms = parameters.false_alarms_per_day;
        let share = |of: f64, events: f64| (of * alarms / events.max(1.0)).min(0.05);
        Self {
            per_transition: share(FOR_TRANSITIONS, transitions),
            per_time: share(FOR_TIMES, transitions),
            per_check: share(FOR_CHECKS, checks),
        }
    }
}

/// Comparisons that checking after every group cycle would have made while learning.
fn checks(learned: &Learned, rules: &[Rule], chains: &Chains) -> f64 {
    let mut cycles = vec![0u64; learned.group_start.len()];
    let mut compared = vec![0usize; learned.group_start.len()];
    for rule in rules {
        let group = chains.group_of(rule.chain);
        compared[group] += 1 + usize::from(rule.probability < 1.0) + rule.clusters.len() / 2;
        if chains.kind(rule.chain) == ChainKind::Group && rule.next == learned.group_start[group] {
            cycles[group] += rule.count;
        }
    }
    cycles.iter().zip(compared).map(|(&cycles, compared)| cycles as f64 * compared as f64).sum()
}
