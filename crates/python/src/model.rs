//! `NominalModel`: learn, save, load, look at, confirm.

use std::path::Path;
use std::sync::Arc;
use std::time::{SystemTime, UNIX_EPOCH};

use arrow_array::RecordBatch;
use pyo3::prelude::*;
use pyo3::types::PyCapsule;
use serde_json::{Value, json};

use runglight_engine::cycle::model::CycleModel;
use runglight_engine::finding::{Finding, time_text};
use runglight_engine::joint::learn::learn as learn_both;
use runglight_engine::log::{ChangeLog, SECOND, SignalIndex};
use runglight_engine::signal_state::chains::ChainIndex;
use runglight_engine::signal_state::model::NominalModel;
use runglight_engine::signal_state::parameters::Parameters;
use runglight_engine::symbols::SymbolTable;
use runglight_formats::model_directory::{self, MODEL_FORMAT, Provenance};
use runglight_formats::rules_table;

use crate::change_log::PyChangeLog;
use crate::cycle::{CycleSettings, PyCycleModel};
use crate::errors;
use crate::monitor::{ELSEWHERE, PyMonitor, Share};
use crate::stream;

/// What was learned of a plant.
#[pyclass(name = "NominalModel", module = "runglight._engine")]
pub struct PyNominalModel {
    model: Arc<NominalModel>,
    cycle: Option<Arc<CycleModel>>,
    provenance: Provenance,
    /// Where this is a part of a model.
    share: Option<Arc<Share>>,
}

/// The rules of a model as an Arrow table.
#[pyclass(name = "Rules", module = "runglight._engine", frozen)]
pub struct PyRules {
    batch: RecordBatch,
}

#[pymethods]
impl PyRules {
    fn __len__(&self) -> usize {
        self.batch.num_rows()
    }

    #[pyo3(signature = (requested_schema = None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyCapsule>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        stream::export(py, self.batch.clone(), requested_schema)
    }
}

impl PyNominalModel {
    /// A model without a cycle machine.
    pub fn of(model: NominalModel, provenance: Provenance) -> Self {
        Self { model: Arc::new(model), cycle: None, provenance, share: None }
    }

    fn chain(&self, group: &str, device: Option<&str>) -> PyResult<ChainIndex> {
        self.model.find_chain(group, device).ok_or_else(|| {
            let name = device.map_or_else(|| group.to_owned(), |d| format!("{group}-{d}"));
            errors::input(format!("the model has no device or group '{name}'"))
        })
    }

    fn rule_rows(&self, chain: ChainIndex) -> Vec<Value> {
        let model = &self.model;
        let mut rows = Vec::new();
        for rule in model.rules_of(chain) {
            let limits = model.limits_of(rule);
            let trigger = rule.trigger.as_ref().and_then(|t| t.clusters.last());
            let row = |cluster: Option<usize>| {
                let of = cluster.map(|index| &rule.clusters[index]);
                let own = cluster.filter(|_| rule.trigger.is_none());
                let limit = own.and_then(|index| limits.get(index));
                json!({
                    "model": if model.device_name(chain).is_some() { "device" } else { "group" },
                    "group": model.group_name(chain),
                    "device": model.device_name(chain),
                    "current": model.state_name(rule.current),
                    "next": model.state_name(rule.next),
                    "count": rule.count,
                    "transition_probability": rule.probability,
                    "cluster": cluster,
                    "average_s": of.map(|c| c.average_s),
                    "minimum_s": of.map(|c| c.minimum_s),
                    "maximum_s": of.map(|c| c.maximum_s),
                    "time_probability": of.map(|c| c.probability),
                    "position": rule.position,
                    "trigger": rules_table::trigger_name(model, rule),
                    "trigger_average_s": trigger.map(|t| t.average_s),
                    "trigger_maximum_s": trigger.map(|t| t.maximum_s),
                    "trigger_times": rule.trigger.as_ref().map(|trigger| &trigger.clusters),
                    "early_limit_s": limit.map(|l| l.0),
                    "late_limit_s": limit.map(|l| l.1).filter(|l| l.is_finite()),
                    "start_up": rule.evidence() == 0,
                })
            };
            if rule.clusters.is_empty() {
                rows.push(row(None));
            }
            rows.extend((0..rule.clusters.len()).map(|index| row(Some(index))));
        }
        rows
    }

