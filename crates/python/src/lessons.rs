//! Learning in parts: surveys of rows wherever they lie, a lesson of each group, one model.

use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::types::{Int64Type, TimestampNanosecondType};
use arrow_array::{Array, RecordBatch};
use arrow_schema::{DataType, TimeUnit};
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use pyo3_arrow::PyRecordBatch;

use runglight_engine::log::{Gap, Nanoseconds};
use runglight_engine::signal_state::learn::context::Context;
use runglight_engine::signal_state::learn::lesson::{Learner, Lesson};
use runglight_engine::signal_state::learn::merge::merge;
use runglight_engine::signal_state::learn::survey::{NO_PLACE, Survey};
use runglight_engine::signal_state::parameters::Parameters;
use runglight_engine::symbols::SymbolTable;
use runglight_formats::model_directory::Provenance;

use crate::errors;
use crate::model::{PyNominalModel, now_text};

/// What learning must know of a whole log; those of its pieces merge.
#[pyclass(name = "LogSurvey", module = "runglight._engine")]
pub struct PyLogSurvey {
    survey: Survey,
}

#[pymethods]
impl PyLogSurvey {
    #[new]
    #[pyo3(signature = (gaps = Vec::new()))]
    fn new(gaps: Vec<(Nanoseconds, Nanoseconds)>) -> Self {
        let gaps = gaps.into_iter().map(|(start, end)| Gap { start, end }).collect();
        Self { survey: Survey::new(gaps) }
    }

    fn add(&mut self, py: Python<'_>, batch: PyRecordBatch) -> PyResult<()> {
        let batch = batch.into_inner();
        py.detach(|| add(&mut self.survey, &batch)).map_err(errors::input)
    }

    fn merge(&mut self, state: &[u8]) -> PyResult<()> {
        let other = Survey::restore(state).map_err(errors::input)?;
        self.survey.merge(other).map_err(errors::input)
    }

    fn state(&self) -> Vec<u8> {
        self.survey.save()
    }

    fn __len__(&self) -> usize {
        self.survey.rows() as usize
    }
}

fn add(survey: &mut Survey, batch: &RecordBatch) -> Result<(), String> {
    let column = |name: &str| {
        let column = batch.column_by_name(name);
        let column = column.ok_or_else(|| format!("a batch to survey has no column '{name}'"))?;
        match column.null_count() {
            0 => Ok(column),
            nulls => Err(format!("column '{name}' has no value in {nulls} rows of a batch")),
        }
    };
    let whole = |name: &str| {
        let column = column(name)?.as_primitive_opt::<Int64Type>();
        column.map(|c| c.values()).ok_or_else(|| format!("column '{name}' must be int64"))
    };
    let time = match column("time")?.data_type() {
        DataType::Timestamp(TimeUnit::Nanosecond, _) => {
            column("time")?.as_primitive::<TimestampNanosecondType>().values()
        }
        _ => whole("time")?,
    };
    let names = column("signal")?.as_string_opt::<i32>();
    let names = names.ok_or_else(|| "column 'signal' must be text".to_owned())?;
    let values = whole("value")?;
    let places = match batch.column_by_name("place") {
        Some(_) => Some(whole("place")?),
        None => None,
    };
    let place = |row: usize| places.map_or(NO_PLACE, |places| places[row]);
    let rows = 0..batch.num_rows();
    survey.add(rows.map(|row| (time[row], names.value(row), values[row], place(row))));
    Ok(())
}

/// What learning a group by itself must know of the plant and of the log.
#[pyclass(name = "LearningContext", module = "runglight._engine", frozen)]
pub struct PyLearningContext {
    context: Arc<Context>,
}

#[pymethods]
impl PyLearningContext {
    #[staticmethod]
    #[pyo3(signature = (survey, symbols_csv = None, parameters_json = "{}"))]
    fn of(
        survey: &PyLogSurvey,
        symbols_csv: Option<&str>,
        parameters_json: &str,
    ) -> PyResult<Self> {
        let parameters: Parameters = serde_json::from_str(parameters_json)
            .map_err(|error| errors::input(format!("parameters of learning: {error}")))?;
        let table = symbols_csv.unwrap_or("address\n");
        let table = SymbolTable::parse(table).map_err(errors::input)?;
        let context = Context::of(&survey.survey, &table, &parameters).map_err(errors::input)?;
        Ok(Self { context: Arc::new(context) })
    }

