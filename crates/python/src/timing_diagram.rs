//! `TimingDiagram`: spans to draw, as numpy arrays.

use std::sync::{PoisonError, RwLock};

use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;

use runglight_engine::timing_diagram::{Edge, Span, TimingDiagram};

use crate::change_log::PyChangeLog;
use crate::errors;

/// The changes of every signal, ready to be drawn at any scale.
#[pyclass(name = "TimingDiagram", module = "runglight._engine", frozen)]
pub struct PyTimingDiagram {
    diagram: RwLock<TimingDiagram>,
}

type Spans<'py> = (
    Bound<'py, PyArray1<u32>>,
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray1<u32>>,
    Bound<'py, PyArray1<u8>>,
);

impl PyTimingDiagram {
    fn read<T>(&self, look: impl FnOnce(&TimingDiagram) -> T) -> T {
        look(&self.diagram.read().unwrap_or_else(PoisonError::into_inner))
    }

    fn write(&self, change: impl FnOnce(&mut TimingDiagram)) {
        change(&mut self.diagram.write().unwrap_or_else(PoisonError::into_inner));
    }
}

#[pymethods]
impl PyTimingDiagram {
    #[new]
    #[pyo3(signature = (log = None))]
    fn new(py: Python<'_>, log: Option<&PyChangeLog>) -> Self {
        let diagram = log.map_or_else(TimingDiagram::default, |log| {
            let rows = &log.log;
            py.detach(|| TimingDiagram::of(rows))
        });
        Self { diagram: RwLock::new(diagram) }
    }

    fn append(
        &self,
        time_ns: PyReadonlyArray1<'_, i64>,
        signal_index: PyReadonlyArray1<'_, u32>,
        value: PyReadonlyArray1<'_, i64>,
    ) -> PyResult<()> {
        let (time, signal, value) = (time_ns.as_array(), signal_index.as_array(), value.as_array());
        if time.len() != signal.len() || time.len() != value.len() {
            return Err(errors::input("rows need columns of one length"));
        }
        let (time, signal, value) = (time.to_vec(), signal.to_vec(), value.to_vec());
        self.write(|diagram| diagram.append(&time, &signal, &value));
        Ok(())
    }

    fn forget_before(&self, time_ns: i64) {
        self.write(|diagram| diagram.forget_before(time_ns));
    }

    #[getter]
    fn lanes(&self) -> usize {
        self.read(TimingDiagram::lanes)
    }

    fn changes(&self, lane: usize) -> usize {
        self.read(|diagram| diagram.changes(lane))
    }

    fn value_range(&self, lane: usize) -> Option<(i64, i64)> {
        self.read(|diagram| diagram.value_range(lane))
    }

    /// `(spans per lane, start_ns, value, changes, known)` of some lanes, one after the other.
    fn spans<'py>(
        &self,
        py: Python<'py>,
        lanes: Vec<usize>,
        from_ns: i64,
        until_ns: i64,
        columns: u32,
    ) -> Spans<'py> {
        let (counts, spans) = py.detach(|| {
            self.read(|diagram| {
                let mut spans: Vec<Span> = Vec::new();
                let counts: Vec<u32> = lanes
                    .iter()
                    .map(|&lane| {
                        let of_lane = diagram.spans(lane, from_ns, until_ns, columns);
                        let count = of_lane.len() as u32;
                        spans.extend(of_lane);
                        count
                    })
                    .collect();
                (counts, spans)
            })
        });
        (
            counts.into_pyarray(py),
            spans.iter().map(|span| span.start).collect::<Vec<_>>().into_pyarray(py),
            spans.iter().map(|span| span.value).collect::<Vec<_>>().into_pyarray(py),
            spans.iter().map(|span| span.changes).collect::<Vec<_>>().into_pyarray(py),
            spans.iter().map(|span| u8::from(span.known)).collect::<Vec<_>>().into_pyarray(py),
        )
    }

    #[pyo3(signature = (lane, from_ns, until_ns, limit = 100_000))]
    fn edges(&self, lane: usize, from_ns: i64, until_ns: i64, limit: usize) -> Vec<(i64, i64)> {
        let edges = self.read(|diagram| diagram.edges(lane, from_ns, until_ns, limit));
        edges.into_iter().map(pair).collect()
    }

    fn next_edge(&self, lane: usize, after_ns: i64) -> Option<(i64, i64)> {
        self.read(|diagram| diagram.next_edge(lane, after_ns)).map(pair)
    }

    fn previous_edge(&self, lane: usize, before_ns: i64) -> Option<(i64, i64)> {
        self.read(|diagram| diagram.previous_edge(lane, before_ns)).map(pair)
    }
}

fn pair(edge: Edge) -> (i64, i64) {
    (edge.time, edge.value)
}
