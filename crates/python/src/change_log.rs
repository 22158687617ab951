//! `ChangeLog`, and reading and writing it.

use std::path::Path;

use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyCapsule;
use pyo3_arrow::PyRecordBatchReader;

use runglight_engine::log::{ChangeLog, Gap, SECOND};
use runglight_formats::{Format, ReadOptions};

use crate::errors;
use crate::stream;

/// A change log in memory.
#[pyclass(name = "ChangeLog", module = "runglight._engine", frozen)]
pub struct PyChangeLog {
    pub log: ChangeLog,
    report_json: String,
}

type Columns<'py> =
    (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<u32>>, Bound<'py, PyArray1<i64>>);

impl PyChangeLog {
    pub fn new(log: ChangeLog) -> Self {
        let report = serde_json::json!({
            "format": null, "rows": log.len(), "bad_rows": 0, "bad": [], "left_out": [], "notes": [],
        });
        Self { log, report_json: report.to_string() }
    }

    /// Reads anything with `__arrow_c_stream__`.
    pub fn from_stream(
        py: Python<'_>,
        reader: PyRecordBatchReader,
        reorder_s: f64,
    ) -> PyResult<ChangeLog> {
        let reader = reader.into_reader()?;
        let reorder = (reorder_s * SECOND as f64) as i64;
        py.detach(|| runglight_formats::arrow::from_batches(reader, reorder)).map_err(errors::input)
    }
}

#[pymethods]
impl PyChangeLog {
    #[staticmethod]
    #[pyo3(signature = (table, reorder_s = 1.0))]
    fn from_arrow(py: Python<'_>, table: PyRecordBatchReader, reorder_s: f64) -> PyResult<Self> {
        Self::from_stream(py, table, reorder_s).map(Self::new)
    }

    fn __len__(&self) -> usize {
        self.log.len()
    }

    #[pyo3(signature = (requested_schema = None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyCapsule>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        let batch = py.detach(|| runglight_formats::arrow::to_batch(&self.log));
        stream::export(py, batch, requested_schema)
    }

    #[getter]
    fn signals(&self) -> Vec<String> {
        self.log.signals.clone()
    }

    #[getter]
    fn start_ns(&self) -> Option<i64> {
        self.log.time.first().copied()
    }

    #[getter]
    fn end_ns(&self) -> Option<i64> {
        self.log.time.last().copied()
    }

    #[getter]
    fn scan_interval_ns(&self) -> Option<i64> {
        self.log.scan_interval
    }

    #[getter]
    fn gaps(&self) -> Vec<(i64, i64)> {
        self.log.gaps.iter().map(|gap| (gap.start, gap.end)).collect()
    }

    #[getter]
    fn report_json(&self) -> String {
        self.report_json.clone()
    }

    fn with_signals(&self, signals: Vec<String>) -> PyResult<Self> {
        if signals.len() != self.log.signals.len() {
            let (found, expected) = (signals.len(), self.log.signals.len());
            return Err(errors::input(format!("{found} names for {expected} signals")));
        }
        let log = ChangeLog { signals, ..self.log.clone() };
        Ok(Self { log, report_json: self.report_json.clone() })
    }

    /// The signal an address is, or the word and the bit of it.
    fn find_address(&self, address: &str) -> Option<(String, Option<u32>)> {
        runglight_engine::bits::find_address(&self.log.signals, address)
            .map(|(signal, bit)| (signal.to_owned(), bit))
    }

    /// The same log with some of its words split into bits.
    fn split_words(&self, py: Python<'_>, words: Vec<String>) -> PyResult<Self> {
        let log = py
            .detach(|| runglight_engine::bits::split_words(&self.log, &words))
            .map_err(errors::input)?;
        Ok(Self { log, report_json: self.report_json.clone() })
    }

    /// Rows `offset..offset + length`; a gap goes with the first row after it.
    #[pyo3(signature = (offset, length = None))]
    fn slice(&self, offset: usize, length: Option<usize>) -> Self {
        let start = offset.min(self.log.len());
        let end = length.map_or(self.log.len(), |l| (start + l).min(self.log.len()));
        Self::new(ChangeLog {
            signals: self.log.signals.clone(),
            time: self.log.time[start..end].to_vec(),
            signal: self.log.signal[start..end].to_vec(),
            value: self.log.value[start..end].to_vec(),
            scan_interval: self.log.scan_interval,
            gaps: self.log.gaps_among(start..end).copied().collect(),
        })
    }

    fn columns<'py>(&self, py: Python<'py>) -> Columns<'py> {
        (
            self.log.time.clone().into_pyarray(py),
            self.log.signal.clone().into_pyarray(py),
            self.log.value.clone().into_pyarray(py),
        )
    }
}

/// Reads a log file.
#[pyfunction]
#[pyo3(signature = (path, options_json = "{}"))]
pub fn read_log(py: Python<'_>, path: &str, options_json: &str) -> PyResult<PyChangeLog> {
    let options: ReadOptions = serde_json::from_str(options_json)
        .map_err(|error| errors::input(format!("reader options: {error}")))?;
    let reading =
        py.detach(|| runglight_formats::read(Path::new(path), &options)).map_err(errors::input)?;
    let report_json = serde_json::to_string(&reading.report).map_err(errors::input)?;
    Ok(PyChangeLog { log: reading.log, report_json })
}

/// Writes a log file; returns rows written.
#[pyfunction]
#[pyo3(signature = (log, path, format = None))]
pub fn write_log(
    py: Python<'_>,
    log: &PyChangeLog,
    path: &str,
    format: Option<&str>,
) -> PyResult<u64> {
    let path = Path::new(path);
    let format = match format {
        Some(name) => Some(Format::from_name(name).ok_or_else(|| {
            errors::input(format!("no format '{name}'; use csv, parquet, xes or vcd"))
        })?),
        None => None,
    };
    py.detach(|| runglight_formats::write(&log.log, path, format)).map_err(errors::input)
}

/// A log from three numpy arrays and the names the indices stand for.
#[pyfunction]
#[pyo3(signature = (time_ns, signal_index, value, signals, scan_interval_ns = None, gaps = Vec::new()))]
pub fn log_from_columns(
    time_ns: PyReadonlyArray1<'_, i64>,
    signal_index: PyReadonlyArray1<'_, u32>,
    value: PyReadonlyArray1<'_, i64>,
    signals: Vec<String>,
    scan_interval_ns: Option<i64>,
    gaps: Vec<(i64, i64)>,
) -> PyResult<PyChangeLog> {
    let mut log = ChangeLog {
        signals,
        time: time_ns.as_array().to_vec(),
        signal: signal_index.as_array().to_vec(),
        value: value.as_array().to_vec(),
        scan_interval: scan_interval_ns,
        gaps: in_order(gaps)?,
    };
    log.sort_within(0).map_err(errors::input)?;
    Ok(PyChangeLog::new(log))
}

/// Gaps by the time of the first row after them, as learning and watching walk through them.
fn in_order(gaps: Vec<(i64, i64)>) -> PyResult<Vec<Gap>> {
    if let Some((start, end)) = gaps.iter().find(|(start, end)| end < start) {
        return Err(errors::input(format!("a gap ends at {end}, before it starts at {start}")));
    }
    let mut gaps: Vec<Gap> = gaps.into_iter().map(|(start, end)| Gap { start, end }).collect();
    gaps.sort_by_key(|gap| (gap.end, gap.start));
    Ok(gaps)
}
