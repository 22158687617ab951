//! Times as ISO 8601.

use jiff::fmt::temporal::DateTimePrinter;
use jiff::{SignedDuration, Timestamp};
use runglight_engine::log::Nanoseconds;

/// Writes a time as ISO 8601, UTC, with as many groups of three decimals as it needs.
pub(crate) fn write_iso(time: Nanoseconds, into: &mut Vec<u8>) {
    let precision = match time {
        _ if time % 1_000_000_000 == 0 => 0,
        _ if time % 1_000_000 == 0 => 3,
        _ if time % 1_000 == 0 => 6,
        _ => 9,
    };
    let timestamp = Timestamp::UNIX_EPOCH + SignedDuration::from_nanos(time);
    // A vector takes whatever is written.
    let _ = DateTimePrinter::new().precision(Some(precision)).print_timestamp(&timestamp, into);
}
