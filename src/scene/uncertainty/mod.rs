//! What is not known of a scene: how far its numbers may be off, as the section `[uncertainty]` says.
//!
//! It is data alone: nothing of a run depends on it, and a run's scene is the same with and without.

mod covariance;
mod spectrum;
#[cfg(test)]
mod tests;

use std::path::PathBuf;

use super::values::Word;

pub(super) use covariance::read_covariance;
pub use covariance::{Covariance, FittedNumber, Scale};

/// What is not known of a scene; empty where it does not say.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Uncertainty {
    /// What may be off by itself, in the order of the keys.
    pub keys: Vec<UncertainKey>,
    /// Numbers that were fitted together; `None` without.
    pub covariance: Option<Covariance>,
}

/// A key of the scene, and how far what it says may be off.
#[derive(Clone, Debug, PartialEq)]
pub struct UncertainKey {
    /// The path of the key, elements of lists counted from 1.
    pub key: String,
    /// What may be off, and how.
    pub spread: Spread,
}

/// How far something may be off.
#[derive(Clone, Debug, PartialEq)]
pub enum Spread {
    /// A number.
    Number {
        /// What the scene says, in SI units.
        value: f64,
        /// How far it may be off.
        distribution: Distribution,
    },
    /// All moduli of the Prony series: log-normal, with one normal process over the logarithm of the relaxation time.
    Prony {
        /// Standard deviation of the logarithm of each modulus.
        relative: f64,
        /// log10 of the relaxation times over 1 s.
        decades: Vec<f64>,
    },
    /// The density of the spectrum of profile and bands: log-normal.
    Spectrum {
        /// Standard deviation of the logarithm.
        relative: f64,
        /// The [decades](decade_of) of wavelengths that differ by themselves; `None`: one factor for all.
        decades: Option<Vec<i32>>,
    },
    /// Another self-affine surface of the same law each time.
    Seed,
}

/// How a number is distributed about what the scene says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Distribution {
    /// Log-normal: the standard deviation of the logarithm.
    Relative(f64),
    /// Log-uniform from one over this to this times the number.
    Factor(f64),
    /// Normal: the standard deviation, in the unit of the number.
    Absolute(f64),
}

/// What stands in the place of a distribution for a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Other {
    Seed,
}

impl Word for Other {
    const WORDS: &'static [(&'static str, Self)] = &[("seed", Self::Seed)];
}

/// What varies by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Each {
    Decade,
}

impl Word for Each {
    const WORDS: &'static [(&'static str, Self)] = &[("decade", Self::Decade)];
}

impl Uncertainty {
    /// The moduli of the Prony series.
    pub const PRONY: &str = "material.prony";
    /// The density of the spectrum.
    pub const SPECTRUM: &str = "surface.spectrum";
    /// The seed of a self-affine surface.
    pub const SURFACE: &str = "surface";

    /// Whether everything is known.
    pub fn is_empty(&self) -> bool {
        self.keys.is_empty() && self.covariance.is_none()
    }

    /// The file of the covariance, relative to the scene's folder.
    pub fn file(&self) -> Option<&PathBuf> {
        self.covariance.as_ref().map(|covariance| &covariance.file)
    }
}

impl Spread {
    /// That of the moduli of these relaxation times (s).
    pub(super) fn of_prony(relative: f64, times: impl Iterator<Item = f64>) -> Self {
        Self::Prony { relative, decades: times.map(f64::log10).collect() }
    }
}
