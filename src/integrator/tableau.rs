//! The coefficients of the Runge-Kutta methods and of their continuous extensions.

use std::array::from_fn;

use nalgebra::{DMatrix, DVector};

/// The most stages that a method has, the explicit one included.
pub const MAX_STAGES: usize = 7;

/// One number for each stage of a method; 0 beyond its last.
pub type StageWeights = [f64; MAX_STAGES];

/// A diagonally implicit Runge-Kutta method with an explicit first stage, the same γ in every other stage, and the end
/// of the step as its last stage (stiffly accurate: b is the last row of A).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tableau {
    /// Number of stages, the explicit one included.
    pub stages: usize,
    /// a_ij; the diagonal is γ but for the first stage, where it is 0.
    pub a: [StageWeights; MAX_STAGES],
    /// c_i: stage i lies at the fraction c_i of the step.
    pub c: StageWeights,
    /// b_i - b̂_i: the weights of the error estimate.
    pub error: StageWeights,
    /// Order of the embedded method. That of the method itself is one higher.
    pub embedded_order: i32,
    /// Weight of the error of F_z in the error test; that of F_x is a multiple of it. It makes the errors of whole runs
    /// about the relative tolerance and, among such weights, a given error cheap.
    pub force_weight: f64,
    /// Weight of the errors of energies in the error test, as that of F_z.
    pub energy_weight: f64,
}

impl Tableau {
    /// A method from A without its first column, c, b̂ and the order of b̂. The first column of A follows from
    /// Σ_j a_ij = c_i; the last row is b. The `weight` is that of the forces and of the energies.
    const fn new<const N: usize>(
        a: [[f64; N]; N],
        c: [f64; N],
        embedded: [f64; N],
        embedded_order: i32,
        weight: f64,
    ) -> Self {
        let mut padded = [[0.0; MAX_STAGES]; MAX_STAGES];
        let mut i = 0;
        while i < N {
            padded[i] = pad(a[i]);
            if 0 < i && i < N - 1 {
                let mut first = c[i];
                let mut j = 1;
                while j <= i {
                    first -= a[i][j];
                    j += 1;
                }
                padded[i][0] = first;
            }
            i += 1;
        }
        let mut error = padded[N - 1];
        let mut j = 0;
        while j < N {
            error[j] -= embedded[j];
            j += 1;
        }
        Self { stages: N, a: padded, c: pad(c), error, embedded_order, force_weight: weight, energy_weight: weight }
    }

    /// The index of the last stage, at the end of the step.
    pub fn last(&self) -> usize {
        self.stages - 1
    }

    /// The weights b.
    pub fn weights(&self) -> &StageWeights {
        &self.a[self.last()]
    }

    /// The coefficient γ of every implicit stage.
    pub fn gamma(&self) -> f64 {
        self.a[self.last()][self.last()]
    }
}

/// Continuous weights b_i(θ): h Σ_i b_i(θ) P_i over the stages is the integral of P from the start of a step to its
/// fraction θ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContinuousWeights {
    /// The coefficients of θ, θ², … θ⁵.
    by_power: [StageWeights; 5],
}

impl ContinuousWeights {
    /// The continuous weights of a method of stage order 2.
    ///
    /// Of all weights that are exact to the order p of the embedded method, Σ b_i (1, c, c², …)_i = (θ, θ²/2, θ³/3, …),
    /// with Σ b_i (A c²)_i = θ⁴/12 at order 4, these are the smallest for θ → 0. A term in θ^{p+1} brings them to the
    /// method's own weights at θ = 1.
    pub fn new(tableau: &Tableau) -> Self {
        let (stages, order) = (tableau.stages, tableau.embedded_order.clamp(1, 4) as usize);
        let a = DMatrix::from_fn(stages, stages, |i, j| tableau.a[i][j]);
        let c = DVector::from_column_slice(&tableau.c[..stages]);
        let square = c.component_mul(&c);
        let cube = c.component_mul(&square);
        let conditions = [DVector::repeat(stages, 1.0), c, square.clone(), cube, a * square];
        let count = if order == 4 { 5 } else { order };
        let rows = DMatrix::from_fn(count, stages, |row, stage| conditions[row][stage]);
        // The least squares solution is the transpose times the inverse of the normal matrix, which is not singular:
        // the conditions of a method that obeys them do not depend on each other.
        let normal = (&rows * rows.transpose()).try_inverse().unwrap_or_else(|| DMatrix::zeros(count, count));
        let smallest = rows.transpose() * normal;
        let of =
            |stage: usize, row: usize, factor: f64| if stage < stages { factor * smallest[(stage, row)] } else { 0.0 };
        let mut by_power = [[0.0; MAX_STAGES]; 5];
        for (power, weights) in by_power.iter_mut().enumerate().take(order) {
            *weights = from_fn(|stage| of(stage, power, 1.0 / (power + 1) as f64));
        }
        if order == 4 {
            by_power[3] = from_fn(|stage| by_power[3][stage] + of(stage, 4, 1.0 / 12.0));
        }
        let so_far = by_power;
        by_power[order] =
            from_fn(|stage| tableau.weights()[stage] - so_far.iter().map(|weights| weights[stage]).sum::<f64>());
        Self { by_power }
    }

