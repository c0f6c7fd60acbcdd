//! What acts on the ends of a part of a layer that is simulated on its own: the links to the rest of it.

use super::{ByAxis, CarrierPoint};

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
