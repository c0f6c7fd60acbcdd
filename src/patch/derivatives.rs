//! How a run's outputs change at once, its states and modes held: as the body is displaced, or as it moves on.
//!
//! The spring of an element that sticks follows the face, and where its stiffness falls, loses its share; one that
//! slips stays at its limit. The pressure follows the approach, arms turn with the body; temperatures stay.

use super::block::ElementMode;
use super::definition::ElementSite;
use super::face::Face;
use super::motion::{BodyKinematics, PoseMotion, size};
use super::run::PatchRun;
use super::variables::{PatchOutput, PatchVariable};
use crate::element::{LawPlace, SpringLaw, damped};
use crate::math::{Dual, Number};

type Rate = Dual<1>;

/// Outputs that follow the pose at once, and their changes.
#[derive(Clone, Copy, Debug)]
struct Changes {
    /// Force and moment on the body.
    wrench: [Rate; 6],
    /// The force on the tread.
    transport: Rate,
    /// The real area of contact.
    real_area: Rate,
    /// The largest pressure on an element.
    pressure: Rate,
    /// The part of the normal force on elements outside the table.
    outside: Rate,
    /// Σ|G|.
    tangential: Rate,
    /// Σ|G|η with the share η of hysteresis in the friction coefficient.
    hysteresis: Rate,
    /// The energy stored in the springs: of the normal ones the slope alone.
    elastic: Rate,
}

/// A displacement of the body, or its motion.
#[derive(Clone, Copy, Debug)]
struct Displacement {
    /// Changes of the pose's coordinates.
    pose: [f64; 6],
    /// How many cells of the tread enter.
    entered: f64,
}

/// An element as it changes.
#[derive(Clone, Copy, Debug)]
struct MovingElement {
    area: Rate,
    /// From the pose's point, in the ground's axes.
    arm: [Rate; 3],
    /// The direction of the arc in the ground's axes.
    along: [Rate; 3],
    /// The displacement of the face's material along the plane.
    displacement: [f64; 2],
}

fn rate(value: f64, slope: f64) -> Rate {
    Rate { value, slopes: [slope] }
}

impl PatchRun {
    /// Writes into `values` how `variables` change as the pose's coordinates change by `direction` (m and rad per
    /// unit).
    pub fn directional_derivative(&mut self, variables: &[PatchVariable], direction: [f64; 6], values: &mut [f64]) {
        let with_shares = variables.iter().any(|variable| variable.output.follows_shares());
        let changes = self.changes(&Displacement { pose: direction, entered: 0.0 }, with_shares);
        for (variable, value) in variables.iter().zip(values) {
            *value = changes.rate_of(variable.output).slopes[0];
        }
    }

    /// The rate of a component of the wrench at the end of the last step, N/s or N m/s; `None` for another output.
    pub fn rate(&mut self, output: PatchOutput) -> Option<f64> {
        if !matches!(output, PatchOutput::Force(_) | PatchOutput::Moment(_)) {
            return None;
        }
        let entered = match &*self.patch.face {
            Face::Tread(tread) => self.totals.tread_speed / tread.cell,
            Face::Points(_) => 0.0,
        };
        Some(self.changes(&Displacement { pose: self.totals.rates, entered }, false).rate_of(output).slopes[0])
    }

    /// The changes; without `with_shares` those of the real area and of hysteresis stay 0.
    fn changes(&mut self, shift: &Displacement, with_shares: bool) -> Changes {
        let (totals, now) = (self.totals, self.totals.instant());
        let start = totals.pose.coordinates();
        let shifted = PoseMotion { start, change: shift.pose.map(|slope| rate(0.0, slope)), duration: 1.0 }.at(1.0);
        let limits = self.law.limits();
        let mut changes = Changes::zero();
        for i in 0..self.patch.count() {
            // The element's law at the approach as it changes.
            let here = self.element_contact(i, &totals, &now, self.springs.rise_of_law(i));
            let element = self.moving_element(i, shift, &shifted);
            let approach = -(shifted.height + element.arm[2]);
            let law = self.law.at_place(&here.place.constant(), approach);
            let normal = law.pressure * element.area;
            if normal.value <= 0.0 {
                continue;
            }
            // Its spring, and what both add to the sums.
            let (limit, stiffness) = (normal * law.friction, law.stiffness * element.area);
            let mut force = self.force(i, limit, stiffness, element.displacement);
            let elongation = size(force) / stiffness;
            let damping = self.patch.damping();
            if damping > 0.0 {
                force = damped(force, &SpringLaw { stiffness, limit }, here.velocity.map(Rate::constant), damping);
            }
            changes.add(&element, force, normal);
            let tangential = size(force);
            if with_shares {
                let (hysteresis, ratio) = self.shares(&here.place, approach);
                changes.real_area = changes.real_area + ratio * element.area;
                changes.hysteresis = changes.hysteresis + tangential * hysteresis;
            }
            changes.pressure = changes.pressure.larger(law.pressure);
            changes.tangential = changes.tangential + tangential;
            let stored = rate(0.0, normal.value * approach.slopes[0]);
            changes.elastic = changes.elastic + (elongation * elongation * stiffness).times(0.5) + stored;
            if limits.is_outside(here.pressure, size(here.velocity)) {
                changes.outside = changes.outside + normal;
            }
        }
        changes
    }

