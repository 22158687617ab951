//! What an alarm rests on: how probable the unseen is on a healthy machine.
//!
//! Good-Turing: after `n` draws of which `s` kinds were seen once, the next draw is of an unseen
//! kind with probability `s/n`. A state left once or rarely makes the unknown unsurprising. States
//! with little data of their own borrow from their chain, and chains from all chains of their
//! kind, each level weighing one draw:
//! `θ(state) = (s + θ(chain)) / (n + 1)`, `θ(chain) = (S + θ(plant)) / (N + 1)`, …
//! The same mass over *rare* time clusters says how probable an odd time is.

use crate::timing::limits::BODY_INSTANCES;

use super::chains::{ChainKind, Chains};
use super::rules::{Rule, RuleTable, row_of};
use super::states::StateId;

/// Seen-once kinds out of draws.
#[derive(Debug, Clone, Copy, Default)]
struct Tally {
    once: f64,
    draws: f64,
}

impl Tally {
    fn unseen(self, from_above: f64) -> f64 {
        (self.once + from_above) / (self.draws + 1.0)
    }
}

/// Unseen mass per chain, from which that of states and rules follows.
#[derive(Debug, Clone, Default)]
pub struct Evidence {
    transition_by_chain: Vec<f64>,
    /// By character.
    time_by_chain: [Vec<f64>; 3],
    /// Of what is explained, and of open waits.
    shares: [Shares; 2],
    resolution_s: f64,
}

/// What a transition's time is made of. The rare times of one say nothing about the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Character {
    /// The machine moves: one time, or a few, each tight.
    Motion,
    /// The device waits for an event that is known.
    KnownWait,
    /// The device waits for something nobody knows.
    OpenWait,
}

/// Motions take up to this many times (part types, speeds).
const MOTION_TIMES: usize = 3;
/// A motion's time spreads over no more than this share of it, or this many resolutions.
const MOTION_SPREAD: f64 = 0.05;
const MOTION_RESOLUTIONS: f64 = 10.0;

impl Character {
    fn of(rule: &Rule, resolution_s: f64) -> Self {
        let usual = || rule.judged().iter().filter(|c| c.instances >= BODY_INSTANCES);
        let tight = usual().all(|cluster| {
            let spread = cluster.maximum_s - cluster.minimum_s;
            spread <= (MOTION_SPREAD * cluster.average_s).max(MOTION_RESOLUTIONS * resolution_s)
        });
        if rule.trigger.is_some() {
            Self::KnownWait
        } else if tight && usual().count() <= MOTION_TIMES {
            Self::Motion
        } else {
            Self::OpenWait
        }
    }
}

/// Shares of the time clusters of all rules that have several: what a rule seen only a few times
/// may still hold back. Of a cluster with share `q` nothing is seen in `n` instances with
/// probability `(1-q)^n`, and the next instance is its first with probability `q·(1-q)^n`.
#[derive(Debug, Clone, Default)]
struct Shares {
    /// Clusters by share, in steps of one hundredth.
    clusters: Vec<u32>,
    rules: u32,
}

impl Shares {
    fn of<'a>(rules: impl Iterator<Item = &'a Rule>) -> Self {
        let mut shares = Self { clusters: vec![0; 101], rules: 0 };
        for rule in rules.filter(|rule| rule.evidence() >= BODY_INSTANCES) {
            shares.rules += 1;
            let clusters = rule.judged();
            let usual = clusters.iter().filter(|c| c.instances >= BODY_INSTANCES);
            for cluster in usual.filter(|_| clusters.len() > 1) {
                let percent = (cluster.probability * 100.0).round().clamp(0.0, 100.0);
                shares.clusters[percent as usize] += 1;
            }
        }
        shares
    }

    /// Probability that the next instance of a rule seen `instances` times takes a usual time of
    /// its own that has not been seen yet.
    fn unseen(&self, instances: u64) -> f64 {
        let mass = |(percent, &clusters): (usize, &u32)| {
            let share = percent as f64 / 100.0;
            f64::from(clusters) * share * (1.0 - share).powf(instances as f64)
        };
        self.clusters.iter().enumerate().map(mass).sum::<f64>() / f64::from(self.rules.max(1))
    }
}

