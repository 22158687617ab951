//! Wide text logs: one row per sample, one column per signal.

use std::io::Read;

use super::dialect::Dialect;
use super::records::Records;
use super::{TimeCells, fault_of, fields_fault};
use crate::Reading;
use crate::error::FormatError;
use crate::intake::Intake;
use crate::options::{OnError, ReadOptions};
use crate::sampler::{Reorder, Sampler};
use crate::source::Source;
use crate::value::Cell;

pub(super) fn read(
    source: Source,
    dialect: &Dialect,
    times: TimeCells,
    columns: &[usize],
    options: &ReadOptions,
    mut intake: Intake,
) -> Result<Reading, FormatError> {
    let names = dialect.unique_names();
    let sampler = || Sampler::new(columns.iter().map(|&column| names[column].clone()), options);
    let told = intake.report.clone();
    let mut file = WideFile {
        records: Records::new(source.into_reader(), dialect.delimiter, dialect.newline),
        dialect,
        times: times.clone(),
        columns,
        sampler: sampler(),
    };
    if !file.read_in_order(&mut intake)? {
        // Some rows stand before earlier ones: read again, holding rows back.
        let path = intake.path.clone();
        intake = Intake::new(&path, told.format, options)?;
        intake.report = told;
        intake.names.latin_1 = dialect.latin_1;
        file.records =
            Records::new(Source::open(&path)?.into_reader(), dialect.delimiter, dialect.newline);
        file.times = times;
        file.sampler = sampler();
        file.read_reordered(&mut intake)?;
    }
    file.times.parser.say(&mut intake.report);
    file.sampler.finish(&mut intake)?;
    intake.finish()
}

/// A row that waits for earlier ones: its number and its cells, text ones with their bytes.
type Waiting = (u64, Vec<(Cell, Box<[u8]>)>);

struct WideFile<'a> {
    records: Records<Box<dyn Read>>,
    dialect: &'a Dialect,
    times: TimeCells,
    columns: &'a [usize],
    sampler: Sampler,
}

impl WideFile<'_> {
    /// Goes to the next usable record and gives its time; `None` at the end.
    fn advance(&mut self, intake: &mut Intake) -> Result<Option<i64>, FormatError> {
        loop {
            let found = self
                .records
                .advance()
                .map_err(|error| FormatError::io(&intake.path, "read this file", error))?;
            let Some(found) = found else { return Ok(None) };
            let row = self.records.row();
            if row < self.dialect.first_data_row() {
                continue;
            }
            intake.report.rows += 1;
            let fault = fault_of(&found)
                .or_else(|| fields_fault(&self.records, self.dialect.columns.len()));
            let time = match fault {
                Some(fault) => Err(fault),
                None => self.times.parse(&self.records),
            };
            match time {
                Ok(time) => return Ok(Some(time)),
                Err(fault) => {
                    self.stop_at_earlier(intake)?;
                    intake.bad(row, fault)?;
                }
            }
        }
    }

    /// A bad cell waits until its column is known to be kept; a bad row behind it comes second.
    fn stop_at_earlier(&self, intake: &mut Intake) -> Result<(), FormatError> {
        match self.sampler.first_bad() {
            Some((row, fault)) if intake.on_error() == OnError::Fail => intake.bad(row, fault),
            _ => Ok(()),
        }
    }

    /// Reads while times do not go back; false where they do.
    fn read_in_order(&mut self, intake: &mut Intake) -> Result<bool, FormatError> {
        let mut newest = i64::MIN;
        // Most cells repeat the row before: their bytes are compared before they are parsed.
        let mut before: Vec<Vec<u8>> = vec![Vec::new(); self.columns.len()];
        while let Some(time) = self.advance(intake)? {
            if time < newest {
                return Ok(false);
            }
            let is_first = newest == i64::MIN;
            newest = time;
            self.sampler.sample(time);
            let row = self.records.row();
            for (index, &column) in self.columns.iter().enumerate() {
                let bytes = self.records.field(column);
                let same = before[index] == bytes;
                if same && !is_first && !bytes.is_empty() || self.sampler.is_left_out(index) {
                    continue;
                }
                let cell = Cell::parse(bytes);
                self.sampler.cell(index, row, cell, bytes);
                before[index].clear();
                // A bad cell is bad again in the next row.
                if matches!(cell, Cell::Integer(_) | Cell::Real(_)) {
                    before[index].extend_from_slice(bytes);
                }
            }
        }
        Ok(true)
    }

    fn read_reordered(&mut self, intake: &mut Intake) -> Result<(), FormatError> {
        let mut waiting = Reorder::new(intake.reorder());
        while let Some(time) = self.advance(intake)? {
            let row = self.records.row();
            let late = intake.is_late(time);
            if late {
                self.stop_at_earlier(intake)?;
            }
            if !intake.in_order(row, time)? {
                continue;
            }
            let cells: Vec<(Cell, Box<[u8]>)> = self
                .columns
                .iter()
                .map(|&column| {
                    let bytes = self.records.field(column);
                    match Cell::parse(bytes) {
                        Cell::Text => (Cell::Text, bytes.into()),
                        cell => (cell, Box::default()),
                    }
                })
                .collect();
            waiting.put(time, (row, cells));
            while let Some((time, sample)) = waiting.take(false) {
                self.take(time, sample);
            }
        }
        while let Some((time, sample)) = waiting.take(true) {
            self.take(time, sample);
        }
        Ok(())
    }

    fn take(&mut self, time: i64, (row, cells): Waiting) {
        self.sampler.sample(time);
        for (index, (cell, bytes)) in cells.into_iter().enumerate() {
            self.sampler.cell(index, row, cell, &bytes);
        }
    }
}
