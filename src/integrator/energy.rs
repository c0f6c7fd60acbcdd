//! The energies through the channels over a step (docs/theory.md, section 7).
//!
//! Every channel is a quadrature of its power over the stages, E = h Σ_i b_i P_i. The powers of dampers and Maxwell
//! elements are quadratic in the rates ė_j and in a_0, from which the elements' elongations at the stages follow
//! (`maxwell`). So sums over the layer are taken of their products, once per step, and not of every element at every
//! stage.

use std::ops::Range;

use super::maxwell::{Maxwell, StageCoefficients};
use super::rates::Rates;
use super::tableau::STAGES;
use crate::math::{dot, dots, square_and_dots, sum_of_pairs};
use crate::model::{BoundaryPowers, ByLink, ChannelEnergies, LinkKind, MaxwellRow, Model, State};

/// Σ ė_i ė_j over the links of one kind, m²/s², where they are needed; 0 elsewhere.
type RateProducts<const N: usize> = [[f64; N]; N];

/// What the energies up to any fraction of a step follow from: the powers at its stages, summed over the layer or a part of
/// it.
#[derive(Clone, Debug)]
pub(super) struct StepSums {
    /// Whether they are those of the last attempted step.
    known: bool,
    /// The power lost in dampers, W.
    dampers: [f64; STAGES],
    /// The power lost in Maxwell elements, W.
    elements: [f64; STAGES],
    /// What the stages do not resolve of it, by relaxation time.
    relaxing: Vec<RelaxingPower>,
}

/// Sums over all elements of one relaxation time, from which the power lost in them at the stages follows.
struct ElementSums<const N: usize> {
    /// Σ c a_0²/τ, W.
    square: f64,
    /// Σ c a_0 ė_j/τ, W/s.
    mixed: [f64; N],
    /// Σ c ė_i ė_j/τ, W/s².
    rates: RateProducts<N>,
}

/// The power lost in the elements of one relaxation time that do not follow their links yet: of l = a_0 - τė_0, over all of
/// them; 0 where the stages resolve it.
#[derive(Clone, Copy, Debug, Default)]
struct RelaxingPower {
    /// Σ c l²/τ, W.
    square: f64,
    /// Σ c l ė_0, W.
    mixed: f64,
}

/// Some masses of a layer in a step from its `start`, of length `h` (s), with these `stages`.
pub(super) struct MassesInStep<'a> {
    pub model: &'a Model,
    pub masses: Range<usize>,
    pub start: &'a State,
    pub stages: &'a [Rates],
    pub h: f64,
}

impl<'a> MassesInStep<'a> {
    /// ė of the links of one kind at the first `N` stages, m/s; none where there is no such link.
    fn rates<const N: usize>(&self, kind: LinkKind) -> [&'a [f64]; N] {
        let links = self.masses.start..self.masses.start + kind.count(self.masses.len());
        std::array::from_fn(|i| self.stages[i].elongation_rate[kind].get(links.clone()).unwrap_or_default())
    }

    /// The elongations of the elements of `row` at the start, m.
    fn elements(&self, row: &MaxwellRow) -> &'a [f64] {
        let first = row.range.start + self.masses.start;
        &self.start.maxwell[first..first + row.kind.count(self.masses.len())]
    }
}

/// A step with sums over some of its masses.
pub(super) struct SummedStep<'a> {
    pub of: MassesInStep<'a>,
    pub sums: &'a mut StepSums,
    /// The powers of these masses through the surface and the carrier at the stages.
    pub exchange: &'a [BoundaryPowers],
}

impl StepSums {
    /// Workspace for the elements of `model`.
    pub(super) fn new(model: &Model) -> Self {
        let none = [0.0; STAGES];
        let relaxing = vec![RelaxingPower::default(); model.relaxation_times.len()];
        Self { known: false, dampers: none, elements: none, relaxing }
    }

    /// A new step is attempted.
    pub(super) fn forget(&mut self) {
        self.known = false;
    }

