//! Rules as the periodic checks come to them: most of what was seen of most rules is told to be
//! steady by a glance at their lanes, without a look into the model.

use crate::log::SECOND;
use crate::signal_state::model::NominalModel;
use crate::signal_state::rules::row_of;

use super::Lane;

/// One rule as the periodic checks come to it.
#[derive(Debug, Clone, Copy)]
pub struct Checked {
    /// Twice its number, and one more where it is the first of several out of its state.
    rule: u32,
    /// Its average time, in seconds.
    average_s: f32,
    /// An average that differs from it by no more is steady, and with it the rule; below zero where
    /// there is more to it.
    steady_s: f32,
}

/// A glance is sure of an average where it differs by so much less, relatively, than what would
/// matter: more than single precision takes from it.
const SURE: f64 = 1e-5;

impl Checked {
    /// The rule.
    pub fn rule(self) -> usize {
        self.rule as usize / 2
    }

    /// True where it is the first of several out of its state.
    pub fn branches(self) -> bool {
        self.rule % 2 == 1
    }

    /// True where a glance never tells whether it is steady.
    pub fn is_intricate(self) -> bool {
        self.steady_s < 0.0
    }

    /// True where what its lane has seen is steady beyond doubt.
    pub(super) fn is_steady(self, lane: &Lane) -> bool {
        let seen = lane.seen[0] as f32;
        let sum_s = (lane.sum[0] as f64 / SECOND as f64) as f32;
        let change_s = (sum_s - self.average_s * seen).abs();
        !self.is_intricate() && change_s <= self.steady_s * seen
    }
}

/// The rules of each group, in the model's order.
pub(super) fn of_groups(model: &NominalModel) -> Vec<Vec<Checked>> {
    let mut groups: Vec<Vec<Checked>> = vec![Vec::new(); model.plant.groups.len()];
    for (index, rule) in model.rules.iter().enumerate() {
        let row = model.table.row(row_of(rule.current, model.kind(rule.chain)));
        let first = row.clone().min_by_key(|&other| model.rules[other].sequence);
        let branches = row.len() > 1 && first == Some(index);
        let (average_s, steady_s) = if branches { (0.0, -1.0) } else { steady(model, index) };
        groups[model.chains.group_of(rule.chain)].push(Checked {
            rule: 2 * index as u32 + u32::from(branches),
            average_s,
            steady_s,
        });
    }
    groups.iter_mut().for_each(Vec::shrink_to_fit);
    groups
}

/// The average time of a rule that is no first of several, and by how much it may differ.
fn steady(model: &NominalModel, rule: usize) -> (f32, f32) {
    let rule = &model.rules[rule];
    match rule.judged() {
        [] => (0.0, f32::MAX),
        _ if !model.times(model.kind(rule.chain)) => (0.0, f32::MAX),
        [only] => {
            let sure = model.significant_change_s(only) - SURE * only.average_s;
            (only.average_s as f32, if sure > 0.0 { sure as f32 } else { -1.0 })
        }
        _ => (0.0, -1.0),
    }
}
