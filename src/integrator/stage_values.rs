//! The values at one stage, and the start of a step that goes with them.

use serde::{Deserialize, Serialize};

use super::tolerance::RunningMaxima;
use crate::model::{
    BoundaryPowers, ByAxis, ByLink, CarrierPoint, ContactForces, Forces, LinkKind, MaxwellRow, Mode, Model, SlipCurve,
    State, SurfacePoint, memory_rate,
};

/// The share of an explicit acceleration that friction may take away within the step without the implicit one in its
/// place. Where friction is not steep that share is of the order of the step's length, and the explicit one has the
/// method's order.
const STEEP: f64 = 0.5;

/// The margin of a quantity that has no limit.
pub const NO_LIMIT: f64 = f64::MAX;

/// Velocities, accelerations and contact forces at one stage, which later stages, the error estimate and the search for
/// events use.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StageValues {
    /// ẋ_i, m/s.
    pub velocity_x: Vec<f64>,
    /// ż_i, m/s.
    pub velocity_z: Vec<f64>,
    /// ẍ_i, m/s²; 0 for a sticking mass.
    pub acceleration_x: Vec<f64>,
    /// z̈_i, m/s²; in contact along the surface, s ẍ + κ ẋ².
    pub acceleration_z: Vec<f64>,
    /// ė of the links by kind, m/s; empty where the scene has no such link.
    pub elongation_rate: ByLink<Vec<f64>>,
    /// F_N of the masses in contact, N; [`NO_LIMIT`] for a free one.
    pub normal: Vec<f64>,
    /// F_T v_t/A of the masses that slip, W/m², 0 of the others; empty where friction heats nothing.
    pub heat_flux: Vec<f64>,
    /// v̇_s, the rates of the speeds that the masses remember, m/s²; empty where friction has no memory.
    pub memory_rate: Vec<f64>,
    /// Margin to the next mode change along t: σẋ (m/s) of a slipping mass, T - |f·t| (N) of a sticking one;
    /// [`NO_LIMIT`] for a free mass, and where the scene has no friction.
    pub margin: Vec<f64>,
}

impl StageValues {
    /// Zero rates for the masses and links of `model`.
    pub fn new(model: &Model) -> Self {
        let zeros = || vec![0.0; model.masses()];
        Self {
            velocity_x: zeros(),
            velocity_z: zeros(),
            acceleration_x: zeros(),
            acceleration_z: zeros(),
            elongation_rate: Forces::zeros_by_link(model),
            normal: zeros(),
            heat_flux: if model.flash.is_some() { zeros() } else { Vec::new() },
            memory_rate: vec![0.0; model.memory_variables()],
            margin: zeros(),
        }
    }

    /// Sets the contact forces and margins to those of free masses.
    pub fn clear_contacts(&mut self) {
        self.normal.fill(NO_LIMIT);
        self.heat_flux.fill(0.0);
        self.margin.fill(NO_LIMIT);
    }

    /// Copies `other`; rates of the same model without allocating.
    pub fn copy_from(&mut self, other: &Self) {
        let pairs = [
            (&mut self.velocity_x, &other.velocity_x),
            (&mut self.velocity_z, &other.velocity_z),
            (&mut self.acceleration_x, &other.acceleration_x),
            (&mut self.acceleration_z, &other.acceleration_z),
            (&mut self.normal, &other.normal),
            (&mut self.heat_flux, &other.heat_flux),
            (&mut self.memory_rate, &other.memory_rate),
            (&mut self.margin, &other.margin),
        ];
        for (mine, theirs) in pairs {
            mine.clone_from(theirs);
        }
        for (mine, theirs) in self.elongation_rate.iter_mut().zip(&other.elongation_rate) {
            mine.clone_from(theirs);
        }
    }

