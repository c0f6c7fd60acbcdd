//! The energies through the channels over a step (docs/theory.md, section 7).
//!
//! Every channel is a quadrature of its power over the stages, E = h Σ_i b_i P_i. The powers of dampers and Maxwell
//! elements are quadratic in the rates ė_j and in a_0, from which the elements' elongations at the stages follow
//! (`maxwell`). So sums over the layer are taken of their products, once per step, and not of every element at every
//! stage.

use super::dense::DenseOutput;
use super::maxwell::ElementCoefficients;
use super::tableau::{MAX_STAGES, StageWeights};
use crate::math::{dot, dots, square_and_dots, sum_of_pairs};
use crate::model::{BoundaryPowers, ByLink, ChannelEnergies, LinkKind, MaxwellRow, Model};

/// Σ ė_i ė_j over the links of one kind, m²/s², where they are needed; 0 elsewhere.
type RateProducts<const N: usize> = [[f64; N]; N];

/// What the energies up to any fraction of a step follow from: the powers at its stages, summed over the layer or a
/// part of it.
#[derive(Clone, Debug)]
pub(super) struct EnergySums {
    /// Whether they are those of the last attempted step.
    known: bool,
    /// The power lost in dampers, W.
    dampers: StageWeights,
    /// The power lost in Maxwell elements, W.
    elements: StageWeights,
    /// What the stages do not resolve of it, by relaxation time.
    relaxing: Vec<RelaxingPower>,
}

/// Sums over all elements of one relaxation time, from which the power lost in them at the stages follows.
struct MaxwellSums<const N: usize> {
    /// Σ c a_0²/τ, W.
    square: f64,
    /// Σ c a_0 ė_j/τ, W/s.
    mixed: [f64; N],
    /// Σ c ė_i ė_j/τ, W/s².
    rates: RateProducts<N>,
}

/// The power lost in the elements of one relaxation time that do not follow their links yet: of l = a_0 - τė_0, over
/// all of them; 0 where the stages resolve it.
#[derive(Clone, Copy, Debug, Default)]
struct RelaxingPower {
    /// Σ c l²/τ, W.
    square: f64,
    /// Σ c l ė_0, W.
    mixed: f64,
}

impl EnergySums {
    /// Workspace for the elements of `model`.
    pub(super) fn new(model: &Model) -> Self {
        let relaxing = vec![RelaxingPower::default(); model.relaxation_times.len()];
        Self { known: false, dampers: StageWeights::default(), elements: StageWeights::default(), relaxing }
    }

    /// A new step is attempted.
    pub(super) fn invalidate(&mut self) {
        self.known = false;
    }

    /// Energies through the channels, J, that the powers at the stages of `step` make with these `weights`, which stand
    /// for `measure`; the masses' powers through the surface and the carrier at the stages are `exchange`.
    pub(super) fn energies(
        &mut self,
        step: &DenseOutput<'_>,
        exchange: &[BoundaryPowers],
        weights: &StageWeights,
        measure: Measure,
    ) -> ChannelEnergies {
        self.collect(step);
        let (h, mut energy) = (step.span.length, self.lost(step, weights, measure));
        for (weight, exchange) in weights.iter().zip(exchange).take(step.stages().len()) {
            energy.friction += h * weight * exchange.friction;
            energy.shear += h * weight * exchange.shear;
            energy.fine += h * weight * exchange.fine;
            energy.input += h * weight * exchange.input;
            energy.carrier += h * weight * exchange.carrier;
            energy.damper += h * weight * exchange.measured[0];
            energy.maxwell += h * weight * exchange.measured[1];
        }
        energy
    }

    /// Energies lost in the dampers and Maxwell elements, J.
    fn lost(&self, step: &DenseOutput<'_>, weights: &StageWeights, measure: Measure) -> ChannelEnergies {
        let (h, weights) = (step.span.length, &weights[..step.stages().len()]);
        let mut missed = 0.0;
        let times = step.method.maxwell.coefficients().iter().zip(&step.model.relaxation_times).zip(&self.relaxing);
        for ((coefficients, tau), relaxing) in times.filter(|(_, relaxing)| relaxing.square > 0.0) {
            missed += UnresolvedRelaxation::new(h / tau, coefficients, weights, measure).power(relaxing);
        }
        ChannelEnergies {
            damper: h * dot(weights, &self.dampers),
            maxwell: h * (dot(weights, &self.elements) + missed),
            ..ChannelEnergies::default()
        }
    }

