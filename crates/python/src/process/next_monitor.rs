//! `NextMonitor`: the verbs of every monitor, asked of the network that foretells what comes next.

use pyo3::prelude::*;
use pyo3_arrow::PyRecordBatchReader;

use runglight_engine::finding::Finding;
use runglight_engine::log::{ChangeLog, SignalIndex};
use runglight_engine::process::watching::{NextMonitor, UNLIKELY};
use runglight_engine::signal_state::events::Row;
use runglight_engine::signal_state::monitor::MonitorError;

use super::next_activity::PyNextActivity;
use crate::change_log::PyChangeLog;
use crate::errors;
use crate::findings::PyFindings;

/// Watches one machine.
#[pyclass(name = "NextMonitor", module = "runglight._engine")]
pub struct PyNextMonitor {
    monitor: NextMonitor,
}

impl PyNextMonitor {
    /// Rows up to each gap, the gap, the rows after it.
    fn watch(&mut self, log: &ChangeLog) -> Result<Vec<Finding>, MonitorError> {
        let numbers: Vec<Option<SignalIndex>> =
            log.signals.iter().map(|symbol| self.monitor.signal(symbol)).collect();
        let mut findings = Vec::new();
        let mut start = 0;
        let mut rows: Vec<Row> = Vec::with_capacity(log.len());
        let mut take = |monitor: &mut NextMonitor, from: usize, to: usize| {
            rows.clear();
            rows.extend((from..to).filter_map(|row| {
                let signal = numbers[log.signal[row] as usize]?;
                Some(Row { time: log.time[row], signal, value: log.value[row] })
            }));
            monitor.observe(&rows)
        };
        for gap in &log.gaps {
            let end = start + log.time[start..].partition_point(|&time| time < gap.end);
            findings.extend(take(&mut self.monitor, start, end)?);
            findings.extend(self.monitor.gap(gap.end));
            start = end;
        }
        findings.extend(take(&mut self.monitor, start, log.len())?);
        Ok(findings)
    }
}

#[pymethods]
impl PyNextMonitor {
    #[new]
    #[pyo3(signature = (next, reset, unlikely = UNLIKELY, state = None))]
    fn new(
        next: &PyNextActivity,
        reset: &str,
        unlikely: f32,
        state: Option<&[u8]>,
    ) -> PyResult<Self> {
        let monitor = NextMonitor::new(next.next.clone(), &next.net, reset, unlikely);
        let mut monitor = monitor.ok_or_else(|| {
            errors::input(format!(
                "reset '{reset}' must be SIGNAL=VALUE of a signal that the network knows, like %IX0.1=0"
            ))
        })?;
        if let Some(state) = state {
            monitor.restore(state).map_err(errors::input)?;
        }
        Ok(Self { monitor })
    }

    fn observe(&mut self, py: Python<'_>, batch: &Bound<'_, PyAny>) -> PyResult<PyFindings> {
        let findings = match batch.cast::<PyChangeLog>() {
            Ok(log) => {
                let log = log.get();
                py.detach(|| self.watch(&log.log))
            }
            Err(_) => {
                let reader = batch.extract::<PyRecordBatchReader>()?.into_reader()?;
                let log = py
                    .detach(|| runglight_formats::arrow::from_batches(reader, 0))
                    .map_err(errors::input)?;
                py.detach(|| self.watch(&log))
            }
        };
        Ok(PyFindings::from(findings.map_err(errors::input)?))
    }

    fn gap(&mut self, start_ns: i64, end_ns: i64) -> PyFindings {
        let _ = start_ns;
        PyFindings::from(self.monitor.gap(end_ns))
    }

    fn advance(&mut self, now_ns: i64) -> PyFindings {
        PyFindings::from(self.monitor.advance(now_ns))
    }

    fn finish(&mut self) -> PyFindings {
        PyFindings::from(self.monitor.finish())
    }

    fn state(&self) -> Vec<u8> {
        self.monitor.save()
    }
}
