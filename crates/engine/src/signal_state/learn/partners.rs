//! What sisters wait for: a partner that a transition hardly ever had to wait for is known from
//! others that are called alike but for numbers.
//!
//! `St4Conv` runs when its clamp is open and `St5Conv` has stopped, and `St5Conv` when its own is
//! and `St6Conv` has. Then `St3Conv` waits for `St4Conv`, though that has always been the earlier.

use std::collections::{BTreeMap, BTreeSet};

use crate::plant::Plant;
use crate::signal_state::enabling::{self, Delayed, Happenings, Joined, Usual, has_odd};
use crate::signal_state::states::{NO_STATE, StateId, States};

use super::instances::{Instances, OfRule};
use super::kinship::{Family, Kinship, Relative};
use super::timing::Times;
use super::walk::{Found, Walk};

/// So many sisters must have a partner that a transition itself shows nothing of, and so many for
/// each that has another, or contradicts.
const SISTERS_AT_LEAST: usize = 2;
const SISTERS_PER_STRANGER: usize = 4;

/// Joins of one family that are held against its transitions: the commonest. Sisters of one make
/// have few.
const PAIRS_AT_MOST: usize = 128;

/// A group that has been walked through.
pub(super) struct Group<'a> {
    pub(super) walk: &'a Walk,
    pub(super) instances: &'a Instances,
    pub(super) happenings: Happenings<'a>,
    pub(super) plant: &'a Plant,
    pub(super) states: &'a States,
}

/// The two of a join, as they are to sisters.
type Pair = [Relative; 2];

/// The joins of a family: how many sisters have one, and how many each; either may stand first.
#[derive(Default)]
struct Known {
    sisters: usize,
    pairs: BTreeMap<Pair, usize>,
}

/// A partner that a transition does not contradict.
struct Offer {
    /// So many sisters have it.
    have: usize,
    state: StateId,
    delayed: Delayed,
}

/// Gives transitions what their sisters wait for: `times` are those of `rules`.
pub(super) fn take_over(group: &Group<'_>, rules: &[usize], times: &mut [Times]) {
    if !times.iter().any(|times| pair(times).is_some()) {
        return;
    }
    let kinship = Kinship::of(group.plant, group.states, group.walk);
    let mut table = Table { group, rules, kinship };
    let families = table.families(times);
    let pairs = families.values().flat_map(|known| known.pairs.keys());
    table.kinship.call(&pairs.flatten().map(Relative::stem).collect::<BTreeSet<u64>>());
    let members = table.members(&families);
    for (family, members) in &members {
        for &place in members {
            if let Some(better) = table.better(&families[family], place, &times[place]) {
                table.give(better, place, &mut times[place]);
            }
        }
    }
    for (family, mut known) in table.families(times) {
        let mut open = members.get(&family).cloned().unwrap_or_default();
        open.retain(|&place| pair(&times[place]).is_none());
        open.retain(|&place| {
            let Some(shown) = table.shown(&known, place, &times[place]) else { return true };
            known.add(table.pairs(place, shown.states));
            table.give(shown, place, &mut times[place]);
            false
        });
        for (place, delayed) in table.offered(&known, &open, times) {
            table.give(delayed, place, &mut times[place]);
        }
    }
}

/// The two of a join.
fn pair(times: &Times) -> Option<[StateId; 2]> {
    times
        .explanation
        .trigger
        .as_ref()
        .map(|trigger| trigger.states)
        .filter(|states| states[1] != NO_STATE)
}

/// What a transition waits for, be it no more than its device's own last event.
fn waits_for(found: &Found, times: &Times) -> [StateId; 2] {
    times.explanation.trigger.as_ref().map_or([found.current, NO_STATE], |trigger| trigger.states)
}

impl Known {
    fn add(&mut self, pairs: Vec<Pair>) {
        self.sisters += 1;
        for pair in pairs {
            *self.pairs.entry(pair).or_default() += 1;
        }
    }

    fn keep_commonest(&mut self) {
        if self.pairs.len() > PAIRS_AT_MOST {
            let mut pairs: Vec<(Pair, usize)> =
                std::mem::take(&mut self.pairs).into_iter().collect();
            pairs.sort_by_key(|(_, have)| std::cmp::Reverse(*have));
            pairs.truncate(PAIRS_AT_MOST);
            self.pairs = pairs.into_iter().collect();
        }
    }
}

/// The transitions of a group by their places, and who is whose sister.
struct Table<'a> {
    group: &'a Group<'a>,
    rules: &'a [usize],
    kinship: Kinship<'a>,
}

