//! What a run adds up for its outputs: energies, counts, and the estimated error.

use serde::{Deserialize, Serialize};

use crate::model::ChannelEnergies;
use crate::scene::{OutputGroup, Scene};

/// The quantities that a run adds up, as the output groups of its scene need them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Accounts {
    /// Energies: the groups `dissipation` and `energy`.
    pub energy: bool,
    /// The error estimate of the forces and the processor time: the group `solver`.
    pub solver: bool,
    /// The error estimate of E_diss: the groups `solver` and `dissipation` together.
    pub dissipation_error: bool,
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
            dissipation_error: asked(OutputGroup::Solver) && asked(OutputGroup::Dissipation),
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
    /// T + V + T_c + V_c at the start.
    pub initial: f64,
}

impl Energies {
    /// Adds what `other` has gained through the channels and in impacts.
    pub fn gain(&mut self, other: &Self) {
        self.channels.add(&other.channels);
        self.impact += other.impact;
    }

    /// Energy dissipated in all channels and in impacts, J.
    pub fn dissipated(&self) -> f64 {
        self.channels.dissipated() + self.impact
    }

    /// The largest of all energies through the channels and in impacts, J.
    pub fn largest(&self) -> f64 {
        let ChannelEnergies { damper, maxwell, friction, shear, fine: _, input, carrier } = self.channels;
        let all: [f64; 7] = [damper, maxwell, friction, shear, input, carrier, self.impact];
        all.iter().fold(0.0, |largest, energy| largest.max(energy.abs()))
    }
}

/// The quantities of a run whose error is estimated, at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Monitored {
    /// F_x and F_z, N.
    pub forces: [f64; 2],
    /// Distances of bodies from their start along x and z, m.
    pub ways: [f64; 2],
    /// E_diss, J; `None` where it is not asked for.
    pub dissipated: Option<f64>,
}

/// The largest estimated error of a quantity, and the largest absolute value of it, both in its unit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct LargestError {
    error: f64,
    value: f64,
}

impl LargestError {
    /// Includes an `error` found where the more accurate run has the `value`.
    fn include(&mut self, error: f64, value: f64) {
        self.error = self.error.max(error);
        self.value = self.value.max(value.abs());
    }

    /// The error over the largest value; 0 without an error.
    fn relative(&self) -> f64 {
        match (self.error, self.value) {
            (0.0, _) => 0.0,
            (_, 0.0) => 1.0,
            (error, value) => (error / value).min(f64::MAX),
        }
    }
}

/// Differences of a force below this share of the larger of both forces are roundings: a force that is the sum of
/// opposite ones, as in a symmetric scene, consists of nothing else.
const ROUNDING: f64 = 1e-13;

/// The solver's counts since the start, and its error estimate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Counters {
    /// Accepted steps of the whole layer.
    pub steps: u64,
    /// Rejected steps of the whole layer.
    pub rejected: u64,
    /// Mode changes.
    pub events: u64,
    /// Communication steps that were done again from their start.
    pub repeated: u64,
    /// The largest errors of F_x and F_z, N.
    forces: [LargestError; 2],
    /// The largest errors of the bodies' displacements, m.
    ways: [LargestError; 2],
    /// The largest error of E_diss, J.
    dissipated: LargestError,
}

impl Counters {
    /// Compares a run with its reference run at the same time: the difference is this share of the error.
    pub fn record_error(&mut self, found: &Monitored, reference: &Monitored, share: f64) {
        let largest = self.forces.iter().map(|force| force.value).chain(reference.forces.map(f64::abs));
        let rounding = ROUNDING * largest.fold(0.0, f64::max);
        for ((force, found), reference) in self.forces.iter_mut().zip(found.forces).zip(reference.forces) {
            let difference = (found - reference).abs();
            force.include(if difference > rounding { difference / share } else { 0.0 }, reference);
        }
        for ((way, found), reference) in self.ways.iter_mut().zip(found.ways).zip(reference.ways) {
            way.include((found - reference).abs() / share, reference);
        }
        if let (Some(found), Some(reference)) = (found.dissipated, reference.dissipated) {
            self.dissipated.include((found - reference).abs() / share, reference);
        }
    }

    /// Records that the errors of a run are unknown: they count as large as the quantities `found`.
    pub fn record_unknown(&mut self, found: &Monitored) {
        for (force, found) in self.forces.iter_mut().zip(found.forces) {
            force.include(found.abs(), found);
        }
        for (way, found) in self.ways.iter_mut().zip(found.ways) {
            way.include(found.abs(), found);
        }
        if let Some(found) = found.dissipated {
            self.dissipated.include(found.abs(), found);
        }
    }

    /// The largest of the estimated errors of F_x, F_z and the bodies' displacements, each over its largest value so
    /// far; 0 without an estimate.
    pub fn force_error(&self) -> f64 {
        self.forces.iter().chain(&self.ways).map(LargestError::relative).fold(0.0, f64::max)
    }

    /// The estimated error of E_diss over its largest value so far; 0 without an estimate.
    pub fn dissipation_error(&self) -> f64 {
        self.dissipated.relative()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn monitored(x: f64, z: f64, dissipated: f64) -> Monitored {
        Monitored { forces: [x, z], ways: [0.0; 2], dissipated: Some(dissipated) }
    }

    #[test]
    fn the_error_is_that_of_the_worse_force_over_its_own_largest_value() {
        let mut counters = Counters::default();
        assert_eq!((counters.force_error(), counters.dissipation_error()), (0.0, 0.0));
        counters.record_error(&monitored(0.5, 101.0, 3.0), &monitored(1.0, 100.0, 4.0), 0.5);
        assert_eq!((counters.force_error(), counters.dissipation_error()), (1.0, 0.5));
        // The largest error stays, over a value that has become larger.
        counters.record_error(&monitored(-8.0, 50.0, 8.0), &monitored(-8.0, 50.0, 8.0), 0.5);
        assert_eq!((counters.force_error(), counters.dissipation_error()), (0.125, 0.25));
    }

    #[test]
    fn a_force_of_roundings_has_no_error() {
        let mut counters = Counters::default();
        counters.record_error(&monitored(1e-15, 1.0, 0.0), &monitored(-2e-15, 1.0, 0.0), 1.0);
        assert_eq!(counters.force_error(), 0.0);
        counters.record_error(&monitored(0.0, 1.0, 0.0), &monitored(2e-12, 1.0, 0.0), 1.0);
        assert_eq!(counters.force_error(), 1.0);
    }

    #[test]
    fn unknown_errors_are_as_large_as_the_quantities() {
        let mut counters = Counters::default();
        counters.record_unknown(&monitored(-2.0, 5.0, 0.1));
        assert_eq!((counters.force_error(), counters.dissipation_error()), (1.0, 1.0));
    }
}
