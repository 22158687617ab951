//! What states are to sisters: transitions that are called alike but for numbers wait for states
//! that are called alike too, and whose numbers lie as far from theirs.

use std::collections::BTreeSet;

use hashbrown::HashMap;

use crate::log::SignalIndex;
use crate::plant::Plant;
use crate::signal_state::sisters::{numbers, stem};
use crate::signal_state::states::{StateId, States};

use super::walk::{Found, Walk};

/// So many numbers of a state's name may be counted from those of a transition.
const COUNTED_AT_MOST: usize = 3;

/// What a state has in common with those of sisters: the stem of its name, and its value.
type Kin = (u64, i64);

/// What transitions have in common with their sisters.
pub(super) type Family = [Kin; 2];

/// A state as it is to sisters.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Relative {
    kin: Kin,
    numbers: Vec<Number>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Number {
    /// The same to all sisters.
    Fixed(i64),
    /// So far from the transition's own.
    Counted(i64),
}

impl Relative {
    /// True where it is one and the same to all sisters.
    pub(super) fn is_fixed(&self) -> bool {
        self.numbers.iter().all(|number| matches!(number, Number::Fixed(_)))
    }

    /// What its name has in common with those of others.
    pub(super) fn stem(&self) -> u64 {
        self.kin.0
    }
}

/// Who is whose relative in a group.
pub(super) struct Kinship<'a> {
    plant: &'a Plant,
    states: &'a States,
    walk: &'a Walk,
    stems: HashMap<SignalIndex, u64>,
    /// Signals by stem and numbers, as far as they were asked for.
    called: HashMap<(u64, Vec<i64>), SignalIndex>,
}

impl<'a> Kinship<'a> {
    /// In a group that has been walked through.
    pub(super) fn of(plant: &'a Plant, states: &'a States, walk: &'a Walk) -> Self {
        let mut stems = HashMap::new();
        for state in walk.rules.iter().flat_map(|found| [found.current, found.next]) {
            let (signal, _) = states.signal_value(state);
            stems.entry(signal).or_insert_with(|| stem(plant, signal));
        }
        Self { plant, states, walk, stems, called: HashMap::new() }
    }

    /// Makes signals of these stems known by their numbers.
    pub(super) fn call(&mut self, asked: &BTreeSet<u64>) {
        for (&signal, stem) in self.stems.iter().filter(|(_, stem)| asked.contains(*stem)) {
            // Of two with the same numbers, the first: tables have no order.
            let called = self.called.entry((*stem, numbers(self.plant, signal)));
            called.and_modify(|first| *first = signal.min(*first)).or_insert(signal);
        }
    }

    /// The family of a transition.
    pub(super) fn family(&self, found: &Found) -> Option<Family> {
        Some([self.kin(found.current)?.0, self.kin(found.next)?.0])
    }

    /// All that a state may be to the sisters of a transition: its first number is counted from
    /// the transition's, any others may be.
    pub(super) fn relatives(&self, found: &Found, state: StateId) -> Vec<Relative> {
        let Some((kin, signal)) = self.kin(state) else { return Vec::new() };
        let (own, numbers) = (self.own(found), numbers(self.plant, signal));
        let may_count = own.len().min(numbers.len()).min(COUNTED_AT_MOST);
        let all = (0..1u32 << may_count.saturating_sub(1)).map(|further| {
            let number = |(at, &number): (usize, &i64)| {
                let is_counted = at < may_count && (further << 1 | 1) >> at & 1 == 1;
                if is_counted { Number::Counted(number - own[at]) } else { Number::Fixed(number) }
            };
            Relative { kin, numbers: numbers.iter().enumerate().map(number).collect() }
        });
        all.collect()
    }

    /// The state that a relative of sisters is to a transition of these numbers, if it was ever
    /// entered.
    pub(super) fn state(&self, own: &[i64], relative: &Relative) -> Option<StateId> {
        let numbers = relative.numbers.iter().enumerate().map(|(at, number)| match *number {
            Number::Fixed(number) => Some(number),
            Number::Counted(from) => Some(own.get(at)? + from),
        });
        let (stem, value) = relative.kin;
        let signal = *self.called.get(&(stem, numbers.collect::<Option<_>>()?))?;
        let state = self.states.find(signal, value)?;
        (!self.walk.entries.of(state).is_empty()).then_some(state)
    }

    /// The numbers of a transition.
    pub(super) fn own(&self, found: &Found) -> Vec<i64> {
        numbers(self.plant, self.states.signal_value(found.next).0)
    }

    fn kin(&self, state: StateId) -> Option<(Kin, SignalIndex)> {
        let (signal, value) = self.states.signal_value(state);
        Some(((*self.stems.get(&signal)?, value), signal))
    }
}
