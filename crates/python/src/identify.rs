//! `identify`: which signal do declared events mean?

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, RecordBatch, StringArray, UInt32Array};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyCapsule;
use runglight_engine::bits::BitNames;
use runglight_engine::identify::ranking::Ranked;
use runglight_engine::identify::sweep::{suggested, sweep};
use runglight_engine::identify::trace::trace;
use runglight_engine::identify::view::View;
use runglight_engine::identify::{Identification, Settings, identify as identified};
use runglight_engine::log::Nanoseconds;
use runglight_engine::naming::NamingRule;
use runglight_formats::ReadOptions;
use serde::Deserialize;
use serde_json::{Value, json};

use crate::change_log::PyChangeLog;
use crate::errors;
use crate::stream;

/// Settings as JSON.
#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Asked {
    tau_ns: Nanoseconds,
    view: String,
    share: f64,
    words: Vec<String>,
}

impl Default for Asked {
    fn default() -> Self {
        let Settings { tau, share, words, .. } = Settings::default();
        Self { tau_ns: tau, view: "all".to_owned(), share, words }
    }
}

impl Asked {
    fn settings(text: &str) -> PyResult<Settings> {
        let asked: Self = serde_json::from_str(text)
            .map_err(|error| errors::input(format!("settings of identify: {error}")))?;
        let view = View::from_name(&asked.view).ok_or_else(|| {
            errors::input(format!(
                "there is no view '{}'; use all, rising, falling or increments",
                asked.view
            ))
        })?;
        Ok(Settings { tau: asked.tau_ns, view, share: asked.share, words: asked.words })
    }
}

/// Signals, and bits of words, in the order in which they fit.
#[pyclass(name = "Identification", module = "runglight._engine", frozen)]
pub struct PyIdentification {
    found: Identification,
    view: View,
    names: HashMap<String, String>,
}

impl PyIdentification {
    /// What the symbol table calls an address.
    fn name(&self, ranked: &Ranked) -> Option<&str> {
        self.names.get(&ranked.name).map(String::as_str)
    }

    fn same_as(&self, ranked: &Ranked) -> &str {
        &self.found.ranked[ranked.same_as as usize].name
    }
}

#[pymethods]
impl PyIdentification {
    fn __len__(&self) -> usize {
        self.found.ranked.len()
    }

    #[pyo3(signature = (requested_schema = None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyCapsule>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        let ranked = &self.found.ranked;
        let real = |of: fn(&Ranked) -> f64| -> ArrayRef {
            Arc::new(Float64Array::from_iter_values(ranked.iter().map(of)))
        };
        let number = |of: fn(&Ranked) -> u32| -> ArrayRef {
            Arc::new(UInt32Array::from_iter_values(ranked.iter().map(of)))
        };
        let text = |of: &dyn Fn(&Ranked) -> Option<String>| -> ArrayRef {
            Arc::new(ranked.iter().map(of).collect::<StringArray>())
        };
        let batch = RecordBatch::try_from_iter_with_nullable([
            ("rank", number(|r| r.rank), false),
            ("address", text(&|r| Some(r.name.clone())), false),
            ("name", text(&|r| self.name(r).map(str::to_owned)), true),
            ("score_in", real(|r| r.score_in), false),
            ("score_out", real(|r| r.score_out), false),
            ("changes", number(|r| r.changes), false),
            ("same_as", text(&|r| Some(self.same_as(r).to_owned())), false),
        ])
        .map_err(errors::input)?;
        stream::export(py, batch, requested_schema)
    }

    /// The windows and what became of the events.
    fn summary_json(&self) -> PyResult<String> {
        let found = &self.found;
        let summary = json!({
            "start_ns": found.recorded.0,
            "end_ns": found.recorded.1,
            "windows": found.windows.iter().map(|window| json!({
                "start_ns": window.start, "end_ns": window.end, "events": window.events,
            })).collect::<Vec<_>>(),
            "areas_s": found.areas_s,
            "unrecorded_ns": found.unrecorded,
            "changing": found.changing,
        });
        serde_json::to_string(&summary).map_err(errors::input)
    }

    /// The rows of the table, or the first of them.
    #[pyo3(signature = (limit = None))]
    fn rows_json(&self, limit: Option<usize>) -> PyResult<String> {
        let rows: Vec<Value> = self
            .found
            .ranked
            .iter()
            .take(limit.unwrap_or(usize::MAX))
            .map(|r| {
                json!({
                    "rank": r.rank, "address": r.name, "name": self.name(r),
                    "score_in": r.score_in, "score_out": r.score_out, "changes": r.changes,
                    "same_as": self.same_as(r),
                })
            })
            .collect();
        serde_json::to_string(&rows).map_err(errors::input)
    }

    /// When the first of the list changed, each as an array.
    fn moments<'py>(
        &self,
        py: Python<'py>,
        log: &PyChangeLog,
        limit: usize,
    ) -> Vec<Bound<'py, PyArray1<i64>>> {
        let wanted: Vec<_> =
            self.found.ranked.iter().take(limit).map(|ranked| ranked.candidate).collect();
        let traces = py.detach(|| trace(&log.log, &wanted, self.view));
        traces.into_iter().map(|moments| moments.into_pyarray(py)).collect()
    }
}

