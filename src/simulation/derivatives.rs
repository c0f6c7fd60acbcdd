//! Derivatives of the outputs: by the carrier's displacement with the states held, and by time.

use super::Simulation;
use crate::outputs::Variable;

impl Simulation {
    /// Writes into `values` how `variables` follow the carrier when it is moved along x and z by `direction` (m per unit)
    /// and every state is held: places, velocities, dashpots, modes.
    pub fn directional_derivative(&mut self, variables: &[Variable], direction: (f64, f64), values: &mut [f64]) {
        self.with_moment(|moment| moment.differentiate(variables, direction, values));
    }

    /// Ḟ_x and Ḟ_z where the run stands, N/s, as the carrier came there; at the start, as it leaves.
    pub fn force_rates(&mut self) -> (f64, f64) {
        if !self.run.rates_hold {
            self.integrator.begin(&self.model, &self.run.state, &self.run.carrier, self.run.s, &mut self.forces);
        }
        self.integrator.start_rates().on_carrier(&self.model, &self.run.carrier.at(self.run.s))
    }
}