    fn group_list(&self) -> Value {
        let plant = &self.model.plant;
        let groups = plant.groups.iter().enumerate().map(|(group, entry)| {
            let devices: Vec<Value> = plant
                .devices
                .iter()
                .enumerate()
                .filter(|(_, device)| device.group == group)
                .map(|(index, device)| {
                    json!({
                        "device": device.name,
                        "start": device.starting.map(|s| plant.signals[s as usize].name().to_owned()),
                        "signals": plant.signals.iter().filter(|s| s.device() == index).count(),
                        "rules": self.model.rules.iter().filter(|r| r.chain == index).count(),
                    })
                })
                .collect();
            let start = self.model.learned.group_start.get(group).copied();
            let known = start.filter(|&s| (s as usize) < self.model.states.len());
            json!({
                "group": entry.name,
                "start": known.map(|state| self.model.state_name(state)),
                "stall_after_s": self.model.stall_after(group) as f64 / SECOND as f64,
                "devices": devices,
            })
        });
        Value::Array(groups.collect())
    }
}

#[pymethods]
impl PyNominalModel {
    fn rules(&self, py: Python<'_>) -> PyRules {
        PyRules { batch: py.detach(|| rules_table::to_batch(&self.model)) }
    }

    #[pyo3(signature = (group = None, device = None))]
    fn rules_json(&self, group: Option<&str>, device: Option<&str>) -> PyResult<String> {
        let chains = match group {
            Some(group) => vec![self.chain(group, device)?],
            None => (0..self.model.plant.devices.len() + self.model.plant.groups.len()).collect(),
        };
        let rows: Vec<Value> = chains.into_iter().flat_map(|c| self.rule_rows(c)).collect();
        serde_json::to_string(&rows).map_err(errors::input)
    }

    fn save(&self, py: Python<'_>, directory: &str) -> PyResult<()> {
        if self.model.is_part() {
            return Err(errors::input(
                "a part of a model cannot be saved by itself; save the whole model",
            ));
        }
        py.detach(|| {
            let cycle = self.cycle.as_deref();
            model_directory::save(&self.model, cycle, &self.provenance, Path::new(directory))
        })
        .map_err(errors::model)
    }

    fn summary_json(&self) -> PyResult<String> {
        let model = &self.model;
        let seconds = |nanoseconds: i64| nanoseconds as f64 / SECOND as f64;
        let summary = json!({
            "created": self.provenance.created,
            "source": self.provenance.source,
            "format": MODEL_FORMAT,
            "timing": model.parameters.timing,
            "parameters": model.parameters,
            "signals": model.plant.signals.len(),
            "devices": model.plant.devices.len(),
            "groups": model.plant.groups.len(),
            "rules": model.rules.len(),
            "events": model.learned.events,
            "duration_s": seconds(model.learned.duration),
            "scan_interval_s": seconds(model.learned.resolution),
            "unnamed": model.plant.unplaced,
            "group_list": self.group_list(),
        });
        serde_json::to_string(&summary).map_err(errors::input)
    }

    #[pyo3(signature = (group, device = None))]
    fn dot(&self, group: &str, device: Option<&str>) -> PyResult<String> {
        Ok(self.model.dot(self.chain(group, device)?))
    }

    #[getter]
    fn signals(&self) -> Vec<&str> {
        self.model.plant.signals.iter().map(|signal| signal.symbol()).collect()
    }

    fn knows(&self, log: &Bound<'_, PyChangeLog>) -> bool {
        let (model, log) = (&self.model, &log.get().log);
        let found = model.symbols().find_all(&model.plant, log.signals.iter().map(String::as_str));
        found.iter().all(Option::is_some)
    }

    fn symbols_csv(&self) -> String {
        SymbolTable::of_plant(&self.model.plant)
    }

    #[getter]
    fn cycle(&self) -> Option<PyCycleModel> {
        self.cycle.clone().map(PyCycleModel::new)
    }

    #[pyo3(signature = (state = None))]
    fn monitor(&self, state: Option<&[u8]>) -> PyResult<PyMonitor> {
        let model = Arc::clone(&self.model);
        let monitor = match &self.share {
            Some(share) => PyMonitor::of_part(model, Arc::clone(share), state),
            None => PyMonitor::new(model, self.cycle.clone(), state),
        };
        monitor.map_err(errors::input)
    }

    #[getter]
    fn groups(&self) -> Vec<&str> {
        self.model.plant.groups.iter().map(|group| group.name.as_str()).collect()
    }

    fn independent_groups(&self) -> Vec<Vec<&str>> {
        let name = |group: usize| self.model.plant.groups[group].name.as_str();
        if self.cycle.is_some() {
            return vec![self.groups()];
        }
        let parts = self.model.independent_groups();
        parts.into_iter().map(|part| part.into_iter().map(name).collect()).collect()
    }

