//! The weights with which the stages of a step enter the values within it (docs/theory.md, section 5).

use super::interpolation::Velocities;
use super::maxwell::ElementWeights;
use super::method::RungeKutta;
use super::scheme::Scheme;
use super::tableau::StageWeights;
use crate::math::Relaxation;
use crate::model::{ByLink, Forces, MaxwellRow, Model, State};

/// Workspace of [`DenseOutput`](super::DenseOutput): the weights of the stages at one fraction of a step.
#[derive(Clone, Debug)]
pub struct DenseWorkspace {
    /// The scheme and the length of the step and its fraction for which the weights are set; `None` where they are not.
    pub(super) at: Option<(Scheme, f64, f64)>,
    /// Of the stages' values in a value.
    pub(super) values: StageWeights,
    /// Of the stages' rates in a value's change since the start, s.
    pub(super) integral: StageWeights,
    /// By relaxation time.
    pub(super) elements: Vec<ElementWeights>,
    /// By relaxation time: the exact solution over the whole step.
    pub(super) whole: Vec<Relaxation>,
    /// By kind of link: of the stages' elongation rates in the force of all Maxwell elements, N s/m.
    pub(super) of_rate: ByLink<StageWeights>,
    /// Of the masses that are meant: their accelerations in the defect, x and v_x in sums.
    pub(super) of_masses: [Vec<f64>; 2],
    /// The layer and its forces at one fraction, where links are in spatial measure, so that no sums make these.
    pub(super) layer: Option<Box<(State, Forces)>>,
}

impl DenseWorkspace {
    /// Workspace for steps of `model`.
    pub fn new(model: &Model) -> Self {
        Self {
            at: None,
            values: StageWeights::default(),
            integral: StageWeights::default(),
            elements: vec![ElementWeights::default(); model.relaxation_times.len()],
            whole: vec![Relaxation::default(); model.relaxation_times.len()],
            of_rate: ByLink::default(),
            of_masses: [vec![0.0; model.masses()], vec![0.0; model.masses()]],
            layer: model.spatial.map(|_| Box::new((State::new(model), Forces::new(model)))),
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

    /// Sets the weights at the fraction `theta` of a step of length `h` (s) by `method`, unless they are there already.
    pub(super) fn set(&mut self, model: &Model, method: &RungeKutta, h: f64, theta: f64) {
        let at = (method.scheme, h, theta);
        if self.at == Some(at) {
            return;
        }
        let interpolation = &method.coefficients.interpolation;
        self.values = interpolation.values(theta);
        self.integral = interpolation.integral(theta).map(|weight| h * weight);
        match interpolation.velocities() {
            Velocities::Polynomial => self.set_relaxing_elements(model, method, h, theta),
            Velocities::BrokenLine => self.set_linear_elements(method),
        }
        self.of_rate = ByLink::default();
        for row in &model.rows {
            let rates = self.elements[row.time_index].rates;
            for (weight, rate) in self.of_rate[row.kind].iter_mut().zip(rates) {
                *weight += row.stiffness * rate;
            }
        }
        self.at = Some(at);
    }

    /// Lets the elements follow the interpolated rate exactly, less the linear share of the difference at the step's
    /// own end.
    fn set_relaxing_elements(&mut self, model: &Model, method: &RungeKutta, h: f64, theta: f64) {
        let is_other_step = self.at.is_none_or(|(scheme, length, _)| (scheme, length) != (method.scheme, h));
        let relaxations = self.elements.iter_mut().zip(&mut self.whole).zip(&model.relaxation_times);
        for ((elements, whole), tau) in relaxations {
            if is_other_step {
                *whole = Relaxation::new(h / tau, 1.0);
            }
            let here = if theta == 1.0 { *whole } else { Relaxation::new(h / tau, theta) };
            let driven = std::array::from_fn(|power| h * (here.driven[power] - theta * whole.driven[power]));
            elements.ends = [here.decay - theta * whole.decay, theta];
            elements.rates = method.coefficients.interpolation.combined(&driven);
        }
    }

    /// Puts the elements on the broken lines through their elongations at the start, at the first implicit stage and at
    /// the end.
    fn set_linear_elements(&mut self, method: &RungeKutta) {
        let [of_start, of_first, of_end, ..] = self.values;
        for (time_index, elements) in self.elements.iter_mut().enumerate() {
            *elements = method.maxwell.weights_between(time_index, 1, [of_start, of_first, of_end]);
        }
    }
}
