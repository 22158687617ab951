//! The partner of a single trigger that explains most instances and leaves some far off.
//!
//! Where one of two is nearly always the later, a sample hardly meets the other. The instances
//! that the first leaves vote for what they really waited for, at the same distance.

use crate::signal_state::states::{NO_STATE, StateId};

use super::ballot::Ballot;
use super::delays::{self, Wait};
use super::election::Election;
use super::{Delayed, Entry, FINALISTS, GAIN, Happenings, window};

/// So many instances must be left, and the partner must explain this share of them.
const LEFT_AT_LEAST: usize = 3;
pub(super) const LEFT_EXPLAINED: f64 = 0.6;
/// Windows of the two, in close widths.
const WIDTHS: f64 = 1.5;

/// The trigger and its partner.
pub(super) fn found(
    ballot: &mut Ballot,
    index: Happenings<'_>,
    election: &Election<'_>,
    waits: &[Wait],
    [one, other]: [StateId; 2],
) -> Option<Delayed> {
    if other != NO_STATE {
        return None;
    }
    let delays = delays::of_each(index, waits, [one, NO_STATE]);
    let mut sorted: Vec<f64> = delays.iter().copied().flatten().collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let (low, high) = most_within(&sorted, election.close)?;
    let explained = |delay: &f64| (low..=high).contains(delay);
    let is_left = |&at: &usize| !delays[at].as_ref().is_some_and(explained);
    let left: Vec<usize> = (0..delays.len()).filter(is_left).collect();
    if left.len() < LEFT_AT_LEAST || left.len() * 3 > delays.len() * 2 {
        return None;
    }
    let theirs: Vec<Entry> = left.iter().map(|&at| election.instances[at]).collect();
    let of_left = Election { instances: &theirs, steady: election.close, ..*election };
    // Met at no steady distance, it is none.
    let nowhere = u32::MAX;
    let needed = (LEFT_EXPLAINED * of_left.voters() as f64).ceil() as u32;
    ballot.vote(index, &of_left);
    let mut candidates = ballot.candidates(index, &of_left, needed, nowhere);
    candidates.retain(|c| {
        let (least, most) = c.close.ends_s();
        c.state != one
            && c.close.votes() >= needed
            && most.max(high) - least.min(low) <= WIDTHS * election.close
    });
    candidates.sort_by_key(|c| std::cmp::Reverse(c.close.votes()));
    let mut room = Vec::new();
    let joined = candidates.iter().take(FINALISTS).filter_map(|c| {
        let states = [one, c.state];
        let delays = delays::sorted(index, waits, states, &mut room)?;
        let (low, high) = most_within(&delays, election.close)?;
        let within = delays.iter().filter(|d| (low..=high).contains(*d)).count();
        let still_left = waits.len() - within;
        let fewer = still_left as f64 <= GAIN * left.len() as f64;
        fewer.then_some((still_left, delays, states))
    });
    let best = joined.min_by_key(|(still_left, ..)| *still_left);
    best.map(|(_, delays, states)| Delayed { states, delays })
}

/// Ends of the window of this width that holds most of the sorted times.
fn most_within(sorted: &[f64], width: f64) -> Option<(f64, f64)> {
    let apart = |start: usize, end: usize| sorted[end] - sorted[start] > width;
    window::densest(sorted.len(), apart).map(|(start, end)| (sorted[start], sorted[end]))
}
