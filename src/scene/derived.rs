//! What follows from a scene without a run.

use std::f64::consts::TAU;
use std::path::Path as FilePath;
use std::{fs, io};

use super::points::peak_to_valley;
use super::{Path, RateShear, Scene, allowed};

/// A name as a C identifier: letters, digits and underscores, no digit first.
pub fn identifier(name: &str) -> String {
    let legal = |letter: char| if letter.is_ascii_alphanumeric() { letter } else { '_' };
    let identifier: String = name.chars().map(legal).collect();
    if identifier.starts_with(|first: char| first.is_ascii_digit()) { format!("_{identifier}") } else { identifier }
}

impl Scene {
    /// The scene's name as a C identifier: letters, digits and underscores, no digit first.
    pub fn model_identifier(&self) -> String {
        identifier(&self.name)
    }

    /// The bytes of one of the scene's [`files`](Self::files) as an FMU carries them; `folder` is the scene's.
    ///
    /// # Errors
    /// Where the file cannot be read.
    pub fn carried(&self, folder: &FilePath, file: &FilePath) -> io::Result<Vec<u8>> {
        match self.extracts.iter().find(|extract| extract.name == file) {
            Some(extract) => Ok(extract.text.clone().into_bytes()),
            None => fs::read(folder.join(file)),
        }
    }

    /// The scene's height, m: the peak-to-valley heights of the profile's data points and of the layer's roughness
    /// together, the spacing of the masses where both are flat.
    pub fn height(&self) -> f64 {
        let height = peak_to_valley(&self.surface.z) + peak_to_valley(&self.layer.roughness);
        if height > 0.0 { height } else { self.layer.spacing }
    }

    /// The absolute tolerance, m: as it was set, or the relative one times the [`height`](Self::height), as far as that
    /// may be set.
    pub fn absolute_tolerance(&self) -> f64 {
        let default = || (self.solver.relative_tolerance * self.height()).max(allowed::SMALLEST);
        self.solver.absolute_tolerance.unwrap_or_else(default)
    }
}

impl RateShear {
    /// The creep speed, m/s: as it was set, or a millionth of the reference speed, as far as that may be set.
    pub fn creep_speed(&self) -> f64 {
        self.creep_speed.unwrap_or_else(|| (CREEP * self.reference_speed).max(allowed::SMALLEST))
    }
}

/// The creep speed over the reference speed where the scene does not say.
const CREEP: f64 = 1e-6;

impl Path {
    /// The displacement since the start at `time` (s) after it, m.
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
