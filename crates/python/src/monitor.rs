//! `Monitor`: observe and advance.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use pyo3_arrow::PyRecordBatchReader;

use runglight_engine::cycle::model::CycleModel;
use runglight_engine::joint::JointMonitor;
use runglight_engine::log::{ChangeLog, Gap, Nanoseconds, SignalIndex};
use runglight_engine::signal_state::events::Row;
use runglight_engine::signal_state::found::Found;
use runglight_engine::signal_state::model::NominalModel;
use runglight_engine::signal_state::monitor::{Columns, Keys, MonitorError};

use crate::change_log::PyChangeLog;
use crate::contract::Dictionary;
use crate::errors;
use crate::findings::PyFindings;

/// Times, signals and values as numpy hands them over.
type Arrays<'py> =
    (PyReadonlyArray1<'py, i64>, PyReadonlyArray1<'py, u32>, PyReadonlyArray1<'py, i64>);

/// Rows handed to the engine at once.
const CHUNK_ROWS: usize = 4096;

/// Watches one plant.
#[pyclass(name = "Monitor", module = "runglight._engine")]
pub struct PyMonitor {
    pub(crate) monitor: JointMonitor,
    pub(crate) naming: Naming,
    pub(crate) dictionary: Dictionary,
    /// What the indices of [`PyMonitor::observe_rows`] stand for.
    bound: Vec<SignalIndex>,
}

/// Whose numbers stand for signals.
pub enum Naming {
    /// The plant's.
    Plant(Arc<NominalModel>),
    /// Those of the bits of a cycle machine that is watched alone.
    Bits(HashMap<String, SignalIndex>),
    /// The part's, found by the whole plant's names.
    Part(Arc<Share>),
}

/// A signal of another part: its rows are none of this monitor's business.
pub const ELSEWHERE: SignalIndex = SignalIndex::MAX - 1;

/// What a part of a plant knows of the whole.
pub struct Share {
    /// The whole model.
    pub whole: Arc<NominalModel>,
    /// The part's number of each signal of the whole plant, or [`ELSEWHERE`].
    pub own: Vec<SignalIndex>,
    /// Whether it tells of signals that no part knows: that with the plant's first group does.
    pub tells_unknown: bool,
}

impl Naming {
    /// The number of each symbol, where it is known.
    pub fn find_all<'a>(&self, symbols: impl Iterator<Item = &'a str>) -> Vec<Option<SignalIndex>> {
        match self {
            Self::Plant(model) => model.symbols().find_all(&model.plant, symbols),
            Self::Bits(bits) => symbols.map(|symbol| bits.get(symbol).copied()).collect(),
            Self::Part(share) => {
                let found = share.whole.symbols().find_all(&share.whole.plant, symbols);
                let nobodys = (!share.tells_unknown).then_some(ELSEWHERE);
                found
                    .into_iter()
                    .map(|s| s.map_or(nobodys, |s| Some(share.own[s as usize])))
                    .collect()
            }
        }
    }

    /// Leaves out rows of other parts.
    pub fn keep_own(&self, rows: &mut Vec<Row>) {
        if matches!(self, Self::Part(_)) {
            rows.retain(|row| row.signal != ELSEWHERE);
        }
    }
}

impl PyMonitor {
    pub fn new(
        model: Arc<NominalModel>,
        cycle: Option<Arc<CycleModel>>,
        state: Option<&[u8]>,
    ) -> Result<Self, MonitorError> {
        let monitor = match state {
            Some(bytes) => JointMonitor::restore(Arc::clone(&model), cycle, bytes)?,
            None => JointMonitor::new(Arc::clone(&model), cycle),
        };
        Ok(Self::with(monitor, Naming::Plant(model)))
    }

    /// A part of a plant.
    pub fn of_part(
        model: Arc<NominalModel>,
        share: Arc<Share>,
        state: Option<&[u8]>,
    ) -> Result<Self, MonitorError> {
        let monitor = match state {
            Some(bytes) => JointMonitor::restore(model, None, bytes)?,
            None => JointMonitor::new(model, None),
        };
        Ok(Self::with(monitor, Naming::Part(share)))
    }

    /// The cycle machine alone.
    pub fn of_cycle(cycle: Arc<CycleModel>, state: Option<&[u8]>) -> Result<Self, MonitorError> {
        let bits = (0..).zip(&cycle.bits).map(|(i, bit)| (bit.symbol.clone(), i)).collect();
        Ok(Self::with(JointMonitor::of_cycle(cycle, state)?, Naming::Bits(bits)))
    }

    fn with(monitor: JointMonitor, naming: Naming) -> Self {
        Self { monitor, naming, dictionary: Dictionary::default(), bound: Vec::new() }
    }

    /// The engine's numbers of signals, by name.
    fn numbers(&mut self, signals: &[String]) -> Vec<SignalIndex> {
        let known = self.naming.find_all(signals.iter().map(String::as_str));
        signals
            .iter()
            .zip(known)
            .map(|(symbol, known)| self.monitor.signal_index(symbol, known))
            .collect()
    }

    /// Three columns as rows of bound signals.
    fn rows(&self, columns: &Arrays<'_>) -> PyResult<Vec<Row>> {
        let (time, signal, value) =
            (columns.0.as_array(), columns.1.as_array(), columns.2.as_array());
        if time.len() != signal.len() || time.len() != value.len() {
            return Err(errors::input("time, signal and value are not of one length"));
        }
        let mut rows = Vec::with_capacity(time.len());
        for ((&time, &signal), &value) in time.iter().zip(signal).zip(value) {
            let Some(&signal) = self.bound.get(signal as usize) else {
                let bound = self.bound.len();
                return Err(errors::input(format!(
                    "signal index {signal} is not among the {bound} bound signals; bind them first"
                )));
            };
            rows.push(Row { time, signal, value });
        }
        self.naming.keep_own(&mut rows);
        Ok(rows)
    }

