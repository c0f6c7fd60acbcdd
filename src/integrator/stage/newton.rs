//! Newton's equations of a stage.

use nalgebra::{Matrix2, Vector2};

use super::{StageLaw, StageSolver};
use crate::model::{Mode, Model, SurfacePoint};

impl StageSolver {
    /// What the equations of motion miss at the velocities as they are, into the right sides. Returns how large it is
    /// as a velocity, m/s, if the inertia alone stood against it.
    pub(super) fn residuals(&mut self, model: &Model, beta: f64) -> f64 {
        let inertia = model.mass / beta;
        let velocities = self.state.velocity_x.iter().zip(&self.state.velocity_z);
        let starred = self.history.velocity_x.iter().zip(&self.history.velocity_z);
        let forces = self.forces.on_mass_x.iter().zip(&self.forces.on_mass_z);
        let known = velocities.zip(starred).zip(forces);
        for (right, (((v_x, v_z), (star_x, star_z)), (f_x, f_z))) in self.system.right.iter_mut().zip(known) {
            *right = Vector2::new(f_x - inertia * (v_x - star_x), f_z - inertia * (v_z - star_z));
        }
        for &i in &self.contacts {
            self.system.right[i] = Vector2::zeros();
        }
        for (slip, &i) in self.slip.iter_mut().zip(&self.slips) {
            let v = self.state.velocity_x[i];
            let acceleration = (v - self.history.velocity_x[i]) / beta;
            *slip = Slip::new(model, self.state.mode[i], &self.state.surface[i], (v, acceleration));
            self.system.right[i].x = -slip.residual(model, (self.forces.on_mass_x[i], self.forces.on_mass_z[i]));
        }
        if let Some(law) = &model.rate_shear {
            self.add_rate_shear(law);
        }
        largest(&self.system.right) / inertia
    }

    /// What of Newton's matrix holds for the whole step: all but the rows and columns of slipping masses.
    pub(super) fn assemble_held(&mut self, model: &Model, beta: f64) {
        let k = self.state.mode.len();
        let inertia = model.mass / beta;
        let [vertical, horizontal, lateral_x, lateral_z] = self.laws.map(|law| law.weight);
        for i in 0..k {
            let (row, column, diagonal) = if self.state.mode[i] == Mode::Free {
                let neighbours = neighbours(i, k);
                let weights = (horizontal + neighbours * lateral_x, vertical + neighbours * lateral_z);
                (
                    Row { x_by_x: 1.0, x_by_z: 0.0, z_by_z: 1.0 },
                    Column { x: lateral_x, z_by_x: 0.0, z: lateral_z },
                    Matrix2::new(inertia + weights.0, 0.0, 0.0, inertia + weights.1),
                )
            } else {
                (Row::default(), Column::default(), Matrix2::identity())
            };
            (self.rows[i], self.columns[i], self.system.diagonal[i]) = (row, column, diagonal);
        }
        for i in 1..k {
            self.couple(i - 1);
        }
    }

    /// The rows and columns of slipping masses at the velocities as they are, of which the residuals are known.
    pub(super) fn assemble_slips(&mut self, model: &Model, beta: f64) {
        let k = self.state.mode.len();
        let [vertical, horizontal, lateral_x, lateral_z] = self.laws;
        for (slip, &i) in self.slip.iter().zip(&self.slips) {
            let neighbours = neighbours(i, k);
            let climb = slip.climb(beta);
            let weight = |law: &StageLaw| law.stiffness * climb.height + law.damping * climb.rate;
            let weights = (
                horizontal.weight + neighbours * lateral_x.weight,
                weight(&vertical) + neighbours * weight(&lateral_z),
            );
            let forces = (self.forces.on_mass_x[i], self.forces.on_mass_z[i]);
            self.system.diagonal[i] = Matrix2::new(slip.derivative(model, beta, forces, weights), 0.0, 0.0, 1.0);
            self.rows[i] = Row { x_by_x: slip.share_x, x_by_z: slip.share_z, z_by_z: 0.0 };
            self.columns[i] = Column { x: lateral_x.weight, z_by_x: weight(&lateral_z), z: 0.0 };
        }
        if model.rate_shear.is_some() {
            self.assemble_rate_shear(beta);
        }
        for slip in 0..self.slips.len() {
            let i = self.slips[slip];
            if i > 0 {
                self.couple(i - 1);
            }
            if i + 1 < k && self.slips.get(slip + 1) != Some(&(i + 1)) {
                self.couple(i);
            }
        }
    }

    /// The blocks between mass `i` and the next.
    fn couple(&mut self, i: usize) {
        self.system.upper[i] = self.rows[i].coupling(&self.columns[i + 1]);
        self.system.lower[i + 1] = self.rows[i + 1].coupling(&self.columns[i]);
    }
}

