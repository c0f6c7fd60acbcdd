//! The layer within the step tried last, of either method.

use super::Integrator;
use super::dense::{DenseWorkspace, StepSpan};
use crate::model::{Carrier, Forces, Model, State};

/// What replaces some of the masses of an interpolated state.
pub trait Overlay: std::fmt::Debug {
    /// Writes those masses at the time `s` after the start of the carrier's piece (s) into `state`, of the layer of `model`.
    fn write(&mut self, model: &Model, state: &mut State, s: f64);
}

/// The layer at one fraction of the step tried last, and where its state and forces there are to be written.
#[derive(Debug)]
pub struct LayerWithin<'a> {
    /// The model.
    pub model: &'a Model,
    /// The carrier's motion.
    pub carrier: &'a Carrier,
    /// The state at the start of the step.
    pub start: &'a State,
    /// The step.
    pub span: StepSpan,
    /// Whether it is a time step.
    pub time_step: bool,
    /// The fraction of the step.
    pub theta: f64,
    /// The integrator that has tried the step.
    pub integrator: &'a Integrator,
    /// The weights of its stages.
    pub workspace: &'a mut DenseWorkspace,
    /// The state to be written.
    pub state: &'a mut State,
    /// The length and the fraction of the step tried last that this state belongs to; `None` where to another.
    pub state_at: &'a mut Option<(f64, f64)>,
    /// The forces to be written.
    pub forces: &'a mut Forces,
    /// What replaces some masses in it.
    pub overlay: Option<&'a mut dyn Overlay>,
}

impl<'a> LayerWithin<'a> {
    /// Writes the state.
    pub fn interpolate(&mut self) {
        let at = Some((self.span.length, self.theta));
        if *self.state_at == at {
            return;
        }
        *self.state_at = at;
        let Self { model, carrier, start, span, theta, integrator, .. } = *self;
        if self.time_step {
            integrator.two_stage_maxwell(model, start, theta, &mut self.state.maxwell);
            integrator.two_stage_dense(model, carrier, start, span).state_at(theta, self.state);
        } else {
            integrator.dense(model, carrier, start, span).state_at(theta, self.workspace, self.state);
        }
        if let Some(overlay) = &mut self.overlay {
            overlay.write(model, self.state, span.at(theta));
        }
    }

    /// Writes the state and the forces in it.
    pub fn evaluate(mut self) -> (&'a State, &'a Forces) {
        self.interpolate();
        self.forces.evaluate(self.model, self.state, &self.carrier.at(self.span.at(self.theta)));
        (self.state, self.forces)
    }
}
