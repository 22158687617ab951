//! Which column of a table means what: by option, else by its name, else by its cells.

use std::path::Path;

use crate::error::{FormatError, shortened};
use crate::options::ReadOptions;
use crate::report::ReadReport;
use crate::time::{self, TimeFormat, TimeParser};
use crate::value::Cell;

/// What the first cells of a column look like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Nothing in it.
    Empty,
    /// Only 0, 1, true, false, on and off.
    Truth,
    /// Numbers.
    Number,
    /// A time, or numbers that are a plausible time.
    Time,
    /// Anything else.
    Text,
}

impl Kind {
    /// What most cells of a sample are.
    pub(crate) fn of<'a>(cells: impl Iterator<Item = &'a [u8]> + Clone) -> Self {
        let mut counts = [0_usize; 3];
        for cell in cells.clone() {
            match Cell::parse(cell) {
                Cell::Empty => {}
                Cell::Integer(0 | 1) => counts[0] += 1,
                Cell::Integer(_) | Cell::Real(_) => counts[1] += 1,
                Cell::Text => counts[2] += 1,
            }
        }
        let [truths, numbers, texts] = counts;
        if truths + numbers + texts == 0 {
            return Kind::Empty;
        }
        let numeric = truths + numbers > texts;
        if numeric && numbers == 0 {
            return Kind::Truth;
        }
        if let Some(sniffed) = time::sniff(cells.clone(), None) {
            let is_number = matches!(sniffed.format, TimeFormat::Number { .. });
            let mut parser = TimeParser::new(sniffed.format, 0);
            let plausible = !is_number || plausible_numbers(cells.clone());
            let fitting = cells.filter(|cell| parser.parse(cell).is_ok()).count();
            if plausible && 2 * fitting > truths + numbers + texts {
                return Kind::Time;
            }
        }
        if numeric { Kind::Number } else { Kind::Text }
    }
}

/// True where numbers are times of the years 1990 to 2100 in some unit.
fn plausible_numbers<'a>(cells: impl Iterator<Item = &'a [u8]>) -> bool {
    let mut cells = cells.filter(|cell| !cell.is_empty()).peekable();
    cells.peek().is_some() && cells.all(time::is_plausible_number)
}

/// A column as far as its place is to be decided.
#[derive(Debug, Clone)]
pub(crate) struct Column {
    pub(crate) name: String,
    pub(crate) kind: Kind,
}

/// Where the time stands; some logs split it into a date and a time of day.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct TimeColumns {
    pub(crate) date: Option<usize>,
    pub(crate) time: usize,
}

/// How the columns make up a log.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Layout {
    /// One row per change; without a value column each row is an occurrence.
    Long { time: TimeColumns, signal: Vec<usize>, value: Option<usize> },
    /// One row per sample, one column per signal.
    Wide { time: TimeColumns, columns: Vec<usize> },
}

const TIME_NAMES: [&str; 17] = [
    "timestamp",
    "time",
    "datetime",
    "dateandtime",
    "timestring",
    "timestamputc",
    "timeutc",
    "utc",
    "ts",
    "eventtime",
    "logtime",
    "localtime",
    "timetimestamp",
    "date",
    "zeit",
    "zeitstempel",
    "t",
];
const SIGNAL_NAMES: [&str; 18] = [
    "signal",
    "signalname",
    "symbol",
    "symbolname",
    "tag",
    "tagname",
    "variable",
    "variablename",
    "varname",
    "name",
    "address",
    "itemid",
    "item",
    "nodeid",
    "point",
    "pointname",
    "channel",
    "conceptname",
];
const VALUE_NAMES: [&str; 9] = [
    "value",
    "status",
    "state",
    "val",
    "varvalue",
    "newvalue",
    "symbolvalue",
    "variablevalue",
    "tagvalue",
];

/// A column's name without case, blanks, underscores and punctuation: `_TIMESTAMP`, `Time stamp`.
fn plain(name: &str) -> String {
    let name = name.split(['[', '(']).next().unwrap_or_default();
    name.chars()
        .filter(|character| character.is_alphanumeric())
        .flat_map(char::to_lowercase)
        .collect()
}

/// The first column that bears one of the names, the best name first.
fn by_name(plain_names: &[String], names: &[&str], taken: &[usize]) -> Option<usize> {
    names.iter().find_map(|name| {
        plain_names
            .iter()
            .enumerate()
            .position(|(index, plain)| plain == name && !taken.contains(&index))
    })
}

/// The columns of a long log by their names: time, signal and value.
pub fn columns_of_changes(names: &[String]) -> [Option<usize>; 3] {
    let plain_names: Vec<String> = names.iter().map(|name| plain(name)).collect();
    let mut taken = Vec::new();
    [&TIME_NAMES[..], &SIGNAL_NAMES, &VALUE_NAMES].map(|known| {
        let found = by_name(&plain_names, known, &taken);
        taken.extend(found);
        found
    })
}

