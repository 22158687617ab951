//! What sisters wait for: a partner that a transition hardly ever had to wait for is known from
//! others that are called alike but for numbers.
//!
//! `St4Conv` runs when its clamp is open and `St5Conv` has stopped, and `St5Conv` when its own is
//! and `St6Conv` has. Then `St3Conv` waits for `St4Conv`, though that has always been the earlier.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use crate::log::SignalIndex;
use crate::plant::Plant;
use crate::signal_state::enabling::{Happenings, Joined, Trigger, Usual, has_odd};
use crate::signal_state::sisters;
use crate::signal_state::states::{NO_STATE, StateId, States};

use super::instances::{Instances, OfRule};
use super::timing::Times;
use super::walk::{Found, Walk};

/// So many sisters must have a partner that the transition itself shows nothing of, and so many
/// for each that has another, or that contradicts.
const SISTERS_AT_LEAST: usize = 2;
const SISTERS_PER_STRANGER: usize = 4;
/// So many numbers of a partner's name may be counted from the transition's own.
const COUNTED_AT_MOST: usize = 3;

/// A group that has been walked through.
pub(super) struct Group<'a> {
    pub(super) walk: &'a Walk,
    pub(super) instances: &'a Instances,
    pub(super) happenings: Happenings<'a>,
    pub(super) plant: &'a Plant,
    pub(super) states: &'a States,
}

/// A state, called by what sisters have in common.
type Kin = (u64, i64);

/// Sisters: where they lead from and to, and what they wait for.
type Family = [Kin; 3];

/// A state as sisters have it: its numbers as they are, or counted from the transition's.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
struct Member {
    kin: Kin,
    numbers: Vec<Number>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Number {
    Fixed(i64),
    Counted(i64),
}

/// A trigger and its partner as sisters have them.
type Pair = [Member; 2];

/// What is known of a family: how many sisters have a partner, and how many each pair.
#[derive(Default)]
struct Known {
    sisters: usize,
    have: BTreeMap<Pair, usize>,
}

/// A partner that a transition does not contradict.
struct Offer {
    have: usize,
    place: usize,
    state: StateId,
    trigger: Trigger,
}

/// Gives transitions the partners that their sisters have: `times` are those of `rules`.
pub(super) fn take_over(group: &Group<'_>, rules: &[usize], times: &mut [Times]) {
    if !times.iter().any(|times| pair(times).is_some()) {
        return;
    }
    let names = Names::of(group);
    let mut families = BTreeMap::<Family, Known>::new();
    for (&rule, times) in rules.iter().zip(&*times) {
        let Some([one, other]) = pair(times) else { continue };
        let found = &group.walk.rules[rule];
        for pair in [[one, other], [other, one]] {
            let Some(family) = names.family(found, pair[0]) else { continue };
            families.entry(family).or_default().learn(names.pairs(found, pair));
        }
    }
    let mut open = BTreeMap::<Family, Vec<usize>>::new();
    for (place, (&rule, times)) in rules.iter().zip(&*times).enumerate() {
        let family = alone(&group.walk.rules[rule], times)
            .and_then(|trigger| names.family(&group.walk.rules[rule], trigger))
            .filter(|family| families.contains_key(family));
        if let Some(family) = family {
            open.entry(family).or_default().push(place);
        }
    }
    for (family, mut open) in open {
        let Some(known) = families.get_mut(&family) else { continue };
        open.retain(|&place| {
            let found = &group.walk.rules[rules[place]];
            let shown = group.shown(&names, known, rules[place], &times[place]);
            let is_open = shown.is_none();
            if let Some(trigger) = shown {
                known.learn(names.pairs(found, trigger.states));
                times[place].trigger = Some(trigger);
            }
            is_open
        });
        for Offer { place, trigger, .. } in group.offers(&names, known, rules, &open, times) {
            times[place].trigger = Some(trigger);
        }
    }
}

/// The two of a join.
fn pair(times: &Times) -> Option<[StateId; 2]> {
    times.trigger.as_ref().map(|trigger| trigger.states).filter(|states| states[1] != NO_STATE)
}

/// What a transition without a partner waits for.
fn alone(found: &Found, times: &Times) -> Option<StateId> {
    let [trigger, partner] =
        times.trigger.as_ref().map_or([found.current, NO_STATE], |trigger| trigger.states);
    (partner == NO_STATE).then_some(trigger)
}

impl Known {
    fn learn(&mut self, pairs: Vec<Pair>) {
        self.sisters += 1;
        for pair in pairs {
            *self.have.entry(pair).or_default() += 1;
        }
    }
}

impl<'a> Group<'a> {
    fn usual(&self, rule: usize, times: &Times) -> Option<Usual<'a>> {
        let found = &self.walk.rules[rule];
        let OfRule::Device(entries) = self.instances.of(self.walk, rule) else { return None };
        let way = (found.current, found.next);
        Usual::of(self.happenings, entries, way, times.trigger.as_ref(), times.judged())
    }

    /// A partner of some sister that odd instances of a transition show.
    fn shown(&self, names: &Names, known: &Known, rule: usize, times: &Times) -> Option<Trigger> {
        if !has_odd(times.judged(), self.happenings.resolution_s) {
            return None;
        }
        let found = &self.walk.rules[rule];
        let usual = self.usual(rule, times)?;
        let met = usual.met_by_odd();
        let alone = alone(found, times)?;
        let states = known.have.keys().filter_map(|pair| names.partner(self, found, alone, pair));
        let states: BTreeSet<StateId> = states.filter(|state| met.contains_key(state)).collect();
        let joined = states.into_iter().map(|state| usual.joined(state)).filter(Joined::is_shown);
        let best = joined.min_by(Joined::by_merit)?;
        Some(usual.with(best))
    }

