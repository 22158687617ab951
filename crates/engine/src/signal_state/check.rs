//! The three periodic checks (Ghosh 2016, section 2.6): transition probabilities, transition time
//! probabilities and average transition times, held against the model every so many group cycles,
//! in the order of the complete transition sequence, since what comes first has an effect on what
//! follows.
//!
//! `plat` reports every change beyond the significant one. `adaptive` also asks whether chance
//! explains it: the standardised difference, with the dispersion learned for that very share or
//! mean, must be as rare as the budget demands.

use prefetch_index::prefetch_index;

use crate::finding::Kind;
use crate::log::SECOND;
use crate::timing::TimeCluster;
use crate::timing::limits::BODY_INSTANCES;

use super::chains::ChainKind;
use super::lanes::{Checked, Lanes, Seen};
use super::model::NominalModel;
use super::parameters::Timing;
use super::rules::row_of;

/// One share or average that has changed.
#[derive(Debug, Clone, PartialEq)]
pub struct Departure {
    /// Which check.
    pub kind: Kind,
    /// The rule it is about.
    pub rule: usize,
    /// Observed share, or average in seconds.
    pub observed: f64,
    /// Learned share, or average in seconds.
    pub learned: f64,
    /// Observed shares of all branches or clusters, in the model's order; empty for averages.
    pub observed_shares: Vec<f64>,
    /// The learned shares beside them.
    pub learned_shares: Vec<f64>,
}

/// Fewer observations than this in a window prove nothing in `adaptive`.
const OBSERVATIONS_AT_LEAST: u32 = 5;

/// How many rules before its turn what a rule needs is fetched, and what is found through that:
/// seldom asked for, it is out of the processor's sight.
const FAR: usize = 16;
const NEAR: usize = 8;

/// What a glance does not show to be steady.
struct Suspect {
    rule: usize,
    shares: bool,
    times: bool,
}

/// All departures of a group, causes first.
pub fn departures(model: &NominalModel, group: usize, lanes: &Lanes) -> Vec<Departure> {
    let suspects = suspects(group, lanes);
    let mut found: Vec<(u32, Departure)> = Vec::new();
    for (place, &Suspect { rule, shares, times }) in suspects.iter().enumerate() {
        fetch(model, &suspects[place..]);
        let of_shares = shares.then(|| branch(model, rule, lanes)).flatten();
        let several = times.then(|| several_times(model, rule, lanes)).flatten();
        let average = times.then(|| average(model, rule, lanes)).flatten();
        let of_rule = [of_shares, several, average].into_iter().flatten();
        found.extend(of_rule.map(|departure| (model.rules[rule].sequence, departure)));
    }
    found.sort_by_key(|(sequence, _)| *sequence);
    found.into_iter().map(|(_, departure)| departure).collect()
}

/// The rules of a group that are worth more than a glance, as what was counted of them lies.
fn suspects(group: usize, lanes: &Lanes) -> Vec<Suspect> {
    let checks = lanes.checks(group);
    let suspect = |(place, checked): (usize, &Checked)| {
        if let Some(far) = checks.rules().get(place + FAR) {
            lanes.fetch_row(checks, far);
            lanes.fetch_further(far);
        }
        let shares = !lanes.are_steady_shares(checks, checked);
        let times = !lanes.are_steady_times(checks, checked);
        (shares || times).then(|| Suspect { rule: checked.rule(), shares, times })
    };
    checks.rules().iter().enumerate().filter_map(suspect).collect()
}

/// Fetches what suspects yet to come need.
fn fetch(model: &NominalModel, to_come: &[Suspect]) {
    if let Some(far) = to_come.get(FAR) {
        // A rule lies in two lines of memory or three.
        prefetch_index(&model.rules, far.rule);
        prefetch_index(&model.rules, far.rule + 1);
    }
    if let Some(near) = to_come.get(NEAR) {
        prefetch_index(model.rules[near.rule].judged(), 0);
    }
}

/// The branches out of a state, asked once, at the first of them.
fn branch(model: &NominalModel, rule: usize, lanes: &Lanes) -> Option<Departure> {
    let kind: ChainKind = model.chains.kind(model.rules[rule].chain);
    let row = model.table.row(row_of(model.rules[rule].current, kind));
    let total: u32 = row.clone().map(|r| lanes.count(r)).sum();
    if total == 0 {
        return None;
    }
    let learned_total: u64 = row.clone().map(|r| u64::from(model.rules[r].count)).sum();
    let share = |r: usize| f64::from(lanes.count(r)) / f64::from(total);
    let changed = row
        .clone()
        .filter(|&r| {
            let learned = &model.rules[r];
            let dispersion = || model.judgement().evidence.dispersion(learned);
            let (observed, learned) =
                ((lanes.count(r), total), (learned.probability, learned_total));
            share_changed(model, observed, learned, dispersion)
        })
        .max_by(|&a, &b| {
            let change = |r: usize| (share(r) - model.rules[r].probability).abs();
            change(a).total_cmp(&change(b))
        })?;
    Some(Departure {
        kind: Kind::TransitionProbability,
        rule: changed,
        observed: share(changed),
        learned: model.rules[changed].probability,
        observed_shares: row.clone().map(share).collect(),
        learned_shares: row.map(|r| model.rules[r].probability).collect(),
    })
}

