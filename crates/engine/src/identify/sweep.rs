//! Which τ? Every one of a list is tried, and the one taken at which the best signal meets most.

use crate::identify::candidates::Candidates;
use crate::identify::ranking::Ranked;
use crate::identify::{Identification, IdentifyError, Settings, identify_among};
use crate::log::{ChangeLog, Nanoseconds};

/// What meets this share of the most is as good.
const AS_GOOD: f64 = 0.9;

/// What one τ gives.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Half the width of the windows.
    pub tau: Nanoseconds,
    /// Number of windows.
    pub windows: usize,
    /// The best signal; none where nothing changes.
    pub best: Option<Ranked>,
    /// Of those that do not change at the same moments, the one that fits next best; none where
    /// there is no other.
    pub next: Option<Ranked>,
    /// Windows that the best meets, less its changes out of place, in number.
    pub met: f64,
    /// By how much the next fits worse: windows missed and changes out of place.
    pub lead: f64,
}

/// Tries every τ of a list; see [`suggested`].
///
/// # Errors
/// Those of [`identify`](crate::identify::identify).
pub fn sweep(
    log: &ChangeLog,
    events: &[Nanoseconds],
    taus: &[Nanoseconds],
    settings: &Settings,
) -> Result<Vec<Step>, IdentifyError> {
    let candidates = Candidates::of(log, &settings.words);
    taus.iter()
        .map(|&tau| {
            let settings = Settings { tau, share: 1.0, ..settings.clone() };
            identify_among(log, &candidates, events, &settings).map(|found| step(tau, found))
        })
        .collect()
}

/// The step whose best signal meets most windows. Narrow windows miss what was declared late, and
/// wide ones merge: both are fewer met. How far the best is ahead of the next is no measure: a
/// machine has signals that go together, and only chance sets them apart. Of the neighbours that
/// meet as much, the one in the middle leaves room to both sides.
pub fn suggested(steps: &[Step]) -> Option<usize> {
    let of_best = steps.iter().filter(|step| step.best.is_some()).map(|step| step.met);
    let most = of_best.max_by(f64::total_cmp)?;
    let is_good = |step: &Step| step.best.is_some() && step.met >= most.min(most * AS_GOOD);
    let first = steps.iter().position(|step| step.best.is_some() && step.met >= most)?;
    let before = steps[..first].iter().rev().take_while(|step| is_good(step)).count();
    let after = steps[first + 1..].iter().take_while(|step| is_good(step)).count();
    Some(first - before + (before + after) / 2)
}

fn step(tau: Nanoseconds, found: Identification) -> Step {
    let windows = found.windows.len();
    let outside_s: f64 = found.areas_s.iter().sum();
    let misfits = |r: &Ranked| r.score_in * windows as f64 + r.score_out * outside_s;
    let mut ranked = found.ranked.into_iter();
    let best = ranked.next();
    let next = best.as_ref().and_then(|best| {
        ranked
            .filter(|other| other.same_as != best.same_as)
            // The first of several as good: they come in the order of the ranking.
            .min_by(|a, b| misfits(a).total_cmp(&misfits(b)))
    });
    let lead = match (&best, &next) {
        (Some(best), Some(next)) => misfits(next) - misfits(best),
        (Some(best), None) => windows as f64 - misfits(best),
        _ => 0.0,
    };
    let met = best.as_ref().map_or(0.0, |best| windows as f64 - misfits(best));
    Step { tau, windows, best, next, met, lead }
}
