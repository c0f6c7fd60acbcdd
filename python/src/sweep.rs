//! Friction over speed, load and temperature.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use asperity::element::{FrictionTable, PointContact};
use asperity_study::Error;
use asperity_study::calibration::uncertain_scene;
use asperity_study::comparison::CompareOptions;
use asperity_study::friction_map::Maps;
use asperity_study::pack::FmuOptions;
use asperity_study::sweep::{
    Over, SampleHeader, Sampled, SweepColumn, SweepOptions, SweepPlan, SweepTable, column_picture, quantile_table,
    sweep_picture,
};
use asperity_study::uncertainty::SampleOptions;
use numpy::{IntoPyArray as _, ToPyArray as _};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::background::{Task, in_background};
use crate::compare::compare;
use crate::errors::Raise as _;
use crate::found::{FoundColumn, Numbers, Picture, columns};
use crate::options::Options;
use crate::pack::pack;
use crate::scene::Scene;

/// All points of a sweep; `None` where nobody waits for them any more.
fn find(plan: &SweepPlan, task: &Task) -> Option<SweepTable> {
    let (points, done) = (plan.header().grid.count(), AtomicUsize::new(0));
    let table = plan.table(&task.stop(), || {
        task.report((1 + done.fetch_add(1, Ordering::Relaxed)) as f64 / points as f64);
    });
    (!task.is_stopped()).then_some(table)
}

/// A sweep of a scene, with samples - how many, by which seed, and whether a covariance's numbers are fitted anew in each - or
/// without.
fn plan(
    scene: asperity::scene::Scene,
    options: &SweepOptions,
    samples: Option<(usize, u64, bool)>,
    task: &Task,
) -> Result<SweepPlan, Error> {
    match samples {
        Some((count, seed, refit)) => {
            let uncertain = uncertain_scene(scene, refit, &task.stop())?;
            SweepPlan::with_samples(&uncertain, options, None, SampleOptions { count, seed })
        }
        None => SweepPlan::new(scene, options, None),
    }
}

/// The table of a sweep, and what is said of it.
#[pyfunction]
pub(crate) fn sweep(
    py: Python<'_>,
    scene: &Scene,
    options: Options<SweepOptions>,
    samples: Option<(usize, u64, bool)>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Table, Vec<String>)> {
    let options = options.0;
    let scene = Arc::clone(&scene.scene);
    let found = in_background(py, progress, move |task| {
        let plan = plan((*scene).clone(), &options, samples, task)?;
        Ok(find(&plan, task).map(|swept| {
            let found = plan.warnings(&swept.rows);
            let warnings = plan.first_warnings().iter().cloned().chain(found).collect();
            let matters = plan.matters(&swept.rows).map(|matters| matters.table(swept.header.load));
            (Table { swept, matters, drawn: plan.drawn() }, warnings)
        }))
    })?;
    let found = found.map_err(|error: Error| error.raise())?;
    // It is only stopped where nobody waits.
    found.ok_or_else(|| PyValueError::new_err("stopped"))
}

/// The table of a sweep; of one with samples what matters, if that was found, and what was drawn by names.
#[pyclass(frozen, module = "asperity._native")]
#[derive(Debug)]
pub(crate) struct Table {
    swept: SweepTable,
    matters: Option<asperity::table::Table>,
    drawn: Vec<(String, Vec<f64>)>,
}

/// Numbers by names.
type Named<'py> = Vec<(String, Numbers<'py>)>;

impl Table {
    /// Another column than friction.
    fn other(&self, name: &str) -> Option<SweepColumn> {
        self.swept.header.column(name).filter(|_| name != "friction")
    }
}

#[pymethods]
impl Table {
    #[new]
    fn new(text: &str, matters: &str, drawn: Vec<(String, Vec<f64>)>) -> PyResult<Self> {
        let file = Path::new("table");
        let matters = (!matters.is_empty()).then(|| asperity::table::Table::parse(matters, file)).transpose();
        // What is cut off within a line is so in files alone.
        let (swept, matters) = SweepTable::parse(&format!("{}\n", text.trim_end()), file)
            .and_then(|swept| Ok((swept, matters?)))
            .map_err(|error| error.raise())?;
        Ok(Self { swept, matters, drawn })
    }

