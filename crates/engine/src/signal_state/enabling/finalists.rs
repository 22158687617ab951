//! Which candidates are worth measuring on all instances.

use crate::signal_state::states::{NO_STATE, StateId};

use super::ballot::{Ballot, Candidate, Leader};
use super::election::Election;
use super::meetings::{Window, in_nanoseconds};
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
    let half = needed.div_ceil(2);
    let candidates = ballot.candidates(index, election, half, needed);
    let spread = |c: &Candidate| {
        let (least, greatest) = c.steady.ends_s();
        greatest - least
    };
    let best = |mut singles: Vec<&Candidate>| {
        singles.sort_by(|a, b| spread(a).total_cmp(&spread(b)));
        singles.into_iter().take(FINALISTS).map(|c| [c.state, NO_STATE]).collect::<Vec<_>>()
    };
    let (steady_ones, others): (Vec<&Candidate>, Vec<&Candidate>) =
        candidates.iter().partition(|c| c.steady.votes() >= needed);
    let mut finalists = best(steady_ones);
    // A program may act after one time or another: met by all, at a few steady distances.
    finalists.extend(best(
        others.into_iter().filter(|c| c.met >= needed && 3 * c.steady.votes() >= needed).collect(),
    ));
    let mut joins_of = |width: f64, window: fn(&Candidate) -> Window| {
        let leaders = candidates.iter().map(window).filter(|w| leads(w.votes(), needed));
        let leaders: Vec<Leader> = leaders.map(|w| leader(&w, needed, width)).collect();
        if leaders.is_empty() {
            return Vec::new();
        }
        let mut all = ballot.followers(index, election, &leaders, &candidates);
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

/// More than seconds in floating point are ever off by.
const MARGIN_NS: u64 = 1000;

fn leader(window: &Window, needed: u32, width: f64) -> Leader {
    let width = in_nanoseconds(width) + MARGIN_NS;
    Leader {
        voters: window.voters,
        lacks: needed.saturating_sub(window.votes()).max(1) as usize,
        reach: window.greatest.saturating_sub(width)..=window.least + width,
    }
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
    partners.sort_by_key(|(_, window)| std::cmp::Reverse(window.votes()));
    let mut pairs: Vec<(u32, f64, [StateId; 2])> = Vec::new();
    for (at, (one, first)) in partners.iter().enumerate().take(LEADING) {
        let alone = first.votes();
        if !leads(alone, needed) {
            break;
        }
        for (other, second) in &partners[at + 1..] {
            let together = (first.voters | second.voters).count_ones();
            if together < needed || together <= alone {
                continue;
            }
            // The program waits for both and then acts: whichever is the later, at one distance.
            let (low, high) = first.and(second).ends_s();
            if high - low <= width {
                pairs.push((together, high - low, [*one, *other]));
            }
        }
    }
    pairs.sort_by(|a, b| b.0.cmp(&a.0).then(a.1.total_cmp(&b.1)));
    pairs.into_iter().map(|(.., states)| states).collect()
}
