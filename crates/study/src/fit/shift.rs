//! Time-temperature superposition without known constants: the factors a_T by which the curves of all temperatures
//! become one, and the constants of Williams, Landel and Ferry that have these factors.
//!
//! The factors are those of the least squares over all rows of both moduli: against a generalised Maxwell model with a
//! dense series of relaxation times, whose moduli (not negative) follow the factors. It represents whatever one curve
//! can be, so what is left is what the factors leave. Where curves share no range of moduli it has nothing to hold them
//! by, and the errors of the factors say so. Gauss-Newton steps in ln a_T start from neighbours laid over each other
//! one by one.

use std::f64::consts::LN_10;

use nalgebra::{DMatrix, DVector};

use super::compound::{Sample, Test};
use super::options::{Weight, WlfConstants};
use super::prony::{PronyProblem, Solution};

/// The rows of one temperature.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Isotherm {
    /// Their mean temperature, K.
    pub(super) temperature: f64,
    pub(super) samples: Vec<Sample>,
}

/// The factor of a temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Factor {
    /// K.
    pub(super) temperature: f64,
    /// ln a_T.
    pub(super) ln: f64,
    /// Its standard error.
    pub(super) error: f64,
}

/// What superposition has found.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Superposition {
    /// From cold to hot.
    pub(super) factors: Vec<Factor>,
    /// Root mean square of the relative residuals of the one curve.
    pub(super) rms: f64,
    /// The law that has these factors, and the residuals with it; `None` with fewer than three temperatures.
    pub(super) law: Option<(WlfConstants, f64)>,
}

/// Points a decade of the series that stands for the one curve.
const PER_DECADE: f64 = 10.0;
/// A law is as good as the factors themselves where it leaves this much more of the data.
const AS_GOOD: f64 = 1.15;

impl Superposition {
    /// Whether the law describes the factors, and can stand for them.
    pub(super) fn law_holds(&self) -> bool {
        self.law.is_some_and(|(_, rms)| rms <= AS_GOOD * self.rms.max(1e-3))
    }
}

/// Puts the curves together, by temperatures from cold to hot, at the one nearest to `reference` (K).
pub(super) fn superpose(isotherms: &[Isotherm], test: Test, reference: f64) -> Superposition {
    let curves = Curves::new(isotherms, test, reference);
    let start = curves.neighbours();
    let (free, rms, errors) = curves.refine(start, &curves.free());
    let factor =
        |(i, isotherm): (usize, &Isotherm)| Factor { temperature: isotherm.temperature, ln: free[i], error: errors[i] };
    let factors: Vec<Factor> = isotherms.iter().enumerate().map(factor).collect();
    let law = law_of(&factors, curves.reference).map(|constants| curves.refine_law(constants));
    Superposition { factors, rms, law }
}

/// How well known constants put the curves together: the residuals of the one curve.
pub(super) fn rms_with(isotherms: &[Isotherm], test: Test, constants: &WlfConstants) -> f64 {
    let curves = Curves::new(isotherms, test, constants.reference_temperature);
    let shifts: Vec<f64> = isotherms.iter().map(|isotherm| ln_factor(constants, isotherm.temperature)).collect();
    curves.solve(&shifts).1.error
}

fn ln_factor(constants: &WlfConstants, temperature: f64) -> f64 {
    let above = temperature - constants.reference_temperature;
    -LN_10 * constants.c1 * above / (constants.c2 + above)
}

struct Curves<'a> {
    isotherms: &'a [Isotherm],
    test: Test,
    /// The isotherm whose factor is 1.
    reference: usize,
    samples: Vec<Sample>,
    /// The isotherm of each sample.
    group: Vec<usize>,
}

