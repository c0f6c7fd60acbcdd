//! Newton's equations of a stage: residuals, Jacobian, and the correction for rate-dependent friction (docs/theory.md,
//! sections 3 and 4).

use std::hint::select_unpredictable;
use std::ops::Range;

use nalgebra::{Matrix2, Vector2};

use super::border::Side;
use super::slipping_mass::{
    ContactJacobian, NeighbourWeights, RowShares, SlipMotion, SlippingMass, StageFriction, largest_of,
};
use super::{MassHistory, StagePoint, StageSolver};
use crate::math::{Jet, with_widest_vectors};
use crate::model::{
    Axis, ByAxis, ByLink, ContactForces, Forces, LinearFriction, LinkKind, LinkLaw, Mode, Model, SlipFriction,
    SlipHistory, State,
};

impl StageSolver {
    /// Factors the Jacobian at the solution, for the tangents of the stage.
    pub(in crate::integrator) fn factor_at_solution(&mut self, model: &Model, beta: f64) {
        // Of linear equations the factors of the step are those at every velocity.
        if !self.is_linear() {
            self.assemble(model, beta);
            self.system.factor();
            self.factor_border(model, beta);
        }
    }

    /// [Sets](Self::set_residuals) the residuals and returns the largest as the velocity, m/s, that it makes against
    /// the inertia alone.
    pub(super) fn residuals(&mut self, model: &Model, beta: f64) -> f64 {
        self.set_residuals(model, beta);
        let right = &self.system.right;
        let largest = with_widest_vectors(
            #[inline(always)]
            || largest_of(right),
        );
        // A force that is left over makes β/m of it in velocity, as in [5].
        let of_masses = largest * beta / model.mass;
        self.border.as_ref().map_or(of_masses, |border| of_masses.max(border.largest_residual(beta)))
    }

    /// Writes the negative residuals of the equations of motion at the present velocities to the right sides.
    pub(super) fn set_residuals(&mut self, model: &Model, beta: f64) {
        let Self { state, history, forces, system, .. } = self;
        // [5] of the free masses, and [6] of the slipping ones as if friction did not depend on the speed ...
        with_widest_vectors(
            #[inline(always)]
            || set_linear_residuals(&mut system.right, model, state, history, forces, beta),
        );
        // ... which is replaced where it does, or is not linear in F_N; and [21] of bodies.
        if !model.friction.is_linear() {
            self.slip_residuals(model, beta);
        }
        self.set_border_residuals(beta);
    }

    /// Of mass `i`, which slips: the factor with which a force on it along `axis` enters its equation, and how its
    /// elongation along that axis follows its ẋ.
    pub(super) fn slip_border(&self, model: &Model, i: usize, beta: f64, axis: Axis) -> (f64, ContactJacobian) {
        let Self { state, history, forces, laws, weights, .. } = self;
        let stage = Evaluated { model, state, history, forces, laws, weights, beta };
        let slip = match self.slips.binary_search(&i) {
            Ok(n) if !model.friction.is_linear() => stage.slipping_mass(i, &self.friction[n].friction),
            _ => stage.slipping_mass_under(model.friction.linear(), i),
        };
        match axis {
            // Along x the elongation follows ẋ itself, along z as [7] says.
            Axis::X => (slip.shares().x, ContactJacobian { height: beta, rate: 1.0 }),
            Axis::Z => (slip.shares().z, slip.climb(beta)),
        }
    }

