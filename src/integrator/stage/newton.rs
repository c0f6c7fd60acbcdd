//! Newton's equations of a stage.

use nalgebra::{Matrix2, Vector2};

use super::StageSolver;
use crate::model::{Mode, Model};

impl StageSolver {
    /// What the equations of motion miss at the velocities as they are, into the right sides. Returns how large it is as
    /// a velocity, m/s, if the inertia alone stood against it.
    pub(super) fn residuals(&mut self, model: &Model, beta: f64) -> f64 {
        let inertia = model.mass / beta;
        let (mut largest, mut sum) = (0.0_f64, 0.0);
        for i in 0..self.state.mode.len() {
            let right = match self.state.mode[i] {
                Mode::Free => self.free_residual(inertia, i),
                Mode::Stick => Vector2::zeros(),
                Mode::Forward | Mode::Backward => Vector2::new(-self.slip_residual(model, beta, i), 0.0),
            };
            largest = largest.max(right.x.abs().max(right.y.abs()));
            sum += right.x + right.y;
            self.system.right[i] = right;
        }
        if sum.is_finite() { largest / inertia } else { f64::NAN }
    }

    /// f - m (v - v*)/β along x and z.
    fn free_residual(&self, inertia: f64, i: usize) -> Vector2<f64> {
        let (state, history) = (&self.state, &self.history);
        Vector2::new(
            self.forces.on_mass_x[i] - inertia * (state.velocity_x[i] - history.velocity_x[i]),
            self.forces.on_mass_z[i] - inertia * (state.velocity_z[i] - history.velocity_z[i]),
        )
    }

    /// m q² ẍ + m s κ ẋ² - f_x - s f_z + F_T q with F_T = σ (μ F_N + A τ_0) put in, from (6)-(9):
    ///
    ///   m q² ẍ + m κ ẋ² (s + σμ) - (1 - σμs) f_x - (s + σμ) f_z + σ A τ_0 q = 0
    fn slip_residual(&self, model: &Model, beta: f64, i: usize) -> f64 {
        let slip = Slip::new(model, self.state.mode[i], self.state.ground[i].slope);
        let kappa = self.state.ground[i].curvature;
        let v = self.state.velocity_x[i];
        let acceleration = (v - self.history.velocity_x[i]) / beta;
        model.mass * (slip.q2 * acceleration + kappa * v * v * slip.share_z)
            - slip.share_x * self.forces.on_mass_x[i]
            - slip.share_z * self.forces.on_mass_z[i]
            + slip.sigma_shear * slip.q
    }

    /// Newton's matrix at the velocities as they are.
    pub(super) fn assemble(&mut self, model: &Model, beta: f64) {
        let k = self.state.mode.len();
        let [vertical, horizontal, lateral_x, lateral_z] = self.laws;
        for i in 0..k {
            self.columns[i] = self.column(beta, i);
        }
        for i in 0..k {
            let neighbours = f64::from(u8::from(i > 0) + u8::from(i + 1 < k));
            let weight_x = horizontal.weight + neighbours * lateral_x.weight;
            let row = match self.state.mode[i] {
                Mode::Free => {
                    let weight_z = vertical.weight + neighbours * lateral_z.weight;
                    Row::free(model.mass / beta, (weight_x, weight_z))
                }
                Mode::Stick => Row::identity(),
                Mode::Forward | Mode::Backward => {
                    let stiffness = vertical.stiffness + neighbours * lateral_z.stiffness;
                    let damping = vertical.damping + neighbours * lateral_z.damping;
                    let climb = self.climb(beta, i);
                    self.slip_row(model, beta, i, (weight_x, stiffness * climb.height + damping * climb.rate))
                }
            };
            self.system.diagonal[i] = Matrix2::new(row.diagonal.0, 0.0, 0.0, row.diagonal.1);
            if i > 0 {
                self.system.lower[i] = row.coupling(&self.columns[i - 1]);
            }
            if i + 1 < k {
                self.system.upper[i] = row.coupling(&self.columns[i + 1]);
            }
        }
    }

