//! Sequences: the distinct successive words of a region between two edges of the work-complete
//! bit, cleaned as section 3.3 of Guim & Dias 2023 says.

use crate::log::{ChangeLog, Nanoseconds};

use super::image::{Image, Phase, Wiring};
use super::regions::Word;

/// A region's word changes, or a sequence begins with it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entered {
    /// The word.
    pub word: Word,
    /// When.
    pub time: Nanoseconds,
    /// How long no region had changed before.
    pub quiet: Nanoseconds,
    /// Readings with a change in the whole machine since the sequence began.
    pub position: u32,
}

/// One row of a training file: what a region went through in one work or set-up.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Sequence {
    /// Work or set-up.
    pub phase: Phase,
    /// Words as they were entered.
    pub words: Vec<Entered>,
    /// When it ended.
    pub end: Nanoseconds,
}

/// One work or set-up of the whole machine, before cleaning.
#[derive(Debug, Clone, Copy)]
struct Row {
    phase: Option<Phase>,
    start: Nanoseconds,
    end: Nanoseconds,
    /// Manual, alarm or a gap fell into it.
    paused: bool,
}

/// What learning reads from logs.
#[derive(Debug, Clone, Default)]
pub struct Sequences {
    /// Per region, in time order; only what cleaning left.
    pub by_region: Vec<Vec<Sequence>>,
    /// Per phase: sequences kept and left out.
    pub kept: [u64; 2],
    /// Per phase.
    pub left_out: [u64; 2],
    /// Per phase: how long the longest kept one took.
    pub longest: [Nanoseconds; 2],
}

impl Sequences {
    /// Reads one log. `bit_of_signal` maps the log's signals to bits.
    pub fn read(
        &mut self,
        log: &ChangeLog,
        bit_of_signal: &[Option<u32>],
        bits: usize,
        regions: usize,
        wiring: &Wiring,
    ) {
        self.by_region.resize(regions, Vec::new());
        let mut image = Image::new(bits, regions);
        let mut rows: Vec<Row> = Vec::new();
        let mut words: Vec<Vec<(u32, Entered)>> = vec![Vec::new(); regions];
        let (mut last_change, mut position) = (0, 0);
        let mut gaps = log.gaps.iter().peekable();
        let mut start = 0;
        while start < log.len() {
            let time = log.time[start];
            let mut end = start;
            while end < log.len() && log.time[end] == time {
                if let Some(bit) = bit_of_signal[log.signal[end] as usize] {
                    image.set(wiring, bit, log.value[end] != 0);
                }
                end += 1;
            }
            start = end;
            let mode_changed = image.complete(wiring);
            let new_row = mode_changed && rows.last().is_none_or(|r| r.phase != image.mode.phase);
            while gaps.next_if(|gap| gap.end <= time).is_some() {
                if let Some(row) = rows.last_mut() {
                    row.paused = true;
                }
            }
            if new_row {
                if let Some(row) = rows.last_mut() {
                    row.end = time;
                }
                rows.push(Row { phase: image.mode.phase, start: time, end: time, paused: false });
                let number = rows.len() as u32 - 1;
                position = 0;
                for (words, &word) in words.iter_mut().zip(&image.words) {
                    words.push((number, Entered { word, time, quiet: 0, position }));
                }
                last_change = time;
            } else if !image.dirty.is_empty() {
                let number = rows.len() as u32 - 1;
                position += 1;
                let quiet = time.saturating_sub(std::mem::replace(&mut last_change, time));
                for &region in &image.dirty {
                    let word = image.words[region as usize];
                    let of_region = &mut words[region as usize];
                    if of_region.last().is_none_or(|last| last.1.word != word) {
                        of_region.push((number, Entered { word, time, quiet, position }));
                    }
                }
            }
            image.dirty.clear();
            if let Some(row) = rows.last_mut() {
                row.paused |= image.mode.manual || image.mode.alarm;
                row.end = time;
            }
        }
        let kept = self.clean(&rows);
        for (into, of_region) in self.by_region.iter_mut().zip(&words) {
            for run in of_region.chunk_by(|a, b| a.0 == b.0) {
                let number = run[0].0 as usize;
                if let (true, Some(phase)) = (kept[number], rows[number].phase) {
                    let words = run.iter().map(|(_, entered)| *entered).collect();
                    into.push(Sequence { phase, words, end: rows[number].end });
                }
            }
        }
    }

    /// Which rows stay: in each training file the rows with a pause go, the ones above and below
    /// them, and the first and the last ("they started to be collected in the middle of the
    /// sequence", or "were not collected until the end").
    fn clean(&mut self, rows: &[Row]) -> Vec<bool> {
        let mut kept = vec![false; rows.len()];
        for phase in Phase::ALL {
            let file: Vec<usize> =
                (0..rows.len()).filter(|&row| rows[row].phase == Some(phase)).collect();
            let paused = |place: usize| file.get(place).is_some_and(|&row| rows[row].paused);
            for (place, &row) in file.iter().enumerate() {
                let edge = place == 0 || place + 1 == file.len();
                let near = paused(place) || paused(place + 1) || (place > 0 && paused(place - 1));
                kept[row] = !edge && !near;
                let count = if kept[row] { &mut self.kept } else { &mut self.left_out };
                count[phase.index()] += 1;
                if kept[row] {
                    let took = rows[row].end.saturating_sub(rows[row].start);
                    let longest = &mut self.longest[phase.index()];
                    *longest = (*longest).max(took);
                }
            }
        }
        kept
    }
}
