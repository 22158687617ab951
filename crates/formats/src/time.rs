//! Times as logs write them, parsed exactly to the nanosecond.

use jiff::fmt::strtime::BrokenDownTime;
use jiff::tz::Offset;
use runglight_engine::log::{Nanoseconds, SECOND};

use crate::report::ReadReport;

const DAY: Nanoseconds = 86_400 * SECOND;
/// Days from 0001-01-01 to 1970-01-01.
const YEAR_1_DAYS: i64 = 719_162;
/// 1990-01-01 and 2100-01-01 in Unix seconds: the years a machine's log is taken to be from.
const PLAUSIBLE_S: std::ops::Range<i128> = 631_152_000..4_102_444_800;

/// What a time outside the 64-bit nanosecond range should have been.
const IN_RANGE: &str = "a time between the years 1678 and 2261";
const AN_ISO_TIME: &str = "a time like 2024-04-15T12:00:00.5Z";
const A_NUMBER: &str = "a number as time";
const NOT_NEGATIVE: &str = "a time that is not negative";

/// How one column writes its times.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum TimeFormat {
    /// ISO 8601, or the like with a blank or slashes.
    Iso,
    /// Time of day only; the day comes from the options and rolls over at midnight.
    Clock,
    /// A decimal number of units since an epoch, both in nanoseconds.
    Number { unit: Nanoseconds, epoch_s: i64 },
    /// Day, month and year (or month first), then a time of day.
    DayMonthYear { month_first: bool },
    /// A strptime pattern.
    Pattern(String),
}

impl TimeFormat {
    /// A decimal number of units since the Unix epoch.
    const fn unix(unit: Nanoseconds) -> Self {
        Self::Number { unit, epoch_s: 0 }
    }

    /// Seconds since 0001-01-01, as CODESYS and .NET count them.
    const fn seconds_since_year_1() -> Self {
        Self::Number { unit: SECOND, epoch_s: -YEAR_1_DAYS * 86_400 }
    }

    /// The format an option names; `None` stands for sniffing.
    pub(crate) fn from_option(option: &str) -> Result<Option<Self>, &'static str> {
        Ok(Some(match option {
            "auto" | "" => return Ok(None),
            "iso" => Self::Iso,
            "clock" => Self::Clock,
            "s" => Self::unix(SECOND),
            "ms" => Self::unix(1_000_000),
            "us" => Self::unix(1_000),
            "ns" => Self::unix(1),
            "s-year1" => Self::seconds_since_year_1(),
            pattern if pattern.contains('%') => Self::Pattern(pattern.to_owned()),
            _ => return Err("auto, iso, clock, s, ms, us, ns, s-year1 or a strptime pattern"),
        }))
    }

    const fn expected(&self) -> &'static str {
        match self {
            Self::Iso => AN_ISO_TIME,
            Self::Clock => "a time of day like 14:45:34.17",
            Self::Number { .. } => A_NUMBER,
            Self::DayMonthYear { month_first: false } => "a time like 15-04-2024 12:00:00.5",
            Self::DayMonthYear { month_first: true } => "a time like 04-15-2024 12:00:00.5",
            Self::Pattern(_) => "a time in the pattern given as time_format",
        }
    }
}

/// What a look at the first times of a file gave.
pub(crate) struct Sniffed {
    pub(crate) format: TimeFormat,
    pub(crate) notes: Vec<String>,
}

