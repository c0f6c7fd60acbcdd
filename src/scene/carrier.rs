//! The carrier as a body: an axis along which loads and a drive move it, not a prescribed displacement.

use serde::{Deserialize, Serialize};

use super::values::Word;
use super::{Axis, ByAxis, Unit};

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