impl<'a> Curves<'a> {
    fn new(isotherms: &'a [Isotherm], test: Test, reference: f64) -> Self {
        let distance = |i: &usize| (isotherms[*i].temperature - reference).abs();
        let nearest = (0..isotherms.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0);
        let samples = isotherms.iter().flat_map(|isotherm| isotherm.samples.iter().copied()).collect();
        let group = isotherms.iter().enumerate().flat_map(|(i, isotherm)| vec![i; isotherm.samples.len()]).collect();
        Self { isotherms, test, reference: nearest, samples, group }
    }

    /// ln a_T from one neighbour to the next, each laid over the other as well as can be.
    fn neighbours(&self) -> Vec<f64> {
        let steps: Vec<f64> = self.isotherms.windows(2).map(|pair| self.step(&pair[0], &pair[1])).collect();
        let sums: Vec<f64> = std::iter::once(0.0)
            .chain(steps.iter().scan(0.0, |sum, step| {
                *sum -= step;
                Some(*sum)
            }))
            .collect();
        sums.iter().map(|sum| sum - sums[self.reference]).collect()
    }

    /// By how much ln a_T of the colder curve is larger: where the polylines through both moduli, over the logarithm of
    /// frequency or time, are closest.
    fn step(&self, cold: &Isotherm, hot: &Isotherm) -> f64 {
        /// The largest step from one temperature to the next, and the first grid.
        const MOST: f64 = 25.0;
        const FINE: f64 = 0.05;
        let (cold, hot) = (Polyline::new(cold, self.test), Polyline::new(hot, self.test));
        let steps = (0..=(MOST / FINE) as usize).map(|i| i as f64 * FINE);
        let distances = steps.filter_map(|step| Some((step, cold.distance(&hot, step)?)));
        distances.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0.0, |(step, _)| step)
    }

    /// The slopes of all factors in themselves, without the reference's.
    fn free(&self) -> DMatrix<f64> {
        let count = self.isotherms.len();
        DMatrix::from_fn(count, count - 1, |i, j| {
            let column = if j < self.reference { j } else { j + 1 };
            if i == column { 1.0 } else { 0.0 }
        })
    }

    fn solve(&self, shifts: &[f64]) -> (Vec<Sample>, Solution) {
        let shifted = |(sample, group): (&Sample, &usize)| sample.shifted(shifts[*group].exp(), self.test);
        let samples: Vec<Sample> = self.samples.iter().zip(&self.group).map(shifted).collect();
        let problem = PronyProblem::new(&samples, self.test, false, Weight::Both);
        let solution = problem.solve(&problem.grid(PER_DECADE));
        (samples, solution)
    }

    /// The step of parameters on which the shifts depend by `slopes`, the standard errors of the shifts.
    fn newton(
        &self,
        samples: &[Sample],
        solution: &Solution,
        slopes: &DMatrix<f64>,
        damping: f64,
    ) -> Option<(DVector<f64>, DVector<f64>)> {
        let problem = PronyProblem::new(samples, self.test, false, Weight::Both);
        let (by_shift, residual) = problem.shift_slopes(solution, &self.group, self.isotherms.len());
        let by_parameter = by_shift * slopes;
        let normal = by_parameter.tr_mul(&by_parameter);
        let mut damped = normal.clone();
        let rounding = normal.diagonal().max() * 1e-14;
        (0..normal.nrows()).for_each(|i| damped[(i, i)] += damping * normal[(i, i)] + rounding);
        let inverse = damped.cholesky()?.inverse();
        let step = &inverse * by_parameter.tr_mul(&residual);
        let freedom = (residual.len() as f64 - normal.nrows() as f64).max(1.0);
        let variance = residual.norm_squared() / freedom;
        let covariance = slopes * inverse * slopes.transpose();
        Some((step, covariance.diagonal().map(|value| (value * variance).sqrt())))
    }

    /// Least squares in all factors: the factors, what is left, their standard errors.
    fn refine(&self, mut shifts: Vec<f64>, slopes: &DMatrix<f64>) -> (Vec<f64>, f64, Vec<f64>) {
        const STEPS: usize = 40;
        const GAIN: f64 = 1e-6;
        let (mut samples, mut solution) = self.solve(&shifts);
        let mut damping = 1e-3;
        for _ in 0..STEPS {
            let Some((step, _)) = self.newton(&samples, &solution, slopes, damping) else { break };
            // A step of more than a decade is beyond what the slopes tell.
            let moves = slopes * &step / (step.amax() / LN_10).max(1.0);
            let trial: Vec<f64> = shifts.iter().zip(moves.iter()).map(|(shift, step)| shift + step).collect();
            let (moved, found) = self.solve(&trial);
            let gain = 1.0 - found.error / solution.error;
            damping *= if gain > 0.0 { 0.2 } else { 10.0 };
            if gain > 0.0 {
                (shifts, samples, solution) = (trial, moved, found);
            }
            if (0.0..GAIN).contains(&gain) || damping > 1e4 {
                break;
            }
        }
        let errors = self.newton(&samples, &solution, slopes, 0.0).map(|(_, errors)| errors.iter().copied().collect());
        // Without a solution nothing is known of them.
        let errors = errors.unwrap_or_else(|| vec![f64::INFINITY; shifts.len()]);
        (shifts, solution.error, errors)
    }

    /// Least squares in the constants of the law, and what is left.
    fn refine_law(&self, start: WlfConstants) -> (WlfConstants, f64) {
        const STEPS: usize = 30;
        const GAIN: f64 = 1e-6;
        let shifts = |law: &WlfConstants| -> Vec<f64> {
            self.isotherms.iter().map(|isotherm| ln_factor(law, isotherm.temperature)).collect()
        };
        let mut law = start;
        let (mut samples, mut solution) = self.solve(&shifts(&law));
        let mut damping = 1e-3;
        for _ in 0..STEPS {
            // In ln C_1 and ln C_2, which stay above 0.
            let slopes = DMatrix::from_fn(self.isotherms.len(), 2, |i, j| {
                let above = self.isotherms[i].temperature - law.reference_temperature;
                let shift = ln_factor(&law, self.isotherms[i].temperature);
                if j == 0 { shift } else { -shift * law.c2 / (law.c2 + above) }
            });
            let Some((step, _)) = self.newton(&samples, &solution, &slopes, damping) else { break };
            let step = &step / step.amax().max(1.0);
            let trial = WlfConstants { c1: law.c1 * step[0].exp(), c2: law.c2 * step[1].exp(), ..law };
            let solved = self.is_possible(&trial).then(|| self.solve(&shifts(&trial)));
            let gain = solved.as_ref().map_or(-1.0, |(_, found)| 1.0 - found.error / solution.error);
            damping *= if gain > 0.0 { 0.2 } else { 10.0 };
            if let Some((moved, found)) = solved.filter(|_| gain > 0.0) {
                (law, samples, solution) = (trial, moved, found);
            }
            if (0.0..GAIN).contains(&gain) || damping > 1e6 {
                break;
            }
        }
        (law, solution.error)
    }

    /// All temperatures above the pole, and factors that are numbers.
    fn is_possible(&self, law: &WlfConstants) -> bool {
        let coldest = self.isotherms[0].temperature - law.reference_temperature;
        law.c2 + coldest > 1.0 && law.c2 < 1e5 && law.c1 < 1e5 && ln_factor(law, self.isotherms[0].temperature) < 140.0
    }
}

