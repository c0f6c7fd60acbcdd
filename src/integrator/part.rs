//! A part of the layer in the step that the layer's integrator has attempted last.

use std::ops::Range;

use super::Integrator;
use super::carrier_sums::CarrierSums;
use super::dense::{DenseOutput, DenseWorkspace, StepSpan};
use super::energy::{MassesInStep, StepSums, SummedStep};
use super::tableau::STAGES;
use crate::model::{BoundaryPowers, ByAxis, Carrier, ChannelEnergies, Model, State};

/// The event-driven step of the whole layer that its integrator has attempted last.
#[derive(Debug)]
pub struct WholeLayer<'a> {
    /// The integrator.
    pub integrator: &'a Integrator,
    /// The layer's model.
    pub model: &'a Model,
    /// The carrier's motion.
    pub carrier: &'a Carrier,
    /// The state at the start of the step.
    pub start: &'a State,
    /// The step.
    pub span: StepSpan,
    /// Workspace for all masses of the layer.
    pub workspace: &'a mut DenseWorkspace,
}

impl<'a> WholeLayer<'a> {
    /// The dense output of these masses, and the workspace for it.
    pub fn dense(&mut self, masses: &Range<usize>) -> (DenseOutput<'a>, &mut DenseWorkspace) {
        let step = self.integrator.dense(self.model, self.carrier, self.start, self.span);
        (step.restricted_to(masses.clone()), self.workspace)
    }

    /// The fraction of the step at the time `s` after the start of the carrier's piece.
    pub fn theta(&self, s: f64) -> f64 {
        (s - self.span.start) / self.span.length
    }
}

/// What is summed over some masses of a layer, one after another, in the step attempted last.
#[derive(Clone, Debug)]
pub struct PartSums {
    /// The masses.
    pub masses: Range<usize>,
    carrier_sums: CarrierSums,
    energy_sums: StepSums,
    /// Their powers through the surface and the carrier at the stages, where energies are tracked.
    exchange: [BoundaryPowers; STAGES],
}

impl PartSums {
    /// Workspace for the masses of `part`, those from `first` on in a layer.
    pub fn new(part: &Model, first: usize) -> Self {
        Self {
            masses: first..first + part.masses(),
            carrier_sums: CarrierSums::new(part),
            energy_sums: StepSums::new(part),
            exchange: [BoundaryPowers::default(); STAGES],
        }
    }

    /// The masses are now those of `part` from `first` on, in another `step`.
    pub fn begin(&mut self, step: &mut WholeLayer<'_>, part: &Model, first: usize) {
        self.masses = first..first + part.masses();
        self.carrier_sums.forget();
        self.energy_sums.forget();
        if step.integrator.stages.tracks_energy {
            self.set_exchange(step, part);
        }
    }

    fn set_exchange(&mut self, step: &mut WholeLayer<'_>, part: &Model) {
        let (x, z) = self.on_carrier(step, part, 0.0);
        let at_start = ByAxis { x, z };
        let (integrator, masses) = (step.integrator, self.masses.clone());
        let [vertical, horizontal, ..] = &integrator.end_forces().link.0;
        let sum = |links: &[f64]| links.get(masses.clone()).map_or(0.0, |part| part.iter().sum());
        let between = integrator.stages.link_forces.iter().map(|[x, z]| ByAxis { x: sum(x), z: sum(z) });
        let at_end = ByAxis { x: sum(horizontal), z: sum(vertical) };
        let on_carrier = std::iter::once(at_start).chain(between).chain(std::iter::once(at_end));
        let stages = integrator.stages.rates.iter().zip(&integrator.stages.carrier);
        for ((exchange, on_carrier), (rates, carrier)) in self.exchange.iter_mut().zip(on_carrier).zip(stages) {
            let [v_x, v_z, normal] =
                [&rates.velocity_x, &rates.velocity_z, &rates.normal].map(|of| &of[masses.clone()]);
            *exchange = BoundaryPowers::from_forces(
                part,
                &step.start.mode[masses.clone()],
                (v_x, v_z, normal),
                carrier,
                on_carrier,
            );
        }
    }

    /// F_x and F_z of the masses, of `part`, at the fraction `theta` of `step`, N.
    pub fn on_carrier(&mut self, step: &mut WholeLayer<'_>, part: &Model, theta: f64) -> (f64, f64) {
        let (integrator, ends) = (step.integrator, (step.start, step.integrator.end()));
        let stages = &integrator.stages()[..integrator.pair.stages()];
        let heights = integrator.pair.contact_heights();
        self.carrier_sums.collect(step.model, &self.masses, ends, stages, heights);
        let point = step.carrier.at(step.span.at(theta));
        let (dense, workspace) = step.dense(&self.masses);
        let motion = dense.summed_motion(theta, &self.carrier_sums, workspace);
        self.carrier_sums.forces(part, &motion, &point, |row| workspace.of_elements(row))
    }

    /// Energies of the masses through the channels up to the fraction `theta` of `step`, J.
    pub fn energies(&mut self, step: &WholeLayer<'_>, theta: f64) -> ChannelEnergies {
        step.integrator.event_method.energies(self.summed(step), theta)
    }

    /// P_diss of the masses at the fraction `theta` of `step`, by the powers at its stages, W.
    pub fn dissipated_power(&mut self, step: &WholeLayer<'_>, theta: f64) -> f64 {
        let weights = step.integrator.interpolation.values(theta);
        step.integrator.event_method.dissipated_power(self.summed(step), theta, &weights)
    }

    fn summed<'a>(&'a mut self, step: &WholeLayer<'a>) -> SummedStep<'a> {
        let WholeLayer { integrator, model, start, span, .. } = *step;
        let (masses, stages) = (self.masses.clone(), integrator.stages());
        let of = MassesInStep { model, masses, start, stages, h: span.length };
        SummedStep { of, sums: &mut self.energy_sums, exchange: &self.exchange }
    }
}
