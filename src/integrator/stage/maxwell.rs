//! The Maxwell elements of a stage: taken out of the linear system before it is solved, found after.

use super::{Rates, StageLaw, StageSolver};
use crate::model::Model;

impl StageSolver {
    /// H and D of every link.
    pub(super) fn condense_maxwell(&mut self, model: &Model, beta: f64) {
        for (law, link) in self.laws.iter_mut().zip(&model.links) {
            *law = StageLaw { stiffness: link.stiffness, damping: link.damping, weight: 0.0 };
        }
        for force in &mut self.history_force {
            force.fill(0.0);
        }
        for row in &model.rows {
            let weight = row.stiffness * row.relaxation_time / (row.relaxation_time + beta);
            self.laws[row.kind as usize].damping += beta * weight;
            let history = &self.history.maxwell[row.range.clone()];
            for (force, a) in self.history_force[row.kind as usize].iter_mut().zip(history) {
                *force += weight * a;
            }
        }
        for law in &mut self.laws {
            law.weight = beta * law.stiffness + law.damping;
        }
    }

    /// a = g (a* + β ė) and ȧ = ė - a/τ, the second by (a - a*)/β, which keeps its digits when τ is short.
    pub(super) fn update_maxwell(&mut self, model: &Model, beta: f64, rates: &mut Rates) {
        let per_beta = 1.0 / beta;
        rates.clear_maxwell_force();
        for row in &model.rows {
            let g = row.relaxation_time / (row.relaxation_time + beta);
            let history = &self.history.maxwell[row.range.clone()];
            let a = &mut self.state.maxwell[row.range.clone()];
            let elongation_rate = &self.forces.rate[row.kind as usize];
            let (rate, force_rate) = rates.maxwell_row(row);
            let known = history.iter().zip(elongation_rate);
            let found = a.iter_mut().zip(rate).zip(force_rate);
            for ((history, elongation_rate), ((a, rate), force_rate)) in known.zip(found) {
                *a = g * (history + beta * elongation_rate);
                *rate = (*a - history) * per_beta;
                *force_rate += row.stiffness * *rate;
            }
        }
    }
}