/// The law with the factors, by their errors: (T - T_ref)/log a_T = -(C_2 + T - T_ref)/C_1, then Gauss-Newton steps.
pub(super) fn law_of(factors: &[Factor], reference: usize) -> Option<WlfConstants> {
    /// Standard error of ln a_T that no factor is below: a law is no better.
    const LEAST: f64 = 0.02;
    let reference_temperature = factors[reference].temperature;
    let others: Vec<&Factor> = factors.iter().filter(|factor| factor.temperature != reference_temperature).collect();
    if others.len() < 2 {
        return None;
    }
    let coldest = factors[0].temperature - reference_temperature;
    // For each C_2 the best C_1 is that of a line. C_2 lies between the neighbours of the best of a grid.
    let with = |c2: f64| {
        let terms = others.iter().map(|factor| {
            let above = factor.temperature - reference_temperature;
            let weight = 1.0 / (factor.error.powi(2) + LEAST.powi(2));
            (-LN_10 * above / (c2 + above), factor.ln, weight)
        });
        let (products, squares) =
            terms.clone().fold((0.0, 0.0), |(a, b), (x, y, weight)| (a + weight * x * y, b + weight * x * x));
        let c1 = products / squares;
        (c1, terms.map(|(x, y, weight)| weight * (y - c1 * x).powi(2)).sum::<f64>())
    };
    let least = (5.0 - coldest).max(5.0);
    const GRID: usize = 400;
    let place = |i: f64| least * (1e4 / least).powf(i / GRID as f64);
    let error = |i: f64| with(place(i)).1;
    let best = (0..=GRID).map(|i| i as f64).min_by(|a, b| error(*a).total_cmp(&error(*b)))?;
    let (mut low, mut high) = ((best - 1.0).max(0.0), (best + 1.0).min(GRID as f64));
    for _ in 0..60 {
        let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if error(a) < error(b) { high = b } else { low = a }
    }
    let c2 = place(0.5 * (low + high));
    let c1 = with(c2).0;
    (c1 > 0.0).then_some(WlfConstants { c1, c2, reference_temperature })
}

