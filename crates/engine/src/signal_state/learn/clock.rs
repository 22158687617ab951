//! What times of a log mean: its resolution, and what is of one scan.

use serde::{Deserialize, Serialize};

use crate::log::{ChangeLog, Nanoseconds, SECOND};
use crate::signal_state::parameters::Parameters;

/// Smallest time difference that means something: the scan interval where known, else the
/// resolution the logger writes times with.
pub(super) fn resolution(logs: &[&ChangeLog], parameters: &Parameters) -> Nanoseconds {
    let scan = scan_interval(logs, parameters);
    scan.unwrap_or_else(|| logger_resolution(logs)).clamp(FINEST, SECOND)
}

fn scan_interval(logs: &[&ChangeLog], parameters: &Parameters) -> Option<Nanoseconds> {
    let given = parameters.scan_interval_s.map(|s| (s * SECOND as f64) as Nanoseconds);
    given.or_else(|| logs.iter().filter_map(|log| log.scan_interval).max())
}

/// Finer times are taken as noise.
const FINEST: Nanoseconds = SECOND / 1000;
/// The usual grids of loggers, coarsest first.
const GRIDS: [Nanoseconds; 9] = [
    1000 * FINEST,
    500 * FINEST,
    200 * FINEST,
    100 * FINEST,
    50 * FINEST,
    20 * FINEST,
    10 * FINEST,
    5 * FINEST,
    2 * FINEST,
];
/// Share of times that may lie off the logger's grid, when a clock was set or a source is finer.
const OFF_GRID: f64 = 0.05;

/// The coarsest of the usual grids (1 s, 500 ms, 200 ms, … 1 ms) nearly all times lie on.
fn logger_resolution(logs: &[&ChangeLog]) -> Nanoseconds {
    let rows: usize = logs.iter().map(|log| log.len()).sum();
    let allowed = (OFF_GRID * rows as f64) as usize;
    // Known grids are divided by several times faster.
    let fits = [
        fits::<{ GRIDS[0] }>,
        fits::<{ GRIDS[1] }>,
        fits::<{ GRIDS[2] }>,
        fits::<{ GRIDS[3] }>,
        fits::<{ GRIDS[4] }>,
        fits::<{ GRIDS[5] }>,
        fits::<{ GRIDS[6] }>,
        fits::<{ GRIDS[7] }>,
        fits::<{ GRIDS[8] }>,
    ];
    let of_grid = GRIDS.into_iter().zip(fits).find(|(_, fits)| fits(logs, allowed));
    of_grid.map_or(FINEST, |(grid, _)| grid)
}

/// Whether no more than so many times lie off a grid, which is given up with the first too many.
fn fits<const GRID: Nanoseconds>(logs: &[&ChangeLog], allowed: usize) -> bool {
    let times = logs.iter().flat_map(|log| &log.time);
    times.filter(|&&time| time % GRID != 0).nth(allowed).is_none()
}

/// Times by where they lie in their second: what [`resolution`] needs to know of rows that are
/// spread over many places.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Phases {
    /// By millisecond.
    whole: Vec<u64>,
    /// Times between milliseconds.
    between: u64,
}

/// All grids divide it.
const PHASES: Nanoseconds = SECOND / FINEST;

impl Default for Phases {
    fn default() -> Self {
        Self { whole: vec![0; PHASES as usize], between: 0 }
    }
}

impl Phases {
    #[inline]
    pub(super) fn add(&mut self, time: Nanoseconds) {
        if time % FINEST == 0 {
            self.whole[(time / FINEST).rem_euclid(PHASES) as usize] += 1;
        } else {
            self.between += 1;
        }
    }

    pub(super) fn merge(&mut self, other: &Self) {
        for (own, other) in self.whole.iter_mut().zip(&other.whole) {
            *own += other;
        }
        self.between += other.between;
    }

    /// As [`resolution`] of a log with these times.
    pub(super) fn resolution(&self, parameters: &Parameters) -> Nanoseconds {
        scan_interval(&[], parameters).unwrap_or_else(|| self.of_logger()).clamp(FINEST, SECOND)
    }

    fn of_logger(&self) -> Nanoseconds {
        let rows = self.whole.iter().sum::<u64>() + self.between;
        let allowed = (OFF_GRID * rows as f64) as u64;
        let off = |grid: Nanoseconds| {
            let phases = self.whole.iter().zip(0..);
            let off_grid = phases.filter(|&(_, phase)| phase * FINEST % grid != 0);
            self.between + off_grid.map(|(count, _)| count).sum::<u64>()
        };
        GRIDS.into_iter().find(|&grid| off(grid) <= allowed).unwrap_or(FINEST)
    }
}

/// Scans may come early by one part in this many of their interval.
const SCAN_JITTER: Nanoseconds = 4;

/// Events closer than this have no order; zero where only equal times are of one scan.
///
/// A little less than the interval: scans jitter, and two in a row are not one because the second
/// came early; nor must a live finding wait for a third.
pub(super) fn scan_window(logs: &[&ChangeLog], parameters: &Parameters) -> Nanoseconds {
    let interval = scan_interval(logs, parameters);
    interval.map_or(0, |interval| interval - interval / SCAN_JITTER)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phases_tell_what_the_times_tell() {
        let parameters = Parameters::default();
        for step in [1, 2, 5, 10, 20, 30, 50, 100, 250, 1000] {
            for stray in [0, 3, 9] {
                let time = |row: i64| row * step * FINEST + if row < stray { 1 } else { 0 };
                let log = ChangeLog { time: (-50..50).map(time).collect(), ..ChangeLog::default() };
                let (mut one, mut other) = (Phases::default(), Phases::default());
                log.time[..30].iter().for_each(|&time| one.add(time));
                log.time[30..].iter().for_each(|&time| other.add(time));
                one.merge(&other);
                assert_eq!(one.resolution(&parameters), resolution(&[&log], &parameters));
            }
        }
    }
}
