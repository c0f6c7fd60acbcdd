//! The search for as few Maxwell terms as keep the error within a bound.
//!
//! The error of a series is the root mean square of the relative errors of both moduli at all N points,
//!
//! ε² = (1/2N) Σ [(E'/E'_measured - 1)² + (E''/E''_measured - 1)²].
//!
//! For given relaxation times, the moduli follow by non-negative least squares, which is convex: on a grid of times so
//! fine that a finer one gains nothing, they tell the least error that any series with E_j ≥ 0 has. Of that series,
//! neighbours on the grid are one term that lies between them. Then terms are taken out one by one, those first that
//! are missed least, and each time the others move to where the error is least: Gauss-Newton steps in ln τ.

use std::f64::consts::LN_10;

use asperity::scene::PronyTerm;
use nalgebra::{DMatrix, DVector};

use super::compound::{Compound, Sample, relaxation};
use super::nnls::non_negative_least_squares;

/// How far beyond 1/ω of the data relaxation times may lie, in decades: there a term is a spring or a damper, but for
/// 1e-3 of its modulus.
const BEYOND: f64 = 1.5;
/// Times of the fine grid in a decade. A term half way between two of them is both together, but for some 2e-3.
const PER_DECADE: f64 = 8.0;
/// Where the error wanted cannot be had, the best series has the fewest terms that come so near to the least error.
const NEAR: f64 = 1.01;
/// Terms that may be the next to go: those missed least while the others stand.
const CANDIDATES: usize = 3;

/// What is sought.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wanted {
    /// The largest error ε, 1.
    pub(super) error: f64,
    /// Whether a Kelvin-Voigt viscosity may be among the unknowns.
    pub(super) viscosity: bool,
}

/// The series with the fewest terms that the search finds within the error wanted; where that cannot be had, within
/// [`NEAR`] of the least that can.
pub(super) fn search(samples: &[Sample], wanted: &Wanted) -> Compound {
    let problem = Problem::new(samples, wanted.viscosity);
    let fine = problem.solve(&problem.grid());
    let mut best = problem.refine(problem.solve(&fine.merged()));
    if best.error > wanted.error {
        let unmerged = problem.refine(fine);
        best = if NEAR * unmerged.error < best.error { unmerged } else { best };
    }
    let goal = wanted.error.max(NEAR * best.error);
    while let Some(fewer) = problem.without_one(&best, goal) {
        best = fewer;
    }
    best.compound()
}

/// The moduli of least error for some relaxation times; what is 0 is left out.
#[derive(Clone, Debug)]
struct Solution {
    /// E_∞ and η.
    constants: [f64; 2],
    /// ln τ_j.
    times: Vec<f64>,
    /// E_j.
    moduli: Vec<f64>,
    error: f64,
}

impl Solution {
    fn compound(&self) -> Compound {
        let term = |(time, &modulus): (&f64, &f64)| PronyTerm { relaxation_time: time.exp(), modulus };
        let mut terms: Vec<PronyTerm> = self.times.iter().zip(&self.moduli).map(term).collect();
        terms.sort_by(|a, b| a.relaxation_time.total_cmp(&b.relaxation_time));
        Compound { equilibrium_modulus: self.constants[0], viscosity: self.constants[1], terms }
    }

    /// ln τ with neighbours on the fine grid as one, at their mean by modulus.
    fn merged(&self) -> Vec<f64> {
        let terms: Vec<(f64, f64)> = self.times.iter().copied().zip(self.moduli.iter().copied()).collect();
        let near = |a: &(f64, f64), b: &(f64, f64)| b.0 - a.0 < 1.5 * LN_10 / PER_DECADE;
        let mean = |group: &[(f64, f64)]| {
            let sum: f64 = group.iter().map(|(_, modulus)| modulus).sum();
            group.iter().map(|(time, modulus)| time * modulus / sum).sum::<f64>()
        };
        terms.chunk_by(near).map(mean).collect()
    }
}

/// The measured moduli as a problem of least squares: each row is a modulus at one point over that measured.
struct Problem<'a> {
    samples: &'a [Sample],
    viscosity: bool,
    /// Ends of ln τ.
    low: f64,
    high: f64,
}

