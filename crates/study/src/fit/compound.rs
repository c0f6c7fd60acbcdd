//! Measured moduli, a compound as a Prony series, and its errors at them.
//!
//! The error of a series is the root mean square of the relative errors of both moduli at all N points,
//!
//! ε² = (1/2N) Σ [(E'/E'_measured - 1)² + (E''/E''_measured - 1)²].

use asperity::scene::{PronyTerm, complex_stiffness};

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

/// A spring, a dashpot and Maxwell elements in parallel, as moduli.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Compound {
    /// E_∞, Pa.
    pub(super) equilibrium_modulus: f64,
    /// Kelvin-Voigt viscosity η, Pa s.
    pub(super) viscosity: f64,
    /// (τ_j, E_j), from short to long.
    pub(super) terms: Vec<PronyTerm>,
}

impl Compound {
    /// E' and E'' at ω, or E(t) and 0, Pa.
    pub(super) fn response(&self, test: Test, at: f64) -> (f64, f64) {
        match test {
            Test::Oscillation => self.complex_modulus(at),
            Test::Relaxation => {
                let terms = self.terms.iter().map(|term| term.modulus * (-at / term.relaxation_time).exp());
                (self.equilibrium_modulus + terms.sum::<f64>(), 0.0)
            }
        }
    }

    /// E' and E'' at ω, Pa (2).
    pub(super) fn complex_modulus(&self, omega: f64) -> (f64, f64) {
        let elements = self.terms.iter().map(PronyTerm::element);
        complex_stiffness(self.equilibrium_modulus, self.viscosity, elements, omega)
    }

    /// The compound with some digits more than a fit of relative error `error` warrants. Errors are reported for the
    /// rounded compound, as it is written to the file.
    pub(super) fn rounded(&self, error: f64) -> Self {
        let digits = (3.0 - error.log10()).ceil().clamp(4.0, 17.0) as usize;
        let round = |value: f64| format!("{value:.*e}", digits - 1).parse().unwrap_or(value);
        let term =
            |term: &PronyTerm| PronyTerm { relaxation_time: round(term.relaxation_time), modulus: round(term.modulus) };
        Self {
            equilibrium_modulus: round(self.equilibrium_modulus),
            viscosity: round(self.viscosity),
            terms: self.terms.iter().map(term).collect(),
        }
    }
}

/// Relative error of a quantity, 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RelativeError {
    /// Root mean square over the points.
    pub rms: f64,
    /// The largest one.
    pub largest: f64,
    /// Angular frequency (rad/s) or time (s) of the largest error.
    pub at: f64,
}

/// Errors of a compound at measured points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FitErrors {
    /// Of E', or of E(t).
    pub storage: RelativeError,
    /// Of E''; 0 of relaxation.
    pub loss: RelativeError,
    /// Of tan δ; 0 of relaxation.
    pub loss_tangent: RelativeError,
    /// E' and E'' together: the error that the search bounds.
    pub both: RelativeError,
}

impl FitErrors {
    /// The errors at samples of a test; of relaxation those of E(t) alone.
    pub(super) fn of(compound: &Compound, samples: &[Sample], test: Test) -> Self {
        let of = |error: fn(&Sample, f64, f64) -> f64| {
            RelativeError::of(samples.iter().map(|sample| {
                let (storage, loss) = compound.response(test, sample.at);
                (sample.at, error(sample, storage, loss))
            }))
        };
        let storage = of(|sample, storage, _| storage / sample.storage - 1.0);
        if test == Test::Relaxation {
            return Self { storage, both: storage, ..Self::default() };
        }
        let loss = of(|sample, _, loss| loss / sample.loss - 1.0);
        let loss_tangent = of(|sample, storage, loss| loss / storage * sample.storage / sample.loss - 1.0);
        let worse = if storage.largest > loss.largest { storage } else { loss };
        let rms = ((storage.rms.powi(2) + loss.rms.powi(2)) / 2.0).sqrt();
        Self { storage, loss, loss_tangent, both: RelativeError { rms, ..worse } }
    }
}

impl RelativeError {
    fn of(errors: impl Iterator<Item = (f64, f64)>) -> Self {
        let (mut squares, mut count, mut found) = (0.0, 0.0, Self::default());
        for (at, error) in errors {
            squares += error * error;
            count += 1.0;
            if error.abs() >= found.largest {
                found = Self { largest: error.abs(), at, ..found };
            }
        }
        Self { rms: (squares / count).sqrt(), ..found }
    }
}
