//! How probable it is that a healthy machine leaves a state in a way not seen yet.
//!
//! What is new to a device may be known from its sisters; what none of them ever did is rarer. Both
//! are unseen mass (Good-Turing, [`super::oddity`]), of kinds seen once by the device, and of those
//! among them that no sister took either.

use std::collections::BTreeMap;

use super::chains::{ChainIndex, ChainKind};
use super::oddity::{Oddity, Tally};
use super::rules::Rule;
use super::sisters::{Family, Names};
use super::states::StateId;
use super::ways::Ways;
use crate::log::SignalIndex;

/// To whom a way of leaving a state is new.
#[derive(Debug, Clone, Copy)]
enum Novelty {
    ToDevice,
    ToSisters,
}

impl Novelty {
    /// True where a rule was once such a novelty, and its kind never came again; `taken` says how
    /// often sisters took it.
    fn is_odd(self, rule: &Rule, taken: impl Fn() -> Option<u64>) -> bool {
        rule.evidence() == 1
            && match self {
                Self::ToDevice => true,
                Self::ToSisters => taken() == Some(1),
            }
    }
}

/// States of group chains, with the ways out of them that never came again. In a program ways are
/// few, and what is new is new where something was new before; in a group its devices fall in with
/// one another, and it may be new anywhere: each state is one draw (Ewens), whatever came of it.
fn of_states<'a>(
    rules: impl Iterator<Item = (&'a Rule, &'a Family)>,
    names: Names<'_>,
) -> impl Iterator<Item = (ChainIndex, Family, Tally)> {
    let mut states: BTreeMap<StateId, (ChainIndex, Tally)> = BTreeMap::new();
    for (rule, _) in rules {
        let once = f64::from(rule.evidence() == 1);
        let (_, tally) = states.entry(rule.current).or_insert((rule.chain, Tally::default()));
        tally.once += once;
        tally.kinds += once;
        tally.draws = 1.0;
    }
    let family = move |state| names.of_state(state, ChainKind::Group);
    states.into_iter().map(move |(state, (chain, tally))| (chain, family(state), tally))
}

/// Unseen ways of leaving a state, in a whole plant.
#[derive(Debug)]
pub struct Leaving {
    /// In a way new to a device, and in one new to its sisters too.
    of_devices: [Oddity; 2],
    /// In a group's chain.
    of_groups: Oddity,
    /// Of devices.
    ways: Ways,
}

impl Leaving {
    /// Tallies rules, whose families are these.
    pub fn of(rules: &[Rule], families: &[Family], names: Names<'_>) -> Self {
        let of_kind = |kind| {
            let rules = rules.iter().zip(families);
            rules.filter(move |(rule, _)| names.chains.kind(rule.chain) == kind)
        };
        let ways = Ways::of(of_kind(ChainKind::Device).map(|(rule, &way)| (way, rule.evidence())));
        let leaving = |kind, odd: &dyn Fn(&Rule, Family) -> bool| {
            Oddity::of_programs(of_kind(kind).map(|(rule, &way)| {
                let once = f64::from(odd(rule, way));
                let tally = Tally { once, kinds: once, draws: rule.evidence() as f64 };
                (rule.chain, names.of_state(rule.current, kind), tally)
            }))
        };
        let of_devices = [Novelty::ToDevice, Novelty::ToSisters].map(|novelty| {
            leaving(ChainKind::Device, &|rule, way| novelty.is_odd(rule, || ways.taken(way)))
        });
        let of_groups = Oddity::of_programs(of_states(of_kind(ChainKind::Group), names));
        Self { of_devices, of_groups, ways }
    }

    /// Probability that a state is left for a signal's value, which it never was: in any way new
    /// to its device where sisters know this one, else in one new to them all.
    pub fn unknown(
        &self,
        row: &[Rule],
        names: Names<'_>,
        (chain, whole, state): (ChainIndex, ChainIndex, StateId),
        next: (SignalIndex, i64),
    ) -> f64 {
        let [to_device, to_sisters] = self.unseen(row, names, (chain, whole, state));
        let way = names.of_transition(state, next, names.chains.kind(chain));
        if self.ways.taken(way).is_some() { to_device } else { to_sisters }
    }

    /// Probabilities that a state is left in a way new to its device, and in one new to all its
    /// sisters: of the state whose rules are `row`, in a chain that is `whole` in the whole plant.
    pub fn unseen(
        &self,
        row: &[Rule],
        names: Names<'_>,
        (chain, whole, state): (ChainIndex, ChainIndex, StateId),
    ) -> [f64; 2] {
        let kind = names.chains.kind(chain);
        let family = names.of_state(state, kind);
        let draws = row.iter().map(Rule::evidence).sum::<u64>() as f64;
        let unseen = |oddity: &Oddity, novelty: Novelty| {
            let taken = |rule| self.ways.taken(names.of_rule(rule));
            let odd = row.iter().filter(|rule| novelty.is_odd(rule, || taken(rule)));
            let tally = Tally { once: odd.count() as f64, draws, ..Tally::default() };
            tally.unseen(oddity.at(whole, family))
        };
        if kind == ChainKind::Group {
            return [unseen(&self.of_groups, Novelty::ToDevice); 2];
        }
        let [of_device, of_sisters] = &self.of_devices;
        let to_device = unseen(of_device, Novelty::ToDevice);
        [to_device, unseen(of_sisters, Novelty::ToSisters).min(to_device)]
    }
}
