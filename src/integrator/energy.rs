//! The energies through the channels over a step (docs/theory.md, section 7).
//!
//! Every channel is a quadrature of its power over the stages, E = h Σ_i b_i P_i. The powers of dampers and Maxwell
//! elements are quadratic in the rates ė_j and in a_0, from which the elements' elongations at the stages follow
//! (`maxwell`). So sums over the layer are taken of their products, once per step, and not of every element at every
//! stage.

use super::maxwell::{Maxwell, StageCoefficients};
use super::rates::Rates;
use crate::math::{dot, sum_of_pairs, weighted_sum};
use crate::model::{ChannelEnergies, Exchange, LinkKind, MaxwellRow, Model};

/// Σ ė_i ė_j over the links of one kind, m²/s², for j ≤ i.
type RateProducts<const STAGES: usize> = [[f64; STAGES]; STAGES];

/// A step over which energies are to be integrated.
#[derive(Clone, Copy)]
pub(super) struct StepPowers<'a, const STAGES: usize> {
    pub model: &'a Model,
    pub maxwell: &'a Maxwell<STAGES>,
    /// The elongations of the Maxwell elements at the start, m.
    pub a: &'a [f64],
    /// The rates at the stages.
    pub stages: &'a [Rates],
    /// The powers through the surface and the carrier at the stages.
    pub exchange: &'a [Exchange],
    /// The length of the step, s.
    pub h: f64,
    /// The weights of the stages; they add up to the fraction of the step that they are for.
    pub weights: &'a [f64; STAGES],
}

impl<const STAGES: usize> StepPowers<'_, STAGES> {
    /// Energies through all channels, J. `scratch` has one number per mass.
    pub(super) fn energies(&self, scratch: &mut [f64]) -> ChannelEnergies {
        let mut energy = self.lost(scratch);
        for (weight, exchange) in self.weights.iter().zip(self.exchange) {
            energy.friction += self.h * weight * exchange.friction;
            energy.input += self.h * weight * exchange.input;
        }
        energy
    }

    /// Energies lost in the dampers and Maxwell elements, J.
    fn lost(&self, scratch: &mut [f64]) -> ChannelEnergies {
        let Self { model, maxwell, a, stages, h, weights, .. } = *self;
        let mut energy = ChannelEnergies::default();
        let mut products = [[[0.0; STAGES]; STAGES]; 4];
        let mut changes = [None; 4];
        for kind in LinkKind::ALL {
            let damping = model.links[kind as usize].damping;
            if damping == 0.0 && !maxwell.has_elements(kind) {
                continue;
            }
            let products = &mut products[kind as usize];
            *products = rate_products(stages, kind, maxwell.has_elements(kind));
            energy.damper += h * damping * (0..STAGES).map(|i| weights[i] * products[i][i]).sum::<f64>();
        }
        for (index, coefficients) in maxwell.coefficients().iter().enumerate() {
            let squares = SquareWeights::new(coefficients, h / model.relaxation_times[index], weights);
            for row in model.rows.iter().filter(|row| row.time_index == index) {
                let (kind, a) = (row.kind as usize, &a[row.range.clone()]);
                let mut sum = squares.sum(row, a, stages, &products[kind], scratch);
                if let Some(unresolved) = &squares.unresolved {
                    let change = *changes[kind].get_or_insert_with(|| largest_change(stages, row.kind));
                    sum += unresolved.sum(row.relaxation_time, a, &stages[0].elongation_rate[kind], change);
                }
                energy.maxwell += h * row.stiffness / row.relaxation_time * sum;
            }
        }
        energy
    }
}

/// The products of one kind of link: all of them, or those of each stage with itself alone.
fn rate_products<const STAGES: usize>(stages: &[Rates], kind: LinkKind, all: bool) -> RateProducts<STAGES> {
    let mut products = [[0.0; STAGES]; STAGES];
    for i in 0..STAGES {
        let rate = &stages[i].elongation_rate[kind as usize];
        for j in if all { 0 } else { i }..=i {
            products[i][j] = dot(rate, &stages[j].elongation_rate[kind as usize]);
        }
    }
    products
}

