//! `NextActivity`: trained, kept, asked.

use std::path::Path;
use std::sync::Arc;

use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

use runglight_engine::process::baseline::Markov;
use runglight_engine::process::decay::{Decay, DecayState, Samples};
use runglight_engine::process::lesson;
use runglight_engine::process::next_activity::{NextActivity, Predictor};
use runglight_engine::process::petri::PetriNet;
use runglight_engine::process::replay::TokenReplay;
use runglight_engine::process::succession::Succession;
use runglight_formats::next_directory::{self, NextError, Training};
use runglight_neural::learn::learn;
use runglight_neural::training::{Epoch, Settings, TrainingError};

use super::event_log::PyEventLog;
use super::petri_net::PyPetriNet;
use crate::errors;

/// A network that foretells the next activity, and the net it was trained with.
#[pyclass(name = "NextActivity", module = "runglight._engine", frozen)]
pub struct PyNextActivity {
    pub next: NextActivity,
    pub net: Arc<PetriNet>,
    training: Training,
}

/// How each event was foretold: trace, event, expected class, activity that came, probability of
/// what came.
type Foretold<'py> = (
    Bound<'py, PyArray1<u64>>,
    Bound<'py, PyArray1<u64>>,
    Bound<'py, PyArray1<u32>>,
    Bound<'py, PyArray1<u32>>,
    Bound<'py, PyArray1<f32>>,
    Bound<'py, PyArray1<bool>>,
);

#[pymethods]
impl PyNextActivity {
    /// Names of the activities it can foretell.
    #[getter]
    fn activities(&self) -> Vec<String> {
        self.next.activities().to_vec()
    }

    /// `{created, source, settings, events}`.
    fn training_json(&self) -> PyResult<String> {
        serde_json::to_string(&self.training).map_err(errors::model)
    }

    fn save(&self, py: Python<'_>, path: &str) -> PyResult<()> {
        py.detach(|| next_directory::save(&self.next, &self.net, &self.training, Path::new(path)))
            .map_err(errors::model)
    }

    fn foretell<'py>(
        &self,
        py: Python<'py>,
        log: &PyEventLog,
        traces: Vec<usize>,
    ) -> PyResult<Foretold<'py>> {
        check(&traces, log)?;
        let log = &log.log;
        let foretold = py.detach(|| {
            let succession = Succession::of(log);
            lesson::foretell(&mut self.next.clone(), &self.net, log, &traces, succession)
        });
        let column =
            |of: fn(&lesson::Foretold) -> u64| -> Vec<u64> { foretold.iter().map(of).collect() };
        Ok((
            column(|event| event.trace as u64).into_pyarray(py),
            column(|event| event.event as u64).into_pyarray(py),
            foretold.iter().map(|f| f.expected as u32).collect::<Vec<_>>().into_pyarray(py),
            foretold.iter().map(|f| f.came).collect::<Vec<_>>().into_pyarray(py),
            foretold.iter().map(|f| f.probability).collect::<Vec<_>>().into_pyarray(py),
            foretold.iter().map(|f| f.right).collect::<Vec<_>>().into_pyarray(py),
        ))
    }
}

/// Trains on some traces; `progress(epoch, loss, held_out_loss)` is called after each epoch.
#[pyfunction]
#[pyo3(signature = (log, net, traces, settings_json, source, events_json, progress = None))]
#[expect(clippy::too_many_arguments, reason = "one call from Python, and the interpreter")]
pub fn train_next(
    py: Python<'_>,
    log: &PyEventLog,
    net: &PyPetriNet,
    traces: Vec<usize>,
    settings_json: &str,
    source: Vec<String>,
    events_json: &str,
    progress: Option<Py<PyAny>>,
) -> PyResult<PyNextActivity> {
    check(&traces, log)?;
    let settings: Settings = serde_json::from_str(settings_json)
        .map_err(|error| errors::input(format!("settings of the training: {error}")))?;
    let events = serde_json::from_str(events_json).map_err(errors::input)?;
    let mut stopped: Option<PyErr> = None;
    let succession = Succession::of(&log.log);
    let trained = py.detach(|| {
        learn(&net.net, &log.log, &traces, succession, &settings, |epoch| {
            stopped = tell(progress.as_ref(), epoch).err();
            stopped.is_none()
        })
    });
    let next = match (trained, stopped) {
        (Err(TrainingError::Interrupted), Some(error)) => return Err(error),
        (trained, _) => trained.map_err(errors::input)?,
    };
    let settings = serde_json::to_value(settings).map_err(errors::input)?;
    let created = crate::model::now_text();
    let training = Training { created, source, settings, events };
    Ok(PyNextActivity { next, net: Arc::clone(&net.net), training })
}

/// Tells the caller, and lets Ctrl-C through.
fn tell(progress: Option<&Py<PyAny>>, epoch: Epoch) -> PyResult<()> {
    Python::attach(|py| {
        py.check_signals()?;
        if let Some(progress) = progress {
            progress.call1(py, (epoch.number, epoch.loss, epoch.held_out_loss))?;
        }
        Ok(())
    })
}

/// Reads a trained network; `net` must be the one it was trained with.
#[pyfunction]
#[pyo3(signature = (path, net, net_path = ""))]
pub fn load_next(
    py: Python<'_>,
    path: &str,
    net: &PyPetriNet,
    net_path: &str,
) -> PyResult<PyNextActivity> {
    let shown = if net_path.is_empty() { "the net given" } else { net_path };
    let loaded = py.detach(|| next_directory::load(Path::new(path), (&net.net, Path::new(shown))));
    let (next, training) = loaded.map_err(|error: NextError| errors::model(error))?;
    Ok(PyNextActivity { next, net: Arc::clone(&net.net), training })
}

/// Events foretold rightly, and events there were, by what most often followed the last `order`
/// activities in the training part.
#[pyfunction]
pub fn markov_score(
    py: Python<'_>,
    log: &PyEventLog,
    train: Vec<usize>,
    test: Vec<usize>,
    order: usize,
) -> PyResult<(usize, usize)> {
    check(&train, log)?;
    check(&test, log)?;
    let log = &log.log;
    Ok(py.detach(|| {
        let succession = Succession::of(log);
        Markov::fit(log, &train, order, succession).score(log, &test, succession)
    }))
}

fn check(traces: &[usize], log: &PyEventLog) -> PyResult<()> {
    let count = log.log.traces();
    match traces.iter().find(|&&trace| trace >= count) {
        Some(beyond) => {
            Err(errors::input(format!("there is no trace {beyond}; the log has {count}")))
        }
        None => Ok(()),
    }
}

/// Decay samples of some traces: features (one row each), and the activity that came.
type Sampled<'py> = (Bound<'py, PyArray2<f32>>, Bound<'py, PyArray1<u32>>);

/// The samples a network is trained with, not scaled; decays are learned from the same traces.
#[pyfunction]
pub fn decay_samples<'py>(
    py: Python<'py>,
    log: &PyEventLog,
    net: &PyPetriNet,
    traces: Vec<usize>,
) -> PyResult<Sampled<'py>> {
    check(&traces, log)?;
    let (log, net) = (&log.log, &net.net);
    let samples = py.detach(|| {
        let mut replay = TokenReplay::of(net, &log.activities);
        let decay = Decay::fit(&mut replay, log, &traces);
        Samples::take(&mut replay, &decay, log, &traces, Succession::of(log))
    });
    let width = DecayState::features(net.places.len());
    let features = samples.features.into_pyarray(py).reshape([samples.next.len(), width])?;
    Ok((features, samples.next.into_pyarray(py)))
}
