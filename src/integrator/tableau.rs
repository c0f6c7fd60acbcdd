//! The coefficients of the two Runge-Kutta methods and of their continuous extensions.

use std::sync::LazyLock;

use nalgebra::{DMatrix, SMatrix, SVector};

/// A diagonally implicit Runge-Kutta method with an explicit first stage, the same γ in every other stage, and the end
/// of the step as its last stage (stiffly accurate: b is the last row of A).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tableau<const STAGES: usize> {
    /// a_ij; the diagonal is γ but for the first stage, where it is 0.
    pub a: [[f64; STAGES]; STAGES],
    /// c_i: stage i lies at the fraction c_i of the step.
    pub c: [f64; STAGES],
    /// b_i - b̂_i: the weights of the error estimate.
    pub error: [f64; STAGES],
    /// Order of the embedded method. That of the method itself is one higher.
    pub embedded_order: i32,
    /// Weight of the error of F_z in the error test; that of F_x is a multiple of it. It makes the errors of whole runs about the
    /// relative tolerance and, among such weights, a given error cheap.
    pub force_weight: f64,
    /// The same of the energies.
    pub energy_weight: f64,
}

impl<const STAGES: usize> Tableau<STAGES> {
    /// A method from A without its first column, c, b̂ and the order of b̂. The first column of A follows from
    /// Σ_j a_ij = c_i; the last row is b. The `weight` is that of the forces and of the energies.
    const fn new(
        mut a: [[f64; STAGES]; STAGES],
        c: [f64; STAGES],
        embedded: [f64; STAGES],
        embedded_order: i32,
        weight: f64,
    ) -> Self {
        let mut i = 1;
        while i < STAGES - 1 {
            let mut first = c[i];
            let mut j = 1;
            while j <= i {
                first -= a[i][j];
                j += 1;
            }
            a[i][0] = first;
            i += 1;
        }
        let mut error = a[STAGES - 1];
        let mut j = 0;
        while j < STAGES {
            error[j] -= embedded[j];
            j += 1;
        }
        Self { a, c, error, embedded_order, force_weight: weight, energy_weight: weight }
    }

    /// The weights b.
    pub fn weights(&self) -> &[f64; STAGES] {
        &self.a[STAGES - 1]
    }

    /// The coefficient γ of every implicit stage.
    pub fn gamma(&self) -> f64 {
        self.a[STAGES - 1][STAGES - 1]
    }
}

/// Continuous weights b_i(θ): h Σ_i b_i(θ) P_i over the stages is the integral of P from the start of a step to its
/// fraction θ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContinuousWeights<const STAGES: usize> {
    /// The coefficients of θ, θ², … θ⁵.
    by_power: [SVector<f64, STAGES>; 5],
}

impl<const STAGES: usize> ContinuousWeights<STAGES> {
    /// The continuous weights of a method.
    ///
    /// Of all weights that are exact to the order p of the embedded method, Σ b_i (1, c, c², …)_i = (θ, θ²/2, θ³/3, …),
    /// with Σ b_i (A c²)_i = θ⁴/12 at order 4, these are the smallest for θ → 0. A term in θ^{p+1} brings them to the
    /// method's own weights at θ = 1.
    pub fn new(tableau: &Tableau<STAGES>) -> Self {
        let order = tableau.embedded_order.clamp(1, 4) as usize;
        let c = SVector::from(tableau.c);
        let a = SMatrix::<f64, STAGES, STAGES>::from_fn(|i, j| tableau.a[i][j]);
        let square = c.component_mul(&c);
        let conditions = [SVector::repeat(1.0), c, square, c.component_mul(&square), a * square];
        let count = if order == 4 { 5 } else { order };
        let rows = DMatrix::from_fn(count, STAGES, |row, stage| conditions[row][stage]);
        // The least squares solution is the transpose times the inverse of the normal matrix, which is not singular:
        // the conditions of a method that obeys them do not depend on each other.
        let normal = (&rows * rows.transpose()).try_inverse().unwrap_or_else(|| DMatrix::zeros(count, count));
        let smallest = rows.transpose() * normal;
        let of = |row: usize, factor: f64| SVector::from_fn(|stage, _| factor * smallest[(stage, row)]);
        let mut by_power = [SVector::zeros(); 5];
        for power in 0..order {
            by_power[power] = of(power, 1.0 / (power + 1) as f64);
        }
        if order == 4 {
            by_power[3] += of(4, 1.0 / 12.0);
        }
        by_power[order] = SVector::from(*tableau.weights()) - by_power.iter().sum::<SVector<f64, STAGES>>();
        Self { by_power }
    }

    /// The weights up to the fraction `theta`.
    pub fn at(&self, theta: f64) -> [f64; STAGES] {
        let sum = self.by_power.iter().rev().fold(SVector::zeros(), |sum, weights| (sum + weights) * theta);
        sum.into()
    }
}

