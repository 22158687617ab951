//! Rules as the periodic checks come to them: most of what was seen of most rules is told to be
//! steady by a glance at their lanes, without a look into the model, which lies far away.

use crate::log::SECOND;
use crate::signal_state::model::NominalModel;
use crate::signal_state::rules::row_of;

use super::counted::Seen;

/// The rules of a group, as their lanes lie: what was counted is read from one end to the other.
#[derive(Debug, Clone, Default)]
pub struct Checks {
    rules: Vec<Checked>,
    /// The times of all of them, in their order.
    times: Vec<Time>,
    /// The rules that leave a state, where those are several; state after state.
    rows: Vec<Leaving>,
    /// A share that differs by no more from the learned one is steady.
    steady_share: f32,
}

/// One rule as the periodic checks come to it.
#[derive(Debug, Clone, Copy)]
pub struct Checked {
    rule: u32,
    pub(super) lane: u32,
    /// Where its times begin, and how many those are; none where they mean nothing.
    first_time: u32,
    times: u32,
    /// Where the rules begin that leave its state, and how many those are; none but at the first of
    /// several to have been seen.
    first_of_row: u32,
    row: u32,
}

/// One of several rules that leave a state.
#[derive(Debug, Clone, Copy)]
pub(super) struct Leaving {
    pub(super) lane: u32,
    /// Its share of what leaves the state.
    share: f32,
}

/// One of a rule's times, in seconds.
#[derive(Debug, Clone, Copy)]
struct Time {
    average_s: f32,
    /// An average that differs from it by no more is steady; none is where this is below zero.
    steady_s: f32,
    /// Its share of the rule.
    share: f32,
}

/// A glance is sure of a share, and of an average, relatively, where it differs by so much less
/// than what would matter: more than single precision takes from it.
const SURE: f64 = 1e-5;

impl Checked {
    /// The rule.
    pub fn rule(&self) -> usize {
        self.rule as usize
    }
}

impl Checks {
    /// The rules.
    pub fn rules(&self) -> &[Checked] {
        &self.rules
    }

    /// The rules among which one is the first of several out of their state; none where it is not.
    pub(super) fn row(&self, of: &Checked) -> &[Leaving] {
        &self.rows[of.first_of_row as usize..][..of.row as usize]
    }

    /// True where the shares of the rules out of a state are steady beyond doubt, `of` being the
    /// first of several; `count` says by lane how often one was taken.
    pub(super) fn are_steady_shares(&self, of: &Checked, count: impl Fn(usize) -> u32) -> bool {
        let row = || self.row(of).iter().map(|other| (other.share, count(other.lane as usize)));
        let total: u32 = row().map(|(_, count)| count).sum();
        row().all(|(share, count)| self.is_steady(share, count, total))
    }

    /// True where what was seen of a rule's times is steady beyond doubt.
    pub(super) fn are_steady_times(
        &self,
        of: &Checked,
        seen: impl Iterator<Item = Seen> + Clone,
    ) -> bool {
        let times = &self.times[of.first_time as usize..][..of.times as usize];
        let total: u32 =
            if times.len() > 1 { seen.clone().map(|seen| seen.count).sum() } else { 0 };
        times.iter().zip(seen).all(|(time, Seen { sum, count })| {
            let sum_s = (sum as f64 / SECOND as f64) as f32;
            let change_s = (sum_s - time.average_s * count as f32).abs();
            (count == 0 || change_s <= time.steady_s * count as f32)
                && self.is_steady(time.share, count, total)
        })
    }

    /// True where so many of all are a share that is steady beyond doubt; any is, of none.
    fn is_steady(&self, share: f32, count: u32, total: u32) -> bool {
        total == 0
            || (count as f32 - share * total as f32).abs() <= self.steady_share * total as f32
    }
}

/// The rules of each group, whose lanes are given.
pub(super) fn of_groups(model: &NominalModel, lane_of: &[u32]) -> Vec<Checks> {
    let steady_share = (model.parameters.significant_change - SURE) as f32;
    let mut groups = vec![Checks { steady_share, ..Checks::default() }; model.plant.groups.len()];
    let mut as_they_lie: Vec<usize> = (0..model.rules.len()).collect();
    as_they_lie.sort_unstable_by_key(|&rule| lane_of[rule]);
    for index in as_they_lie {
        let rule = &model.rules[index];
        let Checks { rules, times, rows, .. } = &mut groups[model.chains.group_of(rule.chain)];
        let kind = model.kind(rule.chain);
        let row = model.table.row(row_of(rule.current, kind));
        let first = row.clone().min_by_key(|&other| model.rules[other].sequence);
        let row = if row.len() > 1 && first == Some(index) { row } else { 0..0 };
        let judged = if model.times(kind) { rule.judged() } else { &[] };
        rules.push(Checked {
            rule: index as u32,
            lane: lane_of[index],
            first_time: times.len() as u32,
            times: judged.len() as u32,
            first_of_row: rows.len() as u32,
            row: row.len() as u32,
        });
        rows.extend(row.map(|other| Leaving {
            lane: lane_of[other],
            share: model.rules[other].probability as f32,
        }));
        times.extend(judged.iter().map(|cluster| {
            let sure = model.significant_change_s(cluster) - SURE * cluster.average_s;
            Time {
                average_s: cluster.average_s as f32,
                steady_s: if sure > 0.0 { sure as f32 } else { -1.0 },
                share: cluster.probability as f32,
            }
        }));
    }
    for Checks { rules, times, rows, .. } in &mut groups {
        rules.shrink_to_fit();
        times.shrink_to_fit();
        rows.shrink_to_fit();
    }
    groups
}
