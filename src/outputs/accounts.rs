//! What a run adds up for its outputs: energies, counts, and the estimated error.

use serde::{Deserialize, Serialize};

use crate::model::ChannelEnergies;
use crate::scene::{OutputGroup, Scene};

/// The quantities that a run adds up, as the output groups of its scene need them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Accounts {
    /// Energies: the groups `dissipation` and `energy`.
    pub energy: bool,
    /// The error estimate of F_z and the processor time: the group `solver`.
    pub solver: bool,
    /// The forces' sensitivities to the carrier's targets: the group `tangent`.
    pub tangents: bool,
}

impl Accounts {
    /// The quantities that the output groups of `scene` need.
    pub fn new(scene: &Scene) -> Self {
        let asked = |group| scene.outputs.contains(&group);
        Self {
            energy: asked(OutputGroup::Dissipation) || asked(OutputGroup::Energy),
            solver: asked(OutputGroup::Solver),
            tangents: asked(OutputGroup::Tangent),
        }
    }
}

/// Energies since the start, J.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Energies {
    /// Through the channels: all but impacts, which are instantaneous.
    pub channels: ChannelEnergies,
    /// Dissipated in impacts.
    pub impact: f64,
    /// T + V at the start.
    pub initial: f64,
}

impl Energies {
    /// Energy dissipated in all channels and in impacts, J.
    pub fn dissipated(&self) -> f64 {
        self.channels.dissipated() + self.impact
    }

    /// All numbers, to check that they are finite.
    pub fn numbers(&self) -> [f64; 6] {
        let Self { channels: ChannelEnergies { damper, maxwell, friction, input }, impact, initial } = *self;
        [damper, maxwell, friction, input, impact, initial]
    }
}

/// The solver's counts since the start, and its error estimate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Counters {
    /// Accepted steps.
    pub steps: u64,
    /// Rejected steps.
    pub rejected: u64,
    /// Mode changes.
    pub events: u64,
    /// Largest estimated error of F_z, N.
    largest_error: f64,
    /// Largest |F_z| of the error-estimation run, N.
    largest_force: f64,
}

impl Counters {
    /// All numbers that are not counts, to check that they are finite.
    pub fn numbers(&self) -> [f64; 2] {
        [self.largest_error, self.largest_force]
    }

    /// Compares F_z with that of the error-estimation run at the same time, N. The difference is the `share` of the error.
    pub fn note_error(&mut self, force: f64, reference: f64, share: f64) {
        self.largest_error = self.largest_error.max((force - reference).abs() / share);
        self.largest_force = self.largest_force.max(reference.abs());
    }

    /// Notes that the error of F_z = `force` (N) is unknown: it counts as large as the force.
    pub fn note_unknown(&mut self, force: f64) {
        self.note_error(2.0 * force, force, 1.0);
    }

    /// Estimated error of F_z over its largest value so far; 0 without an estimate.
    pub fn estimated_error(&self) -> f64 {
        match (self.largest_error, self.largest_force) {
            (0.0, _) => 0.0,
            (_, 0.0) => 1.0,
            (error, force) => (error / force).min(f64::MAX),
        }
    }
}
