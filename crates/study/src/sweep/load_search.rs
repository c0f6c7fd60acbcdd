//! The displacement w of the carrier at which the layer bears a load: a first estimate and a search over runs.
//!
//! The estimate is that of a Winkler foundation: the vertical springs alone over all positions of the profile.
//!
//! A run at w bears F_z, of which the Maxwell elements' share is B; in steady motion B is 0. Near the load the two are
//! related by
//!
//!   F_z = a - s w + κ B
//!
//! with s the layer's stiffness in steady motion. κ is the part of B that F_z loses as the dashpots come to rest: 1
//! where all masses stay in contact, less where they come and go. Three runs would give the three numbers; so that two
//! do, and scatter does no harm, they are those of least squares over all runs and over what is known beforehand. The
//! load is met at B = 0.

use asperity::model::{LinkKind, Model};
use asperity::scene::Scene;
use nalgebra::{Matrix3, Vector3};

/// Halvings of the interval in which w lies.
const HALVINGS: usize = 60;
/// What is known of s, over the stiffness of the vertical springs alone, and of κ, each with its uncertainty.
const STIFFNESS: Known = Known { value: 1.0, error: 0.7 };
const KAPPA: Known = Known { value: 0.95, error: 0.1 };
/// Error of F_z of a run, as a share of the load: its scatter, and what the law's curvature makes of the distances from
/// the load and from rest.
const SCATTER: f64 = 2e-4;
const CURVATURE: f64 = 0.1;
/// s is at least this share of what it is estimated to be.
const LEAST: f64 = 0.2;

/// A value with its uncertainty.
struct Known {
    value: f64,
    error: f64,
}

/// The search for the w at which F_z is a load.
#[derive(Clone, Copy, Debug)]
pub(super) struct LoadSearch {
    /// F_z, N.
    pub(super) target: f64,
    /// Present w, m.
    pub(super) w: f64,
    /// w of the first run, m.
    first: f64,
    /// Change of w for a change of F_z by the load, m.
    unit: f64,
    /// Normal equations of least squares for a, s and κ in units of the load.
    matrix: Matrix3<f64>,
    right: Vector3<f64>,
}

impl LoadSearch {
    /// From the estimate of a Winkler foundation.
    pub(super) fn estimated(load: f64, scene: &Scene, model: &Model) -> Self {
        let foundation = WinklerFoundation::new(model, &heights(scene, model));
        let w = foundation.displacement(load);
        Self::new(load, w, foundation.stiffness(w))
    }

    /// From `w` (m), where F_z grows by about `stiffness` (N/m) as w falls.
    fn new(load: f64, w: f64, stiffness: f64) -> Self {
        let mut search = Self {
            target: load,
            w,
            first: w,
            unit: load / stiffness,
            matrix: Matrix3::zeros(),
            right: Vector3::zeros(),
        };
        search.add(Vector3::new(0.0, 1.0, 0.0), STIFFNESS);
        search.add(Vector3::new(0.0, 0.0, 1.0), KAPPA);
        search
    }

    /// Adds the equation row · (a, s, κ) = value.
    fn add(&mut self, row: Vector3<f64>, Known { value, error }: Known) {
        let weight = 1.0 / (error * error);
        self.matrix += weight * row * row.transpose();
        self.right += weight * value * row;
    }

    /// Moves w after a run in which F_z was `force`, of which the Maxwell elements bore `maxwell` (N). Returns the
    /// change of w, m.
    pub(super) fn change(&mut self, force: f64, maxwell: f64) -> f64 {
        let (x, force, maxwell) = ((self.w - self.first) / self.unit, force / self.target, maxwell / self.target);
        let error = SCATTER + CURVATURE * ((force - 1.0).abs() + maxwell.abs());
        self.add(Vector3::new(1.0, -x, maxwell), Known { value: force, error });
        let Some(law) = self.matrix.cholesky().map(|matrix| matrix.solve(&self.right)) else { return 0.0 };
        let next = self.first + self.unit * (law[0] - 1.0) / law[1].max(LEAST);
        let change = next - self.w;
        self.w = next;
        change
    }
}

/// A Winkler foundation, independent vertical springs, over the profile: every mass at every position.
#[derive(Clone, Debug)]
struct WinklerFoundation {
    /// z_r of evenly spaced positions less Z_i, m: the compression of each spring at w = 0.
    compressions: Vec<f64>,
    /// Stiffness of all springs together, N/m.
    stiffness: f64,
}

