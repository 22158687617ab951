//! What learning must know of a whole log before any part of it can be learned by itself.
//!
//! A first pass over rows that lie in many places and in any order. Each place makes a survey of
//! its rows; surveys of all places, merged in any order, tell of the log what one look at all of
//! it would have.

use std::collections::HashMap;

use hashbrown::DefaultHashBuilder;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::log::{Gap, Nanoseconds};
use crate::saved_state;

use super::clock::Phases;
use super::reading::Run;

/// Rows of equal time have this place where nobody tells another.
pub const NO_PLACE: i64 = 0;

/// Why saved bytes are no survey.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum SurveyError {
    /// Damaged, or of another version.
    #[error("the bytes are no survey of this version; survey the log anew")]
    Damaged,
    /// Made with other gaps.
    #[error("surveys of one log must be made with the same gaps")]
    OtherGaps,
}

/// What is known of one signal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
struct Sighting {
    /// Its first row: time, and place among rows of that time.
    first: (Nanoseconds, i64),
    /// It ever held a value other than 0 and 1.
    word: bool,
    rows: u64,
}

/// A survey of some rows of a log.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Survey {
    gaps: Vec<Gap>,
    /// By gap: time of the first row after it.
    resumes: Vec<Option<Nanoseconds>>,
    signals: HashMap<String, Sighting, DefaultHashBuilder>,
    /// Least and greatest time.
    span: Option<(Nanoseconds, Nanoseconds)>,
    /// A row of the least time has the value 0.
    zero_at_first: bool,
    phases: Phases,
    rows: u64,
}

impl Survey {
    /// Of no rows yet; `gaps` are those of the whole log, in time order.
    pub fn new(gaps: Vec<Gap>) -> Self {
        Self { resumes: vec![None; gaps.len()], gaps, ..Self::default() }
    }

    /// Takes in rows: times, names by number, values, and places among rows of one time.
    pub fn add<'a>(&mut self, rows: impl Iterator<Item = (Nanoseconds, &'a str, i64, i64)>) {
        for (time, name, value, place) in rows {
            self.rows += 1;
            self.phases.add(time);
            self.add_time(time, value == 0);
            for (resume, gap) in self.resumes.iter_mut().zip(&self.gaps) {
                if time >= gap.end {
                    *resume = Some(resume.map_or(time, |resume| resume.min(time)));
                }
            }
            let (first, word) = ((time, place), value & !1 != 0);
            match self.signals.get_mut(name) {
                Some(sighting) => {
                    sighting.first = sighting.first.min(first);
                    sighting.word |= word;
                    sighting.rows += 1;
                }
                None => {
                    let sighting = Sighting { first, word, rows: 1 };
                    self.signals.insert(name.to_owned(), sighting);
                }
            }
        }
    }

    fn add_time(&mut self, time: Nanoseconds, zero: bool) {
        match &mut self.span {
            Some((least, greatest)) => {
                *greatest = time.max(*greatest);
                if time < *least {
                    (*least, self.zero_at_first) = (time, zero);
                } else if time == *least {
                    self.zero_at_first |= zero;
                }
            }
            None => (self.span, self.zero_at_first) = (Some((time, time)), zero),
        }
    }

    /// Takes in what another place has found.
    ///
    /// # Errors
    /// Surveys made with other gaps.
    pub fn merge(&mut self, other: Self) -> Result<(), SurveyError> {
        if self.gaps != other.gaps {
            return Err(SurveyError::OtherGaps);
        }
        self.rows += other.rows;
        self.phases.merge(&other.phases);
        if let Some((least, greatest)) = other.span {
            self.add_time(least, other.zero_at_first);
            self.add_time(greatest, false);
        }
        for (own, other) in self.resumes.iter_mut().zip(other.resumes) {
            *own = [*own, other].into_iter().flatten().min();
        }
        for (name, theirs) in other.signals {
            self.signals
                .entry(name)
                .and_modify(|own| {
                    own.first = own.first.min(theirs.first);
                    own.word |= theirs.word;
                    own.rows += theirs.rows;
                })
                .or_insert(theirs);
        }
        Ok(())
    }

    /// Everything, compactly.
    pub fn save(&self) -> Vec<u8> {
        saved_state::sealed(self)
    }

    /// From what was saved.
    ///
    /// # Errors
    /// Damaged bytes.
    pub fn restore(bytes: &[u8]) -> Result<Self, SurveyError> {
        let body = saved_state::unsealed(bytes).ok_or(SurveyError::Damaged)?;
        postcard::from_bytes(body).map_err(|_| SurveyError::Damaged)
    }

    /// Number of rows.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Signals in the order of their first rows, and in that of their names where those are equal.
    pub(super) fn signals(&self) -> Vec<Surveyed<'_>> {
        let mut signals: Vec<(&String, &Sighting)> = self.signals.iter().collect();
        signals.sort_unstable_by_key(|&(symbol, _)| symbol);
        let mut signals: Vec<_> = (0..)
            .zip(signals)
            .map(|(by_name, (symbol, sighting))| {
                let Sighting { first, word, rows } = *sighting;
                (first, Surveyed { symbol, by_name, word, rows })
            })
            .collect();
        signals.sort_by_key(|&(first, _)| first);
        signals.into_iter().map(|(_, surveyed)| surveyed).collect()
    }

    /// Where rows begin that have no predecessor.
    pub(super) fn runs(&self) -> Vec<Run> {
        let first = self.span.map(|(begins, _)| Run { begins, image: self.zero_at_first });
        let resumed = self.resumes.iter().flatten();
        first.into_iter().chain(resumed.map(|&begins| Run { begins, image: true })).collect()
    }

    /// Time from the first row to the last.
    pub(super) fn duration(&self) -> Nanoseconds {
        self.span.map_or(0, |(least, greatest)| greatest.saturating_sub(least))
    }

    pub(super) fn phases(&self) -> &Phases {
        &self.phases
    }
}

/// A signal as a survey knows it.
pub(super) struct Surveyed<'a> {
    pub(super) symbol: &'a String,
    /// Its place in the order of names.
    pub(super) by_name: u32,
    pub(super) word: bool,
    pub(super) rows: u64,
}
