//! The energies that go through the channels in a step.
//!
//! Every channel is a quadrature of its power over the stages, E = h Σ_i b_i P_i. The powers of dampers and Maxwell
//! elements are quadratic in the rates ė_j and in a_0, from which the elements' elongations at the stages follow
//! (`maxwell`). So the sums over the layer are taken of their products, once, and not of every element at every stage.

use super::maxwell::{Course, Maxwell};
use super::rates::Rates;
use crate::math::dot;
use crate::model::{LinkKind, MaxwellRow, Model, Power};

/// Σ ė_i ė_j over the links of one kind, m²/s², for j ≤ i.
type Products<const STAGES: usize> = [[f64; STAGES]; STAGES];

/// Energies lost in the dampers and Maxwell elements over a step of length `h` whose stages count with `weights`; the
/// elongations at the start are `a`.
pub(super) fn lost<const STAGES: usize>(
    model: &Model,
    maxwell: &Maxwell<STAGES>,
    a: &[f64],
    stages: &[Rates],
    (h, weights): (f64, &[f64; STAGES]),
) -> Power {
    let mut energy = Power::default();
    for kind in LinkKind::ALL {
        let damping = model.links[kind as usize].damping;
        if damping == 0.0 && !maxwell.has(kind) {
            continue;
        }
        let products = products::<STAGES>(stages, kind, maxwell.has(kind));
        energy.damper += h * damping * (0..STAGES).map(|i| weights[i] * products[i][i]).sum::<f64>();
        for (row, course) in maxwell.rows(model, kind) {
            let square = row_squares(row, course, a, stages, &products, weights);
            energy.maxwell += h * row.stiffness / row.relaxation_time * square;
        }
    }
    energy
}

fn products<const STAGES: usize>(stages: &[Rates], kind: LinkKind, all: bool) -> Products<STAGES> {
    let mut products = [[0.0; STAGES]; STAGES];
    for i in 0..STAGES {
        let rate = &stages[i].elongation_rate[kind as usize];
        for j in if all { 0 } else { i }..=i {
            products[i][j] = dot(rate, &stages[j].elongation_rate[kind as usize]);
        }
    }
    products
}

/// Σ_i weight_i Σ a_i² over the elements of one row: a_i = p_i a_0 + h Σ_j q_ij ė_j multiplied out.
fn row_squares<const STAGES: usize>(
    row: &MaxwellRow,
    course: &Course<STAGES>,
    a: &[f64],
    stages: &[Rates],
    products: &Products<STAGES>,
    weights: &[f64; STAGES],
) -> f64 {
    let a = &a[row.range.clone()];
    let start = dot(a, a);
    let with_start: [f64; STAGES] = std::array::from_fn(|j| dot(a, &stages[j].elongation_rate[row.kind as usize]));
    let mut sum = weights[0] * start;
    for i in 1..STAGES {
        let (p, q) = (course.start[i], &course.rate[i]);
        let mut square = p * p * start;
        for j in 0..=i {
            let below: f64 = (0..j).map(|l| q[l] * products[j][l]).sum();
            square += q[j] * (2.0 * (p * with_start[j] + below) + q[j] * products[j][j]);
        }
        sum += weights[i] * square;
    }
    sum
}