    fn groups_of(&self, signals: Vec<String>) -> Vec<Option<&str>> {
        let whole = self.share.as_ref().map_or(&self.model, |share| &share.whole);
        let found = whole.symbols().find_all(&whole.plant, signals.iter().map(String::as_str));
        let group = |signal: SignalIndex| {
            let device = whole.plant.device_of(signal);
            whole.plant.groups[device.group].name.as_str()
        };
        found.into_iter().map(|signal| signal.map(group)).collect()
    }

    #[getter]
    fn is_part(&self) -> bool {
        self.model.is_part()
    }

    fn part(&self, py: Python<'_>, groups: Vec<String>) -> PyResult<Self> {
        if self.model.is_part() {
            return Err(errors::input("this is a part of a model already; cut the whole model"));
        }
        let mut numbers = Vec::with_capacity(groups.len());
        for name in &groups {
            numbers.push(
                self.model
                    .plant
                    .find_group(name)
                    .ok_or_else(|| errors::input(format!("the model has no group '{name}'")))?,
            );
        }
        if numbers.is_empty() {
            return Err(errors::input(
                "a part needs a group at least; name one of the model's groups",
            ));
        }
        if self.cycle.is_some() {
            return Err(errors::input(
                "this model has a cycle machine, which watches the whole plant; it has no parts",
            ));
        }
        for together in self.model.independent_groups() {
            let inside = together.iter().filter(|group| numbers.contains(group)).count();
            if inside > 0 && inside < together.len() {
                let name = |group: &usize| self.model.plant.groups[*group].name.as_str();
                let names: Vec<&str> = together.iter().map(name).collect();
                return Err(errors::input(format!(
                    "the groups {} wait for one another; keep them in one part",
                    names.join(", ")
                )));
            }
        }
        let (model, part) = py.detach(|| self.model.part(&numbers));
        let mut own = vec![ELSEWHERE; self.model.plant.signals.len()];
        for (number, &signal) in (0..).zip(&part.signals) {
            own[signal as usize] = number;
        }
        let tells_unknown = numbers.contains(&0);
        let share = Share { whole: Arc::clone(&self.model), own, tells_unknown };
        Ok(Self {
            model: Arc::new(model),
            cycle: None,
            provenance: self.provenance.clone(),
            share: Some(Arc::new(share)),
        })
    }

    fn confirm(&mut self, finding_json: &str) -> PyResult<usize> {
        let finding: Finding = serde_json::from_str(finding_json)
            .map_err(|error| errors::input(format!("this is no finding: {error}")))?;
        let (model, new) = self.model.confirm(&finding).map_err(errors::input)?;
        self.model = Arc::new(model);
        Ok(new)
    }
}

/// Learns from fault-free logs.
#[pyfunction]
#[pyo3(signature = (logs, symbols_csv = None, parameters_json = "{}", source = Vec::new(), cycle_json = None))]
pub fn learn(
    py: Python<'_>,
    logs: Vec<Py<PyChangeLog>>,
    symbols_csv: Option<&str>,
    parameters_json: &str,
    source: Vec<String>,
    cycle_json: Option<&str>,
) -> PyResult<PyNominalModel> {
    let parameters: Parameters = serde_json::from_str(parameters_json)
        .map_err(|error| errors::input(format!("parameters of learning: {error}")))?;
    let table = SymbolTable::parse(symbols_csv.unwrap_or("address\n")).map_err(errors::input)?;
    let logs: Vec<&ChangeLog> = logs.iter().map(|log| &log.get().log).collect();
    let settings = cycle_json.map(CycleSettings::parse).transpose()?;
    let spec = settings.as_ref().map(CycleSettings::spec);
    let (model, cycle) =
        py.detach(|| learn_both(&logs, &table, &parameters, spec)).map_err(errors::input)?;
    let provenance = Provenance { created: now_text(), source };
    Ok(PyNominalModel {
        model: Arc::new(model),
        cycle: cycle.map(Arc::new),
        provenance,
        share: None,
    })
}

/// Loads a model directory.
#[pyfunction]
pub fn load_model(py: Python<'_>, directory: &str) -> PyResult<PyNominalModel> {
    let (model, cycle, provenance) =
        py.detach(|| model_directory::load(Path::new(directory))).map_err(errors::model)?;
    Ok(PyNominalModel {
        model: Arc::new(model),
        cycle: cycle.map(Arc::new),
        provenance,
        share: None,
    })
}

/// The present time, ISO 8601 UTC.
pub fn now_text() -> String {
    let since_epoch = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    time_text(i64::try_from(since_epoch.as_nanos()).unwrap_or(i64::MAX))
}
