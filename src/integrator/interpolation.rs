//! Continuous extension of a step through the values at its stages.
//!
//! A velocity within the step is v(θ) = Σ_j w_j(θ) v_j over the stages, a position x(θ) = x_0 + h Σ_j ∫w_j v_j. Where a
//! motion is far faster than the step, its stages have settled, and so has any combination of them: nothing is
//! differentiated, as Hermite's interpolant does with the accelerations at both ends.
//!
//! The stages have order 2 each, so w has order 4 for velocities, and order 3 for what depends on the state, where it is
//! exact for their elementary weights up to these orders: Σ w_j (1, c, c², c³, Ac², Ac³, AAc²)_j = (1, θ, θ², θ³, θ³/3,
//! θ⁴/4, θ⁴/12). These are as many conditions as stages. The first and the last stage and, integrated, the method's own b
//! meet them; so w is the first and the last stage at the ends, and the position at the end is the one of the method.

use nalgebra::{DMatrix, DVector};

use super::tableau::{STAGES, Tableau};

/// Number of powers of θ in the weights: they are of degree 4.
const POWERS: usize = 5;

/// The weights w_j(θ) of the stages in a value within the step. Those beyond the method's number of stages are 0.
#[derive(Clone, Debug, PartialEq)]
pub struct StageInterpolation {
    /// The coefficients of 1, θ, … θ⁴.
    by_power: [[f64; STAGES]; POWERS],
    /// The same in Bernstein's basis of degree 4.
    bernstein: [[f64; STAGES]; POWERS],
}

impl StageInterpolation {
    /// The weights of a method whose stages have order 2.
    pub(super) fn new<const N: usize>(tableau: &Tableau<N>) -> Self {
        let by_power = weights(tableau);
        Self { bernstein: in_bernstein_basis(&by_power), by_power }
    }

    /// w(θ).
    pub fn values(&self, theta: f64) -> [f64; STAGES] {
        self.horner(|_| 1.0, theta)
    }

    /// ∫_0^θ w: of the rates in the position, over the length of the step.
    pub fn integral(&self, theta: f64) -> [f64; STAGES] {
        self.horner(|power| 1.0 / (power + 1) as f64, theta).map(|weight| theta * weight)
    }

    /// dw/dθ.
    pub fn slope(&self, theta: f64) -> [f64; STAGES] {
        let derivative =
            |j: usize| (1..POWERS).rev().fold(0.0, |sum, power| sum * theta + power as f64 * self.by_power[power][j]);
        std::array::from_fn(derivative)
    }

    /// Σ_power `factors[power]` w_power, by stage.
    pub fn combined(&self, factors: &[f64; POWERS]) -> [f64; STAGES] {
        std::array::from_fn(|j| factors.iter().zip(&self.by_power).map(|(factor, weights)| factor * weights[j]).sum())
    }

    /// The coefficients of Σ_j w_j(θ) `value(j)` in Bernstein's basis of degree 4, for the `stages` of the step.
    pub fn bernstein(&self, stages: usize, value: impl Fn(usize) -> f64) -> [f64; POWERS] {
        let mut coefficients = [0.0; POWERS];
        for j in 0..stages {
            let value = value(j);
            for (coefficient, weights) in coefficients.iter_mut().zip(&self.bernstein) {
                *coefficient += weights[j] * value;
            }
        }
        coefficients
    }

    fn horner(&self, factor: impl Fn(usize) -> f64, theta: f64) -> [f64; STAGES] {
        std::array::from_fn(|j| {
            (0..POWERS).rev().fold(0.0, |sum, power| sum * theta + factor(power) * self.by_power[power][j])
        })
    }
}

/// The right side of every condition: a power of θ and its coefficient.
const RIGHT: [(usize, f64); STAGES] =
    [(0, 1.0), (1, 1.0), (2, 1.0), (3, 1.0), (3, 1.0 / 3.0), (4, 0.25), (4, 1.0 / 12.0)];

/// The solution of the first N conditions by power of θ.
fn weights<const N: usize>(tableau: &Tableau<N>) -> [[f64; STAGES]; POWERS] {
    let a = DMatrix::from_fn(N, N, |i, j| tableau.a[i][j]);
    let c = DVector::from_column_slice(&tableau.c);
    let (square, cube) = (c.component_mul(&c), c.component_mul(&c).component_mul(&c));
    let once = &a * &square;
    let all = [DVector::repeat(N, 1.0), c, square, cube.clone(), once.clone(), &a * cube, &a * once];
    let conditions = DMatrix::from_fn(N, N, |row, stage| all[row][stage]);
    let factored = conditions.clone().lu();
    std::array::from_fn(|power| {
        let right = DVector::from_fn(N, |row, _| if RIGHT[row].0 == power { RIGHT[row].1 } else { 0.0 });
        // Not singular: the conditions do not depend on each other.
        let solve = |right: &DVector<f64>| factored.solve(right).unwrap_or_else(|| DVector::zeros(N));
        let weights = solve(&right);
        // The conditions are within rounding then, however large the weights are.
        let weights = &weights + solve(&(right - &conditions * &weights));
        std::array::from_fn(|j| if j < N { weights[j] } else { 0.0 })
    })
}

