//! Continuous extension of a step through the values at its stages.
//!
//! A velocity within the step is v(θ) = Σ_j w_j(θ) v_j over the stages, a position x(θ) = x_0 + h Σ_j ∫w_j v_j. Where a
//! motion is far faster than the step, its stages have settled, and so has any combination of them: nothing is
//! differentiated, as Hermite's interpolant does with the accelerations at both ends.
//!
//! The stages have order 2 each, so w has order q for velocities where it is exact for their elementary weights up to
//! that order: Σ w_j (1, c, c², Ac², Ac³, AAc²)_j = (1, θ, θ², θ³/3, θ⁴/4, θ⁴/12), and order 3 for what depends on the
//! state where Σ w_j c_j³ = θ³, too. The first and the last stage and, integrated, the method's own b meet all of these
//! up to the method's order.
//!
//! The seven stages of [`ESDIRK5`](super::ESDIRK5) meet all seven conditions, by one w; so it is the first and the last
//! stage at the ends, and the position at the end is that of the method. The four of [`ESDIRK3`](super::ESDIRK3) meet
//! the first three. One direction n is left to them, and w = w_p + φ(θ) n with a parabola φ that makes the ends and the
//! integral so.
//!
//! The two implicit stages of [`SDIRK2`](super::SDIRK2) give positions as parabolas, the integrals of the straight line
//! through the velocities there. Velocities themselves, which may have followed a jump in no time, are linear from the
//! start to the first of these stages and from there to the end, so they do not oscillate.

use nalgebra::{DMatrix, DVector};

use super::tableau::{GAMMA, MAX_STAGES, SDIRK2, StageWeights, Tableau, sdirk2_weights};
use crate::math::Jet;
use crate::model::BodyInterpolant;

/// Number of powers of θ in the weights: they are of degree 4.
const POWERS: usize = 5;

/// The weights w_j(θ) of the stages in a value within the step.
#[derive(Clone, Debug, PartialEq)]
pub struct Interpolation {
    velocities: Velocities,
    /// c.
    nodes: StageWeights,
    /// The indices of the stages in the order of time.
    in_time: [usize; MAX_STAGES],
    /// Number of stages.
    stages: usize,
    /// See [`overshoot`](Self::overshoot).
    overshoot: f64,
    /// The coefficients of 1, θ, … θ⁴ in the polynomial whose integrals are the positions.
    by_power: [StageWeights; POWERS],
    /// By stage: the integrals in Bernstein's basis of degree 5.
    bernstein_integral: [[f64; POWERS + 1]; MAX_STAGES],
}

/// What the velocities within a step are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Velocities {
    /// The polynomial whose integrals are the positions.
    Polynomial,
    /// Linear from the start to the first implicit stage and from there to the end.
    BrokenLine,
}

impl Interpolation {
    /// The weights of a method whose stages have order 2.
    pub fn new(tableau: &Tableau) -> Self {
        Self::with_weights(tableau, weights(tableau), Velocities::Polynomial)
    }

    /// Those of [`SDIRK2`](super::SDIRK2).
    pub(super) fn sdirk2() -> Self {
        let (mut by_power, slope) = ([StageWeights::default(); POWERS], 1.0 / (1.0 - GAMMA));
        (by_power[0][1], by_power[0][2]) = (slope, -GAMMA * slope);
        (by_power[1][1], by_power[1][2]) = (-slope, slope);
        Self::with_weights(&SDIRK2, by_power, Velocities::BrokenLine)
    }

    fn with_weights(tableau: &Tableau, by_power: [StageWeights; POWERS], velocities: Velocities) -> Self {
        let (stages, nodes) = (tableau.stages, tableau.c);
        let mut in_time = std::array::from_fn(|stage| stage);
        in_time[..stages].sort_by(|&a, &b| f64::total_cmp(&nodes[a], &nodes[b]));
        let overshoot = overshoot(&in_time.map(|stage: usize| nodes[stage])[..stages]);
        let bernstein_integral = integral_in_bernstein_basis(&by_power);
        Self { velocities, nodes, in_time, stages, overshoot, bernstein_integral, by_power }
    }

