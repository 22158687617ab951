//! `Controller` and `Shadow`: the learned controller in the place of the real one, or beside it.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use pyo3::prelude::*;
use serde_json::json;

use runglight_engine::control::controller::Controller;
use runglight_engine::control::decide::Decide;
use runglight_engine::control::guards::{FORMAT, Guards};
use runglight_engine::control::learn::{LearnParameters, learn};
use runglight_engine::control::message;
use runglight_engine::control::network::Predicted;
use runglight_engine::control::program::Program;
use runglight_engine::control::shadow::Shadow;
use runglight_engine::control::structured_text;

use crate::change_log::PyChangeLog;
use crate::errors;
use crate::findings::PyFindings;
use crate::process::next_activity::PyNextActivity;
use crate::process::petri_net::PyPetriNet;

type Terminals = Vec<(String, &'static str)>;
type Writes = Vec<(usize, i64)>;

/// A learned controller in the place of the PLC's program.
#[pyclass(name = "Controller", module = "runglight._engine", frozen)]
pub struct PyController {
    controller: Mutex<Controller>,
    program: Arc<Program>,
}

#[pymethods]
impl PyController {
    #[new]
    #[pyo3(signature = (net, guards_json = None, next = None, safe = Vec::new()))]
    fn new(
        net: &PyPetriNet,
        guards_json: Option<&str>,
        next: Option<&PyNextActivity>,
        safe: Vec<(String, i64)>,
    ) -> PyResult<Self> {
        let program = program_of(net)?;
        let decide = decider(&program, next);
        let controller =
            Controller::new(Arc::clone(&program), guards_of(guards_json)?, decide, &safe);
        let controller = Mutex::new(controller.map_err(errors::input)?);
        Ok(Self { controller, program })
    }

    #[getter]
    fn terminals(&self) -> Terminals {
        terminals(&self.program)
    }

    #[getter]
    fn safe(&self) -> Writes {
        lock(&self.controller).safe().to_vec()
    }

    #[getter]
    fn mode(&self) -> &'static str {
        message::mode(lock(&self.controller).mode())
    }

    #[getter]
    fn last(&self) -> String {
        lock(&self.controller).last().to_owned()
    }

    fn scan(&self, now_ns: i64, values: Vec<Option<i64>>) -> PyResult<(Writes, PyFindings)> {
        fits(&self.program, &values)?;
        let scan = lock(&self.controller).scan(now_ns, &values);
        Ok((scan.writes, PyFindings::from(scan.findings)))
    }
}

/// A learned controller beside the real one.
#[pyclass(name = "Shadow", module = "runglight._engine", frozen)]
pub struct PyShadow {
    shadow: Mutex<Shadow>,
    program: Arc<Program>,
}

#[pymethods]
impl PyShadow {
    #[new]
    #[pyo3(signature = (net, guards_json = None, next = None, patience_s = 0.5))]
    fn new(
        net: &PyPetriNet,
        guards_json: Option<&str>,
        next: Option<&PyNextActivity>,
        patience_s: f64,
    ) -> PyResult<Self> {
        let program = program_of(net)?;
        let decide = decider(&program, next);
        let shadow = Shadow::new(Arc::clone(&program), guards_of(guards_json)?, decide, patience_s);
        Ok(Self { shadow: Mutex::new(shadow.map_err(errors::input)?), program })
    }

    #[getter]
    fn terminals(&self) -> Terminals {
        terminals(&self.program)
    }

    #[getter]
    fn following(&self) -> bool {
        lock(&self.shadow).following()
    }

    #[getter]
    fn last(&self) -> String {
        lock(&self.shadow).last().to_owned()
    }

    fn scan(&self, now_ns: i64, values: Vec<Option<i64>>) -> PyResult<PyFindings> {
        fits(&self.program, &values)?;
        Ok(PyFindings::from(lock(&self.shadow).scan(now_ns, &values)))
    }

    fn gap(&self) {
        lock(&self.shadow).gap();
    }
}

/// Learns what the net cannot say: counters that decide, and timers.
#[pyfunction]
pub fn learn_guards(
    py: Python<'_>,
    net: &PyPetriNet,
    logs: Vec<Py<PyChangeLog>>,
    reaction_s: f64,
) -> PyResult<String> {
    let program = program_of(net)?;
    let logs: Vec<_> = logs.iter().map(|log| &log.get().log).collect();
    let learned = py.detach(|| learn(&program, &logs, LearnParameters { reaction_s }));
    let learned = learned.map_err(errors::input)?;
    let summary = json!({
        "guards": learned.guards,
        "events": learned.events,
        "runs": learned.runs,
        "departures": learned.departures,
    });
    Ok(summary.to_string())
}

/// The learned controller as a program in Structured Text.
#[pyfunction]
#[pyo3(signature = (net, guards_json = None, safe = Vec::new(), name = "learned"))]
pub fn structured_text_of(
    net: &PyPetriNet,
    guards_json: Option<&str>,
    safe: Vec<(String, i64)>,
    name: &str,
) -> PyResult<String> {
    let program = program_of(net)?;
    structured_text::write(&program, &guards_of(guards_json)?, &safe, name).map_err(errors::input)
}

fn program_of(net: &PyPetriNet) -> PyResult<Arc<Program>> {
    Program::new((*net.net).clone()).map(Arc::new).map_err(errors::input)
}

fn guards_of(json: Option<&str>) -> PyResult<Guards> {
    let Some(json) = json else { return Ok(Guards::default()) };
    let guards: Guards = serde_json::from_str(json).map_err(|error| {
        errors::input(format!("these are no guards ({error}); learn them anew"))
    })?;
    if guards.format != FORMAT {
        return Err(errors::input(format!(
            "the guards have format {}, this version reads format {FORMAT}; learn them anew",
            guards.format
        )));
    }
    Ok(guards)
}

fn decider(program: &Program, next: Option<&PyNextActivity>) -> Option<Box<dyn Decide>> {
    let next = next?;
    Some(Box::new(Predicted::new(program, next.next.clone())))
}

fn terminals(program: &Program) -> Terminals {
    let class = |output| if output { "output" } else { "input" };
    program.terminals.iter().map(|t| (t.address.clone(), class(t.output))).collect()
}

fn fits(program: &Program, values: &[Option<i64>]) -> PyResult<()> {
    let terminals = program.terminals.len();
    if values.len() == terminals {
        return Ok(());
    }
    Err(errors::input(format!("a scan of this net has {terminals} values, not {}", values.len())))
}

/// A panic elsewhere leaves nothing half done here: every scan is whole or did not happen.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
