//! Powers and energies of the layer. E_in = Δ(T + V) + E_damper + E_maxwell + E_friction + E_impact holds exactly in
//! the model, so its residual in a run is the run's numerical error.

use serde::{Deserialize, Serialize};

use crate::math::dot;
use crate::scene::{Axis, ByAxis};

use super::{
    Carrier, CarrierPoint, ContactForces, Forces, FrictionPower, FrictionShares, LinkKind, Mode, Model, SlipHistory,
    State,
};

/// Power through the channels, W.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Powers {
    /// P_damper = Σ d ė².
    pub damper: f64,
    /// P_maxwell = Σ_j c_j τ_j ẏ_j² = Σ_j c_j a_j²/τ_j.
    pub maxwell: f64,
    /// P_friction = Σ F_T v_t.
    pub friction: f64,
    /// P_in: -F_x u̇ and -F_z ẇ of a prescribed carrier, the power of loads and drives on a body.
    pub input: f64,
}

impl Powers {
    /// The powers in `state` with the forces there.
    pub fn evaluate(model: &Model, state: &State, carrier: &CarrierPoint, forces: &Forces) -> Self {
        Self {
            damper: LinkKind::ALL.map(|kind| damper(model, state, forces, kind)).iter().sum(),
            maxwell: LinkKind::ALL.map(|kind| maxwell(model, state, kind)).iter().sum(),
            friction: FrictionPower::evaluate(model, state, forces).friction(),
            input: input(model, forces, carrier),
        }
    }

    /// Power dissipated in all channels, W. Impacts are instantaneous: they count in the energies alone.
    pub fn dissipated(&self) -> f64 {
        self.damper + self.maxwell + self.friction
    }
}

/// Energy through the channels over a time, J: the integrals of [`Powers`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ChannelEnergies {
    /// E_damper.
    pub damper: f64,
    /// E_maxwell.
    pub maxwell: f64,
    /// E_friction.
    pub friction: f64,
    /// E_shear, the part of E_friction against the shear force.
    pub shear: f64,
    /// E_fine, the part of E_friction by hysteresis of the waves that the profile lacks.
    pub fine: f64,
    /// E_in, of a prescribed carrier into the layer, of loads and drives into a body.
    pub input: f64,
    /// E_c, lost in the dampers from bodies to their drives; no part of the dissipated energy.
    pub carrier: f64,
}

impl ChannelEnergies {
    /// Energy dissipated in all channels, J.
    pub fn dissipated(&self) -> f64 {
        self.damper + self.maxwell + self.friction
    }

    /// Adds an `energy` lost in friction, J, that is shared out to its parts.
    pub fn add_friction(&mut self, energy: f64, shares: FrictionShares) {
        self.friction += energy;
        self.shear += shares.shear * energy;
        self.fine += shares.fine * energy;
    }

    /// Subtracts `other`.
    pub fn subtract(&mut self, other: &Self) {
        self.damper -= other.damper;
        self.maxwell -= other.maxwell;
        self.friction -= other.friction;
        self.shear -= other.shear;
        self.fine -= other.fine;
        self.input -= other.input;
        self.carrier -= other.carrier;
    }

    /// Adds `other`.
    pub fn add(&mut self, other: &Self) {
        self.damper += other.damper;
        self.maxwell += other.maxwell;
        self.friction += other.friction;
        self.shear += other.shear;
        self.fine += other.fine;
        self.input += other.input;
        self.carrier += other.carrier;
    }
}

/// Power through the surface and through the carrier: the part of [`Powers`] that is not the links' own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BoundaryPowers {
    /// P_friction = Σ F_T v_t, W.
    pub friction: f64,
    /// P_shear = Σ (F_T - μ F_N) v_t, W: the part of the shear force.
    pub shear: f64,
    /// P_fine: the part of the hysteresis of the waves that the profile lacks, W.
    pub fine: f64,
    /// P_in: -F_x u̇ and -F_z ẇ of a prescribed carrier, the power of loads and drives on a body, W.
    pub input: f64,
    /// P_c = D (u̇ - u̇_d)² and likewise along z, lost in the dampers from bodies to their drives, W.
    pub carrier: f64,
    /// P_damper and P_maxwell of links in spatial measure, W: by their spacing at the instant, too.
    pub measured: [f64; 2],
}

