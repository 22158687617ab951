//! Each engine error becomes one named Python exception whose text is the engine's sentence.

use pyo3::create_exception;
use pyo3::exceptions::PyException;
use pyo3::prelude::*;

create_exception!(
    _engine,
    RunglightError,
    PyException,
    "Base of everything the engine raises; its text is one sentence for the user."
);
create_exception!(
    _engine,
    InputError,
    RunglightError,
    "A log, table or parameter cannot be used: names the file, the row and the mend."
);
create_exception!(
    _engine,
    ModelError,
    RunglightError,
    "A model directory is missing, older than this version, or damaged."
);

/// Adds the exceptions to the module.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    module.add("RunglightError", py.get_type::<RunglightError>())?;
    module.add("InputError", py.get_type::<InputError>())?;
    module.add("ModelError", py.get_type::<ModelError>())
}

/// An unusable input.
pub fn input(error: impl std::fmt::Display) -> PyErr {
    InputError::new_err(error.to_string())
}

/// An unusable model.
pub fn model(error: impl std::fmt::Display) -> PyErr {
    ModelError::new_err(error.to_string())
}