    /// A whole log with all its gaps.
    pub fn watch(&mut self, log: &ChangeLog) -> Result<Found, MonitorError> {
        self.watch_rows(log, 0..log.len(), log.gaps.iter())
    }

    /// Rows up to each gap, the gap, the rows after it.
    fn watch_rows<'a>(
        &mut self,
        log: &ChangeLog,
        rows: Range<usize>,
        gaps: impl Iterator<Item = &'a Gap>,
    ) -> Result<Found, MonitorError> {
        let numbers = self.numbers(&log.signals);
        let keys = self.monitor.keys(numbers);
        let mut found = Found::default();
        let mut start = rows.start;
        for gap in gaps {
            let times = &log.time[start..rows.end];
            let end = start + times.partition_point(|&time| time < gap.end);
            self.take_range(log, start..end, &keys)?;
            found.append(self.monitor.take_found());
            found.append(self.monitor.gap(gap.start, gap.end).into());
            start = end;
        }
        self.take_range(log, start..rows.end, &keys)?;
        found.append(self.monitor.take_found());
        Ok(found)
    }

    /// Rows of a log, whose keys are its signals.
    fn take_range(
        &mut self,
        log: &ChangeLog,
        range: Range<usize>,
        keys: &Keys,
    ) -> Result<(), MonitorError> {
        let (time, key) = (&log.time[range.clone()], &log.signal[range.clone()]);
        self.take_columns(time, key, &log.value[range], keys)
    }

    /// Rows in columns, in chunks that stay in the processor's cache; those of other parts are left
    /// out.
    pub fn take_columns(
        &mut self,
        time: &[Nanoseconds],
        key: &[u32],
        value: &[i64],
        keys: &Keys,
    ) -> Result<(), MonitorError> {
        let chunks = time.chunks(CHUNK_ROWS).zip(key.chunks(CHUNK_ROWS));
        for ((time, key), value) in chunks.zip(value.chunks(CHUNK_ROWS)) {
            let columns = Columns::new(time, key, value, keys);
            if matches!(self.naming, Naming::Part(_)) {
                let mut rows = columns.to_rows();
                self.naming.keep_own(&mut rows);
                self.monitor.take_rows(&rows)?;
            } else {
                self.monitor.take_columns(columns)?;
            }
        }
        Ok(())
    }
}

#[pymethods]
impl PyMonitor {
    fn bind(&mut self, signals: Vec<String>) {
        self.bound = self.numbers(&signals);
    }

    fn observe_rows(
        &mut self,
        time_ns: PyReadonlyArray1<'_, i64>,
        signal_index: PyReadonlyArray1<'_, u32>,
        value: PyReadonlyArray1<'_, i64>,
    ) -> PyResult<PyFindings> {
        let rows = self.rows(&(time_ns, signal_index, value))?;
        // A batch of a live source is a few rows: not worth letting another thread in.
        let findings = self.monitor.observe(&rows).map_err(errors::input)?;
        Ok(findings.into())
    }

    fn observe_image(
        &mut self,
        time_ns: PyReadonlyArray1<'_, i64>,
        signal_index: PyReadonlyArray1<'_, u32>,
        value: PyReadonlyArray1<'_, i64>,
    ) -> PyResult<PyFindings> {
        let rows = self.rows(&(time_ns, signal_index, value))?;
        let findings = self.monitor.image(&rows).map_err(errors::input)?;
        Ok(findings.into())
    }

    #[getter]
    fn now_ns(&self) -> Option<i64> {
        self.monitor.now()
    }

    fn observe(&mut self, py: Python<'_>, batch: &Bound<'_, PyAny>) -> PyResult<PyFindings> {
        let found = match batch.cast::<PyChangeLog>() {
            Ok(log) => {
                let log = log.get();
                py.detach(|| self.watch(&log.log)).map_err(errors::input)?
            }
            Err(_) => {
                let reader = batch.extract::<PyRecordBatchReader>()?.into_reader()?;
                py.detach(|| self.watch_stream(reader))?
            }
        };
        Ok(found.into())
    }

    fn observe_slice(
        &mut self,
        py: Python<'_>,
        log: &Bound<'_, PyChangeLog>,
        offset: usize,
        length: usize,
    ) -> PyResult<PyFindings> {
        let log = &log.get().log;
        let start = offset.min(log.len());
        let rows = start..start.saturating_add(length).min(log.len());
        let found = py
            .detach(|| self.watch_rows(log, rows.clone(), log.gaps_among(rows)))
            .map_err(errors::input)?;
        Ok(found.into())
    }

    fn gap(&mut self, start_ns: i64, end_ns: i64) -> PyFindings {
        self.monitor.gap(start_ns, end_ns).into()
    }

    fn begin(&mut self, time_ns: i64, image: bool) {
        self.monitor.begin(time_ns, image);
    }

    fn advance(&mut self, py: Python<'_>, now_ns: i64) -> PyFindings {
        py.detach(|| self.monitor.advance(now_ns)).into()
    }

    fn finish(&mut self, py: Python<'_>) -> PyFindings {
        py.detach(|| self.monitor.finish()).into()
    }

    fn state(&self, py: Python<'_>) -> Vec<u8> {
        py.detach(|| self.monitor.save())
    }

    fn take_snapshots(&mut self) -> PyResult<Vec<String>> {
        let snapshots = self.monitor.take_snapshots();
        snapshots.iter().map(|s| serde_json::to_string(s).map_err(errors::input)).collect()
    }
}