    /// What the velocities within a step are.
    pub(super) fn velocities(&self) -> Velocities {
        self.velocities
    }

    /// How far a parabola through the values at three stages that follow each other leaves their range between them, as
    /// a share of it.
    pub fn overshoot(&self) -> f64 {
        self.overshoot
    }

    /// The indices of the stages in the order of time.
    pub fn in_time(&self) -> &[usize] {
        &self.in_time[..self.stages]
    }

    /// The fraction of the step at which a stage lies.
    pub fn node(&self, stage: usize) -> f64 {
        self.nodes[stage]
    }

    /// w(θ).
    pub fn values(&self, theta: f64) -> StageWeights {
        match self.velocities {
            Velocities::Polynomial => self.horner(|_| 1.0, theta),
            Velocities::BrokenLine => broken_line(theta),
        }
    }

    /// ∫_0^θ w: of the rates in the position, over the length of the step.
    pub fn integral(&self, theta: f64) -> StageWeights {
        self.horner(|power| 1.0 / (power + 1) as f64, theta).map(|weight| theta * weight)
    }

    /// The slope of the polynomial at θ.
    pub fn slope(&self, theta: f64) -> StageWeights {
        let derivative =
            |j: usize| (1..POWERS).rev().fold(0.0, |sum, power| sum * theta + power as f64 * self.by_power[power][j]);
        std::array::from_fn(derivative)
    }

    /// Σ_power `factors[power]` w_power, by stage.
    pub fn combined(&self, factors: &[f64; POWERS]) -> StageWeights {
        std::array::from_fn(|j| factors.iter().zip(&self.by_power).map(|(factor, weights)| factor * weights[j]).sum())
    }

    /// The coefficients of 1, θ, … θ⁴ of a value by those at the stages.
    pub fn polynomial(&self, values: impl Fn(usize) -> f64) -> [f64; POWERS] {
        let values: StageWeights = std::array::from_fn(|stage| if stage < self.stages { values(stage) } else { 0.0 });
        self.by_power.map(|weights| weights.iter().zip(values).map(|(weight, value)| weight * value).sum())
    }

    /// By stage: the coefficients of ∫_0^θ w in Bernstein's basis of degree 5.
    pub fn bernstein_integral(&self) -> &[[f64; POWERS + 1]; MAX_STAGES] {
        &self.bernstein_integral
    }

    /// The motion of a body through a step of length `h` (s), from its displacement, speed and acceleration at the
    /// stages.
    pub fn body_interpolant(&self, h: f64, at: impl Fn(usize) -> Jet) -> BodyInterpolant {
        match self.velocities {
            Velocities::Polynomial => {
                BodyInterpolant::Polynomial { length: h, speed: self.polynomial(|stage| at(stage).speed) }
            }
            Velocities::BrokenLine => {
                let [start, first, end] = [0, 1, 2].map(at);
                let moved = end.position - start.position;
                let half = parabola(0.5, GAMMA * h * first.speed, moved);
                let displacement = [4.0 * half - moved, 2.0 * moved - 4.0 * half];
                BodyInterpolant::TwoStages { length: h, node: GAMMA, displacement, speed: [first.speed, end.speed] }
            }
        }
    }

    fn horner(&self, factor: impl Fn(usize) -> f64, theta: f64) -> StageWeights {
        std::array::from_fn(|j| {
            (0..POWERS).rev().fold(0.0, |sum, power| sum * theta + factor(power) * self.by_power[power][j])
        })
    }
}

/// Weights of the values at the start, at the first implicit stage of [`SDIRK2`](super::SDIRK2) and at the end in the
/// broken line through them.
#[inline]
fn broken_line(theta: f64) -> StageWeights {
    let mut weights = StageWeights::default();
    if theta < GAMMA {
        (weights[0], weights[1]) = (1.0 - theta / GAMMA, theta / GAMMA);
    } else {
        let fraction = (theta - GAMMA) / (1.0 - GAMMA);
        (weights[1], weights[2]) = (1.0 - fraction, fraction);
    }
    weights
}

