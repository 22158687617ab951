//! Parquet: our own files and anybody else's, long and wide.

use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use arrow_array::{Array, RecordBatch};
use parquet::arrow::ArrowWriter;
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::{ParquetRecordBatchReader, ParquetRecordBatchReaderBuilder};
use parquet::basic::{Compression, ZstdLevel};
use parquet::errors::ParquetError;
use parquet::file::metadata::{KeyValue, ParquetMetaData};
use parquet::file::properties::WriterProperties;
use runglight_engine::log::{ChangeLog, Gap, Nanoseconds};

use crate::Reading;
use crate::arrow;
use crate::columns::{self, Cells, Names, Times};
use crate::csv::parser_for;
use crate::error::{FormatError, RowFault};
use crate::format::Format;
use crate::intake::Intake;
use crate::layout::{self, Column, Layout, TimeColumns};
use crate::options::{OnError, ReadOptions};
use crate::sampler::{Reorder, Sampler};
use crate::source;
use crate::time::TimeParser;
use crate::value::Cell;

const SCAN_INTERVAL: &str = "runglight.scan_interval_ns";
const GAPS: &str = "runglight.gaps";
/// Rows in one batch when reading, and in one row group when writing.
const BATCH: usize = 16_384;
const ROW_GROUP: usize = 1 << 20;
/// More than this unpacked, at this ratio to the file, is no log but a bomb.
const UNPACKED_FREE: u64 = 4 << 30;
const RATIO_MOST: u64 = 1_000;

/// Reads a Parquet file.
pub(crate) fn read(path: &Path, options: &ReadOptions) -> Result<Reading, FormatError> {
    // The decoder trusts lengths in the file here and there; damaged ones can make it panic.
    catch_unwind(AssertUnwindSafe(|| ParquetFile { path, options }.read())).unwrap_or_else(|_| {
        Err(FormatError::damaged(path, "Parquet", "its pages contradict its footer"))
    })
}

struct ParquetFile<'a> {
    path: &'a Path,
    options: &'a ReadOptions,
}

