//! The carrier: as a body along an axis, which loads and a drive move, or with a prescribed displacement; and its motion in
//! runs without a master, in phases one after another.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::values::Word;
use super::{Axis, ByAxis, Unit};
use crate::math::Jet;

/// `[carrier]`: the axes along which the carrier is a body; `None` where its displacement is prescribed.
pub type CarrierBodies = ByAxis<Option<CarrierBody>>;

/// The carrier as a body along one axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct CarrierBody {
    /// Mass M, kg.
    pub mass: f64,
    /// Stiffness K of the spring to the drive, N/m.
    pub stiffness: Option<f64>,
    /// Damping D of the damper to the drive, N s/m.
    pub damping: Option<f64>,
    /// Constant part of the normal load N, N; along z alone.
    pub load: Option<f64>,
    /// Constant part of the tangential force P, N; along x alone.
    pub pull: Option<f64>,
    /// Displacement at the start, m; `None` is the drive's, or 0.
    pub start: Option<f64>,
    /// Speed at the start, m/s.
    pub start_rate: Option<f64>,
    /// Where it starts.
    pub initial: CarrierInitial,
}

impl CarrierBody {
    /// Whether a spring or a damper joins it to a drive.
    pub fn has_drive(&self) -> bool {
        self.stiffness.unwrap_or(0.0) > 0.0 || self.damping.unwrap_or(0.0) > 0.0
    }
}

/// Where a body starts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum CarrierInitial {
    /// At `start`, or at the drive's displacement.
    #[default]
    Start,
    /// Where the springs of the layer and of the drive bear the load; along z alone.
    Equilibrium,
}

impl Word for CarrierInitial {
    const WORDS: &'static [(&'static str, Self)] = &[("start", Self::Start), ("equilibrium", Self::Equilibrium)];
}

/// What a master gives: a displacement of the carrier or of a body's drive, or a force on a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Input {
    /// `u`, along x.
    U,
    /// `w`, along z.
    W,
    /// `load` on a body along z.
    Load,
    /// `pull` on a body along x.
    Pull,
    /// `temperature` of the layer.
    Temperature,
}

impl Input {
    /// All, in the order of the variables.
    pub const ALL: [Self; 5] = [Self::U, Self::W, Self::Load, Self::Pull, Self::Temperature];

    /// Those that move the carrier.
    pub const MECHANICAL: [Self; 4] = [Self::U, Self::W, Self::Load, Self::Pull];

    /// The variable's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::U => "u",
            Self::W => "w",
            Self::Load => "load",
            Self::Pull => "pull",
            Self::Temperature => "temperature",
        }
    }

    /// Its unit.
    pub fn unit(self) -> Unit {
        match self {
            Self::U | Self::W => Unit::Meter,
            Self::Load | Self::Pull => Unit::Newton,
            Self::Temperature => Unit::Kelvin,
        }
    }

    /// The axis that it acts along; `None` for the temperature.
    pub fn axis(self) -> Option<Axis> {
        match self {
            Self::U | Self::Pull => Some(Axis::X),
            Self::W | Self::Load => Some(Axis::Z),
            Self::Temperature => None,
        }
    }

    /// Whether it is a displacement, or a force.
    pub fn is_displacement(self) -> bool {
        matches!(self, Self::U | Self::W)
    }
}

/// One phase of the carrier's motion.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Phase {
    /// Duration, s.
    pub duration: f64,
    /// Motion along x from the phase's start on.
    pub u: Path,
    /// Motion along z from the phase's start on.
    pub w: Path,
    /// The load on a body along z, see [`Phase::load`].
    pub load: Option<Force>,
    /// The tangential force on a body along x, see [`Phase::pull`].
    pub pull: Option<Force>,
    /// The load over the layer's area, Pa, in place of the load; in the material form alone, see [`Phase::load`].
    pub pressure: Option<Force>,
    /// The layer's temperature from the phase's start on, K, where it is an input; `None`: as it was.
    pub temperature: Option<f64>,
    /// The phase ends when F_z rises to this force, N; in the direct form alone, see [`Phase::end_force`].
    pub until_force: Option<f64>,
    /// The phase ends when F_z over the layer's area rises to this pressure, Pa; in the material form alone.
    pub until_pressure: Option<f64>,
    /// Whether it goes from one row of a motion file to the next; results then have the row's end alone.
    #[serde(skip)]
    pub is_row: bool,
}

