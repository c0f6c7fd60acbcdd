//! How the layer follows a target of the carrier: forward sensitivities along the steps' own stages.
//!
//! Over a motion of the carrier of duration h, let one of its displacements end at û + ε: it is moved by ε s/h on the
//! way, and its rate by ε/h. Everything here is the derivative with respect to ε at ε = 0, the modes held.

use crate::model::{Forces, LinkKind, LinkMotion, Mode, Model, RateShear, State, SurfacePoint};

/// Which displacement's target is varied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Target {
    /// That of u.
    U,
    /// That of w.
    W,
}

/// The variation of the layer's state: dimensionless for places, 1/s for velocities.
#[derive(Clone, Debug)]
pub(super) struct Variation {
    /// Of the places ξ_i, in the inertial frame.
    pub x: Vec<f64>,
    /// Of the heights ζ_i.
    pub z: Vec<f64>,
    /// Of ẋ_i.
    pub v_x: Vec<f64>,
    /// Of ż_i.
    pub v_z: Vec<f64>,
    /// Of the Maxwell elements' a.
    pub maxwell: Vec<f64>,
}

/// The variation of the rates at one stage.
#[derive(Clone, Debug)]
pub(super) struct VariationRates {
    pub v_x: Vec<f64>,
    pub v_z: Vec<f64>,
    pub a_x: Vec<f64>,
    pub a_z: Vec<f64>,
    pub maxwell: Vec<f64>,
}

/// The variation of the carrier at one instant.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CarrierVariation {
    pub u: f64,
    pub w: f64,
    pub u_rate: f64,
    pub w_rate: f64,
}

/// The derivative of a run with respect to one target.
#[derive(Clone, Debug)]
pub(super) struct Tangent {
    target: Target,
    /// Duration of the carrier's motion, s.
    duration: f64,
    pub start: Variation,
    /// Of the stage, or of the end of the step; before a stage is solved, what the earlier stages give.
    pub end: Variation,
    pub stages: Vec<VariationRates>,
    pub forces: Forces,
    /// The links' motion with the masses' velocities held.
    pub held: Held,
}

/// Variations of the links' motion while the masses' ẋ do not vary.
#[derive(Clone, Debug)]
pub(super) struct Held {
    pub elongation_x: Vec<f64>,
    pub elongation_z: Vec<f64>,
    /// Always 0.
    velocity_x: Vec<f64>,
    pub velocity_z: Vec<f64>,
}

impl Held {
    fn new(model: &Model) -> Self {
        let zero = vec![0.0; model.masses()];
        Self { elongation_x: zero.clone(), elongation_z: zero.clone(), velocity_x: zero.clone(), velocity_z: zero }
    }

    pub(super) fn links(&self, carrier: &CarrierVariation) -> LinkMotion<'_> {
        LinkMotion {
            elongation_x: &self.elongation_x,
            elongation_z: &self.elongation_z,
            velocity_x: &self.velocity_x,
            velocity_z: &self.velocity_z,
            carrier_rates: (carrier.u_rate, carrier.w_rate),
        }
    }
}

impl Variation {
    fn new(model: &Model) -> Self {
        let zero = vec![0.0; model.masses()];
        let maxwell = vec![0.0; model.maxwell_variables()];
        Self { x: zero.clone(), z: zero.clone(), v_x: zero.clone(), v_z: zero, maxwell }
    }

    fn parts(&mut self) -> [&mut Vec<f64>; 5] {
        [&mut self.x, &mut self.z, &mut self.v_x, &mut self.v_z, &mut self.maxwell]
    }
}

impl Tangent {
    pub(super) fn new(model: &Model, target: Target, stages: usize) -> Self {
        let zero = vec![0.0; model.masses()];
        let rates = VariationRates {
            v_x: zero.clone(),
            v_z: zero.clone(),
            a_x: zero.clone(),
            a_z: zero,
            maxwell: vec![0.0; model.maxwell_variables()],
        };
        Self {
            target,
            duration: 1.0,
            start: Variation::new(model),
            end: Variation::new(model),
            stages: vec![rates; stages],
            forces: Forces::new(model),
            held: Held::new(model),
        }
    }

