//! The bodies of the carrier as unknowns of a stage (docs/theory.md, section 12): a row and a column for each around
//! the block tridiagonal system of the masses, eliminated by their Schur complement.
//!
//! The unknowns of free masses are their velocities relative to the body, and their equations are added to its own. So
//! the forces of the links between them cancel before they are evaluated, however stiff the links: what is left are the
//! inertias, and the links of the masses in contact.

use nalgebra::{Matrix2, Vector2};

use crate::model::{Axis, ByAxis, DrivenBody, Model, Outside};

/// The rows and columns of the bodies.
#[derive(Clone, Debug)]
pub(in crate::integrator) struct Border {
    pub(super) sides: ByAxis<Option<Side>>,
    /// The Schur complement, inverted.
    inverse: Matrix2<f64>,
}

/// The body along one axis.
#[derive(Clone, Debug)]
pub(super) struct Side {
    pub axis: Axis,
    /// Mass M, stiffness K and damping D.
    pub body: DrivenBody,
    /// Contributions of the earlier stages: the speed, and the displacement since the start of the step.
    pub star: BodyHistory,
    /// What acts on the body from outside, and the body itself, at the velocities evaluated last.
    pub outside: Outside,
    /// The column of the masses' equations, once the system of the masses is solved for it.
    pub column: Vec<Vector2<f64>>,
    /// The derivatives of the body's equation by the masses' unknowns.
    pub row: Vec<Vector2<f64>>,
    /// The derivative of the body's equation by its own unknown, kg/s.
    pub diagonal: f64,
    /// The derivative of the other body's equation by this one's unknown, kg/s, beside what the masses make of it.
    pub on_other: f64,
    /// Its negative residual, N.
    pub right: f64,
    /// Mass of the body with the free masses, kg.
    pub inertia: f64,
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
                on_other: 0.0,
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

    pub(super) fn sides(&mut self) -> impl Iterator<Item = &mut Side> {
        self.sides.iter_mut().flatten()
    }

    /// The largest residual as the velocity, m/s, that it makes against the inertia alone.
    pub(super) fn largest_residual(&self, beta: f64) -> f64 {
        let velocities = self.sides.iter().flatten().map(|side| side.right.abs() * beta / side.inertia);
        velocities.fold(0.0, |largest, velocity| if largest > velocity { largest } else { velocity })
    }

    /// Takes the Schur complement from the rows and the solved columns.
    pub(super) fn factor(&mut self) {
        let product = |row: &Side, column: &Side| -> f64 {
            row.row.iter().zip(&column.column).map(|(row, column)| row.dot(column)).sum()
        };
        let sides = [&self.sides.x, &self.sides.z];
        let element = |i: usize, j: usize| match (sides[i], sides[j]) {
            (Some(row), Some(column)) => (if i == j { row.diagonal } else { column.on_other }) - product(row, column),
            _ => f64::from(u8::from(i == j)),
        };
        let schur = Matrix2::from_fn(element);
        // Without a test for zero: a singular system must show in the result.
        let factor = 1.0 / (schur.m11 * schur.m22 - schur.m12 * schur.m21);
        self.inverse = Matrix2::new(schur.m22 * factor, -schur.m12 * factor, -schur.m21 * factor, schur.m11 * factor);
    }

    /// Completes the solution of the masses' system for the right sides in `masses`: subtracts what the bodies make of
    /// it and returns the bodies' unknowns.
    pub(super) fn complete(&self, masses: &mut [Vector2<f64>]) -> Vector2<f64> {
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