impl BoundaryPowers {
    /// The powers in `state` with the forces there.
    pub fn evaluate(model: &Model, state: &State, carrier: &CarrierPoint, forces: &Forces) -> Self {
        let measured = LinkKind::ALL.into_iter().filter(|&kind| model.is_measured(kind));
        let powers = measured.map(|kind| [damper(model, state, forces, kind), maxwell(model, state, kind)]);
        let measured = powers.fold([0.0; 2], |sum, power| [sum[0] + power[0], sum[1] + power[1]]);
        let boundary = Self::with_friction(model, &FrictionPower::evaluate(model, state, forces), carrier, forces);
        Self { measured, ..boundary }
    }

    /// The powers where that of friction is known.
    pub fn with_friction(model: &Model, power: &FrictionPower, carrier: &CarrierPoint, forces: &Forces) -> Self {
        Self::with_powers(model, power, input(model, forces, carrier))
    }

    /// The powers of a layer, or of a part of one, whose slipping masses have these modes, velocities along x and z
    /// (m/s) and normal forces (N), and whose links exert the forces `on_carrier` along x and z (N) on a prescribed
    /// carrier.
    pub fn from_forces(
        model: &Model,
        modes: &[Mode],
        (velocity_x, velocity_z, normal): (&[f64], &[f64], &[f64]),
        carrier: &CarrierPoint,
        on_carrier: ByAxis<f64>,
    ) -> Self {
        let mut power = FrictionPower::default();
        for i in (0..modes.len()).filter(|&i| model.friction.present && modes[i].slips() && velocity_x[i] != 0.0) {
            let contact = ContactForces::in_slip(model, normal[i], (velocity_x[i], velocity_z[i]));
            // No part of a layer is computed alone where friction heats the contacts or has a memory.
            let friction = contact.slip(model, modes[i], velocity_x[i], &SlipHistory::default());
            power.add(&model.friction, modes[i], velocity_x[i], &contact, &friction);
        }
        Self::with_powers(model, &power, -(on_carrier.x * carrier.x.speed + on_carrier.z * carrier.z.speed))
    }

    fn with_powers(model: &Model, power: &FrictionPower, input: f64) -> Self {
        Self {
            friction: power.friction(),
            shear: power.shear(&model.friction),
            fine: power.fine(),
            input,
            carrier: 0.0,
            measured: [0.0; 2],
        }
    }

    /// Adds the powers of what acts on the bodies from outside, at the time `s` after the start of the `carrier`'s
    /// segment (s).
    pub fn add_bodies(&mut self, model: &Model, carrier: &Carrier, s: f64, point: &CarrierPoint) {
        for axis in Axis::ALL {
            if let Some((body, outside)) = carrier.outside_at(model, axis, s, point[axis]) {
                self.input += outside.input(body);
                self.carrier += outside.lost(body);
            }
        }
    }
}

fn damper(model: &Model, state: &State, forces: &Forces, kind: LinkKind) -> f64 {
    let damping = model.links[kind].damping;
    if damping == 0.0 { 0.0 } else { damping * square_sum_of(model, state, kind, &forces.rate[kind]) }
}

/// Σ value² of the links of a kind, each by its measure.
fn square_sum_of(model: &Model, state: &State, kind: LinkKind, values: &[f64]) -> f64 {
    if !model.is_measured(kind) {
        return dot(values, values);
    }
    let of = |(link, value): (usize, &f64)| model.measure(kind, link, &state.elongation_x) * value * value;
    values.iter().enumerate().map(of).sum()
}

fn square_sum(values: impl Iterator<Item = f64>) -> f64 {
    values.map(|v| v * v).sum()
}