impl<'a> Problem<'a> {
    fn new(samples: &'a [Sample], viscosity: bool) -> Self {
        let omegas = || samples.iter().map(|sample| sample.omega);
        let (slow, fast) = (omegas().fold(f64::MAX, f64::min), omegas().fold(0.0, f64::max));
        Self { samples, viscosity, low: -fast.ln() - BEYOND * LN_10, high: -slow.ln() + BEYOND * LN_10 }
    }

    /// ln τ of the fine grid.
    fn grid(&self) -> Vec<f64> {
        let intervals = ((self.high - self.low) / LN_10 * PER_DECADE).ceil();
        (0..=intervals as usize).map(|i| self.low + (self.high - self.low) * i as f64 / intervals).collect()
    }

    /// The column of an unknown with the parts (storage, loss) at ω.
    fn column(&self, parts: impl Fn(f64) -> (f64, f64)) -> DVector<f64> {
        let count = self.samples.len();
        let mut column = DVector::zeros(2 * count);
        for (i, sample) in self.samples.iter().enumerate() {
            let (storage, loss) = parts(sample.omega);
            column[i] = storage / sample.storage;
            column[count + i] = loss / sample.loss;
        }
        column
    }

    /// The columns of E_∞, of η and of the terms at `times` (ln τ).
    fn matrix(&self, times: &[f64]) -> DMatrix<f64> {
        let viscous = if self.viscosity { 1.0 } else { 0.0 };
        let constants = [self.column(|_| (1.0, 0.0)), self.column(|omega| (0.0, viscous * omega))];
        let terms = times.iter().map(|time| self.column(|omega| relaxation(omega * time.exp())));
        DMatrix::from_columns(&constants.into_iter().chain(terms).collect::<Vec<_>>())
    }

    fn ones(&self) -> DVector<f64> {
        DVector::from_element(2 * self.samples.len(), 1.0)
    }

    /// The moduli for the relaxation times `times` (ln τ).
    fn solve(&self, times: &[f64]) -> Solution {
        let (a, ones) = (self.matrix(times), self.ones());
        let x = non_negative_least_squares(&a, &ones);
        let error = (&a * &x - &ones).norm() / (ones.len() as f64).sqrt();
        let terms = times.iter().zip(x.iter().skip(2)).filter(|(_, modulus)| **modulus > 0.0);
        let (times, moduli) = terms.unzip();
        Solution { constants: [x[0], x[1]], times, moduli, error }
    }