/// Finds the layout of a table with a header.
pub(crate) fn recognise(
    path: &Path,
    header_row: u64,
    columns: &[Column],
    options: &ReadOptions,
    report: &mut ReadReport,
) -> Result<Layout, FormatError> {
    let search = Search::of(path, header_row, columns);
    search.columns_named("analog", options.analog.iter().map(|(column, _)| column))?;
    let time = search.time(options, report)?;
    let mut taken = vec![time.time];
    taken.extend(time.date);
    if let Some(layout) = search.long(options, time, &taken, report)? {
        return Ok(layout);
    }
    let converted = search.converted(options)?;
    search.wide(&converted, time, &taken, report)
}

/// Finds the time alone, in a table that holds no log.
pub(crate) fn time_columns(
    path: &Path,
    header_row: u64,
    columns: &[Column],
    options: &ReadOptions,
    report: &mut ReadReport,
) -> Result<TimeColumns, FormatError> {
    Search::of(path, header_row, columns).time(options, report)
}

struct Search<'a> {
    path: &'a Path,
    header_row: u64,
    columns: &'a [Column],
    plain_names: Vec<String>,
}

impl<'a> Search<'a> {
    fn of(path: &'a Path, header_row: u64, columns: &'a [Column]) -> Self {
        let plain_names = columns.iter().map(|column| plain(&column.name)).collect();
        Self { path, header_row, columns, plain_names }
    }

    fn names(&self) -> Vec<String> {
        self.columns.iter().map(|column| column.name.clone()).collect()
    }

    fn missing(&self, role: &'static str, mend: impl Into<String>) -> FormatError {
        FormatError::Columns {
            path: self.path.to_owned(),
            row: self.header_row,
            role,
            columns: self.names(),
            mend: mend.into(),
        }
    }

    /// A column named in an option: exactly, else without case and punctuation.
    fn named(&self, option: &'static str, name: &str) -> Result<usize, FormatError> {
        self.columns
            .iter()
            .position(|column| column.name == name)
            .or_else(|| {
                let wanted = plain(name);
                self.plain_names.iter().position(|plain| !wanted.is_empty() && *plain == wanted)
            })
            .ok_or_else(|| FormatError::UnknownColumn {
                path: self.path.to_owned(),
                option,
                column: name.to_owned(),
                columns: self.names(),
            })
    }

    /// The columns that analog and bits name: exactly, for a plant may have both `M1` and `M_1`.
    fn converted(&self, options: &ReadOptions) -> Result<Vec<usize>, FormatError> {
        let mut columns =
            self.columns_named("analog", options.analog.iter().map(|(column, _)| column))?;
        columns.extend(self.columns_named("bits", options.bits.iter())?);
        Ok(columns)
    }

