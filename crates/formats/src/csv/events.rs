//! Declared events: one column `time`, optional `label`.

use std::path::Path;

use runglight_engine::log::Nanoseconds;

use super::dialect::Dialect;
use super::records::Records;
use super::{TimeCells, fault_of, time_parser};
use crate::error::{FormatError, RowFault};
use crate::format::Format;
use crate::intake::Intake;
use crate::layout::{self, Column, Kind, TimeColumns};
use crate::names;
use crate::options::ReadOptions;
use crate::report::ReadReport;
use crate::sniff;
use crate::source::Source;

/// Events in time order.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DeclaredEvents {
    /// When each happened.
    pub time: Vec<Nanoseconds>,
    /// What each is, where it says so.
    pub label: Vec<Option<String>>,
    /// What reading did.
    pub report: ReadReport,
}

/// Reads an `events.csv`: the times of any format a log may have, in any order.
///
/// # Errors
/// A file that cannot be read, has no column of times, or a row whose time is none.
pub fn read_events(path: &Path, options: &ReadOptions) -> Result<DeclaredEvents, FormatError> {
    let source = Source::open(path)?;
    if sniff::format(path, &source.head, options.format)? != Format::Csv {
        return Err(FormatError::NotALog {
            path: path.to_owned(),
            found: "no text with delimiters",
            mend: "events are declared in a CSV file with a column 'time'",
        });
    }
    let mut intake = Intake::new(path, Format::Csv, options)?;
    let mut dialect = Dialect::sniff(path, &source.head, source.complete, options)?;
    take_single_column(&mut dialect);
    let columns = if dialect.headerless {
        TimeColumns { date: None, time: 0 }
    } else {
        let (row, columns) = (dialect.header_row, &dialect.columns);
        layout::time_columns(path, row, columns, options, &mut intake.report)?
    };
    let label = dialect.columns.iter().position(|c| c.name.trim().eq_ignore_ascii_case("label"));
    let parser = time_parser(path, &dialect, columns, options, &mut intake)?;
    let name = dialect.columns[columns.time].name.clone();
    let mut times = TimeCells { columns, name, parser, joined: Vec::new() };
    let mut records = Records::new(source.into_reader(), dialect.delimiter, dialect.newline);
    let failed = |error| FormatError::io(path, "read this file", error);
    let mut events = Vec::new();
    while let Some(found) = records.advance().map_err(failed)? {
        let row = records.row();
        if row < dialect.first_data_row() {
            continue;
        }
        intake.report.rows += 1;
        let too_short = || {
            let (found, expected) = (records.len(), dialect.columns.len());
            let needed = columns.time.max(columns.date.unwrap_or(0));
            (found <= needed).then_some(RowFault::Fields { found, expected })
        };
        if let Some(fault) = fault_of(&found).or_else(too_short) {
            intake.bad(row, fault)?;
            continue;
        }
        match times.parse(&records) {
            Ok(time) => {
                let said = label.filter(|&l| l < records.len()).map(|l| records.field(l));
                let said = said.map(<[u8]>::trim_ascii).filter(|text| !text.is_empty());
                events.push((time, said.map(names::decode)));
            }
            Err(fault) => intake.bad(row, fault)?,
        }
    }
    times.parser.say(&mut intake.report);
    events.sort_by_key(|(time, _)| *time);
    let (time, label) = events.into_iter().unzip();
    Ok(DeclaredEvents { time, label, report: intake.report })
}

/// A list of times alone needs no header.
fn take_single_column(dialect: &mut Dialect) {
    if let [only] = dialect.columns.as_mut_slice()
        && !dialect.headerless
        && Kind::of([only.name.as_bytes()].into_iter()) == Kind::Time
    {
        dialect.headerless = true;
        dialect.sample.insert(0, vec![only.name.clone().into_bytes()]);
        *only = Column { name: "column 1".to_owned(), kind: Kind::Time };
    }
}
