//! What is found, as Python has it: tables by their columns, pictures as plain data.

use asperity::table::{Cell, Table};
use asperity_study::picture::{self, Mark};
use numpy::{IntoPyArray as _, PyArray1, PyArrayMethods as _};
use pyo3::IntoPyObjectExt as _;
use pyo3::prelude::*;
use pythonize::{depythonize, pythonize};

/// An array of numbers.
pub(crate) type Numbers<'py> = Bound<'py, PyArray1<f64>>;

/// A column: its name, its unit, and an array of its numbers, nan where there is none, or a list of its words.
pub(crate) type FoundColumn<'py> = (String, String, Bound<'py, PyAny>);

/// The columns of a table.
pub(crate) fn columns<'py>(py: Python<'py>, table: &Table) -> PyResult<Vec<FoundColumn<'py>>> {
    let values = |(at, column): (usize, &asperity::table::Column)| {
        let cells = table.cells(at);
        let values = match column.has_words {
            true => cells.map(Cell::text).collect::<Vec<_>>().into_bound_py_any(py)?,
            false => {
                let numbers = cells.map(|cell| cell.number().unwrap_or(f64::NAN));
                numbers.collect::<Vec<_>>().into_pyarray(py).into_any()
            }
        };
        Ok((column.name.clone(), column.unit.clone(), values))
    };
    table.columns().iter().enumerate().map(values).collect()
}

/// A picture, which Python draws.
#[pyclass(frozen, module = "asperity._native")]
#[derive(Debug)]
pub(crate) struct Picture(pub(crate) picture::Picture);

#[pymethods]
impl Picture {
    #[new]
    fn new(data: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self(depythonize(data)?))
    }

    /// Rows of panels with their axes and marks, in lists and dictionaries.
    fn data<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(pythonize(py, &self.0)?)
    }

    /// For pickle and copy.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyAny>,))> {
        Ok((slf.as_any().get_type().into_any(), (slf.get().data(slf.py())?,)))
    }
}

/// A quantity, its unit, and the names and values of its curves.
type Panel<'py> = (String, String, Vec<(String, Numbers<'py>)>);

/// Curves over the values of a quantity in a unit, a panel for each other quantity.
#[pyfunction]
pub(crate) fn curves(title: &str, x: (String, String, Numbers<'_>), panels: Vec<Panel<'_>>) -> PyResult<Picture> {
    let (quantity, unit, x) = x;
    let x = x.to_vec()?;
    let curve = |(look, (name, y)): (usize, &(String, Numbers<'_>))| {
        let points = x.iter().zip(y.to_vec()?).map(|(&x, y)| [x, y]).collect();
        Ok(Mark::line(name, look, points))
    };
    let marks = |(quantity, unit, curves): &Panel<'_>| {
        let marks = curves.iter().enumerate().map(curve).collect::<PyResult<_>>()?;
        Ok((quantity.clone(), unit.clone(), marks))
    };
    let panels: Vec<(String, String, Vec<Mark>)> = panels.iter().map(marks).collect::<PyResult<_>>()?;
    let panels = panels.iter().map(|(quantity, unit, marks)| ((&**quantity, &**unit), marks.clone())).collect();
    Ok(Picture(picture::Picture::over((&quantity, &unit), panels).titled(title)))
}