    /// Evaluates the friction of the slipping masses, and writes their residuals, under a law that is not linear.
    fn slip_residuals(&mut self, model: &Model, beta: f64) {
        let Self { state, history, forces, laws, weights, flash, memory, .. } = self;
        let stage = Evaluated { model, state, history, forces, laws, weights, beta };
        let per_beta = 1.0 / beta;
        for (&i, slip) in self.slips.iter().zip(&mut self.friction) {
            // T at F_N and v_t of the last velocities; where it heats the contact, at the ϑ that it makes itself.
            let normal = if model.friction.is_linear_in_normal() { 0.0 } else { stage.normal(i) };
            let past = SlipHistory { flash: flash.of_mass(i), memory: memory.of_mass(i) };
            slip.friction = model.friction.slip(normal, stage.slip_speed(i), &past);
            flash.set_guess(i, slip.friction.flash);
            // -R of [6] with the tangent of T(0) at F_N, which has its value there, ...
            let velocity = state.velocity_x[i];
            let motion = SlipMotion { velocity, acceleration: (velocity - history.velocity_x[i]) * per_beta };
            let (sigma, surface) = (state.mode[i].direction(), &state.surface[i]);
            let mass = SlippingMass::under(slip.friction.tangent(), sigma, surface, motion);
            let right = &mut self.system.right[i].x;
            *right = -mass.residual(model.mass, forces.on_mass(i));
            // ... less σ q B(v), the excess of section 4.
            if model.friction.depends_on_speed() {
                *right -= mass.speed_by_velocity() * slip.friction.excess;
            }
        }
    }

    /// Assembles the part of the Jacobian that is constant through a step: all but the rows and columns of slipping
    /// masses.
    pub(super) fn assemble_constant_rows(&mut self, model: &Model, beta: f64) {
        let k = self.state.mode.len();
        // Free masses and sticking ones between the slips, the latter as if they were free ...
        let mut from = 0;
        for run in 0..=self.slip_runs.len() {
            let (to, next) = self.slip_runs.get(run).map_or((k, k), |slips| (slips.start, slips.end));
            self.assemble_free_rows(model, beta, from..to);
            from = next;
        }
        // ... and then with the identity twice: their velocities stay.
        for n in 0..self.sticks.len() {
            self.hold(self.sticks[n]);
        }
    }

    /// Assembles the rows and columns of masses that follow one another as those of free ones.
    fn assemble_free_rows(&mut self, model: &Model, beta: f64, masses: Range<usize>) {
        if masses.is_empty() {
            return;
        }
        let k = self.state.mode.len();
        let inertia = model.mass / beta;
        let [vertical, horizontal, lateral_x, lateral_z] = self.weights.0;
        // [5]: m/β + W_h + n W_lx along x, m/β + W_v + n W_lz along z, with n neighbours; x and z are not coupled.
        let diagonal = |neighbours: f64| {
            let (x, z) = (horizontal + neighbours * lateral_x, vertical + neighbours * lateral_z);
            Matrix2::new(inertia + x, 0.0, 0.0, inertia + z)
        };
        let system = &mut self.system;
        // A free mass takes forces up as they are, and acts on its neighbours by the lateral links along each axis.
        self.rows[masses.clone()].fill(RowShares { x_by_x: 1.0, x_by_z: 0.0, z_by_z: 1.0 });
        self.columns[masses.clone()].fill(NeighbourWeights { x: lateral_x, z_by_x: 0.0, z: lateral_z });
        // Two neighbours each, but for the ends of the layer.
        system.diagonal[masses.clone()].fill(diagonal(2.0));
        for end in [0, k - 1].into_iter().filter(|end| masses.contains(end)) {
            system.diagonal[end] = diagonal(neighbours(end, k));
        }
        // Beside the diagonal -∂f/∂v of a neighbour; `couple_slips` sets those beside slips.
        let beside = Matrix2::new(-lateral_x, 0.0, 0.0, -lateral_z);
        system.upper[masses.clone()].fill(beside);
        system.lower[masses].fill(beside);
    }

    /// Makes the equations of mass `i`, in contact, those of a mass that keeps its velocity.
    fn hold(&mut self, i: usize) {
        let system = &mut self.system;
        // No force enters its rows, and it makes none on its neighbours: δẋ = δż = 0.
        (self.rows[i], self.columns[i]) = (RowShares::default(), NeighbourWeights::default());
        (system.lower[i], system.diagonal[i], system.upper[i]) =
            (Matrix2::zeros(), Matrix2::identity(), Matrix2::zeros());
        // Nor do the neighbours' equations have its unknowns.
        if i > 0 {
            system.upper[i - 1] = Matrix2::zeros();
        }
        if let Some(lower) = system.lower.get_mut(i + 1) {
            *lower = Matrix2::zeros();
        }
    }

