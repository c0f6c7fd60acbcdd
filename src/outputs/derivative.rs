//! Directional derivatives of the outputs: the carrier is shifted, all states are frozen (see `table`).
//!
//! A shift of the carrier by δu takes δu from the elongation e of every horizontal link and from a_j = e - y_j of its
//! Maxwell elements, so the link's force changes by -(c + Σ c_j) δu; that of a vertical link likewise with δw. On its
//! mass a link's force counts negative: f_x,i grows by (c + Σ c_j) δu, and the contact forces follow.

use super::Snapshot;
use crate::model::{LinkKind, MaxwellRow, Mode, Model};

/// A shift of the carrier: the changes that it makes in each link to it and on each mass.
#[derive(Clone, Copy, Debug)]
pub(super) struct CarrierShift {
    /// Of the elongations of the horizontal and the vertical links, m.
    elongation: (f64, f64),
    /// Of the forces of the links on each mass, N.
    on_mass: (f64, f64),
}

impl CarrierShift {
    /// A shift of u and w by (δu, δw), m.
    pub(super) fn new(model: &Model, (du, dw): (f64, f64)) -> Self {
        let stiffness = |kind| model.instantaneous_stiffness(kind);
        Self {
            elongation: (-du, -dw),
            on_mass: (stiffness(LinkKind::Horizontal) * du, stiffness(LinkKind::Vertical) * dw),
        }
    }
}

/// Changes of the forces in a contact, N, and the slope there.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ContactChange {
    pub(super) normal: f64,
    pub(super) friction: f64,
    slope: f64,
    q: f64,
}

impl ContactChange {
    pub(super) fn hysteresis(self) -> f64 {
        -self.normal * self.slope / self.q
    }

    pub(super) fn adhesion(self) -> f64 {
        -self.friction / self.q
    }

    pub(super) fn force_x(self) -> f64 {
        self.hysteresis() + self.adhesion()
    }

    pub(super) fn force_z(self) -> f64 {
        (self.normal - self.friction * self.slope) / self.q
    }
}

impl Snapshot<'_> {
    /// δF_x = -k (c + Σ c_j) δu of the horizontal links, δF_z likewise of the vertical ones.
    pub(super) fn force_changes(&self, shift: &CarrierShift) -> (f64, f64) {
        let k = self.model.masses() as f64;
        (-k * shift.on_mass.0, -k * shift.on_mass.1)
    }

    /// Of |F_x|/F_z; 0 where F_x = 0, the kink of |F_x|.
    pub(super) fn friction_coefficient_change(&self, shift: &CarrierShift) -> f64 {
        let (x, z) = (self.forces.on_carrier_x(), self.forces.on_carrier_z());
        if z <= 0.0 || x == 0.0 {
            return 0.0;
        }
        let (dx, dz) = self.force_changes(shift);
        (x.signum() * dx - x.abs() * dz / z) / z
    }

    /// δF_N = (s δf_x - δf_z)/q; δF_T = (δf_x + s δf_z)/q where the mass sticks, σ μ δF_N where it slips.
    pub(super) fn contact_change(&self, i: usize, shift: &CarrierShift) -> ContactChange {
        let mode = self.state.mode[i];
        if !mode.in_contact() {
            return ContactChange { q: 1.0, ..ContactChange::default() };
        }
        let slope = self.state.surface[i].slope;
        let q = (1.0 + slope * slope).sqrt();
        let (f_x, f_z) = shift.on_mass;
        let normal = (slope * f_x - f_z) / q;
        let friction = match mode {
            Mode::Stick => (f_x + slope * f_z) / q,
            _ => mode.direction() * self.model.friction_coefficient * normal,
        };
        ContactChange { normal, friction, slope, q }
    }

    pub(super) fn contact_sum(&self, shift: &CarrierShift, part: impl Fn(ContactChange) -> f64) -> f64 {
        (0..self.model.masses()).map(|i| part(self.contact_change(i, shift))).sum()
    }

    /// Of Σ F_T v_t with v_t = ẋ q frozen.
    pub(super) fn friction_power_change(&self, shift: &CarrierShift) -> f64 {
        let power = |i| {
            let contact = self.contact_change(i, shift);
            contact.friction * self.state.velocity_x[i] * contact.q
        };
        (0..self.model.masses()).map(power).sum()
    }

    /// Of Σ_j c_j a_j²/τ_j.
    pub(super) fn maxwell_power_change(&self, shift: &CarrierShift) -> f64 {
        self.maxwell_sum(shift, |row| 2.0 * row.stiffness / row.relaxation_time)
    }

    /// Of V = Σ ½ c e² + Σ_j ½ c_j a_j², where a_j = e - y_j of frozen dashpots.
    pub(super) fn elastic_energy_change(&self, shift: &CarrierShift) -> f64 {
        let spring = |kind: LinkKind, elongations: &[f64], moved: f64| {
            let law = &self.model.links[kind as usize];
            let frozen =
                if law.frozen > 0.0 { law.frozen * self.model.frozen_dashpots(kind).sum::<f64>() } else { 0.0 };
            moved * (law.stiffness * elongations.iter().sum::<f64>() - frozen)
        };
        spring(LinkKind::Horizontal, &self.state.elongation_x, shift.elongation.0)
            + spring(LinkKind::Vertical, &self.state.elongation_z, shift.elongation.1)
            + self.maxwell_sum(shift, |row| row.stiffness)
    }

    /// Σ weight a δa over the Maxwell elements of the links to the carrier.
    fn maxwell_sum(&self, shift: &CarrierShift, weight: impl Fn(&MaxwellRow) -> f64) -> f64 {
        let moved = |kind| match kind {
            LinkKind::Horizontal => shift.elongation.0,
            LinkKind::Vertical => shift.elongation.1,
            LinkKind::LateralX | LinkKind::LateralZ => 0.0,
        };
        let of_row = |row: &MaxwellRow| {
            weight(row) * moved(row.kind) * self.state.maxwell[row.range.clone()].iter().sum::<f64>()
        };
        self.model.rows.iter().map(of_row).sum()
    }
}
