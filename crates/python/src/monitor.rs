//! `Monitor`: observe and advance.

use std::collections::HashMap;
use std::sync::Arc;

use pyo3::prelude::*;
use pyo3_arrow::PyRecordBatchReader;

use runglight_engine::finding::Finding;
use runglight_engine::log::{ChangeLog, SignalIndex};
use runglight_engine::signal_state::events::Row;
use runglight_engine::signal_state::model::NominalModel;
use runglight_engine::signal_state::monitor::{Monitor, MonitorError};

use crate::change_log::PyChangeLog;
use crate::errors;
use crate::findings::PyFindings;

/// Watches one plant.
#[pyclass(name = "Monitor", module = "runglight._engine")]
pub struct PyMonitor {
    monitor: Monitor,
    signals: Arc<HashMap<String, SignalIndex>>,
}

impl PyMonitor {
    pub fn new(model: Arc<NominalModel>, state: Option<&[u8]>) -> Result<Self, MonitorError> {
        let signals = (0..).zip(&model.plant.signals).map(|(i, s)| (s.symbol.clone(), i)).collect();
        let monitor = match state {
            Some(bytes) => Monitor::restore(model, bytes)?,
            None => Monitor::new(model),
        };
        Ok(Self { monitor, signals: Arc::new(signals) })
    }

    /// Rows up to each gap, the gap, the rows after it.
    fn watch(&mut self, log: &ChangeLog) -> Result<Vec<Finding>, MonitorError> {
        let signals = Arc::clone(&self.signals);
        let numbers: Vec<SignalIndex> = log
            .signals
            .iter()
            .map(|symbol| self.monitor.signal_index(symbol, signals.get(symbol).copied()))
            .collect();
        let rows: Vec<Row> = (0..log.len())
            .map(|row| Row {
                time: log.time[row],
                signal: numbers[log.signal[row] as usize],
                value: log.value[row],
            })
            .collect();
        let mut findings = Vec::new();
        let mut rest = rows.as_slice();
        for gap in &log.gaps {
            let (before, after) = rest.split_at(rest.partition_point(|row| row.time < gap.end));
            findings.extend(self.monitor.observe(before)?);
            findings.extend(self.monitor.gap(gap.start, gap.end));
            rest = after;
        }
        findings.extend(self.monitor.observe(rest)?);
        Ok(findings)
    }
}

#[pymethods]
impl PyMonitor {
    fn observe(&mut self, py: Python<'_>, batch: &Bound<'_, PyAny>) -> PyResult<PyFindings> {
        let findings = match batch.cast::<PyChangeLog>() {
            Ok(log) => {
                let log = log.get();
                py.detach(|| self.watch(&log.log))
            }
            Err(_) => {
                let reader: PyRecordBatchReader = batch.extract()?;
                let log = PyChangeLog::from_stream(py, reader, 0.0)?;
                py.detach(|| self.watch(&log))
            }
        };
        Ok(PyFindings { findings: findings.map_err(errors::input)? })
    }

    fn gap(&mut self, start_ns: i64, end_ns: i64) -> PyFindings {
        PyFindings { findings: self.monitor.gap(start_ns, end_ns) }
    }

    fn advance(&mut self, py: Python<'_>, now_ns: i64) -> PyFindings {
        PyFindings { findings: py.detach(|| self.monitor.advance(now_ns)) }
    }

    fn finish(&mut self, py: Python<'_>) -> PyFindings {
        PyFindings { findings: py.detach(|| self.monitor.finish()) }
    }

    fn state(&self, py: Python<'_>) -> Vec<u8> {
        py.detach(|| self.monitor.save())
    }

    fn take_snapshots(&mut self) -> PyResult<Vec<String>> {
        let snapshots = self.monitor.take_snapshots();
        snapshots.iter().map(|s| serde_json::to_string(s).map_err(errors::input)).collect()
    }
}
