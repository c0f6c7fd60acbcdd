//! The curvatures at the points that make a spline C².

// The curvatures M_i = z''(x_i) that make a spline C²: with h_i = x_{i+1} - x_i, μ_i = h_{i-1}/(h_{i-1} + h_i),
// λ_i = 1 - μ_i and the second divided difference of the heights,
//
//     μ_i M_{i-1} + 2 M_i + λ_i M_{i+1} = 6 z[x_{i-1}, x_i, x_{i+1}]
//
// (Stoer & Bulirsch, Introduction to Numerical Analysis, 2.4.2). The equations are diagonally dominant: no pivoting.

/// One equation of a tridiagonal system with `N` right sides.
#[derive(Clone, Copy, Debug)]
struct Equation<const N: usize> {
    lower: f64,
    diagonal: f64,
    upper: f64,
    right: [f64; N],
}

/// The curvatures at the points of a natural spline: 0 at both ends.
pub(super) fn natural_curvatures(x: &[f64], z: &[f64]) -> Vec<f64> {
    let inner = (1..x.len() - 1).map(|i| equation(x[i] - x[i - 1], x[i + 1] - x[i], z[i] - z[i - 1], z[i + 1] - z[i]));
    let mut curvatures = Vec::with_capacity(x.len());
    curvatures.push(0.0);
    curvatures.extend(solve_tridiagonal(inner).into_iter().flatten());
    curvatures.push(0.0);
    curvatures
}

/// The curvatures at the points of a periodic spline: the last equal to the first.
pub(super) fn periodic_curvatures(x: &[f64], z: &[f64]) -> Vec<f64> {
    let intervals = x.len() - 1;
    let before = |i: usize| if i == 0 { intervals - 1 } else { i - 1 };
    let width = |i: usize| x[i + 1] - x[i];
    let rise = |i: usize| z[i + 1] - z[i];
    let row = |i: usize| equation(width(before(i)), width(i), rise(before(i)), rise(i));
    // With fewer than three unknowns the entries that wrap around the matrix fall onto others.
    match intervals {
        // One interval from a height to the same height: flat.
        0 | 1 => vec![0.0; intervals + 1],
        // lower + upper = 1 and the right sides are opposite: 2 M_0 + M_1 = r, M_0 + 2 M_1 = -r.
        2 => {
            let [right] = row(0).right;
            vec![right, -right, right]
        }
        _ => solve_cyclic(intervals, row),
    }
}

fn equation(h_left: f64, h_right: f64, rise_left: f64, rise_right: f64) -> Equation<1> {
    let span = h_left + h_right;
    let right = 6.0 * (rise_right / h_right - rise_left / h_left) / span;
    Equation { lower: h_left / span, diagonal: 2.0, upper: h_right / span, right: [right] }
}

/// Gauss's elimination of a tridiagonal system.
fn solve_tridiagonal<const N: usize>(rows: impl ExactSizeIterator<Item = Equation<N>>) -> Vec<[f64; N]> {
    let mut uppers = Vec::with_capacity(rows.len());
    let mut solution = Vec::with_capacity(rows.len());
    let (mut upper_before, mut before) = (0.0, [0.0; N]);
    for row in rows {
        let pivot = row.diagonal - row.lower * upper_before;
        upper_before = row.upper / pivot;
        before = std::array::from_fn(|k| (row.right[k] - row.lower * before[k]) / pivot);
        uppers.push(upper_before);
        solution.push(before);
    }
    for i in (1..solution.len()).rev() {
        let behind = solution[i];
        (0..N).for_each(|k| solution[i - 1][k] -= uppers[i - 1] * behind[k]);
    }
    solution
}

/// The curvatures from the `n` ≥ 3 equations of a periodic spline; the first row's `lower` and the last row's `upper`
/// wrap around the matrix.
///
/// Sherman and Morrison: the cyclic matrix is a tridiagonal one plus the dyad (γ, 0, …, α)ᵀ (1, 0, …, β/γ).
fn solve_cyclic(n: usize, row: impl Fn(usize) -> Equation<1>) -> Vec<f64> {
    let (first, last) = (row(0), row(n - 1));
    let (alpha, beta, gamma) = (last.upper, first.lower, -first.diagonal);
    let with_dyad = |i: usize| {
        let Equation { lower, diagonal, upper, right: [right] } = row(i);
        let (diagonal, dyad) = match i {
            0 => (diagonal - gamma, gamma),
            _ if i == n - 1 => (diagonal - alpha * beta / gamma, alpha),
            _ => (diagonal, 0.0),
        };
        Equation { lower, diagonal, upper, right: [right, dyad] }
    };
    let solution = solve_tridiagonal((0..n).map(with_dyad));
    let along = |k: usize| solution[0][k] + beta / gamma * solution[n - 1][k];
    let factor = along(0) / (1.0 + along(1));
    let mut curvatures: Vec<f64> =
        solution.into_iter().map(|[plain, correction]| plain - factor * correction).collect();
    // The point behind the last interval is the first one again.
    curvatures.push(curvatures[0]);
    curvatures
}
