//! The pieces of a written time: a date, a time of day, a zone.

use runglight_engine::log::{Nanoseconds, SECOND};

use super::calendar::{DAY, at, days};

/// Midnight of a day written `YYYY-MM-DD`.
pub(crate) fn midnight(date: &str) -> Option<Nanoseconds> {
    let date: &[u8; 10] = date.trim().as_bytes().try_into().ok()?;
    at(iso_date(date)?, 0).ok()
}

fn digit(byte: u8) -> Option<i64> {
    byte.is_ascii_digit().then(|| i64::from(byte - b'0'))
}

fn two_digits(bytes: &[u8]) -> Option<i64> {
    Some(digit(*bytes.first()?)? * 10 + digit(*bytes.get(1)?)?)
}

/// `YYYY-MM-DD` or `YYYY/MM/DD`, as days since 1970-01-01.
pub(super) fn iso_date(date: &[u8; 10]) -> Option<i64> {
    if !matches!((date[4], date[7]), (b'-', b'-') | (b'/', b'/')) {
        return None;
    }
    let year = two_digits(date)? * 100 + two_digits(&date[2..])?;
    days(year, two_digits(&date[5..])?, two_digits(&date[8..])?)
}

/// `H:MM`, `HH:MM:SS` or `HH:MM:SS.fff…`: nanoseconds of the day and what follows.
pub(super) fn time_of_day(text: &[u8]) -> Option<(Nanoseconds, &[u8])> {
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
    let (of_minute, text) = time_of_minute(seconds)?;
    Some((minutes + of_minute, text))
}

/// `S`, `SS` or `SS.fff…`: nanoseconds of the minute and what follows.
#[inline]
pub(super) fn time_of_minute(seconds: &[u8]) -> Option<(Nanoseconds, &[u8])> {
    let (second, text) = match seconds {
        [_, next, ..] if next.is_ascii_digit() => (two_digits(seconds)?, &seconds[2..]),
        [_, ..] => (digit(seconds[0])?, &seconds[1..]),
        [] => return None,
    };
    // 60 is a leap second.
    if second > 60 {
        return None;
    }
    let whole = second * SECOND;
    let [b'.' | b',', fraction @ ..] = text else { return Some((whole, text)) };
    let (mut number, mut digits) = (0, 0);
    while let Some(byte) = fraction.get(digits).filter(|byte| byte.is_ascii_digit()) {
        if digits < MOST_DIGITS {
            number = number * 10 + i64::from(byte - b'0');
        }
        digits += 1;
    }
    if digits == 0 {
        return None;
    }
    Some((whole + number * WEIGHT_OF_LAST[digits.min(MOST_DIGITS)], &fraction[digits..]))
}

/// Digits of a fraction that count; what is finer than a nanosecond is dropped.
const MOST_DIGITS: usize = 9;
/// Nanoseconds that the last of so many digits of a fraction counts.
const WEIGHT_OF_LAST: [i64; MOST_DIGITS + 1] =
    [SECOND, 100_000_000, 10_000_000, 1_000_000, 100_000, 10_000, 1_000, 100, 10, 1];

/// `Z`, `UTC`, `GMT`, `+HH`, `+HHMM` or `+HH:MM`, in seconds east of Greenwich.
pub(super) fn zone_offset_s(zone: &[u8]) -> Option<i64> {
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
pub(super) fn day_month_year(
    cell: &[u8],
    month_first: bool,
) -> Option<Result<Nanoseconds, &'static str>> {
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
