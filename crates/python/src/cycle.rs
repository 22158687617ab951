//! `CycleModel`: the cycle machine of Guim & Dias 2023, by itself or as part of a model.

use std::sync::Arc;

use pyo3::prelude::*;
use serde::Deserialize;
use serde_json::{Value, json};

use runglight_engine::cycle::image::Phase;
use runglight_engine::cycle::learn::{CycleError, learn};
use runglight_engine::cycle::localise;
use runglight_engine::cycle::model::CycleModel;
use runglight_engine::cycle::parameters::{CycleParameters, ModeSpec, RegionSpecs};
use runglight_engine::cycle::stops::Sign;
use runglight_engine::joint::learn::CycleSpec;
use runglight_engine::log::{ChangeLog, SECOND};
use runglight_engine::naming::NamingRule;
use runglight_engine::plant::Plant;
use runglight_engine::symbols::SymbolTable;

use crate::change_log::PyChangeLog;
use crate::errors;
use crate::monitor::PyMonitor;

/// `[modes]`, `[regions]` and `[cycle]` as JSON.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CycleSettings {
    modes: ModeSpec,
    #[serde(default)]
    regions: RegionSpecs,
    #[serde(default)]
    cycle: CycleParameters,
}

impl CycleSettings {
    pub fn parse(text: &str) -> PyResult<Self> {
        serde_json::from_str(text)
            .map_err(|error| errors::input(format!("settings of the cycle machine: {error}")))
    }

    pub fn spec(&self) -> CycleSpec<'_> {
        (&self.modes, &self.regions, &self.cycle)
    }

    fn learn(&self, logs: &[&ChangeLog], plant: &Plant) -> Result<CycleModel, CycleError> {
        learn(logs, plant, &self.modes, &self.regions, &self.cycle)
    }
}

/// What was learned of a machine's sequences.
#[pyclass(name = "CycleModel", module = "runglight._engine", frozen)]
pub struct PyCycleModel {
    model: Arc<CycleModel>,
}

impl PyCycleModel {
    pub fn new(model: Arc<CycleModel>) -> Self {
        Self { model }
    }

    fn region(&self, name: &str) -> PyResult<usize> {
        self.model.find_region(name).ok_or_else(|| {
            let names: Vec<&str> = self.model.regions.iter().map(|r| r.name.as_str()).collect();
            errors::input(format!(
                "the model has no region '{name}'; its regions: {}",
                names.join(", ")
            ))
        })
    }
}

fn phase_of(name: &str) -> PyResult<Phase> {
    match name {
        "work" => Ok(Phase::Work),
        "setup" => Ok(Phase::Setup),
        _ => Err(errors::input(format!("there is no phase '{name}'; use work or setup"))),
    }
}

#[pymethods]
impl PyCycleModel {
    /// Regions with their bits, and how much was learned of each.
    fn summary_json(&self) -> PyResult<String> {
        let model = &self.model;
        let address = |bit: usize| {
            let bit = &model.bits[bit];
            bit.address.clone().unwrap_or_else(|| bit.symbol.clone())
        };
        let phases = |of: &dyn Fn(usize) -> Value| json!({ "work": of(0), "setup": of(1) });
        let regions: Vec<Value> = (0..model.regions.len())
            .map(|index| {
                let region = &model.regions[index];
                let counts = |phase: usize| {
                    let machine = &model.machines[index][phase];
                    json!({
                        "states": machine.nodes.len(),
                        "initial": machine.nodes.iter().filter(|n| n.initial > 0).count(),
                        "final": machine.nodes.iter().filter(|n| n.last > 0).count(),
                        "transitions": machine.transitions.len(),
                        "either_order": model.independence[index][phase].len(),
                    })
                };
                json!({
                    "region": region.name,
                    "bits": region.slots.iter().map(|s| s.map(address)).collect::<Vec<_>>(),
                    "work": counts(0),
                    "setup": counts(1),
                })
            })
            .collect();
        let known_from = u64::from(model.parameters.known_stops);
        let stops: Vec<Value> = model
            .stops
            .iter()
            .map(|(signs, count)| {
                let sign = |sign: &Sign| {
                    let bit = &model.bits[sign.bit as usize];
                    json!({
                        "signal": bit.name,
                        "address": bit.address,
                        "showed": sign.showed,
                        "value": u8::from(sign.value),
                    })
                };
                json!({
                    "signs": signs.iter().map(sign).collect::<Vec<_>>(),
                    "count": count,
                    "known": known_from > 0 && count >= known_from,
                })
            })
            .collect();
        let summary = json!({
            "mode": model.parameters.mode,
            "parameters": model.parameters,
            "work_complete": address(model.modes.work_complete.bit),
            "mode_bits": model.modes.all().map(|mode| address(mode.bit)).collect::<Vec<_>>(),
            "sequences": phases(&|p| json!(model.kept[p])),
            "left_out": phases(&|p| json!(model.left_out[p])),
            "longest_s": phases(&|p| json!(model.longest[p] as f64 / SECOND as f64)),
            "stops": stops,
            "regions": regions,
        });
        serde_json::to_string(&summary).map_err(errors::input)
    }

