//! Which τ? Every one of a list is tried, and the one taken that sets the best signal apart.

use crate::identify::candidates::Candidates;
use crate::identify::ranking::Ranked;
use crate::identify::{Identification, IdentifyError, Settings, identify_among};
use crate::log::{ChangeLog, Nanoseconds};

/// What one τ gives.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Half the width of the windows.
    pub tau: Nanoseconds,
    /// Number of windows.
    pub windows: usize,
    /// The best signal; none where nothing changes.
    pub best: Option<Ranked>,
    /// The best one that does not change at the same moments; none where there is no other.
    pub next: Option<Ranked>,
    /// By how many windows the best beats the next: the difference of their `score_in` times
    /// the number of windows.
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

/// The step whose best signal leads by most windows. Wide windows merge into few, narrow ones
/// miss what was declared late: both cost the lead. Of equal leads the narrower windows are taken.
pub fn suggested(steps: &[Step]) -> Option<usize> {
    let mut best: Option<(usize, f64)> = None;
    for (place, step) in steps.iter().enumerate() {
        if step.best.is_some() && best.is_none_or(|(_, lead)| step.lead > lead + 1e-9) {
            best = Some((place, step.lead));
        }
    }
    best.map(|(place, _)| place)
}

fn step(tau: Nanoseconds, found: Identification) -> Step {
    let windows = found.windows.len();
    let mut ranked = found.ranked.into_iter();
    let best = ranked.next();
    let next = ranked.find(|other| best.as_ref().is_some_and(|best| other.same_as != best.same_as));
    let lead = match (&best, &next) {
        (Some(best), Some(next)) => (next.score_in - best.score_in) * windows as f64,
        (Some(best), None) => (1.0 - best.score_in) * windows as f64,
        _ => 0.0,
    };
    Step { tau, windows, best, next, lead }
}
