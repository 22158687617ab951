//! The enabling event of a transition: what it really waits for.
//!
//! Many transitions wait for a neighbour. Measured from the device's own last event their times
//! look random; measured from the event that enables them they are tight. For every transition
//! whose own times are broad we look for the signal-state in its group, or the later of two (a
//! join), whose occurrences best explain when it happens.
//!
//! Near-linear: a sample of the instances looks back over the last few events of the group and
//! votes for the states it meets at a steady distance; only the finalists are measured on all
//! instances. What lies further back in time than those few events is not found. What bears the same
//! time is looked at again when the whole group has had its turn.

mod ballot;
mod delays;
mod election;
mod entries;
mod finalists;
mod happenings;
mod meetings;
mod nominated;
mod partner;
mod seldom;
mod together;
mod window;

pub use entries::{Entries, Entry, NO_RULE};
pub use happenings::{Happening, Happenings};
pub use nominated::better;
pub use seldom::{Joined, Usual, has_odd};
pub use together::{Timed, Together};

use crate::log::Nanoseconds;
use crate::timing::Clusters;
use crate::timing::optimal;

use super::states::{NO_STATE, StateId};

use ballot::Ballot;
use election::Election;
use finalists::finalists;

/// What enables a transition, and how long it then takes.
#[derive(Debug, Clone, PartialEq)]
pub struct Trigger {
    /// The enabling state, and the other one of a join: the delay runs from the later of the two.
    pub states: [StateId; 2],
    /// Delays from the enabling event.
    pub clusters: Clusters,
}

impl Trigger {
    /// The states there are: one, or the two of a join.
    pub fn states(&self) -> impl Iterator<Item = StateId> + '_ {
        self.states.iter().copied().filter(|&state| state != NO_STATE)
    }

    /// How long after it each instance of a transition into `next` happened, in seconds; none where
    /// it came without a fresh one.
    pub fn delays(
        &self,
        index: Happenings<'_>,
        instances: &[Entry],
        next: StateId,
    ) -> Vec<Option<f64>> {
        delays::of_each(index, &delays::waits(index, instances, next), self.states)
    }

    /// Since when the transition was due, its enabling states (of one, twice) having been entered
    /// at two times: the later. `None` where the device was not waiting for it: one of them has not
    /// been entered afresh since the device last did the same (`before`), or the device's own last
    /// event (`own`) is the later.
    #[inline]
    pub fn due(
        one: Nanoseconds,
        other: Nanoseconds,
        before: Nanoseconds,
        own: Nanoseconds,
    ) -> Option<Nanoseconds> {
        let (older, later) = (one.min(other), one.max(other));
        (older >= before && older != Nanoseconds::MIN && later >= own).then_some(later)
    }
}

/// Fewer instances say nothing about what enables a transition.
const INSTANCES_AT_LEAST: usize = 8;
/// A first screening by so few voters spares most transitions the full vote: some state must be
/// met by so many of them at a steady distance.
const SCREENERS: usize = 8;
const SCREENED: usize = 3;
/// A trigger must explain this share of the voters.
const EXPLAINED: f64 = 0.9;
/// Finalists measured on all instances, of single triggers and of joins.
const FINALISTS: usize = 6;
/// A trigger must leave no more than this share of the own spread.
const GAIN: f64 = 0.5;
/// Steps (of the natural logarithm of the spread) by which several distances must beat one.
const SEVERAL: f64 = 2.0;
/// Own times spreading less than this many resolutions, or this share of the time, are tight.
const TIGHT_RESOLUTIONS: f64 = 5.0;
const TIGHT_SHARE: f64 = 0.0001;
/// Delays that agree within this are steady, at the most.
const STEADY_AT_MOST_S: f64 = 1.0;
/// Share of each tail of delays that may be outliers.
const OUTLIERS: f64 = 0.01;

/// States that explain when a transition happens, and its delays from the later of them, sorted, in
/// seconds.
#[derive(Debug)]
pub struct Delayed {
    /// The enabling state, and the other one of a join.
    pub states: [StateId; 2],
    /// One at least.
    pub delays: Vec<f64>,
}

/// How well it is known what a transition waits for.
#[derive(Debug)]
pub struct Explanation {
    /// What its device's own last event leaves unexplained of its times, in seconds.
    pub own_s: f64,
    /// The same of what it waits for; where nothing was found, of the own last event.
    pub left_s: f64,
    /// How long it usually takes from there, in seconds.
    pub usual_s: f64,
    /// Share of its instances that take just that.
    pub exact: f64,
    /// Share of its instances that take no time at all.
    pub at_once: f64,
    /// What it waits for.
    pub trigger: Option<Trigger>,
}

impl Explanation {
    /// Too few instances to say anything.
    pub const NONE: Self = Self {
        own_s: f64::INFINITY,
        left_s: f64::INFINITY,
        usual_s: 0.0,
        exact: 0.0,
        at_once: 0.0,
        trigger: None,
    };