    /// Assembles what is not constant at the velocities of the last residuals.
    pub(super) fn assemble(&mut self, model: &Model, beta: f64) {
        if self.measured.is_some() {
            self.assemble_measured(model, beta);
        } else {
            self.assemble_slips(model, beta);
        }
    }

    /// Assembles the rows and columns of slipping masses at the velocities of the last residuals.
    fn assemble_slips(&mut self, model: &Model, beta: f64) {
        let Self { rows, columns, state, history, forces, laws, weights, slip_runs, system, .. } = self;
        let stage = Evaluated { model, state, history, forces, laws, weights, beta };
        // [8] of all slips with the law's own μ and A τ_0, where F_N has no part in these.
        if model.friction.is_linear_in_normal() {
            with_widest_vectors(
                #[inline(always)]
                || {
                    for run in slip_runs.iter() {
                        let (rows, columns) = (&mut rows[run.clone()], &mut columns[run.clone()]);
                        stage.assemble_run(&mut system.diagonal[run.clone()], rows, columns, run.start);
                    }
                },
            );
        }
        if !model.friction.is_linear() {
            for (&i, slip) in self.slips.iter().zip(&mut self.friction) {
                let mass = stage.slipping_mass(i, &slip.friction);
                // [8] with the tangent of T(0) at F_N.
                if !model.friction.is_linear_in_normal() {
                    (system.diagonal[i], rows[i], columns[i]) = stage.assembled(i, &mass);
                }
                // G of [10] is the derivative so far; [9] comes to it.
                let diagonal = &mut system.diagonal[i].m11;
                slip.derivative_without = *diagonal;
                if model.friction.depends_on_speed() {
                    *diagonal += mass.rate_derivative(&slip.friction, beta);
                }
            }
        }
        self.couple_slips();
    }

    /// Sets the blocks between slipping masses and their neighbours.
    fn couple_slips(&mut self) {
        let Self { rows, columns, slip_runs, system, .. } = self;
        // Each run of slips with the mass before and the one behind it.
        let last = rows.len() - 1;
        with_widest_vectors(
            #[inline(always)]
            || {
                for run in slip_runs.iter() {
                    let (first, end) = (run.start.saturating_sub(1), run.end.min(last));
                    let masses = first..end + 1;
                    let (upper, lower) = (&mut system.upper[first..end], &mut system.lower[first + 1..end + 1]);
                    couple(upper, lower, &rows[masses.clone()], &columns[masses]);
                }
            },
        );
    }
}

/// What the equations of the slipping masses follow from.
pub(super) struct Evaluated<'a> {
    pub(super) model: &'a Model,
    pub(super) state: &'a State,
    pub(super) history: &'a MassHistory,
    pub(super) forces: &'a Forces,
    pub(super) laws: &'a ByLink<LinkLaw>,
    pub(super) weights: &'a ByLink<f64>,
    /// β of the stage, s.
    pub(super) beta: f64,
}

