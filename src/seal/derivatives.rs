//! How the outputs of a seal change with its inputs, and with time.

use super::run::SealRun;
use super::variables::{SealOutput, SealVariable};

impl SealRun {
    /// How outputs change as u and w (m) and the sealed pressure (Pa) do at once, all states held: along a direction of
    /// these, by a difference.
    pub fn directional_derivative(&mut self, variables: &[SealVariable], direction: [f64; 3], values: &mut [f64]) {
        /// Of the pressure on the lip.
        const BY: f64 = 1e-6;
        let (sealed, w, slips) = (self.state.totals.sealed, self.state.totals.w, self.state.totals.slips);
        let [du, dw, dp] = direction;
        let stiffness = self.seal.file.approach_stiffness.unwrap_or(0.0);
        let largest = self.film.totals.iter().copied().fold(0.0, f64::max);
        let change = dp.abs() + stiffness * dw.abs();
        let mut ends = [const { Vec::new() }; 2];
        let share = if change > 0.0 { BY * largest.max(1.0) / change } else { 0.0 };
        for (end, side) in ends.iter_mut().zip([-0.5, 0.5]) {
            let (sealed, w) = (sealed + side * share * dp, w + side * share * dw);
            self.set_totals(sealed, w);
            self.settle_under(sealed);
            *end = variables.iter().map(|variable| self.value(variable.output)).collect();
        }
        self.set_totals(sealed, w);
        self.settle_under(sealed);
        for (i, value) in values.iter_mut().enumerate().take(variables.len()) {
            *value = if share > 0.0 { (ends[1][i] - ends[0][i]) / share } else { 0.0 };
            if variables[i].output == SealOutput::ForceX && slips == 0.0 {
                *value -= self.seal.file.stiffness.map_or(0.0, |stiffness| stiffness * du);
            }
        }
    }

    /// Ḟ_x and Ḟ_z, N/s, at the rates of the last step; of F_x of a rigid lip `None`.
    pub fn force_rates(&mut self) -> (Option<f64>, f64) {
        let totals = self.state.totals;
        let (w_rate, pressure_rate) = (totals.w_rate, totals.pressure_rate);
        let mut load = [0.0];
        let output = SealVariable::of(SealOutput::ForceZ);
        self.directional_derivative(&[output], [0.0, w_rate, pressure_rate], &mut load);
        (self.seal.file.stiffness.map(|stiffness| -stiffness * (totals.u_rate - totals.speed)), load[0])
    }
}
