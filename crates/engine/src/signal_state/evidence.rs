//! What an alarm rests on: how probable the unseen is on a healthy machine.
//!
//! A state left once or rarely makes the unknown unsurprising. States with little data of their own
//! borrow from where they are, which weighs one draw: `θ(state) = (s + θ) / (n + 1)`, where `θ` is
//! the plant's unseen mass, in so far as their device and their sisters differ from it
//! ([`super::oddity`]). The same mass over *rare* time clusters says how probable an odd time is.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::log::SignalIndex;
use crate::timing::TimeCluster;
use crate::timing::limits::BODY_INSTANCES;
use crate::timing::pooled::Pooled;
use crate::timing::shape::{SHAPE_INSTANCES, Shapes};

use super::chains::{ChainIndex, ChainKind};
use super::leaving::Leaving;
use super::oddity::{Oddity, Tally};
use super::rules::{Rule, RuleTable, row_of};
use super::shares::{FirstSeenByCount, SharesBySisters};
use super::sisters::{Family, Names};
use super::states::StateId;

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

const CHARACTERS: [Character; 3] = [Character::Motion, Character::KnownWait, Character::OpenWait];
/// Motions take up to this many times (part types, speeds).
const MOTION_TIMES: usize = 3;
/// A motion's time spreads over no more than this share of it, or this many resolutions.
const MOTION_SPREAD: f64 = 0.1;
const MOTION_RESOLUTIONS: f64 = 10.0;
/// A time spreads over no more than so many of its standard deviations: the extremes of many
/// instances lie farther apart than those of a few, and it is the same motion.
const SPREAD_DEVIATIONS: f64 = 5.0;
/// Instances from which it shows how the share of a way wanders.
const WANDERING_INSTANCES: u64 = 8;
/// Instances from which a time seen once or twice is odd, and not merely one of several.
const TELLING_INSTANCES: u64 = 20;

