//! A surface that is smoothed, split and made periodic, and its analysis.

use std::ops::RangeInclusive;

use asperity::scene::{RoughnessSpectrum, SplitError, Surface};

use super::analysis::{FinerWaves, Removed, SurfaceAnalysis};
use super::periodic::{mirrored, tapered};

/// How a surface that ends becomes periodic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MadePeriodic {
    /// By the mirror image behind the map, or behind the profile where that is read alone.
    Mirrored,
    /// The profile by its end, which goes over into its beginning.
    Tapered,
}

/// What is done with a surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceOptions {
    /// The wavelength below which waves are taken away, m.
    pub smooth: Option<f64>,
    /// The wavelength below which waves become a spectrum, m.
    pub split: Option<f64>,
    /// How it becomes periodic.
    pub periodic: Option<MadePeriodic>,
    /// Whether it is a line of a map that was chosen, whose map stays as it is.
    pub line_alone: bool,
    /// The wavelengths that the power law is fitted to, m; `None`: the widest range that follows one.
    pub wavelengths: Option<RangeInclusive<f64>>,
}

/// A surface cannot be made what is asked for.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SurfaceError {
    /// It is periodic.
    #[error("`mirror` and `taper` make a profile periodic, and it is")]
    AlreadyPeriodic,
    /// It is no longer than the waves that are to be taken away.
    #[error("`smooth` {smooth:?}: expected at most {length:?} m, the length of the profile; lengths are in m")]
    Smooth {
        /// The wavelength asked for, m.
        smooth: f64,
        /// The length of the profile, m.
        length: f64,
    },
    /// It is too short or too coarse to be split.
    #[error("`split` {split:?}: expected {expected}")]
    Split {
        /// The wavelength asked for, m.
        split: f64,
        /// What could be.
        expected: SplitError,
    },
}

crate::error::of_kind! { SurfaceError => Value }

/// A surface before and after, and its analysis.
#[derive(Debug)]
pub struct TreatedSurface {
    /// As it was read.
    pub read: Surface,
    /// As it is now.
    pub surface: Surface,
    /// The spectrum of the waves that were split off.
    pub finer: Option<RoughnessSpectrum>,
    /// Of the surface as it is now.
    pub analysis: SurfaceAnalysis,
}

impl TreatedSurface {
    /// Smooths or splits a surface, makes it periodic and analyses it, each as asked for.
    ///
    /// # Errors
    /// Where it is periodic already, or cannot be split at that wavelength.
    pub fn new(read: Surface, options: &SurfaceOptions) -> Result<Self, SurfaceError> {
        if options.periodic.is_some() && read.is_periodic() {
            return Err(SurfaceError::AlreadyPeriodic);
        }
        let length = read.x()[read.x().len() - 1] - read.x()[0];
        if let Some(smooth) = options.smooth.filter(|smooth| *smooth > length) {
            return Err(SurfaceError::Smooth { smooth, length });
        }
        let split = |split: f64| read.split(split).map_err(|expected| SurfaceError::Split { split, expected });
        let (smooth, finer) = match options.split.map(split).transpose()? {
            Some(parts) => (parts.profile, Some(parts.finer)),
            None => (options.smooth.map_or_else(|| read.clone(), |cut_off| read.smoothed(cut_off)), None),
        };
        let removed = options.smooth.or(options.split).map(|cut_off| Removed::of(&read, &smooth, cut_off));
        let surface = match options.periodic {
            Some(MadePeriodic::Mirrored) => match smooth.map().filter(|_| !options.line_alone) {
                Some(map) => Surface::of_map(map.mirrored(), true),
                None => mirrored(&smooth),
            },
            Some(MadePeriodic::Tapered) => tapered(&smooth),
            None => smooth,
        };
        let waves = finer.as_ref().map(FinerWaves::of);
        let of_surface = SurfaceAnalysis::of(&surface, options.wavelengths.as_ref());
        let analysis = SurfaceAnalysis { removed, finer: waves, ..of_surface };
        Ok(Self { read, surface, finer, analysis })
    }
}
