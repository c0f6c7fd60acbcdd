//! Prony series of smallest error: moduli for given relaxation times, and the times near some.
//!
//! For given relaxation times, the moduli follow by non-negative least squares, which is convex: on a grid of times so
//! fine that a finer one gains nothing, they give the smallest error of any series with E_j ≥ 0. The times are optimised
//! by Gauss-Newton steps in ln τ.
//!
//! The search for the fewest terms within an error bound begins there. Neighbours on the grid are merged into one term
//! between them. Then terms are removed one by one, those that matter least first, and after each removal the relaxation
//! times of the others are optimised.

use std::f64::consts::LN_10;

use asperity::scene::{MaxwellElement, PronyTerm, complex_stiffness};
use nalgebra::{DMatrix, DVector};

use super::compound::{Compound, Sample, Test};
use super::nnls::non_negative_least_squares;
use super::options::Weight;

/// Decades by which relaxation times may exceed the range of 1/ω of the data: there a term acts as a spring or a damper
/// up to 1e-3 of its modulus.
const MARGIN: f64 = 1.5;

/// Real and imaginary part of ix/(1 + ix), x = ωτ.
fn relaxation(x: f64) -> (f64, f64) {
    complex_stiffness(0.0, 0.0, [MaxwellElement { stiffness: 1.0, relaxation_time: 1.0 }], x)
}

/// What a term of modulus 1 has: at ω r + i s = iωτ/(1 + iωτ), at t e^(-t/τ) and 0.
fn term(test: Test, at: f64, tau: f64) -> (f64, f64) {
    match test {
        Test::Oscillation => relaxation(at * tau),
        Test::Relaxation => ((-at / tau).exp(), 0.0),
    }
}

/// The slope of that in ln τ: 2r(1 - r) and s(1 - 2r), or (t/τ) e^(-t/τ).
fn term_slope(test: Test, at: f64, tau: f64) -> (f64, f64) {
    match test {
        Test::Oscillation => {
            let (r, s) = relaxation(at * tau);
            (2.0 * r * (1.0 - r), s * (1.0 - 2.0 * r))
        }
        Test::Relaxation => (at / tau * (-at / tau).exp(), 0.0),
    }
}

/// The moduli of smallest error for given relaxation times; terms with modulus 0 are omitted.
#[derive(Clone, Debug)]
pub(super) struct Solution {
    /// E_∞ and η.
    constants: [f64; 2],
    /// ln τ_j.
    pub(super) times: Vec<f64>,
    /// E_j.
    moduli: Vec<f64>,
    /// ε, 1.
    pub(super) error: f64,
}

impl Solution {
    /// The series, from short to long relaxation times.
    pub(super) fn compound(&self) -> Compound {
        let term = |(time, &modulus): (&f64, &f64)| PronyTerm { relaxation_time: time.exp(), modulus };
        let mut terms: Vec<PronyTerm> = self.times.iter().zip(&self.moduli).map(term).collect();
        terms.sort_by(|a, b| a.relaxation_time.total_cmp(&b.relaxation_time));
        Compound { equilibrium_modulus: self.constants[0], viscosity: self.constants[1], terms }
    }

    /// ln τ with neighbours on a grid of so many points a decade merged at their mean, weighted by modulus.
    pub(super) fn merged(&self, per_decade: f64) -> Vec<f64> {
        let terms: Vec<(f64, f64)> = self.times.iter().copied().zip(self.moduli.iter().copied()).collect();
        let near = |a: &(f64, f64), b: &(f64, f64)| b.0 - a.0 < 1.5 * LN_10 / per_decade;
        let mean = |group: &[(f64, f64)]| {
            let sum: f64 = group.iter().map(|(_, modulus)| modulus).sum();
            group.iter().map(|(time, modulus)| time * modulus / sum).sum::<f64>()
        };
        terms.chunk_by(near).map(mean).collect()
    }
}

/// The measured moduli as a least squares problem: a row is a modulus at one point over the measured one.
pub(super) struct PronyProblem<'a> {
    samples: &'a [Sample],
    test: Test,
    viscosity: bool,
    weight: Weight,
    /// Bounds of ln τ.
    low: f64,
    high: f64,
}

