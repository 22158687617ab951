//! How odd a healthy plant is, and its parts: unseen mass, shared between those who are alike.
//!
//! Good-Turing: after `n` draws of which `s` kinds were seen once, the next draw is of an unseen
//! kind with probability `s/n`. A part (a device, a family of sisters) is as odd as the plant,
//! unless parts differ by more than chance: then in so far as they do. The number of odd kinds of a
//! part is Poisson, its rate over the plant's gamma with mean 1, and the gamma's shape `k` is found
//! by moments; a part with `a` odd kinds where `e` were to be expected is `(k + a)/(k + e)` times as
//! odd as the plant.

// Ordered maps: sums must not depend on the order in which a table happens to lie.
use std::collections::{BTreeMap, BTreeSet};

use super::chains::ChainIndex;
use super::sisters::Family;

/// What a plant with no evidence at all is taken to hide: one half of one kind.
const PRIOR_ONCE: f64 = 0.5;

/// What was drawn, and how much of it was odd.
#[derive(Debug, Clone, Copy, Default)]
pub struct Tally {
    /// Odd draws.
    pub once: f64,
    /// Kinds with an odd draw.
    pub kinds: f64,
    /// All draws.
    pub draws: f64,
}

impl Tally {
    /// Unseen mass where what one draw tells is known from elsewhere.
    pub fn unseen(self, from_above: f64) -> f64 {
        (self.once + from_above) / (self.draws + 1.0)
    }

    /// Takes in another's draws.
    pub fn add(&mut self, other: Self) {
        self.once += other.once;
        self.kinds += other.kinds;
        self.draws += other.draws;
    }
}

/// Unseen mass of a plant, and how its parts differ, for parts named by `Part`.
#[derive(Debug, Clone)]
pub struct Parts<Part> {
    ratios: BTreeMap<Part, f64>,
}

impl<Part: Copy + Ord> Parts<Part> {
    /// From the tallies of all parts.
    pub fn of(tallies: &BTreeMap<Part, Tally>) -> Self {
        let mut sum = Tally::default();
        tallies.values().for_each(|tally| sum.add(*tally));
        let rate = (sum.kinds + PRIOR_ONCE) / (sum.draws + 1.0);
        let expected = |tally: &Tally| rate * tally.draws;
        let (squares, excess) = tallies.values().fold((0.0, 0.0), |(squares, excess), tally| {
            let of_part = expected(tally);
            (squares + of_part.powi(2), excess + (tally.kinds - of_part).powi(2) - of_part)
        });
        if excess <= 0.0 {
            return Self { ratios: BTreeMap::new() };
        }
        let shape = squares / excess;
        let ratio = |tally: &Tally| (shape + tally.kinds) / (shape + expected(tally));
        Self { ratios: tallies.iter().map(|(&part, tally)| (part, ratio(tally))).collect() }
    }

    /// How much odder a part is than the plant; one where parts do not differ, or nothing was drawn.
    pub fn ratio(&self, part: Part) -> f64 {
        self.ratios.get(&part).copied().unwrap_or(1.0)
    }
}

/// Unseen mass of a plant as a whole.
fn of_plant<'a>(tallies: impl Iterator<Item = &'a Tally>) -> f64 {
    let mut sum = Tally::default();
    tallies.for_each(|tally| sum.add(*tally));
    sum.unseen(PRIOR_ONCE)
}

/// Unseen mass of a plant, of its devices and of its families of sisters.
#[derive(Debug, Clone)]
pub struct Oddity {
    plant: f64,
    chains: Parts<ChainIndex>,
    families: Parts<Family>,
    /// Of chains, or of families, taken by themselves; empty where they are not.
    of_programs: BTreeMap<ChainIndex, f64>,
    of_makes: BTreeMap<Family, f64>,
}

/// Chains whose sisters are a make of their own.
const SISTERS_AT_LEAST: usize = 3;

/// What was drawn in the chains, and in the families, of a plant.
#[derive(Default)]
struct Drawn {
    chains: BTreeMap<ChainIndex, Tally>,
    families: BTreeMap<Family, (Tally, BTreeSet<ChainIndex>)>,
}

impl Drawn {
    fn of(tallies: impl Iterator<Item = (ChainIndex, Family, Tally)>) -> Self {
        let mut drawn = Self::default();
        for (chain, family, tally) in tallies {
            drawn.chains.entry(chain).or_default().add(tally);
            let (of_family, chains) = drawn.families.entry(family).or_default();
            of_family.add(tally);
            chains.insert(chain);
        }
        drawn
    }

    /// Where nothing is taken by itself.
    fn oddity(&self) -> Oddity {
        let families = self.families.iter().map(|(&family, &(tally, _))| (family, tally));
        Oddity {
            plant: of_plant(self.chains.values()),
            chains: Parts::of(&self.chains),
            families: Parts::of(&families.collect()),
            of_programs: BTreeMap::new(),
            of_makes: BTreeMap::new(),
        }
    }
}

impl Oddity {
    /// Which way a device goes on is a program of its own: one that never did anything odd is taken
    /// to be closed, whatever the rest of the plant does, and then the plant weighs one draw.
    pub fn of_programs(tallies: impl Iterator<Item = (ChainIndex, Family, Tally)>) -> Self {
        let drawn = Drawn::of(tallies);
        let oddity = drawn.oddity();
        let own = drawn.chains.iter().map(|(&chain, tally)| (chain, tally.unseen(oddity.plant)));
        Self { of_programs: own.collect(), ..oddity }
    }

    /// How long a device takes is a matter of its make: where sisters never were odd, the plant
    /// weighs one draw against all of theirs.
    pub fn of_makes(tallies: impl Iterator<Item = (ChainIndex, Family, Tally)>) -> Self {
        let drawn = Drawn::of(tallies);
        let oddity = drawn.oddity();
        let makes = drawn.families.iter().filter(|(_, (_, of))| of.len() >= SISTERS_AT_LEAST);
        let own = makes.map(|(&family, (tally, _))| (family, tally.unseen(oddity.plant)));
        Self { of_makes: own.collect(), ..oddity }
    }

    /// What one draw of a family in a chain tells.
    pub fn at(&self, chain: ChainIndex, family: Family) -> f64 {
        let alike = self.plant * self.chains.ratio(chain) * self.families.ratio(family);
        let own = [self.of_programs.get(&chain), self.of_makes.get(&family)];
        own.into_iter().flatten().fold(alike, |least, &own| least.min(own)).min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tally(kinds: f64) -> Tally {
        Tally { once: kinds, kinds, draws: 1000.0 }
    }

    #[test]
    fn parts_that_differ_by_chance_are_alike() {
        let alike = (0..100).map(|part| (part, tally(f64::from(part % 3)))).collect();
        let parts = Parts::of(&alike);
        assert!((parts.ratio(0) - 1.0).abs() < 0.01 && (parts.ratio(2) - 1.0).abs() < 0.01);
    }

    #[test]
    fn one_odd_part_does_not_make_the_others_odd() {
        let mut tallies: BTreeMap<i32, Tally> = (0..100).map(|part| (part, tally(0.0))).collect();
        tallies.insert(100, tally(60.0));
        let parts = Parts::of(&tallies);
        assert!(parts.ratio(3) < 0.1);
        assert!(parts.ratio(100) > 50.0);
    }
}