/// The logarithms of the moduli of a curve over that of ω or 1/t.
struct Polyline {
    points: Vec<(f64, [f64; 2])>,
    /// Moduli that count: the loss of oscillation too.
    count: usize,
}

impl Polyline {
    fn new(isotherm: &Isotherm, test: Test) -> Self {
        let point = |sample: &Sample| {
            let x = if test == Test::Oscillation { sample.at.ln() } else { -sample.at.ln() };
            (x, [sample.storage.ln(), sample.loss.max(f64::MIN_POSITIVE).ln()])
        };
        let mut points: Vec<(f64, [f64; 2])> = isotherm.samples.iter().map(point).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        points.dedup_by(|a, b| a.0 == b.0);
        Self { points, count: if test == Test::Oscillation { 2 } else { 1 } }
    }

    /// The values at `x`, up to some way beyond the ends along the last pieces; `None` further out.
    fn at(&self, x: f64) -> Option<[f64; 2]> {
        /// Of ln ω.
        const BEYOND: f64 = 1.0;
        let last = self.points.len().checked_sub(1).filter(|last| *last > 0)?;
        if !(self.points[0].0 - BEYOND..=self.points[last].0 + BEYOND).contains(&x) {
            return None;
        }
        let i = self.points.partition_point(|point| point.0 <= x).clamp(1, last);
        let ((x0, y0), (x1, y1)) = (self.points[i - 1], self.points[i]);
        let share = (x - x0) / (x1 - x0);
        Some(std::array::from_fn(|k| y0[k] + share * (y1[k] - y0[k])))
    }

    /// The mean square distance of two curves where they share a range, the other one `step` further to the left.
    fn distance(&self, hot: &Self, step: f64) -> Option<f64> {
        let (mut sum, mut count) = (0.0, 0.0);
        let mut add = |a: [f64; 2], b: [f64; 2]| {
            for k in 0..self.count {
                sum += (a[k] - b[k]).powi(2);
                count += 1.0;
            }
        };
        self.points.iter().filter_map(|(x, y)| Some((*y, hot.at(x + step)?))).for_each(|(a, b)| add(a, b));
        hot.points.iter().filter_map(|(x, y)| Some((self.at(x - step)?, *y))).for_each(|(a, b)| add(a, b));
        (count > 0.0).then(|| sum / count)
    }
}

#[cfg(test)]
mod tests {
    use asperity::math::SplitMix64;

    use super::*;
    use crate::fit::compound::Compound;

    const LAW: WlfConstants = WlfConstants { c1: 7.52, c2: 119.75, reference_temperature: 293.15 };

