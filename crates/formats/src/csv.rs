//! Delimited text: long and wide logs, with or without header.

mod dialect;
mod events;
mod long;
mod records;
mod wide;
mod write;

use std::io::Read;
use std::path::Path;

use runglight_engine::log::Nanoseconds;

use crate::Reading;
use crate::error::{FormatError, RowFault};
use crate::format::Format;
use crate::intake::Intake;
use crate::layout::{self, Layout, TimeColumns};
use crate::options::ReadOptions;
use crate::source::Source;
use crate::time::{self, TimeFormat, TimeParser};
use dialect::Dialect;
use records::{Found, LINE_MOST, Records};

pub use events::{DeclaredEvents, read_events};
pub(crate) use write::write;

/// Reads delimited text.
pub(crate) fn read(
    path: &Path,
    source: Source,
    options: &ReadOptions,
) -> Result<Reading, FormatError> {
    let mut intake = Intake::new(path, Format::Csv, options)?;
    for note in &source.notes {
        intake.report.note(*note);
    }
    let dialect = Dialect::sniff(path, &source.head, source.complete, options)?;
    intake.names.latin_1 = dialect.latin_1;
    let layout = match dialect.headerless_layout(path)? {
        Some(layout) => {
            intake.report.note("no header row: the columns are read as time, signal and value");
            layout
        }
        None => layout::recognise(
            path,
            dialect.header_row,
            &dialect.columns,
            options,
            &mut intake.report,
        )?,
    };
    let (Layout::Long { time, .. } | Layout::Wide { time, .. }) = layout;
    let cells = TimeCells {
        columns: time,
        name: dialect.columns[time.time].name.clone(),
        parser: time_parser(path, &dialect, time, options, &mut intake)?,
        joined: Vec::new(),
    };
    match layout {
        Layout::Long { signal, value, .. } => {
            long::read(source.into_reader(), &dialect, cells, &signal, value, intake)
        }
        Layout::Wide { columns, .. } => {
            wide::read(source, &dialect, cells, &columns, options, intake)
        }
    }
}

/// The time of each record, from one column or two.
#[derive(Clone)]
struct TimeCells {
    columns: TimeColumns,
    name: String,
    parser: TimeParser,
    joined: Vec<u8>,
}

impl TimeCells {
    #[inline]
    fn parse<R: Read>(&mut self, records: &Records<R>) -> Result<Nanoseconds, RowFault> {
        let cell = records.field(self.columns.time);
        let parsed = match self.columns.date {
            None => self.parser.parse(cell),
            Some(date) => {
                join(records.field(date), cell, &mut self.joined);
                self.parser.parse(&self.joined)
            }
        };
        parsed.map_err(|expected| RowFault::cell(&self.name, cell, expected))
    }
}

fn join(date: &[u8], time: &[u8], joined: &mut Vec<u8>) {
    joined.clear();
    joined.extend_from_slice(date);
    joined.push(b' ');
    joined.extend_from_slice(time);
}

/// The parser for a file's times: the format asked for, or the one the first rows have.
fn time_parser(
    path: &Path,
    dialect: &Dialect,
    columns: TimeColumns,
    options: &ReadOptions,
    intake: &mut Intake,
) -> Result<TimeParser, FormatError> {
    let cells: Vec<Vec<u8>> = dialect
        .sample
        .iter()
        .map(|record| {
            let cell = |column: usize| record.get(column).map_or(&[][..], Vec::as_slice);
            let mut joined = Vec::new();
            match columns.date {
                Some(date) => join(cell(date), cell(columns.time), &mut joined),
                None => joined.extend_from_slice(cell(columns.time)),
            }
            joined
        })
        .collect();
    let name = &dialect.columns[columns.time].name;
    parser_for(path, name, cells.iter().map(Vec::as_slice), options, intake)
}

/// The parser for a column of text cells.
pub(crate) fn parser_for<'a>(
    path: &Path,
    column: &str,
    cells: impl Iterator<Item = &'a [u8]> + Clone,
    options: &ReadOptions,
    intake: &mut Intake,
) -> Result<TimeParser, FormatError> {
    let option = |option, found: &str, expected| FormatError::Option {
        path: path.to_owned(),
        option,
        found: found.to_owned(),
        expected,
    };
    let format = match TimeFormat::from_option(&options.time_format)
        .map_err(|expected| option("time_format", &options.time_format, expected))?
    {
        Some(format) => format,
        None => match time::sniff(cells, time::unit_in_name(column)) {
            Some(sniffed) => {
                for note in sniffed.notes {
                    intake.report.note(note);
                }
                sniffed.format
            }
            // No cell looks like a time: ISO says in the first bad row what was expected.
            None => TimeFormat::Iso,
        },
    };
    let midnight = match &options.date {
        Some(date) => {
            time::midnight(date).ok_or_else(|| option("date", date, "a day written YYYY-MM-DD"))?
        }
        None => {
            if format == TimeFormat::Clock {
                intake.report.note(
                    "times have no date: the first day is taken as 1970-01-01; give date for the real one",
                );
            }
            0
        }
    };
    Ok(TimeParser::new(format, midnight))
}

/// What is wrong with something that is not a record.
fn fault_of(found: &Found) -> Option<RowFault> {
    match found {
        Found::Record => None,
        Found::LongLine => Some(RowFault::LongLine { limit_mib: LINE_MOST >> 20 }),
        Found::OpenQuote => Some(RowFault::OpenQuote),
    }
}

/// Too few or too many fields; one empty field behind a trailing delimiter is no fault.
#[inline]
fn fields_fault<R: Read>(records: &Records<R>, expected: usize) -> Option<RowFault> {
    let found = records.len();
    if found == expected || (found == expected + 1 && records.field(expected).is_empty()) {
        return None;
    }
    Some(RowFault::Fields { found, expected })
}
