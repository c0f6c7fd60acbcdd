//! A run of a scene along its excitation.

use std::ops::ControlFlow;
use std::sync::Arc;

use asperity::outputs::{OutputType, Variable, variables};
use asperity::scene::{Scene as SceneData, Unit};
use asperity::simulation::SimulationError;
use asperity_study::masses::{ElementField, ElementHistory};
use asperity_study::run_figures::{RunFigures, implausible_run};
use asperity_study::runner::{InputSample, Rows, RunOptions, Runner};
use numpy::{IntoPyArray as _, PyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::background::{Task, in_background};
use crate::elements::recorded;
use crate::errors::Raise as _;
use crate::options::Options;
use crate::scene::Scene;

/// A column of a result.
pub(crate) struct Column {
    name: String,
    unit: String,
    kind: OutputType,
    values: Vec<f64>,
}

impl Column {
    pub(crate) fn of(variable: &Variable) -> Self {
        Self::new(&variable.name, variable.unit, variable.kind)
    }

    /// Of all masses, row by row.
    fn of_masses(field: ElementField) -> Self {
        Self { values: field.values, ..Self::new(&field.name, field.unit, field.kind) }
    }

    fn new(name: &str, unit: Unit, kind: OutputType) -> Self {
        Self { name: name.to_owned(), unit: unit.name().to_owned(), kind, values: Vec::new() }
    }

    /// The values as an array, which takes them over.
    fn array(self, py: Python<'_>) -> Bound<'_, PyAny> {
        match self.kind {
            OutputType::Real => self.values.into_pyarray(py).into_any(),
            OutputType::Integer => {
                PyArray1::from_iter(py, self.values.into_iter().map(|value| value as i64)).into_any()
            }
        }
    }
}

/// Arrays and units by the columns' names.
pub(crate) fn arrays<'py>(py: Python<'py>, columns: Vec<Column>) -> PyResult<Arrays<'py>> {
    let (arrays, units) = (PyDict::new(py), PyDict::new(py));
    for column in columns {
        units.set_item(&column.name, &column.unit)?;
        arrays.set_item(column.name.clone(), column.array(py))?;
    }
    Ok((arrays, units))
}

/// What a run leaves.
struct Recorded {
    columns: Vec<Column>,
    /// Of the masses, row by row.
    elements: Vec<Column>,
    /// What each row says of the layer as a whole, where the masses are kept.
    instants: Vec<f64>,
    warnings: Vec<String>,
}

fn run(scene: &SceneData, options: RunOptions, elements: bool, task: &Task) -> Result<Recorded, SimulationError> {
    let (inputs, variables) = (scene.inputs(), variables(scene));
    let time = Column { name: "time".into(), unit: "s".into(), kind: OutputType::Real, values: Vec::new() };
    let of_input = inputs.iter().map(|input| Column::new(input.name(), input.unit(), OutputType::Real));
    let mut columns: Vec<Column> =
        std::iter::once(time).chain(of_input).chain(variables.iter().map(Column::of)).collect();
    let mut elements = elements.then(|| ElementHistory::new(scene));
    let mut values = vec![0.0; variables.len()];
    let duration = scene.duration();
    let mut figures = RunFigures::default();

    let runner = Runner::new(scene, Rows::PerPhase(options.rows), 0.0)?;
    let mut runner = runner.with_rows_at(options.times).stopped_by(&task.stop());
    runner.run(&scene.excitation, |carrier: InputSample, snapshot| {
        snapshot.evaluate(&variables, &mut values);
        figures.add(snapshot);
        let row = std::iter::once(carrier.time).chain(inputs.iter().map(|&input| carrier.input(input)));
        columns.iter_mut().zip(row.chain(values.iter().copied())).for_each(|(column, value)| column.values.push(value));
        elements.iter_mut().for_each(|elements| elements.add(carrier.time, snapshot));
        task.report(if duration > 0.0 { carrier.time / duration } else { 1.0 });
        ControlFlow::Continue(())
    })?;
    let mut warnings = runner.take_warnings();
    warnings.extend(runner.simulation().inaccuracy().map(|inaccuracy| inaccuracy.to_string()));
    warnings.extend(implausible_run(scene, &figures, runner.simulation()));
    let (instants, fields) = elements.map(recorded).unwrap_or_default();
    Ok(Recorded { columns, elements: fields.into_iter().map(Column::of_masses).collect(), instants, warnings })
}

/// Arrays and their units.
type Arrays<'py> = (Bound<'py, PyDict>, Bound<'py, PyDict>);

/// The rows, the masses, what each row says of the layer as a whole, and the warnings.
type Found<'py> = (Arrays<'py>, Arrays<'py>, Bound<'py, PyArray1<f64>>, Vec<String>);

/// Runs the scene along its excitation.
#[pyfunction]
pub(crate) fn simulate<'py>(
    py: Python<'py>,
    scene: &Scene,
    options: Options<RunOptions>,
    elements: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<Found<'py>> {
    let options = options.0;
    let scene = Arc::clone(&scene.scene);
    let recorded = in_background(py, progress, move |task| run(&scene, options, elements, task))?;
    let Recorded { columns, elements, instants, warnings } = recorded.map_err(|error| error.raise())?;
    Ok((arrays(py, columns)?, arrays(py, elements)?, instants.into_pyarray(py), warnings))
}