    /// Computes the rates that the forces give in `state`: the explicit first stage of a step whose implicit stages
    /// have β = `beta` (s). The carrier is at `profile_position`, m.
    pub fn evaluate(&mut self, model: &Model, state: &State, forces: &Forces, profile_position: f64, beta: f64) {
        self.clear_contacts();
        for i in 0..model.masses() {
            self.evaluate_mass(model, state, forces, profile_position, i);
            // Under a remembered speed friction has a value at the start that says what it does.
            if state.mode[i].slips()
                && model.friction.memory.is_none()
                && let Some(curve) = model.friction.slip_curve(self.normal[i], &state.history(i))
            {
                self.soften(model, &curve, state, i, beta);
            }
        }
        for (mine, rate) in self.elongation_rate.iter_mut().zip(&forces.rate) {
            mine.copy_from_slice(rate);
        }
    }

    /// Replaces the acceleration of slipping mass `i` by the mean one of an implicit step of `beta` (s) with the other
    /// forces held, where the two differ much: friction is then so steep over the speed that its value at the start
    /// says nothing of the step.
    fn soften(&mut self, model: &Model, law: &SlipCurve<'_>, state: &State, i: usize, beta: f64) {
        let (v, surface) = (state.velocity_x[i], &state.surface[i]);
        let per_velocity = state.mode[i].direction() * surface.slope.hypot(1.0);
        let (speed, gain, weight) = (per_velocity * v, per_velocity * self.acceleration_x[i], model.mass / beta);
        let after = law.balance(speed, law.excess(speed) + model.mass * gain, weight);
        let slowed = (law.excess(after) - law.excess(speed)).abs() / model.mass;
        if slowed > STEEP * gain.abs() {
            let mean = (after - speed) / beta;
            self.acceleration_x[i] = mean / per_velocity;
            self.acceleration_z[i] = surface.slope * self.acceleration_x[i] + surface.curvature * v * v;
        }
    }

    /// Computes the rates of mass `i` from the forces in `state`. Its contact force and margin are those of a free mass
    /// before.
    #[inline]
    fn evaluate_mass(&mut self, model: &Model, state: &State, forces: &Forces, profile_position: f64, i: usize) {
        let v = state.velocity_x[i];
        self.velocity_x[i] = v;
        self.velocity_z[i] = state.velocity_z[i];
        if let (Some(rate), Some(way)) = (self.memory_rate.get_mut(i), model.friction.memory) {
            *rate = memory_rate(way, state.tangential_speed(model, i, profile_position), state.memory[i]);
        }
        let on_mass = forces.on_mass(i);
        let mode = state.mode[i];
        if mode == Mode::Free {
            self.acceleration_x[i] = on_mass.x / model.mass;
            self.acceleration_z[i] = on_mass.z / model.mass;
        } else {
            let (surface, history) = (&state.surface[i], state.history(i));
            let contact = ContactForces::new(model, on_mass, v, surface, &history);
            self.acceleration_x[i] = contact.acceleration(model, mode, v, surface, &history);
            self.set_contact(model, i, mode, v, surface, &contact);
            if let Some(flux) = self.heat_flux.get_mut(i) {
                let friction = contact.friction(model, mode, v, &history);
                *flux = if mode.slips() { friction.abs() * (v * contact.q).abs() / model.element_area } else { 0.0 };
            }
        }
    }

    /// Recomputes the rates of mass `i` and of its links from the forces in `state` under the carrier, which is at
    /// `profile_position`, m.
    pub fn refresh(
        &mut self,
        model: &Model,
        state: &State,
        forces: &Forces,
        i: usize,
        (carrier, profile_position): (&CarrierPoint, f64),
    ) {
        (self.normal[i], self.margin[i]) = (NO_LIMIT, NO_LIMIT);
        self.heat_flux.get_mut(i).into_iter().for_each(|flux| *flux = 0.0);
        self.evaluate_mass(model, state, forces, profile_position, i);
        for kind in LinkKind::ALL {
            let (velocity, carrier_rate) = if kind.is_along_x() {
                (&state.velocity_x, carrier.x.speed)
            } else {
                (&state.velocity_z, carrier.z.speed)
            };
            let rate = &mut self.elongation_rate[kind];
            for link in kind.links_on(i, velocity.len()) {
                if let Some(rate) = rate.get_mut(link) {
                    *rate = kind.difference(velocity, carrier_rate, link);
                }
            }
        }
    }

