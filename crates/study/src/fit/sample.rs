//! What a row of measured moduli says.

/// What was measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Test {
    /// E' and E'' over ω.
    Oscillation,
    /// E(t) after a step of strain.
    Relaxation,
}

/// Measured moduli at one frequency or time, at the reference temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Angular frequency ω, rad/s; or the time t, s.
    pub at: f64,
    /// Storage modulus E', or relaxation modulus E(t), Pa.
    pub storage: f64,
    /// Loss modulus E'', Pa; 0 of relaxation.
    pub loss: f64,
}

impl Sample {
    /// At a_T ω, or t/a_T: what it is at the reference temperature.
    pub(super) fn shifted(&self, factor: f64, test: Test) -> Self {
        let at = if test == Test::Oscillation { self.at * factor } else { self.at / factor };
        Self { at, ..*self }
    }

    /// With its moduli times a factor.
    pub(super) fn scaled(&self, factor: f64) -> Self {
        Self { at: self.at, storage: factor * self.storage, loss: factor * self.loss }
    }
}
