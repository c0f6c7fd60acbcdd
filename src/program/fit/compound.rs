//! A Prony series and how far it is from measured moduli.

use asperity::scene::{MaxwellElement, PronyTerm, complex_stiffness};

/// What was measured at one frequency, at the reference temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sample {
    /// Angular frequency ω, rad/s.
    pub(super) omega: f64,
    /// Storage modulus E', Pa.
    pub(super) storage: f64,
    /// Loss modulus E'', Pa.
    pub(super) loss: f64,
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

/// Real and imaginary part of ix/(1 + ix), x = ωτ.
pub(super) fn relaxation(x: f64) -> (f64, f64) {
    complex_stiffness(0.0, 0.0, [MaxwellElement { stiffness: 1.0, relaxation_time: 1.0 }], x)
}

impl Compound {
    /// E' and E'' at ω, Pa (2).
    pub(super) fn complex_modulus(&self, omega: f64) -> (f64, f64) {
        let elements = self.terms.iter().map(PronyTerm::element);
        complex_stiffness(self.equilibrium_modulus, self.viscosity, elements, omega)
    }

    /// The same with `digits` significant digits, at least four more than `error` has noughts: what is written is what
    /// the error is told of.
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

/// Relative errors of a quantity, 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Error {
    /// Root mean square over the points.
    pub(super) rms: f64,
    pub(super) largest: f64,
    /// Where it is largest, rad/s.
    pub(super) at: f64,
}

/// How far a series is from what was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Errors {
    pub(super) storage: Error,
    pub(super) loss: Error,
    pub(super) loss_tangent: Error,
    /// E' and E'' together: what the search bounds.
    pub(super) both: Error,
}

impl Errors {
    pub(super) fn of(compound: &Compound, samples: &[Sample]) -> Self {
        let of = |error: fn(&Sample, f64, f64) -> f64| {
            Error::of(samples.iter().map(|sample| {
                let (storage, loss) = compound.complex_modulus(sample.omega);
                (sample.omega, error(sample, storage, loss))
            }))
        };
        let storage = of(|sample, storage, _| storage / sample.storage - 1.0);
        let loss = of(|sample, _, loss| loss / sample.loss - 1.0);
        let loss_tangent = of(|sample, storage, loss| loss / storage * sample.storage / sample.loss - 1.0);
        let worse = if storage.largest > loss.largest { storage } else { loss };
        let rms = ((storage.rms.powi(2) + loss.rms.powi(2)) / 2.0).sqrt();
        Self { storage, loss, loss_tangent, both: Error { rms, ..worse } }
    }

    #[cfg(test)]
    pub(super) fn largest(&self) -> f64 {
        self.both.largest
    }
}

impl Error {
    fn of(errors: impl Iterator<Item = (f64, f64)>) -> Self {
        let (mut squares, mut count, mut found) = (0.0, 0.0, Self::default());
        for (omega, error) in errors {
            squares += error * error;
            count += 1.0;
            if error.abs() >= found.largest {
                found = Self { largest: error.abs(), at: omega, ..found };
            }
        }
        Self { rms: (squares / count).sqrt(), ..found }
    }
}
