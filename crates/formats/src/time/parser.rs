//! Cells in, times out.

use jiff::fmt::strtime::BrokenDownTime;
use jiff::tz::Offset;
use runglight_engine::log::{Nanoseconds, SECOND};

use super::calendar::{DAY, at};
use super::decimal::number;
use super::text::{day_month_year, iso_date, time_of_day, time_of_minute, zone_offset_s};
use super::{AN_ISO_TIME, IN_RANGE, TimeFormat};
use crate::report::ReadReport;

/// Length of `YYYY-MM-DDTHH:MM:`.
const MINUTE_LENGTH: usize = 17;

/// Turns cells into times.
#[derive(Debug, Clone)]
pub(crate) struct TimeParser {
    format: TimeFormat,
    /// Midnight of the day that clock times are on.
    midnight: Nanoseconds,
    /// The newest clock time seen.
    newest: Option<Nanoseconds>,
    /// The date parsed last, as text and as days since 1970: most rows repeat it.
    cached_date: ([u8; 10], i64),
    /// The date, hour and minute parsed last, as text, as days since 1970 and as nanoseconds of the
    /// day: most rows repeat them too.
    cached_minute: ([u8; MINUTE_LENGTH], i64, Nanoseconds),
    /// True once a time without zone was read as UTC.
    assumed_utc: bool,
}

impl TimeParser {
    /// `midnight` is the first day of a file with clock times, in nanoseconds since 1970.
    pub(crate) fn new(format: TimeFormat, midnight: Nanoseconds) -> Self {
        Self {
            format,
            midnight,
            newest: None,
            cached_date: ([0; 10], 0),
            cached_minute: ([0; MINUTE_LENGTH], 0, 0),
            assumed_utc: false,
        }
    }

    /// Says what was assumed of the times parsed so far.
    pub(crate) fn say(&self, report: &mut ReadReport) {
        if self.assumed_utc {
            report.note("times without a zone are read as UTC");
        }
    }

    /// Parses one cell; the error says what was expected.
    #[inline]
    pub(crate) fn parse(&mut self, cell: &[u8]) -> Result<Nanoseconds, &'static str> {
        match &self.format {
            TimeFormat::Iso => self.iso(cell),
            TimeFormat::Number { unit, epoch_s } => number(cell, *unit, *epoch_s),
            TimeFormat::Clock => self.clock(cell),
            TimeFormat::DayMonthYear { month_first } => {
                let time = day_month_year(cell, *month_first).ok_or(self.format.expected())?;
                self.assumed_utc = true;
                time
            }
            TimeFormat::Pattern(pattern) => {
                let pattern = pattern.clone();
                self.pattern(&pattern, cell)
            }
        }
    }

    fn iso(&mut self, cell: &[u8]) -> Result<Nanoseconds, &'static str> {
        if let Some((start, seconds)) = cell.split_first_chunk::<MINUTE_LENGTH>()
            && *start == self.cached_minute.0
        {
            let (of_minute, zone) = time_of_minute(seconds).ok_or(AN_ISO_TIME)?;
            let (_, days, minutes) = self.cached_minute;
            return self.in_zone(days, minutes + of_minute, zone);
        }
        self.iso_of_any_minute(cell)
    }

    fn iso_of_any_minute(&mut self, cell: &[u8]) -> Result<Nanoseconds, &'static str> {
        let Some(date) = cell.first_chunk::<10>() else { return Err(AN_ISO_TIME) };
        let days = if *date == self.cached_date.0 {
            self.cached_date.1
        } else {
            let days = iso_date(date).ok_or(AN_ISO_TIME)?;
            self.cached_date = (*date, days);
            days
        };
        let rest = &cell[10..];
        if rest.is_empty() {
            self.assumed_utc = true;
            return at(days, 0);
        }
        let clock = match rest {
            [b'T' | b't' | b',', clock @ ..] => clock,
            [b' ', ..] => rest.trim_ascii_start(),
            _ => return Err(AN_ISO_TIME),
        };
        let (of_day, zone) = time_of_day(clock).ok_or(AN_ISO_TIME)?;
        if let Some(start) = cell.first_chunk::<MINUTE_LENGTH>()
            && start.ends_with(b":")
            && let Some((minutes, [])) = time_of_day(&start[11..16])
        {
            self.cached_minute = (*start, days, minutes);
        }
        self.in_zone(days, of_day, zone)
    }

    /// A time of a day, where what stands behind it says in which zone.
    #[inline]
    fn in_zone(
        &mut self,
        days: i64,
        of_day: Nanoseconds,
        zone: &[u8],
    ) -> Result<Nanoseconds, &'static str> {
        let offset_s = match zone {
            [] => {
                self.assumed_utc = true;
                0
            }
            b"Z" | b"z" => 0,
            zone => zone_offset_s(zone.trim_ascii_start()).ok_or(AN_ISO_TIME)?,
        };
        at(days, of_day - offset_s * SECOND)
    }

    fn clock(&mut self, cell: &[u8]) -> Result<Nanoseconds, &'static str> {
        let Some((of_day, [])) = time_of_day(cell) else { return Err(self.format.expected()) };
        self.rolled(of_day)
    }

    /// A jump back by more than half a day is midnight. A row that midnight's disorder left
    /// behind (23:59:59.9 just after 00:00:00.0) still belongs to the day before.
    fn rolled(&mut self, of_day: Nanoseconds) -> Result<Nanoseconds, &'static str> {
        const DISORDER: Nanoseconds = 60 * SECOND;
        let mut time = self.midnight.checked_add(of_day).ok_or(IN_RANGE)?;
        if let Some(newest) = self.newest {
            if newest.saturating_sub(time) > DAY / 2 {
                self.midnight = self.midnight.checked_add(DAY).ok_or(IN_RANGE)?;
                time = time.checked_add(DAY).ok_or(IN_RANGE)?;
            } else if time.saturating_sub(newest) > DAY / 2
                && newest.saturating_sub(time.saturating_sub(DAY)).abs() < DISORDER
            {
                return Ok(time - DAY);
            }
        }
        self.newest = Some(self.newest.map_or(time, |newest| newest.max(time)));
        Ok(time)
    }

    fn pattern(&mut self, pattern: &str, cell: &[u8]) -> Result<Nanoseconds, &'static str> {
        let expected = self.format.expected();
        let parsed = BrokenDownTime::parse(pattern, cell).map_err(|_| expected)?;
        let in_range = |timestamp: jiff::Timestamp| {
            Nanoseconds::try_from(timestamp.as_nanosecond()).map_err(|_| IN_RANGE)
        };
        if let Ok(timestamp) = parsed.to_timestamp() {
            return in_range(timestamp);
        }
        if let Ok(civil) = parsed.to_datetime() {
            self.assumed_utc = true;
            return in_range(Offset::UTC.to_timestamp(civil).map_err(|_| IN_RANGE)?);
        }
        if let Ok(date) = parsed.to_date() {
            self.assumed_utc = true;
            let midnight = date.to_datetime(jiff::civil::Time::midnight());
            return in_range(Offset::UTC.to_timestamp(midnight).map_err(|_| IN_RANGE)?);
        }
        let clock = parsed.to_time().map_err(|_| expected)?;
        let seconds = (i64::from(clock.hour()) * 60 + i64::from(clock.minute())) * 60
            + i64::from(clock.second());
        self.rolled(seconds * SECOND + i64::from(clock.subsec_nanosecond()))
    }
}
