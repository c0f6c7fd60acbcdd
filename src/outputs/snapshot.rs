//! A run at one instant: the values of the output variables there, and their directional derivatives.
//!
//! In a directional derivative the carrier is shifted and all states are frozen (see `table`). A shift by δu takes δu
//! from the elongation e of every horizontal link and from a_j = e - y_j of its Maxwell elements, so the link's force
//! changes by -(c + Σ c_j) δu; that of a vertical link likewise with δw. On its mass a link's force counts negative:
//! f_x,i grows by (c + Σ c_j) δu, and the contact forces follow.

use std::cell::{Cell, OnceCell, RefCell};

use super::{Counters, Energies, Monitored, Variable};
use crate::integrator::InterpolatedLayer;
use crate::model::{
    BodyEnergy, Carrier, CarrierPoint, ContactForces, FineContact, Flash, Forces, FrictionShares, LinkKind, MaxwellRow,
    Mode, Model, Powers, State, Tangents, elastic_energy, kinetic_energy,
};
use crate::scene::{Axis, ByAxis};

/// The layer's state and the forces in it. Within a step they are computed when they are first asked for: F_x, F_z and
/// the energies do without.
#[derive(Debug)]
pub struct LayerView<'a> {
    known: Cell<(&'a State, &'a Forces)>,
    /// The layer that is still to be computed in place of the known one.
    within: RefCell<Option<InterpolatedLayer<'a>>>,
}

impl<'a> LayerView<'a> {
    /// The layer as it stands.
    pub(crate) fn at(state: &'a State, forces: &'a Forces) -> Self {
        Self { known: Cell::new((state, forces)), within: RefCell::new(None) }
    }

    /// The layer within a step.
    pub(crate) fn within(within: InterpolatedLayer<'a>) -> Self {
        let end = (within.step.dense.end(), within.step.dense.end_forces());
        Self { known: Cell::new(end), within: RefCell::new(Some(within)) }
    }

    fn get(&self) -> (&'a State, &'a Forces) {
        if let Some(within) = self.within.take() {
            self.known.set(within.evaluate());
        }
        self.known.get()
    }
}

/// A run at one instant.
#[derive(Debug)]
pub struct Snapshot<'a> {
    /// The model.
    pub model: &'a Model,
    /// The time, s.
    pub time: f64,
    /// F_x and F_z, N.
    pub on_carrier: ByAxis<f64>,
    /// P_diss, W, where it is known without the layer.
    pub dissipated_power: Option<f64>,
    /// The layer's state and the forces in it.
    pub layer: LayerView<'a>,
    /// The carrier's rates.
    pub carrier: CarrierPoint,
    /// The carrier's motion, and the time since the start of its segment, s.
    pub motion: (&'a Carrier, f64),
    /// Displacement of the carrier: u and w, m.
    pub displacement: ByAxis<f64>,
    /// u and w at the start of the run, m.
    pub start: ByAxis<f64>,
    /// Energies since the start.
    pub energies: Energies,
    /// The derivatives by the targets of the last motion.
    pub tangents: Tangents,
    /// The solver's counters.
    pub counters: Counters,
    /// Processor time since the start, s.
    pub run_time: f64,
}

/// A snapshot with the sums that several outputs need: each is evaluated once, when it is first asked for.
#[derive(Debug)]
pub(super) struct Evaluation<'a, 's> {
    pub(super) at: &'a Snapshot<'s>,
    contact_sums: OnceCell<ContactSums>,
    kinetic_energy: OnceCell<f64>,
    elastic_energy: OnceCell<f64>,
}

/// Sums over the masses in contact, forces in N.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ContactSums {
    pub(super) hysteresis: f64,
    pub(super) adhesion: f64,
    /// The part of the adhesion that is shear force.
    pub(super) shear: f64,
    /// The part of the hysteresis that is of the waves that the profile lacks.
    pub(super) fine: f64,
    pub(super) force_z: f64,
    /// Area that touches, m².
    pub(super) real_area: f64,
}

impl<'a, 's> Evaluation<'a, 's> {
    fn new(at: &'a Snapshot<'s>) -> Self {
        let (kinetic_energy, elastic_energy) = (OnceCell::new(), OnceCell::new());
        Self { at, contact_sums: OnceCell::new(), kinetic_energy, elastic_energy }
    }

