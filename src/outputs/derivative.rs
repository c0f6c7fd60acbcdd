//! How the outputs follow the carrier's displacement with the states held (the table in `dependencies`).
//!
//! Moving the carrier by δu takes δu from the elongation e of every horizontal link and from a_j = e - y_j of its
//! Maxwell elements, so its force changes by -(c + Σ c_j) δu; a vertical link likewise with δw. A link's force counts
//! negative on its mass: f_x,i grows by (c + Σ c_j) δu, and with it what the contact bears.

use super::{Output, Snapshot, Variable};
use crate::model::{LinkKind, MaxwellRow, Mode, Model};

/// What moving the carrier does to each link to it and to each mass.
struct Change {
    /// Of the elongations of the horizontal and the vertical links, m.
    elongation: (f64, f64),
    /// Of the forces of the links on each mass, N.
    on_mass: (f64, f64),
}

impl Change {
    fn new(model: &Model, (du, dw): (f64, f64)) -> Self {
        let stiffness = |kind| instant_stiffness(model, kind);
        Self {
            elongation: (-du, -dw),
            on_mass: (stiffness(LinkKind::Horizontal) * du, stiffness(LinkKind::Vertical) * dw),
        }
    }
}

/// c + Σ c_j of a link, N/m: its stiffness while the dashpots stand still.
fn instant_stiffness(model: &Model, kind: LinkKind) -> f64 {
    let maxwell: f64 = model.rows.iter().filter(|row| row.kind == kind).map(|row| row.stiffness).sum();
    model.links[kind as usize].stiffness + maxwell
}

/// Changes of the forces in a contact, N, and the slope there.
#[derive(Clone, Copy, Default)]
struct ContactChange {
    normal: f64,
    friction: f64,
    slope: f64,
    q: f64,
}

impl ContactChange {
    fn hysteresis(self) -> f64 {
        -self.normal * self.slope / self.q
    }

    fn adhesion(self) -> f64 {
        -self.friction / self.q
    }

    fn force_z(self) -> f64 {
        (self.normal - self.friction * self.slope) / self.q
    }
}

