//! One pass over the log counts every candidate's changes in every window and area.
//!
//! Nothing is kept per event: a candidate remembers the segment it last changed in, and its count
//! is turned into scores when it changes in another one. Segments without a change need no visit:
//! such a window adds 1 to the sum of its scores, such an area nothing.

use crate::identify::candidates::{Candidates, Word, bits};
use crate::identify::timeline::{BLIND, Segment, Timeline};
use crate::identify::view::View;
use crate::log::{ChangeLog, Nanoseconds};

/// How a candidate changed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tally {
    /// Sum over the windows with changes of min(e, c) / max(e, c), for e events and c changes.
    pub agreement: f64,
    /// Sum over the areas of changes per second.
    pub rates: f64,
    /// A fingerprint of the moments it changed at.
    pub moments: u64,
    /// Changes in windows and areas.
    pub changes: u32,
    segment: u32,
    /// Changes in `segment`.
    count: u32,
}

impl Tally {
    const NONE: Self =
        Self { agreement: 0.0, rates: 0.0, moments: 0, changes: 0, segment: BLIND, count: 0 };

    #[inline]
    fn change(&mut self, time: Nanoseconds, segment: u32, segments: &[Segment]) {
        if segment != self.segment {
            self.close(segments);
            self.segment = segment;
        }
        self.count += 1;
        self.changes += 1;
        self.moments = mixed(self.moments, time);
    }

    /// Turns the count of the running segment into scores.
    #[inline]
    fn close(&mut self, segments: &[Segment]) {
        let count = f64::from(std::mem::take(&mut self.count));
        match segments.get(self.segment as usize) {
            Some(Segment::Window(events)) => {
                self.agreement += events.min(count) / events.max(count);
            }
            Some(Segment::Area(width_s)) => self.rates += count / width_s,
            None => {}
        }
    }
}

/// The finaliser of MurmurHash3, which lets no two moments cancel each other.
#[inline]
fn mixed(moments: u64, time: Nanoseconds) -> u64 {
    let mixed = (moments ^ time as u64).wrapping_mul(0xFF51_AFD7_ED55_8CCD);
    (mixed ^ (mixed >> 33)).wrapping_mul(0xC4CE_B9FE_1A85_EC53)
}

/// A signal on the way: a cache line.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct State {
    tally: Tally,
    last: i64,
    seen: bool,
}

/// A change of a word.
#[derive(Debug, Clone, Copy, Default)]
struct Flip {
    time: Nanoseconds,
    /// The bits whose change counts.
    bits: u64,
    segment: u32,
}

/// The changes of all words, those of one side by side: the tallies of its bits then stay in the
/// cache, where bits taken row by row would lie all over the memory.
struct Flips {
    flips: Vec<Flip>,
    /// For each word where its changes begin, and where the next goes.
    places: Vec<(usize, usize)>,
}

impl Flips {
    /// Room for all that may come.
    fn of(words: &[Word]) -> Self {
        let mut room = 0;
        let places = words
            .iter()
            .map(|word| {
                let start = room;
                room += word.rows as usize;
                (start, start)
            })
            .collect();
        Self { flips: vec![Flip::default(); room], places }
    }

    #[inline]
    fn push(&mut self, word: usize, flip: Flip) {
        let next = &mut self.places[word].1;
        self.flips[*next] = flip;
        *next += 1;
    }

    fn by_word(&self) -> impl Iterator<Item = &[Flip]> {
        self.places.iter().map(|&(start, end)| &self.flips[start..end])
    }
}

/// Tallies of the signals, and of the bits of words.
pub struct Tallies {
    /// By signal.
    pub signals: Vec<Tally>,
    /// In the order of [`Candidates::bits`].
    pub bits: Vec<Tally>,
}

/// Counts the changes of a view.
pub fn count(log: &ChangeLog, candidates: &Candidates, timeline: &Timeline, view: View) -> Tallies {
    let segments = timeline.segments.as_slice();
    let mut states = vec![State { tally: Tally::NONE, last: 0, seen: false }; log.signals.len()];
    let mut flips = Flips::of(candidates.words());
    let mut walk = timeline.walk();
    for ((&time, &signal), &value) in log.time.iter().zip(&log.signal).zip(&log.value) {
        let segment = walk.segment(time);
        let state = &mut states[signal as usize];
        let last = std::mem::replace(&mut state.last, value);
        // A signal's first row tells how it stands; nothing is known to have changed.
        if last == value || !std::mem::replace(&mut state.seen, true) || segment == BLIND {
            state.seen = true;
            continue;
        }
        if view.counts(last, value) {
            state.tally.change(time, segment, segments);
        }
        if let Some(word) = candidates.word(signal) {
            flips.push(word, Flip { time, bits: view.bits(last, value), segment });
        }
    }
    let mut bit_tallies = vec![Tally::NONE; candidates.bits().len()];
    for (word, flips) in candidates.words().iter().zip(flips.by_word()) {
        for flip in flips {
            for bit in bits(flip.bits & word.mask) {
                bit_tallies[word.number_of(bit)].change(flip.time, flip.segment, segments);
            }
        }
    }
    let mut signals: Vec<Tally> = states.into_iter().map(|state| state.tally).collect();
    for tally in signals.iter_mut().chain(&mut bit_tallies) {
        tally.close(segments);
    }
    Tallies { signals, bits: bit_tallies }
}
