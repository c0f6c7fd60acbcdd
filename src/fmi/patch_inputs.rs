//! The inputs of a patch and the motion that follows from them: between communication points the pose is continuous and
//! runs straight to its targets; a temperature is held.

use serde::{Deserialize, Serialize};

use crate::patch::{COORDINATES, Patch, PatchMotion, PatchRun, PatchStart, Pose};
use crate::scene::{Extrapolation, Unit, is_possible};

use super::error::InputOutOfRange;
use super::inputs::Signal;

/// An input of a patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PatchInput {
    /// A coordinate of the pose: x, y, z, roll, pitch, yaw.
    Coordinate(usize),
    /// The speed of the tread.
    TransportSpeed,
    /// The temperature.
    Temperature,
}

impl PatchInput {
    /// The inputs of a patch, in the order of their value references.
    pub fn of(patch: &Patch) -> Vec<Self> {
        let optional =
            [patch.has_tread().then_some(Self::TransportSpeed), patch.has_temperatures().then_some(Self::Temperature)];
        (0..COORDINATES.len()).map(Self::Coordinate).chain(optional.into_iter().flatten()).collect()
    }

    /// The variable's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Coordinate(i) => COORDINATES[i],
            Self::TransportSpeed => "transport.speed",
            Self::Temperature => "temperature",
        }
    }

    /// The variable's unit.
    pub fn unit(self) -> Unit {
        match self {
            Self::Coordinate(0..3) => Unit::Meter,
            Self::Coordinate(_) => Unit::Radian,
            Self::TransportSpeed => Unit::MeterPerSecond,
            Self::Temperature => Unit::Kelvin,
        }
    }

    /// What it is, in a few words.
    pub fn description(self) -> &'static str {
        match self {
            Self::Coordinate(0) => "Position of the body ahead",
            Self::Coordinate(1) => "Position of the body to the left",
            Self::Coordinate(2) => "Height of the body above the ground",
            Self::Coordinate(3) => "Roll of the body about its x axis, after pitch and yaw",
            Self::Coordinate(4) => "Pitch of the body about its y axis, after yaw",
            Self::Coordinate(_) => "Yaw of the body about the z axis",
            Self::TransportSpeed => "Speed at which the tread runs to the rear",
            Self::Temperature => "Temperature, held over each communication step",
        }
    }

    /// Its start value.
    pub fn start(self, patch: &Patch) -> f64 {
        match self {
            Self::Coordinate(2) => patch.clear_height(),
            Self::Temperature => patch.temperature(),
            _ => 0.0,
        }
    }

    fn index(self) -> usize {
        match self {
            Self::Coordinate(i) => i,
            Self::TransportSpeed => 6,
            Self::Temperature => 7,
        }
    }
}

/// The inputs as the master sets them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct PatchInputs {
    signals: [Signal; 8],
}

impl PatchInputs {
    /// The start values.
    pub(super) fn new(patch: &Patch) -> Self {
        let mut inputs = Self::default();
        PatchInput::of(patch).into_iter().for_each(|input| inputs.set(input, input.start(patch)));
        inputs
    }

    pub(super) fn get(&self, input: PatchInput) -> f64 {
        self.signals[input.index()].value()
    }

    pub(super) fn set(&mut self, input: PatchInput, value: f64) {
        self.signals[input.index()].set(value);
    }

    /// Sets the first derivative of an input for the next step; a temperature has none that counts.
    pub(super) fn set_rate(&mut self, input: PatchInput, rate: f64) {
        self.signals[input.index()].set_rate(rate);
    }

    fn pose(&self) -> [f64; 6] {
        std::array::from_fn(|i| self.signals[i].value())
    }

    /// The start of a run: at the values given, moving at the derivatives given, else at rest.
    pub(super) fn start(&self, time: f64) -> PatchStart {
        PatchStart {
            time,
            pose: Pose::from_coordinates(self.pose()),
            rates: std::array::from_fn(|i| self.signals[i].rate().unwrap_or_default()),
            transport_speed: self.get(PatchInput::TransportSpeed),
            temperature: self.get(PatchInput::Temperature),
        }
    }

    /// The motion of a run over a step of `h` (s).
    pub(super) fn motion(&self, run: &PatchRun, h: f64, rule: Extrapolation) -> Result<PatchMotion, InputOutOfRange> {
        let time = run.time();
        let target = |input: PatchInput| self.signals[input.index()].checked_target(input.name(), time, h, rule);
        let current = run.pose().coordinates();
        let mut rates = [0.0; 6];
        for (i, rate) in rates.iter_mut().enumerate() {
            let target = target(PatchInput::Coordinate(i))?;
            *rate = self.signals[i].given_rate(current[i]).unwrap_or((target - current[i]) / h);
        }
        let temperature = self.get(PatchInput::Temperature);
        if !is_possible(temperature) {
            return Err(InputOutOfRange { name: PatchInput::Temperature.name(), value: temperature, time });
        }
        Ok(PatchMotion { duration: h, rates, transport_speed: target(PatchInput::TransportSpeed)?, temperature })
    }

    /// Whether a run can have reached these inputs.
    pub(super) fn is_valid(&self) -> bool {
        self.signals.iter().all(Signal::is_valid)
    }

    /// Completes a step of `h`: its derivatives apply to no other.
    pub(super) fn complete_step(&mut self, h: f64) {
        self.signals.iter_mut().for_each(|signal| signal.complete_step(h));
    }
}
