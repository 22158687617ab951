//! Python bindings of the runglight engine: Arrow in, Arrow out. The only crate that names `pyo3`.

mod change_log;
mod contract;
mod control;
mod cycle;
mod errors;
mod findings;
mod identify;
mod lessons;
mod model;
mod monitor;
mod process;
mod stream;
mod timing_diagram;

use pyo3::prelude::*;

/// The compiled engine; `python/runglight/_engine.pyi` describes it.
#[pymodule]
fn _engine(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    quiet_panics();
    errors::register(module)?;
    module.add_class::<change_log::PyChangeLog>()?;
    module.add_class::<control::PyController>()?;
    module.add_class::<control::PyShadow>()?;
    module.add_class::<cycle::PyCycleModel>()?;
    module.add_class::<findings::PyFindings>()?;
    module.add_class::<identify::PyIdentification>()?;
    module.add_class::<lessons::PyGroupLearner>()?;
    module.add_class::<lessons::PyLearningContext>()?;
    module.add_class::<lessons::PyLogSurvey>()?;
    module.add_class::<model::PyNominalModel>()?;
    module.add_class::<model::PyRules>()?;
    module.add_class::<monitor::PyMonitor>()?;
    module.add_class::<process::event_log::PyEventLog>()?;
    module.add_class::<process::mining::PyMined>()?;
    module.add_class::<process::petri_net::PyPetriNet>()?;
    module.add_class::<process::next_activity::PyNextActivity>()?;
    module.add_class::<process::next_monitor::PyNextMonitor>()?;
    module.add_class::<timing_diagram::PyTimingDiagram>()?;
    module.add_function(wrap_pyfunction!(change_log::read_log, module)?)?;
    module.add_function(wrap_pyfunction!(change_log::write_log, module)?)?;
    module.add_function(wrap_pyfunction!(change_log::log_from_columns, module)?)?;
    module.add_function(wrap_pyfunction!(control::learn_guards, module)?)?;
    module.add_function(wrap_pyfunction!(control::structured_text_of, module)?)?;
    module.add_function(wrap_pyfunction!(cycle::learn_cycle, module)?)?;
    module.add_function(wrap_pyfunction!(identify::bit_names, module)?)?;
    module.add_function(wrap_pyfunction!(identify::identify, module)?)?;
    module.add_function(wrap_pyfunction!(identify::read_events, module)?)?;
    module.add_function(wrap_pyfunction!(identify::split_name, module)?)?;
    module.add_function(wrap_pyfunction!(identify::sweep_tau, module)?)?;
    module.add_function(wrap_pyfunction!(lessons::log_columns, module)?)?;
    module.add_function(wrap_pyfunction!(model::learn, module)?)?;
    module.add_function(wrap_pyfunction!(model::load_model, module)?)?;
    module.add_function(wrap_pyfunction!(process::event_log::event_log, module)?)?;
    module.add_function(wrap_pyfunction!(process::mining::mine, module)?)?;
    module.add_function(wrap_pyfunction!(process::next_activity::decay_samples, module)?)?;
    module.add_function(wrap_pyfunction!(process::next_activity::train_next, module)?)?;
    module.add_function(wrap_pyfunction!(process::next_activity::load_next, module)?)?;
    module.add_function(wrap_pyfunction!(process::next_activity::markov_score, module)?)?;
    Ok(())
}

/// A decoder that panics on a damaged file is caught and told as an error; what Rust would print
/// besides would only frighten the user. `RUST_BACKTRACE` brings it back.
fn quiet_panics() {
    if std::env::var_os("RUST_BACKTRACE").is_none() {
        std::panic::set_hook(Box::new(|_| {}));
    }
}