    fn columns_named<'n>(
        &self,
        option: &'static str,
        names: impl Iterator<Item = &'n String>,
    ) -> Result<Vec<usize>, FormatError> {
        names
            .map(|name| {
                self.columns.iter().position(|column| column.name == *name).ok_or_else(|| {
                    FormatError::UnknownColumn {
                        path: self.path.to_owned(),
                        option,
                        column: name.clone(),
                        columns: self.names(),
                    }
                })
            })
            .collect()
    }

    fn time(
        &self,
        options: &ReadOptions,
        report: &mut ReadReport,
    ) -> Result<TimeColumns, FormatError> {
        if let Some(name) = &options.time_column {
            return Ok(TimeColumns { date: None, time: self.named("time_column", name)? });
        }
        let exactly = |name: &str| self.plain_names.iter().position(|plain| plain == name);
        if let (Some(date), Some(time)) = (exactly("date"), exactly("time"))
            && self.columns[date].kind != Kind::Number
        {
            report.note(format!(
                "columns '{}' and '{}' together give the time",
                self.columns[date].name, self.columns[time].name
            ));
            return Ok(TimeColumns { date: Some(date), time });
        }
        let found = by_name(&self.plain_names, &TIME_NAMES, &[]).or_else(|| {
            self.plain_names
                .iter()
                .position(|plain| plain.starts_with("time") || plain.starts_with("date"))
        });
        if let Some(time) = found {
            return Ok(TimeColumns { date: None, time });
        }
        // No name helps: a first column of times will do, or the only one there is.
        let mut timely =
            (0..self.columns.len()).filter(|&column| self.columns[column].kind == Kind::Time);
        match (timely.next(), timely.next()) {
            (Some(time), None) | (Some(time @ 0), Some(_)) => {
                report.note(format!("column '{}' is taken as the time", self.columns[time].name));
                Ok(TimeColumns { date: None, time })
            }
            _ => Err(self.missing(
                "time column",
                "name it with time_column, or add a header row such as time,signal,value",
            )),
        }
    }

    fn long(
        &self,
        options: &ReadOptions,
        time: TimeColumns,
        taken: &[usize],
        report: &mut ReadReport,
    ) -> Result<Option<Layout>, FormatError> {
        let mut signal = Vec::new();
        for name in &options.signal_columns {
            signal.push(self.named("signal_columns", name)?);
        }
        let named = !signal.is_empty();
        let mut value = match &options.value_column {
            Some(name) => Some(self.named("value_column", name)?),
            None => None,
        };
        if signal.is_empty()
            && value.is_none()
            && let Some(codes) = self.event_codes()
        {
            self.say_occurrences(&codes, report);
            return Ok(Some(self.occurrences(time, codes, taken, report)));
        }
        if signal.is_empty() {
            let taken = [taken, value.as_slice()].concat();
            signal.extend(by_name(&self.plain_names, &SIGNAL_NAMES, &taken));
        }
        if value.is_none() {
            let taken = [taken, &signal].concat();
            value = by_name(&self.plain_names, &VALUE_NAMES, &taken);
        }
        match (signal.is_empty(), value) {
            (true, Some(_)) if options.value_column.is_some() => {
                Err(self.missing("signal column", "name it with signal_columns"))
            }
            (true, _) => Ok(None),
            (false, Some(value)) => {
                let other = self.others(&[taken, &signal, &[value]].concat());
                // In a sampled file, a lamp may be called Signal and a valve Status.
                if !named
                    && options.value_column.is_none()
                    && !other.is_empty()
                    && matches!(self.columns[signal[0]].kind, Kind::Truth)
                {
                    return Ok(None);
                }
                for column in other {
                    report.leave_out(&self.columns[column].name, "neither time, signal nor value");
                }
                Ok(Some(Layout::Long { time, signal, value: Some(value) }))
            }
            (false, None) => {
                let other = self.others(&[taken, &signal].concat());
                if named || (other.is_empty() && self.columns[signal[0]].kind == Kind::Text) {
                    self.say_occurrences(&signal, report);
                    return Ok(Some(self.occurrences(time, signal, taken, report)));
                }
                if self.columns[signal[0]].kind == Kind::Text {
                    return Err(self.missing(
                        "value column",
                        "name it with value_column, or give signal_columns if each row is an occurrence without a value",
                    ));
                }
                Ok(None)
            }
        }
    }

    fn occurrences(
        &self,
        time: TimeColumns,
        signal: Vec<usize>,
        taken: &[usize],
        report: &mut ReadReport,
    ) -> Layout {
        for column in self.others(&[taken, &signal].concat()) {
            report.leave_out(&self.columns[column].name, "neither time nor signal");
        }
        Layout::Long { time, signal, value: None }
    }

    fn say_occurrences(&self, signal: &[usize], report: &mut ReadReport) {
        let names: Vec<_> =
            signal.iter().map(|&column| format!("'{}'", self.columns[column].name)).collect();
        report.note(format!(
            "no value column: each row is an occurrence of the signal named by {}, written as value 1 and then 0 at the same time",
            names.join(", ")
        ));
    }

    /// The traffic controllers' high-resolution log (Sturdevant et al., "Indiana Traffic Signal Hi
    /// Resolution Data Logger Enumerations", 2012): device, event code and its parameter.
    fn event_codes(&self) -> Option<Vec<usize>> {
        let find = |names: &[&str]| by_name(&self.plain_names, names, &[]);
        let event = find(&["eventid", "eventcode"])?;
        let parameter = find(&["parameter", "eventparam", "param", "eventparameter"])?;
        let device = find(&["deviceid", "signalid", "controllerid"]);
        Some(device.into_iter().chain([parameter, event]).collect())
    }

    fn others(&self, taken: &[usize]) -> Vec<usize> {
        (0..self.columns.len())
            .filter(|column| !taken.contains(column) && !self.is_blank(*column))
            .collect()
    }

    /// A trailing delimiter makes a column without name and cells.
    fn is_blank(&self, column: usize) -> bool {
        self.columns[column].name.is_empty() && self.columns[column].kind == Kind::Empty
    }

    fn wide(
        &self,
        wanted: &[usize],
        time: TimeColumns,
        taken: &[usize],
        report: &mut ReadReport,
    ) -> Result<Layout, FormatError> {
        let others = self.others(taken);
        let (texts, columns): (Vec<usize>, Vec<usize>) = others.into_iter().partition(|column| {
            matches!(self.columns[*column].kind, Kind::Text) && !wanted.contains(column)
        });
        if columns.is_empty() && texts.is_empty() {
            return Err(
                self.missing("signal column", "a log needs at least time, signal and value")
            );
        }
        // More text than numbers is a table of events whose signal columns nobody named.
        if texts.len() >= columns.len() {
            const SHOWN: usize = 4;
            let names: Vec<_> = texts
                .iter()
                .take(SHOWN)
                .map(|&text| shortened(self.columns[text].name.as_bytes()))
                .collect();
            return Err(self.missing(
                "signal column and value column",
                format!(
                    "name them with signal_columns and value_column (text stands in {}; with signal_columns alone each row is an occurrence)",
                    names.join(" and ")
                ),
            ));
        }
        for text in texts {
            report.leave_out(&self.columns[text].name, "holds text, not values");
        }
        Ok(Layout::Wide { time, columns })
    }
}