    pub(super) fn contact_sums(&self) -> &ContactSums {
        self.contact_sums.get_or_init(|| self.at.contact_sums())
    }

    /// T, J.
    pub(super) fn kinetic_energy(&self) -> f64 {
        *self.kinetic_energy.get_or_init(|| kinetic_energy(self.at.model, self.at.state()))
    }

    /// V, J.
    pub(super) fn elastic_energy(&self) -> f64 {
        *self.elastic_energy.get_or_init(|| elastic_energy(self.at.model, self.at.state()))
    }

    /// E_in - Δ(T + V + T_c + V_c) - E_diss - E_c, J.
    pub(super) fn energy_residual(&self) -> f64 {
        let energies = &self.at.energies;
        let gained = self.kinetic_energy() + self.elastic_energy() + self.at.body_energy().total() - energies.initial;
        energies.channels.input - gained - energies.dissipated() - energies.channels.carrier
    }
}

impl<'a> Snapshot<'a> {
    /// The residual of the energy balance over the largest of the energies in it; 0 where there are none.
    pub fn relative_energy_residual(&self) -> f64 {
        let now = Evaluation::new(self);
        let stored = now.kinetic_energy() + now.elastic_energy() + self.body_energy().total();
        let largest = self.energies.largest().max(self.energies.initial).max(stored);
        if largest > 0.0 { now.energy_residual().abs() / largest } else { 0.0 }
    }