/// Ranks a log's signals by events.
#[pyfunction]
#[pyo3(signature = (log, events_ns, settings_json = "{}", names = HashMap::new()))]
pub fn identify(
    py: Python<'_>,
    log: &PyChangeLog,
    events_ns: PyReadonlyArray1<'_, i64>,
    settings_json: &str,
    names: HashMap<String, String>,
) -> PyResult<PyIdentification> {
    let settings = Asked::settings(settings_json)?;
    let events = events_ns.as_array().to_vec();
    let found = py.detach(|| identified(&log.log, &events, &settings)).map_err(errors::input)?;
    Ok(PyIdentification { found, view: settings.view, names })
}

/// Tries several widths of windows.
#[pyfunction]
#[pyo3(signature = (log, events_ns, taus_ns, settings_json = "{}"))]
pub fn sweep_tau(
    py: Python<'_>,
    log: &PyChangeLog,
    events_ns: PyReadonlyArray1<'_, i64>,
    taus_ns: Vec<Nanoseconds>,
    settings_json: &str,
) -> PyResult<String> {
    let settings = Asked::settings(settings_json)?;
    let events = events_ns.as_array().to_vec();
    let steps =
        py.detach(|| sweep(&log.log, &events, &taus_ns, &settings)).map_err(errors::input)?;
    let told = |ranked: &Option<Ranked>| {
        ranked.as_ref().map(|r| {
            json!({
                "address": r.name, "score_in": r.score_in, "score_out": r.score_out,
                "changes": r.changes,
            })
        })
    };
    let swept = json!({
        "suggested": suggested(&steps),
        "steps": steps.iter().map(|step| json!({
            "tau_ns": step.tau, "windows": step.windows, "met": step.met, "lead": step.lead,
            "best": told(&step.best), "next": told(&step.next),
        })).collect::<Vec<_>>(),
    });
    serde_json::to_string(&swept).map_err(errors::input)
}

/// Group, device and signal of a name by a naming rule; None where it does not fit.
#[pyfunction]
pub fn split_name(naming: &str, name: &str) -> PyResult<Option<(String, String, String)>> {
    let rule = NamingRule::parse(naming).map_err(errors::input)?;
    Ok(rule.split(name).map(|split| (split.group, split.device, split.signal)))
}

/// What the bits of a word are called among the other signals of its log.
#[pyfunction]
pub fn bit_names(signals: Vec<String>, word: &str, width: u32) -> Vec<String> {
    let names = BitNames::of(signals.iter().map(String::as_str));
    (0..width.min(64)).map(|bit| names.name(word, bit)).collect()
}

type Events<'py> = (Bound<'py, PyArray1<i64>>, Vec<Option<String>>, String);

/// Reads declared events: times, labels, and what reading did.
#[pyfunction]
#[pyo3(signature = (path, options_json = "{}"))]
pub fn read_events<'py>(py: Python<'py>, path: &str, options_json: &str) -> PyResult<Events<'py>> {
    let options: ReadOptions = serde_json::from_str(options_json)
        .map_err(|error| errors::input(format!("reader options: {error}")))?;
    let events = py
        .detach(|| runglight_formats::read_events(Path::new(path), &options))
        .map_err(errors::input)?;
    let report = serde_json::to_string(&events.report).map_err(errors::input)?;
    Ok((events.time.into_pyarray(py), events.label, report))
}
