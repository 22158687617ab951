//! `Findings`: in the order they were made, as Arrow or as lines of JSON.

use std::collections::HashMap;
use std::hash::Hash;
use std::sync::Arc;

use arrow_array::builder::{
    Float64Builder, ListBuilder, StringBuilder, StructBuilder, TimestampNanosecondBuilder,
    UInt8Builder,
};
use arrow_array::{ArrayRef, RecordBatch};
use arrow_schema::{ArrowError, DataType, Field, Fields};
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyList, PyString, PyTuple};

use runglight_engine::finding::{Finding, Kind, Severity};
use runglight_engine::signal_state::found::Found;
use runglight_engine::signal_state::telling::{Said, Telling};

use crate::errors;
use crate::stream;

/// Findings of one call; put into words when somebody asks.
#[pyclass(name = "Findings", module = "runglight._engine", frozen)]
pub struct PyFindings {
    found: Found,
}

impl From<Found> for PyFindings {
    fn from(found: Found) -> Self {
        Self { found }
    }
}

impl From<Vec<Finding>> for PyFindings {
    fn from(findings: Vec<Finding>) -> Self {
        Self { found: findings.into() }
    }
}

#[pymethods]
impl PyFindings {
    fn __len__(&self) -> usize {
        self.found.len()
    }

    #[pyo3(signature = (requested_schema = None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyCapsule>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        let batch = py.detach(|| to_batch(&self.found.findings()));
        stream::export(py, batch.map_err(errors::input)?, requested_schema)
    }

    fn json_lines<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        PyList::new(py, Told::of(py, &self.found)?.lines)
    }

    fn told<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let Told { lines, ids, kinds, severities } = Told::of(py, &self.found)?;
        let lists = [
            PyList::new(py, lines)?,
            PyList::new(py, ids)?,
            PyList::new(py, kinds)?,
            PyList::new(py, severities)?,
        ];
        PyTuple::new(py, lists)
    }
}

/// Findings as JSON, and what is counted of each.
#[derive(Default)]
struct Told<'py> {
    lines: Vec<Bound<'py, PyString>>,
    ids: Vec<Bound<'py, PyString>>,
    kinds: Vec<Bound<'py, PyString>>,
    severities: Vec<Bound<'py, PyString>>,
}

impl<'py> Told<'py> {
    fn of(py: Python<'py>, found: &Found) -> PyResult<Self> {
        let mut telling = found.telling();
        let mut piece = Piece::default();
        let (mut kinds, mut severities) = (Names::default(), Names::default());
        let mut told = Self::default();
        while py.detach(|| piece.fill(&mut telling)) {
            let (mut line, mut id) = (0, 0);
            for head in &piece.heads {
                told.lines.push(PyString::from_bytes(py, &piece.lines[line..head.line_end])?);
                told.ids.push(PyString::new(py, &piece.ids[id..head.id_end]));
                told.kinds.push(kinds.of(py, head.kind));
                told.severities.push(severities.of(py, head.severity));
                (line, id) = (head.line_end, head.id_end);
            }
        }
        Ok(told)
    }
}

/// Findings that are told before Python takes them over: few enough to stay in the processor's
/// cache.
#[derive(Default)]
struct Piece {
    /// The lines, one behind the other.
    lines: Vec<u8>,
    /// The ids, one behind the other.
    ids: String,
    heads: Vec<Head>,
}

/// One finding of a [`Piece`].
struct Head {
    /// Where its line ends.
    line_end: usize,
    /// Where its id ends.
    id_end: usize,
    kind: Kind,
    severity: Severity,
}

impl Piece {
    const FINDINGS: usize = 128;

    /// Tells the next ones; false where there is none.
    fn fill(&mut self, telling: &mut Telling<'_>) -> bool {
        let Self { lines, ids, heads } = self;
        lines.clear();
        ids.clear();
        heads.clear();
        let mut hear = |said: Said<'_>| {
            said.append_json(lines);
            let finding = said.finding;
            ids.push_str(&finding.id);
            heads.push(Head {
                line_end: lines.len(),
                id_end: ids.len(),
                kind: finding.kind,
                severity: finding.severity,
            });
        };
        (0..Self::FINDINGS).all(|_| telling.tell_next(&mut hear));
        !heads.is_empty()
    }
}

/// Names of variants: equal ones are one object.
struct Names<'py, Variant>(HashMap<Variant, Bound<'py, PyString>>);

impl<Variant> Default for Names<'_, Variant> {
    fn default() -> Self {
        Self(HashMap::new())
    }
}

