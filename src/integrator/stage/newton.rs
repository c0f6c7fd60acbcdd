//! Newton's equations of a stage.

use nalgebra::{Matrix2, Vector2};

use super::StageSolver;
use crate::model::{Mode, Model};

impl StageSolver {
    /// Newton's equations for the corrections of the velocities.
    pub(super) fn assemble(&mut self, model: &Model, beta: f64) {
        let k = self.state.mode.len();
        let [vertical, horizontal, lateral_x, lateral_z] = self.laws;
        for i in 0..k {
            let neighbours = f64::from(u8::from(i > 0) + u8::from(i + 1 < k));
            let weight_x = horizontal.weight + neighbours * lateral_x.weight;
            let weight_z = vertical.weight + neighbours * lateral_z.weight;
            let row = match self.state.mode[i] {
                Mode::Free => self.free_row(model, beta, i, (weight_x, weight_z)),
                Mode::Stick => Row::identity(),
                Mode::Forward | Mode::Backward => {
                    let stiffness = vertical.stiffness + neighbours * lateral_z.stiffness;
                    let damping = vertical.damping + neighbours * lateral_z.damping;
                    let climb = self.climb[i];
                    self.slip_row(model, beta, i, (weight_x, stiffness * climb.height + damping * climb.rate))
                }
            };
            self.system.diagonal[i] = row.diagonal;
            self.system.right[i] = row.right;
            if i > 0 {
                self.system.lower[i] = row.coupling(&self.column(i - 1));
            }
            if i + 1 < k {
                self.system.upper[i] = row.coupling(&self.column(i + 1));
            }
        }
    }

    /// m (v - v*)/β - f = 0 along x and z.
    fn free_row(&self, model: &Model, beta: f64, i: usize, (weight_x, weight_z): (f64, f64)) -> Row {
        let inertia = model.mass / beta;
        let right_x = self.forces.on_mass_x[i] - inertia * (self.state.velocity_x[i] - self.history.velocity_x[i]);
        let right_z = self.forces.on_mass_z[i] - inertia * (self.state.velocity_z[i] - self.history.velocity_z[i]);
        Row {
            along_x: Vector2::new(1.0, 0.0),
            along_z: Vector2::new(0.0, 1.0),
            diagonal: Matrix2::new(inertia + weight_x, 0.0, 0.0, inertia + weight_z),
            right: Vector2::new(right_x, right_z),
        }
    }

    /// m q² ẍ + m s κ ẋ² - f_x - s f_z + F_T q = 0 with F_T = σ (μ F_N + A τ_0) put in, from (6)-(9):
    ///
    ///   m q² ẍ + m κ ẋ² (s + σμ) - (1 - σμs) f_x - (s + σμ) f_z + σ A τ_0 q = 0
    fn slip_row(&self, model: &Model, beta: f64, i: usize, (weight_x, weight_z): (f64, f64)) -> Row {
        let m = model.mass;
        let ground = &self.state.ground[i];
        let (s, kappa, third) = (ground.slope, ground.curvature, ground.third);
        let v = self.state.velocity_x[i];
        let (f_x, f_z) = (self.forces.on_mass_x[i], self.forces.on_mass_z[i]);
        let sigma = self.state.mode[i].direction();
        let sigma_mu = sigma * model.friction_coefficient;
        let sigma_shear = sigma * model.shear_force;
        let (share_x, share_z) = (1.0 - sigma_mu * s, s + sigma_mu);
        let q2 = 1.0 + s * s;
        let q = q2.sqrt();
        let acceleration = (v - self.history.velocity_x[i]) / beta;
        let residual =
            m * (q2 * acceleration + kappa * v * v * share_z) - share_x * f_x - share_z * f_z + sigma_shear * q;
        // With v the place moves by β, so s by ds = βκ and κ by βz'''.
        let ds = beta * kappa;
        let inertia = q2 / beta
            + 2.0 * s * ds * acceleration
            + v * (beta * third * v * share_z + 2.0 * kappa * share_z + kappa * v * ds);
        let derivative = m * inertia
            + share_x * weight_x
            + share_z * weight_z
            + ds * (sigma_mu * f_x - f_z)
            + sigma_shear * s * ds / q;
        Row {
            along_x: Vector2::new(share_x, 0.0),
            along_z: Vector2::new(share_z, 0.0),
            diagonal: Matrix2::new(derivative, 0.0, 0.0, 1.0),
            right: Vector2::new(-residual, 0.0),
        }
    }

    /// How the lateral forces on a neighbour follow mass `j`'s unknowns: ∂f_x and ∂f_z of the neighbour.
    fn column(&self, j: usize) -> Column {
        let [_, _, lateral_x, lateral_z] = &self.laws;
        match self.state.mode[j] {
            Mode::Free => Column { x: Vector2::new(lateral_x.weight, 0.0), z: Vector2::new(0.0, lateral_z.weight) },
            Mode::Stick => Column { x: Vector2::zeros(), z: Vector2::zeros() },
            Mode::Forward | Mode::Backward => {
                let climb = &self.climb[j];
                let z = lateral_z.stiffness * climb.height + lateral_z.damping * climb.rate;
                Column { x: Vector2::new(lateral_x.weight, 0.0), z: Vector2::new(z, 0.0) }
            }
        }
    }
}

/// Newton's equations of one mass, and how the forces f_x, f_z on it enter them.
struct Row {
    along_x: Vector2<f64>,
    along_z: Vector2<f64>,
    diagonal: Matrix2<f64>,
    right: Vector2<f64>,
}

/// ∂f_x and ∂f_z on a neighbour by a mass's two unknowns.
struct Column {
    x: Vector2<f64>,
    z: Vector2<f64>,
}

impl Row {
    fn identity() -> Self {
        Self {
            along_x: Vector2::zeros(),
            along_z: Vector2::zeros(),
            diagonal: Matrix2::identity(),
            right: Vector2::zeros(),
        }
    }

    /// The block beside the diagonal: what the neighbour's unknowns do to this row.
    fn coupling(&self, column: &Column) -> Matrix2<f64> {
        -(self.along_x * column.x.transpose() + self.along_z * column.z.transpose())
    }
}
