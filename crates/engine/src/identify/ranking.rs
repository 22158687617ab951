//! From tallies to the ranked list.
//!
//! Scores are compared at the resolution of the paper's tables, 0.0001: what differs by less is
//! a tie. Signals that never change are dropped, the best share by `score_in` is kept (rounded
//! up, and ties with the last one kept too), ordered by `score_in`, then `score_out`, then name.

use std::collections::HashMap;

use crate::identify::candidates::{Candidate, Candidates};
use crate::identify::tally::{Tallies, Tally};
use crate::identify::timeline::{Segment, Timeline};
use crate::log::ChangeLog;

/// Steps of a score in 1.
const RESOLUTION: f64 = 10_000.0;

/// A signal, or a bit of one, and how well it fits.
#[derive(Debug, Clone, PartialEq)]
pub struct Ranked {
    /// 1 for the best; signals of equal scores have the same rank.
    pub rank: u32,
    /// What it is.
    pub candidate: Candidate,
    /// Its address or name.
    pub name: String,
    /// Mean over the windows of 1 - min(e, c) / max(e, c); 0 is best.
    pub score_in: f64,
    /// Mean over the areas of changes per second; 0 is best.
    pub score_out: f64,
    /// Changes that count.
    pub changes: u32,
    /// Place in the list of the first one that changes at exactly the same moments; its own
    /// where it is the first.
    pub same_as: u32,
}

struct Scored {
    candidate: Candidate,
    /// In steps of the resolution.
    score_in: u64,
    score_out: u64,
    changes: u32,
    moments: u64,
}

/// The number of candidates that change, and the best of them.
pub fn rank(
    log: &ChangeLog,
    candidates: &Candidates,
    tallies: &Tallies,
    timeline: &Timeline,
    share: f64,
) -> (usize, Vec<Ranked>) {
    let windows = timeline.windows.len() as f64;
    let areas = timeline.segments.iter().filter(|s| matches!(s, Segment::Area(_))).count() as f64;
    let score = |candidate: Candidate, tally: &Tally| Scored {
        candidate,
        score_in: steps((windows - tally.agreement) / windows),
        score_out: if areas == 0.0 { 0 } else { steps(tally.rates / areas) },
        changes: tally.changes,
        moments: tally.moments,
    };
    let signals = (0..).map(|signal| Candidate { signal, bit: None }).zip(&tallies.signals);
    let bits = candidates.bits().iter().copied().zip(&tallies.bits);
    let mut scored: Vec<Scored> = signals
        .chain(bits)
        .filter(|(_, tally)| tally.changes > 0)
        .map(|(candidate, tally)| score(candidate, tally))
        .collect();
    let changing = scored.len();
    keep_best(&mut scored, share);
    let mut named: Vec<(String, Scored)> =
        scored.into_iter().map(|s| (candidates.name(log, s.candidate), s)).collect();
    named.sort_unstable_by(|(name, a), (other, b)| {
        (a.score_in, a.score_out, name, a.candidate).cmp(&(
            b.score_in,
            b.score_out,
            other,
            b.candidate,
        ))
    });
    (changing, ranked(named))
}

fn steps(score: f64) -> u64 {
    // Counts are at most 2^32 and areas at least a nanosecond wide; the cast saturates.
    (score * RESOLUTION).round() as u64
}

fn keep_best(scored: &mut Vec<Scored>, share: f64) {
    // 0.2 of 15 is 3, although 0.2 is a little more than a fifth in binary.
    let kept = (scored.len() as f64 * share - 1e-9).ceil() as usize;
    if kept == 0 || kept >= scored.len() {
        return;
    }
    let (_, last, _) = scored.select_nth_unstable_by_key(kept - 1, |s| s.score_in);
    let worst = last.score_in;
    scored.retain(|s| s.score_in <= worst);
}

fn ranked(named: Vec<(String, Scored)>) -> Vec<Ranked> {
    let mut firsts: HashMap<(u64, u32), u32> = HashMap::new();
    let mut rank = 0;
    let mut before = None;
    (0..)
        .zip(named)
        .map(|(place, (name, scored))| {
            if before.replace((scored.score_in, scored.score_out))
                != Some((scored.score_in, scored.score_out))
            {
                rank = place + 1;
            }
            Ranked {
                rank,
                candidate: scored.candidate,
                name,
                score_in: scored.score_in as f64 / RESOLUTION,
                score_out: scored.score_out as f64 / RESOLUTION,
                changes: scored.changes,
                same_as: *firsts.entry((scored.moments, scored.changes)).or_insert(place),
            }
        })
        .collect()
}
