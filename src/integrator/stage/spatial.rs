//! Stages whose links along z are in spatial measure: their Jacobian, that of the bodies, and the powers of these links.
//!
//! The spacing of two masses enters the forces along z on both and their neighbours, and the heights enter those along x.
//! So all blocks are full, and change with the strain.

use nalgebra::{Matrix2, Vector2};

use super::border::Side;
use super::newton::{Evaluated, neighbours};
use super::{StageSolver, StageValues};
use crate::model::{Axis, ByAxis, LinkKind, MeasuredMotion, Mode, Model, SpatialMeasure, Varied};

impl StageSolver {
    /// Assembles the Jacobian at the velocities of the last residuals.
    pub(super) fn assemble_measured(&mut self, model: &Model, beta: f64) {
        let Some(measure) = self.forces.spatial.take() else { return };
        let k = self.state.mode.len();
        let mut slips = 0;
        for i in 0..k {
            let own = self.follow(beta, i, i, |motion| measure.on_itself(&self.laws, i, motion));
            let shares = match self.state.mode[i] {
                Mode::Free => {
                    self.system.diagonal[i] = Matrix2::identity() * (model.mass / beta) - own;
                    Matrix2::identity()
                }
                Mode::Stick => {
                    self.system.diagonal[i] = Matrix2::identity();
                    Matrix2::zeros()
                }
                Mode::Forward | Mode::Backward => {
                    slips += 1;
                    self.assemble_measured_slip(model, beta, (i, slips - 1), own)
                }
            };
            if i + 1 < k {
                let by_next = self.follow(beta, i, i + 1, |motion| measure.by_next(&self.laws, i, motion));
                self.system.upper[i] = -(shares * by_next);
            }
            if i > 0 {
                let by = self.follow(beta, i, i - 1, |motion| measure.by_previous(&self.laws, i, motion));
                self.system.lower[i] = -(shares * by);
            }
        }
        self.forces.spatial = Some(measure);
    }

    /// Assembles the diagonal block of mass `i`, slip `n`, whose forces follow its unknowns as `own` says. Returns the
    /// factors with which forces enter its equations.
    fn assemble_measured_slip(
        &mut self,
        model: &Model,
        beta: f64,
        (i, n): (usize, usize),
        own: Matrix2<f64>,
    ) -> Matrix2<f64> {
        let Self { state, history, forces, laws, weights, .. } = self;
        let stage = Evaluated { model, state, history, forces, laws, weights, beta };
        let friction = self.friction.get_mut(n).filter(|_| !model.friction.is_linear());
        let law = friction.as_ref().map_or_else(|| model.friction.linear(), |slip| slip.friction.tangent());
        let mass = stage.slipping_mass_under(law, i);
        let mut derivative = mass.derivative(model, beta, forces.on_mass(i), ByAxis { x: -own.m11, z: -own.m21 });
        if let Some(slip) = friction {
            slip.derivative_without = derivative;
            if model.friction.depends_on_speed() {
                derivative += mass.rate_derivative(&slip.friction, beta);
            }
        }
        self.system.diagonal[i] = Matrix2::new(derivative, 0.0, 0.0, 1.0);
        let ByAxis { x, z } = mass.shares();
        Matrix2::new(x, z, 0.0, 0.0)
    }

    /// How the forces on mass `i` follow the unknowns of mass `j`: along x (first row) and z those that `measured` gives
    /// for a motion of it, and along x those of the links along x.
    fn follow(&self, beta: f64, i: usize, j: usize, measured: impl Fn(&MeasuredMotion) -> Varied) -> Matrix2<f64> {
        let [by_x, by_z] = self.unknowns(j, beta).map(|motion| measured(&motion));
        let [_, horizontal, lateral, _] = self.weights.0;
        let along_x = match (self.state.mode[j], i == j) {
            (Mode::Stick, _) => 0.0,
            (_, true) => -(horizontal + neighbours(i, self.state.mode.len()) * lateral),
            (_, false) => lateral,
        };
        Matrix2::new(by_x[0] + along_x, by_z[0], by_x[1], by_z[1])
    }

    /// How mass `i` moves by each of its unknowns, ẋ and ż.
    fn unknowns(&self, i: usize, beta: f64) -> [MeasuredMotion; 2] {
        let none = MeasuredMotion::default();
        match self.state.mode[i] {
            Mode::Free => [MeasuredMotion { x: beta, ..none }, MeasuredMotion { z: beta, rate_z: 1.0, ..none }],
            Mode::Stick => [none; 2],
            Mode::Forward | Mode::Backward => {
                let (surface, v) = (&self.state.surface[i], self.state.velocity_x[i]);
                // [7]: it climbs the profile.
                let rate_z = surface.slope + beta * surface.curvature * v;
                [MeasuredMotion { x: beta, z: beta * surface.slope, rate_z }, none]
            }
        }
    }

