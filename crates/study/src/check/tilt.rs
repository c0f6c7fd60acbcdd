//! The face of a patch, tilted until its elements stand at the separations of all the pressures of the table.

use asperity::element::{FrictionTable, Node, Quantity};
use asperity::patch::{Patch, PatchElement, Pose};

use super::measure::selected;

/// The largest angle of a face, rad: of one that is small beside the separations, elements stand at some of them.
const STEEPEST: f64 = 0.5;
/// Halvings of an interval of angles.
const HALVINGS: u32 = 60;
/// Share of the separations by which an element may be outside: rounding.
const SLACK: f64 = 1e-6;

/// An element of a tilted face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TiltedElement {
    pub(super) element: PatchElement,
    /// From the pose's point in the ground's axes, m.
    pub(super) arm: [f64; 3],
    /// The separation of the face and the ground there, m.
    pub(super) separation: f64,
}

/// A tilted face at a speed of the table.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TiltedFace {
    /// The speed, m/s.
    pub(super) speed: f64,
    pub(super) pose: Pose,
    /// Elements at even quantiles of the separation.
    pub(super) tilted_elements: Vec<TiltedElement>,
}

impl TiltedFace {
    /// The face of `patch` over the pressures that its table has at speed number `speed`, with `count` elements or
    /// fewer.
    pub(super) fn new(patch: &Patch, speed: usize, count: usize) -> Self {
        let table = patch.table();
        let separations = separations(table, speed, patch.temperature());
        let elements: Vec<PatchElement> = patch.elements().filter(|element| element.area > 0.0).collect();
        let places: Vec<[f64; 3]> = elements.iter().map(|element| element.place).collect();
        let pose = pose(&places, separations);
        let arms = pose.arms(places);
        let tilted = |(element, arm): (PatchElement, [f64; 3])| TiltedElement {
            element,
            arm,
            separation: pose.place[2] + arm[2],
        };
        let [closest, farthest] = separations;
        let slack = SLACK * (farthest - closest);
        let mut tilted_elements: Vec<TiltedElement> = elements.into_iter().zip(arms).map(tilted).collect();
        tilted_elements.retain(|tilted| (closest - slack..=farthest + slack).contains(&tilted.separation));
        tilted_elements.sort_by(|a, b| a.separation.total_cmp(&b.separation));
        Self { speed: table.grid.speeds[speed], pose, tilted_elements: selected(&tilted_elements, count) }
    }

    /// The longest arm of its elements, m.
    pub(super) fn lever(&self) -> f64 {
        let length = |[x, y, z]: [f64; 3]| x.hypot(y).hypot(z);
        self.tilted_elements.iter().map(|tilted| length(tilted.arm)).fold(0.0, f64::max)
    }
}

/// The separations (m) of the largest and of the least pressure at a speed, at the temperature of the table next to
/// `kelvin`.
fn separations(table: &FrictionTable, speed: usize, kelvin: f64) -> [f64; 2] {
    let off = |&i: &usize| (table.grid.temperatures[i] - kelvin).abs();
    let all = 0..table.grid.temperatures.len();
    let temperature = all.min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0);
    [table.grid.loads.len() - 1, 0].map(|load| table.value(Quantity::Separation, Node { temperature, load, speed }))
}

/// The pose in which `places` of the face (m) stand from `closest` to `farthest` (m) above the ground, or farther where
/// the face is not flat. It leans to the side too, so that elements beside each other differ.
fn pose(places: &[[f64; 3]], [closest, farthest]: [f64; 2]) -> Pose {
    let [along, across] = [0, 1].map(|axis| spread(places, axis));
    let wanted = farthest - closest;
    let share = if along > 0.0 { 0.5 } else { 1.0 };
    let roll = if across > 0.0 { (share * wanted / across).min(STEEPEST.sin()).asin() } else { 0.0 };
    let leaning = |pitch: f64| Pose { place: [0.0; 3], angles: [roll, pitch, 0.0] };
    let heights = |pitch: f64| leaning(pitch).arms(places.iter().copied());
    let reaches = |pitch: f64| spread(&heights(pitch), 2) >= wanted;
    let pitch = if along == 0.0 || reaches(0.0) { 0.0 } else { first(STEEPEST, reaches) };
    let lowest = heights(pitch).iter().map(|place| place[2]).fold(f64::INFINITY, f64::min);
    Pose { place: [0.0, 0.0, closest - lowest], ..leaning(pitch) }
}

/// The first angle up to `high` from which `reaches` holds; `high` where there is none.
fn first(mut high: f64, reaches: impl Fn(f64) -> bool) -> f64 {
    let mut low = 0.0;
    for _ in 0..HALVINGS {
        let middle = f64::midpoint(low, high);
        if reaches(middle) { high = middle } else { low = middle }
    }
    high
}

/// From the least to the largest of the coordinates on an axis, m.
fn spread(places: &[[f64; 3]], axis: usize) -> f64 {
    let values = || places.iter().map(|place| place[axis]);
    values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(nx: usize, ny: usize) -> Vec<[f64; 3]> {
        let at = |i: usize, count: usize| (i as f64 + 0.5) / count as f64 - 0.5;
        (0..nx * ny).map(|i| [0.02 * at(i / ny, nx), 0.01 * at(i % ny, ny), 0.0]).collect()
    }

    /// From the closest to the farthest separation, whichever way the face extends.
    #[test]
    fn a_flat_face_covers_the_separations() {
        for (nx, ny) in [(10, 6), (10, 1), (1, 6)] {
            let places = grid(nx, ny);
            let pose = pose(&places, [2e-5, 8e-5]);
            let heights: Vec<f64> = pose.arms(places).iter().map(|arm| pose.place[2] + arm[2]).collect();
            let (low, high) = heights.iter().fold((1.0, 0.0), |(low, high), z| (f64::min(low, *z), f64::max(high, *z)));
            // Bisected, and one cosine in the arm of the other angle.
            assert!((low - 2e-5).abs() < 1e-12 && (high - 8e-5).abs() < 1e-9, "{nx} {ny}: {low} {high}");
        }
    }

    #[test]
    fn a_single_element_stands_closest_and_a_cylinder_keeps_level() {
        let single = pose(&[[0.0, 0.0, -0.3]], [2e-5, 8e-5]);
        assert_eq!(single, Pose { place: [0.0, 0.0, 2e-5 + 0.3], angles: [0.0; 3] });
        let arc: Vec<[f64; 3]> =
            (-5..=5).map(|i| 0.01 * f64::from(i)).map(|a| [0.3 * a.sin(), 0.0, -0.3 * a.cos()]).collect();
        let level = pose(&arc, [2e-5, 8e-5]);
        assert_eq!(level.angles, [0.0; 3]);
        // The lowest point of the arc.
        assert!((level.place[2] - 0.3 - 2e-5).abs() < 1e-15, "{level:?}");
    }
}