impl<'a> Table<'a> {
    fn found(&self, place: usize) -> &'a Found {
        &self.group.walk.rules[self.rules[place]]
    }

    /// Lets a transition wait for something else than was found.
    fn give(&self, delayed: Delayed, place: usize, times: &mut Times) {
        let of_rule = (self.found(place), self.instances(place));
        times.wait_for(delayed, of_rule, (self.group.happenings, &self.group.walk.first_steps));
    }

    /// The families of those that have a join.
    fn families(&self, times: &[Times]) -> BTreeMap<Family, Known> {
        let mut families = BTreeMap::<Family, Known>::new();
        for (place, times) in times.iter().enumerate() {
            let Some(states) = pair(times) else { continue };
            if let Some(family) = self.kinship.family(self.found(place)) {
                families.entry(family).or_default().add(self.pairs(place, states));
            }
        }
        families.values_mut().for_each(Known::keep_commonest);
        families
    }

    /// Who is in these families.
    fn members(&self, families: &BTreeMap<Family, Known>) -> BTreeMap<Family, Vec<usize>> {
        let mut members = BTreeMap::<Family, Vec<usize>>::new();
        for place in 0..self.rules.len() {
            let family = self.kinship.family(self.found(place));
            if let Some(family) = family.filter(|family| families.contains_key(family)) {
                members.entry(family).or_default().push(place);
            }
        }
        members
    }

    /// All that a join may be to sisters.
    fn pairs(&self, place: usize, [one, other]: [StateId; 2]) -> Vec<Pair> {
        let found = self.found(place);
        let ones = self.kinship.relatives(found, one);
        let others = self.kinship.relatives(found, other);
        let each = ones.iter().flat_map(|one| others.iter().map(move |other| (one, other)));
        let either = each
            .flat_map(|(one, other)| [[one.clone(), other.clone()], [other.clone(), one.clone()]]);
        either.collect()
    }

    /// The join of sisters that explains a transition far better than what was found for it.
    fn better(&self, known: &Known, place: usize, times: &Times) -> Option<Delayed> {
        let found = self.found(place);
        let has = waits_for(found, times);
        let own = self.kinship.own(found);
        let states = |[one, other]: &Pair| {
            // Each comes in both orders.
            if one > other {
                return None;
            }
            let one = self.kinship.state(&own, one)?;
            let other = self.kinship.state(&own, other)?;
            // A single trigger may lack a partner only.
            let holds = |state: StateId| state == one || state == other;
            let is_new = !(holds(has[0]) && (has[1] == NO_STATE || holds(has[1])));
            (one != other && !holds(found.next) && is_new).then_some([one, other])
        };
        let pairs: Vec<[StateId; 2]> = known.pairs.keys().filter_map(states).collect();
        let OfRule::Device(entries) = self.instances(place) else { return None };
        enabling::better(self.group.happenings, entries, found.next, has, &pairs)
    }

    /// The partner of some sister that odd instances of a transition show.
    fn shown(&self, known: &Known, place: usize, times: &Times) -> Option<Delayed> {
        if !has_odd(times.judged(), self.group.happenings.resolution_s) {
            return None;
        }
        let usual = self.usual(place, times)?;
        let met = usual.met_by_odd();
        let own = self.kinship.own(self.found(place));
        let partner = |pair: &Pair| self.partner(place, &own, times, pair);
        let states = known.pairs.keys().filter_map(partner);
        let states: BTreeSet<StateId> = states.filter(|state| met.contains_key(state)).collect();
        let joined = states.into_iter().map(|state| usual.joined(state));
        let best = joined.filter(Joined::is_shown).min_by(Joined::by_merit)?;
        Some(usual.with(best))
    }

    /// Partners that enough sisters have, for those of the `open` transitions that show nothing.
    fn offered(&self, known: &Known, open: &[usize], times: &[Times]) -> Vec<(usize, Delayed)> {
        let mut offers = BTreeMap::<usize, Vec<Offer>>::new();
        for (pair, &have) in &known.pairs {
            let is_common = |strangers: usize| {
                have >= SISTERS_AT_LEAST && have >= SISTERS_PER_STRANGER * strangers
            };
            let mut strangers = known.sisters - have;
            // Where sisters share one and the same, there is no telling who else does.
            if !is_common(strangers) || pair[1].is_fixed() {
                continue;
            }
            let mut fit = Vec::new();
            for &place in open {
                let own = self.kinship.own(self.found(place));
                let state = self.partner(place, &own, &times[place], pair);
                let Some(state) = state else { continue };
                let Some(usual) = self.usual(place, &times[place]) else { continue };
                let joined = usual.joined(state);
                if !joined.is_sound() {
                    strangers += 1;
                } else if joined.alternates {
                    fit.push((place, Offer { have, state, delayed: usual.with(joined) }));
                }
            }
            if is_common(strangers) {
                for (place, offer) in fit {
                    offers.entry(place).or_default().push(offer);
                }
            }
        }
        let clearest = |(place, mut of_one): (usize, Vec<Offer>)| {
            let most = of_one.iter().map(|offer| offer.have).max()?;
            of_one.retain(|offer| offer.have == most);
            // Of two that as many have, neither is known.
            of_one.dedup_by_key(|offer| offer.state);
            let only = of_one.pop().filter(|_| of_one.is_empty())?;
            Some((place, only.delayed))
        };
        offers.into_iter().filter_map(clearest).collect()
    }

    /// The second of a pair of sisters to a transition that waits for no more than the first.
    fn partner(
        &self,
        place: usize,
        own: &[i64],
        times: &Times,
        [one, other]: &Pair,
    ) -> Option<StateId> {
        let found = self.found(place);
        let [trigger, _] = waits_for(found, times);
        if self.kinship.state(own, one)? != trigger {
            return None;
        }
        let partner = self.kinship.state(own, other)?;
        (![found.current, found.next, trigger].contains(&partner)).then_some(partner)
    }

    fn usual(&self, place: usize, times: &Times) -> Option<Usual<'a>> {
        let found = self.found(place);
        let OfRule::Device(entries) = self.instances(place) else { return None };
        let way = (found.current, found.next);
        Usual::of(
            self.group.happenings,
            entries,
            way,
            times.explanation.trigger.as_ref(),
            times.judged(),
        )
    }

    fn instances(&self, place: usize) -> OfRule<'a> {
        self.group.instances.of(self.group.walk, self.rules[place])
    }
}