    /// Moves the relaxation times to where the error is least: K. Levenberg's and D. Marquardt's steps, of the error as
    /// a function of ln τ alone.
    fn refine(&self, mut solution: Solution) -> Solution {
        /// A step that gains less, as a share of the error, is the last.
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

    /// The damped step of ln τ, none of it longer than 1. The moduli go along: their share of the slopes is projected
    /// out (variable projection as L. Kaufman has it, 1975).
    fn step(&self, solution: &Solution, damping: f64) -> Option<DVector<f64>> {
        let terms = solution.times.iter().zip(&solution.moduli);
        let slopes: Vec<_> = terms.map(|(time, modulus)| self.slope(time.exp(), *modulus)).collect();
        if slopes.is_empty() {
            return None;
        }
        let (a, x) = self.positive(solution);
        let residual = self.ones() - &a * x;
        let q = a.qr().q();
        let mut slopes = DMatrix::from_columns(&slopes);
        slopes -= &q * q.tr_mul(&slopes);
        let mut normal = slopes.tr_mul(&slopes);
        let rounding = normal.diagonal().max() * f64::EPSILON;
        (0..normal.nrows()).for_each(|i| normal[(i, i)] += damping * normal[(i, i)] + rounding);
        let step = normal.cholesky()?.solve(&slopes.tr_mul(&residual));
        Some(&step / step.amax().max(1.0))
    }

    /// d/d ln τ of a term: with r + i s = iωτ/(1 + iωτ), those of r and s are 2r(1 - r) and s(1 - 2r).
    fn slope(&self, tau: f64, modulus: f64) -> DVector<f64> {
        self.column(|omega| {
            let (r, s) = relaxation(omega * tau);
            (modulus * 2.0 * r * (1.0 - r), modulus * s * (1.0 - 2.0 * r))
        })
    }

    /// The columns and the values of the unknowns that are not 0.
    fn positive(&self, solution: &Solution) -> (DMatrix<f64>, DVector<f64>) {
        let all: Vec<f64> = solution.constants.iter().chain(&solution.moduli).copied().collect();
        let used: Vec<usize> = (0..all.len()).filter(|&i| all[i] > 0.0).collect();
        let x = DVector::from_iterator(used.len(), used.iter().map(|&i| all[i]));
        (self.matrix(&solution.times).select_columns(&used), x)
    }

    /// One term less, if the error then stays within `goal`.
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
    use super::super::compound::Errors;
    use super::*;

    /// Points of `compound`, five a decade from 10^low to 10^high rad/s.
    fn samples(compound: &Compound, low: i32, high: i32) -> Vec<Sample> {
        let at = |i: i32| {
            let omega = 10.0_f64.powf(f64::from(i) / 5.0);
            let (storage, loss) = compound.complex_modulus(omega);
            Sample { omega, storage, loss }
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

    fn find(samples: &[Sample], error: f64) -> (Compound, Errors) {
        let compound = search(samples, &Wanted { error, viscosity: false });
        let errors = Errors::of(&compound, samples);
        (compound, errors)
    }

    /// Every relative error in `samples` by a normal deviate of `sigma`: G. Box's and M. Muller's.
    fn noisy(mut samples: Vec<Sample>, sigma: f64) -> Vec<Sample> {
        let mut state: u64 = 88_172_645_463_325_252;
        let mut uniform = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            ((state >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
        };
        let mut normal = || (-2.0 * uniform().ln()).sqrt() * (std::f64::consts::TAU * uniform()).cos();
        for sample in &mut samples {
            sample.storage *= 1.0 + sigma * normal();
            sample.loss *= 1.0 + sigma * normal();
        }
        samples
    }

    /// No fewer terms do, so the search ends on the terms themselves.
    #[test]
    fn known_terms_are_found_again() {
        for (known, low, high) in [(three(), -3, 7), (sixteen(), -5, 15)] {
            let (found, errors) = find(&samples(&known, low, high), 1e-3);
            assert_eq!(found.terms.len(), known.terms.len());
            assert!(errors.largest() < 1e-9, "{errors:?}");
            for (found, known) in found.terms.iter().zip(&known.terms) {
                // The moduli of neighbours differ by 1e3, which is what rounding grows by.
                assert!((found.relaxation_time / known.relaxation_time - 1.0).abs() < 1e-6, "{found:?} {known:?}");
                assert!((found.modulus / known.modulus - 1.0).abs() < 1e-6, "{found:?} {known:?}");
            }
        }
    }

    /// Data that end within the spectrum: terms beyond act as springs and dampers, which stand-ins near the ends are
    /// too.
    #[test]
    fn a_part_of_a_spectrum_is_fitted_within_what_is_asked() {
        let samples = samples(&sixteen(), -2, 6);
        let (found, errors) = find(&samples, 1e-4);
        assert!(found.terms.len() <= 10 && errors.both.rms <= 1e-4 && errors.largest() < 1e-3, "{errors:?}");
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

    /// 5 % of noise: what remains is the noise, and its mean goes: the compound itself is met to a part of it.
    #[test]
    fn noise_is_not_fitted() {
        for (known, low, high) in [(three(), -3, 7), (sixteen(), -5, 15)] {
            let measured = noisy(samples(&known, low, high), 0.05);
            let (found, errors) = find(&measured, 0.02);
            // Some 35 unknowns of 202 figures take their share of it; the deviate itself has 5 % ± 0.25 %.
            assert!((0.04..0.055).contains(&errors.both.rms), "{errors:?}");
            let truth = Errors::of(&found, &samples(&known, low, high));
            assert!(truth.both.rms < 0.025, "{truth:?}");
            assert!(found.terms.len() < known.terms.len() + 3, "{}", found.terms.len());
        }
    }

    #[test]
    fn viscosity_is_found_where_it_is_allowed() {
        let known = Compound { viscosity: 200.0, ..series(2e6, &[(1e-2, 3e6)]) };
        let wanted = Wanted { error: 1e-3, viscosity: true };
        let found = search(&samples(&known, -1, 5), &wanted);
        assert_eq!(found.terms.len(), 1);
        assert!((found.viscosity / 200.0 - 1.0).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn one_point_is_met_by_one_term() {
        let (found, errors) = find(&[Sample { omega: 10.0, storage: 2e6, loss: 3e5 }], 1e-3);
        assert!(found.terms.len() == 1 && errors.largest() < 1e-12, "{found:?}");
    }
}
