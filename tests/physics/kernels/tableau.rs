//! The coefficients of the Runge-Kutta methods.

use asperity::internals::integrator::{ContinuousWeights, ESDIRK3, ESDIRK5, MAX_STAGES, StageWeights, Tableau};
use nalgebra::Complex;

/// A rooted tree: the trees that hang on its root.
#[derive(Clone)]
struct Tree(Vec<Tree>);

impl Tree {
    fn order(&self) -> usize {
        1 + self.0.iter().map(Self::order).sum::<usize>()
    }

    /// γ(t), the order of the tree times γ of all that hang on its root.
    fn density(&self) -> f64 {
        self.order() as f64 * self.0.iter().map(Self::density).product::<f64>()
    }

    /// φ_i(t) = Π over the trees on the root of Σ_j a_ij φ_j: Σ b_i φ_i = 1/γ(t) is the order condition of the tree.
    fn weights(&self, a: &[StageWeights; MAX_STAGES]) -> StageWeights {
        let mut product = [1.0; MAX_STAGES];
        for branch in &self.0 {
            let inner = branch.weights(a);
            for (value, row) in product.iter_mut().zip(a) {
                *value *= dot(row, &inner);
            }
        }
        product
    }
}

/// All rooted trees of an order.
fn trees(order: usize) -> Vec<Tree> {
    let smaller: Vec<Tree> = (1..order).flat_map(trees).collect();
    forests(order - 1, &smaller).into_iter().map(Tree).collect()
}

/// All multisets of trees with `order` nodes together, drawn from `from` in its order.
fn forests(order: usize, from: &[Tree]) -> Vec<Vec<Tree>> {
    if order == 0 {
        return vec![Vec::new()];
    }
    let mut found = Vec::new();
    for (i, tree) in from.iter().enumerate().filter(|(_, tree)| tree.order() <= order) {
        for mut rest in forests(order - tree.order(), &from[i..]) {
            rest.push(tree.clone());
            found.push(rest);
        }
    }
    found
}

fn dot(a: &StageWeights, b: &StageWeights) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The largest |Σ b_i φ_i - 1/γ| over all trees of an order.
fn miss(method: &Tableau, weights: &StageWeights, order: usize) -> f64 {
    let one = |tree: &Tree| (dot(weights, &tree.weights(&method.a)) - 1.0 / tree.density()).abs();
    trees(order).iter().map(one).fold(0.0, f64::max)
}

fn embedded(method: &Tableau) -> StageWeights {
    std::array::from_fn(|i| method.weights()[i] - method.error[i])
}

/// Sums of some ten products of numbers up to 1.5, each rounded: a few units of the last place. The coefficients
/// themselves are printed to 25 digits.
const ROUNDING: f64 = 4e-15;

/// There are 1, 1, 2, 4, 9 rooted trees of the orders 1 to 5.
#[test]
fn the_trees_are_all_there() {
    let counts: Vec<usize> = (1..=5).map(|order| trees(order).len()).collect();
    assert_eq!(counts, [1, 1, 2, 4, 9]);
}

fn check_order(method: &Tableau) {
    let embedded_order = method.embedded_order as usize;
    for order in 1..=embedded_order + 1 {
        assert!(miss(method, method.weights(), order) < ROUNDING, "b, order {order}");
    }
    for order in 1..=embedded_order {
        assert!(miss(method, &embedded(method), order) < ROUNDING, "b̂, order {order}");
    }
    // The estimate b - b̂ sees the embedded method's leading error: no condition of the next order holds by chance.
    assert!(miss(method, &embedded(method), embedded_order + 1) > 1e-4);
}

/// Every order condition: b to the method's order, b̂ to one less and not further.
#[test]
fn the_order_conditions_hold() {
    assert_eq!((ESDIRK5.embedded_order, ESDIRK3.embedded_order), (4, 2));
    check_order(&ESDIRK5);
    check_order(&ESDIRK3);
}

