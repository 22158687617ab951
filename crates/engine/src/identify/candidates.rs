//! What may be the variable looked for: every signal that changes, and every bit of a word.

use std::collections::HashSet;

use crate::bits::{BitNames, is_word_address, width_of};
use crate::log::{ChangeLog, SignalIndex};

/// Marks a signal that is no word.
const NO_WORD: u32 = u32::MAX;

/// A word whose bits are candidates too.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Word {
    /// The bits that ever change.
    pub mask: u64,
    /// Number of its lowest such bit among the bits of all words.
    pub first: u32,
    /// Number of its rows.
    pub rows: u32,
}

impl Word {
    /// Number, among the bits of all words, of one of its bits that are in the mask.
    #[inline]
    pub fn number_of(self, bit: u32) -> usize {
        (self.first + (self.mask & ((1u64 << bit) - 1)).count_ones()) as usize
    }
}

/// A signal, or a bit of one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Candidate {
    /// The signal.
    pub signal: SignalIndex,
    /// Its bit, where not the whole of it is meant.
    pub bit: Option<u32>,
}

/// The words among a log's signals, and their bits that change.
#[derive(Debug, Clone)]
pub struct Candidates {
    /// For each signal the place of its word, or [`NO_WORD`].
    place: Vec<u32>,
    words: Vec<Word>,
    bits: Vec<Candidate>,
    names: BitNames,
}

/// What a signal's values tell.
#[derive(Clone, Copy)]
struct Extent {
    first: i64,
    lowest: i64,
    highest: i64,
    flipped: u64,
    rows: u32,
}

impl Candidates {
    /// Finds the words of a log: signals with values other than 0 and 1, with the address of a
    /// word, or named in `words`.
    pub fn of(log: &ChangeLog, words: &[String]) -> Self {
        let named: HashSet<&str> = words.iter().map(String::as_str).collect();
        let names = BitNames::of(log.signals.iter().map(String::as_str));
        let taken = taken_names(log);
        let mut found = Self {
            place: Vec::with_capacity(log.signals.len()),
            words: Vec::new(),
            bits: Vec::new(),
            names,
        };
        for (signal, extent) in (0..).zip(extents(log)) {
            let name = &log.signals[signal as usize];
            let is_word = || {
                extent.lowest < 0
                    || extent.highest > 1
                    || named.contains(name.as_str())
                    || is_word_address(name)
            };
            if extent.flipped == 0 || !is_word() {
                found.place.push(NO_WORD);
                continue;
            }
            let width = width_of(extent.lowest, extent.highest);
            let mut mask = extent.flipped & (u64::MAX >> (64 - width));
            if let Some(taken) = &taken {
                for bit in bits(mask) {
                    if taken.contains(names.name(name, bit).as_str()) {
                        mask &= !(1 << bit);
                    }
                }
            }
            found.place.push(found.words.len() as u32);
            found.words.push(Word { mask, first: found.bits.len() as u32, rows: extent.rows });
            found.bits.extend(bits(mask).map(|bit| Candidate { signal, bit: Some(bit) }));
        }
        found
    }

    /// The place among the words of a signal that is one.
    #[inline]
    pub fn word(&self, signal: SignalIndex) -> Option<usize> {
        match self.place[signal as usize] {
            NO_WORD => None,
            place => Some(place as usize),
        }
    }

    /// The words, in the order of the log's signals.
    pub fn words(&self) -> &[Word] {
        &self.words
    }

    /// The bits of all words.
    pub fn bits(&self) -> &[Candidate] {
        &self.bits
    }

    /// What a candidate is called.
    pub fn name(&self, log: &ChangeLog, candidate: Candidate) -> String {
        let signal = &log.signals[candidate.signal as usize];
        match candidate.bit {
            Some(bit) => self.names.name(signal, bit),
            None => signal.clone(),
        }
    }
}

/// One pass over the rows: which values each signal takes. A signal without rows has no bits.
fn extents(log: &ChangeLog) -> Vec<Extent> {
    let none = Extent { first: 0, lowest: i64::MAX, highest: i64::MIN, flipped: 0, rows: 0 };
    let mut extents = vec![none; log.signals.len()];
    for (&signal, &value) in log.signal.iter().zip(&log.value) {
        let extent = &mut extents[signal as usize];
        if extent.lowest > extent.highest {
            extent.first = value;
        }
        extent.lowest = extent.lowest.min(value);
        extent.highest = extent.highest.max(value);
        extent.rows += 1;
        extent.flipped |= (extent.first ^ value) as u64;
    }
    extents
}

/// The signals' names, where some may be bits of words that are signals too.
fn taken_names(log: &ChangeLog) -> Option<HashSet<&str>> {
    let ends_in_bit = |name: &String| {
        name.rsplit_once('.').is_some_and(|(_, bit)| bit.parse::<u8>().is_ok_and(|bit| bit < 64))
    };
    log.signals.iter().any(ends_in_bit).then(|| log.signals.iter().map(String::as_str).collect())
}

/// Places of the bits that are set, lowest first.
pub(super) fn bits(mut mask: u64) -> impl Iterator<Item = u32> {
    std::iter::from_fn(move || {
        let bit = mask.trailing_zeros();
        (bit < 64).then(|| {
            mask &= mask - 1;
            bit
        })
    })
}
