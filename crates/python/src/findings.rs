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
        let batch = py.detach(|| {
            let mut findings = Vec::with_capacity(self.found.len());
            self.found.tell(|finding| findings.push(finding.clone()));
            to_batch(&findings)
        });
        stream::export(py, batch.map_err(errors::input)?, requested_schema)
    }

    fn json_lines<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        py.detach(|| Told::of(&self.found)).lines(py)
    }

    fn told<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let told = py.detach(|| Told::of(&self.found));
        let kinds = told.names(py, |head| head.kind)?;
        let severities = told.names(py, |head| head.severity)?;
        (told.lines(py)?, told.ids(py)?, kinds, severities).into_pyobject(py)
    }
}

/// Findings as JSON, and what is counted of each.
#[derive(Default)]
struct Told {
    /// The lines, one behind the other.
    lines: Vec<u8>,
    /// The ids, one behind the other.
    ids: String,
    heads: Vec<Head>,
}

/// One finding of [`Told`].
struct Head {
    /// Where its line ends.
    line_end: usize,
    /// Where its id ends.
    id_end: usize,
    kind: Kind,
    severity: Severity,
}

impl Told {
    fn of(found: &Found) -> Self {
        let mut told = Self { heads: Vec::with_capacity(found.len()), ..Self::default() };
        found.tell(|finding| {
            finding.append_json(&mut told.lines);
            told.ids.push_str(&finding.id);
            told.heads.push(Head {
                line_end: told.lines.len(),
                id_end: told.ids.len(),
                kind: finding.kind,
                severity: finding.severity,
            });
        });
        told
    }

    fn lines<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let mut start = 0;
        let line = |head: &Head| {
            let line = &self.lines[std::mem::replace(&mut start, head.line_end)..head.line_end];
            PyString::from_bytes(py, line)
        };
        PyList::new(py, self.heads.iter().map(line).collect::<PyResult<Vec<_>>>()?)
    }

    fn ids<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let mut start = 0;
        let id = |head: &Head| &self.ids[std::mem::replace(&mut start, head.id_end)..head.id_end];
        PyList::new(py, self.heads.iter().map(id))
    }

    /// One text per finding; equal ones are one object.
    fn names<'py, Named: serde::Serialize + Copy + Eq + Hash>(
        &self,
        py: Python<'py>,
        of: impl Fn(&Head) -> Named,
    ) -> PyResult<Bound<'py, PyList>> {
        let mut known: HashMap<Named, Bound<'py, PyString>> = HashMap::new();
        let name = |head: &Head| {
            let named = of(head);
            let text = || PyString::new(py, &name(&named).unwrap_or_default());
            known.entry(named).or_insert_with(text).clone()
        };
        PyList::new(py, self.heads.iter().map(name))
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