/// Finds the format most of the sample has; `None` where no cell looks like a time.
/// `unit_hint` is the unit a column's name tells, for numbers of no plausible year.
pub(crate) fn sniff<'a>(
    sample: impl Iterator<Item = &'a [u8]> + Clone,
    unit_hint: Option<Nanoseconds>,
) -> Option<Sniffed> {
    let mut notes = Vec::new();
    let count = |format: &TimeFormat| {
        let mut parser = TimeParser::new(format.clone(), 0);
        sample.clone().filter(|cell| parser.parse(cell).is_ok()).count()
    };
    let mut best: Option<(TimeFormat, usize)> = None;
    for format in [
        TimeFormat::Iso,
        TimeFormat::Clock,
        TimeFormat::DayMonthYear { month_first: false },
        TimeFormat::DayMonthYear { month_first: true },
        TimeFormat::unix(SECOND),
    ] {
        let fitting = count(&format);
        if fitting > best.as_ref().map_or(0, |(_, most)| *most) {
            best = Some((format, fitting));
        }
    }
    // Seconds are only one way to read a number, and the others reach further.
    let numbers = sample.clone().filter_map(decimal).count();
    if numbers > best.as_ref().map_or(0, |(_, most)| *most) || {
        matches!(best, Some((TimeFormat::Number { .. }, _)))
    } {
        let format = sniff_number(sample.clone(), unit_hint, &mut notes)?;
        return Some(Sniffed { format, notes });
    }
    let (format, fitting) = best?;
    if let TimeFormat::DayMonthYear { month_first } = format {
        let other = count(&TimeFormat::DayMonthYear { month_first: !month_first });
        notes.push(match (month_first, other == fitting) {
            (true, _) => "dates are read month first: a second number above 12 stands in them".into(),
            (false, true) => "dates are read day first, which the first rows leave open; give time_format if the month stands first".into(),
            (false, false) => "dates are read day first".into(),
        });
    }
    Some(Sniffed { format, notes })
}

/// The unit that puts most numbers between 1990 and 2100.
fn sniff_number<'a>(
    sample: impl Iterator<Item = &'a [u8]> + Clone,
    unit_hint: Option<Nanoseconds>,
    notes: &mut Vec<String>,
) -> Option<TimeFormat> {
    const UNITS: [(Nanoseconds, &str); 4] = [
        (SECOND, "seconds"),
        (1_000_000, "milliseconds"),
        (1_000, "microseconds"),
        (1, "nanoseconds"),
    ];
    let plausible =
        |format: &TimeFormat| sample.clone().filter(|cell| is_plausible(format, cell)).count();
    let mut best = (TimeFormat::unix(SECOND), 0, String::new());
    for (unit, name) in UNITS {
        let format = TimeFormat::unix(unit);
        let fitting = plausible(&format);
        if fitting > best.1 {
            best = (format, fitting, format!("times are {name} since 1970-01-01"));
        }
    }
    let year_1 = TimeFormat::seconds_since_year_1();
    let fitting = plausible(&year_1);
    if fitting > best.1 {
        best = (year_1, fitting, "times are seconds since 0001-01-01".to_owned());
    }
    if best.1 == 0 {
        sample.clone().find_map(decimal)?;
        let unit = unit_hint.unwrap_or(SECOND);
        let name =
            UNITS.iter().find(|(known, _)| *known == unit).map_or("seconds", |known| known.1);
        best.0 = TimeFormat::unix(unit);
        best.2 = format!(
            "times give no year from 1990 to 2100 in any unit: taken as {name} since 1970-01-01; give time_format if that is wrong"
        );
    }
    notes.push(best.2);
    Some(best.0)
}

/// True where a number lies between 1990 and 2100.
fn is_plausible(format: &TimeFormat, cell: &[u8]) -> bool {
    let TimeFormat::Number { unit, epoch_s } = *format else { return false };
    decimal(cell).and_then(|number| number.scaled(unit)).is_some_and(|time| {
        PLAUSIBLE_S.contains(&(time / i128::from(SECOND) + i128::from(epoch_s)))
    })
}

/// True where a number lies between 1990 and 2100 in some unit.
pub(crate) fn is_plausible_number(cell: &[u8]) -> bool {
    [1, 1_000, 1_000_000, SECOND]
        .into_iter()
        .map(TimeFormat::unix)
        .chain([TimeFormat::seconds_since_year_1()])
        .any(|format| is_plausible(&format, cell))
}

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
    /// True once a time without zone was read as UTC.
    assumed_utc: bool,
}

