//! How long after a candidate a transition happened, over all its instances.

use crate::log::{Nanoseconds, SECOND};
use crate::signal_state::states::{NO_STATE, StateId};

use super::EXPLAINED;
use super::entries::Entry;
use super::happenings::Happenings;

/// One instance of a transition, as its candidates are held against it.
pub(super) struct Wait {
    time: Nanoseconds,
    took: Nanoseconds,
    /// When the same state was entered before, in the same run; else when that began.
    before: Nanoseconds,
}

/// The instances of a transition into `next`.
pub(super) fn waits(index: Happenings<'_>, instances: &[Entry], next: StateId) -> Vec<Wait> {
    let entries = index.entries.of(next);
    let (mut entry, mut run) = (0, 0);
    let wait = |&Entry { time, took, place, .. }: &Entry| {
        let later = |starts: &&Nanoseconds| **starts <= time;
        run += index.run_starts[run..].iter().take_while(later).count();
        entry += entries[entry..].iter().take_while(|other| other.place < place).count();
        let start = run.checked_sub(1).map_or(Nanoseconds::MIN, |run| index.run_starts[run]);
        let before = entry.checked_sub(1).map_or(start, |at| entries[at].time.max(start));
        Wait { time, took, before }
    };
    instances.iter().map(wait).collect()
}

/// Sorted delays of all instances from the later of the states; `None` where more than a few
/// instances came without a fresh one: each occurrence enables a transition once, and only what
/// happens while the device waits enables it. `delays` is room to work in.
pub(super) fn sorted(
    index: Happenings<'_>,
    waits: &[Wait],
    states: [StateId; 2],
    delays: &mut Vec<Nanoseconds>,
) -> Option<Vec<f64>> {
    let enough = EXPLAINED * waits.len() as f64;
    delays.clear();
    let mut candidates = Occurrences::of(index, states);
    for (at, wait) in waits.iter().enumerate() {
        delays.extend(candidates.delay(wait));
        if ((waits.len() - (at + 1 - delays.len())) as f64) < enough {
            return None;
        }
    }
    // Whole numbers sort faster than floats.
    delays.sort_unstable();
    (delays.len() as f64 >= enough).then(|| delays.iter().map(|&delay| seconds(delay)).collect())
}

/// The same of each instance in turn, in seconds; none where there was no fresh one.
pub(super) fn of_each(
    index: Happenings<'_>,
    waits: &[Wait],
    states: [StateId; 2],
) -> Vec<Option<f64>> {
    let mut candidates = Occurrences::of(index, states);
    waits.iter().map(|wait| candidates.delay(wait).map(seconds)).collect()
}

/// Of how many instances a state was entered not exactly once since the one before.
pub(super) fn not_once(index: Happenings<'_>, waits: &[Wait], state: StateId) -> usize {
    let entries = index.entries.of(state);
    let mut passed = 0;
    let is_once = |wait: &&Wait| {
        passed += entries[passed..].iter().take_while(|other| other.time < wait.before).count();
        let since = &entries[passed..];
        let times = since.iter().take_while(|other| other.time <= wait.time).count();
        passed += times;
        times == 1
    };
    waits.len() - waits.iter().filter(is_once).count()
}

/// When the states of a candidate were entered, passed in the order of the instances.
struct Occurrences<'a> {
    entries: [&'a [Entry]; 2],
    /// How many states there are.
    several: usize,
    passed: [usize; 2],
}

impl<'a> Occurrences<'a> {
    fn of(index: Happenings<'a>, states: [StateId; 2]) -> Self {
        let entries =
            states.map(|state| if state == NO_STATE { &[][..] } else { index.entries.of(state) });
        let several = if states[1] == NO_STATE { 1 } else { 2 };
        Self { entries, several, passed: [0; 2] }
    }

    /// Time since the later of the states, where each was entered afresh while the device waited.
    #[inline]
    fn delay(&mut self, wait: &Wait) -> Option<Nanoseconds> {
        let mut latest = Nanoseconds::MIN;
        let mut fresh = true;
        for (entries, passed) in self.entries.iter().zip(&mut self.passed).take(self.several) {
            // The order inside a scan means nothing: all of the same time.
            *passed += entries[*passed..].iter().take_while(|o| o.time <= wait.time).count();
            match passed.checked_sub(1) {
                Some(last) => {
                    fresh &= entries[last].time >= wait.before;
                    latest = latest.max(entries[last].time);
                }
                None => fresh = false,
            }
        }
        (fresh && wait.time - latest <= wait.took).then(|| wait.time - latest)
    }
}

fn seconds(time: Nanoseconds) -> f64 {
    time as f64 / SECOND as f64
}
