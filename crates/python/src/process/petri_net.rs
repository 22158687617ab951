//! `PetriNet`: read, written and looked at.

use std::path::Path;
use std::sync::Arc;

use pyo3::prelude::*;

use runglight_engine::process::petri::PetriNet;

use super::event_log::class_name;
use crate::errors;

/// A labelled Petri net.
#[pyclass(name = "PetriNet", module = "runglight._engine", frozen)]
pub struct PyPetriNet {
    pub net: Arc<PetriNet>,
}

impl PyPetriNet {
    pub fn new(net: PetriNet) -> Self {
        Self { net: Arc::new(net) }
    }
}

type Row = (String, Option<String>, Option<&'static str>, Vec<u32>, Vec<u32>);

#[pymethods]
impl PyPetriNet {
    #[staticmethod]
    fn read_pnml(py: Python<'_>, path: &str) -> PyResult<Self> {
        let read = py.detach(|| runglight_formats::pnml::read(Path::new(path)));
        Ok(Self::new(read.map_err(errors::input)?))
    }

    fn write_pnml(&self, py: Python<'_>, path: &str) -> PyResult<()> {
        py.detach(|| runglight_formats::pnml::write(&self.net, Path::new(path)))
            .map_err(errors::input)
    }

    #[getter]
    fn name(&self) -> String {
        self.net.name.clone()
    }

    #[getter]
    fn places(&self) -> Vec<String> {
        self.net.places.clone()
    }

    #[getter]
    fn initial(&self) -> Vec<u32> {
        self.net.initial.clone()
    }

    #[getter]
    fn last(&self) -> Vec<u32> {
        self.net.last.clone()
    }

    fn transitions(&self) -> Vec<Row> {
        let rows = self.net.transitions.iter().map(|t| {
            let class = class_name(t.class);
            (t.id.clone(), t.label.clone(), class, t.inputs.clone(), t.outputs.clone())
        });
        rows.collect()
    }
}