    /// The layer's state.
    pub fn state(&self) -> &'a State {
        self.layer.get().0
    }

    /// The forces in that state.
    pub fn forces(&self) -> &'a Forces {
        self.layer.get().1
    }

    /// Writes the values of `variables`, in their order, into `values`; Integers as whole numbers. What no variable
    /// asks for is not computed.
    pub fn evaluate(&self, variables: &[Variable], values: &mut [f64]) {
        let now = Evaluation::new(self);
        for (variable, value) in variables.iter().zip(values) {
            *value = variable.row.value(&now, variable.mass);
        }
    }

    /// Writes into `values` the derivatives of `variables`, in their order, with the carrier shifted along x and z by
    /// `direction` (m per unit) and all states frozen.
    pub fn differentiate(&self, variables: &[Variable], direction: (f64, f64), values: &mut [f64]) {
        let (now, shift) = (Evaluation::new(self), CarrierShift::new(self.model, direction));
        for (variable, value) in variables.iter().zip(values) {
            *value = variable.row.derivative(&now, variable.mass, &shift);
        }
    }

    /// The quantities whose error is estimated; E_diss where it is `tracked`.
    pub(crate) fn monitored(&self, tracked: bool) -> Monitored {
        Monitored {
            forces: [self.on_carrier.x, self.on_carrier.z],
            ways: self.ways(),
            dissipated: tracked.then(|| self.energies.dissipated()),
        }
    }

    /// How far bodies are from their start along x and z, m; 0 where the displacement is prescribed.
    pub fn ways(&self) -> [f64; 2] {
        let way = |axis| self.model.bodies[axis].as_ref().map_or(0.0, |_| self.displacement[axis] - self.start[axis]);
        Axis::ALL.map(way)
    }

    pub(super) fn dissipated_power(&self) -> f64 {
        let powers = || Powers::evaluate(self.model, self.state(), &self.carrier, self.forces());
        self.dissipated_power.unwrap_or_else(|| powers().dissipated())
    }

    /// R, the drive's force on the body along `axis`, N; 0 without one.
    pub(super) fn drive_force(&self, axis: Axis) -> f64 {
        let (carrier, s) = self.motion;
        carrier.outside(self.model, axis, s).map_or(0.0, |(body, outside)| outside.drive_force(body))
    }

    /// The energies of the bodies.
    pub(super) fn body_energy(&self) -> BodyEnergy {
        let (carrier, s) = self.motion;
        if carrier.has_bodies() { carrier.energy(self.model, s) } else { BodyEnergy::default() }
    }

    /// |F_x|/F_z, 0 where F_z ≤ 0; at most the largest number where F_z is next to nothing.
    pub(super) fn friction_coefficient(&self) -> f64 {
        let normal = self.on_carrier.z;
        if normal > 0.0 { (self.on_carrier.x.abs() / normal).min(f64::MAX) } else { 0.0 }
    }

    /// The number of masses whose mode passes `test`.
    pub(super) fn count(&self, test: fn(Mode) -> bool) -> f64 {
        self.state().mode.iter().filter(|&&mode| test(mode)).count() as f64
    }

    /// The flash temperature of mass `i`, K.
    pub(super) fn flash(&self, i: usize) -> f64 {
        self.state().flash(i)
    }

    /// The largest flash temperature of all masses, K.
    pub(super) fn flash_largest(&self) -> f64 {
        (0..self.model.masses()).map(|i| self.flash(i)).fold(0.0, f64::max)
    }

    /// The mean one of the masses in contact, K; 0 where there are none.
    pub(super) fn flash_mean(&self) -> f64 {
        let modes = &self.state().mode;
        let in_contact = || (0..modes.len()).filter(|&i| modes[i].in_contact());
        let count = in_contact().count();
        if count > 0 { in_contact().map(|i| self.flash(i)).sum::<f64>() / count as f64 } else { 0.0 }
    }

    /// Heat that the rubber has taken from friction since the start, J.
    pub(super) fn heat(&self) -> f64 {
        self.model.flash.as_ref().map_or(0.0, |kernel| kernel.share * self.energies.channels.friction)
    }

    /// Position of mass `i` along x and z, m.
    pub(super) fn position(&self, i: usize) -> (f64, f64) {
        (
            self.model.rest_x[i] + (self.displacement.x + self.state().elongation_x[i]),
            self.model.rest_z[i] + (self.displacement.z + self.state().elongation_z[i]),
        )
    }

    /// F_N on mass `i`, N; 0 where it is free.
    pub(super) fn normal_force(&self, i: usize) -> f64 {
        self.contact(i).map_or(0.0, |contact| contact.normal)
    }

    /// F_T on mass `i` against v_t, N; 0 where it is free.
    pub(super) fn friction_force(&self, i: usize) -> f64 {
        let motion = (self.state().mode[i], self.state().velocity_x[i]);
        self.contact(i).map_or(0.0, |contact| self.friction(motion, &contact, self.state().flash(i)))
    }

    /// The surface pushes a mass with F_N n - F_T t, n = (-s, 1)/q, t = (1, s)/q (6), (7).
    fn contact_sums(&self) -> ContactSums {
        let (state, forces) = (self.state(), self.forces());
        let mut sums = ContactSums::default();
        for i in (0..state.mode.len()).filter(|&i| state.mode[i].in_contact()) {
            let (mode, v, surface) = (state.mode[i], state.velocity_x[i], &state.surface[i]);
            let contact = forces.contact(self.model, i, v, surface);
            let s = surface.slope;
            let friction = self.friction((mode, v), &contact, state.flash(i));
            let flash = state.flash(i);
            let fine = self.model.friction.fine_contact(contact.normal, v * contact.q, flash);
            let parts = self.parts(mode, &contact, &fine, friction);
            sums.hysteresis -= contact.normal * s / contact.q + parts.fine / contact.q;
            sums.fine -= parts.fine / contact.q;
            sums.adhesion -= (friction - parts.fine) / contact.q;
            sums.shear -= parts.shear / contact.q;
            sums.real_area += fine.share.value * self.model.element_area;
            sums.force_z += (contact.normal - friction * s) / contact.q;
        }
        sums
    }

    /// The forces in the contact at mass `i`; `None` where it is free.
    fn contact(&self, i: usize) -> Option<ContactForces> {
        let v = self.state().velocity_x[i];
        self.state().mode[i].in_contact().then(|| self.forces().contact(self.model, i, v, &self.state().surface[i]))
    }

    /// F_T (N) in a `contact` of this mode and ẋ (m/s), at the flash temperature `flash`, K.
    fn friction(&self, (mode, v): (Mode, f64), contact: &ContactForces, flash: f64) -> f64 {
        if self.model.friction.present { contact.friction(self.model, mode, v, flash) } else { 0.0 }
    }

    /// The parts of the `friction` in a `contact` (N), N: of a sticking mass, as the parts of the largest friction at rest
    /// share it.
    fn parts(&self, mode: Mode, contact: &ContactForces, fine: &FineContact, friction: f64) -> FrictionShares {
        let law = &self.model.friction;
        match mode {
            Mode::Stick => {
                let shares = law.shares_at_rest(contact.normal);
                FrictionShares { shear: shares.shear * friction, fine: shares.fine * friction }
            }
            _ if law.present => {
                let (sigma, hysteresis) = (mode.direction(), fine.hysteresis.value);
                let shear = friction - sigma * law.coulomb * contact.normal - sigma * hysteresis;
                FrictionShares { shear, fine: sigma * hysteresis }
            }
            _ => FrictionShares::default(),
        }
    }

    /// The mode of mass `i`; without friction a contact slips in the direction of its velocity.
    pub(super) fn mode(&self, i: usize) -> Mode {
        match self.state().mode[i] {
            mode if mode.slips() && !self.model.friction.present => Mode::along(self.state().velocity_x[i]),
            mode => mode,
        }
    }
}