impl Phase {
    /// The load on a layer of this area (m²), N: given, or that of the pressure.
    pub fn load(&self, area: Option<f64>) -> Force {
        let of_pressure = self.pressure.and_then(|pressure| Some(pressure.times(area?)));
        of_pressure.or(self.load).unwrap_or_default()
    }

    /// The tangential force, N.
    pub fn pull(&self) -> Force {
        self.pull.unwrap_or_default()
    }

    /// The motion that a run of a layer of this area (m²) follows through the phase.
    pub fn motion(&self, area: Option<f64>) -> Motion {
        let Self { duration, u, w, temperature, .. } = *self;
        Motion { duration, u, w, load: self.load(area), pull: self.pull(), temperature }
    }

    /// F_z at which the phase of a layer of this area (m²) ends, N, if it does: given, or that of the pressure.
    pub fn end_force(&self, area: Option<f64>) -> Option<f64> {
        self.until_force.or_else(|| Some(self.until_pressure? * area?))
    }
}

/// The carrier's motion over a time, from where the carrier stands.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Duration, s.
    pub duration: f64,
    /// Displacement along x; of the drive of a body.
    pub u: Path,
    /// Displacement along z; of the drive of a body.
    pub w: Path,
    /// The load on a body along z without its constant part.
    pub load: Force,
    /// The tangential force on a body along x without its constant part.
    pub pull: Force,
    /// The layer's temperature, K, where it is an input; `None`: as it was.
    pub temperature: Option<f64>,
}

impl Motion {
    /// The displacement along an axis.
    pub fn path(&self, axis: Axis) -> Path {
        match axis {
            Axis::X => self.u,
            Axis::Z => self.w,
        }
    }

    /// The force on a body along an axis.
    pub fn force(&self, axis: Axis) -> Force {
        match axis {
            Axis::X => self.pull,
            Axis::Z => self.load,
        }
    }
}

/// A force from the start of a phase or a motion on, N, or a pressure, Pa.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Force {
    /// The value that it jumps to at the start; `None`: it goes on from what it has reached, 0 at first.
    pub start: Option<f64>,
    /// Its change from there.
    pub change: Path,
}

impl Force {
    /// `factor` times this.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        let Path { rate, amplitude, frequency } = self.change;
        let change = Path { rate: factor * rate, amplitude: factor * amplitude, frequency };
        Self { start: self.start.map(|start| factor * start), change }
    }
}

/// A change from the start: rate · s + amplitude · sin(2π frequency s), s the time since the start. It is one of a
/// displacement, in m, or of a [`Force`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Path {
    /// Constant rate, m/s.
    pub rate: f64,
    /// Amplitude of the sine, m.
    pub amplitude: f64,
    /// Frequency of the sine, Hz.
    pub frequency: f64,
}

impl Path {
    /// The displacement from `time` to `span` after it, s, m: where the rate is large and the time long, with more
    /// digits than the difference of two displacements.
    pub fn change(&self, time: f64, span: f64) -> f64 {
        let omega = TAU * self.frequency;
        let swing = if self.amplitude == 0.0 { 0.0 } else { (omega * (time + span)).sin() - (omega * time).sin() };
        self.rate * span + self.amplitude * swing
    }

    /// The period of the sine, s; infinite where there is none.
    pub fn period(&self) -> f64 {
        if self.amplitude == 0.0 || self.frequency == 0.0 { f64::INFINITY } else { 1.0 / self.frequency }
    }

    /// Displacement (m), velocity (m/s) and acceleration (m/s²) at `time` (s) after the start.
    #[inline]
    pub fn at(&self, time: f64) -> Jet {
        if self.amplitude == 0.0 {
            return Jet { position: self.rate * time, speed: self.rate, acceleration: 0.0 };
        }
        let omega = TAU * self.frequency;
        let (sine, cosine) = (omega * time).sin_cos();
        let swing = self.amplitude * sine;
        Jet {
            position: self.rate * time + swing,
            speed: self.rate + self.amplitude * omega * cosine,
            acceleration: -omega * omega * swing,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_has_the_rates_of_its_displacement() {
        let path = Path { rate: 0.3, amplitude: 1e-3, frequency: 40.0 };
        let (s, h) = (0.0123, 1e-6);
        let (here, around) = (path.at(s), path.at(s + h) - path.at(s - h));
        // Central differences: error h² ω³ amplitude / 6, and roundings of 1e-16 over h.
        assert!((around.position / (2.0 * h) - here.speed).abs() < 1e-8);
        assert!((around.speed / (2.0 * h) - here.acceleration).abs() < 1e-5);
    }
}
