//! The enabling event of a transition: what it really waits for.
//!
//! Many transitions wait for a neighbour. Measured from the device's own last event their times
//! look random; measured from the event that enables them they are tight. For every transition
//! whose own times are broad we look for the signal-state in its group, or the later of two (a
//! join), whose occurrences best explain when it happens.
//!
//! Near-linear: a sample of the instances looks back over the last few events of the group and
//! votes for the states it meets at a steady distance; only the finalists are measured on all
//! instances. What lies further back in time than those few events is not found.

use crate::log::{Nanoseconds, SECOND};
use crate::plant::{Plant, SignalClass};
use crate::timing::TimeCluster;
use crate::timing::optimal;

use super::states::{NO_STATE, StateId, States};

/// What enables a transition, and how long it then takes.
#[derive(Debug, Clone, PartialEq)]
pub struct Trigger {
    /// The enabling state, and the other one of a join: the delay runs from the later of the two.
    pub states: [StateId; 2],
    /// Delays from the enabling event.
    pub clusters: Vec<TimeCluster>,
}

impl Trigger {
    /// The states there are: one, or the two of a join.
    pub fn states(&self) -> impl Iterator<Item = StateId> + '_ {
        self.states.iter().copied().filter(|&state| state != NO_STATE)
    }
}

/// Fewer instances say nothing about what enables a transition.
const INSTANCES_AT_LEAST: usize = 8;
/// Instances that vote; one bit each.
const VOTERS: usize = 64;
/// Events of the group a voter looks back over.
const LOOK_BACK: usize = 96;
/// A trigger must explain this share of the voters.
const EXPLAINED: f64 = 0.9;
/// Each partner of a join must explain at least this share alone.
const PARTNER: f64 = 0.08;
/// Finalists measured on all instances, of single triggers and of joins.
const FINALISTS: usize = 6;
/// A trigger must leave no more than this share of the own spread.
const GAIN: f64 = 0.5;
/// Own times spreading less than this many resolutions, or this share of the time, are tight.
const TIGHT_RESOLUTIONS: f64 = 5.0;
const TIGHT_SHARE: f64 = 0.01;
/// Delays that agree within this are steady, at the most.
const STEADY_AT_MOST_S: f64 = 1.0;
/// Share of each tail of delays that may be outliers.
const OUTLIERS: f64 = 0.01;

/// One event as the search sees it.
#[derive(Debug, Clone, Copy)]
pub struct Happening {
    /// When.
    pub time: Nanoseconds,
    /// The state entered.
    pub state: StateId,
    /// Group of its device.
    pub group: u32,
    /// Run it belongs to: logs and the stretches between gaps.
    pub run: u32,
}

/// Looks for enabling events in learned happenings.
pub struct Search<'a> {
    happenings: &'a [Happening],
    plant: &'a Plant,
    states: &'a States,
    resolution_s: f64,
    /// Happenings of each group, and the place of each happening in its group.
    by_group: Vec<Vec<u32>>,
    place: Vec<u32>,
    /// Happenings of each state.
    by_state: Vec<Vec<u32>>,
    seen_by: Vec<u32>,
    voter_delays: Vec<Vec<(u8, f64)>>,
}

/// A candidate after the vote.
struct Candidate {
    state: StateId,
    /// Voters that met it at a steady distance.
    mask: u64,
    /// Spread of those distances, in seconds.
    spread: f64,
}

impl<'a> Search<'a> {
    /// Indexes the happenings of a plant.
    pub fn new(
        happenings: &'a [Happening],
        plant: &'a Plant,
        states: &'a States,
        resolution: Nanoseconds,
    ) -> Self {
        let mut by_group = vec![Vec::new(); plant.groups.len()];
        let mut by_state = vec![Vec::new(); states.len()];
        let mut place = Vec::with_capacity(happenings.len());
        for (index, happening) in (0..).zip(happenings) {
            let group: &mut Vec<u32> = &mut by_group[happening.group as usize];
            place.push(group.len() as u32);
            group.push(index);
            by_state[happening.state as usize].push(index);
        }
        Self {
            happenings,
            plant,
            states,
            resolution_s: resolution as f64 / SECOND as f64,
            by_group,
            place,
            by_state,
            seen_by: vec![u32::MAX; states.len()],
            voter_delays: vec![Vec::new(); states.len()],
        }
    }

