//! The curvatures M_i = z''(x_i) that make a spline C²: with h_i = x_{i+1} - x_i, μ_i = h_{i-1}/(h_{i-1} + h_i),
//! λ_i = 1 - μ_i and the second divided difference of the heights,
//!
//! ```text
//! μ_i M_{i-1} + 2 M_i + λ_i M_{i+1} = 6 z[x_{i-1}, x_i, x_{i+1}]
//! ```
//!
//! (Stoer & Bulirsch, Introduction to Numerical Analysis, 2.4.2). The rows are diagonally dominant: no pivoting.

/// One row of a tridiagonal system; the diagonal is 2 except where the cyclic solution changes it.
#[derive(Clone, Copy, Debug)]
struct Row {
    lower: f64,
    diagonal: f64,
    upper: f64,
    right: f64,
}

/// The curvatures at the points of a natural spline: 0 at both ends.
pub(super) fn natural_curvatures(x: &[f64], z: &[f64]) -> Vec<f64> {
    let inner: Vec<Row> =
        (1..x.len() - 1).map(|i| row(x[i] - x[i - 1], x[i + 1] - x[i], z[i] - z[i - 1], z[i + 1] - z[i])).collect();
    let mut curvatures = Vec::with_capacity(x.len());
    curvatures.push(0.0);
    curvatures.extend(solve_tridiagonal(&inner, inner.iter().map(|row| row.right)));
    curvatures.push(0.0);
    curvatures
}

/// The curvatures at the points of a periodic spline: the last equal to the first.
pub(super) fn periodic_curvatures(x: &[f64], z: &[f64]) -> Vec<f64> {
    let intervals = x.len() - 1;
    let before = |i: usize| if i == 0 { intervals - 1 } else { i - 1 };
    let width = |i: usize| x[i + 1] - x[i];
    let rise = |i: usize| z[i + 1] - z[i];
    let rows: Vec<Row> = (0..intervals).map(|i| row(width(before(i)), width(i), rise(before(i)), rise(i))).collect();
    let mut curvatures = solve_cyclic(&rows);
    curvatures.push(curvatures[0]);
    curvatures
}

fn row(h_left: f64, h_right: f64, rise_left: f64, rise_right: f64) -> Row {
    let span = h_left + h_right;
    let right = 6.0 * (rise_right / h_right - rise_left / h_left) / span;
    Row { lower: h_left / span, diagonal: 2.0, upper: h_right / span, right }
}

/// Gauss's elimination of a tridiagonal system.
fn solve_tridiagonal(rows: &[Row], right: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut uppers = Vec::with_capacity(rows.len());
    let mut solution: Vec<f64> = Vec::with_capacity(rows.len());
    let (mut upper_before, mut right_before) = (0.0, 0.0);
    for (row, right) in rows.iter().zip(right) {
        let pivot = row.diagonal - row.lower * upper_before;
        upper_before = row.upper / pivot;
        right_before = (right - row.lower * right_before) / pivot;
        uppers.push(upper_before);
        solution.push(right_before);
    }
    for i in (1..solution.len()).rev() {
        solution[i - 1] -= uppers[i - 1] * solution[i];
    }
    solution
}

/// A tridiagonal system whose first row's `lower` and last row's `upper` wrap around the matrix.
///
/// With fewer than three unknowns the wrapped entries fall onto others.
fn solve_cyclic(rows: &[Row]) -> Vec<f64> {
    match rows {
        [] => Vec::new(),
        // One interval from a height to the same height: flat.
        [_] => vec![0.0],
        // lower + upper = 1 and the right sides are opposite: 2 M_0 + M_1 = r, M_0 + 2 M_1 = -r.
        [first, _] => vec![first.right, -first.right],
        _ => solve_sherman_morrison(rows),
    }
}

/// Sherman and Morrison: the cyclic matrix is a tridiagonal one plus the dyad (γ, 0, …, α)ᵀ (1, 0, …, β/γ).
fn solve_sherman_morrison(rows: &[Row]) -> Vec<f64> {
    let last = rows.len() - 1;
    let (alpha, beta, gamma) = (rows[last].upper, rows[0].lower, -rows[0].diagonal);
    let mut plain = rows.to_vec();
    plain[0].diagonal -= gamma;
    plain[last].diagonal -= alpha * beta / gamma;
    let mut solution = solve_tridiagonal(&plain, rows.iter().map(|row| row.right));
    let dyad = (0..=last).map(|i| [0.0, gamma, alpha][usize::from(i == 0) + 2 * usize::from(i == last)]);
    let correction = solve_tridiagonal(&plain, dyad);
    let along = |v: &[f64]| v[0] + beta / gamma * v[last];
    let factor = along(&solution) / (1.0 + along(&correction));
    solution.iter_mut().zip(&correction).for_each(|(value, shift)| *value -= factor * shift);
    solution
}
