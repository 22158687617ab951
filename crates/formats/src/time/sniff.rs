//! Finds out how a column writes its times, by a look at the first of them.

use runglight_engine::log::{Nanoseconds, SECOND};

use super::decimal::decimal;
use super::{TimeFormat, TimeParser};

/// 1990-01-01 and 2100-01-01 in Unix seconds: the years a machine's log is taken to be from.
const PLAUSIBLE_S: std::ops::Range<i128> = 631_152_000..4_102_444_800;

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