    /// The derivative of [`slip_residual`](Self::slip_residual), where ∂f_x/∂ẋ and ∂f_z/∂ẋ are minus the weights.
    fn slip_row(&self, model: &Model, beta: f64, i: usize, (weight_x, weight_z): (f64, f64)) -> Row {
        let ground = &self.state.ground[i];
        let (s, kappa, third) = (ground.slope, ground.curvature, ground.third);
        let Slip { sigma_mu, sigma_shear, share_x, share_z, q, q2 } = Slip::new(model, self.state.mode[i], s);
        let v = self.state.velocity_x[i];
        let acceleration = (v - self.history.velocity_x[i]) / beta;
        // With v the place moves by β, so s by ds = βκ and κ by βz'''.
        let ds = beta * kappa;
        let inertia = q2 / beta
            + 2.0 * s * ds * acceleration
            + v * (beta * third * v * share_z + 2.0 * kappa * share_z + kappa * v * ds);
        let derivative = model.mass * inertia
            + share_x * weight_x
            + share_z * weight_z
            + ds * (sigma_mu * self.forces.on_mass_x[i] - self.forces.on_mass_z[i])
            + sigma_shear * s * ds / q;
        Row { x_by_x: share_x, x_by_z: share_z, z_by_z: 0.0, diagonal: (derivative, 1.0) }
    }

    /// How a slipping mass is carried up the profile.
    fn climb(&self, beta: f64, i: usize) -> Climb {
        let ground = &self.state.ground[i];
        let v = self.state.velocity_x[i];
        Climb { height: beta * ground.slope, rate: ground.slope + beta * ground.curvature * v }
    }

    fn column(&self, beta: f64, i: usize) -> Column {
        let [_, _, lateral_x, lateral_z] = &self.laws;
        match self.state.mode[i] {
            Mode::Free => Column { x: lateral_x.weight, z_by_x: 0.0, z: lateral_z.weight },
            Mode::Stick => Column::default(),
            Mode::Forward | Mode::Backward => {
                let climb = self.climb(beta, i);
                let z_by_x = lateral_z.stiffness * climb.height + lateral_z.damping * climb.rate;
                Column { x: lateral_x.weight, z_by_x, z: 0.0 }
            }
        }
    }
}

/// How a slipping mass is carried up the profile when its ẋ changes.
struct Climb {
    /// ∂e_z/∂ẋ = βs.
    height: f64,
    /// ∂ż/∂ẋ = s + βκẋ.
    rate: f64,
}

/// How the equation of a slipping mass weighs the forces on it.
struct Slip {
    sigma_mu: f64,
    sigma_shear: f64,
    /// 1 - σμs, of f_x.
    share_x: f64,
    /// s + σμ, of f_z.
    share_z: f64,
    q: f64,
    q2: f64,
}

impl Slip {
    #[inline]
    fn new(model: &Model, mode: Mode, s: f64) -> Self {
        let sigma = mode.direction();
        let sigma_mu = sigma * model.friction_coefficient;
        let q2 = 1.0 + s * s;
        Self {
            sigma_mu,
            sigma_shear: sigma * model.shear_force,
            share_x: 1.0 - sigma_mu * s,
            share_z: s + sigma_mu,
            q: q2.sqrt(),
            q2,
        }
    }
}

/// The block of one mass, which is diagonal, and how the forces f_x, f_z on the mass enter its two equations.
struct Row {
    /// f_x in the first equation.
    x_by_x: f64,
    /// f_z in the first equation: along the slope of a contact.
    x_by_z: f64,
    /// f_z in the second equation.
    z_by_z: f64,
    diagonal: (f64, f64),
}

/// How the lateral forces on a neighbour follow a mass's two unknowns.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Column {
    /// ∂f_x/∂ẋ.
    x: f64,
    /// ∂f_z/∂ẋ: of a mass that slips up a slope.
    z_by_x: f64,
    /// ∂f_z/∂ż.
    z: f64,
}

impl Row {
    fn free(inertia: f64, (weight_x, weight_z): (f64, f64)) -> Self {
        Self { x_by_x: 1.0, x_by_z: 0.0, z_by_z: 1.0, diagonal: (inertia + weight_x, inertia + weight_z) }
    }

    fn identity() -> Self {
        Self { x_by_x: 0.0, x_by_z: 0.0, z_by_z: 0.0, diagonal: (1.0, 1.0) }
    }

    /// The block beside the diagonal: what the neighbour's unknowns do to this row.
    fn coupling(&self, column: &Column) -> Matrix2<f64> {
        Matrix2::new(
            -(self.x_by_x * column.x + self.x_by_z * column.z_by_x),
            -(self.x_by_z * column.z),
            -(self.z_by_z * column.z_by_x),
            -(self.z_by_z * column.z),
        )
    }
}
