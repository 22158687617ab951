//! Record batches over the Arrow C stream interface.

use std::sync::Arc;

use arrow_array::{RecordBatch, StructArray};
use arrow_schema::{DataType, Field};
use pyo3::prelude::*;
use pyo3::types::PyCapsule;
use pyo3_arrow::ffi::{ArrayIterator, to_stream_pycapsule};

/// One batch as a stream capsule.
pub fn export<'py>(
    py: Python<'py>,
    batch: RecordBatch,
    requested_schema: Option<Bound<'py, PyCapsule>>,
) -> PyResult<Bound<'py, PyCapsule>> {
    let field = Field::new("", DataType::Struct(batch.schema().fields().clone()), false)
        .with_metadata(batch.schema().metadata().clone());
    let array: arrow_array::ArrayRef = Arc::new(StructArray::from(batch));
    let reader = ArrayIterator::new([Ok(array)], Arc::new(field));
    to_stream_pycapsule(py, Box::new(reader), requested_schema).map_err(Into::into)
}
