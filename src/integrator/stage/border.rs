//! The bodies of the carrier as unknowns of a stage (docs/theory.md, section 12): a row and a column for each around
//! the block tridiagonal system of the masses, eliminated by their Schur complement.
//!
//! The unknowns of free masses are their velocities relative to the body, and their equations are added to its own. So
//! the forces of the links between them cancel before they are evaluated, however stiff the links: what is left are the
//! inertias, and the links of the masses in contact.

use nalgebra::{Matrix2, Vector2};

use super::{StagePoint, StageSolver};
use crate::math::Jet;
use crate::model::{Axis, ByAxis, CarrierBody, Forces, LinkKind, Mode, Model, Outside};

/// The rows and columns of the bodies.
#[derive(Clone, Debug)]
pub(in crate::integrator) struct Border {
    sides: ByAxis<Option<Side>>,
    /// The Schur complement, inverted.
    inverse: Matrix2<f64>,
}

/// The body along one axis.
#[derive(Clone, Debug)]
struct Side {
    axis: Axis,
    /// Mass M, stiffness K and damping D.
    body: CarrierBody,
    /// Contributions of the earlier stages: the speed, and the displacement since the start of the step.
    star: BodyHistory,
    /// What acts on the body from outside, and the body itself, at the velocities evaluated last.
    outside: Outside,
    /// The column of the masses' equations, once the system of the masses is solved for it.
    column: Vec<Vector2<f64>>,
    /// The derivatives of the body's equation by the masses' unknowns.
    row: Vec<Vector2<f64>>,
    /// The derivative of the body's equation by its own unknown, kg/s.
    diagonal: f64,
    /// Its negative residual, N.
    right: f64,
    /// Mass of the body with the free masses, kg.
    inertia: f64,
}

/// Contributions of the earlier stages to the motion of a body at a stage, and the start of the segment.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::integrator) struct BodyHistory {
    /// Speed u̇*, m/s.
    pub rate: f64,
    /// Displacement since the start of the step, m.
    pub moved: f64,
    /// Displacement at the start of the step since the start of the segment, m.
    pub start: f64,
}

impl Border {
    pub(super) fn new(model: &Model) -> Option<Box<Self>> {
        let side = |axis: Axis| {
            let body = model.bodies[axis]?;
            let zero = vec![Vector2::zeros(); model.masses()];
            Some(Side {
                axis,
                body,
                star: BodyHistory::default(),
                outside: Outside::default(),
                column: zero.clone(),
                row: zero,
                diagonal: 0.0,
                right: 0.0,
                inertia: 0.0,
            })
        };
        let sides = ByAxis::from_fn(side);
        sides.any().then(|| Box::new(Self { sides, inverse: Matrix2::zeros() }))
    }

    /// Sets what a stage knows of the body along `axis`.
    pub(in crate::integrator) fn prepare(&mut self, axis: Axis, star: BodyHistory, outside: Outside) {
        if let Some(side) = &mut self.sides[axis] {
            (side.star, side.outside) = (star, outside);
        }
    }

    fn sides(&mut self) -> impl Iterator<Item = &mut Side> {
        self.sides.iter_mut().flatten()
    }

    /// The largest residual as the velocity, m/s, that it makes against the inertia alone.
    pub(super) fn largest_residual(&self, beta: f64) -> f64 {
        let velocities = self.sides.iter().flatten().map(|side| side.right.abs() * beta / side.inertia);
        velocities.fold(0.0, |largest, velocity| if largest > velocity { largest } else { velocity })
    }

    /// Takes the Schur complement from the rows and the solved columns.
    fn factor(&mut self) {
        let product = |row: &Side, column: &Side| -> f64 {
            row.row.iter().zip(&column.column).map(|(row, column)| row.dot(column)).sum()
        };
        let sides = [&self.sides.x, &self.sides.z];
        let element = |i: usize, j: usize| match (sides[i], sides[j]) {
            (Some(row), Some(column)) => (if i == j { row.diagonal } else { 0.0 }) - product(row, column),
            _ => f64::from(u8::from(i == j)),
        };
        let schur = Matrix2::from_fn(element);
        // Without a test for zero: a singular system must show in the result.
        let factor = 1.0 / (schur.m11 * schur.m22 - schur.m12 * schur.m21);
        self.inverse = Matrix2::new(schur.m22 * factor, -schur.m12 * factor, -schur.m21 * factor, schur.m11 * factor);
    }

    /// Completes the solution of the masses' system for the right sides in `masses`: subtracts what the bodies make of
    /// it and returns the bodies' unknowns.
    fn complete(&self, masses: &mut [Vector2<f64>]) -> Vector2<f64> {
        let left = |side: &Option<Side>| {
            side.as_ref().map_or(0.0, |side| {
                side.right - side.row.iter().zip(&*masses).map(|(row, mass)| row.dot(mass)).sum::<f64>()
            })
        };
        let found = self.inverse * Vector2::new(left(&self.sides.x), left(&self.sides.z));
        for (side, found) in self.sides.iter().zip(found.iter()) {
            let Some(side) = side else { continue };
            masses.iter_mut().zip(&side.column).for_each(|(mass, column)| *mass -= column * *found);
        }
        found
    }
}

