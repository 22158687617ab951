//! Windows around events, and the areas between them.
//!
//! Each event stands for the time from τ before it to τ after it, both ends included; windows
//! that overlap or touch are one, with their events counted (Cadiou 2019, section 3.2). What is
//! left of the recorded time are the areas: one before the first window, between each two, and
//! after the last. An area of width zero is none.
//!
//! What was not recorded counts for nothing: gaps make areas narrower, and an event in a gap (or
//! before or after the recording) has no window, while the time around it belongs to no area
//! either, for the change that goes with it may lie there.

use crate::identify::IdentifyError;
use crate::log::{ChangeLog, Nanoseconds, SECOND};

/// A window around one event, or around several whose windows overlap.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Window {
    /// Its first moment.
    pub start: Nanoseconds,
    /// Its last moment.
    pub end: Nanoseconds,
    /// Events in it.
    pub events: u32,
}

/// What changes of one part of the time are held against.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Segment {
    /// A window, with its number of events.
    Window(f64),
    /// An area, with its recorded width in seconds.
    Area(f64),
}

/// Time that counts for nothing.
pub const BLIND: u32 = u32::MAX;

/// A stretch of time that lies in one segment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Stretch {
    /// Its last moment; it begins after the last moment of the one before.
    until: Nanoseconds,
    segment: u32,
}

/// The recorded time, divided into windows and areas.
#[derive(Debug, Clone, PartialEq)]
pub struct Timeline {
    /// First and last recorded time.
    pub recorded: (Nanoseconds, Nanoseconds),
    /// Windows in time order.
    pub windows: Vec<Window>,
    /// Windows and areas in time order.
    pub segments: Vec<Segment>,
    /// Events without a window.
    pub unrecorded: Vec<Nanoseconds>,
    stretches: Vec<Stretch>,
    /// Times at which signals are told as they stand: the start, and the ends of the gaps.
    images: Vec<Nanoseconds>,
}

impl Timeline {
    /// Divides the recorded time of a log.
    ///
    /// # Errors
    /// A log without rows, no events, or none in the recorded time.
    pub fn of(
        log: &ChangeLog,
        events: &[Nanoseconds],
        tau: Nanoseconds,
    ) -> Result<Self, IdentifyError> {
        let (Some(&start), Some(&end)) = (log.time.first(), log.time.last()) else {
            return Err(IdentifyError::NoRows);
        };
        if events.is_empty() {
            return Err(IdentifyError::NoEvents);
        }
        let mut sorted = events.to_vec();
        sorted.sort_unstable();
        let gaps: Vec<(Nanoseconds, Nanoseconds)> =
            log.gaps.iter().map(|gap| (gap.start.max(start), gap.end.min(end))).collect();
        let is_recorded = |event: &Nanoseconds| {
            (start..=end).contains(event)
                && !gaps.iter().any(|&(from, to)| from < *event && *event < to)
        };
        let (seen, unrecorded): (Vec<Nanoseconds>, Vec<Nanoseconds>) =
            sorted.into_iter().partition(is_recorded);
        if seen.is_empty() {
            return Err(IdentifyError::NoneRecorded { events: events.len(), start, end });
        }
        let around = |event: Nanoseconds| {
            (event.saturating_sub(tau).max(start), event.saturating_add(tau).min(end))
        };
        let blind = united(gaps.into_iter().chain(unrecorded.iter().map(|&e| around(e))));
        let mut timeline = Self {
            recorded: (start, end),
            windows: windows(seen.into_iter().map(around)),
            segments: Vec::new(),
            unrecorded,
            stretches: Vec::new(),
            images: log.gaps.iter().map(|gap| gap.end).collect(),
        };
        timeline.images.sort_unstable();
        timeline.divide(&blind);
        Ok(timeline)
    }

    /// Widths of the areas in seconds.
    pub fn areas_s(&self) -> impl Iterator<Item = f64> {
        self.segments.iter().filter_map(|segment| match segment {
            Segment::Area(width_s) => Some(*width_s),
            Segment::Window(_) => None,
        })
    }

