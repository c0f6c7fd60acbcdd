//! What error a step may make.

use crate::model::{LinkKind, Model};

/// The tolerances of one step's error. Each quantity weighs as error over (absolute + relative · size).
#[derive(Clone, Debug, PartialEq)]
pub struct Tolerance {
    /// Relative tolerance, 1.
    pub relative: f64,
    /// Absolute tolerance of positions, m.
    pub position: f64,
    /// Absolute tolerance of velocities, m/s: that of positions times the stiffest frequency but for rods.
    pub velocity: f64,
    /// What the force of each kind of link is divided by, N/m: a Maxwell element's error counts by the force that it
    /// makes. c + Σ c_j, but what the other links hold a mass with for a rod.
    per_elongation: [f64; 4],
    /// The kinds of link that are rods: their errors count by the forces that they make.
    rods: [Option<Rod>; 4],
    /// [`Model::long_term_stiffness`], N/m.
    lasting: Option<f64>,
}

/// A kind of link that works as a rod.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rod {
    /// c, N/m.
    pub(super) stiffness: f64,
    /// d, N s/m.
    pub(super) damping: f64,
    /// How fast a mass settles or swings on it, 1/s.
    rate: f64,
}

impl Rod {
    fn new(model: &Model, kind: LinkKind) -> Self {
        let (stiffness, damping) = (model.links[kind as usize].stiffness, model.links[kind as usize].damping);
        Self { stiffness, damping, rate: (stiffness / model.mass).sqrt().max(damping / model.mass) }
    }

    /// Share of its force by which a step of length `h` (s) may err: where the steps follow its own motion after a
    /// jump, what counts is the masses' velocities; a step that is long against it forgets the error of the one before.
    pub(super) fn transient(&self, h: f64) -> f64 {
        TRANSIENT / (1.0 + (h * self.rate).powi(2))
    }
}

/// The error of a rod's force just after a jump, as a share of it.
///
/// Recommended 0.01 to 0.3: what is left of it goes with the force of the jump.
const TRANSIENT: f64 = 0.1;

/// Newton's iterations are left to this share of the tolerance.
///
/// Recommended 0.001 to 0.1: larger spoils the error estimate, smaller costs iterations.
pub(super) const NEWTON_SHARE: f64 = 0.05;

impl Tolerance {
    /// The tolerances of `model` for a relative and an absolute (m) one.
    pub fn new(model: &Model, relative: f64, absolute: f64) -> Self {
        let felt = model.mass_stiffness_without_rods();
        let rod = |kind: LinkKind| (model.is_rod(kind) && felt > 0.0).then(|| Rod::new(model, kind));
        let per_elongation = |kind: LinkKind| if rod(kind).is_some() { felt } else { model.glassy[kind as usize] };
        Self {
            relative,
            position: absolute,
            velocity: absolute * model.frequency_without_rods(),
            per_elongation: LinkKind::ALL.map(per_elongation),
            rods: LinkKind::ALL.map(rod),
            lasting: model.long_term_stiffness(),
        }
    }

    /// The square of the error allowed of a position of this size, m².
    #[inline]
    pub fn of_position(&self, size: f64) -> f64 {
        square(self.position + self.relative * size.abs())
    }

    /// The square of the error allowed of a velocity of this size, m²/s².
    #[inline]
    pub fn of_velocity(&self, size: f64) -> f64 {
        square(self.velocity + self.relative * size.abs())
    }

    /// What turns the error of the force of a link, or of all its Maxwell elements, into an elongation, m/N.
    pub fn per_force(&self, kind: LinkKind) -> f64 {
        let stiffness = self.per_elongation[kind as usize];
        if stiffness > 0.0 { 1.0 / stiffness } else { 0.0 }
    }

    /// The same for the vertical Maxwell elements of a mass in contact, where what presses it on once they have relaxed
    /// says nothing of what they do: then their force counts by itself.
    pub(super) fn per_pressing_force(&self, kind: LinkKind) -> Option<f64> {
        self.lasting.filter(|_| kind == LinkKind::Vertical).map(|stiffness| 1.0 / stiffness)
    }

    /// The links of `kind` if they are rods.
    pub(super) fn rod(&self, kind: LinkKind) -> Option<Rod> {
        self.rods[kind as usize]
    }

    /// To what correction of the velocities, m/s, a stage with β = `beta` (s) is solved.
    pub fn newton(&self, beta: f64) -> f64 {
        NEWTON_SHARE * self.velocity.min(self.position / beta)
    }

    /// The same where rods make forces of the velocities: the most that leaves their forces within the tolerance.
    pub(super) fn newton_of_rods(&self, beta: f64) -> f64 {
        let rods = LinkKind::ALL.into_iter().filter_map(|kind| Some((self.rod(kind)?, self.per_force(kind))));
        let share = |(rod, per_force): (Rod, f64)| self.position / (per_force * (rod.damping + beta * rod.stiffness));
        NEWTON_SHARE * rods.map(share).fold(f64::INFINITY, f64::min)
    }
}

fn square(x: f64) -> f64 {
    x * x
}
