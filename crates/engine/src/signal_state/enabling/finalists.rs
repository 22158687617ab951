//! Which candidates are worth measuring on all instances.

use crate::signal_state::states::{NO_STATE, StateId};

use super::ballot::{Ballot, Candidate, Election, VOTERS, Window, voters_of};
use super::{EXPLAINED, FINALISTS, Happenings};

/// Candidates that may lead a join.
const LEADING: usize = 24;

/// The most promising single triggers and joins, after the vote.
pub(super) fn finalists(
    ballot: &mut Ballot,
    index: Happenings<'_>,
    election: &Election<'_>,
) -> Vec<[StateId; 2]> {
    let needed = (EXPLAINED * election.voters() as f64).ceil() as u32;
    // Nearly all states are met by fewer: they can only follow in a join.
    let half = needed.div_ceil(2) as usize;
    let candidates = ballot.candidates(index, election, half..VOTERS + 1, |_| true);
    let spread = |c: &Candidate| c.steady.1.1 - c.steady.1.0;
    let best = |mut singles: Vec<&Candidate>| {
        singles.sort_by(|a, b| spread(a).total_cmp(&spread(b)));
        singles.into_iter().take(FINALISTS).map(|c| [c.state, NO_STATE]).collect::<Vec<_>>()
    };
    let (steady_ones, others): (Vec<&Candidate>, Vec<&Candidate>) =
        candidates.iter().partition(|c| c.steady.0.count_ones() >= needed);
    let mut finalists = best(steady_ones);
    // A program may act after one time or another: met by all, at a few steady distances.
    finalists.extend(best(
        others
            .into_iter()
            .filter(|c| c.met >= needed && 3 * c.steady.0.count_ones() >= needed)
            .collect(),
    ));
    let mut joins_of = |width: f64, window: fn(&Candidate) -> Window| {
        let leaders = candidates.iter().map(|c| window(c).0);
        let leaders: Vec<u32> =
            leaders.filter(|leader| leads(leader.count_ones(), needed)).collect();
        let lacks = |&leader: &u32| needed.saturating_sub(leader.count_ones()).max(1);
        let Some(lacking) = leaders.iter().map(lacks).min() else {
            return Vec::new();
        };
        let follows = |meetings: &[u64]| {
            let voters = voters_of(meetings);
            leaders.iter().any(|leader| (voters & !leader).count_ones() >= lacks(leader))
        };
        let mut all = ballot.candidates(index, election, lacking as usize..half, follows);
        all.extend(candidates.iter().cloned());
        all.sort_unstable_by_key(|c| c.state);
        joins(&all, needed, width, window)
    };
    // Where scans alone do not explain the scatter of the delays, wider windows may.
    let mut pairs = joins_of(election.close, |c| c.close);
    if pairs.is_empty() {
        pairs = joins_of(election.steady, |c| c.steady);
    }
    finalists.extend(pairs.into_iter().take(FINALISTS));
    finalists
}

/// The leading one of two explains at least half of what both do.
fn leads(alone: u32, needed: u32) -> bool {
    2 * alone >= needed
}

/// Pairs that together explain what neither does alone, those that explain most first.
fn joins(
    candidates: &[Candidate],
    needed: u32,
    width: f64,
    window: impl Fn(&Candidate) -> Window,
) -> Vec<[StateId; 2]> {
    let mut partners: Vec<(StateId, Window)> =
        candidates.iter().map(|c| (c.state, window(c))).collect();
    partners.sort_by_key(|(_, (mask, _))| std::cmp::Reverse(mask.count_ones()));
    let mut pairs: Vec<(u32, f64, [StateId; 2])> = Vec::new();
    for (at, (one, (a, first))) in partners.iter().enumerate().take(LEADING) {
        let alone = a.count_ones();
        if !leads(alone, needed) {
            break;
        }
        for (other, (b, second)) in &partners[at + 1..] {
            let together = (a | b).count_ones();
            // The program waits for both and then acts: whichever is the later, at one distance.
            let (low, high) = (first.0.min(second.0), first.1.max(second.1));
            if together >= needed && together > alone && high - low <= width {
                pairs.push((together, high - low, [*one, *other]));
            }
        }
    }
    pairs.sort_by(|a, b| b.0.cmp(&a.0).then(a.1.total_cmp(&b.1)));
    pairs.into_iter().map(|(.., states)| states).collect()
}
