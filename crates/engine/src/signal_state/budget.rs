//! The user's budget of false alarms, split over what can cause one.
//!
//! A budget of one alarm a day, on a machine with so many transitions a day, pays for what a
//! healthy machine hardly ever does. It is spent on the surest first: of all that may be told of a
//! transition, the least probable on a healthy machine, then the next, until what a healthy machine
//! would do of all this adds up to the budget.

use crate::log::SECOND;

use super::chains::{ChainKind, Chains};
use super::evidence::Evidence;
use super::model::Learned;
use super::parameters::Parameters;
use super::rules::{Rule, RuleTable};
use super::shares::FirstSeenByCount;
use super::sisters::Names;

const DAY_S: f64 = 86_400.0;
/// Shares of the budget.
const FOR_TRANSITIONS: f64 = 0.3;
const FOR_ODD_TIMES: f64 = 0.25;
const FOR_TAILS: f64 = 0.25;
const FOR_SHARES: f64 = 0.1;
const FOR_AVERAGES: f64 = 0.1;

/// Nothing more probable than this is ever an alarm.
const MOST: f64 = 0.05;

/// Probability at which each kind of alarm is affordable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Budget {
    /// Most probable unknown transition that is an alarm.
    pub per_transition: f64,
    /// Most probable odd time that is an alarm.
    pub per_time: f64,
    /// Per transition, for the tails of its usual times.
    pub per_tail: f64,
    /// Per state or transition whose shares a periodic check compares.
    pub per_share: f64,
    /// Per average time it compares.
    pub per_average: f64,
}

impl Budget {
    /// Splits the user's budget at the rates seen while learning.
    pub fn of(
        parameters: &Parameters,
        learned: &Learned,
        rules: &[Rule],
        table: &RuleTable,
        names: Names<'_>,
        evidence: &Evidence,
    ) -> Self {
        let chains = names.chains;
        let days = (learned.duration as f64 / SECOND as f64 / DAY_S).max(1.0 / DAY_S);
        let transitions = rules.iter().map(|rule| u64::from(rule.count)).sum::<u64>() as f64 / days;
        let checks = Comparisons::while_learning(learned, rules, chains);
        let per_day = |cycles: f64| cycles / f64::from(parameters.check_every) / days;
        let alarms = parameters.false_alarms_per_day;
        let share = |of: f64, events: f64| (of * alarms / events.max(1.0)).min(MOST);
        let surest = |of: f64, chances: Vec<Chance>| {
            surest_first(chances, of * alarms).max(share(of, transitions)).min(MOST)
        };
        let a_day = |count: u64| count as f64 / days;
        let leaving = table.rows().filter(|row| !row.is_empty()).flat_map(|row| {
            let (chain, state) = (rules[row.start].chain, rules[row.start].current);
            let a_day = a_day(rules[row].iter().map(|rule| u64::from(rule.count)).sum());
            let [to_device, to_sisters] =
                evidence.unknown_transitions(rules, table, names, (chain, state));
            let chance = |probability| Chance { probability, a_day };
            // Of what is new to a device, its sisters may know some.
            let rarer = (to_sisters < to_device).then(|| chance(to_sisters));
            rarer.into_iter().chain([chance(to_device)])
        });
        // What a group's chain takes says nothing that its devices' do not.
        let timed = rules.iter().filter(|rule| chains.kind(rule.chain) == ChainKind::Device);
        let mut first = FirstSeenByCount::default();
        let taking = timed.map(|rule| Chance {
            probability: evidence.any_odd_time(rule, names, &mut first),
            a_day: a_day(rule.count.into()),
        });
        Self {
            per_transition: surest(FOR_TRANSITIONS, leaving.collect()),
            per_time: surest(FOR_ODD_TIMES, taking.collect()),
            per_tail: share(FOR_TAILS, transitions),
            per_share: share(FOR_SHARES, per_day(checks.shares)),
            per_average: share(FOR_AVERAGES, per_day(checks.averages)),
        }
    }
}

/// Something a healthy machine may do: with what probability, each of so many times a day.
struct Chance {
    probability: f64,
    a_day: f64,
}

/// Probabilities no farther apart than this share are equal: they differ by rounding.
const EQUAL: f64 = 1e-9;

/// The highest probability up to which all chances together come true no more than `most_a_day`.
fn surest_first(mut chances: Vec<Chance>, most_a_day: f64) -> f64 {
    chances.sort_by(|a, b| a.probability.total_cmp(&b.probability));
    let mut spent = 0.0;
    let mut highest = 0.0;
    for equal in chances.chunk_by(|a, b| b.probability <= a.probability * (1.0 + EQUAL)) {
        // Equals are told alike: a budget that pays for the least of them pays for all.
        let costs = || equal.iter().map(|chance| chance.probability * chance.a_day);
        if spent + costs().fold(f64::INFINITY, f64::min) > most_a_day {
            break;
        }
        spent += costs().sum::<f64>();
        highest = equal[equal.len() - 1].probability * (1.0 + EQUAL);
    }
    highest
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
