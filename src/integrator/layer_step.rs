//! A step of the layer together with the workspace of its dense output.

use std::ops::Range;

use super::dense::DenseOutput;
use super::dense_weights::DenseWorkspace;
use crate::model::{Forces, Model, State};

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