impl TimeParser {
    /// `midnight` is the first day of a file with clock times, in nanoseconds since 1970.
    pub(crate) fn new(format: TimeFormat, midnight: Nanoseconds) -> Self {
        Self { format, midnight, newest: None, cached_date: ([0; 10], 0), assumed_utc: false }
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

/// Midnight of a day written `YYYY-MM-DD`.
pub(crate) fn midnight(date: &str) -> Option<Nanoseconds> {
    let date: &[u8; 10] = date.trim().as_bytes().try_into().ok()?;
    at(iso_date(date)?, 0).ok()
}

/// The unit in a column's name: `time_ms`, `Time [s]`, `t (us)`.
pub(crate) fn unit_in_name(name: &str) -> Option<Nanoseconds> {
    let unit = name.trim_end_matches([']', ')']).rsplit(['[', '(', '_', ' ']).next()?;
    Some(match unit.to_ascii_lowercase().as_str() {
        "s" | "sec" | "seconds" => SECOND,
        "ms" | "msec" | "milliseconds" => 1_000_000,
        "us" | "µs" | "usec" | "microseconds" => 1_000,
        "ns" | "nsec" | "nanoseconds" => 1,
        _ => return None,
    })
}

/// Writes a time as ISO 8601, UTC, with as many groups of three decimals as it needs.
pub(crate) fn write_iso(time: Nanoseconds, into: &mut Vec<u8>) {
    let days = time.div_euclid(DAY);
    let of_day = time.rem_euclid(DAY);
    let (year, month, day) = civil_from_days(days);
    let seconds = of_day / SECOND;
    let fraction = of_day % SECOND;
    push_digits(into, year, 4);
    for (separator, number) in [
        (b'-', month),
        (b'-', day),
        (b'T', seconds / 3600),
        (b':', seconds / 60 % 60),
        (b':', seconds % 60),
    ] {
        into.push(separator);
        push_digits(into, number, 2);
    }
    if fraction != 0 {
        into.push(b'.');
        if fraction % 1_000_000 == 0 {
            push_digits(into, fraction / 1_000_000, 3);
        } else if fraction % 1_000 == 0 {
            push_digits(into, fraction / 1_000, 6);
        } else {
            push_digits(into, fraction, 9);
        }
    }
    into.push(b'Z');
}

fn push_digits(into: &mut Vec<u8>, number: i64, width: usize) {
    let start = into.len();
    into.resize(start + width, b'0');
    let mut left = number;
    for digit in into[start..].iter_mut().rev() {
        *digit = b'0' + (left % 10) as u8;
        left /= 10;
    }
}

fn at(days: i64, of_day: Nanoseconds) -> Result<Nanoseconds, &'static str> {
    // A zone may carry a time across the edge of the range, so the sum is taken wide.
    let time = i128::from(days) * i128::from(DAY) + i128::from(of_day);
    Nanoseconds::try_from(time).map_err(|_| IN_RANGE)
}

fn digit(byte: u8) -> Option<i64> {
    byte.is_ascii_digit().then(|| i64::from(byte - b'0'))
}

fn two_digits(bytes: &[u8]) -> Option<i64> {
    Some(digit(*bytes.first()?)? * 10 + digit(*bytes.get(1)?)?)
}

/// `YYYY-MM-DD` or `YYYY/MM/DD`, as days since 1970-01-01.
fn iso_date(date: &[u8; 10]) -> Option<i64> {
    if !matches!((date[4], date[7]), (b'-', b'-') | (b'/', b'/')) {
        return None;
    }
    let year = two_digits(date)? * 100 + two_digits(&date[2..])?;
    days(year, two_digits(&date[5..])?, two_digits(&date[8..])?)
}

/// Days since 1970-01-01 of a valid date.
fn days(year: i64, month: i64, day: i64) -> Option<i64> {
    let leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    let length = match month {
        2 if leap => 29,
        2 => 28,
        4 | 6 | 9 | 11 => 30,
        1..=12 => 31,
        _ => return None,
    };
    (1..=length).contains(&day).then(|| days_from_civil(year, month, day))
}

/// Howard Hinnant, "chrono-Compatible Low-Level Date Algorithms", `days_from_civil`.
fn days_from_civil(year: i64, month: i64, day: i64) -> i64 {
    let year = if month <= 2 { year - 1 } else { year };
    let era = year.div_euclid(400);
    let year_of_era = year.rem_euclid(400);
    let day_of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    let day_of_era = year_of_era * 365 + year_of_era / 4 - year_of_era / 100 + day_of_year;
    era * 146_097 + day_of_era - 719_468
}

/// The inverse, `civil_from_days` of the same paper.
fn civil_from_days(days: i64) -> (i64, i64, i64) {
    let shifted = days + 719_468;
    let era = shifted.div_euclid(146_097);
    let day_of_era = shifted.rem_euclid(146_097);
    let year_of_era =
        (day_of_era - day_of_era / 1_460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted_month = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * shifted_month + 2) / 5 + 1;
    let month = if shifted_month < 10 { shifted_month + 3 } else { shifted_month - 9 };
    let year = year_of_era + era * 400 + i64::from(month <= 2);
    (year, month, day)
}

/// `H:MM`, `HH:MM:SS` or `HH:MM:SS.fff…`: nanoseconds of the day and what follows.
fn time_of_day(text: &[u8]) -> Option<(Nanoseconds, &[u8])> {
    let (hour, text) = match text {
        [_, b':', rest @ ..] => (digit(text[0])?, rest),
        [_, _, b':', rest @ ..] => (two_digits(text)?, rest),
        _ => return None,
    };
    let minute = two_digits(text)?;
    let text = &text[2..];
    if hour > 23 || minute > 59 {
        return None;
    }
    let minutes = (hour * 60 + minute) * 60 * SECOND;
    let [b':', seconds @ ..] = text else { return Some((minutes, text)) };
    let (second, text) = match seconds {
        [_, next, ..] if next.is_ascii_digit() => (two_digits(seconds)?, &seconds[2..]),
        [_, ..] => (digit(seconds[0])?, &seconds[1..]),
        [] => return None,
    };
    // 60 is a leap second.
    if second > 60 {
        return None;
    }
    let whole = minutes + second * SECOND;
    let [b'.' | b',', fraction @ ..] = text else { return Some((whole, text)) };
    let digits = fraction.iter().take_while(|byte| byte.is_ascii_digit()).count();
    if digits == 0 {
        return None;
    }
    let mut nanoseconds = 0;
    let mut weight = SECOND / 10;
    for &byte in &fraction[..digits.min(9)] {
        nanoseconds += i64::from(byte - b'0') * weight;
        weight /= 10;
    }
    Some((whole + nanoseconds, &fraction[digits..]))
}

/// `Z`, `UTC`, `GMT`, `+HH`, `+HHMM` or `+HH:MM`, in seconds east of Greenwich.
fn zone_offset_s(zone: &[u8]) -> Option<i64> {
    let (sign, digits) = match zone {
        [] | b"Z" | b"z" | b"UTC" | b"GMT" => return Some(0),
        [b'+', digits @ ..] => (1, digits),
        [b'-', digits @ ..] => (-1, digits),
        // U+2212, the typographic minus that ISO 8601 prefers.
        [0xE2, 0x88, 0x92, digits @ ..] => (-1, digits),
        _ => return None,
    };
    let hours = two_digits(digits)?;
    let minutes = match &digits[2..] {
        [] => 0,
        [b':', minutes @ ..] | minutes if minutes.len() == 2 => two_digits(minutes)?,
        _ => return None,
    };
    (hours < 24 && minutes < 60).then_some(sign * (hours * 3600 + minutes * 60))
}

/// `dd-mm-yy HH:MM:SS.ff`, `dd/mm/yyyy,hh:mm:ss`, `dd.mm.yyyy hh:mm:ss`, also month first.
fn day_month_year(cell: &[u8], month_first: bool) -> Option<Result<Nanoseconds, &'static str>> {
    let (first, text) = short_number(cell, 2)?;
    let (separator, text) = text.split_first()?;
    if !matches!(separator, b'-' | b'/' | b'.') {
        return None;
    }
    let (second, text) = short_number(text, 2)?;
    let text = text.strip_prefix(&[*separator])?;
    let digits = text.iter().take_while(|byte| byte.is_ascii_digit()).count();
    let (year, text) = short_number(text, 4)?;
    let year = match digits {
        // POSIX strptime: 69 to 99 lie in the last century.
        2 if year >= 69 => 1900 + year,
        2 => 2000 + year,
        4 => year,
        _ => return None,
    };
    let (month, day) = if month_first { (first, second) } else { (second, first) };
    let days = days(year, month, day)?;
    let text = match text {
        [] => return Some(at(days, 0)),
        [b',' | b'T' | b' ', text @ ..] => text.trim_ascii_start(),
        _ => return None,
    };
    let (of_day, rest) = time_of_day(text)?;
    let half = match rest.trim_ascii() {
        [] => 0,
        b"AM" | b"am" if of_day >= DAY / 2 => -DAY / 2,
        b"AM" | b"am" => 0,
        b"PM" | b"pm" if of_day < DAY / 2 => DAY / 2,
        b"PM" | b"pm" => 0,
        _ => return None,
    };
    Some(at(days, of_day + half))
}

