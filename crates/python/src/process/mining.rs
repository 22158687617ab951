//! Mining event logs.

use std::path::Path;
use std::sync::Arc;

use pyo3::prelude::*;

use runglight_engine::process::event_log::Activity;
use runglight_engine::process::split_miner::model::ProcessModel;
use runglight_engine::process::split_miner::{MiningParameters, mine as mine_log};

use super::event_log::PyEventLog;
use super::petri_net::PyPetriNet;
use crate::errors;

/// What was mined: a model of tasks and gateways, and the same as a net.
#[pyclass(name = "Mined", module = "runglight._engine", frozen)]
pub struct PyMined {
    model: ProcessModel,
    activities: Vec<Activity>,
    net: PyPetriNet,
    #[pyo3(get)]
    epsilon: f64,
}

#[pymethods]
impl PyMined {
    #[getter]
    fn net(&self) -> PyPetriNet {
        PyPetriNet { net: Arc::clone(&self.net.net) }
    }

    fn write_bpmn(&self, py: Python<'_>, path: &str) -> PyResult<()> {
        let write =
            || runglight_formats::bpmn::write(&self.model, &self.activities, Path::new(path));
        py.detach(write).map_err(errors::input)
    }
}

/// Mines an event log with Split Miner.
#[pyfunction]
#[pyo3(signature = (log, parameters_json = "{}"))]
pub fn mine(py: Python<'_>, log: &PyEventLog, parameters_json: &str) -> PyResult<PyMined> {
    let parameters: MiningParameters = serde_json::from_str(parameters_json)
        .map_err(|error| errors::input(format!("mining: {error}")))?;
    let mined = py.detach(|| mine_log(&log.log, &parameters)).map_err(errors::input)?;
    Ok(PyMined {
        model: mined.model,
        activities: log.log.activities.clone(),
        net: PyPetriNet::new(mined.net),
        epsilon: mined.epsilon,
    })
}