impl Snapshot<'_> {
    /// Writes the changes of `variables`, in their order, with the carrier moved along x and z by `direction`.
    pub fn differentiate(&self, variables: &[Variable], direction: (f64, f64), values: &mut [f64]) {
        let change = Change::new(self.model, direction);
        for (variable, value) in variables.iter().zip(values) {
            *value = self.derivative(variable.output, &change);
        }
    }

    fn derivative(&self, output: Output, change: &Change) -> f64 {
        match output {
            Output::ForceX => self.force_changes(change).0,
            Output::ForceZ => self.force_changes(change).1,
            Output::DissipatedPower => self.maxwell_power_change(change) + self.friction_power_change(change),
            Output::Hysteresis => self.contact_sum(change, ContactChange::hysteresis),
            Output::Adhesion => self.contact_sum(change, ContactChange::adhesion),
            Output::FrictionCoefficient => self.friction_coefficient_change(change),
            Output::ContactForceX => self.contact_sum(change, |contact| contact.hysteresis() + contact.adhesion()),
            Output::ContactForceZ => self.contact_sum(change, ContactChange::force_z),
            Output::ElasticEnergy => self.elastic_energy_change(change),
            Output::EnergyResidual => -self.elastic_energy_change(change),
            Output::ElementNormalForce(i) => self.contact_change(i, change).normal,
            Output::ElementFrictionForce(i) => self.contact_change(i, change).friction,
            Output::DissipatedEnergy
            | Output::DamperEnergy
            | Output::MaxwellEnergy
            | Output::FrictionEnergy
            | Output::ImpactEnergy
            | Output::ContactCount
            | Output::StickingCount
            | Output::ContactRatio
            | Output::ContactArea
            | Output::InputEnergy
            | Output::KineticEnergy
            | Output::TangentXU
            | Output::TangentXW
            | Output::TangentZU
            | Output::TangentZW
            | Output::Steps
            | Output::Events
            | Output::Rejected
            | Output::EstimatedError
            | Output::RunTime
            | Output::ElementX(_)
            | Output::ElementZ(_)
            | Output::ElementMode(_) => 0.0,
        }
    }

    /// δF_x = -k (c + Σ c_j) δu of the horizontal links, δF_z likewise of the vertical ones.
    fn force_changes(&self, change: &Change) -> (f64, f64) {
        let k = self.model.masses() as f64;
        (-k * change.on_mass.0, -k * change.on_mass.1)
    }

    /// Of |F_x|/F_z; none where F_x = 0, the kink of |F_x|.
    fn friction_coefficient_change(&self, change: &Change) -> f64 {
        let (x, z) = (self.forces.on_carrier_x(), self.forces.on_carrier_z());
        if z <= 0.0 || x == 0.0 {
            return 0.0;
        }
        let (dx, dz) = self.force_changes(change);
        (x.signum() * dx - x.abs() * dz / z) / z
    }

    /// δF_N = (s δf_x - δf_z)/q; δF_T = (δf_x + s δf_z)/q where the mass sticks, σ μ δF_N where it slips.
    fn contact_change(&self, i: usize, change: &Change) -> ContactChange {
        let mode = self.state.mode[i];
        if !mode.in_contact() {
            return ContactChange { q: 1.0, ..ContactChange::default() };
        }
        let slope = self.state.surface[i].slope;
        let q = (1.0 + slope * slope).sqrt();
        let (f_x, f_z) = change.on_mass;
        let normal = (slope * f_x - f_z) / q;
        let friction = match mode {
            Mode::Stick => (f_x + slope * f_z) / q,
            _ => mode.direction() * self.model.friction_coefficient * normal,
        };
        ContactChange { normal, friction, slope, q }
    }

    fn contact_sum(&self, change: &Change, part: impl Fn(ContactChange) -> f64) -> f64 {
        (0..self.model.masses()).map(|i| part(self.contact_change(i, change))).sum()
    }

    /// Of Σ F_T v_t: v_t = ẋ q is held.
    fn friction_power_change(&self, change: &Change) -> f64 {
        let power = |i| {
            let contact = self.contact_change(i, change);
            contact.friction * self.state.velocity_x[i] * contact.q
        };
        (0..self.model.masses()).map(power).sum()
    }

    /// Of Σ_j c_j a_j²/τ_j.
    fn maxwell_power_change(&self, change: &Change) -> f64 {
        self.maxwell_sum(change, |row| 2.0 * row.stiffness / row.relaxation_time)
    }

    /// Of Σ ½ c e² + Σ_j ½ c_j a_j²; of dashpots that stand still, a_j = e - y_j.
    fn elastic_energy_change(&self, change: &Change) -> f64 {
        let spring = |kind: LinkKind, elongations: &[f64], moved: f64| {
            let law = &self.model.links[kind as usize];
            let still = if law.frozen > 0.0 { law.frozen * self.model.frozen_dashpots(kind).sum::<f64>() } else { 0.0 };
            moved * (law.stiffness * elongations.iter().sum::<f64>() - still)
        };
        spring(LinkKind::Horizontal, &self.state.elongation_x, change.elongation.0)
            + spring(LinkKind::Vertical, &self.state.elongation_z, change.elongation.1)
            + self.maxwell_sum(change, |row| row.stiffness)
    }

    /// Σ weight a δa over the Maxwell elements of the links to the carrier.
    fn maxwell_sum(&self, change: &Change, weight: impl Fn(&MaxwellRow) -> f64) -> f64 {
        let moved = |kind| match kind {
            LinkKind::Horizontal => change.elongation.0,
            LinkKind::Vertical => change.elongation.1,
            LinkKind::LateralX | LinkKind::LateralZ => 0.0,
        };
        let of_row = |row: &MaxwellRow| {
            weight(row) * moved(row.kind) * self.state.maxwell[row.range.clone()].iter().sum::<f64>()
        };
        self.model.rows.iter().map(of_row).sum()
    }
}