/// A shift of the carrier: the changes that it makes in each link to it and on each mass.
#[derive(Clone, Copy, Debug)]
pub(super) struct CarrierShift {
    /// Of the elongations of the links to the carrier, m.
    elongation: ByAxis<f64>,
    /// Of the forces of the links on each mass, N.
    on_mass: ByAxis<f64>,
    /// Of the drives' displacements, m.
    drive: ByAxis<f64>,
}

impl CarrierShift {
    /// A shift of u and w by (δu, δw), m; along the axis of a body it shifts the drive, and the layer not at all.
    pub(super) fn new(model: &Model, direction: (f64, f64)) -> Self {
        let change = ByAxis { x: direction.0, z: direction.1 };
        let of_layer = ByAxis::from_fn(|axis| if model.bodies[axis].is_some() { 0.0 } else { change[axis] });
        Self {
            elongation: of_layer.map(|change| -change),
            on_mass: ByAxis::from_fn(|axis| model.instantaneous_stiffness(axis.link()) * of_layer[axis]),
            drive: ByAxis::from_fn(|axis| if model.bodies[axis].is_some() { change[axis] } else { 0.0 }),
        }
    }
}

/// Changes of the forces in a contact, N, and the slope there.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ContactChange {
    pub(super) normal: f64,
    pub(super) friction: f64,
    /// Of the part of the friction that is shear force.
    shear: f64,
    /// Of the part by hysteresis of the waves that the profile lacks.
    fine: f64,
    /// Of the area that touches, m².
    real_area: f64,
    slope: f64,
    q: f64,
}

impl ContactChange {
    pub(super) fn hysteresis(self) -> f64 {
        -self.normal * self.slope / self.q - self.fine / self.q
    }

    pub(super) fn fine(self) -> f64 {
        -self.fine / self.q
    }

    pub(super) fn adhesion(self) -> f64 {
        -(self.friction - self.fine) / self.q
    }

    pub(super) fn shear(self) -> f64 {
        -self.shear / self.q
    }

    pub(super) fn coulomb(self) -> f64 {
        -(self.friction - self.fine - self.shear) / self.q
    }

    pub(super) fn real_area(self) -> f64 {
        self.real_area
    }

    pub(super) fn force_x(self) -> f64 {
        self.hysteresis() + self.adhesion()
    }

    pub(super) fn force_z(self) -> f64 {
        (self.normal - self.friction * self.slope) / self.q
    }
}