fn in_bernstein_basis(by_power: &[[f64; STAGES]; POWERS]) -> [[f64; STAGES]; POWERS] {
    // binomial(k, m)/binomial(4, m).
    const SHARE: [[f64; POWERS]; POWERS] = [
        [1.0, 0.0, 0.0, 0.0, 0.0],
        [1.0, 0.25, 0.0, 0.0, 0.0],
        [1.0, 0.5, 1.0 / 6.0, 0.0, 0.0],
        [1.0, 0.75, 0.5, 0.25, 0.0],
        [1.0, 1.0, 1.0, 1.0, 1.0],
    ];
    SHARE.map(|shares| {
        std::array::from_fn(|j| shares.iter().zip(by_power).map(|(share, weights)| share * weights[j]).sum())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::METHOD;

    /// Roundings of weights of size 1 to 100.
    const ROUNDING: f64 = 1e-13;

    fn elementary(tableau: &Tableau<STAGES>) -> [[f64; STAGES]; 7] {
        let times = |x: &[f64; STAGES]| std::array::from_fn(|i| (0..STAGES).map(|j| tableau.a[i][j] * x[j]).sum());
        let c = tableau.c;
        let (square, cube) = (c.map(|c| c * c), c.map(|c| c * c * c));
        [[1.0; STAGES], c, square, cube, times(&square), times(&cube), times(&times(&square))]
    }

    fn sum(weights: &[f64; STAGES], values: &[f64; STAGES]) -> f64 {
        weights.iter().zip(values).map(|(weight, value)| weight * value).sum()
    }

    #[test]
    fn the_weights_have_order_four() {
        let interpolation = StageInterpolation::new(&METHOD);
        for theta in [0.0, 0.1, 0.45, 0.9, 1.0_f64] {
            let weights = interpolation.values(theta);
            let expected = [
                1.0,
                theta,
                theta.powi(2),
                theta.powi(3),
                theta.powi(3) / 3.0,
                theta.powi(4) / 4.0,
                theta.powi(4) / 12.0,
            ];
            for (values, expected) in elementary(&METHOD).iter().zip(expected) {
                assert!((sum(&weights, values) - expected).abs() < ROUNDING, "{theta}: {weights:?}");
            }
        }
    }

    #[test]
    fn both_ends_and_the_whole_step_are_those_of_the_method() {
        let interpolation = StageInterpolation::new(&METHOD);
        let unit = |at: usize| std::array::from_fn(|j| f64::from(u8::from(j == at)));
        let ends: [([f64; STAGES], [f64; STAGES]); 3] = [
            (interpolation.values(0.0), unit(0)),
            (interpolation.values(1.0), unit(STAGES - 1)),
            (interpolation.integral(1.0), *METHOD.weights()),
        ];
        for (found, expected) in ends {
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < ROUNDING), "{found:?} {expected:?}");
        }
    }

    #[test]
    fn slope_integral_and_bernstein_coefficients_belong_to_the_values() {
        let interpolation = StageInterpolation::new(&METHOD);
        let (theta, by) = (0.37, 1e-5);
        let of = |theta: f64, j: usize| interpolation.values(theta)[j];
        for j in 0..STAGES {
            let slope = (of(theta + by, j) - of(theta - by, j)) / (2.0 * by);
            // The quotient misses by² of a third derivative of some 1e3.
            assert!((interpolation.slope(theta)[j] - slope).abs() < 1e-6);
            let integral = interpolation.integral(theta + by)[j] - interpolation.integral(theta - by)[j];
            assert!((integral / (2.0 * by) - of(theta, j)).abs() < 1e-6);
            let coefficients = interpolation.bernstein(STAGES, |stage| f64::from(u8::from(stage == j)));
            let binomial = [1.0, 4.0, 6.0, 4.0, 1.0];
            let value: f64 = (0..5_i32)
                .map(|k| binomial[k as usize] * coefficients[k as usize] * theta.powi(k) * (1.0 - theta).powi(4 - k))
                .sum();
            assert!((value - of(theta, j)).abs() < ROUNDING);
        }
    }
}