impl ParquetFile<'_> {
    fn damaged(&self, error: ParquetError) -> FormatError {
        FormatError::damaged(self.path, "Parquet", error)
    }

    fn open(&self) -> Result<ParquetRecordBatchReaderBuilder<std::fs::File>, FormatError> {
        let file = source::open_file(self.path)?;
        ParquetRecordBatchReaderBuilder::try_new(file).map_err(|error| self.damaged(error))
    }

    fn read(&self) -> Result<Reading, FormatError> {
        let mut intake = Intake::new(self.path, Format::Parquet, self.options)?;
        let builder = self.open()?;
        self.check_size(builder.metadata())?;
        restore(builder.metadata(), &mut intake);
        let fields: Vec<String> =
            builder.schema().fields().iter().map(|field| field.name().clone()).collect();
        let first = builder
            .with_batch_size(500)
            .build()
            .map_err(|error| self.damaged(error))?
            .next()
            .transpose()
            .map_err(|error| FormatError::damaged(self.path, "Parquet", error))?
            .unwrap_or_else(|| {
                RecordBatch::new_empty(std::sync::Arc::new(arrow_schema::Schema::empty()))
            });
        let columns: Vec<Column> = fields
            .iter()
            .enumerate()
            .map(|(index, name)| Column {
                name: name.clone(),
                kind: first.columns().get(index).map_or(layout::Kind::Empty, columns::kind),
            })
            .collect();
        let layout = layout::recognise(self.path, 1, &columns, self.options, &mut intake.report)?;
        let (Layout::Long { time, .. } | Layout::Wide { time, .. }) = &layout;
        let parser = self.time_parser(*time, &columns, &first, &mut intake)?;
        match layout {
            Layout::Long { time, signal, value } => {
                self.long(&columns, time, &signal, value, parser, intake)
            }
            Layout::Wide { time, columns: kept } => {
                self.wide(&columns, time, &kept, parser, intake)
            }
        }
    }

    /// Refuses files that say they unpack to what no machine writes down.
    fn check_size(&self, metadata: &ParquetMetaData) -> Result<(), FormatError> {
        let packed = source::open_file(self.path)?
            .metadata()
            .map_err(|error| FormatError::io(self.path, "read this file", error))?
            .len();
        let unpacked = metadata
            .row_groups()
            .iter()
            .map(|group| u64::try_from(group.total_byte_size()).unwrap_or(u64::MAX))
            .fold(0, u64::saturating_add);
        let limit = UNPACKED_FREE.max(packed.saturating_mul(RATIO_MOST));
        if unpacked > limit {
            return Err(FormatError::TooLarge {
                path: self.path.to_owned(),
                packed_mib: packed.div_ceil(1 << 20),
                limit_mib: limit >> 20,
            });
        }
        Ok(())
    }

    fn time_parser(
        &self,
        time: TimeColumns,
        columns: &[Column],
        first: &RecordBatch,
        intake: &mut Intake,
    ) -> Result<TimeParser, FormatError> {
        let texts: Vec<Vec<u8>> = match times_of(first, time.date, Some(time.time)) {
            Some(Times::Written(cells)) => (0..first.num_rows())
                .map(|row| {
                    let mut text = Vec::new();
                    cells.text(row, &mut text);
                    text
                })
                .collect(),
            _ => Vec::new(),
        };
        let texts = texts.iter().map(Vec::as_slice).filter(|text| !text.is_empty());
        parser_for(self.path, &columns[time.time].name, texts, self.options, intake)
    }

    /// Batches of some columns, in the order of the file.
    fn batches(&self, wanted: &[usize]) -> Result<ParquetRecordBatchReader, FormatError> {
        let builder = self.open()?;
        let mask = ProjectionMask::roots(builder.parquet_schema(), wanted.iter().copied());
        builder
            .with_projection(mask)
            .with_batch_size(BATCH)
            .build()
            .map_err(|error| self.damaged(error))
    }

    fn unusable(
        &self,
        column: &Column,
        batch: &RecordBatch,
        place: usize,
        role: &'static str,
    ) -> FormatError {
        let found = batch.column(place).data_type().to_string();
        FormatError::Columns {
            path: self.path.to_owned(),
            row: 1,
            role,
            columns: vec![column.name.clone()],
            mend: format!("its type {found} cannot be one"),
        }
    }

    fn long(
        &self,
        columns: &[Column],
        time: TimeColumns,
        signal: &[usize],
        value: Option<usize>,
        mut parser: TimeParser,
        mut intake: Intake,
    ) -> Result<Reading, FormatError> {
        let mut wanted = vec![time.time];
        wanted.extend(time.date);
        wanted.extend(signal);
        wanted.extend(value);
        let places = Places::new(&wanted);
        let name = |column: usize| columns[column].name.as_str();
        let (mut text, mut joined) = (Vec::new(), String::new());
        for batch in self.batches(&wanted)? {
            let batch = batch.map_err(|error| FormatError::damaged(self.path, "Parquet", error))?;
            let array = |column: usize| batch.column(places.of(column));
            let refuse = |column: usize, role| {
                self.unusable(&columns[column], &batch, places.of(column), role)
            };
            let times = times_of(&batch, places.find(time.date), places.find(Some(time.time)))
                .ok_or_else(|| refuse(time.time, "time column"))?;
            let mut names = Vec::new();
            for &column in signal {
                names.push(
                    Names::new(array(column)).ok_or_else(|| refuse(column, "signal column"))?,
                );
            }
            let values = match value {
                Some(column) => {
                    Some(Cells::new(array(column)).ok_or_else(|| refuse(column, "value column"))?)
                }
                None => None,
            };
            for at in 0..batch.num_rows() {
                intake.report.rows += 1;
                let row = intake.report.rows;
                let read = || -> Result<_, RowFault> {
                    let time = times.time(at, name(time.time), &mut parser, &mut text)?;
                    let number = match (&values, value) {
                        (Some(cells), Some(column)) => Some(cells.integer(at, name(column))?),
                        _ => None,
                    };
                    for (names, &column) in names.iter().zip(signal) {
                        if names.name(at).is_none() {
                            let column = name(column).to_owned();
                            return Err(RowFault::EmptyCell {
                                column,
                                expected: "the name of a signal",
                            });
                        }
                    }
                    Ok((time, number))
                };
                let (time, number) = match { read }() {
                    Ok(read) => read,
                    Err(fault) => {
                        intake.bad(row, fault)?;
                        continue;
                    }
                };
                if !intake.in_order(row, time)? {
                    continue;
                }
                let index = match names.as_mut_slice() {
                    [only] => match only.intern(at, name(signal[0]), &mut intake.names) {
                        Ok(index) => index,
                        Err(fault) => {
                            intake.bad(row, fault)?;
                            continue;
                        }
                    },
                    several => {
                        joined.clear();
                        for (place, names) in several.iter().enumerate() {
                            if place > 0 {
                                joined.push('-');
                            }
                            joined.push_str(names.name(at).unwrap_or_default());
                        }
                        intake.names.intern(joined.as_bytes())
                    }
                };
                match number {
                    Some(number) => intake.push(time, index, number),
                    None => intake.push_pulse(time, index),
                }
            }
        }
        parser.say(&mut intake.report);
        intake.finish()
    }

    fn wide(
        &self,
        columns: &[Column],
        time: TimeColumns,
        kept: &[usize],
        mut parser: TimeParser,
        mut intake: Intake,
    ) -> Result<Reading, FormatError> {
        let mut wanted = vec![time.time];
        wanted.extend(time.date);
        wanted.extend(kept);
        let places = Places::new(&wanted);
        let mut sampler =
            Sampler::new(kept.iter().map(|&column| columns[column].name.clone()), self.options);
        let mut waiting: Reorder<(u64, Vec<Cell>)> = Reorder::new(intake.reorder());
        let mut text = Vec::new();
        let take = |sampler: &mut Sampler, time: Nanoseconds, (row, cells): (u64, Vec<Cell>)| {
            sampler.sample(time);
            for (column, cell) in cells.into_iter().enumerate() {
                sampler.cell(column, row, cell, if cell == Cell::Text { b"text" } else { b"" });
            }
        };
        for batch in self.batches(&wanted)? {
            let batch = batch.map_err(|error| FormatError::damaged(self.path, "Parquet", error))?;
            let times = times_of(&batch, places.find(time.date), places.find(Some(time.time)))
                .ok_or_else(|| {
                    self.unusable(&columns[time.time], &batch, places.of(time.time), "time column")
                })?;
            let cells: Vec<Option<Cells>> =
                kept.iter().map(|&column| Cells::new(batch.column(places.of(column)))).collect();
            for at in 0..batch.num_rows() {
                intake.report.rows += 1;
                let row = intake.report.rows;
                let time = times.time(at, &columns[time.time].name, &mut parser, &mut text);
                let late = matches!(time, Ok(time) if intake.is_late(time));
                if (late || time.is_err())
                    && intake.on_error() == OnError::Fail
                    && let Some((row, fault)) = sampler.first_bad()
                {
                    intake.bad(row, fault)?;
                }
                let time = match time {
                    Ok(time) => time,
                    Err(fault) => {
                        intake.bad(row, fault)?;
                        continue;
                    }
                };
                if !intake.in_order(row, time)? {
                    continue;
                }
                let sample = cells
                    .iter()
                    .map(|cells| cells.as_ref().map_or(Cell::Text, |cells| cells.cell(at)))
                    .collect();
                waiting.put(time, (row, sample));
                while let Some((time, sample)) = waiting.take(false) {
                    take(&mut sampler, time, sample);
                }
            }
        }
        while let Some((time, sample)) = waiting.take(true) {
            take(&mut sampler, time, sample);
        }
        parser.say(&mut intake.report);
        sampler.finish(&mut intake)?;
        intake.finish()
    }
}