impl<'a> PronyProblem<'a> {
    pub(super) fn new(samples: &'a [Sample], test: Test, viscosity: bool, weight: Weight) -> Self {
        let places = || samples.iter().map(|sample| sample.at);
        let (least, most) = (places().fold(f64::MAX, f64::min), places().fold(0.0, f64::max));
        let (low, high) = match test {
            Test::Oscillation => (-most.ln(), -least.ln()),
            Test::Relaxation => (least.ln(), most.ln()),
        };
        Self { samples, test, viscosity, weight, low: low - MARGIN * LN_10, high: high + MARGIN * LN_10 }
    }

    /// ln τ of a grid with some points a decade.
    pub(super) fn grid(&self, per_decade: f64) -> Vec<f64> {
        let intervals = ((self.high - self.low) / LN_10 * per_decade).ceil();
        (0..=intervals as usize).map(|i| self.low + (self.high - self.low) * i as f64 / intervals).collect()
    }

    /// Values to be met: two of each sample, or one of relaxation.
    fn rows(&self) -> usize {
        if self.test == Test::Oscillation { 2 * self.samples.len() } else { self.samples.len() }
    }

    /// The column of an unknown whose storage and loss part at ω (or value at t) are `parts`.
    fn column(&self, parts: impl Fn(f64) -> (f64, f64)) -> DVector<f64> {
        let count = self.samples.len();
        let mut column = DVector::zeros(self.rows());
        let [of_storage, of_loss] = self.weight.factors();
        for (i, sample) in self.samples.iter().enumerate() {
            let (storage, loss) = parts(sample.at);
            column[i] = of_storage * storage / sample.storage;
            if self.test == Test::Oscillation {
                column[count + i] = of_loss * loss / sample.loss;
            }
        }
        column
    }

    /// The columns of E_∞, of η and of the terms at `times` (ln τ).
    fn matrix(&self, times: &[f64]) -> DMatrix<f64> {
        let viscous = if self.viscosity { 1.0 } else { 0.0 };
        let constants = [self.column(|_| (1.0, 0.0)), self.column(|omega| (0.0, viscous * omega))];
        let terms = times.iter().map(|time| self.column(|at| term(self.test, at, time.exp())));
        DMatrix::from_columns(&constants.into_iter().chain(terms).collect::<Vec<_>>())
    }

    /// What is to be met: each measured modulus over itself, by its weight.
    fn wanted(&self) -> DVector<f64> {
        let [of_storage, of_loss] = self.weight.factors();
        DVector::from_fn(self.rows(), |i, _| if i < self.samples.len() { of_storage } else { of_loss })
    }

    /// How many of the values count in full.
    fn counted(&self) -> usize {
        if self.weight == Weight::Both { self.rows() } else { self.samples.len() }
    }

    /// The moduli for the relaxation times `times` (ln τ).
    pub(super) fn solve(&self, times: &[f64]) -> Solution {
        let (a, wanted) = (self.matrix(times), self.wanted());
        let x = non_negative_least_squares(&a, &wanted);
        let error = (&a * &x - &wanted).norm() / (self.counted() as f64).sqrt();
        let terms = times.iter().zip(x.iter().skip(2)).filter(|(_, modulus)| **modulus > 0.0);
        let (times, moduli) = terms.unzip();
        Solution { constants: [x[0], x[1]], times, moduli, error }
    }

    /// Optimises the relaxation times by the Levenberg-Marquardt method, with the error as a function of ln τ alone.
    pub(super) fn refine(&self, mut solution: Solution) -> Solution {
        /// Relative gain below which the iteration ends.
        const GAIN: f64 = 1e-4;
        const STEPS: usize = 60;
        const DAMPING: [f64; 2] = [1e-12, 1e4];
        let mut damping: f64 = 1e-3;
        for _ in 0..STEPS {
            let Some(step) = self.step(&solution, damping) else { break };
            let moved = solution.times.iter().zip(step.iter()).map(|(time, step)| time + step);
            let trial = self.solve(&moved.map(|time| time.clamp(self.low, self.high)).collect::<Vec<_>>());
            let gain = 1.0 - trial.error / solution.error;
            damping *= if gain > 0.0 { 0.1 } else { 10.0 };
            if gain > 0.0 {
                solution = trial;
            }
            if (0.0..GAIN).contains(&gain) || damping > DAMPING[1] {
                break;
            }
            damping = damping.max(DAMPING[0]);
        }
        solution
    }

