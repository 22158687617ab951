//! Long text logs: one row per change.

use std::io::Read;

use super::dialect::Dialect;
use super::records::Records;
use super::{TimeCells, fault_of, fields_fault};
use crate::Reading;
use crate::error::{FormatError, RowFault};
use crate::intake::Intake;
use crate::value::{self, Cell};

pub(super) fn read(
    reader: Box<dyn Read>,
    dialect: &Dialect,
    mut times: TimeCells,
    signal: &[usize],
    value: Option<usize>,
    mut intake: Intake,
) -> Result<Reading, FormatError> {
    let mut records = Records::new(reader, dialect.delimiter, dialect.newline);
    let name = |column: usize| dialect.columns[column].name.as_str();
    let value_name = value.map_or("", name);
    let path = intake.path.clone();
    let failed = |error| FormatError::io(&path, "read this file", error);
    let mut joined = Vec::new();
    while let Some(found) = records.advance().map_err(failed)? {
        let row = records.row();
        if row < dialect.first_data_row() {
            continue;
        }
        intake.report.rows += 1;
        if let Some(fault) =
            fault_of(&found).or_else(|| fields_fault(&records, dialect.columns.len()))
        {
            intake.bad(row, fault)?;
            continue;
        }
        let time = match times.parse(&records) {
            Ok(time) => time,
            Err(fault) => {
                intake.bad(row, fault)?;
                continue;
            }
        };
        let number = match value.map(|column| Cell::parse(records.field(column))) {
            None => None,
            Some(Cell::Integer(number)) => Some(number),
            Some(_) => {
                let found = value.map_or(&[][..], |column| records.field(column));
                let fault = RowFault::cell(value_name, found, value::EXPECTED);
                intake.bad(row, fault)?;
                continue;
            }
        };
        let signal_name = match signal {
            [only] => records.field(*only),
            several => {
                joined.clear();
                for (place, &column) in several.iter().enumerate() {
                    if place > 0 {
                        joined.push(b'-');
                    }
                    joined.extend_from_slice(records.field(column));
                }
                &joined
            }
        };
        if signal_name.is_empty() || memchr::memchr(0, signal_name).is_some() {
            let column = signal.first().map_or("", |column| name(*column));
            let fault = RowFault::cell(column, signal_name, "the name of a signal");
            intake.bad(row, fault)?;
            continue;
        }
        if !intake.in_order(row, time)? {
            continue;
        }
        match number {
            Some(number) => intake.push_named(time, signal_name, number),
            None => {
                // An occurrence has no value: the signal goes to 1 and back to 0 at the same time.
                intake.push_named(time, signal_name, 1);
                intake.push_named(time, signal_name, 0);
            }
        }
    }
    times.parser.say(&mut intake.report);
    intake.finish()
}
