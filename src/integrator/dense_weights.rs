//! The weights with which the stages of a step enter the values within it (docs/theory.md, section 5).

use super::dense::DenseOutput;
use super::dense_workspace::DenseWorkspace;
use super::interpolation::Velocities;
use crate::math::Relaxation;
use crate::model::{ByLink, CarrierPoint};

impl DenseOutput<'_> {
    /// Sets the weights at the fraction `theta` of the step, unless they are there already.
    pub(super) fn set_weights(&self, workspace: &mut DenseWorkspace, theta: f64) {
        let at = (self.method.scheme, self.span.length, theta);
        if workspace.at == Some(at) {
            return;
        }
        let (h, interpolation) = (self.span.length, self.interpolation());
        workspace.values = interpolation.values(theta);
        workspace.integral = interpolation.integral(theta).map(|weight| h * weight);
        match interpolation.velocities() {
            Velocities::Polynomial => self.set_relaxing_elements(workspace, theta),
            Velocities::BrokenLine => self.set_linear_elements(workspace),
        }
        workspace.of_rate = ByLink::default();
        for row in &self.model.rows {
            let rates = workspace.elements[row.time_index].rates;
            for (weight, rate) in workspace.of_rate[row.kind].iter_mut().zip(rates) {
                *weight += row.stiffness * rate;
            }
        }
        workspace.at = Some(at);
    }

    /// Lets the elements follow the interpolated rate exactly, less the linear share of the difference at the step's
    /// own end.
    fn set_relaxing_elements(&self, workspace: &mut DenseWorkspace, theta: f64) {
        let h = self.span.length;
        let is_other_step = workspace.at.is_none_or(|(scheme, length, _)| (scheme, length) != (self.method.scheme, h));
        let relaxations = workspace.elements.iter_mut().zip(&mut workspace.whole).zip(&self.model.relaxation_times);
        for ((elements, whole), tau) in relaxations {
            if is_other_step {
                *whole = Relaxation::new(h / tau, 1.0);
            }
            let here = if theta == 1.0 { *whole } else { Relaxation::new(h / tau, theta) };
            let driven = std::array::from_fn(|power| h * (here.driven[power] - theta * whole.driven[power]));
            elements.ends = [here.decay - theta * whole.decay, theta];
            elements.rates = self.interpolation().combined(&driven);
        }
    }

    /// Puts the elements on the broken lines through their elongations at the start, at the first implicit stage and at
    /// the end.
    fn set_linear_elements(&self, workspace: &mut DenseWorkspace) {
        let [of_start, of_first, of_end, ..] = workspace.values;
        for (time_index, elements) in workspace.elements.iter_mut().enumerate() {
            *elements = self.method.maxwell.weights_between(time_index, 1, [of_start, of_first, of_end]);
        }
    }

    /// Computes the accelerations of the interpolant along x and z (m/s²) at the fraction `theta` of the step, with the
    /// carrier there.
    pub(super) fn set_accelerations(&self, workspace: &mut DenseWorkspace, theta: f64, carrier: &CarrierPoint) {
        let slope = self.interpolation().slope(theta).map(|weight| weight / self.span.length);
        let missing = |of_carrier: f64, rate: fn(&CarrierPoint) -> f64| {
            of_carrier - slope.iter().zip(self.carriers()).map(|(weight, at)| weight * rate(at)).sum::<f64>()
        };
        let [x, z] = workspace.of_masses.each_mut().map(|values| &mut values[..self.masses.len()]);
        let missing_x = missing(carrier.x.acceleration, |at| at.x.speed);
        self.combine(x, &slope, None, |stage| &stage.velocity_x, missing_x);
        self.combine(z, &slope, None, |stage| &stage.velocity_z, missing(carrier.z.acceleration, |at| at.z.speed));
    }
}
