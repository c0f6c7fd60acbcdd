//! `asperity pack --check SCENE.toml`: an element or a patch against what was swept, in steady sliding and along a motion
//! to and fro.

mod drag;
mod element;
mod patch;

use std::fs;
use std::path::{Path, PathBuf};

use asperity::element::{Load, Node, Quantity, Table};
use asperity::patch::MotionError;
use asperity::scene::{CarrierBodies, ParameterError, Scene};

use crate::files::{self, FileError};
use asperity_study::sweep::{SweepError, separation_at_rest};

pub(super) use element::check as check_element;
pub(super) use patch::check as check_patch;

/// Standard error of the layer's friction coefficient, relative to it.
const ERROR: f64 = 0.01;
/// Distance over which elements slide, m: far more than they stick.
const SLIDING_DISTANCE: f64 = 1.0;
/// Difference of two numbers of the same layer, as a share of their size: rounding.
const ROUNDING: f64 = 1e-6;

/// An element or a patch cannot be compared with its layer.
#[derive(Debug, thiserror::Error)]
pub(crate) enum CheckError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("--check: {0}")]
    Swept(#[from] SweepError),
    #[error("--check: the table was swept of {table:?}, the scene is {scene:?}: expected the scene that was swept")]
    OtherScene { table: String, scene: String },
    #[error("--check: {what} is {found} in the scene, {swept} in the table: expected the scene that was swept")]
    OtherLayer { what: &'static str, found: String, swept: String },
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    #[error(
        "--check: no element of the tilted face stands at a separation of the table: its places are too large to tell them"
    )]
    NoElements,
    #[error("--check: the patch cannot be dragged: {0}")]
    Motion(#[from] MotionError),
}

/// The scene at `path`, which must be the one that `table` was swept of.
fn scene_of(table: &Table, path: &Path) -> Result<Scene, CheckError> {
    // The element's w is given: what the table was swept on is held by its displacement here.
    let scene = Scene { carrier: CarrierBodies::default(), ..files::load_without_run(path, &[], |_| true)? };
    if scene.name != table.scene {
        return Err(CheckError::OtherScene { table: table.scene.clone(), scene: scene.name });
    }
    let [most, least] = [0, table.grid.loads.len() - 1].map(|load| Node { load, ..Node::default() });
    let range = table.value(Quantity::Separation, most) - table.value(Quantity::Separation, least);
    check_number("the separation at w = 0", separation_at_rest(&scene), table.rest_separation, range, "m")?;
    if let (Load::Pressure { area }, Some(found)) = (table.load, scene.layer.area()) {
        check_number("the area of the layer", found, area, area, "m²")?;
    }
    let has_temperature = scene.material.as_ref().is_some_and(|material| material.wlf.is_some());
    if has_temperature == table.grid.temperatures.is_empty() {
        let word = |has: bool| if has { "given" } else { "none" }.to_owned();
        let (found, swept) = (word(has_temperature), word(!has_temperature));
        return Err(CheckError::OtherLayer { what: "the temperature", found, swept });
    }
    Ok(scene)
}

/// Refuses a scene in which a number differs from the table's by more than rounding, of numbers of some `size`.
fn check_number(what: &'static str, found: f64, swept: f64, size: f64, unit: &str) -> Result<(), CheckError> {
    if (found - swept).abs() <= ROUNDING * size {
        return Ok(());
    }
    Err(CheckError::OtherLayer { what, found: format!("{found} {unit}"), swept: format!("{swept} {unit}") })
}

fn folder_beside(output: &Path) -> Result<PathBuf, FileError> {
    let stem = output.file_stem().map_or_else(|| "element".into(), |stem| stem.to_string_lossy());
    let path = output.with_file_name(format!("{stem}-check"));
    fs::create_dir_all(&path).map_err(FileError::io("create", &path))?;
    Ok(path)
}

/// `count` of `all`, evenly, or all of them where there are fewer.
fn selected<T: Copy>(all: &[T], count: usize) -> Vec<T> {
    let count = count.min(all.len());
    (0..count).map(|i| all[(2 * i + 1) * all.len() / (2 * count)]).collect()
}

/// The largest and the root mean square of relative errors.
fn deviation(name: &str, errors: impl ExactSizeIterator<Item = f64>) -> String {
    let (largest, root) = extent(errors);
    format!("{name}: off by at most {:.2} %, in root mean square {:.2} %", 100.0 * largest, 100.0 * root)
}

/// The largest magnitude and the root mean square.
fn extent(errors: impl ExactSizeIterator<Item = f64>) -> (f64, f64) {
    let count = errors.len() as f64;
    let (largest, squares) =
        errors.fold((0.0_f64, 0.0), |(largest, sum), error| (largest.max(error.abs()), sum + error * error));
    (largest, (squares / count).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_selected_evenly_and_each_once() {
        let points: Vec<u32> = (0..10).collect();
        assert_eq!(selected(&points, 2), [2, 7]);
        assert_eq!(selected(&points, 99), points);
    }
}
