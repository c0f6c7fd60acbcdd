//! Where the rubber touches in steady sliding.

use std::sync::Arc;

use asperity::element::PointStatus;
use asperity_study::contact::{SolvedContact, SteadyState, solve_contact};
use asperity_study::sweep::SlidingOptions;
use numpy::IntoPyArray as _;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::background::in_background;
use crate::errors::Raise as _;
use crate::scene::Scene;

/// Solves for steady sliding.
#[pyfunction]
pub(crate) fn contact<'py>(
    py: Python<'py>,
    scene: &Scene,
    pressure: f64,
    speed: f64,
    way: Option<f64>,
    points: Option<u32>,
) -> PyResult<Bound<'py, PyDict>> {
    let (scene, at) = (Arc::clone(&scene.scene), SteadyState { pressure, speed });
    let sliding = SlidingOptions { way, points, ..SlidingOptions::default() };
    let solved = in_background(py, None, move |_| solve_contact(&scene, at, sliding))?;
    let SolvedContact { slide, fields, problem, warnings, .. } = solved.map_err(|error| error.raise())?;
    let found = PyDict::new(py);
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
    Ok(found)
}
