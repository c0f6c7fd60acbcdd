//! The tolerances of the local error of a step (docs/theory.md, section 9).

use crate::model::{ByAxis, ByLink, LinkKind, LinkLaw, Model};

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