    /// An element's place as it changes.
    fn moving_element(&self, i: usize, shift: &Displacement, shifted: &BodyKinematics<Rate>) -> MovingElement {
        let ElementSite { place, area, direction } = self.patch.element(i, self.totals.place);
        let (mut slopes, mut area_slope, mut run) = ([0.0; 3], 0.0, 0.0);
        if let Face::Tread(tread) = &*self.patch.face {
            let (arc, share) = tread.changes((i / tread.rows.len()) as f64, self.totals.place);
            slopes = [direction[0], 0.0, direction[1]].map(|d| d * arc * shift.entered);
            area_slope = tread.area * share * shift.entered;
            run = tread.cell * shift.entered;
        }
        let turned = shifted.turned(place);
        let moved =
            shifted.rotation.map(|row| row[0].value * slopes[0] + row[1].value * slopes[1] + row[2].value * slopes[2]);
        let along = shifted.turned([direction[0], 0.0, direction[1]]);
        let body = |axis: usize| shifted.moved[axis].slopes[0] + turned[axis].slopes[0];
        MovingElement {
            area: rate(area, area_slope),
            arm: std::array::from_fn(|axis| turned[axis] + rate(0.0, moved[axis])),
            along,
            displacement: [0, 1].map(|axis| body(axis) - along[axis].value * run),
        }
    }

    /// G of an element as it changes.
    fn force(&self, i: usize, limit: Rate, stiffness: Rate, displacement: [f64; 2]) -> [Rate; 2] {
        let force = [self.springs.x[i], self.springs.y[i]];
        let slopes = match self.springs.mode[i] {
            mode if mode == ElementMode::Free as u8 => [0.0; 2],
            mode if mode == ElementMode::Slipping as u8 => {
                let strength = force[0].hypot(force[1]);
                let n = force.map(|g| if strength > 0.0 { g / strength } else { 0.0 });
                let along = n[0] * displacement[0] + n[1] * displacement[1];
                [0, 1].map(|axis| n[axis] * limit.slopes[0] + stiffness.value * (displacement[axis] - n[axis] * along))
            }
            _ => {
                let lost = stiffness.slopes[0].min(0.0) / stiffness.value;
                [0, 1].map(|axis| stiffness.value * displacement[axis] + lost * force[axis])
            }
        };
        [rate(force[0], slopes[0]), rate(force[1], slopes[1])]
    }

    /// Hysteresis' share of the friction coefficient and the contact ratio, as they change with the approach.
    fn shares(&self, place: &LawPlace<f64>, approach: Rate) -> (Rate, Rate) {
        // Of smooth cubics over some µm.
        let step = 1e-6 * (approach.value - self.law.earliest_touch()).abs().max(1e-9);
        let at = |shift: f64| self.law.shares(place, approach.value + shift);
        let (before, middle, after) = (at(-step), at(0.0), at(step));
        let slope = |from: f64, to: f64| (to - from) / (2.0 * step) * approach.slopes[0];
        (rate(middle.0, slope(before.0, after.0)), rate(middle.1, slope(before.1, after.1)))
    }
}

impl Changes {
    fn zero() -> Self {
        let zero = Rate::constant(0.0);
        Self {
            wrench: [zero; 6],
            transport: zero,
            real_area: zero,
            pressure: zero,
            outside: zero,
            tangential: zero,
            hysteresis: zero,
            elastic: zero,
        }
    }

    /// Adds the loads of an element.
    fn add(&mut self, element: &MovingElement, force: [Rate; 2], normal: Rate) {
        let [x, y, z] = element.arm;
        let (f_x, f_y, f_z) = (-force[0], -force[1], normal);
        let loads = [f_x, f_y, f_z, y * f_z - z * f_y, z * f_x - x * f_z, x * f_y - y * f_x];
        self.wrench.iter_mut().zip(loads).for_each(|(sum, load)| *sum = *sum + load);
        let [a_x, a_y, a_z] = element.along;
        self.transport = self.transport - (a_x * f_x + a_y * f_y + a_z * f_z);
    }

    fn rate_of(&self, output: PatchOutput) -> Rate {
        let share = |part: Rate, whole: Rate| if whole.value > 0.0 { part / whole } else { Rate::constant(0.0) };
        let [x, y, z, ..] = self.wrench;
        match output {
            PatchOutput::Force(axis) => self.wrench[axis],
            PatchOutput::Moment(axis) => self.wrench[3 + axis],
            PatchOutput::TransportForce => self.transport,
            PatchOutput::RealArea => self.real_area,
            PatchOutput::Pressure => self.pressure,
            PatchOutput::Beyond => share(self.outside, z),
            PatchOutput::Friction => share(size([x, y]), z),
            PatchOutput::Hysteresis => share(self.hysteresis, self.tangential),
            PatchOutput::ElasticEnergy => self.elastic,
            _ => Rate::constant(0.0),
        }
    }
}

impl PatchOutput {
    /// Whether its change takes those of hysteresis' share and of the contact ratio.
    fn follows_shares(self) -> bool {
        matches!(self, Self::RealArea | Self::Hysteresis)
    }

    /// Whether it follows the pose at once, the springs and modes held.
    pub fn follows_pose(self) -> bool {
        use PatchOutput::{
            Beyond, ElasticEnergy, Force, Friction, Hysteresis, Moment, Pressure, RealArea, TransportForce,
        };
        matches!(
            self,
            Force(_)
                | Moment(_)
                | TransportForce
                | RealArea
                | Pressure
                | Beyond
                | Friction
                | Hysteresis
                | ElasticEnergy
        )
    }
}
