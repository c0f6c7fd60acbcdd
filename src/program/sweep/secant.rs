//! The displacement for a load, by secants over runs.
//!
//! A run at w bears F_z, of which the Maxwell elements' share is B; in steady motion B is 0. Near the load the two go
//! together:
//!
//!   F_z = a - s w + κ B
//!
//! with s the layer's stiffness in steady motion. κ is what is gone of F_z when the dashpots have come to rest: 1 where
//! all masses stay in contact, less where they come and go. Three runs would give the three numbers; so that two do,
//! and scatter does not upset them, they are those of least squares over all runs and what is known beforehand. The
//! load is met at B = 0.

use nalgebra::{Matrix3, Vector3};

/// What is known of s, over the stiffness of the vertical springs alone, and of κ: a value and how far it may be off.
const STIFFNESS: (f64, f64) = (1.0, 0.7);
const BORNE: (f64, f64) = (0.95, 0.1);
/// How well a run tells F_z, as a share of the load: by its scatter, and by how far it is from the load and from rest,
/// where the law is not straight.
const SCATTER: f64 = 2e-4;
const BENT: f64 = 0.1;
/// s is at least this share of what it is known to be.
const LEAST: f64 = 0.2;

/// Where w has to be for F_z to be a load.
#[derive(Clone, Copy, Debug)]
pub(super) struct Secant {
    /// F_z, N.
    pub(super) load: f64,
    /// Where w is, m.
    pub(super) w: f64,
    /// The start.
    first: f64,
    /// Change of w for a change of F_z by the load, m.
    unit: f64,
    /// Normal equations of least squares for a, s and κ in units of the load.
    matrix: Matrix3<f64>,
    right: Vector3<f64>,
}

impl Secant {
    /// From w, where F_z grows by about `stiffness` (N/m) as w falls.
    pub(super) fn new(load: f64, (w, stiffness): (f64, f64)) -> Self {
        let mut secant =
            Self { load, w, first: w, unit: load / stiffness, matrix: Matrix3::zeros(), right: Vector3::zeros() };
        secant.add(Vector3::new(0.0, 1.0, 0.0), STIFFNESS);
        secant.add(Vector3::new(0.0, 0.0, 1.0), BORNE);
        secant
    }

    /// An equation row · (a, s, κ) = value, which may be off by `error`.
    fn add(&mut self, row: Vector3<f64>, (value, error): (f64, f64)) {
        let weight = 1.0 / (error * error);
        self.matrix += weight * row * row.transpose();
        self.right += weight * value * row;
    }

    /// Moves w, where F_z was `force`, of which the Maxwell elements bore `borne` (N). Returns by how much, m.
    pub(super) fn change(&mut self, force: f64, borne: f64) -> f64 {
        let (x, force, borne) = ((self.w - self.first) / self.unit, force / self.load, borne / self.load);
        let error = SCATTER + BENT * ((force - 1.0).abs() + borne.abs());
        self.add(Vector3::new(1.0, -x, borne), (force, error));
        let Some(law) = self.matrix.cholesky().map(|matrix| matrix.solve(&self.right)) else { return 0.0 };
        let next = self.first + self.unit * (law[0] - 1.0) / law[1].max(LEAST);
        let change = next - self.w;
        self.w = next;
        change
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs until F_z is within 1e-3 of the load.
    fn runs(mut run: impl FnMut(f64) -> (f64, f64), start: (f64, f64)) -> usize {
        let mut secant = Secant::new(10.0, start);
        for count in 1..30 {
            let (force, borne) = run(secant.w);
            if (force / 10.0 - 1.0).abs() <= 1e-3 {
                return count;
            }
            let _ = secant.change(force, borne);
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

    /// Dashpots that bear twice as much as the springs and come to rest by nine tenths from one run to the next: by
    /// themselves they would be at rest to 1e-3 in four runs, and every change of w stirs them anew.
    #[test]
    fn dashpots_that_come_to_rest_do_not_hide_the_load() {
        let (mut rest, mut before) = (0.0, 0.0);
        let law = |w: f64| {
            // What they miss of rest: what is left, and what w adds.
            rest = 0.1 * rest + 1e6 * (before - w);
            before = w;
            (-5e5 * w + 0.85 * rest, rest)
        };
        assert!(runs(law, (-1.5e-5, 4e5)) <= 10);
    }
}
