//! What times of a log mean: its resolution, and what is of one scan.

use crate::log::{ChangeLog, Nanoseconds, SECOND};
use crate::signal_state::parameters::Parameters;

/// Smallest time difference that means something: the scan interval where known, else the
/// resolution the logger writes times with.
pub(super) fn resolution(logs: &[&ChangeLog], parameters: &Parameters) -> Nanoseconds {
    let given = parameters.scan_interval_s.map(|s| (s * SECOND as f64) as Nanoseconds);
    let scan = given.or_else(|| logs.iter().filter_map(|log| log.scan_interval).max());
    scan.unwrap_or_else(|| logger_resolution(logs)).clamp(FINEST, SECOND)
}

/// Finer times are taken as noise.
const FINEST: Nanoseconds = SECOND / 1000;
/// Share of times that may lie off the logger's grid, when a clock was set or a source is finer.
const OFF_GRID: f64 = 0.05;

/// The coarsest of the usual grids (1 s, 500 ms, 200 ms, … 1 ms) nearly all times lie on.
fn logger_resolution(logs: &[&ChangeLog]) -> Nanoseconds {
    let grids = [1000, 500, 200, 100, 50, 20, 10, 5, 2].map(|ms| ms * FINEST);
    let rows: usize = logs.iter().map(|log| log.len()).sum();
    let allowed = (OFF_GRID * rows as f64) as usize;
    let fits = |grid: Nanoseconds| {
        let times = logs.iter().flat_map(|log| &log.time);
        // A grid that does not fit is given up with the first row too many.
        times.filter(|&&time| time % grid != 0).nth(allowed).is_none()
    };
    grids.into_iter().find(|&grid| fits(grid)).unwrap_or(FINEST)
}

/// Scans may come early by one part in this many of their interval.
const SCAN_JITTER: Nanoseconds = 4;

/// Events closer than this have no order; zero where only equal times are of one scan.
///
/// A little less than the interval: scans jitter, and two in a row are not one because the second
/// came early; nor must a live finding wait for a third.
pub(super) fn scan_window(logs: &[&ChangeLog], parameters: &Parameters) -> Nanoseconds {
    let given = parameters.scan_interval_s.map(|s| (s * SECOND as f64) as Nanoseconds);
    let interval = given.or_else(|| logs.iter().filter_map(|log| log.scan_interval).max());
    interval.map_or(0, |interval| interval - interval / SCAN_JITTER)
}