    /// States and transitions of one region in one phase.
    fn machine_json(&self, region: &str, phase: &str) -> PyResult<String> {
        let (index, phase) = (self.region(region)?, phase_of(phase)?);
        let (shown, machine) = (&self.model.regions[index], self.model.machine(index, phase));
        let hex = |state: u32| shown.hex(machine.word(state));
        let machine = json!({
            "region": shown.name,
            "phase": phase,
            "states": machine.nodes.iter().map(|node| json!({
                "word": shown.hex(node.word), "initial": node.initial, "final": node.last,
            })).collect::<Vec<_>>(),
            "transitions": machine.transitions.iter().map(|t| json!({
                "from": hex(t.from), "to": hex(t.to), "weight": t.weight,
                "longest_stay_s": t.longest_stay as f64 / SECOND as f64,
            })).collect::<Vec<_>>(),
        });
        serde_json::to_string(&machine).map_err(errors::input)
    }

    /// What could have followed a word, against what was seen: best first.
    fn candidates_json(&self, region: &str, phase: &str, at: &str, seen: &str) -> PyResult<String> {
        let (index, phase) = (self.region(region)?, phase_of(phase)?);
        let (shown, machine) = (&self.model.regions[index], self.model.machine(index, phase));
        let word = |text: &str| {
            u128::from_str_radix(text, 16)
                .map_err(|_| errors::input(format!("'{text}' is no hexadecimal word")))
        };
        let possible = machine.find(word(at)?).map_or(&[][..], |state| machine.from(state));
        let candidates = localise::candidates(
            possible.iter().map(|t| (machine.word(t.to), t.weight)),
            word(seen)?,
            shown.width(),
        );
        let rows: Vec<Value> = candidates
            .iter()
            .map(|c| {
                json!({
                    "word": shown.hex(c.word), "weight": c.weight, "popularity": c.popularity,
                    "similarity": c.similarity, "score": c.score,
                    "differing": shown.hex(c.differing),
                })
            })
            .collect();
        serde_json::to_string(&rows).map_err(errors::input)
    }

    /// Graphviz text.
    fn dot(&self, region: &str, phase: &str) -> PyResult<String> {
        Ok(self.model.dot(self.region(region)?, phase_of(phase)?))
    }

    /// Watches the cycle machine alone.
    #[pyo3(signature = (state = None))]
    fn monitor(&self, state: Option<&[u8]>) -> PyResult<PyMonitor> {
        PyMonitor::of_cycle(Arc::clone(&self.model), state).map_err(errors::input)
    }
}

/// Learns the cycle machine alone.
#[pyfunction]
#[pyo3(signature = (logs, settings_json, symbols_csv = None, naming = "{group}-{device}-{signal}"))]
pub fn learn_cycle(
    py: Python<'_>,
    logs: Vec<Py<PyChangeLog>>,
    settings_json: &str,
    symbols_csv: Option<&str>,
    naming: &str,
) -> PyResult<PyCycleModel> {
    let settings = CycleSettings::parse(settings_json)?;
    let table = SymbolTable::parse(symbols_csv.unwrap_or("address\n")).map_err(errors::input)?;
    let rule = NamingRule::parse(naming).map_err(errors::input)?;
    let logs: Vec<&ChangeLog> = logs.iter().map(|log| &log.get().log).collect();
    let mut symbols: Vec<String> = Vec::new();
    let mut known = std::collections::HashSet::new();
    for log in &logs {
        symbols.extend(log.signals.iter().filter(|s| known.insert(s.as_str())).cloned());
    }
    let learned = py.detach(|| {
        let plant = Plant::arrange(&symbols, &table, &rule);
        settings.learn(&logs, &plant)
    });
    Ok(PyCycleModel::new(Arc::new(learned.map_err(errors::input)?)))
}