fn check_shape(method: &Tableau) {
    let (a, c) = (&method.a, &method.c);
    assert_eq!((a[0], c[0], c[method.last()]), ([0.0; MAX_STAGES], 0.0, 1.0));
    let gamma = method.gamma();
    for i in 1..method.stages {
        assert_eq!(a[i][i], gamma);
        assert_eq!(a[i][i + 1..], [0.0; MAX_STAGES][i + 1..]);
        assert!((a[i].iter().sum::<f64>() - c[i]).abs() < ROUNDING, "row {i}");
        // Stage order 2.
        assert!((dot(&a[i], c) - 0.5 * c[i] * c[i]).abs() < ROUNDING, "row {i}");
    }
    assert_eq!(method.weights(), &a[method.last()]);
    assert!(method.error.iter().sum::<f64>().abs() < ROUNDING);
}

/// One γ on the diagonal, an explicit first stage, Σ_j a_ij = c_i, Σ_j a_ij c_j = c_i²/2, b the last row of A.
#[test]
fn rows_and_stages_are_consistent() {
    check_shape(&ESDIRK5);
    check_shape(&ESDIRK3);
}

/// R(z) of y' = λy, z = hλ: the last stage of Y_i = 1 + z Σ_j a_ij Y_j.
fn stability(method: &Tableau, z: Complex<f64>) -> f64 {
    let mut stages = [Complex::new(1.0, 0.0); MAX_STAGES];
    for i in 1..method.stages {
        let earlier: Complex<f64> = stages[..i].iter().zip(&method.a[i]).map(|(y, &a)| y * a).sum();
        stages[i] = (earlier * z + 1.0) / (Complex::new(1.0, 0.0) - z * method.a[i][i]);
    }
    stages[method.last()].norm()
}

/// |R(z)| |z| for z → -∞, at most.
fn check_decay(method: &Tableau) {
    for exponent in 3..=15 {
        let size = 10.0_f64.powi(exponent);
        let decay = stability(method, Complex::new(-size, 0.0));
        // R falls as |z|⁻¹; its factor is some tens. The rest is the rounding of R(∞) = 0.
        assert!(decay < 100.0 / size + ROUNDING, "R({:e}) = {decay:e}", -size);
    }
}

fn check_axis(method: &Tableau) {
    for i in 0..=20_000 {
        // From 1e-5 to 1e5, where R has long fallen.
        let y = 10.0_f64.powf(f64::from(i) / 2000.0 - 5.0);
        let growth = stability(method, Complex::new(0.0, y)) - 1.0;
        assert!(growth < ROUNDING, "|R({y}i)| - 1 = {growth:e}");
    }
}

/// R vanishes at -∞ and |R| ≤ 1 on the imaginary axis. R has its poles at 1/γ > 0 alone, so |R| ≤ 1 on all of the left
/// half plane: the methods are L-stable.
#[test]
fn the_methods_are_l_stable() {
    check_decay(&ESDIRK5);
    check_axis(&ESDIRK5);
    check_decay(&ESDIRK3);
    check_axis(&ESDIRK3);
}

/// The quadrature up to a fraction of the step: exact to order 4 at every fraction, the method's own at the end,
/// nothing at the start.
#[test]
fn the_weights_within_a_step_have_order_four() {
    let within = ContinuousWeights::new(&ESDIRK5);
    let c = ESDIRK5.c;
    let a_c2 = ESDIRK5.a.map(|row| row.iter().zip(c).map(|(a, c)| a * c * c).sum::<f64>());
    for theta in [0.0, 1e-3, 0.2, 0.7, 1.0] {
        let weights = within.at(theta);
        let sum = |term: &dyn Fn(usize) -> f64| (0..c.len()).map(|i| weights[i] * term(i)).sum::<f64>();
        for power in 1..=4 {
            let error = sum(&|i| c[i].powi(power - 1)) - theta.powi(power) / f64::from(power);
            // Roundings of weights up to some 10, and of the printed coefficients.
            assert!(error.abs() < 1e-13, "θ {theta}, order {power}: {error:e}");
        }
        assert!((sum(&|i| a_c2[i]) - theta.powi(4) / 12.0).abs() < 1e-13, "θ {theta}");
    }
    let difference = within.at(1.0).iter().zip(ESDIRK5.weights()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(difference < 1e-13, "{difference:e}");
}
