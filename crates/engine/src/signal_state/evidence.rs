//! What an alarm rests on: how probable the unseen is on a healthy machine.
//!
//! Good-Turing: after `n` draws of which `s` kinds were seen once, the next draw is of an unseen
//! kind with probability `s/n`. A state left once or rarely makes the unknown unsurprising. States
//! with little data of their own borrow from their chain, which weighs one draw:
//! `θ(state) = (s + θ(chain)) / (n + 1)`. A chain is as odd as all chains of its kind are,
//! `θ(plant) = (S + ½) / (N + 1)`, unless chains differ by more than chance: then in so far as they do
//! (gamma-Poisson, its shape by moments). The same mass over *rare* time clusters says how probable
//! an odd time is.

use crate::timing::limits::BODY_INSTANCES;
use crate::timing::shape::Shapes;

use super::chains::{ChainKind, Chains};
use super::rules::{Rule, RuleTable, row_of};
use super::states::StateId;

/// Seen-once kinds out of draws, and how many rules they are of.
#[derive(Debug, Clone, Copy, Default)]
struct Tally {
    once: f64,
    rules: f64,
    draws: f64,
}

impl Tally {
    fn unseen(self, from_above: f64) -> f64 {
        (self.once + from_above) / (self.draws + 1.0)
    }
}

/// Unseen mass per chain, from which that of states and rules follows.
#[derive(Debug, Clone)]
pub struct Evidence {
    transition_by_chain: Vec<f64>,
    /// By character.
    time_by_chain: [Vec<f64>; 3],
    /// Of what is explained, and of open waits.
    shares: [SharesByLength; 2],
    /// By character.
    shapes: [Shapes; 3],
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
    /// its own that has not been seen yet, times the number of rules.
    fn unseen(&self, instances: u64) -> f64 {
        let mass = |(percent, &clusters): (usize, &u32)| {
            let share = percent as f64 / 100.0;
            f64::from(clusters) * share * (1.0 - share).powf(instances as f64)
        };
        self.clusters.iter().enumerate().map(mass).sum::<f64>()
    }
}

/// Shares by the length of the times, in powers of ten: what takes minutes is made of more than
/// what takes a tenth of a second. The whole plant counts as one more rule of each length.
#[derive(Debug, Clone)]
struct SharesByLength {
    lengths: [Shares; LENGTHS],
    all: Shares,
}

const LENGTHS: usize = 6;

impl SharesByLength {
    fn of<'a>(rules: impl Iterator<Item = &'a Rule> + Clone) -> Self {
        let lengths = std::array::from_fn(|length| {
            Shares::of(rules.clone().filter(|rule| length_of(rule) == length))
        });
        Self { lengths, all: Shares::of(rules) }
    }

    fn unseen(&self, rule: &Rule) -> f64 {
        let (of_length, instances) = (&self.lengths[length_of(rule)], rule.evidence());
        let prior = self.all.unseen(instances) / f64::from(self.all.rules.max(1));
        (of_length.unseen(instances) + prior) / (f64::from(of_length.rules) + 1.0)
    }
}

/// Power of ten of a rule's longest usual time, from a hundredth of a second on.
fn length_of(rule: &Rule) -> usize {
    let usual = rule.judged().iter().filter(|c| c.instances >= BODY_INSTANCES);
    let longest_s = usual.map(|c| c.average_s).fold(0.0, f64::max);
    ((longest_s.max(0.01).log10() + 2.0) as usize).min(LENGTHS - 1)
}

