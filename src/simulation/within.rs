//! What lies within the step tried last: rows are shown from there, and the run goes on from there after an event.

use super::Simulation;
use super::stepping::Stride;
use crate::math::bracketed_root;
use crate::model::ChannelEnergies;

/// The most that the dense output may miss of the equations of motion where a step is cut at an event, as a velocity
/// gained over the step, against the tolerance.
///
/// Recommended 1 to 5: what is missed swings about 0 through the step, so less of it is left in the velocity; with 5
/// the errors of whole runs are those of 1, and fewer steps are done again.
const MOST_DEFECT: f64 = 5.0;
/// The most that it may miss where a row is shown within a step, from which nothing goes on. In smooth motion it misses
/// up to some tens; where a step leaps over what follows an event in no time, thousands and more.
const MOST_SHOWN: f64 = 100.0;
/// The most that mode changes not yet settled may make of F_z where a row is shown within a time step, as a multiple of
/// the relative tolerance. That is a bound for all of them together at the step's end; what a row misses is a third of
/// it, and less.
const MOST_UNSETTLED: f64 = 3.0;

impl Simulation {
    /// The share of the step tried last after which F_z is the force `until`; `None` where `stride` ends below.
    pub(super) fn rises_within(&mut self, stride: &Stride, until: Option<f64>) -> Option<f64> {
        let Stride { h, share } = *stride;
        let force = until.filter(|&force| self.force_z_within(h, share) >= force)?;
        Some(bracketed_root(|theta| self.force_z_within(h, theta) - force, (0.0, share), 1e-14))
    }

    /// F_z at the fraction `theta` of the step of length `h` tried last, N.
    pub(super) fn force_z_within(&mut self, h: f64, theta: f64) -> f64 {
        self.evaluate_within(h, theta);
        self.forces.on_carrier_z()
    }

    /// Whether what is known of the step of length `h` tried last is good at its fraction `theta`. A time step's mode
    /// changes are settled at its end, and what lies before is not: it is shown where that makes little of F_z.
    pub(super) fn can_show_within(&mut self, h: f64, theta: f64) -> bool {
        if self.run.stepping {
            let force = self.integrator.end_forces().on_carrier_z().abs();
            self.step_end.unsettled_force() <= MOST_UNSETTLED * self.settings.tolerance.relative * force
        } else {
            self.defect_within(h, theta) <= MOST_SHOWN
        }
    }

    /// Whether the run can go on from the fraction `share` of the step of length `h` tried last.
    pub(super) fn is_good_within(&mut self, h: f64, share: f64) -> bool {
        !self.integrator.has_tangents() && self.defect_within(h, share) <= MOST_DEFECT
    }

    /// What the dense output of the step of length `h` tried last misses of the equations of motion at its fraction
    /// `share`.
    fn defect_within(&mut self, h: f64, share: f64) -> f64 {
        self.evaluate_within(h, share);
        let dense = self.integrator.dense(&self.model, &self.run.carrier, &self.run.state, (self.run.s, h));
        dense.defect(share, (&self.within, &self.forces), &self.dense_workspace, &self.settings.tolerance)
    }

    /// Calls `show` with the simulation as it stood at the fraction `theta` of the step of length `h` tried last.
    pub(super) fn show_within(&mut self, h: f64, theta: f64, show: impl FnOnce(&mut Self)) {
        let (s, energies) = (self.run.s, self.run.energies);
        if self.settings.accounts.energy {
            let gain = self.energies_within(h, theta);
            self.run.energies.channels.add(&gain);
        }
        self.look_within(h, theta);
        let mut within = std::mem::take(&mut self.within);
        self.run.s += theta * h;
        std::mem::swap(&mut self.run.state, &mut within);
        show(self);
        std::mem::swap(&mut self.run.state, &mut within);
        (self.run.s, self.run.energies, self.within) = (s, energies, within);
    }

    /// Energies through the channels from the start of the step of length `h` tried last to its fraction `theta`.
    fn energies_within(&mut self, h: f64, theta: f64) -> ChannelEnergies {
        if self.run.stepping {
            self.integrator.two_stage_energies(&self.model, &self.run.state, h, theta)
        } else {
            self.integrator.energies(&self.model, &self.run.state, h, theta)
        }
    }

    /// The state at the fraction `theta` of the step of length `h` tried last, into `within`.
    pub(super) fn look_within(&mut self, h: f64, theta: f64) {
        if self.within_at == Some((h, theta)) {
            return;
        }
        self.within_at = Some((h, theta));
        if self.run.stepping {
            return self.look_within_time_step(h, theta);
        }
        let dense = self.integrator.dense(&self.model, &self.run.carrier, &self.run.state, (self.run.s, h));
        dense.state_at(theta, &mut self.dense_workspace, &mut self.within);
    }

    /// The state and the forces at the fraction `theta` of the step of length `h` tried last.
    fn evaluate_within(&mut self, h: f64, theta: f64) {
        self.look_within(h, theta);
        self.forces.evaluate(&self.model, &self.within, &self.run.carrier.at(self.run.s + theta * h));
    }
}
