//! The motion of the carrier in runs without a master: phases, one after another.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

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

    /// F_z at which the phase of a layer of this area (m²) ends, N, if it does: given, or that of the pressure.
    pub fn end_force(&self, area: Option<f64>) -> Option<f64> {
        self.until_force.or_else(|| Some(self.until_pressure? * area?))
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
    /// The displacement at `time` (s) after the start, m.
    pub fn at(&self, time: f64) -> f64 {
        self.motion(time)[0]
    }

    /// The velocity at `time` (s) after the start, m/s.
    pub fn velocity(&self, time: f64) -> f64 {
        self.motion(time)[1]
    }

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
    pub fn motion(&self, time: f64) -> [f64; 3] {
        if self.amplitude == 0.0 {
            return [self.rate * time, self.rate, 0.0];
        }
        let omega = TAU * self.frequency;
        let (sine, cosine) = (omega * time).sin_cos();
        let swing = self.amplitude * sine;
        [self.rate * time + swing, self.rate + self.amplitude * omega * cosine, -omega * omega * swing]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_has_the_rates_of_its_displacement() {
        let path = Path { rate: 0.3, amplitude: 1e-3, frequency: 40.0 };
        let (s, h) = (0.0123, 1e-6);
        let [_, velocity, acceleration] = path.motion(s);
        let difference = |component: usize| (path.motion(s + h)[component] - path.motion(s - h)[component]) / (2.0 * h);
        // Central differences: error h² ω³ amplitude / 6, and roundings of 1e-16 over h.
        assert!((difference(0) - velocity).abs() < 1e-8);
        assert!((difference(1) - acceleration).abs() < 1e-5);
    }
}