/// Instances from which a time seen once or twice is odd, and not merely one of several.
const TELLING_INSTANCES: u64 = 20;
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
            transition.rules += f64::from(rule.evidence() == 1);
            // One instance of a few is a usual time seen too seldom, and says nothing about how
            // often others are odd.
            if rule.evidence() >= TELLING_INSTANCES {
                let time = &mut times[Character::of(rule, resolution_s) as usize][rule.chain];
                time.draws += rule.evidence() as f64;
                let rare = rare_instances(rule);
                time.once += rare as f64;
                time.rules += f64::from(rare > 0);
            }
        }
        let open = |rule: &&Rule| Character::of(rule, resolution_s) == Character::OpenWait;
        Self {
            transition_by_chain: shrink(&transitions, chains),
            time_by_chain: times.map(|times| shrink(&times, chains)),
            shares: [
                SharesByLength::of(rules.iter().filter(|rule| !open(rule))),
                SharesByLength::of(rules.iter().filter(open)),
            ],
            shapes: [Character::Motion, Character::KnownWait, Character::OpenWait].map(|of| {
                let rules = rules.iter().filter(|rule| {
                    chains.kind(rule.chain) == ChainKind::Device
                        && Character::of(rule, resolution_s) == of
                });
                Shapes::of(rules.flat_map(Rule::judged), resolution_s)
            }),
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
            ..Tally::default()
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
        let longest = rule.judged().iter().map(|c| c.maximum_s).fold(0.0, f64::max);
        let beyond =
            if time_s > longest && time_s > 0.0 { longest.max(1e-3) / time_s } else { 1.0 };
        let (odd, usual) = self.unseen_times(rule);
        (odd * beyond.min(1.0)).max(usual)
    }

    /// Probability that a transition of a healthy machine takes any time outside all that is usual
    /// for it.
    pub fn any_odd_time(&self, rule: &Rule) -> f64 {
        let (odd, usual) = self.unseen_times(rule);
        odd.max(usual)
    }

    /// Probabilities of an odd time, and of a usual one not seen yet.
    fn unseen_times(&self, rule: &Rule) -> (f64, f64) {
        let tally = Tally {
            once: rare_instances(rule) as f64,
            draws: rule.evidence() as f64,
            ..Tally::default()
        };
        let character = Character::of(rule, self.resolution_s);
        let from_chain = self.time_by_chain[character as usize][rule.chain];
        let shares = &self.shares[usize::from(character == Character::OpenWait)];
        (tally.unseen(from_chain), shares.unseen(rule))
    }

    /// Shapes of the times of a rule's kind.
    pub fn shapes(&self, rule: &Rule) -> &Shapes {
        &self.shapes[Character::of(rule, self.resolution_s) as usize]
    }

    /// Shapes of times since the device's own event where another's enables it.
    pub fn shapes_without_trigger(&self) -> &Shapes {
        &self.shapes[Character::OpenWait as usize]
    }
}

/// Instances in clusters too small to be a usual time.
fn rare_instances(rule: &Rule) -> u64 {
    let rare = rule.judged().iter().filter(|c| c.instances < BODY_INSTANCES);
    rare.map(|c| c.instances).sum::<u64>().saturating_sub(rule.uncounted)
}

/// Unseen mass of every chain: that of all chains of its kind, in so far as they are alike.
fn shrink(tallies: &[Tally], chains: &Chains) -> Vec<f64> {
    let mut unseen = vec![0.0; tallies.len()];
    for kind in [ChainKind::Device, ChainKind::Group] {
        let of_kind =
            || tallies.iter().enumerate().filter(|(chain, _)| chains.kind(*chain) == kind);
        let sum = of_kind().fold(Tally::default(), |sum, (_, tally)| Tally {
            once: sum.once + tally.once,
            rules: sum.rules + tally.rules,
            draws: sum.draws + tally.draws,
        });
        let plant = sum.unseen(PRIOR_ONCE);
        // Odd rules of a chain beside how many there would be if all chains were alike.
        let rate = (sum.rules + PRIOR_ONCE) / (sum.draws + 1.0);
        let expected = |tally: &Tally| rate * tally.draws;
        let (squares, excess) = of_kind().fold((0.0, 0.0), |(squares, excess), (_, tally)| {
            let of_chain = expected(tally);
            (squares + of_chain.powi(2), excess + (tally.rules - of_chain).powi(2) - of_chain)
        });
        for (chain, tally) in of_kind() {
            let ratio = if excess > 0.0 {
                let shape = squares / excess;
                (shape + tally.rules) / (shape + expected(tally))
            } else {
                1.0
            };
            unseen[chain] = (plant * ratio).min(1.0);
        }
    }
    unseen
}
