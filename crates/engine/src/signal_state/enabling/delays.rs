//! How long after a candidate a transition happened, over all its instances.

use crate::log::{Nanoseconds, SECOND};
use crate::signal_state::states::{NO_STATE, StateId};

use super::EXPLAINED;
use super::happenings::Happenings;

/// Instances whose happenings are fetched ahead of their turn.
const TOUCHED: usize = 16;

/// One instance of a transition, as its candidates are held against it.
pub(super) struct Wait {
    time: Nanoseconds,
    own_s: f64,
    /// The last happening of the same time: what is later came after it.
    reached: u32,
    /// The first happening of its run.
    start: u32,
    /// When the same state was entered before, in the same run.
    before: Nanoseconds,
}

/// The instances (ascending) of a transition into `next`, which took `own_s` each.
pub(super) fn waits(
    index: &Happenings<'_>,
    instances: &[u32],
    own_s: &[f64],
    next: StateId,
) -> Vec<Wait> {
    let (entries, times) = index.entries(next);
    let mut entry = 0;
    let wait = |(at, (&instance, &own_s)): (usize, (&u32, &f64))| {
        if at % TOUCHED == 0 {
            let ahead = &instances[at..instances.len().min(at + TOUCHED)];
            let times = ahead.iter().map(|&instance| index.happenings[instance as usize].time);
            std::hint::black_box(times.fold(0, |touched, time| touched ^ time));
        }
        let here = index.happenings[instance as usize];
        // Happenings are in order: all of the same time, and none that are later.
        let together = index.happenings[instance as usize + 1..]
            .iter()
            .take_while(|other| other.time == here.time && other.run == here.run)
            .count();
        let start = index.start_of(here.run);
        entry += entries[entry..].iter().take_while(|&&other| other < instance).count();
        let before = entry.checked_sub(1).filter(|&at| entries[at] >= start);
        Wait {
            time: here.time,
            own_s,
            reached: instance + together as u32,
            start,
            before: before.map_or(Nanoseconds::MIN, |at| times[at]),
        }
    };
    instances.iter().zip(own_s).enumerate().map(wait).collect()
}

/// Sorted delays of all instances from the later of the states; `None` where more than a few
/// instances came without a fresh one: each occurrence enables a transition once, and only what
/// happens while the device waits enables it.
pub(super) fn sorted(
    index: &Happenings<'_>,
    waits: &[Wait],
    states: [StateId; 2],
) -> Option<Vec<f64>> {
    let enough = EXPLAINED * waits.len() as f64;
    let mut delays: Vec<Nanoseconds> = Vec::with_capacity(waits.len());
    let mut candidates = Occurrences::of(index, states);
    for (at, wait) in waits.iter().enumerate() {
        delays.extend(candidates.delay(wait));
        if ((waits.len() - (at + 1 - delays.len())) as f64) < enough {
            return None;
        }
    }
    // Whole numbers sort faster than floats.
    delays.sort_unstable();
    (delays.len() as f64 >= enough).then(|| delays.into_iter().map(seconds).collect())
}

/// The same of each instance in turn, in seconds; infinite where there was no fresh one.
pub(super) fn of_each(index: &Happenings<'_>, waits: &[Wait], state: StateId) -> Vec<f64> {
    let mut candidate = Occurrences::of(index, [state, NO_STATE]);
    waits.iter().map(|wait| candidate.delay(wait).map_or(f64::INFINITY, seconds)).collect()
}

/// When the states of a candidate were entered, passed in the order of the instances.
struct Occurrences<'a> {
    entries: [(&'a [u32], &'a [Nanoseconds]); 2],
    /// How many states there are.
    several: usize,
    passed: [usize; 2],
}

impl<'a> Occurrences<'a> {
    fn of(index: &'a Happenings<'_>, states: [StateId; 2]) -> Self {
        let entries = states
            .map(|state| if state == NO_STATE { (&[][..], &[][..]) } else { index.entries(state) });
        let several = if states[1] == NO_STATE { 1 } else { 2 };
        Self { entries, several, passed: [0; 2] }
    }

    /// Time since the later of the states, where each was entered afresh while the device waited.
    #[inline]
    fn delay(&mut self, wait: &Wait) -> Option<Nanoseconds> {
        let mut latest = Nanoseconds::MIN;
        let mut fresh = true;
        for ((entries, times), passed) in
            self.entries.iter().zip(&mut self.passed).take(self.several)
        {
            *passed += entries[*passed..].iter().take_while(|&&o| o <= wait.reached).count();
            match passed.checked_sub(1).filter(|&last| entries[last] >= wait.start) {
                Some(last) => {
                    fresh &= times[last] >= wait.before;
                    latest = latest.max(times[last]);
                }
                None => fresh = false,
            }
        }
        (fresh && seconds(wait.time - latest) <= wait.own_s).then(|| wait.time - latest)
    }
}

fn seconds(time: Nanoseconds) -> f64 {
    time as f64 / SECOND as f64
}