impl StageSolver {
    /// Assembles and eliminates the bodies' rows and columns, once the system of the masses is factored.
    pub(super) fn factor_border(&mut self, model: &Model, beta: f64) {
        let Some(mut border) = self.border.take() else { return };
        for side in border.sides() {
            self.assemble_side(model, beta, side);
            if self.slips.is_empty() {
                self.system.solve_uncoupled_for(&mut side.column);
            } else {
                self.system.solve_for(&mut side.column);
            }
        }
        border.factor();
        self.border = Some(border);
    }

    /// Assembles the row and the column of one body.
    ///
    /// The unknowns of free masses are relative to it, those of contacts are not. So with δ of the body a free mass
    /// feels its inertia and the lateral links to contacts, a contact its link to the carrier and the lateral ones to
    /// free masses.
    fn assemble_side(&self, model: &Model, beta: f64, side: &mut Side) {
        let (own, lateral, component) = match side.axis {
            Axis::X => (LinkKind::Horizontal, LinkKind::LateralX, 0),
            Axis::Z => (LinkKind::Vertical, LinkKind::LateralZ, 1),
        };
        // The body by itself.
        let inertia = model.mass / beta;
        let modes = &self.state.mode;
        side.column.fill(Vector2::zeros());
        side.row.fill(Vector2::zeros());
        side.inertia = side.body.mass;
        side.diagonal = side.body.mass / beta + beta * side.body.stiffness + side.body.damping;
        for (i, mode) in modes.iter().enumerate() {
            // Lateral links between a free mass and a contact.
            let beside = [i.checked_sub(1), Some(i + 1)].into_iter().flatten().filter_map(|j| modes.get(j));
            let other = beside.filter(|other| other.in_contact() != mode.in_contact()).count() as f64;
            let across = other * self.weights[lateral];
            if !mode.in_contact() {
                side.inertia += model.mass;
                side.diagonal += inertia + across;
                side.column[i][component] = inertia + across;
                side.row[i][component] = inertia + across;
                continue;
            }
            // A contact: its link to the carrier, and if it slips its equation.
            side.diagonal += self.weights[own];
            if mode.slips() {
                let (share, climb) = self.slip_border(model, i, beta, side.axis);
                side.column[i].x = -share * (self.weights[own] + across);
                side.row[i].x = -(climb.force(&self.laws[own]) + other * climb.force(&self.laws[lateral]));
            }
        }
    }

    /// Solves the system for the right sides of the masses and of the bodies, which are set; those of free masses
    /// become velocities in the inertial frame. Returns the bodies' velocities along x and z.
    pub(in crate::integrator) fn solve_bordered(&mut self) -> Vector2<f64> {
        self.system.solve();
        self.complete_border()
    }

    /// The bodies' part of the solution, once the masses' system is solved.
    pub(super) fn complete_border(&mut self) -> Vector2<f64> {
        let Some(border) = &self.border else { return Vector2::zeros() };
        let found = border.complete(&mut self.system.right);
        for (right, mode) in self.system.right.iter_mut().zip(&self.state.mode) {
            if !mode.in_contact() {
                *right += found;
            }
        }
        found
    }

    /// Corrects the bodies' velocities by `change` (m/s), and the carrier at the stage with them.
    pub(super) fn move_bodies(&mut self, change: Vector2<f64>, point: &mut StagePoint) {
        let Some(border) = &mut self.border else { return };
        for side in border.sides() {
            let rate = side.outside.body.speed + change[side.axis as usize];
            let moved = side.star.moved + point.beta * rate;
            let displacement = side.star.start + moved;
            let before = point.carrier[side.axis].position;
            let acceleration = (rate - side.star.rate) / point.beta;
            let position = side.outside.body.position + (displacement - before);
            side.outside.body = Jet { position, speed: rate, acceleration };
            point.carrier[side.axis] = Jet { position: displacement, speed: rate, acceleration };
            point.integrated[side.axis] = moved;
            if side.axis == Axis::X {
                point.moved = moved;
            }
        }
    }

    /// Sets the negative residuals of the bodies' equations at the present velocities.
    pub(super) fn set_border_residuals(&mut self, beta: f64) {
        let Some(border) = &mut self.border else { return };
        for side in border.sides() {
            let gained = side.body.mass * (side.outside.body.speed - side.star.rate) / beta;
            let outside = side.outside.force + side.outside.drive_force(&side.body) - gained;
            side.right = outside + with_free_masses(side.axis, &self.forces, &self.system.right, &self.state.mode);
        }
    }

    /// Sets the right side of the body's equation along `axis` to `outside` and what links with these `forces` exert
    /// (N), as the right sides of the masses are set.
    pub(in crate::integrator) fn set_border_right(&mut self, axis: Axis, forces: &Forces, outside: f64) {
        let Some(border) = &mut self.border else { return };
        if let Some(side) = &mut border.sides[axis] {
            side.right = outside + with_free_masses(axis, forces, &self.system.right, &self.state.mode);
        }
    }
}

/// The force of the links on the body along `axis` and the right sides of the free masses, N: what the links between
/// the two exert cancels.
fn with_free_masses(axis: Axis, forces: &Forces, right: &[Vector2<f64>], modes: &[Mode]) -> f64 {
    let links = &forces.link[axis.link()];
    let of_mass = |(i, (right, mode)): (usize, (&Vector2<f64>, &Mode))| {
        let link = links.get(i).copied().unwrap_or(0.0);
        if mode.in_contact() { link } else { link + right[axis as usize] }
    };
    right.iter().zip(modes).enumerate().map(of_mass).sum()
}