impl Evaluated<'_> {
    /// Writes the diagonal blocks, rows and columns of slipping masses that follow one another from mass `start` on,
    /// under a linear law of friction.
    // As for `set_linear_residuals`, what it writes are arguments.
    #[inline(always)]
    fn assemble_run(
        &self,
        diagonal: &mut [Matrix2<f64>],
        rows: &mut [RowShares],
        columns: &mut [NeighbourWeights],
        start: usize,
    ) {
        let (rows, columns) = (&mut rows[..diagonal.len()], &mut columns[..diagonal.len()]);
        for n in 0..diagonal.len() {
            let i = start + n;
            let slip = self.slipping_mass_under(self.model.friction.linear(), i);
            (diagonal[n], rows[n], columns[n]) = self.assembled(i, &slip);
        }
    }

    /// The equation of mass `i`, which slips with this friction.
    #[inline]
    fn slipping_mass(&self, i: usize, friction: &SlipFriction) -> SlippingMass {
        self.slipping_mass_under(friction.tangent(), i)
    }

    /// v_t of mass `i` in the direction of its slip, m/s.
    #[inline]
    fn slip_speed(&self, i: usize) -> f64 {
        let slope = self.state.surface[i].slope;
        self.state.mode[i].direction() * ((1.0 + slope * slope).sqrt() * self.state.velocity_x[i])
    }

    /// F_N on mass `i`, N.
    #[inline]
    fn normal(&self, i: usize) -> f64 {
        let (velocity, surface) = (self.state.velocity_x[i], &self.state.surface[i]);
        ContactForces::without_limit(self.model.mass, self.forces.on_mass(i), velocity, surface).normal
    }

    /// The equation of mass `i`, which slips under this law of friction.
    #[inline(always)]
    pub(super) fn slipping_mass_under(&self, law: LinearFriction, i: usize) -> SlippingMass {
        let (sigma, surface) = (self.state.mode[i].direction(), &self.state.surface[i]);
        let motion = SlipMotion { velocity: self.state.velocity_x[i], acceleration: self.acceleration(i) };
        SlippingMass::under(law, sigma, surface, motion)
    }

    /// ẍ of mass `i`, (ẋ - ẋ*)/β, m/s².
    #[inline(always)]
    fn acceleration(&self, i: usize) -> f64 {
        (self.state.velocity_x[i] - self.history.velocity_x[i]) / self.beta
    }

    /// The diagonal block, row and column of mass `i`, which slips.
    #[inline(always)]
    fn assembled(&self, i: usize, slip: &SlippingMass) -> (Matrix2<f64>, RowShares, NeighbourWeights) {
        let [_, horizontal, lateral_x, _] = self.weights.0;
        let (neighbours, climb) = (neighbours(i, self.state.mode.len()), slip.climb(self.beta));
        // [7]: a link along z weighs w = c βs + D (s + βκẋ), as the mass climbs, one along x W = βc + D.
        let [vertical, .., lateral_z] = self.laws.0.map(|law| climb.force(&law));
        let weights = ByAxis { x: horizontal + neighbours * lateral_x, z: vertical + neighbours * lateral_z };
        let derivative = slip.derivative(self.model, self.beta, self.forces.on_mass(i), weights);
        // The equation along the profile is the first row, δż = 0 the second: ż follows from ẋ. Its height moves with ẋ,
        // so the lateral z links to its neighbours follow its first unknown.
        let ByAxis { x, z } = slip.shares();
        (
            Matrix2::new(derivative, 0.0, 0.0, 1.0),
            RowShares { x_by_x: x, x_by_z: z, z_by_z: 0.0 },
            NeighbourWeights { x: lateral_x, z_by_x: lateral_z, z: 0.0 },
        )
    }
}

/// Sets the blocks beside the diagonal between masses that follow one another.
#[inline(always)]
fn couple(upper: &mut [Matrix2<f64>], lower: &mut [Matrix2<f64>], rows: &[RowShares], columns: &[NeighbourWeights]) {
    let pairs = rows.iter().zip(&rows[1..]).zip(columns.iter().zip(&columns[1..]));
    for ((upper, lower), ((row, next_row), (column, next_column))) in upper.iter_mut().zip(lower).zip(pairs) {
        // The row of a mass by the unknowns of the next, and the other way round.
        *upper = row.coupling(next_column);
        *lower = next_row.coupling(column);
    }
}

/// The number of neighbours of mass `i` of `k`.
#[inline(always)]
pub(super) fn neighbours(i: usize, k: usize) -> f64 {
    f64::from(u8::from(i > 0) + u8::from(i + 1 < k))
}

