//! When each state of a group was entered.

use crate::log::Nanoseconds;
use crate::signal_state::states::StateId;

/// One time a state was entered.
#[derive(Debug, Clone, Copy, Default)]
pub struct Entry {
    /// When.
    pub time: Nanoseconds,
    /// Since the device's own last event.
    pub took: Nanoseconds,
    /// Its place among the group's events.
    pub place: u32,
    /// The transition it ended; [`NO_RULE`] where it ended none.
    pub rule: u32,
}

/// The entry of a state whose device's last event nobody knows.
pub const NO_RULE: u32 = u32::MAX;

/// The entries of each state side by side, in order. Kept from one group to the next: a state
/// belongs to one group only, so what is left of an earlier group is in nobody's way.
#[derive(Debug, Default)]
pub struct Entries {
    entries: Vec<Entry>,
    /// By state.
    ranges: Vec<Range>,
    taken: u32,
}

#[derive(Debug, Clone, Copy)]
struct Range {
    start: u32,
    end: u32,
}

const NOT_ENTERED: Range = Range { start: u32::MAX, end: u32::MAX };

impl Entries {
    /// Room for so many states.
    pub fn new(states: usize) -> Self {
        Self { ranges: vec![NOT_ENTERED; states], ..Self::default() }
    }

    /// Makes room for the entries of a group.
    pub fn begin(&mut self, entries: usize) {
        self.taken = 0;
        if self.entries.len() < entries {
            self.entries.resize(entries, Entry::default());
        }
    }

    /// Takes the next entry of a state that has so many in all.
    #[inline]
    pub fn enter(&mut self, state: StateId, in_all: u32, entry: Entry) {
        let range = &mut self.ranges[state as usize];
        if range.start == NOT_ENTERED.start {
            *range = Range { start: self.taken, end: self.taken };
            self.taken += in_all;
        }
        self.entries[range.end as usize] = entry;
        range.end += 1;
    }

    /// The entries of a state.
    #[inline]
    pub fn of(&self, state: StateId) -> &[Entry] {
        match self.ranges[state as usize] {
            Range { start, .. } if start == NOT_ENTERED.start => &[],
            Range { start, end } => &self.entries[start as usize..end as usize],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Entries, Entry};

    #[test]
    fn states_keep_their_entries_in_order() {
        let entry = |place| Entry { place, ..Entry::default() };
        let mut entries = Entries::new(4);
        for group in [[0, 1], [3, 2]] {
            entries.begin(5);
            let in_order = [(group[0], 3), (group[1], 2), (group[0], 3), (group[1], 2)];
            for ((state, in_all), place) in in_order.into_iter().zip(0..) {
                entries.enter(state, in_all, entry(place));
            }
            entries.enter(group[0], 3, entry(4));
            let places = |state| entries.of(state).iter().map(|e| e.place).collect::<Vec<_>>();
            assert_eq!((places(group[0]), places(group[1])), (vec![0, 2, 4], vec![1, 3]));
        }
        assert!(Entries::new(1).of(0).is_empty());
    }
}