    /// The damped step of ln τ, at most 1 in each component. The moduli follow the times: their part of the slopes is
    /// projected out (variable projection, L. Kaufman, BIT 15, 1975).
    fn step(&self, solution: &Solution, damping: f64) -> Option<DVector<f64>> {
        let terms = solution.times.iter().zip(&solution.moduli);
        let slopes: Vec<_> = terms.map(|(time, modulus)| self.slope(time.exp(), *modulus)).collect();
        if slopes.is_empty() {
            return None;
        }
        let (a, x) = self.positive(solution);
        let residual = self.wanted() - &a * x;
        let q = a.qr().q();
        let mut slopes = DMatrix::from_columns(&slopes);
        slopes -= &q * q.tr_mul(&slopes);
        let mut normal = slopes.tr_mul(&slopes);
        let rounding = normal.diagonal().max() * f64::EPSILON;
        (0..normal.nrows()).for_each(|i| normal[(i, i)] += damping * normal[(i, i)] + rounding);
        let step = normal.cholesky()?.solve(&slopes.tr_mul(&residual));
        Some(&step / step.amax().max(1.0))
    }

    /// d/d ln τ of a term.
    fn slope(&self, tau: f64, modulus: f64) -> DVector<f64> {
        self.column(|at| {
            let (storage, loss) = term_slope(self.test, at, tau);
            (modulus * storage, modulus * loss)
        })
    }

    /// What is left of the data, and its slopes in the ln a_T of groups of samples, without what the moduli can follow
    /// (variable projection). A function of ωτ or t/τ rises with ln a_T as with ln τ.
    pub(super) fn shift_slopes(
        &self,
        solution: &Solution,
        group: &[usize],
        groups: usize,
    ) -> (DMatrix<f64>, DVector<f64>) {
        let (a, x) = self.positive(solution);
        let residual = self.wanted() - &a * x;
        let terms = solution.times.iter().zip(&solution.moduli);
        let whole =
            terms.fold(DVector::zeros(self.rows()), |sum, (time, modulus)| sum + self.slope(time.exp(), *modulus));
        let count = self.samples.len();
        let of_group = |wanted: usize| {
            DVector::from_fn(self.rows(), |i, _| if group[i % count] == wanted { whole[i] } else { 0.0 })
        };
        let mut slopes = DMatrix::from_columns(&(0..groups).map(of_group).collect::<Vec<_>>());
        let q = a.qr().q();
        slopes -= &q * q.tr_mul(&slopes);
        (slopes, residual)
    }

    /// Columns and values of the unknowns above 0.
    fn positive(&self, solution: &Solution) -> (DMatrix<f64>, DVector<f64>) {
        let all: Vec<f64> = solution.constants.iter().chain(&solution.moduli).copied().collect();
        let used: Vec<usize> = (0..all.len()).filter(|&i| all[i] > 0.0).collect();
        let x = DVector::from_iterator(used.len(), used.iter().map(|&i| all[i]));
        (self.matrix(&solution.times).select_columns(&used), x)
    }
}

/// Points of the fine grid per decade. Two neighbours together represent a term half way between them up to 2e-3.
const PER_DECADE: f64 = 8.0;
/// Where the requested error cannot be reached, the search accepts this multiple of the smallest error.
const NEAR: f64 = 1.01;
/// Number of terms tried for removal: those whose removal costs least while the others are fixed.
const CANDIDATES: usize = 3;

impl PronyProblem<'_> {
    /// The series with the fewest terms found within the admissible `error` (ε, 1) or, if it cannot be reached, within
    /// [`NEAR`] of the smallest error.
    pub(super) fn fewest_terms(&self, error: f64) -> Compound {
        let fine = self.solve(&self.grid(PER_DECADE));
        let mut best = self.refine(self.solve(&fine.merged(PER_DECADE)));
        if best.error > error {
            let unmerged = self.refine(fine);
            best = if NEAR * unmerged.error < best.error { unmerged } else { best };
        }
        let goal = error.max(NEAR * best.error);
        while let Some(fewer) = self.without_one(&best, goal) {
            best = fewer;
        }
        best.compound()
    }

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
        let compound = PronyProblem::new(samples, Test::Oscillation, false, Weight::Both).fewest_terms(error);
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
        let samples = samples(&known, -1, 5);
        let found = PronyProblem::new(&samples, Test::Oscillation, true, Weight::Both).fewest_terms(1e-3);
        assert_eq!(found.terms.len(), 1);
        assert!((found.viscosity / 200.0 - 1.0).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn one_point_is_met_by_one_term() {
        let (found, errors) = find(&[Sample { at: 10.0, storage: 2e6, loss: 3e5 }], 1e-3);
        assert!(found.terms.len() == 1 && errors.both.largest < 1e-12, "{found:?}");
    }
}