fn short_number(text: &[u8], most: usize) -> Option<(i64, &[u8])> {
    let digits = text.iter().take(most).take_while(|byte| byte.is_ascii_digit()).count();
    let number = text[..digits].iter().fold(0, |sum, byte| sum * 10 + i64::from(byte - b'0'));
    (digits > 0).then_some((number, &text[digits..]))
}

/// A decimal number: `mantissa · 10^exponent`, without the rounding of a float.
#[derive(Debug, Clone, Copy)]
struct Decimal {
    mantissa: i128,
    exponent: i32,
}

impl Decimal {
    /// The number times `unit`, cut to an integer.
    fn scaled(self, unit: i64) -> Option<i128> {
        let product = self.mantissa.checked_mul(i128::from(unit))?;
        let power = 10_i128.checked_pow(self.exponent.unsigned_abs());
        if self.exponent >= 0 {
            product.checked_mul(power?)
        } else {
            Some(power.map_or(0, |power| product / power))
        }
    }
}

fn decimal(cell: &[u8]) -> Option<Decimal> {
    // 25 digits are more than any time needs, and times 10^9 they still fit 128 bits.
    const DIGITS: u32 = 25;
    let (negative, digits) = match cell {
        [b'-', digits @ ..] => (true, digits),
        [b'+', digits @ ..] => (false, digits),
        digits => (false, digits),
    };
    let mut mantissa: i128 = 0;
    let mut exponent: i32 = 0;
    let (mut seen, mut point, mut rest) = (0, false, digits);
    while let [byte, tail @ ..] = rest {
        match byte {
            b'0'..=b'9' => {
                let significant = mantissa != 0 || *byte != b'0';
                if seen < DIGITS {
                    mantissa = mantissa * 10 + i128::from(byte - b'0');
                    seen += u32::from(significant);
                    exponent -= i32::from(point);
                } else {
                    exponent += i32::from(!point);
                }
            }
            b'.' | b',' if !point => point = true,
            b'e' | b'E' if rest.len() < digits.len() => {
                exponent = exponent
                    .checked_add(std::str::from_utf8(tail).ok()?.parse::<i16>().ok()?.into())?;
                break;
            }
            _ => return None,
        }
        rest = tail;
    }
    let has_digit = digits.first()?.is_ascii_digit() || digits.get(1)?.is_ascii_digit();
    has_digit.then_some(Decimal { mantissa: if negative { -mantissa } else { mantissa }, exponent })
}

fn number(cell: &[u8], unit: Nanoseconds, epoch_s: i64) -> Result<Nanoseconds, &'static str> {
    let scaled = if !cell.is_empty() && cell.len() <= 18 && cell.iter().all(u8::is_ascii_digit) {
        let whole = cell.iter().fold(0_i64, |sum, byte| sum * 10 + i64::from(byte - b'0'));
        i128::from(whole) * i128::from(unit)
    } else {
        let number = decimal(cell).ok_or(A_NUMBER)?;
        if number.mantissa < 0 {
            return Err(NOT_NEGATIVE);
        }
        number.scaled(unit).ok_or(IN_RANGE)?
    };
    let time = scaled + i128::from(epoch_s) * i128::from(SECOND);
    Nanoseconds::try_from(time).map_err(|_| IN_RANGE)
}
