//! The carrier's motion.

use serde::{Deserialize, Serialize};

use crate::math::Spline;
use crate::scene::Path;

/// The carrier on a smooth piece of its motion. Displacements are counted from the start of the piece, so that a carrier
/// far away loses no digits but those of u itself.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Carrier {
    /// Time at the start of the piece, s.
    pub time: f64,
    /// u at the start of the piece, m.
    pub u: f64,
    /// w at the start of the piece, m.
    pub w: f64,
    /// u at the start of the piece as a position on the profile, m: reduced to its period if it is periodic.
    pub profile_position: f64,
    u_path: Path,
    w_path: Path,
}

/// The carrier at one instant of a piece.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CarrierPoint {
    /// u minus u at the start of the piece, m.
    pub du: f64,
    /// w minus w at the start of the piece, m.
    pub dw: f64,
    /// u̇, m/s.
    pub u_rate: f64,
    /// ẇ, m/s.
    pub w_rate: f64,
    /// ü, m/s².
    pub u_acceleration: f64,
    /// ẅ, m/s².
    pub w_acceleration: f64,
}

/// Position of the carrier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CarrierPosition {
    /// u as a position on the profile, reduced to its period, m.
    pub profile_position: f64,
    /// w, m.
    pub w: f64,
}

impl Carrier {
    /// A piece that starts at `time` (s) from `u`, `w` (m) over `profile`.
    pub fn new(time: f64, (u, w): (f64, f64), (u_path, w_path): (Path, Path), profile: &Spline) -> Self {
        Self { time, u, w, profile_position: profile.reduce(u), u_path, w_path }
    }

    /// The carrier at the time `s` after the start of the piece, s.
    pub fn at(&self, s: f64) -> CarrierPoint {
        let [du, u_rate, u_acceleration] = self.u_path.motion(s);
        let [dw, w_rate, w_acceleration] = self.w_path.motion(s);
        CarrierPoint { du, dw, u_rate, w_rate, u_acceleration, w_acceleration }
    }

    /// The carrier's position at the time `s` after the start of the piece, s.
    pub fn position(&self, s: f64) -> CarrierPosition {
        let point = self.at(s);
        CarrierPosition { profile_position: self.profile_position + point.du, w: self.w + point.dw }
    }

    /// Computes the position on the profile anew from u.
    pub fn find_profile_position(&mut self, profile: &Spline) {
        self.profile_position = profile.reduce(self.u);
    }

    /// The changes of u and w from the time `s` on over `span`, m; both in s.
    pub fn moved(&self, s: f64, span: f64) -> (f64, f64) {
        (self.u_path.change(s, span), self.w_path.change(s, span))
    }

    /// The shorter period of the two sines, s; infinite if there is none.
    pub fn shortest_period(&self) -> f64 {
        self.u_path.period().min(self.w_path.period())
    }

    /// The amplitude of the sine of w, m.
    pub fn amplitude_w(&self) -> f64 {
        self.w_path.amplitude.abs()
    }

    /// All numbers of the piece, to be checked.
    pub fn numbers(&self) -> [f64; 10] {
        let Self { time, u, w, profile_position, u_path, w_path } = *self;
        let [u_path, w_path] = [u_path, w_path].map(|path| [path.rate, path.amplitude, path.frequency]);
        let ([a, b, c], [d, e, f]) = (u_path, w_path);
        [time, u, w, profile_position, a, b, c, d, e, f]
    }
}
