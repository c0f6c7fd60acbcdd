//! The values of output variables at one instant.

use serde::{Deserialize, Serialize};

use super::{Output, Variable};
use crate::math::{Numbers, visit_all};
use crate::model::{
    CarrierPoint, ChannelEnergies, ContactForces, Forces, Mode, Model, Powers, State, elastic_energy, kinetic_energy,
};
use crate::scene::{OutputGroup, Scene};

/// What a scene asks to be added up along the way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Accounts {
    /// Energies: the groups `dissipation` and `energy`.
    pub energy: bool,
    /// The error estimate of F_z and the processor time: the group `solver`.
    pub solver: bool,
    /// The forces' sensitivities to the carrier's targets: the group `tangent`.
    pub tangents: bool,
}

impl Accounts {
    /// What the output groups of `scene` need.
    pub fn new(scene: &Scene) -> Self {
        let asked = |group| scene.outputs.contains(&group);
        Self {
            energy: asked(OutputGroup::Dissipation) || asked(OutputGroup::Energy),
            solver: asked(OutputGroup::Solver),
            tangents: asked(OutputGroup::Tangent),
        }
    }
}

/// Energies added up since the start, J.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Energies {
    /// Through the channels that take time.
    pub channels: ChannelEnergies,
    /// Lost in impacts.
    pub impact: f64,
    /// T + V at the start.
    pub initial: f64,
}

impl Energies {
    /// Energy lost through all channels, J.
    pub fn dissipated(&self) -> f64 {
        self.channels.dissipated() + self.impact
    }
}

impl Numbers for Energies {
    fn visit(&mut self, visit: &mut dyn FnMut(&mut f64)) {
        let Self { channels, impact, initial } = self;
        visit_all([channels, impact, initial], visit);
    }
}

/// What the solver counts since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Counters {
    /// Accepted steps.
    pub steps: u64,
    /// Rejected steps.
    pub rejected: u64,
    /// Mode changes.
    pub events: u64,
    /// Processor time, s: not a part of the run's state, so it is not serialised.
    #[serde(skip)]
    pub run_time: f64,
    /// By how much F_z was off that of a finer run at most, N.
    largest_error: f64,
    /// The largest |F_z| of the finer run so far, N.
    largest_force: f64,
}

impl Counters {
    /// Compares F_z with that of a finer run at the same time, N. `share` of the error shows in the difference.
    pub fn note_error(&mut self, force: f64, finer: f64, share: f64) {
        self.largest_error = self.largest_error.max((force - finer).abs() / share);
        self.largest_force = self.largest_force.max(finer.abs());
    }

    /// F_z is `force` (N), and nothing is known of its error: it counts as large as the force.
    pub fn note_unknown(&mut self, force: f64) {
        self.note_error(2.0 * force, force, 1.0);
    }

    /// Estimated error of F_z over its largest value so far: 0 until there is one.
    pub fn estimated_error(&self) -> f64 {
        match (self.largest_error, self.largest_force) {
            (0.0, _) => 0.0,
            (_, 0.0) => 1.0,
            (error, force) => (error / force).min(f64::MAX),
        }
    }
}

/// All but the whole numbers and the processor time, which is no part of a run's state.
impl Numbers for Counters {
    fn visit(&mut self, visit: &mut dyn FnMut(&mut f64)) {
        let Self { steps: _, rejected: _, events: _, run_time: _, largest_error, largest_force } = self;
        visit_all([largest_error, largest_force], visit);
    }
}

/// A run at one instant.
#[derive(Clone, Copy, Debug)]
pub struct Snapshot<'a> {
    /// The model.
    pub model: &'a Model,
    /// The layer's state.
    pub state: &'a State,
    /// The forces in that state.
    pub forces: &'a Forces,
    /// The carrier's rates.
    pub carrier: &'a CarrierPoint,
    /// Where the carrier stands: u and w, m.
    pub displacement: (f64, f64),
    /// Energies since the start.
    pub energies: &'a Energies,
    /// ∂F_x/∂u, ∂F_x/∂w, ∂F_z/∂u, ∂F_z/∂w by the targets of the last motion, N/m.
    pub tangents: [f64; 4],
    /// The solver's counters.
    pub counters: &'a Counters,
}

/// Sums over the masses in contact.
#[derive(Clone, Copy, Default)]
struct ContactSums {
    hysteresis: f64,
    adhesion: f64,
    force_z: f64,
}

