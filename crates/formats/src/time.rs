//! Times as logs write them, parsed exactly to the nanosecond.

mod calendar;
mod decimal;
mod parser;
mod sniff;
mod text;
mod write;

use runglight_engine::log::{Nanoseconds, SECOND};

pub(crate) use parser::TimeParser;
pub(crate) use sniff::{is_plausible_number, sniff};
pub(crate) use text::midnight;
pub(crate) use write::write_iso;

/// Days from 0001-01-01 to 1970-01-01.
const YEAR_1_DAYS: i64 = 719_162;

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