/// ESDIRK5(4)7L\[2\]SA2 of C. A. Kennedy and M. H. Carpenter, *Diagonally implicit Runge-Kutta methods for stiff ordinary
/// differential equations* (Appl. Numer. Math. 146, 2019).
pub const ESDIRK5: Tableau<7> = {
    const GAMMA: f64 = 23.0 / 125.0;
    const B: [f64; 7] = complete([
        0.0,
        -188593204321.0 / 4778616380481.0,
        2809310203510.0 / 10304234040467.0,
        1021729336898.0 / 2364210264653.0,
        870612361811.0 / 2470410392208.0,
        -1307970675534.0 / 8059683598661.0,
        GAMMA,
    ]);
    const EMBEDDED: [f64; 7] = complete([
        0.0,
        -582099335757.0 / 7214068459310.0,
        615023338567.0 / 3362626566945.0,
        3192122436311.0 / 6174152374399.0,
        6156034052041.0 / 14430468657929.0,
        -1011318518279.0 / 9693750372484.0,
        1914490192573.0 / 13754262428401.0,
    ]);
    Tableau::new(
        [
            [0.0; 7],
            [0.0, GAMMA, 0.0, 0.0, 0.0, 0.0, 0.0],
            [0.0, 791020047304.0 / 3561426431547.0, GAMMA, 0.0, 0.0, 0.0, 0.0],
            [0.0, -158159076358.0 / 11257294102345.0, -85517644447.0 / 5003708988389.0, GAMMA, 0.0, 0.0, 0.0],
            [
                0.0,
                -1653327111580.0 / 4048416487981.0,
                1514767744496.0 / 9099671765375.0,
                14283835447591.0 / 12247432691556.0,
                GAMMA,
                0.0,
                0.0,
            ],
            [
                0.0,
                -4540011970825.0 / 8418487046959.0,
                -1790937573418.0 / 7393406387169.0,
                10819093665085.0 / 7266595846747.0,
                4109463131231.0 / 7386972500302.0,
                GAMMA,
                0.0,
            ],
            B,
        ],
        [
            0.0,
            46.0 / 125.0,
            7121331996143.0 / 11335814405378.0,
            49.0 / 353.0,
            3706679970760.0 / 5295570149437.0,
            347.0 / 382.0,
            1.0,
        ],
        EMBEDDED,
        4,
        3.0,
    )
};

/// ESDIRK3(2)4L\[2\]SA of C. A. Kennedy and M. H. Carpenter, *Diagonally implicit Runge-Kutta methods for ordinary
/// differential equations: a review* (NASA/TM-2016-219173).
pub const ESDIRK3: Tableau<FOUR_STAGES> = {
    const GAMMA: f64 = 1767732205903.0 / 4055673282236.0;
    const B: [f64; FOUR_STAGES] =
        complete([0.0, -4482444167858.0 / 7529755066697.0, 11266239266428.0 / 11593286722821.0, GAMMA]);
    const EMBEDDED: [f64; FOUR_STAGES] = complete([
        0.0,
        -10771552573575.0 / 22201958757719.0,
        9247589265047.0 / 10645013368117.0,
        2193209047091.0 / 5459859503100.0,
    ]);
    Tableau::new(
        [[0.0; FOUR_STAGES], [0.0, GAMMA, 0.0, 0.0], [0.0, -640167445237.0 / 6845629431997.0, GAMMA, 0.0], B],
        [0.0, 2.0 * GAMMA, 0.6, 1.0],
        EMBEDDED,
        2,
        10.0,
    )
};

/// Weights whose first makes their sum 1.
const fn complete<const N: usize>(mut weights: [f64; N]) -> [f64; N] {
    let mut i = 1;
    let mut sum = 0.0;
    while i < N {
        sum += weights[i];
        i += 1;
    }
    weights[0] = 1.0 - sum;
    weights
}

/// Number of stages of [`ESDIRK5`], the explicit one included: the most of any method.
pub const STAGES: usize = ESDIRK5.c.len();

/// Number of stages of [`ESDIRK3`], the explicit one included.
pub(super) const FOUR_STAGES: usize = 4;

/// Number of stages of [`SDIRK2`]; the first is the start of the step, which serves as a guess alone.
pub const TWO_STAGES: usize = 3;

/// γ of [`SDIRK2`]: the fraction of the step at which its first implicit stage lies.
pub(super) const GAMMA: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

/// The error of a step of [`SDIRK2`] is estimated as this multiple of h (k_2 - k_1), with k the rates at the implicit
/// stages. A multiple of γ would be the difference from y_0 + h k_1, which is of order 1.
///
/// Five times that makes the forces of a rough layer err by about half the relative tolerance, as the step length goes with
/// the square root of this number. A smaller one makes longer steps.
pub(super) const SDIRK2_ESTIMATE: f64 = 5.0 * GAMMA;

/// SDIRK2 of R. Alexander (SIAM J. Numer. Anal. 14, 1977): γ = 1 - 1/√2, order 2, L-stable and stiffly accurate. The
/// start of the step counts as a stage without weight.
pub const SDIRK2: Tableau<TWO_STAGES> = Tableau {
    a: [[0.0; 3], [0.0, GAMMA, 0.0], [0.0, 1.0 - GAMMA, GAMMA]],
    c: [0.0, GAMMA, 1.0],
    error: [0.0, -SDIRK2_ESTIMATE, SDIRK2_ESTIMATE],
    embedded_order: 1,
    force_weight: 0.2,
    energy_weight: 0.05,
};

/// The continuous weights of the two implicit stages of [`SDIRK2`]: the straight line through their rates, integrated
/// from the start of the step to its fraction `theta`.
#[inline]
pub(super) fn sdirk2_weights(theta: f64) -> (f64, f64) {
    let last = theta * (0.5 * theta - GAMMA) / (1.0 - GAMMA);
    (theta - last, last)
}

impl ContinuousWeights<TWO_STAGES> {
    /// Those of `sdirk2_weights`, by powers of θ.
    pub(super) fn sdirk2() -> &'static Self {
        static WEIGHTS: LazyLock<ContinuousWeights<TWO_STAGES>> = LazyLock::new(|| {
            let bend = 0.5 / (1.0 - GAMMA);
            let mut by_power = [SVector::zeros(); 5];
            by_power[0] = SVector::from([0.0, 1.0 + 2.0 * GAMMA * bend, -2.0 * GAMMA * bend]);
            by_power[1] = SVector::from([0.0, -bend, bend]);
            ContinuousWeights { by_power }
        });
        &WEIGHTS
    }
}
