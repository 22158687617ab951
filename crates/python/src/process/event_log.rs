//! `EventLog`: the runs of a machine.

use std::path::Path;
use std::sync::Arc;

use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;

use runglight_engine::naming::NamingRule;
use runglight_engine::plant::{Plant, SignalClass};
use runglight_engine::process::event_log::EventLog;
use runglight_engine::process::reset::Reset;
use runglight_engine::process::slicing::Slicing;
use runglight_engine::symbols::SymbolTable;

use crate::change_log::PyChangeLog;
use crate::errors;

/// An event log in memory.
#[pyclass(name = "EventLog", module = "runglight._engine", frozen)]
pub struct PyEventLog {
    pub log: Arc<EventLog>,
}

type Columns<'py> =
    (Bound<'py, PyArray1<u32>>, Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<u64>>);

impl PyEventLog {
    pub fn new(log: EventLog) -> Self {
        Self { log: Arc::new(log) }
    }
}

/// What γ is called in Python.
pub fn class_name(class: Option<SignalClass>) -> Option<&'static str> {
    class.map(|class| match class {
        SignalClass::Input => "input",
        SignalClass::Memory => "memory",
        SignalClass::Output => "output",
    })
}

#[pymethods]
impl PyEventLog {
    #[staticmethod]
    fn from_traces(traces: Vec<Vec<String>>) -> Self {
        let names = traces.iter().map(|trace| trace.iter().map(String::as_str));
        Self::new(EventLog::from_traces(names))
    }

    #[staticmethod]
    fn read_xes(py: Python<'_>, path: &str) -> PyResult<Self> {
        let read = py.detach(|| runglight_formats::event_log::read(Path::new(path)));
        Ok(Self::new(read.map_err(errors::input)?))
    }

    fn write_xes(&self, py: Python<'_>, path: &str) -> PyResult<()> {
        py.detach(|| runglight_formats::event_log::write(&self.log, Path::new(path)))
            .map_err(errors::input)
    }

    fn __len__(&self) -> usize {
        self.log.len()
    }

    #[getter]
    fn traces(&self) -> usize {
        self.log.traces()
    }

    #[getter]
    fn activities(&self) -> Vec<(String, Option<&'static str>)> {
        self.log.activities.iter().map(|a| (a.name.clone(), class_name(a.class))).collect()
    }

    #[getter]
    fn names(&self) -> Vec<String> {
        self.log.names.clone()
    }

    fn columns<'py>(&self, py: Python<'py>) -> Columns<'py> {
        let bounds: Vec<u64> = self.log.bounds.iter().map(|&bound| bound as u64).collect();
        (
            self.log.activity.clone().into_pyarray(py),
            self.log.time.clone().into_pyarray(py),
            bounds.into_pyarray(py),
        )
    }

    fn select(&self, traces: Vec<usize>) -> PyResult<Self> {
        if let Some(beyond) = traces.iter().find(|&&trace| trace >= self.log.traces()) {
            let count = self.log.traces();
            return Err(errors::input(format!("there is no trace {beyond}; the log has {count}")));
        }
        Ok(Self::new(self.log.select(&traces)))
    }
}

/// Cuts an I/O log into runs.
#[pyfunction]
#[pyo3(signature = (log, reset, symbols_csv = None, naming = None, keep_partial = false, only = Vec::new()))]
pub fn event_log(
    py: Python<'_>,
    log: &PyChangeLog,
    reset: &str,
    symbols_csv: Option<&str>,
    naming: Option<&str>,
    keep_partial: bool,
    only: Vec<String>,
) -> PyResult<PyEventLog> {
    let table =
        symbols_csv.map(SymbolTable::parse).transpose().map_err(errors::input)?.unwrap_or_default();
    let rule =
        naming.map(NamingRule::parse).transpose().map_err(errors::input)?.unwrap_or_default();
    let log = &log.log;
    if let Some(unknown) = only.iter().find(|name| !log.signals.contains(name)) {
        return Err(errors::input(format!("the log has no signal '{unknown}'")));
    }
    let sliced = py.detach(|| {
        let plant = Plant::arrange(&log.signals, &table, &rule);
        let only = match only.as_slice() {
            [] => Vec::new(),
            names => log.signals.iter().map(|signal| names.contains(signal)).collect(),
        };
        let slicing = Slicing { reset: Reset::parse(reset, &plant)?, keep_partial, only };
        EventLog::from_change_log(log, &plant, &slicing)
    });
    Ok(PyEventLog::new(sliced.map_err(errors::input)?))
}
