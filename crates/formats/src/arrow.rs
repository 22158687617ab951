//! Change logs as Arrow tables.

use std::sync::Arc;

use arrow_array::{
    Array, ArrayRef, DictionaryArray, Int64Array, RecordBatch, StringArray,
    TimestampNanosecondArray, UInt32Array,
};
use arrow_schema::{ArrowError, DataType, Field, Schema, SchemaRef, TimeUnit};
use runglight_engine::log::{ChangeLog, Nanoseconds};

use crate::columns::{Cells, Names, Times};
use crate::error::{FormatError, RowFault, TableFault};
use crate::names::SignalNames;
use crate::time::{TimeFormat, TimeParser};

/// The contract schema: `time` timestamp\[ns, UTC\], `signal` dictionary\<uint32, utf8\>,
/// `value` int64.
pub fn schema() -> SchemaRef {
    Arc::new(Schema::new(vec![
        Field::new("time", DataType::Timestamp(TimeUnit::Nanosecond, Some("UTC".into())), false),
        Field::new(
            "signal",
            DataType::Dictionary(Box::new(DataType::UInt32), Box::new(DataType::Utf8)),
            false,
        ),
        Field::new("value", DataType::Int64, false),
    ]))
}

/// The log as one batch in the contract schema.
///
/// A log whose columns differ in length, or that names a signal it does not have, is cut off
/// there; [`ChangeLog::sort_within`] tells such a log.
pub fn to_batch(log: &ChangeLog) -> RecordBatch {
    rows_to_batch(log, 0, log.len())
}

/// Some rows of a log as a batch.
pub(crate) fn rows_to_batch(log: &ChangeLog, offset: usize, length: usize) -> RecordBatch {
    let whole = log.time.len().min(log.signal.len()).min(log.value.len());
    let end = (offset + length).min(whole);
    let start = offset.min(end);
    let known =
        log.signal[start..end].iter().take_while(|&&index| (index as usize) < log.signals.len());
    let end = start + known.count();
    let names = StringArray::from_iter_values(&log.signals);
    let time = TimestampNanosecondArray::from_iter_values(log.time[start..end].iter().copied());
    let keys = UInt32Array::from_iter_values(log.signal[start..end].iter().copied());
    let value = Int64Array::from_iter_values(log.value[start..end].iter().copied());
    let batch = DictionaryArray::try_new(keys, Arc::new(names)).and_then(|signal| {
        let columns: Vec<ArrayRef> =
            vec![Arc::new(time.with_timezone("UTC")), Arc::new(signal), Arc::new(value)];
        RecordBatch::try_new(schema(), columns)
    });
    // Keys lie in the dictionary and all columns have one length, so this is never empty-handed.
    batch.unwrap_or_else(|_| RecordBatch::new_empty(schema()))
}

/// A log from batches with the columns `time`, `signal` and `value`.
///
/// Names may be any Arrow string, dictionary-encoded or not; times any timestamp; values any
/// integer, truth value, or float that is an integer. A time without a zone is UTC.
///
/// # Errors
/// A column is missing or of a type that cannot be used, a null, a value that is no integer, or
/// rows older than the reorder window.
pub fn from_batches(
    batches: impl IntoIterator<Item = Result<RecordBatch, ArrowError>>,
    reorder: Nanoseconds,
) -> Result<ChangeLog, FormatError> {
    let mut names = SignalNames::default();
    let mut log = ChangeLog::default();
    for batch in batches {
        let batch = batch.map_err(|error| {
            FormatError::Table(TableFault::Source { reason: error.to_string() })
        })?;
        append(&batch, &mut names, &mut log).map_err(FormatError::Table)?;
    }
    log.signals = names.into_names();
    log.sort_within(reorder)?;
    Ok(log)
}

fn append(
    batch: &RecordBatch,
    names: &mut SignalNames,
    log: &mut ChangeLog,
) -> Result<(), TableFault> {
    let [times, signals, values] =
        [column(batch, "time")?, column(batch, "signal")?, column(batch, "value")?];
    let times = match Times::new(times) {
        Some(ticks @ Times::Ticks { .. }) => ticks,
        _ => return Err(wrong_type("time", times, "a timestamp")),
    };
    let is_null = |array: &ArrayRef| *array.data_type() == DataType::Null && !array.is_empty();
    let mut signals = match Names::new(signals) {
        Some(names) if signals.data_type() != &DataType::Boolean && !is_null(signals) => names,
        _ => return Err(wrong_type("signal", signals, "a string or a dictionary of strings")),
    };
    let values = match Cells::new(values) {
        Some(cells) if !values.data_type().is_string() && !is_null(values) => cells,
        _ => return Err(wrong_type("value", values, "an integer or a boolean")),
    };
    let mut parser = TimeParser::new(TimeFormat::Iso, 0);
    let mut text = Vec::new();
    let done = log.len();
    log.time.reserve(batch.num_rows());
    log.signal.reserve(batch.num_rows());
    log.value.reserve(batch.num_rows());
    // Columns already as the contract has them are taken whole.
    let whole = match (&times, &values) {
        (Times::Ticks { ticks, unit: 1 }, Cells::Integers(integers))
            if ticks.null_count() == 0 && integers.null_count() == 0 =>
        {
            log.time.extend_from_slice(ticks.values());
            log.value.extend_from_slice(integers.values());
            true
        }
        _ => false,
    };
    for row in 0..batch.num_rows() {
        let bad = |reason: RowFault| TableFault::Row { row: (done + row + 1) as u64, reason };
        if !whole {
            log.time.push(times.time(row, "time", &mut parser, &mut text).map_err(bad)?);
            log.value.push(values.integer(row, "value").map_err(bad)?);
        }
        log.signal.push(signals.intern(row, "signal", names).map_err(bad)?);
    }
    Ok(())
}

fn column<'a>(batch: &'a RecordBatch, name: &'static str) -> Result<&'a ArrayRef, TableFault> {
    batch.column_by_name(name).ok_or_else(|| TableFault::Missing {
        column: name,
        columns: batch.schema().fields().iter().map(|field| field.name().clone()).collect(),
    })
}

fn wrong_type(column: &str, array: &ArrayRef, expected: &'static str) -> TableFault {
    TableFault::Type { column: column.to_owned(), found: array.data_type().to_string(), expected }
}