/// The directional derivatives.
impl Snapshot<'_> {
    /// δF_x = -k (c + Σ c_j) δu of the horizontal links, δF_z likewise of the vertical ones.
    pub(super) fn force_changes(&self, shift: &CarrierShift) -> ByAxis<f64> {
        let k = self.model.masses() as f64;
        shift.on_mass.map(|change| -k * change)
    }

    /// δR = K δu_d of the drive along `axis`.
    pub(super) fn drive_force_change(&self, axis: Axis, shift: &CarrierShift) -> f64 {
        let body = &self.model.bodies[axis];
        body.as_ref().map_or(0.0, |body| body.stiffness * shift.drive[axis])
    }

    /// Of V_c = ½ K (u - u_d)² of both axes.
    pub(super) fn drive_energy_change(&self, shift: &CarrierShift) -> f64 {
        let (carrier, s) = self.motion;
        let of = |axis: Axis| {
            let stretch = carrier.outside(self.model, axis, s).map_or(0.0, |(_, outside)| outside.stretch().position);
            -self.drive_force_change(axis, shift) * stretch
        };
        of(Axis::X) + of(Axis::Z)
    }

    /// Of |F_x|/F_z; 0 where F_x = 0, the kink of |F_x|.
    pub(super) fn friction_coefficient_change(&self, shift: &CarrierShift) -> f64 {
        let ByAxis { x, z } = self.on_carrier;
        if z <= 0.0 || x == 0.0 {
            return 0.0;
        }
        let ByAxis { x: dx, z: dz } = self.force_changes(shift);
        (x.signum() * dx - x.abs() * dz / z) / z
    }

    /// δF_N = (s δf_x - δf_z)/q; δF_T = (δf_x + s δf_z)/q where the mass sticks, σ ∂T/∂F_N δF_N where it slips.
    pub(super) fn contact_change(&self, i: usize, shift: &CarrierShift) -> ContactChange {
        let mode = self.state().mode[i];
        if !mode.in_contact() {
            return ContactChange { q: 1.0, ..ContactChange::default() };
        }
        let slope = self.state().surface[i].slope;
        let q = (1.0 + slope * slope).sqrt();
        let ByAxis { x: f_x, z: f_z } = shift.on_mass;
        let normal = (slope * f_x - f_z) / q;
        let contact = self.forces().contact(self.model, i, self.state().velocity_x[i], &self.state().surface[i]);
        let (law, v) = (&self.model.friction, self.state().velocity_x[i]);
        let flash = self.state().flash(i);
        let by_normal = law.slip(contact.normal, v.abs() * q, Flash::held(flash)).by_normal;
        let on_fine = law.fine_contact(contact.normal, v * contact.q, flash);
        let (friction, shear, fine) = match mode {
            Mode::Stick => {
                let friction = (f_x + slope * f_z) / q;
                let shares = law.shares_at_rest(contact.normal);
                let changes = law.shares_by_normal(contact.normal, by_normal);
                let part = |share: f64, change: f64| share * friction + contact.tangential * change * normal;
                (friction, part(shares.shear, changes.shear), part(shares.fine, changes.fine))
            }
            _ => {
                let (sigma, of_fine) = (mode.direction(), on_fine.hysteresis.by_normal);
                let of_shear = by_normal - law.coulomb - of_fine;
                (sigma * by_normal * normal, sigma * of_shear * normal, sigma * of_fine * normal)
            }
        };
        let real_area = on_fine.share.by_normal * normal * self.model.element_area;
        ContactChange { normal, friction, shear, fine, real_area, slope, q }
    }

    pub(super) fn contact_sum(&self, shift: &CarrierShift, part: impl Fn(ContactChange) -> f64) -> f64 {
        (0..self.model.masses()).map(|i| part(self.contact_change(i, shift))).sum()
    }

    /// Of Σ F_T v_t with v_t = ẋ q frozen.
    pub(super) fn friction_power_change(&self, shift: &CarrierShift) -> f64 {
        let power = |i| {
            let contact = self.contact_change(i, shift);
            contact.friction * self.state().velocity_x[i] * contact.q
        };
        (0..self.model.masses()).map(power).sum()
    }

    /// Of Σ_j c_j a_j²/τ_j.
    pub(super) fn maxwell_power_change(&self, shift: &CarrierShift) -> f64 {
        self.maxwell_sum(shift, |row| 2.0 * row.stiffness / row.relaxation_time)
    }

    /// Of V = Σ ½ c e² + Σ_j ½ c_j a_j², where a_j = e - y_j of frozen dashpots.
    pub(super) fn elastic_energy_change(&self, shift: &CarrierShift) -> f64 {
        let spring = |axis: Axis| {
            let (kind, elongations) = (axis.link(), self.state().elongation(axis));
            let stiffness = self.model.links[kind].stiffness;
            let force = stiffness * elongations.iter().sum::<f64>() - self.model.frozen_force_sum(kind);
            shift.elongation[axis] * force
        };
        spring(Axis::X) + spring(Axis::Z) + self.maxwell_sum(shift, |row| row.stiffness)
    }

    /// Σ weight a δa over the Maxwell elements of the links to the carrier.
    fn maxwell_sum(&self, shift: &CarrierShift, weight: impl Fn(&MaxwellRow) -> f64) -> f64 {
        let moved = |kind: LinkKind| if kind.is_lateral() { 0.0 } else { shift.elongation[kind.axis()] };
        let of_row = |row: &MaxwellRow| {
            weight(row) * moved(row.kind) * self.state().maxwell[row.range.clone()].iter().sum::<f64>()
        };
        self.model.rows.iter().map(of_row).sum()
    }
}