    /// Takes the sums over the masses of `step`, unless they are known.
    pub(super) fn collect<const N: usize>(&mut self, step: &MassesInStep<'_>, maxwell: &Maxwell<N>) {
        if self.known {
            return;
        }
        self.known = true;
        let MassesInStep { model, h, .. } = *step;
        let rates: ByLink<[&[f64]; N]> = ByLink::from_fn(|kind| step.rates(kind));
        let products = ByLink::from_fn(|kind| rate_products(model, &rates[kind], kind));
        (self.dampers, self.elements) = ([0.0; STAGES], [0.0; STAGES]);
        for (i, power) in self.dampers[..N].iter_mut().enumerate() {
            *power = model.links.iter().zip(&products).map(|(link, products)| link.damping * products[i][i]).sum();
        }
        let changes = ByLink::from_fn(|kind| {
            let unresolved = model.rows_of(kind).any(|row| h / row.relaxation_time > RESOLVED);
            if unresolved { largest_change(&rates[kind]) } else { 0.0 }
        });
        for (index, (coefficients, relaxing)) in maxwell.coefficients().iter().zip(&mut self.relaxing).enumerate() {
            let mut sums = ElementSums::zero();
            *relaxing = RelaxingPower::default();
            for row in model.rows.iter().filter(|row| row.time_index == index) {
                let (a, kind) = (step.elements(row), row.kind);
                sums.add(row, a, &rates[kind], &products[kind]);
                if h / row.relaxation_time > RESOLVED {
                    relaxing.add(row, a, rates[kind][0], changes[kind]);
                }
            }
            self.elements[..N].iter_mut().enumerate().for_each(|(i, power)| *power += sums.power(coefficients, i));
        }
    }
}

impl<const N: usize> ElementSums<N> {
    fn zero() -> Self {
        let none = [0.0; N];
        Self { square: 0.0, mixed: none, rates: [none; N] }
    }

    /// Adds the elements of `row` with the elongations `a` (m) at the start of a step, with the `rates` of their links at its
    /// stages (m/s) and the `products` of these.
    fn add(&mut self, row: &MaxwellRow, a: &[f64], rates: &[&[f64]; N], products: &RateProducts<N>) {
        let power = row.stiffness / row.relaxation_time;
        let (square, mixed) = square_and_dots(a, *rates);
        self.square += power * square;
        self.mixed.iter_mut().zip(mixed).for_each(|(sum, mixed)| *sum += power * mixed);
        let rates = self.rates.as_flattened_mut().iter_mut().zip(products.as_flattened());
        rates.for_each(|(sum, product)| *sum += power * product);
    }

    /// Σ c a_i²/τ at stage `i`, W: a_i = p_i a_0 + h Σ_j q_ij ė_j multiplied out.
    fn power(&self, coefficients: &StageCoefficients<N>, i: usize) -> f64 {
        let (p, q) = (coefficients.start[i], &coefficients.rate[i]);
        let of_rate = |j: usize| {
            let with_earlier: f64 = (0..j).map(|l| q[l] * self.rates[j][l]).sum();
            q[j] * (2.0 * (p * self.mixed[j] + with_earlier) + q[j] * self.rates[j][j])
        };
        p * p * self.square + (0..=i).map(of_rate).sum::<f64>()
    }
}

impl RelaxingPower {
    /// Adds that of the elements of `row` with the elongations `a` (m) and the rates `rate` of their links (m/s) at the start of
    /// a step through which Σ (ė - ė_0)² comes to `change` (m²/s²).
    ///
    /// Where Σ l² is no larger than τ² times that, the stages resolve it. The power is 0 there, and goes there continuously.
    fn add(&mut self, row: &MaxwellRow, a: &[f64], rate: &[f64], change: f64) {
        let tau = row.relaxation_time;
        let l = |a: f64, rate: f64| a - tau * rate;
        let (square, explained) = (sum_of_pairs(a, rate, |a, rate| l(a, rate) * l(a, rate)), tau * tau * change);
        if square > explained {
            let share = row.stiffness / tau * (1.0 - explained / square);
            self.square += share * square;
            self.mixed += share * tau * sum_of_pairs(a, rate, |a, rate| l(a, rate) * rate);
        }
    }
}

