//! Options that several commands have.

use std::ops::Deref;

use asperity::scene::Setting;
use asperity_study::sweep::SweepMethod;
use clap::Args;

use super::values::{count, length, pressure, share, speed, sweep_method};

// Not a doc comment: that would be the description of the commands that have it.
#[derive(Debug, Args)]
pub(crate) struct Set {
    /// Overrides a key of the scene or patch file: solver.relative_tolerance=1e-9,
    /// layer.vertical.maxwell[1].stiffness=0, friction.coulomb=0.5, surface="{ kind = 'flat' }". What the file does not
    /// have is added. May be repeated.
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<Setting>,
}

impl Deref for Set {
    type Target = [Setting];

    fn deref(&self) -> &Self::Target {
        &self.set
    }
}

// One state of steady sliding. Not a doc comment: that would be the description of the commands that have it.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct SteadyState {
    /// Mean pressure in Pa.
    #[arg(long, value_name = "PRESSURE", value_parser = pressure, allow_negative_numbers = true)]
    pub(crate) pressure: f64,
    /// Sliding speed in m/s.
    #[arg(long, value_name = "SPEED", value_parser = speed, allow_negative_numbers = true)]
    pub(crate) speed: f64,
}

// How the points of a sweep are found. Not a doc comment: that would be the description of the commands that have it.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct Sliding {
    /// How steady sliding is found: by solving for it, or by letting the layer slide until it is. Default: steady where the
    /// foundation is "half_space" or "layer" and the surface periodic and not flat; else layer.
    #[arg(long, value_name = "METHOD", value_parser = sweep_method())]
    pub(crate) method: Option<SweepMethod>,
    /// The way slid so far, in m: the scene's temperature is that of the rubber before it slid, not that of the surface around
    /// its contacts. With --method steady, of a scene with material.heat.
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_negative_numbers = true)]
    pub(crate) way: Option<f64>,
    /// Points of a period along x, with --method steady; of a map with those along y in proportion. Default: the surface's
    /// own, or of a profile 8 to its shortest wave where they are uneven or fewer.
    #[arg(long, value_name = "N", value_parser = count)]
    pub(crate) points: Option<u32>,
    /// Admissible standard error of the friction coefficient, relative to it, with --method layer. Default: 5e-3.
    #[arg(long, value_name = "SHARE", value_parser = share)]
    pub(crate) friction_error: Option<f64>,
    /// Maximum sliding distance in m for a point to become steady, with --method layer. Default: 100 blocks; a block is a
    /// whole number of profile periods or layer lengths.
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_negative_numbers = true)]
    pub(crate) distance: Option<f64>,
}
