//! What elements and patches are compared with: the scene that a table was swept of, how points are chosen, how well they
//! are known, and how large their errors are.

use asperity::element::{FrictionTable, Load, Node, Quantity};
use asperity::scene::{CarrierBodies, Scene};

use crate::error::Error;
use crate::sweep::separation_at_rest;

/// Difference of two numbers of the same layer, as a share of their size: rounding.
const ROUNDING: f64 = 1e-6;

/// The layer of a `scene`, which must be the one that `table` was swept of.
pub(super) fn swept_scene(table: &FrictionTable, scene: Scene) -> Result<Scene, Error> {
    // The element's w is given: what the table was swept on is held by its displacement here.
    let scene = Scene { carrier: CarrierBodies::default(), ..scene };
    if scene.name != table.scene() {
        let (swept, found) = (table.scene(), scene.name);
        return Err(Error::scene(format!(
            "`check`: the table was swept of {swept:?}, the scene is {found:?}: expected the scene that was swept"
        )));
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
        return Err(other_layer("the temperature", &found, &swept));
    }
    Ok(scene)
}

/// Refuses a scene in which a number differs from the table's by more than rounding, of numbers of some `size`.
fn check_number(what: &'static str, found: f64, swept: f64, size: f64, unit: &str) -> Result<(), Error> {
    if (found - swept).abs() <= ROUNDING * size {
        return Ok(());
    }
    Err(other_layer(what, &format!("{found} {unit}"), &format!("{swept} {unit}")))
}

fn other_layer(what: &str, found: &str, swept: &str) -> Error {
    Error::scene(format!(
        "`check`: {what} is {found} in the scene, {swept} in the table: expected the scene that was swept"
    ))
}

/// Standard error of the layer's friction coefficient, relative to it.
pub(super) const ERROR: f64 = 0.01;
/// Distance over which elements slide, m: far more than they stick.
pub(super) const SLIDING_DISTANCE: f64 = 1.0;

/// `count` of `all`, evenly, or all of them where there are fewer.
pub(super) fn selected<T: Copy>(all: &[T], count: usize) -> Vec<T> {
    let count = count.min(all.len());
    (0..count).map(|i| all[(2 * i + 1) * all.len() / (2 * count)]).collect()
}

/// The largest and the root mean square of relative errors.
pub(super) fn deviation(name: &str, errors: impl ExactSizeIterator<Item = f64>) -> String {
    let (largest, root) = extent(errors);
    format!("{name}: off by at most {:.2} %, in root mean square {:.2} %", 100.0 * largest, 100.0 * root)
}

/// The largest magnitude and the root mean square.
pub(super) fn extent(errors: impl ExactSizeIterator<Item = f64>) -> (f64, f64) {
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
