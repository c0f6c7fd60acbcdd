//! What elements and patches are compared with: the scene that a table was swept of, how points are chosen, how well they
//! are known, how large their errors are; the wrenches of a dragged face, and the differences of two series of them.

use asperity::element::{FrictionTable, Load, Node, Quantity};
use asperity::scene::{CarrierBodies, Scene};

use crate::decimals::{decimal, rounded};
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

/// What is compared, and its unit; without force.y, which is 0 along x.
pub const COMPONENTS: [(&str, &str); 5] =
    [("force.x", "N"), ("force.z", "N"), ("moment.x", "N m"), ("moment.y", "N m"), ("moment.z", "N m")];
/// Share of force.z and of its longest arm below which a component is nothing but rounding.
const NOTHING: f64 = 1e-9;

/// The values of [`COMPONENTS`].
pub type Wrench = [f64; COMPONENTS.len()];

/// The wrench of forces (N) at their arms (m), and the sums of their magnitudes: moments may cancel.
pub(super) fn wrench(forces: impl IntoIterator<Item = ([f64; 3], [f64; 3])>) -> (Wrench, Wrench) {
    let (mut sum, mut size) = (Wrench::default(), Wrench::default());
    for ([x, y, z], [along, across, up]) in forces {
        let own = [along, up, y * up - z * across, z * along - x * up, x * across - y * along];
        sum.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
        size.iter_mut().zip(own).for_each(|(size, own)| *size += own.abs());
    }
    (sum, size)
}

/// Two series of wrenches, row by row.
#[derive(Clone, Debug, Default)]
pub struct WrenchSeries {
    /// What the other is measured by.
    pub reference: Vec<Wrench>,
    /// What is measured.
    pub other: Vec<Wrench>,
    /// What differences are shares of.
    scale: Wrench,
}

impl WrenchSeries {
    /// Differences are shares of the largest of `sizes`, by component; `lever` is the longest arm, m.
    pub(super) fn new(reference: Vec<Wrench>, other: Vec<Wrench>, sizes: &[Wrench], lever: f64) -> Self {
        let largest = |i: usize| sizes.iter().fold(f64::MIN_POSITIVE, |largest, row| largest.max(row[i].abs()));
        let least = |i: usize| NOTHING * largest(1) * if i < 2 { 1.0 } else { lever };
        Self { reference, other, scale: std::array::from_fn(|i| largest(i).max(least(i))) }
    }

    /// Magnitudes of the differences as shares.
    pub fn shares(&self) -> Vec<Wrench> {
        let share = |(a, b): (&Wrench, &Wrench)| std::array::from_fn(|i| (a[i] - b[i]).abs() / self.scale[i]);
        self.reference.iter().zip(&self.other).map(share).collect()
    }

    /// The largest of them, and their root mean squares.
    pub(super) fn extent(&self) -> (Wrench, Wrench) {
        let shares = self.shares();
        let over = |i: usize| extent(shares.iter().map(|share| share[i]));
        (std::array::from_fn(|i| over(i).0), std::array::from_fn(|i| over(i).1))
    }
}

/// Shares in per cent.
pub(super) fn percentages(shares: Wrench) -> String {
    let one = |((name, _), share): (&(&str, &str), f64)| {
        format!("{name} {} %", decimal(rounded(100.0 * share, 2), 1e-3..1e5))
    };
    COMPONENTS.iter().zip(shares).map(one).collect::<Vec<_>>().join(", ")
}

/// The largest and the root mean square differences along a motion.
pub(super) fn along(motion: &str, pair: &WrenchSeries) -> [String; 2] {
    let (largest, root) = pair.extent();
    [format!("{motion}, at most: {}", percentages(largest)), format!("  in root mean square: {}", percentages(root))]
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

    #[test]
    fn moments_are_those_of_the_arms() {
        let forces = [([0.1, 0.2, -0.3], [-2.0, 0.0, 5.0]), ([0.0, -0.2, 0.0], [0.0, 1.0, 5.0])];
        // x: y F_z - z F_y, y: z F_x - x F_z, z: x F_y - y F_x.
        let expected = [-2.0, 10.0, 0.0, 0.6 - 0.5, 0.4];
        let (sum, size) = wrench(forces);
        assert!(sum.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-15));
        let expected = [2.0, 10.0, 2.0, 0.1, 0.4];
        assert!(size.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-15));
    }

    #[test]
    fn differences_are_shares_of_the_largest_value_and_rounding_is_none() {
        let reference = vec![[1.0, 10.0, 0.0, 4.0, 1e-15], [-2.0, 5.0, 0.0, 2.0, 0.0]];
        let other = vec![[1.1, 10.0, 0.0, 4.0, -1e-15], [-2.0, 4.0, 0.0, 3.0, 0.0]];
        let shares = WrenchSeries::new(reference.clone(), other, &reference, 0.1).shares();
        let expected = [[0.05, 0.0, 0.0, 0.0, 2e-6], [0.0, 0.1, 0.0, 0.25, 0.0]];
        for (found, expected) in shares.iter().flatten().zip(expected.iter().flatten()) {
            assert!((found - expected).abs() < 1e-12, "{shares:?}");
        }
    }
}