    /// Numbers that this holds.
    pub(super) fn floats(&self) -> usize {
        let (masses, maxwell) = (self.start.x.len(), self.start.maxwell.len());
        // The start, the end and the stages; forces, their links and what is held.
        (2 + self.stages.len()) * (4 * masses + maxwell) + self.forces.bytes() / size_of::<f64>() + 4 * masses
    }

    /// Begins a motion of `duration` (s): the layer as it stands does not depend on where the carrier will go.
    pub(super) fn begin(&mut self, duration: f64) {
        self.duration = duration;
        for part in self.start.parts() {
            part.fill(0.0);
        }
    }

    /// The carrier's variation `s` seconds after the start of its motion.
    pub(super) fn carrier(&self, s: f64) -> CarrierVariation {
        let (place, rate) = (s / self.duration, 1.0 / self.duration);
        match self.target {
            Target::U => CarrierVariation { u: place, u_rate: rate, ..CarrierVariation::default() },
            Target::W => CarrierVariation { w: place, w_rate: rate, ..CarrierVariation::default() },
        }
    }

    /// What the earlier stages, with these weights, give to a stage of a step of length `h`, into `end`.
    pub(super) fn collect_history(&mut self, h: f64, weights: &[f64]) {
        for (end, start) in self.end.parts().into_iter().zip(self.start.parts()) {
            end.copy_from_slice(start);
        }
        for (stage, weight) in self.stages.iter().zip(weights) {
            let step = h * weight;
            let terms = [&stage.v_x, &stage.v_z, &stage.a_x, &stage.a_z, &stage.maxwell];
            for (sum, term) in self.end.parts().into_iter().zip(terms) {
                add(sum, step, term);
            }
        }
    }

    /// Puts the modes' constraints into the variation at the start of a step, and the rates there.
    pub(super) fn evaluate_rates(
        &mut self,
        model: &Model,
        state: &State,
        forces: &Forces,
        accelerations: &[f64],
        s: f64,
    ) {
        let carrier = self.carrier(s);
        for i in 0..model.masses() {
            let constrained = constrained(state, i, self.start.x[i], self.start.v_x[i]);
            if let Some((z, v_x, v_z)) = constrained {
                (self.start.z[i], self.start.v_x[i], self.start.v_z[i]) = (z, v_x, v_z);
            }
        }
        self.forces_at_start(model, &carrier);
        for i in 0..model.masses() {
            let on_mass = (self.forces.on_mass_x[i], self.forces.on_mass_z[i]);
            let rates = &mut self.stages[0];
            let (x, v_x) = (self.start.x[i], self.start.v_x[i]);
            (rates.v_x[i], rates.v_z[i]) = (v_x, self.start.v_z[i]);
            rates.a_x[i] = match state.mode[i] {
                Mode::Free => on_mass.0 / model.mass,
                Mode::Stick => 0.0,
                Mode::Forward | Mode::Backward => {
                    let slip = Slip::at(model, state, forces, i, accelerations[i]);
                    slip.variation((x, v_x), on_mass) / (model.mass * slip.q2())
                }
            };
            rates.a_z[i] = on_mass.1 / model.mass;
        }
        for row in &model.rows {
            let known = self.start.maxwell[row.range.clone()].iter().zip(&self.forces.rate[row.kind as usize]);
            for (rate, (a, elongation_rate)) in self.stages[0].maxwell[row.range.clone()].iter_mut().zip(known) {
                *rate = elongation_rate - a / row.relaxation_time;
            }
        }
    }

    /// ∂F_x and ∂F_z on the carrier at the start of the next step, `s` seconds after the start of the motion, N/m.
    pub(super) fn carrier_forces(&mut self, model: &Model, s: f64) -> (f64, f64) {
        self.forces_at_start(model, &self.carrier(s));
        (self.forces.on_carrier_x(), self.forces.on_carrier_z())
    }

