//! Arrow batches that are as the contract has them: watched where they lie.
//!
//! Others are brought into a change log first. A dictionary of names is looked up once, however
//! many batches share it.

use arrow_array::cast::AsArray;
use arrow_array::types::{Int32Type, Int64Type, TimestampNanosecondType, UInt32Type};
use arrow_array::{
    Array, DictionaryArray, PrimitiveArray, RecordBatch, RecordBatchReader, StringArray,
};
use arrow_buffer::ScalarBuffer;
use arrow_schema::{ArrowError, DataType, TimeUnit};
use pyo3::prelude::*;

use runglight_engine::log::SignalIndex;
use runglight_engine::signal_state::found::Found;
use runglight_engine::signal_state::monitor::{Keys, MonitorError};

use crate::errors;
use crate::monitor::PyMonitor;

/// A name whose first row has not come yet, or that no model knows.
const UNNUMBERED: SignalIndex = SignalIndex::MAX;

/// The columns of a batch in the contract's schema, nothing missing.
struct Columns {
    time: PrimitiveArray<TimestampNanosecondType>,
    /// Places in the dictionary of names.
    keys: ScalarBuffer<u32>,
    names: StringArray,
    value: PrimitiveArray<Int64Type>,
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
                (signal.keys().values().clone(), signal.values())
            }
            DataType::Dictionary(key, _) if **key == DataType::Int32 => {
                let signal: &DictionaryArray<Int32Type> = signal.as_dictionary_opt()?;
                // A negative one lies beyond every dictionary.
                (signal.keys().values().inner().clone().into(), signal.values())
            }
            _ => return None,
        };
        let names = names.as_string_opt::<i32>()?.clone();
        let largest = keys.iter().copied().max();
        let known = largest.is_none_or(|largest| (largest as usize) < names.len());
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
    keys: Keys,
    /// Some have no number yet.
    unnumbered: bool,
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
        for batch in batches {
            self.take_dictionary(&batch.names);
            self.number(batch);
            let keys = std::mem::take(&mut self.dictionary.keys);
            let taken =
                self.take_columns(batch.time.values(), &batch.keys, batch.value.values(), &keys);
            self.dictionary.keys = keys;
            taken?;
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
        let numbers: Vec<SignalIndex> =
            found.into_iter().map(|known| known.unwrap_or(UNNUMBERED)).collect();
        let unnumbered = numbers.contains(&UNNUMBERED);
        let keys = self.monitor.keys(numbers);
        self.dictionary = Dictionary { names: Some(names.clone()), keys, unnumbered };
        true
    }

    /// Numbers signals that no model knows, in the order of their first rows.
    fn number(&mut self, batch: &Columns) {
        if !self.dictionary.unnumbered {
            return;
        }
        for &key in &batch.keys {
            if self.dictionary.keys.number(key) == UNNUMBERED {
                let number = self.monitor.signal_index(batch.names.value(key as usize), None);
                self.dictionary.keys.renumber(key, number);
            }
        }
    }
}
