//! The Maxwell elements over one step, condensed (docs/theory.md, section 2).
//!
//! An element is linear, ȧ = ė - a/τ, so its elongation at stage i follows from that at the start of the step and from
//! the rates ė at the stages,
//!
//!   a_i = p_i a_0 + h Σ_{j≤i} q_ij ė_j,
//!
//! with numbers p, q that depend on h/τ alone. The forces of all elements of one link are then
//!
//!   Σ c a_i = P_i + h Σ_{j<i} Q_ij ė_j + h Q_ii ė_i,   P_i = Σ c p_i a_0,   Q_ij = Σ c q_ij.
//!
//! So the elements are visited once per step, not once per stage, and the cost of a stage does not depend on their
//! number.

use super::stage_values::StageValues;
use super::tableau::{MAX_STAGES, StageWeights, Tableau};
use crate::math::weighted_sum;
use crate::model::{ByLink, ElementSquares, LinkKind, MaxwellRow, Model, SpatialMeasure};

/// Workspace for the Maxwell elements of a layer over one step.
#[derive(Clone, Debug)]
pub(super) struct Maxwell {
    tableau: &'static Tableau,
    /// By relaxation time of the model.
    coefficients: Vec<ElementCoefficients>,
    kinds: ByLink<KindSums>,
}

/// What the elongation of an element at the stages of a step consists of, for one relaxation time.
#[derive(Clone, Debug, Default)]
pub(super) struct ElementCoefficients {
    /// p_i.
    pub start: StageWeights,
    /// h q_ij, s.
    pub rate: [StageWeights; MAX_STAGES],
    /// The embedded error estimate of a: the weights of a_0 and of ė_j, the latter in s.
    error_start: f64,
    error_rate: StageWeights,
}

/// The weights of an element's elongation at the start and at the end of a step, and of its link's rates at the stages
/// (s), in its elongation within the step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ElementWeights {
    pub ends: [f64; 2],
    pub rates: StageWeights,
}

/// The elements of one kind of link, summed.
#[derive(Clone, Debug)]
struct KindSums {
    /// h Q_ij, N s/m.
    rate: [StageWeights; MAX_STAGES],
    error_rate: StageWeights,
    /// P_i of the implicit stages one after another, by link, N; empty where the links have no elements.
    start: Vec<f64>,
    /// The part of the embedded error estimate that a_0 makes, by link, N.
    error_start: Vec<f64>,
}

impl Maxwell {
    /// Workspace for the elements of `model` over steps by a method, if it `is_used`.
    pub(super) fn new(tableau: &'static Tableau, model: &Model, is_used: bool) -> Self {
        let times = if is_used { model.relaxation_times.len() } else { 0 };
        let kinds = ByLink::from_fn(|kind| {
            let present = is_used && model.rows.iter().any(|row| row.kind == kind);
            KindSums::new(tableau, if present { kind.count(model.masses()) } else { 0 })
        });
        Self { tableau, coefficients: vec![ElementCoefficients::default(); times], kinds }
    }

    /// Begins a step of length `h` (s) from the elongations `a` (m).
    pub(super) fn begin(&mut self, model: &Model, a: &[f64], h: f64) {
        for (coefficients, relaxation_time) in self.coefficients.iter_mut().zip(&model.relaxation_times) {
            coefficients.set(self.tableau, h / relaxation_time, h);
        }
        for (kind, sums) in LinkKind::ALL.into_iter().zip(&mut self.kinds) {
            if sums.error_start.is_empty() {
                continue;
            }
            let coefficients = &self.coefficients;
            sums.collect(a, || model.rows_of(kind).map(|row| (row, &coefficients[row.time_index])));
        }
    }

    /// Whether the links of `kind` have Maxwell elements.
    pub(super) fn has_elements(&self, kind: LinkKind) -> bool {
        !self.kinds[kind].error_start.is_empty()
    }

    /// The coefficients by relaxation time of the model.
    pub(super) fn coefficients(&self) -> &[ElementCoefficients] {
        &self.coefficients
    }

    /// Writes P_i + h Σ_{j<i} Q_ij ė_j by kind of link: the part of the elements' forces that is known before stage
    /// `i`, N.
    pub(super) fn known_forces(&self, i: usize, stages: &[StageValues], forces: &mut ByLink<Vec<f64>>) {
        for kind in LinkKind::ALL.into_iter().filter(|&kind| self.has_elements(kind)) {
            let sums = &self.kinds[kind];
            let start = std::iter::once((1.0, sums.start_of(i)));
            weighted_sum(&mut forces[kind], start.chain(by_rate(kind, &sums.rate[i][..i], stages)));
        }
    }

    /// Writes the embedded error estimate of the elements' forces of the links of `kind`, N.
    pub(super) fn force_error(&self, kind: LinkKind, stages: &[StageValues], force: &mut [f64]) {
        let sums = &self.kinds[kind];
        let start = std::iter::once((1.0, &sums.error_start[..]));
        weighted_sum(force, start.chain(by_rate(kind, &sums.error_rate, stages)));
    }

