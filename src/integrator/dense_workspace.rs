//! Where the weights are kept with which the stages of a step enter the values within it.

use super::maxwell::ElementWeights;
use super::scheme::Scheme;
use super::tableau::Weights;
use crate::math::Relaxation;
use crate::model::{ByLink, MaxwellRow, Model};

/// Workspace of [`DenseOutput`](super::DenseOutput): the weights of the stages at one fraction of a step.
#[derive(Clone, Debug)]
pub struct DenseWorkspace {
    /// The scheme and the length of the step and its fraction for which the weights are set; `None` where they are not.
    pub(super) at: Option<(Scheme, f64, f64)>,
    /// Of the stages' values in a value.
    pub(super) values: Weights,
    /// Of the stages' rates in a value's change since the start, s.
    pub(super) integral: Weights,
    /// By relaxation time.
    pub(super) elements: Vec<ElementWeights>,
    /// By relaxation time: the exact solution over the whole step.
    pub(super) whole: Vec<Relaxation>,
    /// By kind of link: of the stages' elongation rates in the force of all Maxwell elements, N s/m.
    pub(super) of_rate: ByLink<Weights>,
    /// Of the masses that are meant: their accelerations in the defect, x and v_x in sums.
    pub(super) of_masses: [Vec<f64>; 2],
}

impl DenseWorkspace {
    /// Workspace for steps of `model`.
    pub fn new(model: &Model) -> Self {
        Self {
            at: None,
            values: Weights::default(),
            integral: Weights::default(),
            elements: vec![ElementWeights::default(); model.relaxation_times.len()],
            whole: vec![Relaxation::default(); model.relaxation_times.len()],
            of_rate: ByLink::default(),
            of_masses: [vec![0.0; model.masses()], vec![0.0; model.masses()]],
        }
    }

    /// Workspace for single masses alone, not for [`DenseOutput::defect`](super::DenseOutput::defect) nor for sums over the layer.
    pub fn for_single_masses(model: &Model) -> Self {
        Self { of_masses: [Vec::new(), Vec::new()], ..Self::new(model) }
    }

    /// Forgets the weights: the model has changed.
    pub fn invalidate(&mut self) {
        self.at = None;
    }

    /// The weights of the elements of one row at the fraction for which the weights are set.
    pub(super) fn element_weights(&self, row: &MaxwellRow) -> &ElementWeights {
        &self.elements[row.time_index]
    }
}
