//! Sums over the masses of a layer, or over some of them, in the step attempted last: the forces on the carrier within
//! it, and the energies.

use std::ops::Range;

use super::carrier_sums::CarrierSums;
use super::dense::DenseOutput;
use super::dense_weights::DenseWorkspace;
use super::energy::{EnergySums, Measure};
use super::tableau::MAX_STAGES;
use crate::model::{BoundaryPowers, ByAxis, ChannelEnergies, Forces, Model, State};

/// What is summed over the masses of a layer, or some of them, one after another, in the step attempted last.
#[derive(Clone, Debug)]
pub struct LayerSums {
    /// The masses.
    pub masses: Range<usize>,
    carrier: CarrierSums,
    energy: EnergySums,
    /// Their powers through the surface and the carrier at the stages, where energies are tracked.
    exchange: [BoundaryPowers; MAX_STAGES],
}

impl LayerSums {
    /// Workspace for the masses of `part`, those from `first` on in a layer.
    pub fn new(part: &Model, first: usize) -> Self {
        Self {
            masses: first..first + part.masses(),
            carrier: CarrierSums::new(part),
            energy: EnergySums::new(part),
            exchange: [BoundaryPowers::default(); MAX_STAGES],
        }
    }

    /// Another step is attempted, in which the masses have these powers through the surface and the carrier at the
    /// stages.
    pub(super) fn begin(&mut self, exchange: &[BoundaryPowers; MAX_STAGES]) {
        self.carrier.invalidate();
        self.energy.invalidate();
        self.exchange = *exchange;
    }

    /// The masses are now those of `part` from `first` on, in another `step`.
    pub fn begin_part(&mut self, step: &mut LayerStep<'_>, part: &Model, first: usize) {
        self.masses = first..first + part.masses();
        self.carrier.invalidate();
        self.energy.invalidate();
        if step.dense.values.tracks_energy {
            self.set_exchange(step, part);
        }
    }

    fn set_exchange(&mut self, step: &mut LayerStep<'_>, part: &Model) {
        let at_start = self.on_carrier(step, part, 0.0);
        let (values, masses) = (step.dense.values, self.masses.clone());
        let [vertical, horizontal, ..] = &step.dense.end_forces().link.0;
        let sum = |links: &[f64]| links.get(masses.clone()).map_or(0.0, |part| part.iter().sum());
        let between = values.link_forces.iter().map(|[x, z]| ByAxis { x: sum(x), z: sum(z) });
        let at_end = ByAxis { x: sum(horizontal), z: sum(vertical) };
        let on_carrier = std::iter::once(at_start).chain(between).chain(std::iter::once(at_end));
        let stages = step.dense.stages().iter().zip(step.dense.carriers());
        for ((exchange, on_carrier), (rates, carrier)) in self.exchange.iter_mut().zip(on_carrier).zip(stages) {
            let [v_x, v_z, normal] =
                [&rates.velocity_x, &rates.velocity_z, &rates.normal].map(|of| &of[masses.clone()]);
            let modes = &step.dense.start.mode[masses.clone()];
            *exchange = BoundaryPowers::from_forces(part, modes, (v_x, v_z, normal), carrier, on_carrier);
        }
    }

    /// F_x and F_z of the masses, of `part`, at the fraction `theta` of `step`, N.
    pub fn on_carrier(&mut self, step: &mut LayerStep<'_>, part: &Model, theta: f64) -> ByAxis<f64> {
        let (dense, workspace) = step.restricted_to(&self.masses);
        let measured = |_: &State, forces: &Forces| ByAxis::from_fn(|axis| forces.on_carrier(axis));
        if let Some(on_carrier) = dense.of_measured_layer(theta, workspace, measured) {
            return on_carrier;
        }
        let (ends, heights) = ((dense.start, dense.end()), dense.method.scheme.contact_heights());
        self.carrier.collect(dense.model, &dense.masses, ends, dense.stages(), heights);
        let motion = dense.summed_motion(theta, &self.carrier, workspace);
        let point = dense.carrier.at(dense.span.at(theta));
        self.carrier.forces(part, &motion, &point, |row| *workspace.element_weights(row))
    }

    /// Energies of the masses through the channels up to the fraction `theta` of `step`, J.
    pub fn energies(&mut self, step: &DenseOutput<'_>, theta: f64) -> ChannelEnergies {
        let coefficients = step.method.coefficients;
        let weights =
            if theta < 1.0 { &coefficients.continuous_weights.at(theta) } else { coefficients.tableau.weights() };
        self.energy.energies(
            &step.restricted_to(self.masses.clone()),
            &self.exchange,
            weights,
            Measure::Integral(theta),
        )
    }

    /// P_diss of the masses at the fraction `theta` of `step`, by the powers at its stages, W.
    pub fn dissipated_power(&mut self, step: &DenseOutput<'_>, theta: f64) -> f64 {
        let (weights, step) = (step.interpolation().values(theta), step.restricted_to(self.masses.clone()));
        let energies = self.energy.energies(&step, &self.exchange, &weights, Measure::Value(theta));
        // Powers that fall steeply through a step have combinations below 0.
        (energies.dissipated() / step.span.length).max(0.0)
    }
}

/// The step of a layer that its integrator has attempted last.
#[derive(Debug)]
pub struct LayerStep<'a> {
    /// The step.
    pub dense: DenseOutput<'a>,
    /// Workspace for all masses of the layer.
    pub workspace: &'a mut DenseWorkspace,
}

impl<'a> LayerStep<'a> {
    /// The dense output of these masses, and the workspace for it.
    pub fn restricted_to(&mut self, masses: &Range<usize>) -> (DenseOutput<'a>, &mut DenseWorkspace) {
        (self.dense.restricted_to(masses.clone()), self.workspace)
    }
}

/// What replaces some of the masses of an interpolated state.
pub trait Overlay: std::fmt::Debug {
    /// Writes those masses at the time `s` after the start of the carrier's segment (s) into `state`, of the layer of
    /// `model`.
    fn write(&mut self, model: &Model, state: &mut State, s: f64);
}

/// The layer at one fraction of the step tried last, and where its state and forces there are to be written.
#[derive(Debug)]
pub struct InterpolatedLayer<'a> {
    /// The step.
    pub step: LayerStep<'a>,
    /// The fraction of the step.
    pub theta: f64,
    /// The state to be written.
    pub state: &'a mut State,
    /// The length and the fraction of the step tried last that this state belongs to; `None` where to another.
    pub state_at: &'a mut Option<(f64, f64)>,
    /// The forces to be written.
    pub forces: &'a mut Forces,
    /// What replaces some masses in it.
    pub overlay: Option<&'a mut dyn Overlay>,
}

impl<'a> InterpolatedLayer<'a> {
    /// Writes the state.
    pub fn interpolate(&mut self) {
        let LayerStep { dense, workspace } = &mut self.step;
        let at = Some((dense.span.length, self.theta));
        if *self.state_at == at {
            return;
        }
        *self.state_at = at;
        dense.state_at(self.theta, workspace, self.state);
        if let Some(overlay) = &mut self.overlay {
            overlay.write(dense.model, self.state, dense.span.at(self.theta));
        }
    }

    /// Writes the state and the forces in it.
    pub fn evaluate(mut self) -> (&'a State, &'a Forces) {
        self.interpolate();
        let dense = &self.step.dense;
        self.forces.evaluate(dense.model, self.state, &dense.carrier.at(dense.span.at(self.theta)));
        (self.state, self.forces)
    }
}