    /// Takes the sums over the masses of `step`, unless they are known.
    fn collect(&mut self, step: &DenseOutput<'_>) {
        if self.known {
            return;
        }
        self.known = true;
        (self.dampers, self.elements) = (StageWeights::default(), StageWeights::default());
        match step.stages().len() {
            3 => self.collect_stages::<3>(step),
            4 => self.collect_stages::<4>(step),
            _ => self.collect_stages::<MAX_STAGES>(step),
        }
    }

    /// [Collects](Self::collect) the sums at `N` stages: products of so many arrays are summed at once.
    fn collect_stages<const N: usize>(&mut self, step: &DenseOutput<'_>) {
        let (model, h) = (step.model, step.span.length);
        // The dampers' powers are squares of the rates; the elements' also take their products.
        let rates: ByLink<[&[f64]; N]> = ByLink::from_fn(|kind| link_rates(step, kind));
        let products = ByLink::from_fn(|kind| rate_products(model, &rates[kind], kind));
        for (i, power) in self.dampers[..N].iter_mut().enumerate() {
            *power = model.links.iter().zip(&products).map(|(link, products)| link.damping * products[i][i]).sum();
        }
        let changes = ByLink::from_fn(|kind| {
            let unresolved = model.rows_of(kind).any(|row| h / row.relaxation_time > RESOLVED);
            if unresolved { largest_change(&rates[kind]) } else { 0.0 }
        });
        // The elements by relaxation time, and what the stages do not resolve of them.
        let coefficients = step.method.maxwell.coefficients();
        for (index, (coefficients, relaxing)) in coefficients.iter().zip(&mut self.relaxing).enumerate() {
            let mut sums = MaxwellSums::zero();
            *relaxing = RelaxingPower::default();
            for row in model.rows.iter().filter(|row| row.time_index == index) {
                let (kind, first) = (row.kind, row.range.start + step.masses.start);
                let a = &step.start.maxwell[first..first + row.kind.count(step.masses.len())];
                if !model.is_measured(kind) {
                    sums.add(row, a, &rates[kind], &products[kind]);
                }
                if h / row.relaxation_time > RESOLVED {
                    relaxing.add(row, a, rates[kind][0], changes[kind]);
                }
            }
            self.elements[..N].iter_mut().enumerate().for_each(|(i, power)| *power += sums.power(coefficients, i));
        }
    }
}

/// ė of the links of one kind at the first `N` stages, m/s; none where there is no such link.
fn link_rates<'a, const N: usize>(step: &DenseOutput<'a>, kind: LinkKind) -> [&'a [f64]; N] {
    let (stages, links) = (step.stages(), step.masses.start..step.masses.start + kind.count(step.masses.len()));
    std::array::from_fn(|i| stages[i].elongation_rate[kind].get(links.clone()).unwrap_or_default())
}

impl<const N: usize> MaxwellSums<N> {
    fn zero() -> Self {
        Self { square: 0.0, mixed: [0.0; N], rates: [[0.0; N]; N] }
    }

    /// Adds the elements of `row` with the elongations `a` (m) at the start of a step, with the `rates` of their links
    /// at its stages (m/s) and the `products` of these.
    fn add(&mut self, row: &MaxwellRow, a: &[f64], rates: &[&[f64]; N], products: &RateProducts<N>) {
        let power = row.stiffness / row.relaxation_time;
        let (square, mixed) = square_and_dots(a, *rates);
        self.square += power * square;
        self.mixed.iter_mut().zip(mixed).for_each(|(sum, mixed)| *sum += power * mixed);
        let rates = self.rates.as_flattened_mut().iter_mut().zip(products.as_flattened());
        rates.for_each(|(sum, product)| *sum += power * product);
    }

