//! How far strain softens rubber in the roughness below the profile.

use serde::Serialize;

/// By what the moduli are less in the bands, where rubber is strained by tens of per cent.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Softening {
    /// s, 1: both moduli, whatever the strain.
    Factor(f64),
    /// By the strain, which rises; at least two rows. Factors are linear in its logarithm, and held beyond the ends.
    Table(Vec<SofteningRow>),
}

/// A row of a table of softening.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SofteningRow {
    /// The strain, 1.
    pub strain: f64,
    /// The factors there.
    pub factors: ModulusFactors,
}

/// Factors on the real (storage) and the imaginary (loss) part of a modulus.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ModulusFactors {
    /// On the storage modulus, 1.
    pub storage: f64,
    /// On the loss modulus, 1.
    pub loss: f64,
}

impl ModulusFactors {
    /// Of rubber that strain does not soften.
    pub const ONE: Self = Self { storage: 1.0, loss: 1.0 };
}

impl Softening {
    /// The factors at a `strain` ≥ 0, 1.
    pub fn factors(&self, strain: f64) -> ModulusFactors {
        let rows = match self {
            Self::Factor(factor) => return ModulusFactors { storage: *factor, loss: *factor },
            Self::Table(rows) => rows,
        };
        let above = rows.partition_point(|row| row.strain <= strain);
        match (above.checked_sub(1).and_then(|below| rows.get(below)), rows.get(above)) {
            (Some(below), Some(above)) => {
                let part = (strain / below.strain).ln() / (above.strain / below.strain).ln();
                let between = |low: f64, high: f64| low + part * (high - low);
                let (low, high) = (below.factors, above.factors);
                ModulusFactors { storage: between(low.storage, high.storage), loss: between(low.loss, high.loss) }
            }
            (Some(end), None) | (None, Some(end)) => end.factors,
            (None, None) => ModulusFactors::ONE,
        }
    }

    /// What it is, in a few words; `None` where it changes nothing.
    pub(super) fn describe(&self) -> Option<String> {
        match self {
            Self::Factor(1.0) => None,
            Self::Factor(factor) => Some(format!("softening {factor:?}")),
            Self::Table(rows) => {
                let [first, last] = [rows.first()?, rows.last()?].map(|row| row.strain);
                Some(format!("softening of a table of strains from {first:?} to {last:?}"))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_linear_in_the_logarithm_and_held_at_the_ends() {
        let row = |strain, storage, loss| SofteningRow { strain, factors: ModulusFactors { storage, loss } };
        let table = Softening::Table(vec![row(0.001, 1.0, 1.0), row(0.1, 0.5, 1.5), row(1.0, 0.25, 0.75)]);
        let at = |strain: f64| {
            let factors = table.factors(strain);
            [factors.storage, factors.loss]
        };
        assert_eq!((at(0.0), at(1e-3), at(1.0), at(7.0)), ([1.0; 2], [1.0; 2], [0.25, 0.75], [0.25, 0.75]));
        let middle = at(0.01);
        // Roundings of logarithms.
        assert!((middle[0] - 0.75).abs() < 1e-15 && (middle[1] - 1.25).abs() < 1e-15, "{middle:?}");
        assert_eq!(at(0.1), [0.5, 1.5]);
    }
}
