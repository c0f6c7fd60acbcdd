//! The search for the fewest terms within an error bound.
//!
//! The moduli of a fine grid of relaxation times have the smallest error of any series. Neighbours on the grid are merged
//! into one term between them. Then terms are removed one by one, those that matter least first, and after each removal the
//! relaxation times of the others are optimised.

use super::compound::Compound;
use super::options::Weight;
use super::prony_problem::{PronyProblem, Solution};
use super::sample::{Sample, Test};

/// Points of the fine grid per decade. Two neighbours together represent a term half way between them up to 2e-3.
const PER_DECADE: f64 = 8.0;
/// Where the requested error cannot be reached, the search accepts this multiple of the smallest error.
const NEAR: f64 = 1.01;
/// Number of terms tried for removal: those whose removal costs least while the others are fixed.
const CANDIDATES: usize = 3;

/// What the search may use and has to reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Target {
    /// The admissible error ε, 1.
    pub(super) error: f64,
    /// Whether a Kelvin-Voigt viscosity is among the unknowns.
    pub(super) viscosity: bool,
    /// What the samples are.
    pub(super) test: Test,
    /// Which modulus counts.
    pub(super) weight: Weight,
}

/// The series with the fewest terms found within the target's error or, if it cannot be reached, within [`NEAR`] of the
/// smallest error.
pub(super) fn search(samples: &[Sample], target: &Target) -> Compound {
    let problem = PronyProblem::new(samples, target.test, target.viscosity, target.weight);
    let fine = problem.solve(&problem.grid(PER_DECADE));
    let mut best = problem.refine(problem.solve(&fine.merged(PER_DECADE)));
    if best.error > target.error {
        let unmerged = problem.refine(fine);
        best = if NEAR * unmerged.error < best.error { unmerged } else { best };
    }
    let goal = target.error.max(NEAR * best.error);
    while let Some(fewer) = problem.without_one(&best, goal) {
        best = fewer;
    }
    best.compound()
}

impl PronyProblem<'_> {
    /// The solution without one of its terms, if the error then stays within `goal`.
    fn without_one(&self, solution: &Solution, goal: f64) -> Option<Solution> {
        let without = |i: usize| {
            let mut rest = solution.times.clone();
            rest.remove(i);
            self.solve(&rest)
        };
        let by_error = |a: &Solution, b: &Solution| a.error.total_cmp(&b.error);
        let mut fewer: Vec<Solution> = (0..solution.times.len()).map(without).collect();
        fewer.sort_by(by_error);
        let refined = fewer.into_iter().take(CANDIDATES).map(|fewer| self.refine(fewer));
        refined.filter(|fewer| fewer.error <= goal).min_by(by_error)
    }
}

#[cfg(test)]
mod tests {
    use asperity::math::SplitMix64;
    use asperity::scene::PronyTerm;

    use super::*;
    use crate::fit::compound::FitErrors;

    /// Points of `compound`, five a decade from 10^low to 10^high rad/s.
    fn samples(compound: &Compound, low: i32, high: i32) -> Vec<Sample> {
        let at = |i: i32| {
            let omega = 10.0_f64.powf(f64::from(i) / 5.0);
            let (storage, loss) = compound.complex_modulus(omega);
            Sample { at: omega, storage, loss }
        };
        (5 * low..=5 * high).map(at).collect()
    }

    fn series(equilibrium_modulus: f64, terms: &[(f64, f64)]) -> Compound {
        let term = |&(relaxation_time, modulus): &(f64, f64)| PronyTerm { relaxation_time, modulus };
        Compound { equilibrium_modulus, viscosity: 0.0, terms: terms.iter().map(term).collect() }
    }

    fn three() -> Compound {
        series(2e6, &[(1.3e-5, 5e6), (3.1e-3, 3e6), (0.7, 1e6)])
    }

    /// A tread-like rubber, one term a decade.
    fn sixteen() -> Compound {
        let moduli =
            [1538.0, 888.0, 824.0, 495.0, 201.0, 76.3, 31.9, 14.8, 8.12, 4.65, 3.16, 2.26, 1.67, 1.42, 0.969, 1.26];
        let terms: Vec<(f64, f64)> =
            (-13..).map(|i| 10.0_f64.powi(i)).zip(moduli.map(|modulus| 1e6 * modulus)).collect();
        series(4.44e6, &terms)
    }

