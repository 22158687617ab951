//! Which candidates are worth measuring on all instances.

use crate::signal_state::states::{NO_STATE, StateId};

use super::ballot::{Candidate, Election, Window};
use super::{EXPLAINED, FINALISTS};

/// Candidates that may lead a join.
const LEADING: usize = 24;

/// The most promising single triggers and joins.
pub(super) fn finalists(
    candidates: &[Candidate],
    voters: usize,
    election: &Election<'_>,
) -> Vec<[StateId; 2]> {
    let needed = (EXPLAINED * voters as f64).ceil() as u32;
    let spread = |c: &Candidate| c.window.1 - c.window.0;
    let best = |mut singles: Vec<&Candidate>| {
        singles.sort_by(|a, b| spread(a).total_cmp(&spread(b)));
        singles.into_iter().take(FINALISTS).map(|c| [c.state, NO_STATE]).collect::<Vec<_>>()
    };
    let (steady_ones, others): (Vec<&Candidate>, Vec<&Candidate>) =
        candidates.iter().partition(|c| c.mask.count_ones() >= needed);
    let mut finalists = best(steady_ones);
    // A program may act after one time or another: met by all, at a few steady distances.
    finalists.extend(best(
        others
            .into_iter()
            .filter(|c| c.met >= needed && 3 * c.mask.count_ones() >= needed)
            .collect(),
    ));
    // Where scans alone do not explain the scatter of the delays, wider windows may.
    let mut pairs = joins(candidates, needed, election.close, |c| c.close);
    if pairs.is_empty() {
        pairs = joins(candidates, needed, election.steady, |c| (c.mask, c.window));
    }
    finalists.extend(pairs.into_iter().take(FINALISTS));
    finalists
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
        // The leading one of two explains at least half of what both do.
        if 2 * alone < needed {
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
