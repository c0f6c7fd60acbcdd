//! Whether measured E' and E'' belong together: for any linear material each follows from the other by the relations of
//! Kramers and Kronig.
//!
//! Over the data's own range these are those of the non-negative spectra: the spectrum that E' has, dense in relaxation
//! times, has an E'', and what E' leaves open of it, at the ends of the range above all, is left to the measured E''. So
//! what remains apart is a contradiction of the data. And the spectrum that comes nearest to both is what no series of
//! Maxwell elements is better than.

use std::f64::consts::TAU;

use super::compound::{Compound, FitErrors, Sample, Test};
use super::options::Weight;
use super::prony::PronyProblem;

/// Points a decade of the dense spectra.
const PER_DECADE: f64 = 12.0;

/// How far E' and E'' are apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Consistency {
    /// By decades of the frequency, from low to high.
    pub decades: Vec<DecadeConsistency>,
    /// The root mean square error (1) of both moduli that the best spectrum leaves.
    pub nearest: f64,
    /// The share of the squares of these errors that the means over decades make, beyond those of scatter: near 0 of
    /// scatter alone, near 1 where E' and E'' contradict each other.
    pub systematic: f64,
}

/// How far E' and E'' are apart in a decade.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DecadeConsistency {
    /// Where it begins, rad/s.
    pub from: f64,
    /// How many points lie within.
    pub rows: usize,
    /// The measured E'' over that of E', geometric mean.
    pub ratio: f64,
    /// Root mean square of the relative errors of E' that the best spectrum leaves.
    pub storage: f64,
    /// The same of E''.
    pub loss: f64,
}

impl Consistency {
    /// Of samples of oscillation; decades of frequencies in Hz if so wanted, else of rad/s.
    pub(super) fn of(samples: &[Sample], in_hertz: bool) -> Self {
        let of_storage = dense(samples, Weight::Storage);
        let best = dense(samples, Weight::Both);
        let unit = if in_hertz { TAU } else { 1.0 };
        // Rounding must not put 10 Hz below 10 Hz.
        let decade = |sample: &Sample| ((sample.at / unit).log10() + 1e-9).floor() as i32;
        let mut sorted = samples.to_vec();
        sorted.sort_by(|a, b| a.at.total_cmp(&b.at));
        let of_decade = |own: &[Sample]| {
            let logarithm = |sample: &Sample| (sample.loss / of_storage.complex_modulus(sample.at).1).ln();
            let errors = FitErrors::of(&best, own, Test::Oscillation);
            DecadeConsistency {
                from: unit * 10.0_f64.powi(decade(&own[0])),
                rows: own.len(),
                ratio: (own.iter().map(logarithm).sum::<f64>() / own.len() as f64).exp(),
                storage: errors.storage.rms,
                loss: errors.loss.rms,
            }
        };
        let decades = sorted.chunk_by(|a, b| decade(a) == decade(b)).map(of_decade).collect();
        let by_decade: Vec<&[Sample]> = sorted.chunk_by(|a, b| decade(a) == decade(b)).collect();
        let nearest = FitErrors::of(&best, samples, Test::Oscillation).both.rms;
        Self { decades, nearest, systematic: systematic(&best, &by_decade) }
    }

    /// Whether what the best spectrum leaves is a contradiction of both moduli, not scatter.
    pub fn is_contradiction(&self) -> bool {
        /// Of the squares.
        const MOST: f64 = 0.5;
        self.systematic > MOST
    }

    /// How far the means over decades are apart, as a share: root mean square over all points.
    pub fn apart(&self) -> f64 {
        let rows: usize = self.decades.iter().map(|decade| decade.rows).sum();
        let squares: f64 = self.decades.iter().map(|decade| decade.rows as f64 * decade.ratio.ln().powi(2)).sum();
        (squares / rows as f64).sqrt()
    }
}

/// The share of the squared errors that their means over decades make, without that of independent ones.
fn systematic(best: &Compound, by_decade: &[&[Sample]]) -> f64 {
    let (mut of_means, mut whole) = (0.0, 0.0);
    for own in by_decade.iter().filter(|own| own.len() > 1) {
        let errors = |of: fn(&Sample, (f64, f64)) -> f64| {
            own.iter().map(|sample| of(sample, best.complex_modulus(sample.at))).collect::<Vec<f64>>()
        };
        let (storage, loss) = (errors(|at, fit| fit.0 / at.storage - 1.0), errors(|at, fit| fit.1 / at.loss - 1.0));
        for errors in [storage, loss] {
            let count = errors.len() as f64;
            let squares: f64 = errors.iter().map(|error| error * error).sum();
            let of_mean = errors.iter().sum::<f64>().powi(2) / count;
            of_means += of_mean - (squares - of_mean) / (count - 1.0);
            whole += squares;
        }
    }
    if whole > 0.0 { (of_means / whole).clamp(0.0, 1.0) } else { 0.0 }
}

fn dense(samples: &[Sample], weight: Weight) -> Compound {
    let problem = PronyProblem::new(samples, Test::Oscillation, true, weight);
    problem.solve(&problem.grid(PER_DECADE)).compound()
}

#[cfg(test)]
mod tests {
    use asperity::scene::PronyTerm;

    use super::*;

    /// A broad spectrum, of which the data see the middle: 8 points a decade from 1e-2 to 1e6 rad/s.
    fn curve(factor: f64) -> Vec<Sample> {
        let term =
            |i: i32| PronyTerm { relaxation_time: 10_f64.powi(-i), modulus: 1e6 * 10_f64.powf(f64::from(i) / 5.0) };
        let compound = Compound { equilibrium_modulus: 1e6, viscosity: 0.0, terms: (-4..10).map(term).collect() };
        let sample = |i: i32| {
            let at = 10_f64.powf(f64::from(i) / 8.0);
            let (storage, loss) = compound.complex_modulus(at);
            Sample { at, storage, loss: factor * loss }
        };
        (-16..=48).map(sample).collect()
    }

    #[test]
    fn moduli_of_one_spectrum_are_not_apart() {
        let found = Consistency::of(&curve(1.0), false);
        assert!(found.nearest < 2e-3 && found.apart() < 5e-3, "{found:?}");
        assert_eq!((found.decades.len(), found.decades[0].rows), (9, 8));
        assert!((found.decades[0].from / 1e-2 - 1.0).abs() < 1e-12);
    }

    /// A factor on E'' is found where E' says what it should be: everywhere but in the first and the last decades, of
    /// which terms beyond the data make a part.
    #[test]
    fn a_factor_on_the_loss_is_found() {
        for factor in [0.7, 1.3] {
            let found = Consistency::of(&curve(factor), false);
            for decade in &found.decades[1..6] {
                assert!((decade.ratio / factor - 1.0).abs() < 0.03, "{factor} {found:?}");
            }
            assert!(found.nearest > 0.05 && found.apart() > 0.2 && found.is_contradiction(), "{found:?}");
        }
    }
}
