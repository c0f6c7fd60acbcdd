//! Where the rubber touches in steady sliding.

use std::sync::Arc;

use asperity::element::PointStatus;
use asperity_study::contact::{ContactOptions, SolvedContact, solve_contact};
use numpy::IntoPyArray as _;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::background::in_background;
use crate::errors::Raise as _;
use crate::found::Picture;
use crate::options::Options;
use crate::scene::Scene;

/// Solves for steady sliding.
#[pyfunction]
pub(crate) fn contact<'py>(
    py: Python<'py>,
    scene: &Scene,
    options: Options<ContactOptions>,
) -> PyResult<Bound<'py, PyDict>> {
    let options = options.0;
    let scene = Arc::clone(&scene.scene);
    let solved = in_background(py, None, move |_| solve_contact(&scene, options))?;
    let solved = solved.map_err(|error| error.raise())?;
    let picture = Picture(solved.picture()).into_pyobject(py)?;
    let SolvedContact { slide, fields, flow, problem, warnings, .. } = solved;
    let found = PyDict::new(py);
    found.set_item("picture", picture)?;
    let (friction, separation) = (slide.friction(), slide.contact.separation);
    for (name, value) in [
        ("friction", friction),
        ("friction_profile", slide.is_found().then_some(slide.profile_hysteresis)),
        ("friction_fine", slide.fine_hysteresis),
        ("friction_adhesion", slide.adhesion),
        ("area", Some(slide.area)),
        ("area_real", slide.real_area),
        ("separation", Some(separation)),
        ("flash_mean", slide.flash_mean),
        ("surface_rise", slide.surface_rise),
        ("leak_gap", flow.map(|flow| flow.leak)),
        ("drag_gap", flow.map(|flow| flow.drag)),
        ("leak_gap_across", flow.and_then(|flow| flow.leak_across)),
    ] {
        found.set_item(name, value)?;
    }
    found.set_item("status", PointStatus::new(problem).text())?;
    found.set_item("warnings", warnings)?;
    for (name, values) in [
        ("x", fields.x),
        ("y", fields.y),
        ("height", fields.heights),
        ("pressure", fields.pressures),
        ("gap", fields.gaps),
    ] {
        found.set_item(name, values.into_pyarray(py))?;
    }
    found.set_item("leak", fields.leak.map(|leak| leak.into_pyarray(py)))?;
    Ok(found)
}