fn maxwell(model: &Model, state: &State, kind: LinkKind) -> f64 {
    let squares = |row: &super::MaxwellRow| square_sum_of(model, state, kind, &state.maxwell[row.range.clone()]);
    model.rows_of(kind).map(|row| row.stiffness * squares(row) / row.relaxation_time).sum()
}

/// The power of a prescribed carrier into the layer, W. One at rest does no work, whatever the forces.
fn input(model: &Model, forces: &Forces, carrier: &CarrierPoint) -> f64 {
    let along = |axis: Axis| {
        let rate = carrier[axis].speed;
        if rate == 0.0 || model.bodies[axis].is_some() { 0.0 } else { forces.on_carrier(axis) * rate }
    };
    -(along(Axis::X) + along(Axis::Z))
}

/// T = Σ ½ m (ẋ² + ż²), J.
pub fn kinetic_energy(model: &Model, state: &State) -> f64 {
    0.5 * model.mass * (square_sum(state.velocity_x.iter().copied()) + square_sum(state.velocity_z.iter().copied()))
}

/// V = Σ ½ c e² + Σ_j ½ c_j (e - y_j)², J, frozen dashpots included.
pub fn elastic_energy(model: &Model, state: &State) -> f64 {
    let row_energy = |row: &super::MaxwellRow| {
        0.5 * row.stiffness * dot(&state.maxwell[row.range.clone()], &state.maxwell[row.range.clone()])
    };
    let of_kind = |kind: LinkKind| {
        if model.is_measured(kind) {
            return (0..kind.count(model.masses())).map(|link| energy_along_z(model, state, kind, link)).sum();
        }
        spring_energy(model, state, kind) + model.rows_of(kind).map(row_energy).sum::<f64>()
    };
    LinkKind::ALL.map(of_kind).iter().sum()
}

/// ½ c e² + Σ_j ½ c_j (e - y_j)² of the links along z at mass `i`, J, frozen dashpots included.
pub fn vertical_spring_energy_at(model: &Model, state: &State, i: usize) -> f64 {
    let lateral = LinkKind::LateralZ.links_on(i, model.masses());
    let of_lateral: f64 = lateral.map(|link| energy_along_z(model, state, LinkKind::LateralZ, link)).sum();
    energy_along_z(model, state, LinkKind::Vertical, i) + of_lateral
}

/// ½ c e² + Σ_j ½ c_j (e - y_j)² of one link along z by its measure, J.
fn energy_along_z(model: &Model, state: &State, kind: LinkKind, link: usize) -> f64 {
    let e = kind.difference(&state.elongation_z, 0.0, link);
    let (stiffness, of_frozen) = (model.links[kind].stiffness, model.frozen_stiffness[kind]);
    let frozen = if of_frozen == 0.0 { 0.0 } else { e - model.frozen_dashpot(kind, link) };
    let elements = model.element_force(kind, |row| state.maxwell[row.range.start + link].powi(2));
    let energy = 0.5 * ((stiffness - of_frozen) * e * e + of_frozen * frozen * frozen + elements);
    model.measure(kind, link, &state.elongation_x) * energy
}

fn spring_energy(model: &Model, state: &State, kind: LinkKind) -> f64 {
    // ζ is counted from rest, so roughness does not stretch the links between the masses.
    let e = state.elongation(kind.axis());
    springs_energy(model, kind, (0..kind.count(e.len())).map(|link| kind.difference(e, 0.0, link)))
}

/// Σ ½ c e², and ½ c_j (e - y_j)² of the part with frozen dashpots.
fn springs_energy(model: &Model, kind: LinkKind, elongations: impl Iterator<Item = f64> + Clone) -> f64 {
    let (stiffness, frozen) = (model.links[kind].stiffness, model.frozen_stiffness[kind]);
    let whole = 0.5 * (stiffness - frozen) * square_sum(elongations.clone());
    if frozen == 0.0 {
        return whole;
    }
    whole + 0.5 * frozen * square_sum(elongations.zip(model.frozen_dashpots(kind)).map(|(e, y)| e - y))
}