    /// Partners that enough sisters have, for those of the `open` transitions that show nothing.
    fn offers(
        &self,
        names: &Names,
        known: &Known,
        rules: &[usize],
        open: &[usize],
        times: &[Times],
    ) -> Vec<Offer> {
        let mut offers = BTreeMap::<usize, Vec<Offer>>::new();
        let is_common = |have: usize, strangers: usize| {
            have >= SISTERS_AT_LEAST && have >= SISTERS_PER_STRANGER * strangers
        };
        for (pair, &have) in &known.have {
            let mut strangers = known.sisters - have;
            // Where sisters share one and the same, there is no telling who else does.
            if !is_common(have, strangers) || pair[1].is_fixed() {
                continue;
            }
            let mut fit = Vec::new();
            for &place in open {
                let found = &self.walk.rules[rules[place]];
                let state = alone(found, &times[place])
                    .and_then(|alone| names.partner(self, found, alone, pair));
                let Some(state) = state else { continue };
                let Some(usual) = self.usual(rules[place], &times[place]) else { continue };
                let joined = usual.joined(state);
                if joined.is_sound() {
                    fit.push(Offer { have, place, state, trigger: usual.with(joined) });
                } else {
                    strangers += 1;
                }
            }
            if is_common(have, strangers) {
                for offer in fit {
                    offers.entry(offer.place).or_default().push(offer);
                }
            }
        }
        let clearest = |mut of_one: Vec<Offer>| {
            let most = of_one.iter().map(|offer| offer.have).max()?;
            of_one.retain(|offer| offer.have == most);
            // Two of equal right are none.
            of_one.dedup_by_key(|offer| offer.state);
            (of_one.len() == 1).then(|| of_one.pop()).flatten()
        };
        offers.into_values().filter_map(clearest).collect()
    }
}

/// What the signals of a group are called.
struct Names {
    of_signal: HashMap<SignalIndex, (u64, Vec<i64>)>,
    called: HashMap<(u64, Vec<i64>), SignalIndex>,
    /// By state of the group.
    signal_value: HashMap<StateId, (SignalIndex, i64)>,
}

impl Names {
    fn of(group: &Group<'_>) -> Self {
        let mut names = Self {
            of_signal: HashMap::new(),
            called: HashMap::new(),
            signal_value: HashMap::new(),
        };
        for state in group.walk.rules.iter().flat_map(|found| [found.current, found.next]) {
            let (signal, value) = group.states.signal_value(state);
            names.signal_value.insert(state, (signal, value));
            if !names.of_signal.contains_key(&signal) {
                let name =
                    (sisters::stem(group.plant, signal), sisters::numbers(group.plant, signal));
                names.called.insert(name.clone(), signal);
                names.of_signal.insert(signal, name);
            }
        }
        names
    }

    fn kin(&self, state: StateId) -> Option<(Kin, &[i64])> {
        let &(signal, value) = self.signal_value.get(&state)?;
        let (stem, numbers) = self.of_signal.get(&signal)?;
        Some(((*stem, value), numbers))
    }

    fn family(&self, found: &Found, trigger: StateId) -> Option<Family> {
        let [current, next, trigger] =
            [found.current, found.next, trigger].map(|state| Some(self.kin(state)?.0));
        Some([current?, next?, trigger?])
    }

    /// All that a trigger and its partner may be to sisters.
    fn pairs(&self, found: &Found, [trigger, partner]: [StateId; 2]) -> Vec<Pair> {
        let partners = self.members(found, partner);
        let with = |trigger: Member| partners.iter().map(move |p| [trigger.clone(), p.clone()]);
        self.members(found, trigger).into_iter().flat_map(with).collect()
    }

    fn members(&self, found: &Found, state: StateId) -> Vec<Member> {
        let (Some((_, own)), Some((kin, numbers))) = (self.kin(found.next), self.kin(state)) else {
            return Vec::new();
        };
        let may_count = own.len().min(numbers.len()).min(COUNTED_AT_MOST);
        let all = (0..1u32 << may_count).map(|counted| {
            let number = |(at, &number): (usize, &i64)| {
                let is_counted = at < may_count && counted >> at & 1 == 1;
                if is_counted { Number::Counted(number - own[at]) } else { Number::Fixed(number) }
            };
            Member { kin, numbers: numbers.iter().enumerate().map(number).collect() }
        });
        all.collect()
    }

    /// The partner in a pair of sisters, as it is to a transition that waits `alone` for its
    /// trigger; `None` where there is none.
    fn partner(
        &self,
        group: &Group<'_>,
        found: &Found,
        alone: StateId,
        [trigger, partner]: &Pair,
    ) -> Option<StateId> {
        if self.state(group, found, trigger)? != alone {
            return None;
        }
        let state = self.state(group, found, partner)?;
        (![found.current, found.next, alone].contains(&state)).then_some(state)
    }

    /// A state of sisters as it is to a transition.
    fn state(&self, group: &Group<'_>, found: &Found, member: &Member) -> Option<StateId> {
        let (_, own) = self.kin(found.next)?;
        let numbers = member.numbers.iter().enumerate().map(|(at, number)| match *number {
            Number::Fixed(number) => Some(number),
            Number::Counted(from) => Some(own.get(at)? + from),
        });
        let (stem, value) = member.kin;
        let signal = *self.called.get(&(stem, numbers.collect::<Option<_>>()?))?;
        let state = group.states.find(signal, value)?;
        self.signal_value.contains_key(&state).then_some(state)
    }
}

impl Member {
    fn is_fixed(&self) -> bool {
        self.numbers.iter().all(|number| matches!(number, Number::Fixed(_)))
    }
}