/// How many neighbours mass `i` of `k` has.
fn neighbours(i: usize, k: usize) -> f64 {
    f64::from(u8::from(i > 0) + u8::from(i + 1 < k))
}

/// The largest of all numbers; NaN where one is not finite.
pub(super) fn largest(values: &[Vector2<f64>]) -> f64 {
    // Comparisons pass over what is not a number, the sum does not.
    let greater = |a: f64, b: f64| if a > b { a } else { b };
    let (mut largest, mut sum) = (Vector2::zeros(), Vector2::zeros());
    for value in values {
        largest = value.abs().zip_map(&largest, greater);
        sum += value;
    }
    if (sum.x + sum.y).is_finite() { greater(largest.x, largest.y) } else { f64::NAN }
}

/// How a slipping mass is carried up the profile when its ẋ changes.
struct Climb {
    /// ∂e_z/∂ẋ = βs.
    height: f64,
    /// ∂ż/∂ẋ = s + βκẋ.
    rate: f64,
}

/// A slipping mass at the velocity ẋ that a stage has come to.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Slip {
    s: f64,
    kappa: f64,
    third: f64,
    velocity: f64,
    acceleration: f64,
    sigma_mu: f64,
    /// σ (A τ_0 + A τ_f(v_c)).
    sigma_shear: f64,
    /// 1 - σμs, which f_x counts with.
    share_x: f64,
    /// s + σμ, which f_z counts with.
    share_z: f64,
    q: f64,
    q2: f64,
}

impl Slip {
    fn new(model: &Model, mode: Mode, surface: &SurfacePoint, (velocity, acceleration): (f64, f64)) -> Self {
        let s = surface.slope;
        let sigma = mode.direction();
        let sigma_mu = sigma * model.friction_coefficient;
        let q2 = 1.0 + s * s;
        Self {
            s,
            kappa: surface.curvature,
            third: surface.third,
            velocity,
            acceleration,
            sigma_mu,
            sigma_shear: sigma * model.shear_force,
            share_x: 1.0 - sigma_mu * s,
            share_z: s + sigma_mu,
            q: q2.sqrt(),
            q2,
        }
    }

    /// m q² ẍ + m s κ ẋ² - f_x - s f_z + F_T q with F_T = σ (μ F_N + A τ_0) put in, from (6)-(9), where A τ_0 stands
    /// for the shear force at rest (for what depends on the speed see `rate`):
    ///
    ///   m q² ẍ + m κ ẋ² (s + σμ) - (1 - σμs) f_x - (s + σμ) f_z + σ A τ_0 q = 0
    fn residual(&self, model: &Model, (f_x, f_z): (f64, f64)) -> f64 {
        let centripetal = self.kappa * self.velocity * self.velocity * self.share_z;
        model.mass * (self.q2 * self.acceleration + centripetal) - self.share_x * f_x - self.share_z * f_z
            + self.sigma_shear * self.q
    }

    /// The derivative of the residual by ẋ, where those of f_x and f_z are minus the weights.
    fn derivative(&self, model: &Model, beta: f64, (f_x, f_z): (f64, f64), (weight_x, weight_z): (f64, f64)) -> f64 {
        let Self { s, kappa, velocity: v, share_z, .. } = *self;
        // With v the place moves by β, so s by ds = βκ and κ by βz'''.
        let ds = beta * kappa;
        let inertia = self.q2 / beta
            + 2.0 * s * ds * self.acceleration
            + v * (beta * self.third * v * share_z + 2.0 * kappa * share_z + kappa * v * ds);
        model.mass * inertia
            + self.share_x * weight_x
            + share_z * weight_z
            + ds * (self.sigma_mu * f_x - f_z)
            + self.sigma_shear * s * ds / self.q
    }

    /// v_t = q ẋ, m/s.
    pub(super) fn speed(&self) -> f64 {
        self.q * self.velocity
    }

    pub(super) fn q(&self) -> f64 {
        self.q
    }

    /// The derivative by ẋ of σ q B(σ q ẋ), where B and its derivative are `excess`.
    pub(super) fn rate_derivative(&self, beta: f64, sigma: f64, excess: (f64, f64)) -> f64 {
        let s_ds = self.s * beta * self.kappa;
        sigma * excess.0 * s_ds / self.q + excess.1 * (self.q2 + self.velocity * s_ds)
    }

    fn climb(&self, beta: f64) -> Climb {
        Climb { height: beta * self.s, rate: self.s + beta * self.kappa * self.velocity }
    }
}

/// How the forces f_x, f_z on a mass enter its two equations.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Row {
    /// f_x in the first equation.
    x_by_x: f64,
    /// f_z in the first equation: along the slope of a contact.
    x_by_z: f64,
    /// f_z in the second equation.
    z_by_z: f64,
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