    /// Writes the elongations at stage `i` of a step from `start` to `a`, m.
    pub(super) fn at_stage(&self, model: &Model, i: usize, start: &[f64], stages: &[StageValues], a: &mut [f64]) {
        for row in &model.rows {
            let coefficients = &self.coefficients[row.time_index];
            let from = std::iter::once((coefficients.start[i], &start[row.range.clone()]));
            let driven = by_rate(row.kind, &coefficients.rate[i][..=i], stages);
            weighted_sum(&mut a[row.range.clone()], from.chain(driven));
        }
    }

    /// Writes the squares of the elongations of the links in spatial measure at stage `i` of a step from `start`, as far as
    /// the earlier `stages` determine them.
    pub(super) fn measured_squares(
        &self,
        model: &Model,
        i: usize,
        start: &[f64],
        stages: &[StageValues],
        squares: &mut MeasuredSquares,
    ) {
        squares.clear();
        for row in &model.rows {
            let Some(n) = SpatialMeasure::LINKS.iter().position(|&kind| kind == row.kind) else { continue };
            let ElementCoefficients { start: of_start, rate, .. } = &self.coefficients[row.time_index];
            let known = &mut squares.known[..row.range.len()];
            let from = std::iter::once((of_start[i], &start[row.range.clone()]));
            weighted_sum(known, from.chain(by_rate(row.kind, &rate[i][..i], stages)));
            squares.energy[n].add(row.stiffness, known, rate[i][i]);
            squares.power[n].add(row.stiffness / row.relaxation_time, known, rate[i][i]);
        }
    }

    /// The weights of the elements of one relaxation time in the sum of their elongations at the start, at stage `i`
    /// and at the end of a step.
    pub(super) fn weights_between(
        &self,
        time_index: usize,
        i: usize,
        [of_start, of_stage, of_end]: [f64; 3],
    ) -> ElementWeights {
        let coefficients = &self.coefficients[time_index];
        let ends = [of_start + of_stage * coefficients.start[i], of_end];
        let mut rates = [0.0; MAX_STAGES];
        for (weight, rate) in rates.iter_mut().zip(&coefficients.rate[i][..=i]) {
            *weight = of_stage * rate;
        }
        ElementWeights { ends, rates }
    }
}

/// Σ c a² and Σ c a²/τ of the elements of the links in spatial measure at a stage.
#[derive(Clone, Debug)]
pub(super) struct MeasuredSquares {
    /// Twice the energies, J.
    pub energy: [ElementSquares; 2],
    /// The powers lost, W.
    pub power: [ElementSquares; 2],
    /// Workspace for the known elongations of one row, m.
    known: Vec<f64>,
}

impl MeasuredSquares {
    pub(super) fn new(model: &Model) -> Self {
        let squares = || SpatialMeasure::LINKS.map(|kind| ElementSquares::new(kind.count(model.masses())));
        Self { energy: squares(), power: squares(), known: vec![0.0; model.masses()] }
    }

    fn clear(&mut self) {
        self.energy.iter_mut().chain(&mut self.power).for_each(ElementSquares::clear);
    }
}

/// The elongation rates of the links of `kind` at the stages, with their weights; stages of weight 0 are left out.
pub(super) fn by_rate<'a>(
    kind: LinkKind,
    weights: &'a [f64],
    stages: &'a [StageValues],
) -> impl Iterator<Item = (f64, &'a [f64])> {
    let stages = weights.iter().zip(stages).filter(|(weight, _)| **weight != 0.0);
    stages.map(move |(&weight, stage)| (weight, &stage.elongation_rate[kind][..]))
}

impl ElementCoefficients {
    /// Sets the coefficients for a step of length `h` and its ratio `z` = h/τ. A stage gives a_i = g (a*_i + γhė_i),
    /// g = 1/(1 + γz), from a*_i = a_0 + h Σ_{j<i} a_ij ȧ_j. Its rate hȧ_i = hė_i - z a_i equals g (hė_i - z a*_i), in
    /// which nothing cancels, however large z is.
    fn set(&mut self, tableau: &Tableau, z: f64, h: f64) {
        match tableau.stages {
            3 => self.set_stages::<3>(tableau, z, h),
            4 => self.set_stages::<4>(tableau, z, h),
            _ => self.set_stages::<MAX_STAGES>(tableau, z, h),
        }
    }

    /// [Sets](Self::set) the coefficients for `N` stages: the compiler unrolls the loops.
    fn set_stages<const N: usize>(&mut self, tableau: &Tableau, z: f64, h: f64) {
        let gamma = tableau.gamma();
        let g = 1.0 / (1.0 + gamma * z);
        // hȧ_i by a_0 and by hė_j.
        let mut change_start = [0.0; N];
        let mut change_rate = [[0.0; N]; N];
        (self.start[0], change_start[0], change_rate[0][0]) = (1.0, -z, 1.0);
        for i in 1..N {
            let weights = &tableau.a[i][..i];
            let start = 1.0 + sum(weights, &change_start, |change| *change);
            (self.start[i], change_start[i]) = (g * start, -z * g * start);
            for j in 0..i {
                let rate = sum(weights, &change_rate, |change| change[j]);
                (self.rate[i][j], change_rate[i][j]) = (h * g * rate, -z * g * rate);
            }
            (self.rate[i][i], change_rate[i][i]) = (h * g * gamma, g);
        }
        let error = &tableau.error[..N];
        self.error_start = sum(error, &change_start, |change| *change);
        for j in 0..N {
            self.error_rate[j] = h * sum(error, &change_rate, |change| change[j]);
        }
    }
}

