//! Which address is it? Variable identification by declared events (Cadiou 2019).
//!
//! A user watches the machine, or photos of it, and declares when something happened. The signal
//! that means it changes when an event is declared (`score_in`), and at no other time
//! (`score_out`). Both are best at 0.

pub mod candidates;
pub mod ranking;
pub mod sweep;
mod tally;
pub mod timeline;
pub mod trace;
pub mod view;

use thiserror::Error;

use crate::log::{ChangeLog, Nanoseconds, SECOND};
use candidates::Candidates;
use ranking::Ranked;
use timeline::{Timeline, Window};
use view::View;

/// How to identify.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Half the width of a window: the change lies at most this far from the declared event.
    pub tau: Nanoseconds,
    /// Which changes count.
    pub view: View,
    /// Share of the changing signals that is kept, best `score_in` first (the Pareto principle).
    pub share: f64,
    /// Signals that are words although only 0 and 1 were seen of them.
    pub words: Vec<String>,
}

impl Default for Settings {
    fn default() -> Self {
        Self { tau: 4 * SECOND, view: View::All, share: 0.2, words: Vec::new() }
    }
}

/// Why nothing can be identified.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum IdentifyError {
    /// The log has no rows.
    #[error("the log has no rows, so nothing can be identified; record the machine while it works")]
    NoRows,
    /// No event was declared.
    #[error("no event was declared; write when it happened into events.csv, one time a row")]
    NoEvents,
    /// No event lies where something was recorded.
    #[error(
        "none of the {events} events lies in the recorded time ({} to {}); check the clock and time zone of the events", Shown(*start), Shown(*end)
    )]
    NoneRecorded {
        /// Number of events.
        events: usize,
        /// First row.
        start: Nanoseconds,
        /// Last row.
        end: Nanoseconds,
    },
    /// A window of negative width.
    #[error("tau must be 0 s or more, not {tau_s} s")]
    Tau {
        /// What was given.
        tau_s: f64,
    },
    /// A share that keeps nothing, or more than there is.
    #[error("share must be more than 0 and at most 1, not {share}")]
    Share {
        /// What was given.
        share: f64,
    },
}

/// A moment as people read it.
struct Shown(Nanoseconds);

impl std::fmt::Display for Shown {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match jiff::Timestamp::from_nanosecond(self.0.into()) {
            Ok(moment) => write!(formatter, "{moment:.3}"),
            Err(_) => write!(formatter, "{} ns", self.0),
        }
    }
}

/// What was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Identification {
    /// First and last recorded time.
    pub recorded: (Nanoseconds, Nanoseconds),
    /// Windows around the events, in time order.
    pub windows: Vec<Window>,
    /// Width of each area outside of them, in seconds.
    pub areas_s: Vec<f64>,
    /// Events that lie where nothing was recorded: they count for nothing.
    pub unrecorded: Vec<Nanoseconds>,
    /// Number of signals, bits of words included, that change in the view.
    pub changing: usize,
    /// The best of them, best first.
    pub ranked: Vec<Ranked>,
}

/// Ranks the signals of a log, and the bits of its words, by how well their changes fit events.
/// The order of the log's signals has no influence on the result.
///
/// # Errors
/// Nothing recorded, no event in recorded time, or settings that make no sense.
pub fn identify(
    log: &ChangeLog,
    events: &[Nanoseconds],
    settings: &Settings,
) -> Result<Identification, IdentifyError> {
    let candidates = Candidates::of(log, &settings.words);
    identify_among(log, &candidates, events, settings)
}

/// As [`identify`], with the candidates found before.
fn identify_among(
    log: &ChangeLog,
    candidates: &Candidates,
    events: &[Nanoseconds],
    settings: &Settings,
) -> Result<Identification, IdentifyError> {
    check(settings)?;
    let timeline = Timeline::of(log, events, settings.tau)?;
    let tallies = tally::count(log, candidates, &timeline, settings.view);
    let (changing, ranked) = ranking::rank(log, candidates, &tallies, &timeline, settings.share);
    Ok(Identification {
        recorded: timeline.recorded,
        areas_s: timeline.areas_s().collect(),
        windows: timeline.windows,
        unrecorded: timeline.unrecorded,
        changing,
        ranked,
    })
}

fn check(settings: &Settings) -> Result<(), IdentifyError> {
    if settings.tau < 0 {
        return Err(IdentifyError::Tau { tau_s: settings.tau as f64 / SECOND as f64 });
    }
    if !(settings.share > 0.0 && settings.share <= 1.0) {
        return Err(IdentifyError::Share { share: settings.share });
    }
    Ok(())
}