    /// The variation of all forces of the links in `start`.
    fn forces_at_start(&mut self, model: &Model, carrier: &CarrierVariation) {
        let start = &self.start;
        for i in 0..model.masses() {
            self.held.elongation_x[i] = start.x[i] - carrier.u;
            self.held.elongation_z[i] = start.z[i] - carrier.w;
        }
        let motion = LinkMotion {
            elongation_x: &self.held.elongation_x,
            elongation_z: &self.held.elongation_z,
            velocity_x: &start.v_x,
            velocity_z: &start.v_z,
            carrier_rates: (carrier.u_rate, carrier.w_rate),
        };
        for kind in LinkKind::ALL {
            let law = &model.links[kind as usize];
            self.forces.spring_and_damper(kind, (law.stiffness, law.damping), &motion, &[]);
        }
        for row in &model.rows {
            add(&mut self.forces.link[row.kind as usize], row.stiffness, &start.maxwell[row.range.clone()]);
        }
        self.forces.sum_on_masses();
    }

    /// Takes the step tried last, which ended with stage `last`.
    pub(super) fn accept(&mut self, last: usize) {
        std::mem::swap(&mut self.start, &mut self.end);
        self.stages.swap(0, last);
    }
}

/// sum += factor · term.
pub(super) fn add(sum: &mut [f64], factor: f64, term: &[f64]) {
    for (sum, term) in sum.iter_mut().zip(term) {
        *sum += factor * term;
    }
}

/// The variations of ζ, ẋ and ż that a contact's constraint leaves, given those of ξ and ẋ; `None` for a free mass.
pub(super) fn constrained(state: &State, i: usize, x: f64, v_x: f64) -> Option<(f64, f64, f64)> {
    let (surface, v) = (&state.surface[i], state.velocity_x[i]);
    match state.mode[i] {
        Mode::Free => None,
        Mode::Stick => Some((surface.slope * x, 0.0, 0.0)),
        Mode::Forward | Mode::Backward => {
            Some((surface.slope * x, v_x, surface.slope * v_x + surface.curvature * v * x))
        }
    }
}

/// A slipping mass and what its equation of motion is varied about.
pub(super) struct Slip<'a> {
    model: &'a Model,
    surface: &'a SurfacePoint,
    sigma: f64,
    velocity: f64,
    acceleration: f64,
    on_mass: (f64, f64),
}

impl<'a> Slip<'a> {
    pub(super) fn at(model: &'a Model, state: &'a State, forces: &Forces, i: usize, acceleration: f64) -> Self {
        Self {
            model,
            surface: &state.surface[i],
            sigma: state.mode[i].direction(),
            velocity: state.velocity_x[i],
            acceleration,
            on_mass: (forces.on_mass_x[i], forces.on_mass_z[i]),
        }
    }

    /// q² = 1 + s².
    pub(super) fn q2(&self) -> f64 {
        1.0 + self.surface.slope * self.surface.slope
    }

    /// m q² δẍ by the variations of place and velocity (δx, δẋ) and of the links' forces on the mass (δf_x, δf_z): from
    ///
    ///   m q² ẍ = (1 - σμs) f_x + (s + σμ) f_z - m κ ẋ² (s + σμ) - σ A τ_0 q,
    ///
    /// A τ_0 all of the shear force.
    pub(super) fn variation(&self, (x, v_x): (f64, f64), (f_x, f_z): (f64, f64)) -> f64 {
        let m = self.model.mass;
        let (s, kappa) = (self.surface.slope, self.surface.curvature);
        let sigma_mu = self.sigma * self.model.friction_coefficient;
        let (share_x, share_z) = (1.0 - sigma_mu * s, s + sigma_mu);
        let (ds, dkappa) = (kappa * x, self.surface.third * x);
        let v = self.velocity;
        let centripetal = dkappa * v * v * share_z + 2.0 * kappa * v * v_x * share_z + kappa * v * v * ds;
        share_x * f_x + share_z * f_z + ds * (self.on_mass.1 - sigma_mu * self.on_mass.0)
            - m * (centripetal + 2.0 * s * ds * self.acceleration)
            - self.sigma * self.model.shear_force * s * ds / self.q2().sqrt()
            - self.model.rate_shear.map_or(0.0, |law| self.rate_variation(&law, v_x, s * ds))
    }

    /// δ[σ q B(σ q ẋ)] by δẋ and s δs, where B is what the friction has beyond that at rest.
    fn rate_variation(&self, law: &RateShear, v_x: f64, s_ds: f64) -> f64 {
        let q = self.q2().sqrt();
        let (force, slope) = law.with_slope(self.sigma * q * self.velocity);
        self.sigma * force * s_ds / q + slope * (self.q2() * v_x + self.velocity * s_ds)
    }
}
