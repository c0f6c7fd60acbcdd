//! The directional derivatives of outputs, with the carrier shifted.
//!
//! In a directional derivative the carrier is shifted and all states are frozen (see `table`). A shift by δu takes δu
//! from the elongation e of every horizontal link and from a_j = e - y_j of its Maxwell elements, so the link's force
//! changes by -(c + Σ c_j) δu; that of a vertical link likewise with δw. On its mass a link's force counts negative:
//! f_x,i grows by (c + Σ c_j) δu, and the contact forces follow.

use super::snapshot::{MassContact, Snapshot};
use crate::model::{ContactForces, LinkKind, MaxwellRow, Mode, Model};
use crate::scene::{Axis, ByAxis};

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
    /// δF_x = -k (c + Σ c_j) δu of the horizontal links, δF_z likewise of the vertical ones, each by its measure.
    pub(super) fn force_changes(&self, shift: &CarrierShift) -> ByAxis<f64> {
        let k = self.model.masses() as f64;
        let measures: f64 = (0..self.model.masses()).map(|i| self.measure(LinkKind::Vertical, i)).sum();
        ByAxis { x: -k * shift.on_mass.x, z: -measures * shift.on_mass.z }
    }

    fn measure(&self, kind: LinkKind, link: usize) -> f64 {
        self.model.measure(kind, link, &self.state().elongation_x)
    }

    /// Changes of the forces on mass `i`, N.
    fn on_mass_change(&self, i: usize, shift: &CarrierShift) -> ByAxis<f64> {
        let Some(spacing) = self.model.spatial else { return shift.on_mass };
        // T_i changes with V = Σ c (e - y)² of the vertical links at both of its ends.
        let energy = |i: usize| {
            let (kind, e) = (LinkKind::Vertical, self.state().elongation_z[i]);
            let elements = self.model.element_force(kind, |row| self.state().maxwell[row.range.start + i]);
            let springs = self.model.links[kind].stiffness * e - self.model.frozen_force(kind, i);
            2.0 * (springs + elements) * shift.elongation.z
        };
        let tension = |i: usize| (energy(i) + energy(i + 1)) / (4.0 * spacing);
        let right = if i + 1 < self.model.masses() { tension(i) } else { 0.0 };
        let left = if i > 0 { tension(i - 1) } else { 0.0 };
        ByAxis { x: shift.on_mass.x + right - left, z: self.measure(LinkKind::Vertical, i) * shift.on_mass.z }
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
        let Some(contact) = self.contact(i) else {
            return ContactChange { q: 1.0, ..ContactChange::default() };
        };
        let MassContact { mode, slope, forces: ContactForces { normal: pressing, tangential, q, .. }, .. } = contact;
        let ByAxis { x: f_x, z: f_z } = self.on_mass_change(i, shift);
        let normal = (slope * f_x - f_z) / q;
        let law = &self.model.friction;
        let by_normal = law.slip(pressing, contact.velocity.abs() * q, &contact.history).by_normal;
        let on_fine = contact.fine(self.model);
        let (friction, shear, fine) = match mode {
            Mode::Stick => {
                let friction = (f_x + slope * f_z) / q;
                let shares = law.shares_at_rest(pressing, &contact.history);
                let changes = law.shares_by_normal(pressing, by_normal, &contact.history);
                let part = |share: f64, change: f64| share * friction + tangential * change * normal;
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
            let spring =
                |i: usize| self.measure(kind, i) * (stiffness * elongations[i] - self.model.frozen_force(kind, i));
            shift.elongation[axis] * (0..elongations.len()).map(spring).sum::<f64>()
        };
        spring(Axis::X) + spring(Axis::Z) + self.maxwell_sum(shift, |row| row.stiffness)
    }

    /// Σ weight a δa over the Maxwell elements of the links to the carrier.
    fn maxwell_sum(&self, shift: &CarrierShift, weight: impl Fn(&MaxwellRow) -> f64) -> f64 {
        let moved = |kind: LinkKind| if kind.is_lateral() { 0.0 } else { shift.elongation[kind.axis()] };
        let of_row = |row: &MaxwellRow| {
            let a = self.state().maxwell[row.range.clone()].iter().enumerate();
            weight(row) * moved(row.kind) * a.map(|(link, a)| self.measure(row.kind, link) * a).sum::<f64>()
        };
        self.model.rows.iter().map(of_row).sum()
    }
}
