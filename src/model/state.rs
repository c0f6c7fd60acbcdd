//! The state of the layer, and the carrier's motion at one instant.

use std::ops::{Index, IndexMut};

use serde::{Deserialize, Serialize};

use super::{Axis, ByAxis, Flash, Input, Model, SlipHistory, SpeedMemory, SurfacePoint};
use crate::math::Jet;

/// The contact mode of a mass, with the conditions that hold in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    /// Gap g ≥ 0, no contact force.
    #[default]
    Free,
    /// g = 0, F_N ≥ 0, v_t ≥ 0: slipping along +t, or, without friction, in contact at any speed.
    Forward,
    /// g = 0, F_N ≥ 0, v_t ≤ 0: slipping along -t.
    Backward,
    /// g = 0, F_N ≥ 0, ẋ = 0, |f·t| ≤ T(0).
    Stick,
}

impl Mode {
    /// Whether the mass is in contact.
    pub fn in_contact(self) -> bool {
        self != Self::Free
    }

    /// Whether the mass is in contact and may move along the profile.
    pub fn slips(self) -> bool {
        matches!(self, Self::Forward | Self::Backward)
    }

    /// The direction σ of slip along t, 1 or -1; 0 in the other modes.
    // Without branches, so that loops over masses become vector instructions.
    #[inline(always)]
    pub fn direction(self) -> f64 {
        f64::from(u8::from(self == Self::Forward)) - f64::from(u8::from(self == Self::Backward))
    }

    /// The slip mode for a velocity or a force along t of this sign.
    pub fn along(tangential: f64) -> Self {
        if tangential < 0.0 { Self::Backward } else { Self::Forward }
    }

    /// The number of the mode in outputs and records: 0 free, 1 or -1 slipping, 2 sticking.
    pub fn number(self) -> i8 {
        match self {
            Self::Free => 0,
            Self::Forward => 1,
            Self::Backward => -1,
            Self::Stick => 2,
        }
    }

    /// The mode with this number, if there is one.
    pub fn from_number(number: i8) -> Option<Self> {
        [Self::Free, Self::Forward, Self::Backward, Self::Stick].into_iter().find(|mode| mode.number() == number)
    }
}

/// Positions relative to the carrier, velocities in the inertial frame, Maxwell elongations and modes of all masses.
///
/// In contact z = z_r(x) and ż = s ẋ are imposed, not integrated, so the constraint does not drift.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// ξ_i - u, m: the elongation of the horizontal link.
    pub elongation_x: Vec<f64>,
    /// ζ_i - w, m: the elongation of the vertical link.
    pub elongation_z: Vec<f64>,
    /// ẋ_i, m/s.
    pub velocity_x: Vec<f64>,
    /// ż_i, m/s.
    pub velocity_z: Vec<f64>,
    /// a_j = e - y_j of all Maxwell elements, m, at the indices [`MaxwellRow::range`](super::MaxwellRow::range). The
    /// force of an element is c_j a_j. da_j/dt = ė - a_j/τ_j keeps all digits also for a short τ_j, where e - y_j would
    /// cancel.
    pub maxwell: Vec<f64>,
    /// The parts ϑ_j of the flash temperatures, K: of the term j of the kernel one for each mass, term after term; empty
    /// where friction heats nothing.
    pub flash: Vec<f64>,
    /// The speeds v_s that the masses remember, m/s; empty where friction has no memory.
    pub memory: Vec<f64>,
    /// The contact modes.
    pub mode: Vec<Mode>,
    /// The profile under each mass in contact; zeros for a free mass.
    pub surface: Vec<SurfacePoint>,
}

impl State {
    /// Elongations of the links to the carrier along `axis`, m.
    pub fn elongation(&self, axis: Axis) -> &[f64] {
        match axis {
            Axis::X => &self.elongation_x,
            Axis::Z => &self.elongation_z,
        }
    }

    /// Moves mass `i` by `moved` along x and z, m. Its dashpots have `time` (s) to follow, see
    /// [`MaxwellRow::left_of`](super::MaxwellRow::left_of).
    pub fn displace(&mut self, model: &Model, i: usize, moved: ByAxis<f64>, time: f64) {
        self.elongation_x[i] += moved.x;
        self.elongation_z[i] += moved.z;
        for row in &model.rows {
            let by = row.left_of(moved[row.kind.axis()], time);
            let a = &mut self.maxwell[row.range.clone()];
            if !row.kind.is_lateral() {
                a[i] += by;
                continue;
            }
            if let Some(a) = a.get_mut(i) {
                *a -= by;
            }
            if i > 0 {
                a[i - 1] += by;
            }
        }
    }

    /// ϑ of mass `i`, K: how much warmer its contact is than the layer.
    pub fn flash(&self, i: usize) -> f64 {
        self.flash.iter().skip(i).step_by(self.mode.len()).sum()
    }

    /// What the past of mass `i` has left of its flash temperature and remembered speed.
    #[inline]
    pub fn history(&self, i: usize) -> SlipHistory {
        let memory = self.memory.get(i).map(|&speed| SpeedMemory::held(speed));
        SlipHistory { flash: Flash::held(self.flash(i)), memory }
    }