    /// Walks through the time, to be asked for times that never go back.
    pub fn walk(&self) -> Walk<'_> {
        Walk { stretches: &self.stretches, images: &self.images }
    }

    fn divide(&mut self, blind: &[(Nanoseconds, Nanoseconds)]) {
        let (start, end) = self.recorded;
        let mut from = start;
        for at in 0..=self.windows.len() {
            let window = self.windows.get(at).copied();
            let (to, last) = window.map_or((end, end), |w| (w.start, w.start.saturating_sub(1)));
            self.area((from, to), last, blind);
            if let Some(window) = window {
                self.stretch(window.end, Some(Segment::Window(f64::from(window.events))));
                from = window.end;
            }
        }
    }

    /// The area from one time to another; `last` is its last moment that is in no window.
    fn area(
        &mut self,
        (from, to): (Nanoseconds, Nanoseconds),
        last: Nanoseconds,
        blind: &[(Nanoseconds, Nanoseconds)],
    ) {
        let hidden = blind
            .iter()
            .map(|&(start, end)| (start.max(from), end.min(to)))
            .filter(|(start, end)| start < end);
        let width = to - from - hidden.clone().map(|(start, end)| end - start).sum::<i64>();
        if width == 0 {
            self.stretch(last, None);
            return;
        }
        let area = self.segments.len() as u32;
        self.segments.push(Segment::Area(width as f64 / SECOND as f64));
        for (start, end) in hidden {
            self.stretches.push(Stretch { until: start, segment: area });
            self.stretches.push(Stretch { until: end.min(last + 1) - 1, segment: BLIND });
        }
        self.stretches.push(Stretch { until: last, segment: area });
    }

    fn stretch(&mut self, until: Nanoseconds, segment: Option<Segment>) {
        let number = segment.map_or(BLIND, |_| self.segments.len() as u32);
        self.segments.extend(segment);
        self.stretches.push(Stretch { until, segment: number });
    }
}

/// Windows that overlap or touch are one.
fn windows(around: impl Iterator<Item = (Nanoseconds, Nanoseconds)>) -> Vec<Window> {
    let mut windows: Vec<Window> = Vec::new();
    for (start, end) in around {
        match windows.last_mut() {
            Some(last) if start <= last.end => {
                last.end = end;
                last.events += 1;
            }
            _ => windows.push(Window { start, end, events: 1 }),
        }
    }
    windows
}

/// Intervals in order, those that overlap as one.
fn united(
    intervals: impl Iterator<Item = (Nanoseconds, Nanoseconds)>,
) -> Vec<(Nanoseconds, Nanoseconds)> {
    let mut sorted: Vec<(Nanoseconds, Nanoseconds)> =
        intervals.filter(|(start, end)| start < end).collect();
    sorted.sort_unstable();
    let mut united: Vec<(Nanoseconds, Nanoseconds)> = Vec::new();
    for (start, end) in sorted {
        match united.last_mut() {
            Some(last) if start <= last.1 => last.1 = last.1.max(end),
            _ => united.push((start, end)),
        }
    }
    united
}

/// Says where moments lie, one after the other.
#[derive(Debug, Clone)]
pub struct Walk<'t> {
    stretches: &'t [Stretch],
    images: &'t [Nanoseconds],
}

impl Walk<'_> {
    /// The segment a moment lies in; [`BLIND`] where what changes counts for nothing.
    #[inline]
    pub fn segment(&mut self, time: Nanoseconds) -> u32 {
        while let [first, rest @ ..] = self.images
            && *first < time
        {
            self.images = rest;
        }
        if self.images.first() == Some(&time) {
            return BLIND;
        }
        while let [first, rest @ ..] = self.stretches
            && first.until < time
        {
            self.stretches = rest;
        }
        self.stretches.first().map_or(BLIND, |stretch| stretch.segment)
    }
}