impl Character {
    fn of(rule: &Rule, resolution_s: f64) -> Self {
        let usual = || rule.judged().iter().filter(|c| c.instances >= BODY_INSTANCES);
        let tight = usual().all(|cluster| {
            let spread = (cluster.maximum_s - cluster.minimum_s)
                .min(SPREAD_DEVIATIONS * f64::from(cluster.deviation_s));
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

/// Unseen mass per chain and family, from which that of states and rules follows.
#[derive(Debug, Clone)]
pub struct Evidence {
    of_plant: Arc<OfPlant>,
    /// In a part of a plant, by chain: its number in the whole one; none in the whole one.
    whole_chain: Option<Arc<[ChainIndex]>>,
}

/// What a whole plant tells.
#[derive(Debug)]
struct OfPlant {
    leaving: Leaving,
    /// How far shares wander in the chain of a group, by the ways of it that tell.
    wandering: BTreeMap<ChainIndex, f32>,
    /// By character.
    times: [Oddity; 3],
    /// Of what is explained, and of open waits.
    shares: [SharesBySisters; 2],
    /// By character.
    shapes: [Shapes; 3],
    /// Weight of exponential tails in families that tell, by character; sorted.
    of_families: [Box<[(Family, f64)]>; 3],
    /// What families of enough sisters show together, by character; sorted.
    pooled: [Box<[(Family, Pooled)]>; 3],
    resolution_s: f64,
}

impl Evidence {
    /// Tallies the rules of a model; `resolution_s` is the smallest time difference that means
    /// something.
    pub fn of(rules: &[Rule], names: Names<'_>, resolution_s: f64) -> Self {
        let characters: Vec<Character> =
            rules.iter().map(|rule| Character::of(rule, resolution_s)).collect();
        let families: Vec<Family> = rules.iter().map(|rule| names.of_rule(rule)).collect();
        let leaving = Leaving::of(rules, &families, names);
        let mut wandering = BTreeMap::<ChainIndex, f32>::new();
        for rule in rules.iter().filter(|rule| rule.evidence() >= WANDERING_INSTANCES) {
            if names.chains.kind(rule.chain) == ChainKind::Group {
                let most = wandering.entry(rule.chain).or_insert(1.0);
                *most = most.max(rule.dispersion);
            }
        }
        let of = |character| {
            let rules = rules.iter().zip(&characters).zip(&families);
            // What a group's chain takes says nothing that its devices' do not.
            rules.filter(move |((rule, of_rule), _)| {
                **of_rule == character && names.chains.kind(rule.chain) == ChainKind::Device
            })
        };
        let times = CHARACTERS.map(|character| {
            // One instance of a few is a usual time seen too seldom, and says nothing about how
            // often others are odd.
            let telling = of(character).filter(|((r, _), _)| r.evidence() >= TELLING_INSTANCES);
            Oddity::of_makes(telling.map(|((rule, _), &family)| {
                let once = rare_instances(rule) as f64;
                let draws = rule.evidence() as f64;
                (rule.chain, family, Tally { once, kinds: once.min(1.0), draws })
            }))
        });
        let mut shares = [SharesBySisters::default(), SharesBySisters::default()];
        for ((rule, character), &family) in rules.iter().zip(&characters).zip(&families) {
            shares[usize::from(*character == Character::OpenWait)].add(rule, family);
        }
        let shapes = CHARACTERS.map(|character| {
            Shapes::of(of(character).flat_map(|((rule, _), _)| rule.judged()), resolution_s)
        });
        let families = CHARACTERS.map(|character| {
            let mut clusters: BTreeMap<Family, Vec<&TimeCluster>> = BTreeMap::new();
            for ((rule, _), &family) in of(character) {
                clusters.entry(family).or_default().extend(rule.judged());
            }
            clusters
        });
        let of_families = CHARACTERS.map(|character| {
            let of_all = &shapes[character as usize];
            let weight = |(&family, clusters): (&Family, &Vec<&TimeCluster>)| {
                let weight = of_all.of_family(clusters.iter().copied());
                weight.map(|weight| (family, weight))
            };
            families[character as usize].iter().filter_map(weight).collect()
        });
        let pooled = CHARACTERS.map(|character| {
            let together = |(&family, clusters): (&Family, &Vec<&TimeCluster>)| {
                // Only what is too small to tell its own shape is ever asked for.
                let asked = clusters.iter().any(|cluster| cluster.instances < SHAPE_INSTANCES);
                let pooled = || Pooled::of(clusters.iter().copied(), resolution_s);
                asked.then(pooled).flatten().map(|pooled| (family, pooled))
            };
            families[character as usize].iter().filter_map(together).collect()
        });
        let of_plant = OfPlant {
            leaving,
            wandering,
            times,
            shares,
            shapes,
            of_families,
            pooled,
            resolution_s,
        };
        Self { of_plant: Arc::new(of_plant), whole_chain: None }
    }

    /// The same, asked for by the chains of a part of the plant.
    pub fn of_part(&self, whole_chain: &[ChainIndex]) -> Self {
        Self { of_plant: Arc::clone(&self.of_plant), whole_chain: Some(whole_chain.into()) }
    }

    fn whole(&self, chain: ChainIndex) -> ChainIndex {
        self.whole_chain.as_ref().map_or(chain, |whole| whole[chain])
    }

    /// Probability that a healthy machine leaves `state` for a signal's value `next`, which it
    /// never did: in any way new to its device where sisters know this one, else in one new to them
    /// all.
    pub fn unknown_transition(
        &self,
        rules: &[Rule],
        table: &RuleTable,
        names: Names<'_>,
        (chain, state, next): (ChainIndex, StateId, (SignalIndex, i64)),
    ) -> f64 {
        let whole = self.whole(chain);
        let row = &rules[table.row(row_of(state, names.chains.kind(chain)))];
        self.of_plant.leaving.unknown(row, names, (chain, whole, state), next)
    }

    /// Probabilities that a healthy machine leaves `state` in a way not seen yet: in its device,
    /// and in any of its sisters either.
    pub fn unknown_transitions(
        &self,
        rules: &[Rule],
        table: &RuleTable,
        names: Names<'_>,
        (chain, state): (ChainIndex, StateId),
    ) -> [f64; 2] {
        let whole = self.whole(chain);
        let row = &rules[table.row(row_of(state, names.chains.kind(chain)))];
        self.of_plant.leaving.unseen(row, names, (chain, whole, state))
    }

    /// How far the share of a way wanders, against independent draws. The devices of a group fall
    /// into step and out again, and what a rare way shows of it by itself is nothing: there the way
    /// that wanders most speaks for all.
    pub fn dispersion(&self, rule: &Rule) -> f64 {
        let of_chain = self.of_plant.wandering.get(&self.whole(rule.chain));
        of_chain.map_or(rule.dispersion, |most| most.max(rule.dispersion)).into()
    }

    /// True where a transition waits for something nobody knows, so that another device's delay
    /// may be its own.
    pub fn is_open_wait(&self, rule: &Rule) -> bool {
        Character::of(rule, self.of_plant.resolution_s) == Character::OpenWait
    }

    /// Probability that a transition of a healthy machine takes `time_s`, which lies outside all
    /// that is usual for it. Longer than anything seen is rarer still, falling with the ratio.
    pub fn odd_time(&self, rule: &Rule, names: Names<'_>, time_s: f64) -> f64 {
        let longest = rule.judged().iter().map(|c| c.maximum_s).fold(0.0, f64::max);
        let beyond =
            if time_s > longest && time_s > 0.0 { longest.max(1e-3) / time_s } else { 1.0 };
        let (odd, usual) = self.unseen_times(rule, names, &mut FirstSeenByCount::default());
        (odd * beyond.min(1.0)).max(usual)
    }

    /// Probability that a transition of a healthy machine takes any time outside all that is usual
    /// for it.
    pub fn any_odd_time(&self, rule: &Rule, names: Names<'_>, first: &mut FirstSeenByCount) -> f64 {
        let (odd, usual) = self.unseen_times(rule, names, first);
        odd.max(usual)
    }

    /// Probabilities of an odd time, and of a usual one not seen yet.
    fn unseen_times(
        &self,
        rule: &Rule,
        names: Names<'_>,
        first: &mut FirstSeenByCount,
    ) -> (f64, f64) {
        let tally = Tally {
            once: rare_instances(rule) as f64,
            draws: rule.evidence() as f64,
            ..Tally::default()
        };
        let character = Character::of(rule, self.of_plant.resolution_s);
        let family = names.of_rule(rule);
        let shares = &self.of_plant.shares[usize::from(character == Character::OpenWait)];
        let odd = tally
            .unseen(self.of_plant.times[character as usize].at(self.whole(rule.chain), family));
        (odd, shares.unseen(rule, family, first))
    }

    /// Shapes of the times of a rule's kind, as its sisters show them.
    pub fn shapes(&self, rule: &Rule, names: Names<'_>) -> Shapes {
        let character = Character::of(rule, self.of_plant.resolution_s) as usize;
        let of_plant = &self.of_plant;
        let (shapes, of_families) = (&of_plant.shapes[character], &of_plant.of_families[character]);
        let family = names.of_rule(rule);
        let weight = of_family(of_families, family);
        let shapes = weight.map_or(*shapes, |&weight| shapes.weighted(weight));
        shapes.like(of_family(&of_plant.pooled[character], family).copied())
    }

    /// Shapes of times since the device's own event where another's enables it.
    pub fn shapes_without_trigger(&self) -> &Shapes {
        &self.of_plant.shapes[Character::OpenWait as usize]
    }
}

fn of_family<T>(of_families: &[(Family, T)], family: Family) -> Option<&T> {
    let found = of_families.binary_search_by_key(&family, |&(family, _)| family);
    found.ok().map(|at| &of_families[at].1)
}

/// Instances in clusters too small to be a usual time, but for those of a start.
fn rare_instances(rule: &Rule) -> u64 {
    let rare = rule.judged().iter().filter(|c| c.instances < BODY_INSTANCES);
    rare.map(|c| u64::from(c.instances)).sum::<u64>().saturating_sub(u64::from(rule.odd_at_start))
}