    /// By these sorted delays.
    fn of(delays: &[f64], own_s: Option<f64>, resolution_s: f64) -> Self {
        let usual_s = delays[delays.len() / 2];
        let below =
            |end: f64| delays.partition_point(|&delay| delay < end) as f64 / delays.len() as f64;
        let half = 0.5 * resolution_s;
        let left_s = residual_spread(delays);
        Self {
            own_s: own_s.unwrap_or(left_s),
            left_s,
            usual_s,
            exact: below(usual_s + half) - below(usual_s - half),
            at_once: below(resolution_s + half),
            trigger: None,
        }
    }

    /// By what the transition waits for instead.
    pub fn or_waits_for(self, found: Delayed, resolution_s: f64) -> Self {
        let Delayed { states, delays } = found;
        let clusters = optimal::cluster(&delays, resolution_s).into();
        let trigger = Some(Trigger { states, clusters });
        Self { trigger, ..Self::of(&delays, Some(self.own_s), resolution_s) }
    }
}

/// Looks for enabling events.
pub struct Search {
    ballot: Ballot,
}

impl Search {
    /// A search in the groups of a plant of so many states, one of several that may go on at a
    /// time.
    pub fn new(states: usize) -> Self {
        Self { ballot: Ballot::new(states) }
    }

    /// The enabling event of a transition from `current` to `next`, the two of `states`, in its
    /// group's happenings. `sorted` is how long its instances took since the device's own last
    /// event, by size, in seconds. No trigger where nothing explains it better than that event.
    pub fn explain(
        &mut self,
        index: Happenings<'_>,
        instances: &[Entry],
        sorted: &[f64],
        states: (StateId, StateId),
    ) -> Explanation {
        if instances.len() < INSTANCES_AT_LEAST {
            return Explanation::NONE;
        }
        let by_itself = Explanation::of(sorted, None, index.resolution_s);
        let own_s = by_itself.own_s;
        if is_tight(own_s, by_itself.usual_s, index.resolution_s) {
            return by_itself;
        }
        match self.trigger(index, instances, own_s, states) {
            Some(found) => by_itself.or_waits_for(found, index.resolution_s),
            None => by_itself,
        }
    }

    /// The states that explain a transition best.
    fn trigger(
        &mut self,
        index: Happenings<'_>,
        instances: &[Entry],
        own_spread: f64,
        (current, next): (StateId, StateId),
    ) -> Option<Delayed> {
        let tight = TIGHT_RESOLUTIONS * index.resolution_s;
        let steady = (own_spread / 8.0).clamp(tight, STEADY_AT_MOST_S.max(tight));
        let close = 2.0 * tight;
        let election = Election { instances, current, next, steady, close };
        if !self.ballot.promises(index, &election, (SCREENERS, SCREENED)) {
            return None;
        }
        self.ballot.complete(index, &election, SCREENERS);
        let finalists = finalists(&mut self.ballot, index, &election);
        let waits = delays::waits(index, instances, next);
        let mut room = Vec::with_capacity(waits.len());
        let best = finalists
            .into_iter()
            .filter_map(|states| {
                let delays = delays::sorted(index, &waits, states, &mut room)?;
                let spread = residual_spread(&delays);
                (spread <= GAIN * own_spread).then_some((spread, delays, states))
            })
            // Several distances must explain far better than one; and the shorter delay stands
            // nearer to the cause where two explain equally well.
            .min_by(|a, b| {
                let rank = |(spread, delays, _): &(f64, Vec<f64>, _)| {
                    let n = delays.len();
                    let several = delays[n - 1 - n / 20] - delays[n / 20] > steady;
                    let left = (spread.max(index.resolution_s) / index.resolution_s).ln().round();
                    (left + if several { SEVERAL } else { 0.0 }) * 1e6 + delays[n / 2]
                };
                rank(a).total_cmp(&rank(b))
            })?;
        let (_, delays, states) = best;
        let joined = partner::found(&mut self.ballot, index, &election, &waits, states);
        Some(joined.unwrap_or(Delayed { states, delays }))
    }
}

/// Whether own times that spread so far, and usually take so long, leave nothing to explain.
fn is_tight(own_s: f64, usual_s: f64, resolution_s: f64) -> bool {
    own_s <= (TIGHT_RESOLUTIONS * resolution_s).max(TIGHT_SHARE * usual_s)
}

/// Range of sorted times without a few outliers and without the two widest gaps: what up to three
/// steady times leave unexplained.
fn residual_spread(sorted: &[f64]) -> f64 {
    let cut = (OUTLIERS * sorted.len() as f64).round() as usize;
    let kept = &sorted[cut..sorted.len() - cut];
    let (Some(first), Some(last)) = (kept.first(), kept.last()) else {
        return 0.0;
    };
    let (mut widest, mut second) = (0.0, 0.0);
    for pair in kept.windows(2) {
        let gap = pair[1] - pair[0];
        if gap > widest {
            (widest, second) = (gap, widest);
        } else if gap > second {
            second = gap;
        }
    }
    last - first - widest - second
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_steady_times_leave_little() {
        let times = [1.0, 1.01, 1.02, 5.0, 5.01, 9.0, 9.02];
        assert!((residual_spread(&times) - 0.05).abs() < 1e-9);
    }
}
