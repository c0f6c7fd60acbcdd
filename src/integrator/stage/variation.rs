//! The variation of a solved stage: the same linear system with another right side.

use nalgebra::Vector2;

use super::{StagePoint, StageSolver};
use crate::integrator::rates::Rates;
use crate::integrator::tangent::{CarrierVariation, Slip, Tangent, add, constrained};
use crate::model::{LinkKind, LinkMotion, Mode, Model};

impl StageSolver {
    /// Factors the system at the solution, once for all variations of the stage.
    pub(in crate::integrator) fn factor_at_solution(&mut self, model: &Model, beta: f64) {
        if !self.slips.is_empty() {
            self.assemble_slips(model, beta);
            self.system.factor();
        }
    }

    /// The variation at stage `i`, whose history stands in `tangent.end`: there and in its rates afterwards.
    pub(in crate::integrator) fn vary(
        &mut self,
        model: &Model,
        point: &StagePoint,
        carrier: &CarrierVariation,
        tangent: &mut Tangent,
        (i, rates): (usize, &Rates),
    ) {
        self.vary_forces(model, point.beta, carrier, tangent);
        self.set_right_sides(model, point.beta, tangent, rates);
        self.system.solve();
        self.finish_variation(model, point.beta, carrier, tangent, i);
    }

    /// The variation of the forces with the stage's ẋ, and the free masses' ż, held.
    fn vary_forces(&self, model: &Model, beta: f64, carrier: &CarrierVariation, tangent: &mut Tangent) {
        let held = &mut tangent.held;
        for i in 0..model.masses() {
            let (z, v_z) = match constrained(&self.state, i, tangent.end.x[i], 0.0) {
                Some((z, _, v_z)) => (z, v_z),
                None => (tangent.end.z[i], 0.0),
            };
            held.elongation_x[i] = tangent.end.x[i] - carrier.u;
            held.elongation_z[i] = z - carrier.w;
            held.velocity_z[i] = v_z;
        }
        let motion = held.links(carrier);
        for kind in LinkKind::ALL {
            let law = &self.laws[kind as usize];
            tangent.forces.spring_and_damper(kind, (law.stiffness, law.damping), &motion, &[]);
        }
        for row in &model.rows {
            let weight = row.stiffness * row.relaxation_time / (row.relaxation_time + beta);
            add(&mut tangent.forces.link[row.kind as usize], weight, &tangent.end.maxwell[row.range.clone()]);
        }
        tangent.forces.sum_on_masses();
    }

    fn set_right_sides(&mut self, model: &Model, beta: f64, tangent: &Tangent, rates: &Rates) {
        let inertia = model.mass / beta;
        for i in 0..model.masses() {
            let on_mass = (tangent.forces.on_mass_x[i], tangent.forces.on_mass_z[i]);
            let (v_x, v_z) = (tangent.end.v_x[i], tangent.end.v_z[i]);
            self.system.right[i] = match self.state.mode[i] {
                Mode::Free => Vector2::new(on_mass.0 + inertia * v_x, on_mass.1 + inertia * v_z),
                Mode::Stick => Vector2::zeros(),
                Mode::Forward | Mode::Backward => {
                    let slip = Slip::at(model, &self.state, &self.forces, i, rates.acceleration_x[i]);
                    let varied = slip.variation((tangent.end.x[i], 0.0), on_mass);
                    Vector2::new(varied + inertia * slip.q2() * v_x, 0.0)
                }
            };
        }
    }

    fn finish_variation(
        &mut self,
        model: &Model,
        beta: f64,
        carrier: &CarrierVariation,
        tangent: &mut Tangent,
        stage: usize,
    ) {
        let (end, rates) = (&mut tangent.end, &mut tangent.stages[stage]);
        for i in 0..model.masses() {
            let found = self.system.right[i];
            let history = (end.v_x[i], end.v_z[i]);
            end.x[i] += beta * found.x;
            (end.v_x[i], end.v_z[i]) = (found.x, found.y);
            match constrained(&self.state, i, end.x[i], found.x) {
                Some((z, v_x, v_z)) => (end.z[i], end.v_x[i], end.v_z[i]) = (z, v_x, v_z),
                None => end.z[i] += beta * found.y,
            }
            (rates.v_x[i], rates.v_z[i]) = (end.v_x[i], end.v_z[i]);
            rates.a_x[i] = (end.v_x[i] - history.0) / beta;
            rates.a_z[i] = (end.v_z[i] - history.1) / beta;
        }
        let motion = LinkMotion {
            elongation_x: &end.x,
            elongation_z: &end.z,
            velocity_x: &end.v_x,
            velocity_z: &end.v_z,
            carrier_rates: (carrier.u_rate, carrier.w_rate),
        };
        for kind in LinkKind::ALL {
            tangent.forces.spring_and_damper(kind, (0.0, 0.0), &motion, &[]);
        }
        for row in &model.rows {
            let g = row.relaxation_time / (row.relaxation_time + beta);
            let elongation_rates = &tangent.forces.rate[row.kind as usize];
            let a = end.maxwell[row.range.clone()].iter_mut().zip(&mut rates.maxwell[row.range.clone()]);
            for ((a, rate), elongation_rate) in a.zip(elongation_rates) {
                let found = g * (*a + beta * elongation_rate);
                *rate = (found - *a) / beta;
                *a = found;
            }
        }
    }
}