/// A step over which energies are to be integrated.
#[derive(Clone, Copy)]
pub(super) struct StepPowers<'a, const N: usize> {
    pub model: &'a Model,
    pub maxwell: &'a Maxwell<N>,
    pub sums: &'a StepSums,
    /// The powers through the surface and the carrier at the stages.
    pub exchange: &'a [BoundaryPowers],
    /// The length of the step, s.
    pub h: f64,
    /// The weights of the stages.
    pub weights: &'a [f64; N],
    /// What they make of the values at the stages.
    pub measure: Measure,
}

/// What weights of the stages stand for.
#[derive(Clone, Copy, Debug)]
pub(super) enum Measure {
    /// The integral up to a fraction of the step, over its length.
    Integral(f64),
    /// The value at a fraction of the step.
    Value(f64),
}

impl Measure {
    /// That of e^(-zθ).
    fn of_decay(self, z: f64) -> f64 {
        match self {
            Self::Integral(theta) => -(-z * theta).exp_m1() / z,
            Self::Value(theta) => (-z * theta).exp(),
        }
    }
}

impl<const N: usize> StepPowers<'_, N> {
    /// Energies through all channels, J.
    pub(super) fn energies(&self) -> ChannelEnergies {
        let mut energy = self.lost();
        for (weight, exchange) in self.weights.iter().zip(self.exchange) {
            energy.friction += self.h * weight * exchange.friction;
            energy.shear += self.h * weight * exchange.shear;
            energy.input += self.h * weight * exchange.input;
            energy.carrier += self.h * weight * exchange.carrier;
        }
        energy
    }

    /// Energies lost in the dampers and Maxwell elements, J.
    fn lost(&self) -> ChannelEnergies {
        let Self { model, maxwell, sums, h, weights, measure, .. } = *self;
        let mut missed = 0.0;
        let times = maxwell.coefficients().iter().zip(&model.relaxation_times).zip(&sums.relaxing);
        for ((coefficients, tau), relaxing) in times.filter(|(_, relaxing)| relaxing.square > 0.0) {
            missed += UnresolvedRelaxation::new(h / tau, coefficients, weights, measure).of(relaxing);
        }
        ChannelEnergies {
            damper: h * dot(weights, &sums.dampers),
            maxwell: h * (dot(weights, &sums.elements) + missed),
            ..ChannelEnergies::default()
        }
    }
}

/// The products of one kind of link: of each stage with itself where there are dampers, of all with each other where there
/// are elements; 0 elsewhere.
fn rate_products<const N: usize>(model: &Model, rates: &[&[f64]; N], kind: LinkKind) -> RateProducts<N> {
    let all = model.rows_of(kind).next().is_some();
    if !all && model.links[kind].damping == 0.0 {
        return [[0.0; N]; N];
    }
    let mut products = [[0.0; N]; N];
    // Each stage with the one that is so many behind it, around the end: half of the distances make all pairs.
    for distance in 0..=if all { N / 2 } else { 0 } {
        let other = |i: usize| (i + distance) % N;
        let sums: [f64; N] = dots(std::array::from_fn(|i| (rates[i], rates[other(i)])));
        for (i, sum) in sums.into_iter().enumerate() {
            (products[i][other(i)], products[other(i)][i]) = (sum, sum);
        }
    }
    products
}

/// The largest Σ (ė_i - ė_0)² of a stage over the links with these rates at the stages, m²/s². It does not use the products,
/// whose rounding errors exceed the change in a steady motion.
fn largest_change(rates: &[&[f64]]) -> f64 {
    let [start, later @ ..] = rates else { return 0.0 };
    let change = |rate: &&[f64]| sum_of_pairs(rate, start, |rate, start| (rate - start) * (rate - start));
    later.iter().map(change).fold(0.0, f64::max)
}