    fn find(samples: &[Sample], error: f64) -> (Compound, FitErrors) {
        let compound =
            search(samples, &Target { error, viscosity: false, test: Test::Oscillation, weight: Weight::Both });
        let errors = FitErrors::of(&compound, samples, Test::Oscillation);
        (compound, errors)
    }

    /// Multiplies the moduli by 1 + `sigma` times a normal deviate (Box-Muller).
    fn noisy(mut samples: Vec<Sample>, sigma: f64) -> Vec<Sample> {
        let mut random = SplitMix64::new(1);
        let mut normal = || (-2.0 * (1.0 - random.unit()).ln()).sqrt() * (std::f64::consts::TAU * random.unit()).cos();
        for sample in &mut samples {
            sample.storage *= 1.0 + sigma * normal();
            sample.loss *= 1.0 + sigma * normal();
        }
        samples
    }

    /// No fewer terms suffice, so the search ends at the terms themselves.
    #[test]
    fn known_terms_are_found_again() {
        for (known, low, high) in [(three(), -3, 7), (sixteen(), -5, 15)] {
            let (found, errors) = find(&samples(&known, low, high), 1e-3);
            assert_eq!(found.terms.len(), known.terms.len());
            assert!(errors.both.largest < 1e-9, "{errors:?}");
            for (found, known) in found.terms.iter().zip(&known.terms) {
                // The moduli of neighbours differ by 1e3, which amplifies rounding errors as much.
                assert!((found.relaxation_time / known.relaxation_time - 1.0).abs() < 1e-6, "{found:?} {known:?}");
                assert!((found.modulus / known.modulus - 1.0).abs() < 1e-6, "{found:?} {known:?}");
            }
        }
    }

    /// Data that end within the spectrum: terms outside act as springs and dampers, which terms near the ends
    /// represent.
    #[test]
    fn a_part_of_a_spectrum_is_fitted_within_what_is_asked() {
        let samples = samples(&sixteen(), -2, 6);
        let (found, errors) = find(&samples, 1e-4);
        assert!(found.terms.len() <= 10 && errors.both.rms <= 1e-4 && errors.both.largest < 1e-3, "{errors:?}");
    }

    #[test]
    fn a_larger_error_takes_fewer_terms() {
        let samples = samples(&sixteen(), -5, 15);
        let counts = [0.2, 0.1, 0.05].map(|error| {
            let (found, errors) = find(&samples, error);
            assert!(errors.both.rms <= error);
            found.terms.len()
        });
        assert!(counts[0] < counts[1] && counts[1] < counts[2] && counts[2] < 16, "{counts:?}");
    }

    /// 5 % of noise: the residual is the noise, which averages out, so that the compound itself is met more closely.
    #[test]
    fn noise_is_not_fitted() {
        for (known, low, high) in [(three(), -3, 7), (sixteen(), -5, 15)] {
            let measured = noisy(samples(&known, low, high), 0.05);
            let (found, errors) = find(&measured, 0.02);
            // Some 35 unknowns for 202 values absorb part of it; the deviate itself has 5 % ± 0.25 %.
            assert!((0.04..0.055).contains(&errors.both.rms), "{errors:?}");
            let truth = FitErrors::of(&found, &samples(&known, low, high), Test::Oscillation);
            assert!(truth.both.rms < 0.025, "{truth:?}");
            assert!(found.terms.len() < known.terms.len() + 3, "{}", found.terms.len());
        }
    }

    #[test]
    fn viscosity_is_found_where_it_is_allowed() {
        let known = Compound { viscosity: 200.0, ..series(2e6, &[(1e-2, 3e6)]) };
        let target = Target { error: 1e-3, viscosity: true, test: Test::Oscillation, weight: Weight::Both };
        let found = search(&samples(&known, -1, 5), &target);
        assert_eq!(found.terms.len(), 1);
        assert!((found.viscosity / 200.0 - 1.0).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn one_point_is_met_by_one_term() {
        let (found, errors) = find(&[Sample { at: 10.0, storage: 2e6, loss: 3e5 }], 1e-3);
        assert!(found.terms.len() == 1 && errors.both.largest < 1e-12, "{found:?}");
    }
}