/// Writes the negative residuals of all masses under a linear law of friction to `right`.
// `right` is an argument of its own. By that the compiler knows that it does not overlap what is read, and makes vector
// instructions of the loop.
#[inline(always)]
fn set_linear_residuals(
    right: &mut [Vector2<f64>],
    model: &Model,
    state: &State,
    history: &MassHistory,
    forces: &Forces,
    beta: f64,
) {
    let (inertia, per_beta) = (model.mass / beta, 1.0 / beta);
    // Slices of one length, so that an index into one of them is one into all.
    let k = right.len();
    let (v_x, v_z) = (&state.velocity_x[..k], &state.velocity_z[..k]);
    let (star_x, star_z) = (&history.velocity_x[..k], &history.velocity_z[..k]);
    let (f_x, f_z) = (&forces.on_mass_x[..k], &forces.on_mass_z[..k]);
    let (mode, surface) = (&state.mode[..k], &state.surface[..k]);
    let (law, mass) = (model.friction.linear(), model.mass);
    for i in 0..k {
        let (gained_x, gained_z) = (v_x[i] - star_x[i], v_z[i] - star_z[i]);
        // -R of [6] with ẍ = (ẋ - ẋ*)/β of [1]; 0 of a mass that sticks, whose second equation is void like a slip's.
        let sigma = mode[i].direction();
        let motion = SlipMotion { velocity: v_x[i], acceleration: gained_x * per_beta };
        let slip = SlippingMass::under(law, sigma, &surface[i], motion);
        let forces = ByAxis { x: f_x[i], z: f_z[i] };
        let of_slip = select_unpredictable(sigma != 0.0, -slip.residual(mass, forces), 0.0);
        // r of [5].
        let (free_x, free_z) = (f_x[i] - inertia * gained_x, f_z[i] - inertia * gained_z);
        let is_free = mode[i] == Mode::Free;
        right[i] =
            Vector2::new(select_unpredictable(is_free, free_x, of_slip), select_unpredictable(is_free, free_z, 0.0));
    }
}

impl StageSolver {
    /// Replaces the corrections of slipping masses, which follow the tangent of the friction curve, by those along the
    /// curve itself. Returns the largest of them as the velocity, m/s, that the same force would change if friction did
    /// not depend on the speed: where the curve is steep, a small correction may still mean a large force.
    pub(super) fn correct_along_friction_curve(&mut self, model: &Model, beta: f64) -> f64 {
        let Self { state, history, forces, laws, weights, flash, memory, .. } = self;
        let stage = Evaluated { model, state, history, forces, laws, weights, beta };
        let mut largest: f64 = 0.0;
        for (&i, slip) in self.slips.iter().zip(&self.friction) {
            let StageFriction { friction, derivative_without } = slip;
            let mass = stage.slipping_mass(i, friction);
            let right = &mut self.system.right[i].x;
            // v and δv = σ q δẋ of section 4, in the direction of slip.
            let per_velocity = mass.speed_by_velocity();
            let (speed, by) = (mass.slip_speed(), per_velocity * *right);
            // 1 + q² B'/G, by which a correction counts in the convergence test.
            let steepness = 1.0 + (mass.q2() * friction.by_speed / derivative_without).max(0.0);
            // v' of [10], with G/q² as the weight; back to δẋ.
            let (law, weight) = (&model.friction, derivative_without / mass.q2());
            let past = SlipHistory { flash: flash.of_mass(i), memory: memory.of_mass(i) };
            let corrected = law.along_curve(friction.normal, &past, (speed, by), weight);
            *right = (corrected - speed) / per_velocity;
            largest = largest.max(steepness * right.abs());
        }
        largest
    }
}

/// The bodies of the carrier (docs/theory.md, section 12).
impl StageSolver {
    /// Assembles and eliminates the bodies' rows and columns, once the system of the masses is factored.
    pub(super) fn factor_border(&mut self, model: &Model, beta: f64) {
        let Some(mut border) = self.border.take() else { return };
        for side in border.sides() {
            self.assemble_side(model, beta, side);
            if self.is_linear() {
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
        if self.measured.is_some() {
            return self.assemble_measured_side(model, beta, side);
        }
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