/// The parabola from 0 at the start to `end` whose velocity at the first implicit stage of [`SDIRK2`](super::SDIRK2)
/// makes `middle` in the fraction γ: the integral of the straight line through the velocities at the implicit stages.
#[inline(always)]
pub(super) fn parabola(theta: f64, middle: f64, end: f64) -> f64 {
    let (first, last) = sdirk2_weights(theta);
    let (of_middle, of_end) = ((first - last * ((1.0 - GAMMA) / GAMMA)) / GAMMA, last / GAMMA);
    of_middle * middle + of_end * end
}

/// See [`Interpolation::overshoot`]: of the parabolas through values at three of these places that follow each other.
fn overshoot(places: &[f64]) -> f64 {
    // Lagrange's polynomial of an outer place is least half-way between the two others.
    let of_three = |places: &[f64]| {
        let (left, right) = (places[1] - places[0], places[2] - places[1]);
        0.25 * (left * left / right).max(right * right / left) / (left + right)
    };
    places.windows(3).map(of_three).fold(0.0, f64::max)
}

/// The right side of every condition: a power of θ and its coefficient.
const RIGHT: [(usize, f64); 7] = [(0, 1.0), (1, 1.0), (2, 1.0), (3, 1.0 / 3.0), (3, 1.0), (4, 0.25), (4, 1.0 / 12.0)];

/// Number of conditions that stages of the method's order can meet.
fn conditions(tableau: &Tableau) -> usize {
    if tableau.embedded_order >= 4 { RIGHT.len() } else { 3 }
}

/// The weights by power of θ.
fn weights(tableau: &Tableau) -> [StageWeights; POWERS] {
    let stages = tableau.stages;
    let a = DMatrix::from_fn(stages, stages, |i, j| tableau.a[i][j]);
    let c = DVector::from_column_slice(&tableau.c[..stages]);
    let (square, cube) = (c.component_mul(&c), c.component_mul(&c).component_mul(&c));
    let once = &a * &square;
    let all = [DVector::repeat(stages, 1.0), c, square, once.clone(), cube.clone(), &a * cube, &a * once];
    let rows = DMatrix::from_fn(conditions(tableau), stages, |row, stage| all[row][stage]);
    let least = Least::new(rows);
    let mut weights: [DVector<f64>; POWERS] = std::array::from_fn(|power| {
        least.solve(&DVector::from_fn(
            conditions(tableau),
            |row, _| if RIGHT[row].0 == power { RIGHT[row].1 } else { 0.0 },
        ))
    });
    if let Some(free) = least.free_direction() {
        // The least weights have no part along it.
        let integral = free.dot(&DVector::from_column_slice(&tableau.weights()[..stages]));
        for (weights, coefficient) in weights.iter_mut().zip(parabola_between(free[0], free[stages - 1], integral)) {
            *weights += coefficient * &free;
        }
    }
    weights.map(|weights| std::array::from_fn(|j| if j < stages { weights[j] } else { 0.0 }))
}

/// Least solutions of R w = r.
struct Least {
    rows: DMatrix<f64>,
    /// Rᵀ(RRᵀ)⁻¹.
    inverse: DMatrix<f64>,
}

impl Least {
    fn new(rows: DMatrix<f64>) -> Self {
        // Not singular: the conditions do not depend on each other.
        let normal = (&rows * rows.transpose()).try_inverse();
        let normal = normal.unwrap_or_else(|| DMatrix::zeros(rows.nrows(), rows.nrows()));
        Self { inverse: rows.transpose() * normal, rows }
    }

    fn solve(&self, right: &DVector<f64>) -> DVector<f64> {
        let mut weights = &self.inverse * right;
        // The rounding of the normal equations is removed.
        for _ in 0..2 {
            weights += &self.inverse * (right - &self.rows * &weights);
        }
        weights
    }

