//! The voters that met a state, and how long ago: whether, and where, their distances agree.

use crate::log::SECOND;

use super::window;

/// Instances that vote; one bit each.
pub(super) const VOTERS: usize = 32;
const VOTER_BITS: u32 = VOTERS.ilog2();

/// Voters that met a state at nearly one distance, one bit each, and the least and greatest of
/// those distances in nanoseconds.
#[derive(Clone, Copy, Default)]
pub(super) struct Window {
    pub(super) voters: u32,
    pub(super) least: u64,
    pub(super) greatest: u64,
}

impl Window {
    /// How many voters.
    pub(super) fn votes(&self) -> u32 {
        self.voters.count_ones()
    }

    /// Both together.
    pub(super) fn and(&self, other: &Self) -> Self {
        Self {
            voters: self.voters | other.voters,
            least: self.least.min(other.least),
            greatest: self.greatest.max(other.greatest),
        }
    }

    /// The ends in seconds.
    pub(super) fn ends_s(&self) -> (f64, f64) {
        (seconds(self.least), seconds(self.greatest))
    }
}

/// How long ago a state was met, and the voter in the low bits: numbers sort several times faster.
pub(super) fn meeting(ago: u64, voter: usize) -> u64 {
    ago << VOTER_BITS | voter as u64
}

pub(super) fn ago(meeting: u64) -> u64 {
    meeting >> VOTER_BITS
}

fn voter(meeting: u64) -> u32 {
    meeting as u32 & (VOTERS as u32 - 1)
}

/// Whether so many meetings may lie within this of one another, in seconds. Of any but one fewer
/// than the others are, one would be among them: most states are told by a few.
pub(super) fn may_be_steady(meetings: &[u64], steady: f64, enough: usize) -> bool {
    let steady = in_nanoseconds(steady);
    meetings[..=meetings.len() - enough].iter().any(|&one| {
        let earliest = ago(one).saturating_sub(steady);
        let near = |&&other: &&u64| ago(other).wrapping_sub(earliest) <= 2 * steady;
        meetings.iter().filter(near).count() >= enough
    })
}

/// Whether so many meetings are within this of one another, in seconds.
pub(super) fn are_steady(meetings: &mut [u64], steady: f64, enough: usize) -> bool {
    let steady = in_nanoseconds(steady);
    meetings.sort_unstable();
    meetings.windows(enough).any(|few| ago(few[enough - 1]) - ago(few[0]) <= steady)
}

/// The window of width `steady` that holds most of the meetings, sorted by distance: its voters
/// and ends.
pub(super) fn densest(meetings: &[u64], steady: f64) -> Option<Window> {
    let steady = in_nanoseconds(steady);
    let apart = |start: usize, end: usize| ago(meetings[end]) - ago(meetings[start]) > steady;
    window::densest(meetings.len(), apart).map(|(start, end)| Window {
        voters: meetings[start..=end].iter().fold(0, |voters, &met| voters | 1 << voter(met)),
        least: ago(meetings[start]),
        greatest: ago(meetings[end]),
    })
}

pub(super) fn in_nanoseconds(seconds: f64) -> u64 {
    (seconds * SECOND as f64) as u64
}

fn seconds(nanoseconds: u64) -> f64 {
    nanoseconds as f64 / SECOND as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_densest_window_names_its_voters() {
        let met = |voter: u64, ms: u64| (ms * 1_000_000) << VOTER_BITS | voter;
        let meetings = [met(3, 100), met(0, 110), met(2, 120), met(1, 7000)];
        let window = densest(&meetings, 0.05).unwrap_or_default();
        assert_eq!(window.voters, 0b1101);
        assert_eq!((window.least, window.greatest), (100_000_000, 120_000_000));
    }

    #[test]
    fn no_window_is_missed_by_looking_at_few() {
        let mut dice = 1u64;
        for enough in 2..9 {
            for _ in 0..500 {
                let mut meetings: Vec<u64> = Vec::new();
                for voter in 0..enough + 3 {
                    dice = dice.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                    meetings.push(meeting((dice >> 33) % 40 * 10_000_000, voter));
                }
                let may_be = may_be_steady(&meetings, 0.05, enough);
                meetings.sort_unstable();
                let is = densest(&meetings, 0.05).is_some_and(|w| w.votes() as usize >= enough);
                assert!(may_be || !is, "{meetings:?}");
            }
        }
        let apart: Vec<u64> = (0..20).map(|voter| meeting(voter << 40, voter as usize)).collect();
        assert!(!may_be_steady(&apart, 0.05, 10));
    }
}