/// The several times of one transition.
fn several_times(model: &NominalModel, rule: usize, lanes: &Lanes) -> Option<Departure> {
    let clusters = model.rules[rule].judged();
    if clusters.len() < 2 {
        return None;
    }
    let total: u32 = lanes.seen(rule).map(|seen| seen.count).sum();
    if total == 0 {
        return None;
    }
    let changed = clusters.iter().zip(lanes.seen(rule)).any(|(cluster, seen)| {
        let learned = (cluster.probability, u64::from(model.rules[rule].count));
        share_changed(model, (seen.count, total), learned, || cluster.dispersion.into())
    });
    changed.then(|| {
        let share = |seen: Seen| f64::from(seen.count) / f64::from(total);
        let observed_shares: Vec<f64> = lanes.seen(rule).map(share).collect();
        Departure {
            kind: Kind::TimeProbability,
            rule,
            observed: observed_shares[0],
            learned: clusters[0].probability,
            observed_shares,
            learned_shares: clusters.iter().map(|c| c.probability).collect(),
        }
    })
}

fn average(model: &NominalModel, rule: usize, lanes: &Lanes) -> Option<Departure> {
    model.rules[rule].judged().iter().zip(lanes.seen(rule)).find_map(|(cluster, seen)| {
        let count = seen.count;
        if count == 0 {
            return None;
        }
        let observed = seen.sum as f64 / SECOND as f64 / f64::from(count);
        mean_changed(model, cluster, observed, count).then(|| Departure {
            kind: Kind::AverageTime,
            rule,
            observed,
            learned: cluster.average_s,
            observed_shares: Vec::new(),
            learned_shares: Vec::new(),
        })
    })
}

fn share_changed(
    model: &NominalModel,
    (count, total): (u32, u32),
    (learned, learned_total): (f64, u64),
    dispersion: impl FnOnce() -> f64,
) -> bool {
    let observed = f64::from(count) / f64::from(total);
    let change = (observed - learned).abs();
    if change <= model.parameters.significant_change {
        return false;
    }
    if model.parameters.timing == Timing::Plat {
        return true;
    }
    if total < OBSERVATIONS_AT_LEAST {
        return false;
    }
    let (n, n0) = (f64::from(total), learned_total as f64);
    // Pooled share under "nothing has changed", with one pseudo-count on either side.
    let pooled = (f64::from(count) + learned * n0 + 1.0) / (n + n0 + 2.0);
    let variance = dispersion() * pooled * (1.0 - pooled) * (1.0 / n + 1.0 / n0);
    let continuity = 0.5 / n;
    two_sided((change - continuity).max(0.0) / variance.sqrt(), n + n0 - 2.0)
        <= model.judgement().budget.per_share
}

fn mean_changed(model: &NominalModel, cluster: &TimeCluster, observed: f64, count: u32) -> bool {
    let change = (observed - cluster.average_s).abs();
    if change <= model.significant_change_s(cluster) {
        return false;
    }
    if model.parameters.timing == Timing::Plat {
        return true;
    }
    if count < OBSERVATIONS_AT_LEAST || cluster.instances < BODY_INSTANCES {
        return false;
    }
    let resolution = model.learned.resolution as f64 / SECOND as f64;
    // Of several times, how their shares wander says how far times stick together.
    let dispersion = f64::from(cluster.dispersion).max(1.0);
    let n0 = f64::from(cluster.instances);
    let error = f64::from(cluster.deviation_s).max(resolution)
        * (dispersion * (1.0 / f64::from(count) + 1.0 / n0)).sqrt();
    two_sided(change / error, n0 - 1.0) <= model.judgement().budget.per_average
}

/// Two-sided tail of Student's t by Wallace's normal approximation (1959).
fn two_sided(t: f64, degrees: f64) -> f64 {
    let degrees = degrees.max(1.0);
    let shrunk = (degrees * (t * t / degrees).ln_1p()).sqrt() * (8.0 * degrees + 1.0)
        / (8.0 * degrees + 3.0);
    libm::erfc(shrunk / std::f64::consts::SQRT_2)
}

#[cfg(test)]
mod tests {
    use super::two_sided;

    #[test]
    fn tails_are_those_of_the_tables() {
        // t = 2.093 at 19 degrees is the 5 % point, 1.96 that of the normal law.
        assert!((two_sided(2.093, 19.0) - 0.05).abs() < 1e-3);
        assert!((two_sided(1.96, 1e9) - 0.05).abs() < 1e-3);
    }
}
