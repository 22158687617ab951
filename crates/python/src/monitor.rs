//! `Monitor`: observe and advance.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

use pyo3::prelude::*;
use pyo3_arrow::PyRecordBatchReader;

use runglight_engine::cycle::model::CycleModel;
use runglight_engine::finding::Finding;
use runglight_engine::joint::JointMonitor;
use runglight_engine::log::{ChangeLog, SignalIndex};
use runglight_engine::signal_state::events::Row;
use runglight_engine::signal_state::model::NominalModel;
use runglight_engine::signal_state::monitor::MonitorError;

use crate::change_log::PyChangeLog;
use crate::errors;
use crate::findings::PyFindings;

/// Rows handed to the engine at once.
const CHUNK_ROWS: usize = 1024;

/// Watches one plant.
#[pyclass(name = "Monitor", module = "runglight._engine")]
pub struct PyMonitor {
    monitor: JointMonitor,
    signals: Arc<HashMap<String, SignalIndex>>,
}

impl PyMonitor {
    pub fn new(
        model: Arc<NominalModel>,
        cycle: Option<Arc<CycleModel>>,
        state: Option<&[u8]>,
    ) -> Result<Self, MonitorError> {
        let signals = (0..).zip(&model.plant.signals).map(|(i, s)| (s.symbol.clone(), i)).collect();
        let monitor = match state {
            Some(bytes) => JointMonitor::restore(model, cycle, bytes)?,
            None => JointMonitor::new(model, cycle),
        };
        Ok(Self { monitor, signals: Arc::new(signals) })
    }

    /// The cycle machine alone.
    pub fn of_cycle(cycle: Arc<CycleModel>, state: Option<&[u8]>) -> Result<Self, MonitorError> {
        let signals = (0..).zip(&cycle.bits).map(|(i, bit)| (bit.symbol.clone(), i)).collect();
        Ok(Self { monitor: JointMonitor::of_cycle(cycle, state)?, signals: Arc::new(signals) })
    }

    /// Rows up to each gap, the gap, the rows after it.
    fn watch(&mut self, log: &ChangeLog) -> Result<Vec<Finding>, MonitorError> {
        let signals = Arc::clone(&self.signals);
        let numbers: Vec<SignalIndex> = log
            .signals
            .iter()
            .map(|symbol| self.monitor.signal_index(symbol, signals.get(symbol).copied()))
            .collect();
        let mut findings = Vec::new();
        let mut start = 0;
        for gap in &log.gaps {
            let end = start + log.time[start..].partition_point(|&time| time < gap.end);
            self.observe_rows(log, start..end, &numbers, &mut findings)?;
            findings.extend(self.monitor.gap(gap.start, gap.end));
            start = end;
        }
        self.observe_rows(log, start..log.len(), &numbers, &mut findings)?;
        Ok(findings)
    }

    /// Rows of a log in chunks that stay in the processor's cache.
    fn observe_rows(
        &mut self,
        log: &ChangeLog,
        range: Range<usize>,
        numbers: &[SignalIndex],
        findings: &mut Vec<Finding>,
    ) -> Result<(), MonitorError> {
        let mut chunk: Vec<Row> = Vec::with_capacity(CHUNK_ROWS);
        for start in range.clone().step_by(CHUNK_ROWS) {
            let end = range.end.min(start + CHUNK_ROWS);
            let columns = log.time[start..end]
                .iter()
                .zip(&log.signal[start..end])
                .zip(&log.value[start..end]);
            chunk.clear();
            chunk.extend(columns.map(|((&time, &signal), &value)| Row {
                time,
                signal: numbers[signal as usize],
                value,
            }));
            findings.extend(self.monitor.observe(&chunk)?);
        }
        Ok(())
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