    /// Assembles the row and the column of one body, with the blocks of the masses assembled.
    ///
    /// The unknowns of free masses are relative to the body, and their equations are added to its own.
    pub(super) fn assemble_measured_side(&self, model: &Model, beta: f64, side: &mut Side) {
        let Some(measure) = &self.forces.spatial else { return };
        let (k, axis) = (self.state.mode.len(), side.axis as usize);
        let is_free = |i: usize| self.state.mode[i] == Mode::Free;
        let unit = |i: usize| if is_free(i) { Vector2::ith(axis, 1.0) } else { Vector2::zeros() };
        let beside = |i: usize| i.saturating_sub(1)..(i + 2).min(k);
        // The body by itself, and what the links to it exert on it.
        let free = (0..k).filter(|&i| is_free(i)).count() as f64;
        side.inertia = side.body.mass + free * model.mass;
        side.diagonal = side.body.mass / beta + beta * side.body.stiffness + side.body.damping;
        side.on_other = 0.0;
        for i in 0..k {
            let on_mass = self.by_carrier(measure, beta, side.axis, i);
            let row: Vector2<f64> = beside(i).map(|j| self.block(i, j) * unit(j)).sum();
            side.column[i] = row - self.shares(model, i, beta) * on_mass;
            let own = self.on_carrier(measure, beta, side.axis, i);
            let of_free = |j: usize| if is_free(j) { self.block(j, i).row(axis).transpose() } else { Vector2::zeros() };
            side.row[i] = beside(i).map(of_free).sum::<Vector2<f64>>() - own;
            // All of it moves: its equation has those of the free masses and its links in it.
            let link = -self.link_by_carrier(measure, side.axis, i);
            side.diagonal += if is_free(i) { side.column[i][axis] } else { 0.0 } - own.dot(&unit(i)) + link;
            side.on_other += if is_free(i) { side.column[i][1 - axis] } else { 0.0 };
            if side.axis == Axis::X {
                side.on_other -= self.on_carrier(measure, beta, Axis::Z, i).dot(&unit(i));
            }
        }
    }

    /// The block of the Jacobian in row `i` and column `j`.
    fn block(&self, i: usize, j: usize) -> Matrix2<f64> {
        match i.cmp(&j) {
            std::cmp::Ordering::Less => self.system.upper[i],
            std::cmp::Ordering::Equal => self.system.diagonal[i],
            std::cmp::Ordering::Greater => self.system.lower[i],
        }
    }

    /// The factors with which the forces along x and z enter the equations of mass `i`.
    fn shares(&self, model: &Model, i: usize, beta: f64) -> Matrix2<f64> {
        match self.state.mode[i] {
            Mode::Free => Matrix2::identity(),
            Mode::Stick => Matrix2::zeros(),
            Mode::Forward | Mode::Backward => {
                let (share, _) = self.slip_border(model, i, beta, Axis::X);
                let (along_z, _) = self.slip_border(model, i, beta, Axis::Z);
                Matrix2::new(share, along_z, 0.0, 0.0)
            }
        }
    }

    /// How the forces on mass `i` follow the speed of the carrier along `axis`.
    fn by_carrier(&self, measure: &SpatialMeasure, beta: f64, axis: Axis, i: usize) -> Vector2<f64> {
        match axis {
            Axis::X => Vector2::new(self.weights[LinkKind::Horizontal], 0.0),
            Axis::Z => measure.by_carrier(&self.laws, i, &MeasuredMotion { x: 0.0, z: -beta, rate_z: -1.0 }).into(),
        }
    }

    /// How the force of the link of mass `i` on the carrier along `axis` follows the carrier's speed.
    fn link_by_carrier(&self, measure: &SpatialMeasure, axis: Axis, i: usize) -> f64 {
        let weight = -self.weights[axis.link()];
        if axis == Axis::X { weight } else { measure.factor(LinkKind::Vertical, i) * weight }
    }

    /// How the force of the links on the carrier along `axis` follows the unknowns of mass `i`.
    fn on_carrier(&self, measure: &SpatialMeasure, beta: f64, axis: Axis, i: usize) -> Vector2<f64> {
        let [by_x, by_z] = self.unknowns(i, beta);
        match axis {
            Axis::X if self.state.mode[i] == Mode::Stick => Vector2::zeros(),
            Axis::X => Vector2::new(self.weights[LinkKind::Horizontal], 0.0),
            Axis::Z => [by_x, by_z].map(|motion| measure.on_carrier(&self.laws, i, &motion)).into(),
        }
    }

    /// P_damper and P_maxwell of the links in spatial measure at the solved stage with these `rates`, W.
    pub(in crate::integrator) fn measured_powers(&self, model: &Model, rates: &StageValues) -> [f64; 2] {
        let (Some(squares), Some(measure)) = (&self.measured, &self.forces.spatial) else { return [0.0; 2] };
        let mut powers = [0.0; 2];
        for (kind, squares) in SpatialMeasure::LINKS.into_iter().zip(&squares.power) {
            for (link, &rate) in rates.elongation_rate[kind].iter().enumerate() {
                let factor = measure.factor(kind, link);
                powers[0] += factor * model.links[kind].damping * rate * rate;
                powers[1] += factor * squares.at(link, rate);
            }
        }
        powers
    }
}