    /// Sets z̈ along the surface, F_N and the margin of mass `i`, in contact in `mode` with the velocity ẋ.
    #[inline]
    pub(super) fn set_contact(
        &mut self,
        model: &Model,
        i: usize,
        mode: Mode,
        velocity_x: f64,
        surface: &SurfacePoint,
        contact: &ContactForces,
    ) {
        self.acceleration_z[i] = surface.slope * self.acceleration_x[i] + surface.curvature * velocity_x * velocity_x;
        self.normal[i] = contact.normal;
        self.margin[i] = match mode {
            Mode::Stick => contact.limit - contact.tangential.abs(),
            _ if model.friction.present => mode.direction() * velocity_x,
            _ => NO_LIMIT,
        };
    }

    /// Ḟ_x and Ḟ_z of the layer on the carrier in `state`, N/s: Ḟ = Σ c ė + d ë + Σ_j c_j (ė - a_j/τ_j) over the links to
    /// the carrier.
    pub fn on_carrier(&self, model: &Model, state: &State, carrier: &CarrierPoint) -> ByAxis<f64> {
        let maxwell = &state.maxwell;
        let of = |kind: LinkKind, acceleration: &[f64], rate_change: f64| {
            let law = &model.links[kind];
            let rate: f64 = self.elongation_rate[kind].iter().sum();
            let damper: f64 = acceleration.iter().map(|a| law.damping * (a - rate_change)).sum();
            let relaxing =
                |row: &MaxwellRow| rate - maxwell[row.range.clone()].iter().sum::<f64>() / row.relaxation_time;
            let elements = model.element_force(kind, relaxing);
            law.stiffness * rate + damper + elements
        };
        ByAxis {
            x: of(LinkKind::Horizontal, &self.acceleration_x, carrier.x.acceleration),
            z: if model.spatial.is_some() {
                self.on_carrier_measured(model, state, carrier.z.acceleration)
            } else {
                of(LinkKind::Vertical, &self.acceleration_z, carrier.z.acceleration)
            },
        }
    }

    /// Ḟ_z of vertical links in spatial measure, Σ L Ḟ + L̇ F, N/s, for this ẅ (m/s²).
    fn on_carrier_measured(&self, model: &Model, state: &State, carrier: f64) -> f64 {
        let (kind, law) = (LinkKind::Vertical, &model.links[LinkKind::Vertical]);
        let of = |(i, &rate): (usize, &f64)| {
            let a = |row: &MaxwellRow| state.maxwell[row.range.start + i];
            let force =
                law.force(state.elongation_z[i], rate) - model.frozen_force(kind, i) + model.element_force(kind, a);
            let change = law.force(rate, self.acceleration_z[i] - carrier)
                + model.element_force(kind, |row| rate - a(row) / row.relaxation_time);
            // L is linear in the positions.
            let lengthens = model.measure(kind, i, &self.velocity_x) - 1.0;
            model.measure(kind, i, &state.elongation_x) * change + lengthens * force
        };
        self.elongation_rate[kind].iter().enumerate().map(of).sum()
    }
}

/// The layer at the start of a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LayerState {
    /// The state.
    pub state: State,
    /// The rates there.
    pub rates: StageValues,
    /// The powers through the surface and the carrier there, W; 0 where energies are not computed.
    pub exchange: BoundaryPowers,
    /// The largest forces and energies so far.
    pub largest: RunningMaxima,
}

impl LayerState {
    /// A layer of `model` at rest and free.
    pub fn new(model: &Model) -> Self {
        let state = State::new(model);
        Self {
            state,
            rates: StageValues::new(model),
            exchange: BoundaryPowers::default(),
            largest: RunningMaxima::default(),
        }
    }

    /// Copies `other`; of the same model without allocating.
    pub fn copy_from(&mut self, other: &Self) {
        self.state.copy_from(&other.state);
        self.rates.copy_from(&other.rates);
        (self.exchange, self.largest) = (other.exchange, other.largest);
    }
}
