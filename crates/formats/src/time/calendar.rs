//! Days since 1970-01-01, and a time of one.

use jiff::civil::Date;
use jiff::tz::Offset;
use runglight_engine::log::{Nanoseconds, SECOND};

use super::IN_RANGE;

pub(super) const DAY: Nanoseconds = 86_400 * SECOND;

/// Days since 1970-01-01 of a valid date.
pub(super) fn days(year: i64, month: i64, day: i64) -> Option<i64> {
    let date = Date::new(year.try_into().ok()?, month.try_into().ok()?, day.try_into().ok()?);
    let midnight = Offset::UTC.to_timestamp(date.ok()?.at(0, 0, 0, 0)).ok()?;
    Some(midnight.as_second().div_euclid(86_400))
}

/// The time of a day; the error says what a time outside the range should have been.
pub(super) fn at(days: i64, of_day: Nanoseconds) -> Result<Nanoseconds, &'static str> {
    // A zone may carry a time across the edge of the range, so the sum is taken wide.
    let time = i128::from(days) * i128::from(DAY) + i128::from(of_day);
    Nanoseconds::try_from(time).map_err(|_| IN_RANGE)
}