/// What a plant with no evidence at all is taken to hide: one half of one kind.
const PRIOR_ONCE: f64 = 0.5;

impl Evidence {
    /// Tallies the rules of a model; `resolution_s` is the smallest time difference that means
    /// something.
    pub fn of(rules: &[Rule], chains: &Chains, resolution_s: f64) -> Self {
        let mut transitions = vec![Tally::default(); chains.len()];
        let mut times = [transitions.clone(), transitions.clone(), transitions.clone()];
        for rule in rules {
            let transition = &mut transitions[rule.chain];
            transition.draws += rule.evidence() as f64;
            transition.once += f64::from(rule.evidence() == 1);
            // A transition hardly ever seen has no usual time from which another would be odd.
            if rule.evidence() >= BODY_INSTANCES {
                let time = &mut times[Character::of(rule, resolution_s) as usize][rule.chain];
                time.draws += rule.evidence() as f64;
                time.once += rare_instances(rule) as f64;
            }
        }
        let open = |rule: &&Rule| Character::of(rule, resolution_s) == Character::OpenWait;
        Self {
            transition_by_chain: shrink(&transitions, chains),
            time_by_chain: times.map(|times| shrink(&times, chains)),
            shares: [
                Shares::of(rules.iter().filter(|rule| !open(rule))),
                Shares::of(rules.iter().filter(open)),
            ],
            resolution_s,
        }
    }

    /// Probability that a healthy machine leaves `state` in a way not seen yet.
    pub fn unknown_transition(
        &self,
        rules: &[Rule],
        table: &RuleTable,
        chain: usize,
        kind: ChainKind,
        state: StateId,
    ) -> f64 {
        let row = &rules[table.row(row_of(state, kind))];
        let tally = Tally {
            once: row.iter().filter(|rule| rule.evidence() == 1).count() as f64,
            draws: row.iter().map(Rule::evidence).sum::<u64>() as f64,
        };
        tally.unseen(self.transition_by_chain[chain])
    }

    /// True where a transition waits for something nobody knows, so that another device's delay
    /// may be its own.
    pub fn is_open_wait(&self, rule: &Rule) -> bool {
        Character::of(rule, self.resolution_s) == Character::OpenWait
    }

    /// Probability that a transition of a healthy machine takes `time_s`, which lies outside all
    /// that is usual for it. Longer than anything seen is rarer still, falling with the ratio.
    pub fn odd_time(&self, rule: &Rule, time_s: f64) -> f64 {
        let tally = Tally { once: rare_instances(rule) as f64, draws: rule.evidence() as f64 };
        let longest = rule.judged().iter().map(|c| c.maximum_s).fold(0.0, f64::max);
        let beyond =
            if time_s > longest && time_s > 0.0 { longest.max(1e-3) / time_s } else { 1.0 };
        let character = Character::of(rule, self.resolution_s);
        let from_chain = self.time_by_chain[character as usize][rule.chain];
        let odd = tally.unseen(from_chain) * beyond.min(1.0);
        let shares = &self.shares[usize::from(character == Character::OpenWait)];
        odd.max(shares.unseen(rule.evidence()))
    }
}

/// Instances in clusters too small to be a usual time.
fn rare_instances(rule: &Rule) -> u64 {
    let rare = rule.judged().iter().filter(|c| c.instances < BODY_INSTANCES);
    rare.map(|c| c.instances).sum::<u64>().saturating_sub(u64::from(rule.uncounted))
}

/// Unseen mass of every chain, shrunk towards that of all chains of its kind.
fn shrink(tallies: &[Tally], chains: &Chains) -> Vec<f64> {
    let plant = |kind: ChainKind| {
        let of_kind = tallies.iter().enumerate().filter(|(chain, _)| chains.kind(*chain) == kind);
        let sum = of_kind.fold(Tally::default(), |sum, (_, tally)| Tally {
            once: sum.once + tally.once,
            draws: sum.draws + tally.draws,
        });
        sum.unseen(PRIOR_ONCE)
    };
    let (devices, groups) = (plant(ChainKind::Device), plant(ChainKind::Group));
    tallies
        .iter()
        .enumerate()
        .map(|(chain, tally)| {
            tally.unseen(if chains.kind(chain) == ChainKind::Device { devices } else { groups })
        })
        .collect()
}