    /// A direction of length 1 with R n = 0; `None` where there is none.
    fn free_direction(&self) -> Option<DVector<f64>> {
        let stages = self.rows.ncols();
        let without_constrained = |vector: DVector<f64>| &vector - self.solve(&(&self.rows * &vector));
        let unit = DVector::from_fn(stages, |i, _| f64::from(u8::from(i + 1 == stages)));
        (self.rows.nrows() < stages).then(|| without_constrained(unit).normalize())
    }
}

/// The coefficients of the parabola with these values at 0 and 1 and this integral between them.
fn parabola_between(start: f64, end: f64, integral: f64) -> [f64; 3] {
    let bend = 3.0 * (start + end) - 6.0 * integral;
    [start, end - start - bend, bend]
}

/// The integrals of the weights from 0 on, by stage.
fn integral_in_bernstein_basis(by_power: &[StageWeights; POWERS]) -> [[f64; POWERS + 1]; MAX_STAGES] {
    // binomial(k, m)/binomial(4, m).
    const SHARE: [[f64; POWERS]; POWERS] = [
        [1.0, 0.0, 0.0, 0.0, 0.0],
        [1.0, 0.25, 0.0, 0.0, 0.0],
        [1.0, 0.5, 1.0 / 6.0, 0.0, 0.0],
        [1.0, 0.75, 0.5, 0.25, 0.0],
        [1.0, 1.0, 1.0, 1.0, 1.0],
    ];
    std::array::from_fn(|stage| {
        let mut integral = [0.0; POWERS + 1];
        for (k, shares) in SHARE.iter().enumerate() {
            let coefficient: f64 = shares.iter().zip(by_power).map(|(share, weights)| share * weights[stage]).sum();
            integral[k + 1] = integral[k] + coefficient / POWERS as f64;
        }
        integral
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::{ESDIRK3, ESDIRK5};

    /// Roundings times the condition of the equations for the weights, some 1e4.
    const ROUNDING: f64 = 1e-11;

    fn meets_its_conditions(tableau: &Tableau) {
        let times = |x: &StageWeights| tableau.a.map(|row| row.iter().zip(x).map(|(a, x)| a * x).sum());
        let c = tableau.c;
        let (square, cube) = (c.map(|c| c * c), c.map(|c| c * c * c));
        let elementary = [[1.0; MAX_STAGES], c, square, times(&square), cube, times(&cube), times(&times(&square))];
        let interpolation = Interpolation::new(tableau);
        for theta in [0.0, 0.1, 0.45, 0.9, 1.0_f64] {
            let weights = interpolation.values(theta);
            for (values, (power, coefficient)) in elementary.iter().zip(RIGHT).take(conditions(tableau)) {
                let found: f64 = weights.iter().zip(values).map(|(weight, value)| weight * value).sum();
                let expected = coefficient * theta.powi(power as i32);
                assert!((found - expected).abs() < ROUNDING, "{theta}: {found} {expected}");
            }
        }
    }

    #[test]
    fn the_weights_meet_their_conditions() {
        meets_its_conditions(&ESDIRK5);
        meets_its_conditions(&ESDIRK3);
    }

    fn has_the_ends_of(tableau: &Tableau) {
        let interpolation = Interpolation::new(tableau);
        let unit = |at: usize| std::array::from_fn(|j| f64::from(u8::from(j == at)));
        let ends: [(StageWeights, StageWeights); 3] = [
            (interpolation.values(0.0), unit(0)),
            (interpolation.values(1.0), unit(tableau.last())),
            (interpolation.integral(1.0), *tableau.weights()),
        ];
        for (found, expected) in ends {
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < ROUNDING), "{found:?} {expected:?}");
        }
    }

    #[test]
    fn both_ends_and_the_whole_step_are_those_of_the_method() {
        has_the_ends_of(&ESDIRK5);
        has_the_ends_of(&ESDIRK3);
    }

    /// The largest error of the sine from its rates at the stages, with a quarter of its period in the step.
    fn error_of_a_sine(tableau: &Tableau) -> f64 {
        let interpolation = Interpolation::new(tableau);
        let quarter = std::f64::consts::FRAC_PI_2;
        let error = |theta: f64, phase: f64| {
            let rates = tableau.c.map(|c| (phase + quarter * c).cos());
            let integral: f64 =
                interpolation.integral(theta).iter().zip(rates).map(|(weight, rate)| weight * rate).sum();
            (phase.sin() + quarter * integral - (phase + quarter * theta).sin()).abs()
        };
        let phases = (0..40).map(|i| 0.05 * std::f64::consts::PI * f64::from(i));
        phases.flat_map(|phase| (0..=20).map(move |i| error(0.05 * f64::from(i), phase))).fold(0.0, f64::max)
    }

    /// What the search for touches relies on.
    #[test]
    fn a_quarter_of_a_sine_is_seen_to_two_percent() {
        let errors = [error_of_a_sine(&ESDIRK5), error_of_a_sine(&ESDIRK3)];
        assert!(errors.iter().all(|&error| error > 1e-6 && error < 2e-2), "{errors:?}");
    }

    /// Against the least of Lagrange's polynomials on a fine grid: what the search for dips relies on.
    #[test]
    fn a_parabola_leaves_the_range_of_its_values_by_the_overshoot_and_no_more() {
        for interpolation in [Interpolation::new(&ESDIRK3), Interpolation::new(&ESDIRK5)] {
            let places: Vec<f64> = interpolation.in_time().iter().map(|&stage| interpolation.node(stage)).collect();
            let lowest = |three: &[f64]| {
                let grid = (0..=1000).map(|i| three[0] + (three[2] - three[0]) * f64::from(i) / 1000.0);
                let of = |t: f64, j: usize| -> f64 {
                    (0..3).filter(|&m| m != j).map(|m| (t - three[m]) / (three[j] - three[m])).product()
                };
                // Of all values between 0 and 1 those make the lowest that are 1 where the polynomial is negative.
                grid.map(|t| (0..3).map(|j| of(t, j).min(0.0)).sum()).fold(0.0, f64::min)
            };
            let least = places.windows(3).map(lowest).fold(0.0, f64::min);
            // The grid misses the vertex by 5e-4 of the width at most, which is of second order.
            assert!((interpolation.overshoot() + least).abs() < 1e-4 * least.abs(), "{places:?} {least}");
        }
    }

    #[test]
    fn stages_come_in_the_order_of_time() {
        assert_eq!(Interpolation::new(&ESDIRK3).in_time(), [0, 2, 1, 3]);
        assert_eq!(Interpolation::new(&ESDIRK5).in_time(), [0, 3, 1, 2, 4, 5, 6]);
    }

    #[test]
    fn slope_integral_and_bernstein_coefficients_belong_to_the_values() {
        let interpolation = Interpolation::new(&ESDIRK5);
        let (theta, by) = (0.37, 1e-5);
        let of = |theta: f64, j: usize| interpolation.values(theta)[j];
        for j in 0..MAX_STAGES {
            let slope = (of(theta + by, j) - of(theta - by, j)) / (2.0 * by);
            // The quotient misses by² of a third derivative of some 1e3.
            assert!((interpolation.slope(theta)[j] - slope).abs() < 1e-6);
            let integral = interpolation.integral(theta + by)[j] - interpolation.integral(theta - by)[j];
            assert!((integral / (2.0 * by) - of(theta, j)).abs() < 1e-6);
            let coefficients = interpolation.bernstein_integral()[j];
            let binomial = [1.0, 5.0, 10.0, 10.0, 5.0, 1.0];
            let value: f64 = (0..6_i32)
                .map(|k| binomial[k as usize] * coefficients[k as usize] * theta.powi(k) * (1.0 - theta).powi(5 - k))
                .sum();
            assert!((value - interpolation.integral(theta)[j]).abs() < ROUNDING);
        }
    }
}