    /// The table in a file.
    #[staticmethod]
    fn read(path: PathBuf) -> PyResult<Self> {
        let swept = SweepTable::read(&path).map_err(|error| error.raise())?;
        Ok(Self { swept, matters: None, drawn: Vec::new() })
    }

    #[getter]
    fn text(&self) -> String {
        self.swept.text()
    }

    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Vec<FoundColumn<'py>>> {
        columns(py, &self.swept.table())
    }

    /// What of the samples is kept, all of each row beside each other.
    fn samples<'py>(&self, py: Python<'py>) -> Named<'py> {
        let kept = self.swept.header.samples.map_or(&[][..], SampleHeader::sampled);
        let values = |sampled: &Sampled| {
            let all = self.swept.rows.iter().filter_map(|row| row.samples.as_ref());
            let values = all.flat_map(|samples| samples.of(*sampled)).map(|value| value.unwrap_or(f64::NAN));
            (sampled.name().to_owned(), values.collect::<Vec<_>>().into_pyarray(py))
        };
        kept.iter().map(values).collect()
    }

    /// What was drawn.
    fn drawn<'py>(&self, py: Python<'py>) -> Named<'py> {
        self.drawn.iter().map(|(name, values)| (name.clone(), values.to_pyarray(py))).collect()
    }

    /// The columns of what matters.
    fn matters<'py>(&self, py: Python<'py>) -> PyResult<Option<Vec<FoundColumn<'py>>>> {
        self.matters.as_ref().map(|matters| columns(py, matters)).transpose()
    }

    /// The table of the sample at a quantile.
    fn quantile(&self, py: Python<'_>, scene: &Scene, probability: f64, progress: Option<Py<PyAny>>) -> PyResult<Self> {
        let (scene, table) = (Arc::clone(&scene.scene), self.swept.clone());
        let found = in_background(py, progress, move |task| {
            let uncertain = uncertain_scene((*scene).clone(), table.header.is_refitted(), &task.stop())?;
            quantile_table(&uncertain, &table, probability, &task.stop())
        })?;
        found.map(|swept| Self { swept, matters: None, drawn: Vec::new() }).map_err(|error| error.raise())
    }

    /// The picture of a column over the speed.
    fn picture(&self, column: &str) -> Picture {
        let other = self.other(column).map(|column| column_picture(&self.swept, &column));
        Picture(other.unwrap_or_else(|| sweep_picture(&self.swept)))
    }

    /// The maps of a column over two quantities.
    fn map(&self, x: &str, y: &str, column: &str) -> PyResult<Picture> {
        let over = Over::parse(&format!("{x},{y}")).map_err(PyValueError::new_err)?;
        let maps = Maps::new(over, &self.swept.header, Path::new("table"), None).map_err(|error| error.raise())?;
        Ok(Picture(maps.of_column(self.other(column)).picture(&self.swept).0))
    }

    /// What a measurement and the table are, and their picture.
    fn compare<'py>(&self, py: Python<'py>, options: Options<CompareOptions>) -> PyResult<Bound<'py, PyDict>> {
        compare(py, &self.swept, &options.0)
    }

    /// For pickle and copy.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> (Bound<'py, PyAny>, Written) {
        let table = slf.get();
        let matters = table.matters.as_ref().map(asperity::table::Table::text).unwrap_or_default();
        (slf.as_any().get_type().into_any(), (table.text(), matters, table.drawn.clone()))
    }
}

/// What a table is made of anew.
type Written = (String, String, Vec<(String, Vec<f64>)>);

/// Packs the table of a sweep as an FMU, a point-contact element.
#[pyfunction]
pub(crate) fn pack_table(
    table: PathBuf,
    output: PathBuf,
    libraries: Vec<OsString>,
    options: Options<FmuOptions>,
) -> PyResult<Vec<String>> {
    let read = FrictionTable::load(&table).map_err(|error| PyValueError::new_err(error.to_string()))?;
    pack(&PointContact::new(read).into(), &table, &libraries, (&output, options))
}