/// The ratio of step and relaxation time up to which the stages resolve an element. From twice this ratio on, all that
/// they miss is put in; in between it grows linearly. Steps as long as the relaxation time are usual where those of a
/// co-simulation master are, and the loss must not depend on the rounding of their length.
const RESOLVED: f64 = 1.0;

/// The difference between the integral, or value, and what the stages make of it for l = a_0 - τė_0, which decays as
/// e^(-zθ) beside τė_0.
///
/// An element that does not yet follow its link, a_0 ≠ τė_0, after a start undeformed or a jump of ė, may relax in a
/// time far shorter than the step, without any stage that resolves it. So the part of Σ_i weight_i a_i² that belongs to
/// a_0 - τė_0 is replaced by the integral that the sum stands for.
struct UnresolvedRelaxation {
    /// Of l²: that of e^(-2zθ) less Σ_i weight_i p_i².
    square: f64,
    /// Of 2 l τė_0: that of e^(-zθ) less Σ_i weight_i p_i.
    mixed: f64,
}

impl UnresolvedRelaxation {
    fn new<const N: usize>(z: f64, coefficients: &StageCoefficients<N>, weights: &[f64; N], measure: Measure) -> Self {
        let squares: f64 = weights.iter().zip(coefficients.start).map(|(weight, p)| weight * p * p).sum();
        let share = (z / RESOLVED - 1.0).min(1.0);
        Self {
            square: share * (measure.of_decay(2.0 * z) - squares),
            mixed: share * (measure.of_decay(z) - dot(weights, &coefficients.start)),
        }
    }

    /// The power, W, in elements that relax with this.
    fn of(&self, relaxing: &RelaxingPower) -> f64 {
        self.square * relaxing.square + 2.0 * self.mixed * relaxing.mixed
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::ESDIRK5;

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
        let model = Model::from_text(SCENE);
        let mut seed = 1_u32;
        let mut number = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(seed) / f64::from(u32::MAX) - 0.5
        };
        let h = 0.01;
        let mut stages = vec![Rates::new(&model); STAGES];
        stages.iter_mut().flat_map(|stage| &mut stage.elongation_rate).flatten().for_each(|rate| *rate = number());
        // An elongation of the order of its relaxation time.
        let mut start = State::new(model.masses(), model.maxwell_variables());
        for row in &model.rows {
            start.maxwell[row.range.clone()].iter_mut().for_each(|a| *a = row.relaxation_time.min(1.0) * number());
        }
        let mut maxwell = Maxwell::<STAGES>::new(&model, true);
        maxwell.begin(&model, &ESDIRK5, &start.maxwell, h);
        let weights: [f64; STAGES] = std::array::from_fn(|_| number());
        let mut sums = StepSums::new(&model);
        let step = MassesInStep { model: &model, masses: 0..5, start: &start, stages: &stages, h };
        sums.collect(&step, &maxwell);
        let (measure, weights) = (Measure::Integral(weights.iter().sum()), &weights);
        let powers = StepPowers { model: &model, maxwell: &maxwell, sums: &sums, exchange: &[], h, weights, measure };
        let found = powers.lost();

        let mut expected = ChannelEnergies::default();
        for (i, weight) in weights.iter().enumerate() {
            for kind in LinkKind::ALL {
                let squares: f64 = stages[i].elongation_rate[kind].iter().map(|rate| rate * rate).sum();
                expected.damper += h * weight * model.links[kind].damping * squares;
                for row in model.rows_of(kind) {
                    let coefficients = &maxwell.coefficients()[row.time_index];
                    for (link, a) in start.maxwell[row.range.clone()].iter().enumerate() {
                        let rate = |j: usize| coefficients.rate[i][j] * stages[j].elongation_rate[kind][link];
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