/// The largest Σ (ė_i - ė_0)² of a stage over the links of one kind, m²/s². It does not use the products, whose rounding
/// errors exceed the change in a steady motion.
fn largest_change(stages: &[Rates], kind: LinkKind) -> f64 {
    let [start, later @ ..] = stages else { return 0.0 };
    let start = &start.elongation_rate[kind as usize];
    let change = |stage: &Rates| {
        sum_of_pairs(&stage.elongation_rate[kind as usize], start, |rate, start| (rate - start) * (rate - start))
    };
    later.iter().map(change).fold(0.0, f64::max)
}

/// The weights of Σ_i weight_i a_i² of an element: a_i = p_i a_0 + h Σ_j q_ij ė_j multiplied out.
///
/// An element that does not yet follow its link, a_0 ≠ τė_0, after a start undeformed or a jump of ė, may relax in a
/// time far shorter than the step, without any stage that resolves it. So the part of the sum that belongs to a_0 - τė_0
/// is replaced by the integral that the sum stands for.
struct SquareWeights<const STAGES: usize> {
    /// Of a_0².
    start: f64,
    /// Of a_0 ė_j, s.
    mixed: [f64; STAGES],
    /// Of ė_j ė_l for l ≤ j, s².
    rates: [[f64; STAGES]; STAGES],
    /// `None` for an element slower than the step, which the stages resolve.
    unresolved: Option<UnresolvedRelaxation>,
}

/// The ratio of step and relaxation time up to which the stages resolve an element. From twice this ratio on, all that
/// they miss is put in; in between it grows linearly. Steps as long as the relaxation time are usual where those of a
/// co-simulation master are, and the loss must not depend on the rounding of their length.
const RESOLVED: f64 = 1.0;

/// The difference between the integral and the quadrature over the stages for l = a_0 - τė_0, which decays as e^(-zθ)
/// beside τė_0.
struct UnresolvedRelaxation {
    /// Of l²: ∫ e^(-2zθ) dθ less Σ_i weight_i p_i².
    square: f64,
    /// Of 2 l τė_0: ∫ e^(-zθ) dθ less Σ_i weight_i p_i.
    mixed: f64,
}

impl<const STAGES: usize> SquareWeights<STAGES> {
    /// For the ratio `z` of step and relaxation time.
    fn new(coefficients: &StageCoefficients<STAGES>, z: f64, weights: &[f64; STAGES]) -> Self {
        let mut squares =
            Self { start: weights[0], mixed: [0.0; STAGES], rates: [[0.0; STAGES]; STAGES], unresolved: None };
        for i in 1..STAGES {
            let (p, q) = (coefficients.start[i], &coefficients.rate[i]);
            squares.start += weights[i] * p * p;
            for j in 0..=i {
                let weighed = weights[i] * q[j];
                squares.mixed[j] += 2.0 * weighed * p;
                for l in 0..j {
                    squares.rates[j][l] += 2.0 * weighed * q[l];
                }
                squares.rates[j][j] += weighed * q[j];
            }
        }
        squares.unresolved = (z > RESOLVED).then(|| UnresolvedRelaxation::new(z, coefficients, weights, squares.start));
        squares
    }

    /// Σ_i weight_i a_i² over the elements of one row, whose elongations at the start are `a`.
    fn sum(
        &self,
        row: &MaxwellRow,
        a: &[f64],
        stages: &[Rates],
        products: &RateProducts<STAGES>,
        scratch: &mut [f64],
    ) -> f64 {
        let rates = self.mixed.iter().zip(stages).filter(|(factor, _)| **factor != 0.0);
        let mixed = rates.map(|(&factor, stage)| (factor, &stage.elongation_rate[row.kind as usize][..]));
        let scratch = &mut scratch[..a.len()];
        weighted_sum(scratch, std::iter::once((self.start, a)).chain(mixed));
        let of_rates = self.rates.iter().flatten().zip(products.iter().flatten());
        dot(a, scratch) + of_rates.map(|(factor, product)| factor * product).sum::<f64>()
    }
}