impl Snapshot<'_> {
    /// Writes the values of `variables`, in their order; Integers as whole numbers. What no variable asks for is not
    /// computed.
    pub fn evaluate(&self, variables: &[Variable], values: &mut [f64]) {
        let asked = |outputs: &[Output]| variables.iter().any(|variable| outputs.contains(&variable.output));
        let (mut sums, mut power, mut kinetic, mut elastic) = (ContactSums::default(), 0.0, 0.0, 0.0);
        if asked(&[Output::Hysteresis, Output::Adhesion, Output::ContactForceX, Output::ContactForceZ]) {
            sums = self.contact_sums();
        }
        if asked(&[Output::DissipatedPower]) {
            power = Powers::evaluate(self.model, self.state, self.carrier, self.forces).dissipated();
        }
        if asked(&[Output::KineticEnergy, Output::ElasticEnergy, Output::EnergyResidual]) {
            kinetic = kinetic_energy(self.model, self.state);
            elastic = elastic_energy(self.model, self.state);
        }
        let count = |test: fn(&Mode) -> bool| self.state.mode.iter().filter(|mode| test(mode)).count() as f64;
        let channels = &self.energies.channels;
        for (variable, value) in variables.iter().zip(values) {
            *value = match variable.output {
                Output::ForceX => self.forces.on_carrier_x(),
                Output::ForceZ => self.forces.on_carrier_z(),
                Output::DissipatedPower => power,
                Output::DissipatedEnergy => self.energies.dissipated(),
                Output::DamperEnergy => channels.damper,
                Output::MaxwellEnergy => channels.maxwell,
                Output::FrictionEnergy => channels.friction,
                Output::ImpactEnergy => self.energies.impact,
                Output::Hysteresis => sums.hysteresis,
                Output::Adhesion => sums.adhesion,
                Output::FrictionCoefficient => self.friction_coefficient(),
                Output::ContactCount => count(|mode| mode.in_contact()),
                Output::StickingCount => count(|&mode| mode == Mode::Stick),
                Output::ContactRatio => count(|mode| mode.in_contact()) / self.model.masses() as f64,
                Output::ContactArea => count(|mode| mode.in_contact()) * self.model.element_area,
                Output::ContactForceX => sums.hysteresis + sums.adhesion,
                Output::ContactForceZ => sums.force_z,
                Output::InputEnergy => channels.input,
                Output::KineticEnergy => kinetic,
                Output::ElasticEnergy => elastic,
                Output::EnergyResidual => {
                    channels.input - (kinetic + elastic - self.energies.initial) - self.energies.dissipated()
                }
                Output::TangentXU => self.tangents[0],
                Output::TangentXW => self.tangents[1],
                Output::TangentZU => self.tangents[2],
                Output::TangentZW => self.tangents[3],
                Output::Steps => held(self.counters.steps),
                Output::Events => held(self.counters.events),
                Output::Rejected => held(self.counters.rejected),
                Output::EstimatedError => self.counters.estimated_error(),
                Output::RunTime => self.counters.run_time,
                Output::ElementX(i) => self.model.rest_x[i] + (self.displacement.0 + self.state.elongation_x[i]),
                Output::ElementZ(i) => self.model.rest_z[i] + (self.displacement.1 + self.state.elongation_z[i]),
                Output::ElementNormalForce(i) => self.contact(i).map_or(0.0, |contact| contact.normal),
                Output::ElementFrictionForce(i) => self.contact(i).map_or(0.0, |contact| self.friction(i, &contact)),
                Output::ElementMode(i) => f64::from(self.mode(i).number()),
            };
        }
    }

    /// |F_x|/F_z, 0 where F_z ≤ 0; held at the largest number where next to nothing presses.
    fn friction_coefficient(&self) -> f64 {
        let normal = self.forces.on_carrier_z();
        if normal > 0.0 { (self.forces.on_carrier_x().abs() / normal).min(f64::MAX) } else { 0.0 }
    }

    /// The surface pushes a mass with F_N n - F_T t, n = (-s, 1)/q, t = (1, s)/q (6), (7).
    fn contact_sums(&self) -> ContactSums {
        let mut sums = ContactSums::default();
        for i in 0..self.model.masses() {
            let Some(contact) = self.contact(i) else { continue };
            let s = self.state.surface[i].slope;
            let friction = self.friction(i, &contact);
            sums.hysteresis -= contact.normal * s / contact.q;
            sums.adhesion -= friction / contact.q;
            sums.force_z += (contact.normal - friction * s) / contact.q;
        }
        sums
    }

    /// The forces in the contact at mass `i`; `None` where it is free.
    fn contact(&self, i: usize) -> Option<ContactForces> {
        let v = self.state.velocity_x[i];
        self.state.mode[i].in_contact().then(|| self.forces.contact(self.model, i, v, &self.state.surface[i]))
    }

    fn friction(&self, i: usize, contact: &ContactForces) -> f64 {
        let (mode, v) = (self.state.mode[i], self.state.velocity_x[i]);
        if self.model.has_friction { contact.friction(self.model, mode, v) } else { 0.0 }
    }

    /// The mode of mass `i`; without friction a contact slips the way it moves.
    fn mode(&self, i: usize) -> Mode {
        match self.state.mode[i] {
            mode if mode.slips() && !self.model.has_friction => Mode::along(self.state.velocity_x[i]),
            mode => mode,
        }
    }
}

/// A counter as an Integer of FMI: held at 2³¹ - 1.
fn held(count: u64) -> f64 {
    count.min(i32::MAX as u64) as f64
}