    /// The profile under mass `i`, touching or free, where the carrier is at `profile_position`, m.
    #[inline]
    pub fn surface_under(&self, model: &Model, i: usize, profile_position: f64) -> SurfacePoint {
        if self.mode[i].in_contact() {
            self.surface[i]
        } else {
            model.surface_at(model.rest_x[i] + (profile_position + self.elongation_x[i]))
        }
    }

    /// |v_t| = q |ẋ| of mass `i`, touching or free, m/s, where the carrier is at `profile_position`, m.
    #[inline]
    pub fn tangential_speed(&self, model: &Model, i: usize, profile_position: f64) -> f64 {
        let slope = self.surface_under(model, i, profile_position).slope;
        (1.0 + slope * slope).sqrt() * self.velocity_x[i].abs()
    }

    /// All masses of `model` at rest and free.
    pub fn new(model: &Model) -> Self {
        let masses = model.masses();
        let zeros = || vec![0.0; masses];
        Self {
            elongation_x: zeros(),
            elongation_z: zeros(),
            velocity_x: zeros(),
            velocity_z: zeros(),
            maxwell: vec![0.0; model.maxwell_variables()],
            flash: vec![0.0; model.flash_variables()],
            memory: vec![0.0; model.memory_variables()],
            mode: vec![Mode::Free; masses],
            surface: vec![SurfacePoint::default(); masses],
        }
    }

    /// Sets mass `i` free.
    pub fn release(&mut self, i: usize) {
        self.mode[i] = Mode::Free;
        self.surface[i] = SurfacePoint::default();
    }

    /// Copies `other`; of the same model without allocating.
    pub fn copy_from(&mut self, other: &Self) {
        self.elongation_x.clone_from(&other.elongation_x);
        self.elongation_z.clone_from(&other.elongation_z);
        self.velocity_x.clone_from(&other.velocity_x);
        self.velocity_z.clone_from(&other.velocity_z);
        self.maxwell.clone_from(&other.maxwell);
        self.flash.clone_from(&other.flash);
        self.memory.clone_from(&other.memory);
        self.mode.clone_from(&other.mode);
        self.surface.clone_from(&other.surface);
    }
}

/// The carrier at one instant of a segment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CarrierPoint {
    /// u minus u at the start of the segment (m), u̇ and ü.
    pub x: Jet,
    /// w minus w at the start of the segment (m), ẇ and ẅ.
    pub z: Jet,
    /// What acts on the first and on the last mass from beyond a part of a layer, N; 0 for a whole layer.
    #[serde(skip)]
    pub ends: [ByAxis<f64>; 2],
}

impl CarrierPoint {
    /// u̇ and ẇ, m/s.
    #[inline(always)]
    pub fn rates(&self) -> ByAxis<f64> {
        ByAxis { x: self.x.speed, z: self.z.speed }
    }
}

impl Index<Axis> for CarrierPoint {
    type Output = Jet;

    fn index(&self, axis: Axis) -> &Jet {
        match axis {
            Axis::X => &self.x,
            Axis::Z => &self.z,
        }
    }
}

impl IndexMut<Axis> for CarrierPoint {
    fn index_mut(&mut self, axis: Axis) -> &mut Jet {
        match axis {
            Axis::X => &mut self.x,
            Axis::Z => &mut self.z,
        }
    }
}

/// Derivatives of the run's forces and of its bodies' motion by the targets of its inputs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tangents {
    by_input: [TangentsOf; Input::MECHANICAL.len()],
}

/// The derivatives by the target of one input.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TangentsOf {
    /// Of F_x and F_z.
    pub force: ByAxis<f64>,
    /// Of the displacement and the speed of the bodies along x and z; 0 where the displacement is prescribed.
    pub body: ByAxis<[f64; 2]>,
}

impl Tangents {
    /// Those by the target of `input`, which moves the carrier.
    pub fn by(&self, input: Input) -> &TangentsOf {
        &self.by_input[input as usize]
    }

    /// Sets those by the target of `input`.
    pub fn set(&mut self, input: Input, tangents: TangentsOf) {
        self.by_input[input as usize] = tangents;
    }
}

/// The forces on the first and on the last mass of a part of a layer, as polynomials in the fraction of a step of the
/// whole layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndForces {
    /// Start of that step, s after the start of the carrier's segment, and its length, s.
    pub span: (f64, f64),
    /// Coefficients of 1, θ, … θ⁴ by end, N.
    pub coefficients: [ByAxis<[f64; 5]>; 2],
}

impl EndForces {
    /// The forces at the time `s` after the start of the carrier's segment (s), by end, N.
    pub fn at(&self, s: f64) -> [ByAxis<f64>; 2] {
        let theta = (s - self.span.0) / self.span.1;
        self.coefficients.map(|end| end.map(|c| c.iter().rev().fold(0.0, |sum, coefficient| sum * theta + coefficient)))
    }
}

impl CarrierPoint {
    /// What acts on mass `i` of `masses` from beyond the part of a layer, N.
    pub fn on_end(&self, i: usize, masses: usize) -> ByAxis<f64> {
        let of = |end: usize, is_end: bool| if is_end { self.ends[end] } else { ByAxis::default() };
        let (first, last) = (of(0, i == 0), of(1, i + 1 == masses));
        ByAxis { x: first.x + last.x, z: first.z + last.z }
    }
}
