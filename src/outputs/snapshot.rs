//! A run at one instant: the values of the output variables there.

use std::cell::{Cell, OnceCell, RefCell};

use super::accounts::{Counters, Energies, Monitored};
use crate::integrator::InterpolatedLayer;
use crate::model::{
    BodyEnergy, Carrier, CarrierPoint, ContactForces, FineContact, Forces, FrictionShares, Mode, Model, Powers,
    SlipHistory, State, Tangents, elastic_energy, kinetic_energy,
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
    pub(super) fn new(at: &'a Snapshot<'s>) -> Self {
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

    /// The speed that mass `i` remembers, m/s.
    pub(super) fn remembered_speed(&self, i: usize) -> f64 {
        self.state().memory.get(i).copied().unwrap_or(0.0)
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
        self.contact(i).map_or(0.0, |contact| contact.forces.normal)
    }

    /// F_T on mass `i` against v_t, N; 0 where it is free.
    pub(super) fn friction_force(&self, i: usize) -> f64 {
        self.contact(i).map_or(0.0, |contact| contact.friction(self.model))
    }

    /// The surface pushes a mass with F_N n - F_T t, n = (-s, 1)/q, t = (1, s)/q (6), (7).
    fn contact_sums(&self) -> ContactSums {
        let mut sums = ContactSums::default();
        let layer = self.layer.get();
        for contact in (0..self.model.masses()).filter_map(|i| self.contact_in(layer, i)) {
            let ContactForces { normal, q, .. } = contact.forces;
            let friction = contact.friction(self.model);
            let fine = contact.fine(self.model);
            let parts = contact.parts(self.model, &fine, friction);
            sums.hysteresis -= normal * contact.slope / q + parts.fine / q;
            sums.fine -= parts.fine / q;
            sums.adhesion -= (friction - parts.fine) / q;
            sums.shear -= parts.shear / q;
            sums.real_area += fine.share.value * self.model.element_area;
            sums.force_z += (normal - friction * contact.slope) / q;
        }
        sums
    }

    /// The contact at mass `i`; `None` where it is free.
    pub(super) fn contact(&self, i: usize) -> Option<MassContact> {
        self.contact_in(self.layer.get(), i)
    }

    #[inline(always)]
    fn contact_in(&self, (state, forces): (&State, &Forces), i: usize) -> Option<MassContact> {
        let (mode, velocity, surface) = (state.mode[i], state.velocity_x[i], &state.surface[i]);
        mode.in_contact().then(|| MassContact {
            mode,
            velocity,
            slope: surface.slope,
            history: state.history(i),
            forces: forces.contact(self.model, state, i),
        })
    }

    /// The mode of mass `i`; without friction a contact slips in the direction of its velocity.
    pub(super) fn mode(&self, i: usize) -> Mode {
        match self.state().mode[i] {
            mode if mode.slips() && !self.model.friction.present => Mode::along(self.state().velocity_x[i]),
            mode => mode,
        }
    }
}

/// A mass in contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct MassContact {
    pub(super) mode: Mode,
    /// ẋ, m/s.
    pub(super) velocity: f64,
    /// s.
    pub(super) slope: f64,
    /// What its past has left.
    pub(super) history: SlipHistory,
    pub(super) forces: ContactForces,
}

impl MassContact {
    /// F_T, N.
    fn friction(&self, model: &Model) -> f64 {
        let Self { mode, velocity, ref history, .. } = *self;
        if model.friction.present { self.forces.friction(model, mode, velocity, history) } else { 0.0 }
    }

    /// What the roughness below the profile does in it.
    pub(super) fn fine(&self, model: &Model) -> FineContact {
        model.friction.fine_contact(self.forces.normal, self.velocity * self.forces.q, &self.history)
    }

    /// The parts of the `friction` (N), N: of a sticking mass, as the parts of the largest friction at rest share it.
    fn parts(&self, model: &Model, fine: &FineContact, friction: f64) -> FrictionShares {
        let (law, normal) = (&model.friction, self.forces.normal);
        match self.mode {
            Mode::Stick => {
                let shares = law.shares_at_rest(normal, &self.history);
                FrictionShares { shear: shares.shear * friction, fine: shares.fine * friction }
            }
            mode if law.present => {
                let (sigma, hysteresis) = (mode.direction(), fine.hysteresis.value);
                let shear = friction - sigma * law.coulomb * normal - sigma * hysteresis;
                FrictionShares { shear, fine: sigma * hysteresis }
            }
            _ => FrictionShares::default(),
        }
    }
}
