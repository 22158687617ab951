//! Arrow columns of any fitting type, seen as times, names or values.

use std::io::Write;

use arrow_array::cast::AsArray;
use arrow_array::types::Int64Type;
use arrow_array::{Array, ArrayRef, Float64Array, Int64Array, StringArray};
use arrow_schema::{DataType, TimeUnit};
use runglight_engine::log::{Nanoseconds, SECOND, SignalIndex};

use crate::error::RowFault;
use crate::layout::Kind;
use crate::names::SignalNames;
use crate::time::TimeParser;
use crate::value::{self, Cell};

/// A column without dictionary encoding.
fn plain(array: &ArrayRef) -> Option<ArrayRef> {
    match array.data_type() {
        DataType::Dictionary(_, values) => arrow_cast::cast(array, values).ok(),
        _ => Some(array.clone()),
    }
}

/// A column of numbers, truth values or text.
#[derive(Debug, Clone)]
pub(crate) enum Cells {
    Integers(Int64Array),
    Reals(Float64Array),
    Texts(StringArray),
}

impl Cells {
    /// `None` where the type holds no values.
    pub(crate) fn new(array: &ArrayRef) -> Option<Self> {
        use DataType::{
            Boolean, Decimal32, Decimal64, Decimal128, Decimal256, Float16, Float32, Float64,
            LargeUtf8, Null, Time32, Time64, Utf8, Utf8View,
        };
        let array = plain(array)?;
        let cast = |to: &DataType| arrow_cast::cast(&array, to).ok();
        let kind = array.data_type().clone();
        Some(match kind {
            Boolean => Self::Integers(cast(&DataType::Int64)?.as_primitive::<Int64Type>().clone()),
            // Beyond 63 bits the cast gives null, which no row may have; text keeps the number.
            DataType::UInt64 => Self::Texts(cast(&Utf8)?.as_string::<i32>().clone()),
            _ if kind.is_integer() => {
                Self::Integers(cast(&DataType::Int64)?.as_primitive::<Int64Type>().clone())
            }
            Float16 | Float32 | Float64 => Self::Reals(cast(&Float64)?.as_primitive().clone()),
            Utf8 | LargeUtf8 | Utf8View | Null | Time32(_) | Time64(_) | Decimal32(..)
            | Decimal64(..) | Decimal128(..) | Decimal256(..) => {
                Self::Texts(cast(&Utf8)?.as_string::<i32>().clone())
            }
            _ => return None,
        })
    }

    pub(crate) fn cell(&self, row: usize) -> Cell {
        match self {
            Self::Integers(array) if array.is_valid(row) => Cell::Integer(array.value(row)),
            Self::Reals(array) if array.is_valid(row) => Cell::from_real(array.value(row)),
            Self::Texts(array) if array.is_valid(row) => {
                Cell::parse(array.value(row).trim().as_bytes())
            }
            _ => Cell::Empty,
        }
    }

    /// The cell as text; floats as the shortest text that gives them back.
    pub(crate) fn text(&self, row: usize, into: &mut Vec<u8>) {
        into.clear();
        // Writing into a vector cannot fail.
        let _ = match self {
            Self::Integers(array) if array.is_valid(row) => write!(into, "{}", array.value(row)),
            Self::Reals(array) if array.is_valid(row) => write!(into, "{}", array.value(row)),
            Self::Texts(array) if array.is_valid(row) => {
                into.extend_from_slice(array.value(row).trim().as_bytes());
                Ok(())
            }
            _ => Ok(()),
        };
    }

    /// An integer, or what is wrong with the cell.
    pub(crate) fn integer(&self, row: usize, column: &str) -> Result<i64, RowFault> {
        match self.cell(row) {
            Cell::Integer(number) => Ok(number),
            _ => {
                let mut found = Vec::new();
                self.text(row, &mut found);
                Err(RowFault::cell(column, &found, value::EXPECTED))
            }
        }
    }
}

/// A date and a time of day as one column of text; `None` where they have no text.
pub(crate) fn joined(date: &ArrayRef, time: &ArrayRef) -> Option<ArrayRef> {
    let texts = |array: &ArrayRef| arrow_cast::cast(&plain(array)?, &DataType::Utf8).ok();
    let (dates, times) = (texts(date)?, texts(time)?);
    let pairs = dates.as_string::<i32>().iter().zip(times.as_string::<i32>().iter());
    let joined: StringArray =
        pairs.map(|(date, time)| Some(format!("{} {}", date?, time?))).collect();
    Some(std::sync::Arc::new(joined))
}

/// A column of times.
pub(crate) enum Times {
    /// Ticks of so many nanoseconds since 1970.
    Ticks { ticks: Int64Array, unit: Nanoseconds },
    /// Anything that a [`TimeParser`] must read.
    Written(Cells),
}

