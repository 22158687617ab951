//! Arrow batches that are as the contract has them: watched where they lie.
//!
//! Others are brought into a change log first. A dictionary of names is looked up once, however
//! many batches share it.

use arrow_array::cast::AsArray;
use arrow_array::types::{Int32Type, Int64Type, TimestampNanosecondType, UInt32Type};
use arrow_array::{
    Array, DictionaryArray, PrimitiveArray, RecordBatch, RecordBatchReader, StringArray,
};
use arrow_schema::{ArrowError, DataType, TimeUnit};
use pyo3::prelude::*;

use runglight_engine::log::SignalIndex;
use runglight_engine::signal_state::events::Row;
use runglight_engine::signal_state::found::Found;
use runglight_engine::signal_state::monitor::MonitorError;

use crate::errors;
use crate::monitor::{CHUNK_ROWS, PyMonitor};

/// A name whose first row has not come yet, or that no model knows.
const UNNUMBERED: SignalIndex = SignalIndex::MAX;

/// The columns of a batch in the contract's schema, nothing missing.
struct Columns {
    time: PrimitiveArray<TimestampNanosecondType>,
    keys: Keys,
    names: StringArray,
    value: PrimitiveArray<Int64Type>,
}

enum Keys {
    Unsigned(PrimitiveArray<UInt32Type>),
    Signed(PrimitiveArray<Int32Type>),
}

impl Keys {
    /// Places in the dictionary of some rows, where they lie or in `room`; a negative key lies
    /// beyond every dictionary.
    fn of<'a>(&'a self, rows: std::ops::Range<usize>, room: &'a mut Vec<u32>) -> &'a [u32] {
        match self {
            Self::Unsigned(keys) => &keys.values()[rows],
            Self::Signed(keys) => {
                room.clear();
                room.extend(keys.values()[rows].iter().map(|&key| key as u32));
                room
            }
        }
    }

    fn largest(&self) -> Option<u32> {
        match self {
            Self::Unsigned(keys) => keys.values().iter().copied().max(),
            Self::Signed(keys) => keys.values().iter().map(|&key| key as u32).max(),
        }
    }
}

impl Columns {
    /// `None` where anything is not as the contract has it.
    fn of(batch: &RecordBatch) -> Option<Self> {
        let time = batch.column_by_name("time")?;
        let signal = batch.column_by_name("signal")?;
        let value = batch.column_by_name("value")?;
        let whole = time.null_count() == 0 && signal.null_count() == 0 && value.null_count() == 0;
        if !whole || !matches!(time.data_type(), DataType::Timestamp(TimeUnit::Nanosecond, _)) {
            return None;
        }
        let (keys, names) = match signal.data_type() {
            DataType::Dictionary(key, _) if **key == DataType::UInt32 => {
                let signal: &DictionaryArray<UInt32Type> = signal.as_dictionary_opt()?;
                (Keys::Unsigned(signal.keys().clone()), signal.values())
            }
            DataType::Dictionary(key, _) if **key == DataType::Int32 => {
                let signal: &DictionaryArray<Int32Type> = signal.as_dictionary_opt()?;
                (Keys::Signed(signal.keys().clone()), signal.values())
            }
            _ => return None,
        };
        let names = names.as_string_opt::<i32>()?.clone();
        let known = keys.largest().is_none_or(|largest| (largest as usize) < names.len());
        known.then_some(Self {
            time: time.as_primitive_opt()?.clone(),
            keys,
            names,
            value: value.as_primitive_opt()?.clone(),
        })
    }
}

/// True where the rows of all batches are in time order.
fn in_order(batches: &[Columns]) -> bool {
    let mut newest = i64::MIN;
    batches.iter().all(|batch| {
        let times = batch.time.values();
        let Some((&first, &last)) = times.first().zip(times.last()) else { return true };
        let follows = first >= newest && times.is_sorted();
        newest = last;
        follows
    })
}

/// The names of a dictionary and their numbers in the model.
#[derive(Default)]
pub struct Dictionary {
    names: Option<StringArray>,
    numbers: Vec<SignalIndex>,
}

impl Dictionary {
    /// True where the names are those of the last batch, the very same memory.
    fn is_of(&self, names: &StringArray) -> bool {
        self.names.as_ref().is_some_and(|known| {
            known.len() == names.len()
                && known.offsets().inner().ptr_eq(names.offsets().inner())
                && known.values().ptr_eq(names.values())
        })
    }
}

impl PyMonitor {
    /// Watches all batches of a stream.
    pub fn watch_stream(&mut self, reader: impl RecordBatchReader) -> PyResult<Found> {
        let batches: Vec<Result<RecordBatch, ArrowError>> = reader.collect();
        let columns: Option<Vec<Columns>> = batches
            .iter()
            .map(|batch| Columns::of(batch.as_ref().ok()?))
            .collect::<Option<_>>()
            .filter(|columns: &Vec<Columns>| in_order(columns))
            .filter(|columns| columns.iter().all(|batch| self.take_dictionary(&batch.names)));
        match columns {
            Some(columns) => self.watch_columns(&columns).map_err(errors::input),
            None => {
                let log =
                    runglight_formats::arrow::from_batches(batches, 0).map_err(errors::input)?;
                self.watch(&log).map_err(errors::input)
            }
        }
    }

    fn watch_columns(&mut self, batches: &[Columns]) -> Result<Found, MonitorError> {
        let mut rows: Vec<Row> = Vec::with_capacity(CHUNK_ROWS);
        let mut room: Vec<u32> = Vec::new();
        for batch in batches {
            self.take_dictionary(&batch.names);
            let length = batch.time.len();
            for start in (0..length).step_by(CHUNK_ROWS) {
                let end = length.min(start + CHUNK_ROWS);
                let keys = batch.keys.of(start..end, &mut room);
                let columns = batch.time.values()[start..end]
                    .iter()
                    .zip(&batch.value.values()[start..end])
                    .zip(keys);
                let numbers = &self.dictionary.numbers;
                let mut numbered = true;
                rows.clear();
                rows.extend(columns.map(|((&time, &value), &key)| {
                    let signal = numbers[key as usize];
                    numbered &= signal != UNNUMBERED;
                    Row { time, signal, value }
                }));
                if !numbered {
                    self.number(&mut rows, keys, &batch.names);
                }
                self.naming.keep_own(&mut rows);
                self.monitor.take_rows(&rows)?;
            }
        }
        Ok(self.monitor.take_found())
    }

    /// Looks the names up, unless they are known; false where one is missing or empty.
    fn take_dictionary(&mut self, names: &StringArray) -> bool {
        if self.dictionary.is_of(names) {
            return true;
        }
        if names.null_count() > 0 || names.offsets().lengths().any(|length| length == 0) {
            return false;
        }
        let found = self.naming.find_all(names.iter().flatten());
        let numbers = found.into_iter().map(|known| known.unwrap_or(UNNUMBERED)).collect();
        self.dictionary = Dictionary { names: Some(names.clone()), numbers };
        true
    }

    /// Numbers signals that no model knows, in the order of their first rows.
    fn number(&mut self, rows: &mut [Row], keys: &[u32], names: &StringArray) {
        for (row, &key) in rows.iter_mut().zip(keys).filter(|(row, _)| row.signal == UNNUMBERED) {
            row.signal = self.monitor.signal_index(names.value(key as usize), None);
            self.dictionary.numbers[key as usize] = row.signal;
        }
    }
}