    /// Those of [`SDIRK2`]: the straight line through the rates at its two implicit stages, integrated.
    pub(super) fn sdirk2() -> Self {
        let bend = 0.5 / (1.0 - GAMMA);
        let mut by_power = [[0.0; MAX_STAGES]; 5];
        by_power[0] = pad([0.0, 1.0 + 2.0 * GAMMA * bend, -2.0 * GAMMA * bend]);
        by_power[1] = pad([0.0, -bend, bend]);
        Self { by_power }
    }

    /// The weights up to the fraction `theta`.
    pub fn at(&self, theta: f64) -> StageWeights {
        from_fn(|stage| self.by_power.iter().rev().fold(0.0, |sum, weights| (sum + weights[stage]) * theta))
    }
}

/// ESDIRK5(4)7L\[2\]SA2 of C. A. Kennedy and M. H. Carpenter, *Diagonally implicit Runge-Kutta methods for stiff
/// ordinary differential equations* (Appl. Numer. Math. 146, 2019).
pub const ESDIRK5: Tableau = {
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
pub const ESDIRK3: Tableau = {
    const GAMMA: f64 = 1767732205903.0 / 4055673282236.0;
    const B: [f64; 4] = complete([0.0, -4482444167858.0 / 7529755066697.0, 11266239266428.0 / 11593286722821.0, GAMMA]);
    const EMBEDDED: [f64; 4] = complete([
        0.0,
        -10771552573575.0 / 22201958757719.0,
        9247589265047.0 / 10645013368117.0,
        2193209047091.0 / 5459859503100.0,
    ]);
    Tableau::new(
        [[0.0; 4], [0.0, GAMMA, 0.0, 0.0], [0.0, -640167445237.0 / 6845629431997.0, GAMMA, 0.0], B],
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

/// Values at the first stages, padded with 0 for the others.
const fn pad<const N: usize>(values: [f64; N]) -> StageWeights {
    let mut padded = [0.0; MAX_STAGES];
    let mut i = 0;
    while i < N {
        padded[i] = values[i];
        i += 1;
    }
    padded
}

/// γ of [`SDIRK2`]: the fraction of the step at which its first implicit stage lies.
pub(super) const GAMMA: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

/// The error of a step of [`SDIRK2`] is estimated as this multiple of h (k_2 - k_1), with k the rates at the implicit
/// stages. A multiple of γ would be the difference from y_0 + h k_1, which is of order 1.
///
/// Five times that makes the forces of a rough layer err by about half the relative tolerance, as the step length goes
/// with the square root of this number. A smaller one makes longer steps.
pub(super) const SDIRK2_ESTIMATE: f64 = 5.0 * GAMMA;

/// SDIRK2 of R. Alexander (SIAM J. Numer. Anal. 14, 1977): γ = 1 - 1/√2, order 2, L-stable and stiffly accurate. The
/// start of the step counts as a stage without weight: it serves as a guess alone.
pub const SDIRK2: Tableau = Tableau {
    force_weight: 0.2,
    energy_weight: 0.05,
    error: pad([0.0, -SDIRK2_ESTIMATE, SDIRK2_ESTIMATE]),
    ..Tableau::new([[0.0; 3], [0.0, GAMMA, 0.0], [0.0, 1.0 - GAMMA, GAMMA]], [0.0, GAMMA, 1.0], [0.0; 3], 1, 1.0)
};

/// The continuous weights of the two implicit stages of [`SDIRK2`]: the straight line through their rates, integrated
/// from the start of the step to its fraction `theta`.
#[inline]
pub(super) fn sdirk2_weights(theta: f64) -> (f64, f64) {
    let last = theta * (0.5 * theta - GAMMA) / (1.0 - GAMMA);
    (theta - last, last)
}
