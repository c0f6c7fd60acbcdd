//! The tolerances of the local error of a step (docs/theory.md, section 9).

use serde::{Deserialize, Serialize};

use crate::model::{ByAxis, ByLink, Forces, LinkKind, LinkLaw, Model};

/// The tolerances of the local error of a step. The error of each quantity is divided by absolute + relative · size.
#[derive(Clone, Debug, PartialEq)]
pub struct Tolerance {
    /// Relative tolerance, 1.
    pub relative: f64,
    /// Absolute tolerance of positions, m.
    pub position: f64,
    /// Absolute tolerance of velocities, m/s: that of positions times the highest natural frequency without rods.
    pub velocity: f64,
    /// By kind of link, the stiffness that turns the error of a force into one of an elongation, N/m: c + Σ c_j, but
    /// for a rod the stiffness with which the other links hold a mass.
    force_scale: ByLink<f64>,
    /// The kinds of link that are rods: their errors count as errors of their forces.
    rods: ByLink<Option<Rod>>,
    /// [`Model::long_term_stiffness`], N/m.
    long_term_stiffness: Option<f64>,
    /// Number of masses of the layer, over which their errors are averaged.
    pub(super) masses: usize,
    /// Absolute tolerance of the speed of a body along x and z, m/s: that of positions times its natural frequency on
    /// the layer and the drive.
    pub(super) body_velocity: ByAxis<f64>,
}

/// A kind of link that is stiff enough to act as a rod.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rod {
    pub(super) law: LinkLaw,
    /// The larger of the natural frequency √(c/m) of a mass on it and of its decay rate d/m, 1/s.
    rate: f64,
}

impl Rod {
    fn new(model: &Model, kind: LinkKind) -> Self {
        let law = model.links[kind];
        Self { law, rate: (law.stiffness / model.mass).sqrt().max(law.damping / model.mass) }
    }

    /// Relative error that a step of length `h` (s) may make of its force in addition. Where the steps resolve the
    /// rod's own motion after a jump, the velocities of the masses decide; a long step forgets the errors of the
    /// previous one.
    pub(super) fn transient(&self, h: f64) -> f64 {
        TRANSIENT / (1.0 + (h * self.rate).powi(2))
    }
}

/// Allowed relative error of a rod's force just after a jump.
///
/// Recommended 0.01 to 0.3. It dies out together with the force of the jump.
const TRANSIENT: f64 = 0.1;

/// Newton's iterations end when their error is below this share of the tolerance.
///
/// Recommended 0.001 to 0.1. A larger share spoils the error estimate, a smaller one costs iterations.
pub(super) const NEWTON_SHARE: f64 = 0.05;

impl Tolerance {
    /// The tolerances of `model` for a `relative` tolerance and an `absolute` one of positions, m.
    pub fn new(model: &Model, relative: f64, absolute: f64) -> Self {
        let stiffness = model.mass_stiffness_without_rods();
        let rod = |kind: LinkKind| (model.is_rod(kind) && stiffness > 0.0).then(|| Rod::new(model, kind));
        let force_scale = |kind: LinkKind| if rod(kind).is_some() { stiffness } else { model.glassy[kind] };
        Self {
            relative,
            position: absolute,
            velocity: absolute * model.frequency_without_rods(),
            force_scale: ByLink::from_fn(force_scale),
            rods: ByLink::from_fn(rod),
            long_term_stiffness: model.long_term_stiffness(),
            masses: model.masses(),
            body_velocity: ByAxis::from_fn(|axis| absolute * model.body_frequency(axis)),
        }
    }

    /// The square of the allowed error of a position of this size, m².
    #[inline]
    pub fn position_tolerance_sq(&self, size: f64) -> f64 {
        square(self.position + self.relative * size.abs())
    }

    /// The square of the allowed error of a velocity of this size, m²/s².
    #[inline]
    pub fn velocity_tolerance_sq(&self, size: f64) -> f64 {
        square(self.velocity + self.relative * size.abs())
    }

    /// The factor that turns the error of the force of a link, or of all its Maxwell elements, into one of an
    /// elongation, m/N.
    pub(super) fn per_force(&self, kind: LinkKind) -> f64 {
        let stiffness = self.force_scale[kind];
        if stiffness > 0.0 { 1.0 / stiffness } else { 0.0 }
    }

    /// The factor for the force of the vertical Maxwell elements of masses in contact, where their stiffness is far
    /// above the long-term one; `None` otherwise, and for the other links.
    pub(super) fn per_contact_force(&self, kind: LinkKind) -> Option<f64> {
        self.long_term_stiffness.filter(|_| kind == LinkKind::Vertical).map(|stiffness| 1.0 / stiffness)
    }

    pub(super) fn rod(&self, kind: LinkKind) -> Option<Rod> {
        self.rods[kind]
    }

    /// The correction of the velocities, m/s, below which Newton's iterations of a stage with β = `beta` (s) end.
    pub(super) fn newton(&self, beta: f64) -> f64 {
        NEWTON_SHARE * self.velocity.min(self.position / beta)
    }

    /// The correction of the velocities, m/s, that changes the forces of the rods by [`NEWTON_SHARE`] of their
    /// tolerance; infinite without rods.
    pub(super) fn newton_of_rods(&self, beta: f64) -> f64 {
        let rods = LinkKind::ALL.into_iter().filter_map(|kind| Some((self.rod(kind)?, self.per_force(kind))));
        let share = |(rod, per_force): (Rod, f64)| self.position / (per_force * rod.law.by_velocity(beta));
        NEWTON_SHARE * rods.map(share).fold(f64::INFINITY, f64::min)
    }
}

pub(super) fn square(x: f64) -> f64 {
    x * x
}

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