impl WinklerFoundation {
    /// The long-term vertical springs of the layer.
    fn new(model: &Model, heights: &[f64]) -> Self {
        let stiffness = model.links[LinkKind::Vertical].stiffness;
        let stiffness = if stiffness > 0.0 { stiffness } else { model.mass_stiffness() };
        let mut rest = model.rest_z.clone();
        rest.sort_by(f64::total_cmp);
        rest.dedup();
        // Of a roughness with many heights, a sample.
        let every = rest.len().div_ceil(16);
        let rest = rest.iter().step_by(every);
        let compressions = rest.flat_map(|z| heights.iter().map(move |height| height - z)).collect();
        Self { compressions, stiffness: stiffness * model.masses() as f64 }
    }

    /// The compressions of the springs in contact at w, m.
    fn compressed(&self, w: f64) -> impl Iterator<Item = f64> {
        self.compressions.iter().map(move |compression| compression - w).filter(|compression| *compression > 0.0)
    }

    /// F_z at w, N.
    fn force(&self, w: f64) -> f64 {
        self.stiffness / self.compressions.len() as f64 * self.compressed(w).fold(0.0, |sum, one| sum + one)
    }

    /// By how much F_z grows as w falls, N/m.
    fn stiffness(&self, w: f64) -> f64 {
        self.stiffness / self.compressions.len() as f64 * self.compressed(w).count() as f64
    }

    /// w at which F_z is `load` (N), m.
    fn displacement(&self, load: f64) -> f64 {
        let mut high = self.compressions.iter().copied().fold(f64::MIN, f64::max);
        let mut low = self.compressions.iter().copied().fold(f64::MAX, f64::min).min(high) - load / self.stiffness;
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(low, high);
            if self.force(middle) > load { low = middle } else { high = middle }
        }
        low
    }
}

/// Heights of the profile at evenly spaced positions over the whole of it, m.
fn heights(scene: &Scene, model: &Model) -> Vec<f64> {
    let (first, last) = ends(scene);
    let count = 4 * scene.surface.x().len();
    let position = |i: usize| first + (last - first) * (i as f64 + 0.5) / count as f64;
    (0..count).map(|i| model.surface_at(position(i)).height).collect()
}

/// Separation of the carrier's rest line and the profile's mean line at w = 0, m.
pub fn separation_at_rest(scene: &Scene) -> f64 {
    let model = Model::new(scene);
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    mean(&model.rest_z) - mean(&heights(scene, &model))
}

/// First and last position of the profile, m.
pub(super) fn ends(scene: &Scene) -> (f64, f64) {
    let x = scene.surface.x();
    (x.first().copied().unwrap_or(0.0), x.last().copied().unwrap_or(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Number of runs until F_z is within 1e-3 of the load; `run` gives F_z and the share of the Maxwell elements.
    fn runs(mut run: impl FnMut(f64) -> (f64, f64), start: (f64, f64)) -> usize {
        let mut search = LoadSearch::new(10.0, start.0, start.1);
        for count in 1..30 {
            let (force, maxwell) = run(search.w);
            if (force / 10.0 - 1.0).abs() <= 1e-3 {
                return count;
            }
            let _ = search.change(force, maxwell);
        }
        30
    }

    /// A load that grows with the square of the depth.
    #[test]
    fn a_smooth_load_is_found_in_a_few_runs() {
        let law = |w: f64| (1e9 * w * w, 0.0);
        assert!(runs(law, (-5e-5, 1e5)) <= 5);
        // The slope at first wrong by a factor of 2 either way, the start by one of 2 or more.
        assert!(runs(law, (-5e-5, 2e5)) <= 8);
        assert!(runs(law, (-2e-4, 4e5)) <= 8);
    }

    /// Dashpots that bear twice as much as the springs and come to rest by nine tenths from one run to the next: with w
    /// held they would be at rest to 1e-3 in four runs, but every change of w loads them anew.
    #[test]
    fn dashpots_that_come_to_rest_do_not_hide_the_load() {
        let (mut rest, mut before) = (0.0, 0.0);
        let law = |w: f64| {
            // What is left of their load, and what w adds.
            rest = 0.1 * rest + 1e6 * (before - w);
            before = w;
            (-5e5 * w + 0.85 * rest, rest)
        };
        assert!(runs(law, (-1.5e-5, 4e5)) <= 10);
    }
}