fn sum<T>(weights: &[f64], terms: &[T], number: impl Fn(&T) -> f64) -> f64 {
    weights.iter().zip(terms).map(|(weight, term)| weight * number(term)).sum()
}

impl KindSums {
    fn new(tableau: &Tableau, links: usize) -> Self {
        Self {
            rate: [[0.0; MAX_STAGES]; MAX_STAGES],
            error_rate: [0.0; MAX_STAGES],
            start: vec![0.0; tableau.last() * links],
            error_start: vec![0.0; links],
        }
    }

    /// P_i of stage `i`, an implicit one, by link, N.
    fn start_of(&self, i: usize) -> &[f64] {
        let links = self.error_start.len();
        &self.start[(i - 1) * links..i * links]
    }

    fn collect<'a, Rows>(&mut self, a: &[f64], rows: impl Fn() -> Rows)
    where
        Rows: Iterator<Item = (&'a MaxwellRow, &'a ElementCoefficients)>,
    {
        let start = |i: usize| {
            rows().map(move |(row, coefficients)| (row.stiffness * coefficients.start[i], &a[row.range.clone()]))
        };
        let links = self.error_start.len();
        for (i, sums) in (1..).zip(self.start.chunks_exact_mut(links)) {
            weighted_sum(sums, start(i));
        }
        let error = rows().map(|(row, coefficients)| (row.stiffness * coefficients.error_start, &a[row.range.clone()]));
        weighted_sum(&mut self.error_start, error);
        (self.rate, self.error_rate) = ([[0.0; MAX_STAGES]; MAX_STAGES], [0.0; MAX_STAGES]);
        for (row, coefficients) in rows() {
            let sums = self.rate.iter_mut().chain([&mut self.error_rate]);
            for (sums, rates) in sums.zip(coefficients.rate.iter().chain([&coefficients.error_rate])) {
                sums.iter_mut().zip(rates).for_each(|(sum, rate)| *sum += row.stiffness * rate);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::ESDIRK5;

    const METHOD: Tableau = ESDIRK5;

    /// Stage by stage, as the method is defined: a_i and the embedded estimate, in units where h = 1.
    fn stage_by_stage(z: f64, a: f64, rates: &StageWeights) -> (StageWeights, f64) {
        let (mut found, mut changes) = ([a; MAX_STAGES], [0.0; MAX_STAGES]);
        changes[0] = rates[0] - z * a;
        for i in 1..MAX_STAGES {
            let star = a + (0..i).map(|j| METHOD.a[i][j] * changes[j]).sum::<f64>();
            found[i] = (star + METHOD.gamma() * rates[i]) / (1.0 + METHOD.gamma() * z);
            changes[i] = rates[i] - z * found[i];
        }
        (found, METHOD.error.iter().zip(changes).map(|(weight, change)| weight * change).sum())
    }

    #[test]
    fn coefficients_are_those_of_the_stages() {
        let rates = [0.3, -0.7, 1.1, 0.2, -0.4, 0.9, 0.5];
        for z in [0.0, 1e-8, 0.1, 1.0, 30.0, 1e4] {
            let a = 0.8 / (1.0 + z);
            let mut coefficients = ElementCoefficients::default();
            coefficients.set(&METHOD, z, 1.0);
            let (expected, expected_error) = stage_by_stage(z, a, &rates);
            for i in 0..MAX_STAGES {
                let driven: f64 = coefficients.rate[i].iter().zip(&rates).map(|(q, rate)| q * rate).sum();
                let found = coefficients.start[i] * a + driven;
                // In the plain recursion a change hȧ loses the digits that ė and z a share.
                assert!(
                    (found - expected[i]).abs() < 1e-14 / (1.0 + z) * 100.0,
                    "z {z:e}, stage {i}: {found} {}",
                    expected[i]
                );
            }
            let driven: f64 = coefficients.error_rate.iter().zip(&rates).map(|(e, rate)| e * rate).sum();
            let found = coefficients.error_start * a + driven;
            assert!((found - expected_error).abs() < 1e-13, "z {z:e}: {found} {expected_error}");
        }
    }

    /// τ far below the step length: at its end a = τė, however short τ is.
    #[test]
    fn a_short_element_is_a_damper() {
        for z in [1e9, 1e13, 1e100] {
            let mut coefficients = ElementCoefficients::default();
            coefficients.set(&METHOD, z, 1.0);
            let a = 1.0 / z;
            let end = coefficients.start[MAX_STAGES - 1] * a + coefficients.rate[MAX_STAGES - 1].iter().sum::<f64>();
            // R(∞) = 0 within the digits of the printed coefficients; of 1/z a few roundings.
            assert!((end * z - 1.0).abs() < 1e-8, "z {z:e}: {}", end * z);
        }
    }
}