    /// Σ c a_i²/τ at stage `i`, W: a_i = p_i a_0 + h Σ_j q_ij ė_j multiplied out.
    fn power(&self, coefficients: &ElementCoefficients, i: usize) -> f64 {
        let (p, q) = (coefficients.start[i], &coefficients.rate[i]);
        let of_rate = |j: usize| {
            let with_earlier: f64 = (0..j).map(|l| q[l] * self.rates[j][l]).sum();
            q[j] * (2.0 * (p * self.mixed[j] + with_earlier) + q[j] * self.rates[j][j])
        };
        p * p * self.square + (0..=i).map(of_rate).sum::<f64>()
    }
}

impl RelaxingPower {
    /// Adds that of the elements of `row` with the elongations `a` (m) and the rates `rate` of their links (m/s) at the
    /// start of a step through which Σ (ė - ė_0)² comes to `change` (m²/s²).
    ///
    /// Where Σ l² is no larger than τ² times that, the stages resolve it. The power is 0 there, and goes there
    /// continuously.
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
    fn decay(self, z: f64) -> f64 {
        match self {
            Self::Integral(theta) => -(-z * theta).exp_m1() / z,
            Self::Value(theta) => (-z * theta).exp(),
        }
    }
}

/// The products of one kind of link: of each stage with itself where there are dampers, of all with each other where
/// there are elements; 0 elsewhere.
fn rate_products<const N: usize>(model: &Model, rates: &[&[f64]; N], kind: LinkKind) -> RateProducts<N> {
    let mut products = [[0.0; N]; N];
    let all = model.rows_of(kind).next().is_some();
    // What links in spatial measure lose is summed up at the stages.
    if model.is_measured(kind) || !all && model.links[kind].damping == 0.0 {
        return products;
    }
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

/// The largest Σ (ė_i - ė_0)² of a stage over the links with these rates at the stages, m²/s². It does not use the
/// products, whose rounding errors exceed the change in a steady motion.
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
    fn new(z: f64, coefficients: &ElementCoefficients, weights: &[f64], measure: Measure) -> Self {
        let squares: f64 = weights.iter().zip(coefficients.start).map(|(weight, p)| weight * p * p).sum();
        let weight = (z / RESOLVED - 1.0).min(1.0);
        Self {
            square: weight * (measure.decay(2.0 * z) - squares),
            mixed: weight * (measure.decay(z) - dot(weights, &coefficients.start)),
        }
    }

    /// The power, W, in elements that relax with this.
    fn power(&self, relaxing: &RelaxingPower) -> f64 {
        self.square * relaxing.square + 2.0 * self.mixed * relaxing.mixed
    }
}

#[cfg(test)]
mod tests {
    use super::super::method::{RungeKutta, Stages, TimeSpan};
    use super::super::scheme::Scheme;
    use super::*;
    use crate::model::{Carrier, State};

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
        let mut values = Stages::new(&model, MAX_STAGES, true, Vec::new());
        values
            .rates
            .iter_mut()
            .flat_map(|stage| &mut stage.elongation_rate)
            .flatten()
            .for_each(|rate| *rate = number());
        // An elongation of the order of its relaxation time.
        let mut start = State::new(&model);
        for row in &model.rows {
            start.maxwell[row.range.clone()].iter_mut().for_each(|a| *a = row.relaxation_time.min(1.0) * number());
        }
        let mut method = RungeKutta::new(Scheme::Esdirk5, &model, true);
        method.maxwell.begin(&model, &start.maxwell, h);
        let weights: StageWeights = std::array::from_fn(|_| number());
        let mut sums = EnergySums::new(&model);
        let (masses, carrier, span) = (
            0..5,
            &Carrier::new(0.0, Default::default(), Default::default(), &model.profile),
            TimeSpan { start: 0.0, length: h },
        );
        let step =
            DenseOutput { model: &model, masses, carrier, span, start: &start, method: &method, values: &values };
        sums.collect(&step);
        let found = sums.lost(&step, &weights, Measure::Integral(weights.iter().sum()));

        let (stages, maxwell) = (&values.rates, &method.maxwell);
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