impl<'py, Variant: serde::Serialize + Copy + Eq + Hash> Names<'py, Variant> {
    fn of(&mut self, py: Python<'py>, variant: Variant) -> Bound<'py, PyString> {
        let text = || PyString::new(py, &name(&variant).unwrap_or_default());
        self.0.entry(variant).or_insert_with(text).clone()
    }
}

/// The name serde gives a unit variant: `transition_probability`, `fault`, …
fn name(value: &impl serde::Serialize) -> Option<String> {
    serde_json::to_value(value).ok()?.as_str().map(str::to_owned)
}

type TextOf = fn(&Finding) -> Option<String>;

fn to_batch(findings: &[Finding]) -> Result<RecordBatch, ArrowError> {
    let mut columns: Vec<(&str, ArrayRef)> = Vec::new();
    let text = |of: TextOf| -> ArrayRef {
        let mut builder = StringBuilder::new();
        for finding in findings {
            builder.append_option(of(finding));
        }
        Arc::new(builder.finish())
    };
    let real = |of: fn(&Finding) -> Option<f64>| -> ArrayRef {
        let mut builder = Float64Builder::new();
        for finding in findings {
            builder.append_option(of(finding));
        }
        Arc::new(builder.finish())
    };
    let mut time = TimestampNanosecondBuilder::new().with_timezone("UTC");
    let mut rank = UInt8Builder::new();
    for finding in findings {
        time.append_value(finding.time);
        rank.append_option(finding.rank);
    }
    columns.push(("id", text(|f| Some(f.id.clone()))));
    columns.push(("incident", text(|f| Some(f.incident.clone()))));
    columns.push(("time", Arc::new(time.finish())));
    columns.push(("kind", text(|f| name(&f.kind))));
    columns.push(("severity", text(|f| name(&f.severity))));
    columns.push(("state", text(|f| name(&f.state))));
    columns.push(("model", text(|f| name(&f.model))));
    columns.push(("group", text(|f| f.group.clone())));
    columns.push(("device", text(|f| f.device.clone())));
    columns.push(("signal", text(|f| f.signal.clone())));
    columns.push(("address", text(|f| f.address.clone())));
    columns.push(("from", text(|f| f.from.clone())));
    columns.push(("to", text(|f| f.to.clone())));
    columns.push(("expected", expected(findings)));
    columns.push(("observed_s", real(|f| f.observed_s)));
    columns.push(("limit_s", real(|f| f.limit_s)));
    columns.push(("rank", Arc::new(rank.finish())));
    columns.push(("suspects", suspects(findings)));
    columns.push(("path", path(findings)));
    columns.push(("snapshot_id", text(|f| f.snapshot_id.clone())));
    columns.push(("message", text(|f| Some(f.message.clone()))));
    RecordBatch::try_from_iter_with_nullable(columns.into_iter().map(|(n, c)| (n, c, true)))
}

fn path(findings: &[Finding]) -> ArrayRef {
    let mut list = ListBuilder::new(StringBuilder::new());
    for finding in findings {
        for state in &finding.path {
            list.values().append_value(state);
        }
        list.append(true);
    }
    Arc::new(list.finish())
}

/// A struct of two fields of text or number, three in all.
fn list_of(fields: [(&'static str, DataType); 3]) -> ListBuilder<StructBuilder> {
    let fields: Fields =
        fields.into_iter().map(|(name, data_type)| Field::new(name, data_type, true)).collect();
    ListBuilder::new(StructBuilder::from_fields(fields, 0))
}

fn append_text(row: &mut StructBuilder, field: usize, text: Option<&str>) {
    if let Some(builder) = row.field_builder::<StringBuilder>(field) {
        builder.append_option(text);
    }
}

fn append_real(row: &mut StructBuilder, field: usize, number: Option<f64>) {
    if let Some(builder) = row.field_builder::<Float64Builder>(field) {
        builder.append_option(number);
    }
}

fn expected(findings: &[Finding]) -> ArrayRef {
    let mut list = list_of([
        ("state", DataType::Utf8),
        ("probability", DataType::Float64),
        ("limit_s", DataType::Float64),
    ]);
    for finding in findings {
        for expected in &finding.expected {
            let row = list.values();
            append_text(row, 0, Some(&expected.state));
            append_real(row, 1, Some(expected.probability));
            append_real(row, 2, expected.limit_s);
            row.append(true);
        }
        list.append(true);
    }
    Arc::new(list.finish())
}

fn suspects(findings: &[Finding]) -> ArrayRef {
    let mut list = list_of([
        ("address", DataType::Utf8),
        ("signal", DataType::Utf8),
        ("score", DataType::Float64),
    ]);
    for finding in findings {
        for suspect in &finding.suspects {
            let row = list.values();
            append_text(row, 0, suspect.address.as_deref());
            append_text(row, 1, Some(&suspect.signal));
            append_real(row, 2, Some(suspect.score));
            row.append(true);
        }
        list.append(true);
    }
    Arc::new(list.finish())
}