impl Times {
    /// `None` where the type holds no times.
    pub(crate) fn new(array: &ArrayRef) -> Option<Self> {
        let array = plain(array)?;
        let (unit, array) = match array.data_type() {
            DataType::Timestamp(unit, _) => (*unit, array.clone()),
            DataType::Date32 | DataType::Date64 => {
                let unit = TimeUnit::Millisecond;
                (unit, arrow_cast::cast(&array, &DataType::Timestamp(unit, None)).ok()?)
            }
            _ => return Cells::new(&array).map(Self::Written),
        };
        let ticks = arrow_cast::cast(&array, &DataType::Int64).ok()?;
        let unit = match unit {
            TimeUnit::Second => SECOND,
            TimeUnit::Millisecond => 1_000_000,
            TimeUnit::Microsecond => 1_000,
            TimeUnit::Nanosecond => 1,
        };
        Some(Self::Ticks { ticks: ticks.as_primitive().clone(), unit })
    }

    pub(crate) fn time(
        &self,
        row: usize,
        column: &str,
        parser: &mut TimeParser,
        text: &mut Vec<u8>,
    ) -> Result<Nanoseconds, RowFault> {
        match self {
            Self::Ticks { ticks, unit } if ticks.is_valid(row) => {
                ticks.value(row).checked_mul(*unit).ok_or_else(|| RowFault::Cell {
                    column: column.to_owned(),
                    found: ticks.value(row).to_string(),
                    expected: "a time between the years 1678 and 2261",
                })
            }
            Self::Ticks { .. } => {
                Err(RowFault::EmptyCell { column: column.to_owned(), expected: "a time" })
            }
            Self::Written(cells) => {
                cells.text(row, text);
                parser.parse(text).map_err(|expected| RowFault::cell(column, text, expected))
            }
        }
    }
}

/// A column of signal names; each name of its dictionary is looked up once.
pub(crate) enum Names {
    Dictionary {
        keys: Vec<usize>,
        nulls: Option<arrow_buffer::NullBuffer>,
        values: StringArray,
        known: Vec<Option<SignalIndex>>,
    },
    Plain(StringArray),
}

impl Names {
    /// `None` where the type holds no names.
    pub(crate) fn new(array: &ArrayRef) -> Option<Self> {
        if let Some(dictionary) = array.as_any_dictionary_opt()
            && !dictionary.values().is_empty()
        {
            let values = Self::strings(dictionary.values())?;
            let known = vec![None; values.len()];
            let nulls = dictionary.keys().nulls().cloned();
            return Some(Self::Dictionary {
                keys: dictionary.normalized_keys(),
                nulls,
                values,
                known,
            });
        }
        Self::strings(&plain(array)?).map(Self::Plain)
    }

    fn strings(array: &ArrayRef) -> Option<StringArray> {
        let fits = array.data_type().is_string()
            || array.data_type().is_integer()
            || matches!(array.data_type(), DataType::Null | DataType::Boolean);
        fits.then(|| arrow_cast::cast(array, &DataType::Utf8).ok())?
            .map(|array| array.as_string::<i32>().clone())
    }

    /// The name in a row, where there is one.
    pub(crate) fn name(&self, row: usize) -> Option<&str> {
        let (values, place) = match self {
            Self::Dictionary { keys, nulls, values, .. } => {
                if nulls.as_ref().is_some_and(|nulls| nulls.is_null(row)) {
                    return None;
                }
                (values, keys[row])
            }
            Self::Plain(values) => (values, row),
        };
        values.is_valid(place).then(|| values.value(place)).filter(|name| !name.is_empty())
    }

    /// The number of the name in a row.
    #[inline]
    pub(crate) fn intern(
        &mut self,
        row: usize,
        column: &str,
        names: &mut SignalNames,
    ) -> Result<SignalIndex, RowFault> {
        if let Self::Dictionary { keys, known, nulls: None, .. } = self
            && let Some(index) = known[keys[row]]
        {
            return Ok(index);
        }
        let Some(name) = self.name(row) else {
            return Err(RowFault::EmptyCell {
                column: column.to_owned(),
                expected: "the name of a signal",
            });
        };
        let index = names.intern(name.as_bytes());
        if let Self::Dictionary { keys, known, .. } = self {
            known[keys[row]] = Some(index);
        }
        Ok(index)
    }
}

/// What a column's type and first cells look like.
pub(crate) fn kind(array: &ArrayRef) -> Kind {
    match array.data_type() {
        DataType::Timestamp(..) | DataType::Date32 | DataType::Date64 => return Kind::Time,
        DataType::Boolean => return Kind::Truth,
        _ => {}
    }
    let Some(cells) = Cells::new(array) else { return Kind::Text };
    let texts: Vec<Vec<u8>> = (0..array.len().min(500))
        .map(|row| {
            let mut text = Vec::new();
            cells.text(row, &mut text);
            text
        })
        .collect();
    match Kind::of(texts.iter().map(Vec::as_slice)) {
        Kind::Empty if array.data_type().is_string() => Kind::Text,
        kind => kind,
    }
}