    #[staticmethod]
    fn restore(state: &[u8]) -> PyResult<Self> {
        let context = Context::restore(state).ok_or_else(|| {
            errors::input("the bytes are no learning context of this version; survey the log anew")
        })?;
        Ok(Self { context: Arc::new(context) })
    }

    fn state(&self) -> Vec<u8> {
        self.context.save()
    }

    #[getter]
    fn groups(&self) -> Vec<&str> {
        self.context.groups().collect()
    }

    #[getter]
    fn rows_of_groups(&self) -> Vec<u64> {
        self.context.rows().to_vec()
    }

    #[getter]
    fn signals(&self) -> Vec<(&str, usize)> {
        self.context.signals().collect()
    }

    fn learner(&self) -> PyGroupLearner {
        PyGroupLearner { context: Arc::clone(&self.context), learner: None }
    }

    #[pyo3(signature = (lessons, source = Vec::new()))]
    fn merge(
        &self,
        py: Python<'_>,
        lessons: Vec<Vec<u8>>,
        source: Vec<String>,
    ) -> PyResult<PyNominalModel> {
        let restored = lessons.iter().map(|bytes| Lesson::restore(bytes)).collect::<Option<_>>();
        let lessons = restored.ok_or_else(|| {
            errors::input("a lesson is damaged or of another version; learn anew")
        })?;
        let model = py.detach(|| merge(&self.context, lessons)).map_err(errors::input)?;
        let provenance = Provenance { created: now_text(), source };
        Ok(PyNominalModel::of(model, provenance))
    }
}

/// Learns one group after another, each when its last row has come.
#[pyclass(name = "GroupLearner", module = "runglight._engine")]
pub struct PyGroupLearner {
    context: Arc<Context>,
    learner: Option<Learner>,
}

#[pymethods]
impl PyGroupLearner {
    #[pyo3(signature = (group, time_ns, signal_index, value, place = None))]
    fn add<'py>(
        &mut self,
        py: Python<'py>,
        group: PyReadonlyArray1<'py, i32>,
        time_ns: PyReadonlyArray1<'py, i64>,
        signal_index: PyReadonlyArray1<'py, i32>,
        value: PyReadonlyArray1<'py, i64>,
        place: Option<PyReadonlyArray1<'py, i64>>,
    ) -> PyResult<Vec<Bound<'py, PyBytes>>> {
        let (group, signal) = (group.as_slice()?, signal_index.as_slice()?);
        let (time, value) = (time_ns.as_slice()?, value.as_slice()?);
        let place = place.as_ref().map(PyReadonlyArray1::as_slice).transpose()?;
        let lengths = [time.len(), signal.len(), value.len()];
        if lengths.iter().chain(&place.map(<[i64]>::len)).any(|&length| length != group.len()) {
            return Err(errors::input("group, time, signal and value are not of one length"));
        }
        let mut lessons = Vec::new();
        let mut start = 0;
        while start < group.len() {
            let of = group[start];
            let end = start + group[start..].iter().take_while(|&&other| other == of).count();
            let number = usize::try_from(of).unwrap_or(usize::MAX);
            if self.learner.as_ref().is_some_and(|learner| learner.group() != number) {
                lessons.extend(self.finish(py));
            }
            let learner = match &mut self.learner {
                Some(learner) => learner,
                none => none.insert(
                    Learner::new(Arc::clone(&self.context), number).map_err(errors::input)?,
                ),
            };
            let rows = (start..end).map(|row| {
                (time[row], signal[row] as u32, value[row], place.map(|place| place[row]))
            });
            py.detach(|| learner.add(rows)).map_err(errors::input)?;
            start = end;
        }
        Ok(lessons)
    }

    fn finish<'py>(&mut self, py: Python<'py>) -> Option<Bound<'py, PyBytes>> {
        let learner = self.learner.take()?;
        let lesson = py.detach(|| learner.learn().save());
        Some(PyBytes::new(py, &lesson))
    }
}

/// The names among these of the columns that hold times, signals and values.
#[pyfunction]
pub fn log_columns(names: Vec<String>) -> Vec<Option<String>> {
    let found = runglight_formats::columns_of_changes(&names);
    found.into_iter().map(|place| place.map(|place| names[place].clone())).collect()
}
