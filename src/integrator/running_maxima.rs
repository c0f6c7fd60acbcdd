//! The largest forces and energies of a run so far: what their errors are measured by.

use serde::{Deserialize, Serialize};

use super::tolerance::Tolerance;
use crate::model::{ByAxis, Forces, LinkKind, Model};

/// The least scale of the errors of one force, as a share of the other, and as one of the force that the scene's height
/// makes on a mass.
const MIN_FORCE: f64 = 1e-3;
/// The least scale of the errors of one force as a share of the force that the height makes on all masses in the long
/// term: the first touches are not resolved down to forces that do not matter later.
const MIN_OF_LAYER: f64 = 1e-3;
/// The share of the scene's height by which the layer is compressed in the least scale of the errors of energies; the
/// least scale is lower where the masses have less energy at the carrier's speed. A light layer moves with energies far
/// below those of its springs.
const MIN_COMPRESSION: f64 = 0.01;
/// The elongation of one mass's links whose energy is the least scale in any case, as a share of the scene's height.
const MIN_ELONGATION: f64 = 1e-9;
/// The least scale of the errors of F_x as a share of the friction that a slide under F_z would have.
const EXPECTED_FRICTION: f64 = 0.5;

/// The largest forces of the layer on the carrier and energies so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RunningMaxima {
    /// |F_x| and |F_z|, N.
    pub force: ByAxis<f64>,
    /// Of the energies through the channels and in impacts, J; 0 where energies are not computed.
    pub energy: f64,
}

impl RunningMaxima {
    /// Includes the forces of `forces`.
    #[must_use]
    pub fn with(self, forces: &Forces) -> Self {
        Self { force: ByAxis::from_fn(|axis| self.force[axis].max(forces.on_carrier(axis).abs())), ..self }
    }

    /// By how much the force of one mass of a layer of `model` may err, N: the errors of all masses, if they are
    /// independent, make one of F_x or F_z within the relative tolerance.
    pub fn allowed_of_mass(self, model: &Model, tolerance: &Tolerance) -> f64 {
        let scale = self.force_scales(model, tolerance);
        tolerance.relative * scale.x.min(scale.z) / (tolerance.masses as f64).sqrt()
    }

    /// What the errors of F_x and F_z are measured by in a layer of `model`, N. Forces that are still to come, or that
    /// symmetry makes nothing, are not resolved down to their rounding.
    pub(super) fn force_scales(self, model: &Model, tolerance: &Tolerance) -> ByAxis<f64> {
        let expected = MIN_FORCE.max(EXPECTED_FRICTION * model.friction.coulomb);
        let of_mass = MIN_FORCE * height(tolerance) * model.effective_stiffness();
        let of_layer = MIN_OF_LAYER * height(tolerance) * layer_stiffness(model, tolerance);
        let least = of_mass.max(of_layer);
        ByAxis {
            x: self.force.x.max(expected * self.force.z).max(least),
            z: self.force.z.max(MIN_FORCE * self.force.x).max(least),
        }
    }

    /// What the errors of energies are measured by, J, under a carrier that moves at `speed` (m/s).
    pub(super) fn energy_scale(self, model: &Model, tolerance: &Tolerance, speed: f64) -> f64 {
        let of_layer = layer_stiffness(model, tolerance) * (MIN_COMPRESSION * height(tolerance)).powi(2);
        let of_motion = tolerance.masses as f64 * model.mass * speed * speed;
        let of_mass = (MIN_ELONGATION * height(tolerance)).powi(2) * model.effective_stiffness();
        self.energy.max(of_layer.min(of_motion)).max(of_mass)
    }
}

/// The long-term stiffness of the vertical links of the whole layer, N/m.
fn layer_stiffness(model: &Model, tolerance: &Tolerance) -> f64 {
    tolerance.masses as f64 * model.links[LinkKind::Vertical].stiffness
}

/// The scene's height, m.
fn height(tolerance: &Tolerance) -> f64 {
    tolerance.position / tolerance.relative
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = "name = 'a'
        layer = { masses = 40, spacing = 1.0, mass = 1e-7, vertical = { stiffness = 2e3 } }
        surface = { kind = 'flat' }";

    /// Of a layer that is 1e-5 m high: 40 · 2000 N/m · (1e-7 m)², 40 · 1e-7 kg · v², and 2000 N/m · (1e-14 m)².
    #[test]
    fn nothing_yet_is_measured_by_the_layer_or_by_its_motion() {
        let model = Model::from_text(SCENE);
        let (tolerance, nothing) = (Tolerance::new(&model, 1e-3, 1e-8), RunningMaxima::default());
        for (speed, expected) in [(1.0, 8e-10), (1e-3, 4e-12), (0.0, 2e-25)] {
            let found = nothing.energy_scale(&model, &tolerance, speed);
            assert!((found / expected - 1.0).abs() < 1e-12, "{speed} m/s: {found:e} J");
        }
        let ByAxis { x, z } = nothing.force_scales(&model, &tolerance);
        assert!((x / 8e-4 - 1.0).abs() < 1e-12 && x == z, "{x:e} and {z:e} N");
        let known = RunningMaxima { force: ByAxis { x: 0.0, z: 2.0 }, energy: 1e-3 };
        assert_eq!(
            (known.force_scales(&model, &tolerance).z, known.energy_scale(&model, &tolerance, 1.0)),
            (2.0, 1e-3)
        );
    }
}