impl UnresolvedRelaxation {
    fn new<const STAGES: usize>(
        z: f64,
        coefficients: &StageCoefficients<STAGES>,
        weights: &[f64; STAGES],
        squares: f64,
    ) -> Self {
        let fraction = weights.iter().sum::<f64>();
        let integral = |z: f64| -(-z * fraction).exp_m1() / z;
        let share = (z / RESOLVED - 1.0).min(1.0);
        Self {
            square: share * (integral(2.0 * z) - squares),
            mixed: share * (integral(z) - dot(weights, &coefficients.start)),
        }
    }

    /// The sum over elements of relaxation time `tau` (s) with the elongations `a`, whose links start with `rate` and
    /// change it by `change`, the [`largest_change`].
    ///
    /// Where l is no larger than the change of ė in the step explains, the stages resolve it: the sum is 0 then, and goes
    /// there continuously.
    fn sum(&self, tau: f64, a: &[f64], rate: &[f64], change: f64) -> f64 {
        let l = |a: f64, rate: f64| a - tau * rate;
        let square = sum_of_pairs(a, rate, |a, rate| l(a, rate) * l(a, rate));
        let explained = tau * tau * change;
        if square <= explained {
            return 0.0;
        }
        let mixed = tau * sum_of_pairs(a, rate, |a, rate| l(a, rate) * rate);
        (1.0 - explained / square) * (self.square * square + 2.0 * self.mixed * mixed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::{ESDIRK5, STAGES};

    const SCENE: &str = "name = 'a'
        layer = { masses = 5, spacing = 1.0, mass = 1.0,
                  vertical = { damping = 0.7, maxwell = [{ stiffness = 3.0, relaxation_time = 0.2 },
                                                         { stiffness = 2.0, relaxation_time = 1e-7 }] },
                  lateral_x = { damping = 0.3 },
                  lateral_z = { maxwell = [{ stiffness = 1.5, relaxation_time = 50.0 }] } }
        surface = { kind = 'flat' }";

    /// Against the sums over every element at every stage.
    #[test]
    fn products_give_the_sum_over_every_element_at_every_stage() {
        let model = Model::of_text(SCENE);
        let mut seed = 1_u32;
        let mut number = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(seed) / f64::from(u32::MAX) - 0.5
        };
        let h = 0.01;
        let mut stages = vec![Rates::new(&model); STAGES];
        stages.iter_mut().flat_map(|stage| &mut stage.elongation_rate).flatten().for_each(|rate| *rate = number());
        // An elongation of the order of its relaxation time.
        let start: Vec<f64> =
            model.rows.iter().flat_map(|row| row.range.clone().map(|_| row.relaxation_time)).collect();
        let start: Vec<f64> = start.into_iter().map(|tau| tau.min(1.0) * number()).collect();
        let mut maxwell = Maxwell::<STAGES>::new(&model, true);
        maxwell.begin(&model, &ESDIRK5, &start, h);
        let weights: [f64; STAGES] = std::array::from_fn(|_| number());
        let powers = StepPowers {
            model: &model,
            maxwell: &maxwell,
            a: &start,
            stages: &stages,
            exchange: &[],
            h,
            weights: &weights,
        };
        let found = powers.lost(&mut [0.0; 5]);

        let mut expected = ChannelEnergies::default();
        for (i, weight) in weights.iter().enumerate() {
            for kind in LinkKind::ALL {
                let squares: f64 = stages[i].elongation_rate[kind as usize].iter().map(|rate| rate * rate).sum();
                expected.damper += h * weight * model.links[kind as usize].damping * squares;
                for row in model.rows_of(kind) {
                    let coefficients = &maxwell.coefficients()[row.time_index];
                    for (link, a) in start[row.range.clone()].iter().enumerate() {
                        let rate = |j: usize| coefficients.rate[i][j] * stages[j].elongation_rate[kind as usize][link];
                        let a = coefficients.start[i] * a + (0..=i).map(rate).sum::<f64>();
                        expected.maxwell += h * weight * row.stiffness * a * a / row.relaxation_time;
                    }
                }
            }
        }
        // Some hundred terms of both signs in another order.
        assert!((found.damper - expected.damper).abs() < 1e-13 * expected.damper.abs(), "{found:?} {expected:?}");
        assert!((found.maxwell - expected.maxwell).abs() < 1e-12 * expected.maxwell.abs(), "{found:?} {expected:?}");
    }
}