/// The times of a batch, from one column or from a date and a time of day.
fn times_of(batch: &RecordBatch, date: Option<usize>, time: Option<usize>) -> Option<Times> {
    let time = batch.columns().get(time?)?;
    match date {
        None => Times::new(time),
        Some(date) => Times::new(&columns::joined(batch.columns().get(date)?, time)?),
    }
}

/// Where columns of the file stand in a projected batch, which keeps the file's order.
struct Places(Vec<usize>);

impl Places {
    fn new(wanted: &[usize]) -> Self {
        let mut places = wanted.to_vec();
        places.sort_unstable();
        places.dedup();
        Self(places)
    }

    fn find(&self, column: Option<usize>) -> Option<usize> {
        column.map(|column| self.of(column))
    }

    fn of(&self, column: usize) -> usize {
        self.0.binary_search(&column).unwrap_or_else(|place| place)
    }
}

/// Takes what our own writer noted down beside the rows.
fn restore(metadata: &ParquetMetaData, intake: &mut Intake) {
    for entry in metadata.file_metadata().key_value_metadata().into_iter().flatten() {
        let Some(text) = &entry.value else { continue };
        let understood = match entry.key.as_str() {
            SCAN_INTERVAL => {
                text.parse().map(|interval| intake.scan_interval = Some(interval)).is_ok()
            }
            GAPS => serde_json::from_str::<Vec<Gap>>(text).map(|gaps| intake.gaps = gaps).is_ok(),
            _ => true,
        };
        if !understood {
            intake
                .report
                .note(format!("the note {} in the file is damaged and not used", entry.key));
        }
    }
}

/// Writes a log in the contract schema, with its scan interval and gaps beside it.
pub(crate) fn write(log: &ChangeLog, into: &mut (impl Write + Send)) -> Result<(), ParquetError> {
    let mut notes = Vec::new();
    if let Some(interval) = log.scan_interval {
        notes.push(KeyValue::new(SCAN_INTERVAL.to_owned(), interval.to_string()));
    }
    if !log.gaps.is_empty() {
        let gaps = serde_json::to_string(&log.gaps)
            .map_err(|error| ParquetError::External(Box::new(error)))?;
        notes.push(KeyValue::new(GAPS.to_owned(), gaps));
    }
    let properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::try_new(3)?))
        .set_created_by(concat!("runglight ", env!("CARGO_PKG_VERSION")).to_owned())
        .set_key_value_metadata((!notes.is_empty()).then_some(notes))
        .build();
    let mut writer = ArrowWriter::try_new(into, arrow::schema(), Some(properties))?;
    for offset in (0..log.len()).step_by(ROW_GROUP) {
        writer.write(&arrow::rows_to_batch(log, offset, ROW_GROUP))?;
    }
    writer.close()?;
    Ok(())
}