    /// The enabling event of a transition into `next`, whose instances are the happenings
    /// `instances` (ascending) and took `own_s` since the device's own last event; `current` is
    /// that event's state. `None` where nothing explains it better than the own event.
    pub fn trigger(
        &mut self,
        instances: &[u32],
        own_s: &[f64],
        (current, next): (StateId, StateId),
    ) -> Option<Trigger> {
        if instances.len() < INSTANCES_AT_LEAST {
            return None;
        }
        let mut sorted = own_s.to_vec();
        sorted.sort_unstable_by(f64::total_cmp);
        let own_spread = residual_spread(&sorted);
        let tight = TIGHT_RESOLUTIONS * self.resolution_s;
        if own_spread <= tight.max(TIGHT_SHARE * sorted[sorted.len() / 2]) {
            return None;
        }
        let steady = (own_spread / 8.0).clamp(tight, STEADY_AT_MOST_S.max(tight));
        let candidates = self.vote(instances, own_s, (current, next), steady);
        let voters = instances.len().min(VOTERS);
        let finalists = finalists(&candidates, voters);
        finalists
            .into_iter()
            .filter_map(|states| {
                let delays = self.delays(instances, own_s, states, next)?;
                let spread = residual_spread(&delays);
                (spread <= GAIN * own_spread).then_some((spread, delays, states))
            })
            // The shorter delay stands nearer to the cause where two explain equally well.
            .min_by(|a, b| {
                let rank = |(spread, delays, _): &(f64, Vec<f64>, _)| {
                    (spread.max(self.resolution_s) / self.resolution_s).ln().round() * 1e6
                        + delays[delays.len() / 2]
                };
                rank(a).total_cmp(&rank(b))
            })
            .map(|(_, delays, states)| Trigger {
                states,
                clusters: optimal::cluster(&delays, self.resolution_s),
            })
    }

    /// Lets a sample of the instances look back; the own last event always stands for election.
    fn vote(
        &mut self,
        instances: &[u32],
        own_s: &[f64],
        (current, next): (StateId, StateId),
        steady: f64,
    ) -> Vec<Candidate> {
        let voters = instances.len().min(VOTERS);
        let mut met: Vec<StateId> = vec![current];
        for voter in 0..voters {
            let instance = voter * instances.len() / voters;
            let index = instances[instance];
            let here = self.happenings[index as usize];
            let group = &self.by_group[here.group as usize];
            let place = self.place[index as usize] as usize;
            // A happening belongs to one transition of one device, so it stamps uniquely.
            let stamp = index;
            self.seen_by[current as usize] = stamp;
            self.voter_delays[current as usize].push((voter as u8, own_s[instance]));
            let mut visit = |other: Happening| {
                if other.state != next && self.seen_by[other.state as usize] != stamp {
                    self.seen_by[other.state as usize] = stamp;
                    let delays = &mut self.voter_delays[other.state as usize];
                    if delays.is_empty() {
                        met.push(other.state);
                    }
                    delays.push((voter as u8, seconds(here.time - other.time)));
                }
            };
            // Of the same time, but later in the file: the order inside a scan means nothing.
            for &later in &group[place + 1..] {
                let other = self.happenings[later as usize];
                if other.time != here.time {
                    break;
                }
                visit(other);
            }
            for &earlier in group[..place].iter().rev().take(LOOK_BACK) {
                let other = self.happenings[earlier as usize];
                if other.run != here.run {
                    break;
                }
                visit(other);
            }
        }
        let mut candidates = Vec::new();
        for state in met {
            let mut delays = std::mem::take(&mut self.voter_delays[state as usize]);
            if self.may_enable(state, next, &delays) {
                delays.sort_unstable_by(|a, b| a.1.total_cmp(&b.1));
                candidates.extend(densest(&delays, steady).map(|(mask, spread)| Candidate {
                    state,
                    mask,
                    spread,
                }));
            }
            delays.clear();
            self.voter_delays[state as usize] = delays;
        }
        let least = (PARTNER * voters as f64).ceil() as u32;
        candidates.retain(|c| c.mask.count_ones() >= least || c.state == current);
        candidates
    }

    /// An event of the same instant may be the cause of ours only where an input enables an
    /// output; otherwise it may as well be its effect.
    fn may_enable(&self, state: StateId, next: StateId, delays: &[(u8, f64)]) -> bool {
        let class = |state| {
            let (signal, _) = self.states.signal_value(state);
            self.plant.signals[signal as usize].class
        };
        let together = delays.iter().filter(|(_, delay)| *delay <= 0.0).count();
        together * 5 <= delays.len()
            || (class(state) != SignalClass::Output && class(next) == SignalClass::Output)
    }

