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
const FOR_TRANSITIONS: f64 = 0.3;
const FOR_TIMES: f64 = 0.5;
const FOR_SHARES: f64 = 0.1;
const FOR_AVERAGES: f64 = 0.1;

/// Probability at which each kind of alarm is affordable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Budget {
    /// Per transition, for unknown ones.
    pub per_transition: f64,
    /// Per transition, for odd times.
    pub per_time: f64,
    /// Per state or transition whose shares a periodic check compares.
    pub per_share: f64,
    /// Per average time it compares.
    pub per_average: f64,
}

impl Budget {
    /// Splits the user's budget at the rates seen while learning.
    pub fn of(parameters: &Parameters, learned: &Learned, rules: &[Rule], chains: &Chains) -> Self {
        let days = (learned.duration as f64 / SECOND as f64 / DAY_S).max(1.0 / DAY_S);
        let transitions = rules.iter().map(|rule| u64::from(rule.count)).sum::<u64>() as f64 / days;
        let checks = Comparisons::while_learning(learned, rules, chains);
        let per_day = |cycles: f64| cycles / f64::from(parameters.check_every) / days;
        let alarms = parameters.false_alarms_per_day;
        let share = |of: f64, events: f64| (of * alarms / events.max(1.0)).min(0.05);
        Self {
            per_transition: share(FOR_TRANSITIONS, transitions),
            per_time: share(FOR_TIMES, transitions),
            per_share: share(FOR_SHARES, per_day(checks.shares)),
            per_average: share(FOR_AVERAGES, per_day(checks.averages)),
        }
    }
}

/// Comparisons that checking after every group cycle would have made while learning.
struct Comparisons {
    shares: f64,
    averages: f64,
}

impl Comparisons {
    fn while_learning(learned: &Learned, rules: &[Rule], chains: &Chains) -> Self {
        let mut cycles = vec![0u64; learned.group_start.len()];
        let mut shares = vec![0usize; learned.group_start.len()];
        let mut averages = vec![0usize; learned.group_start.len()];
        for rule in rules {
            let group = chains.group_of(rule.chain);
            let starts = rule.next == learned.group_start[group];
            if chains.kind(rule.chain) == ChainKind::Group && starts {
                cycles[group] += u64::from(rule.count);
            }
            let branches = rule.evidence() > 0 && rule.probability < 0.95;
            shares[group] += usize::from(branches) + usize::from(rule.judged().len() > 1);
            averages[group] += rule.judged().len();
        }
        let sum = |compared: Vec<usize>| {
            cycles.iter().zip(compared).map(|(&cycles, n)| cycles as f64 * n as f64).sum()
        };
        Self { shares: sum(shares), averages: sum(averages) }
    }
}