    /// A tread-like rubber, one term a decade.
    fn rubber() -> Compound {
        let moduli =
            [1538.0, 888.0, 824.0, 495.0, 201.0, 76.3, 31.9, 14.8, 8.12, 4.65, 3.16, 2.26, 1.67, 1.42, 0.969, 1.26];
        let term = |(i, modulus): (i32, f64)| asperity::scene::PronyTerm {
            relaxation_time: 10.0_f64.powi(i),
            modulus: 1e6 * modulus,
        };
        let terms = (-13..).zip(moduli).map(term).collect();
        Compound { equilibrium_modulus: 4.44e6, viscosity: 0.0, terms }
    }

    /// Three decades at each temperature (°C), each modulus times 1 + `noise` times a normal deviate.
    fn isotherms(celsius: &[f64], test: Test, noise: f64) -> Vec<Isotherm> {
        let (rubber, mut random) = (rubber(), SplitMix64::new(3));
        let mut factor = move || {
            let size = (-2.0 * (1.0 - random.unit()).ln()).sqrt();
            1.0 + noise * size * (std::f64::consts::TAU * random.unit()).cos()
        };
        let mut isotherm = |temperature: f64| {
            let shift = ln_factor(&LAW, temperature).exp();
            let samples = (-10..=5).map(|i| {
                let at = 10.0_f64.powf(f64::from(i) / 5.0 + 2.0);
                let reduced = Sample { at, storage: 0.0, loss: 0.0 }.shifted(shift, test).at;
                let (storage, loss) = rubber.response(test, reduced);
                Sample { at, storage: storage * factor(), loss: loss * factor() }
            });
            Isotherm { temperature, samples: samples.collect() }
        };
        celsius.iter().map(|celsius| isotherm(celsius + 273.15)).collect()
    }

    /// Curves that share half of their range, of both kinds of test: the factors to 3 %, the law too.
    #[test]
    fn the_law_that_made_the_curves_comes_back() {
        for (test, noise) in [(Test::Oscillation, 0.0), (Test::Oscillation, 0.01), (Test::Relaxation, 0.0)] {
            let curves = isotherms(&[-20.0, -10.0, 0.0, 10.0, 20.0, 35.0], test, noise);
            let found = superpose(&curves, test, 293.15);
            let (law, _) = found.law.unwrap();
            for factor in &found.factors {
                let known = ln_factor(&LAW, factor.temperature);
                let of_law = ln_factor(&law, factor.temperature);
                // One per cent of scatter is several in the factors, where moduli rise by a tenth a decade of ω.
                let most = if noise > 0.0 { 0.08 } else { 0.03 };
                assert!((factor.ln - known).abs() < most, "{test:?} {noise} {factor:?} {known}");
                assert!((of_law - known).abs() < most, "{test:?} {noise} {law:?}");
                assert!((factor.ln - known).abs() < 5.0 * factor.error + 0.02, "{test:?} {noise} {factor:?} {known}");
            }
            assert!(found.law_holds(), "{found:?}");
        }
    }

    /// Factors that no such law has: rows are then shifted by the factors.
    #[test]
    fn curves_without_a_law_are_told() {
        let mut curves = isotherms(&[-20.0, -10.0, 0.0, 10.0, 20.0], Test::Oscillation, 0.0);
        let shift = |curve: &mut Isotherm, factor: f64| curve.samples.iter_mut().for_each(|sample| sample.at /= factor);
        shift(&mut curves[1], 5.0);
        let found = superpose(&curves, Test::Oscillation, 293.15);
        assert!(!found.law_holds() && found.rms < 0.01, "{found:?}");
        let known = ln_factor(&LAW, 263.15) + 5.0_f64.ln();
        assert!((found.factors[1].ln - known).abs() < 0.05, "{found:?}");
        assert!(rms_with(&curves, Test::Oscillation, &LAW) > 5.0 * found.rms);
    }
}