    /// Sorted delays of all instances from the later of the states; `None` where more than a few
    /// instances came without a fresh one: each occurrence enables a transition once, and only
    /// what happens while the device waits enables it.
    fn delays(
        &self,
        instances: &[u32],
        own_s: &[f64],
        states: [StateId; 2],
        next: StateId,
    ) -> Option<Vec<f64>> {
        let mut delays: Vec<f64> = Vec::with_capacity(instances.len());
        let mut cursors = [0usize; 2];
        let entries = &self.by_state[next as usize];
        let mut entry = 0;
        for (&index, &own) in instances.iter().zip(own_s) {
            let here = self.happenings[index as usize];
            entry += entries[entry..].partition_point(|&other| other < index);
            let before = entry.checked_sub(1).map(|at| self.happenings[entries[at] as usize]);
            let before = before.filter(|b| b.run == here.run).map(|b| b.time);
            let mut latest: Option<Nanoseconds> = None;
            let mut fresh = true;
            for (state, cursor) in states.iter().zip(&mut cursors) {
                if *state == NO_STATE {
                    continue;
                }
                let occurrences = &self.by_state[*state as usize];
                let reached = |other: &u32| {
                    let other = self.happenings[*other as usize];
                    other.run < here.run || (other.run == here.run && other.time <= here.time)
                };
                *cursor += occurrences[*cursor..].iter().take_while(|o| reached(o)).count();
                let last =
                    cursor.checked_sub(1).map(|at| self.happenings[occurrences[at] as usize]);
                let time = last.filter(|l| l.run == here.run).map(|l| l.time);
                fresh &= time.is_some() && time >= before;
                latest = latest.max(time);
            }
            let delay = latest.filter(|_| fresh).map(|time| seconds(here.time - time));
            delays.extend(delay.filter(|&delay| delay <= own));
        }
        delays.sort_unstable_by(f64::total_cmp);
        (delays.len() as f64 >= EXPLAINED * instances.len() as f64).then_some(delays)
    }
}

fn seconds(time: Nanoseconds) -> f64 {
    time as f64 / SECOND as f64
}

/// The window of width `steady` that holds most of the sorted delays: its voters and spread.
fn densest(delays: &[(u8, f64)], steady: f64) -> Option<(u64, f64)> {
    let mut best: Option<(usize, usize)> = None;
    let mut start = 0;
    for end in 0..delays.len() {
        while delays[end].1 - delays[start].1 > steady {
            start += 1;
        }
        if best.is_none_or(|(s, e)| end - start > e - s) {
            best = Some((start, end));
        }
    }
    best.map(|(start, end)| {
        let mask = delays[start..=end].iter().fold(0u64, |mask, (voter, _)| mask | 1 << voter);
        (mask, delays[end].1 - delays[start].1)
    })
}

/// The most promising single triggers and joins.
fn finalists(candidates: &[Candidate], voters: usize) -> Vec<[StateId; 2]> {
    let needed = (EXPLAINED * voters as f64).ceil() as u32;
    let mut singles: Vec<&Candidate> =
        candidates.iter().filter(|c| c.mask.count_ones() >= needed).collect();
    singles.sort_by(|a, b| a.spread.total_cmp(&b.spread));
    let mut finalists: Vec<[StateId; 2]> =
        singles.iter().take(FINALISTS).map(|c| [c.state, NO_STATE]).collect();
    let mut partners: Vec<&Candidate> = candidates.iter().collect();
    partners.sort_by_key(|c| std::cmp::Reverse(c.mask.count_ones()));
    partners.truncate(24);
    let mut joins: Vec<(f64, [StateId; 2])> = Vec::new();
    for (at, one) in partners.iter().enumerate() {
        for other in &partners[at + 1..] {
            let together = (one.mask | other.mask).count_ones();
            let alone = one.mask.count_ones().max(other.mask.count_ones());
            if together >= needed && alone < needed {
                joins.push((one.spread.max(other.spread), [one.state, other.state]));
            }
        }
    }
    joins.sort_by(|a, b| a.0.total_cmp(&b.0));
    finalists.extend(joins.into_iter().take(FINALISTS).map(|(_, states)| states));
    finalists
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

    #[test]
    fn the_densest_window_names_its_voters() {
        let delays = [(3, 0.1), (0, 0.11), (2, 0.12), (1, 7.0)];
        let (mask, spread) = densest(&delays, 0.05).unwrap_or_default();
        assert_eq!(mask, 0b1101);
        assert!((spread - 0.02).abs() < 1e-9);
    }
}
