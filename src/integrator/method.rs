//! One Runge-Kutta step: the stages of an attempted step, from their history to their error test.

use super::error::{CarrierQuadrature, ErrorEstimate, ErrorTest, ErrorWorkspace};
use super::heat::{StageHeat, heat_flux};
use super::maxwell::Maxwell;
use super::scheme::{Coefficients, InitialGuess, Scheme};
use super::sensitivity::{Sensitivity, Solved};
use super::stage::{BodyHistory, ConvergenceTest, NoConvergence, StagePoint, StageSolver};
use super::stage_values::{LayerState, StageValues};
use super::tableau::MAX_STAGES;
use super::tolerance::Tolerance;
use crate::math::{Jet, weighted_sum, with_widest_vectors};
use crate::model::{Axis, BoundaryPowers, ByAxis, Carrier, CarrierPoint, Input, Mode, Model, State};

/// Where a step lies in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeSpan {
    /// Start of the step, s after the start of the carrier's segment.
    pub start: f64,
    /// Length of the step, s.
    pub length: f64,
}

impl TimeSpan {
    /// The time at the fraction `theta` of the step, s after the start of the carrier's segment.
    pub fn at(&self, theta: f64) -> f64 {
        self.start + theta * self.length
    }
}

/// A Runge-Kutta method with its workspace.
#[derive(Clone, Debug)]
pub(super) struct RungeKutta {
    pub scheme: Scheme,
    pub coefficients: &'static Coefficients,
    pub maxwell: Maxwell,
    pub heat: StageHeat,
}

/// The values at the stages of the last attempted step. Stage 0 is the start of the step.
#[derive(Clone, Debug)]
pub(super) struct Stages {
    pub rates: Vec<StageValues>,
    pub carrier: [CarrierPoint; MAX_STAGES],
    /// The powers through the surface and the carrier; computed if `tracks_energy`.
    pub exchange: [BoundaryPowers; MAX_STAGES],
    /// The forces of the horizontal and vertical links at the stages between the first and the last; kept where
    /// energies of parts of the layer may be asked for.
    pub link_forces: Vec<[Vec<f64>; 2]>,
    pub solver: StageSolver,
    pub tracks_energy: bool,
    /// The sensitivities to the targets of the inputs; empty if they are not asked for.
    pub tangents: Vec<Sensitivity>,
}

/// What a step is attempted with.
#[derive(Clone, Copy)]
pub(super) struct StepAttempt<'a> {
    pub model: &'a Model,
    pub start: &'a LayerState,
    pub carrier: &'a Carrier,
    pub span: TimeSpan,
    /// β = γh, s.
    pub beta: f64,
}

/// The most by which the speed of a slip may be guessed to grow where friction depends on it. Where friction falls with
/// the speed there may be several solutions: the one that the motion reaches first is found from its present speed.
const MAX_GUESSED: f64 = 2.0;

impl RungeKutta {
    /// The method of a `scheme` for `model`, without workspace unless it `is_used`.
    pub(super) fn new(scheme: Scheme, model: &Model, is_used: bool) -> Self {
        let coefficients = scheme.coefficients();
        Self {
            scheme,
            coefficients,
            maxwell: Maxwell::new(coefficients.tableau, model, is_used),
            heat: StageHeat::new(coefficients, model, is_used),
        }
    }

    /// Solves all stages of a step.
    pub(super) fn attempt(
        &mut self,
        stages: &mut Stages,
        step: &StepAttempt<'_>,
        convergence: ConvergenceTest,
    ) -> Result<(), NoConvergence> {
        let (StepAttempt { model, start, carrier, span, beta }, tableau) = (*step, self.coefficients.tableau);
        let state = &start.state;
        // The first stage is the start of the step.
        stages.rates[0].copy_from(&start.rates);
        stages.exchange[0] = start.exchange;
        stages.carrier[0] = carrier.at(span.start);
        stages.solver.begin(model, state, beta, self.scheme.contact_modes());
        self.maxwell.begin(model, &state.maxwell, span.length);
        self.heat.begin(&state.flash, span.length);
        for i in 1..tableau.stages {
            // What the earlier stages contribute, and a guess of the velocities.
            let (weights, s) = (&tableau.a[i][..], span.at(tableau.c[i]));
            let moved = carrier.moved(span.start, tableau.c[i] * span.length).x;
            let mut point = stages.prepare(step, i, s, moved, weights);
            self.maxwell.known_forces(i, &stages.rates[..i], &mut stages.solver.history.force);
            self.heat.prepare(i, &stages.rates[..i], &mut stages.solver.flash);
            if let Some(squares) = &mut stages.solver.measured {
                self.maxwell.measured_squares(model, i, &state.maxwell, &stages.rates[..i], squares);
            }
            stages.solver.memory.prepare(state, (tableau.c[i], span.length, beta), &stages.rates[..i], weights);
            stages.guess(step, i, &self.coefficients.initial_guess);
            // The velocities at the stage, and their sensitivities.
            stages.solve(step, &mut point, i, s, convergence)?;
            if model.spatial.is_some() && !stages.tangents.is_empty() {
                let Stages { rates, solver, .. } = stages;
                self.maxwell.at_stage(model, i, &state.maxwell, rates, &mut solver.state.maxwell);
            }
            stages.vary(step, &self.heat, &point, i, s, weights);
            if i < tableau.last() {
                stages.keep_link_forces(i);
            }
        }
        // The last stage is the end of the step; its Maxwell elements and flash temperatures are still to be found.
        let Stages { rates, solver, .. } = stages;
        self.maxwell.at_stage(model, tableau.last(), &state.maxwell, rates, &mut solver.state.maxwell);
        self.heat.at_end(&state.flash, rates.iter().map(heat_flux), &mut solver.state.flash);
        Ok(())
    }

    /// The error test of the step whose stages are solved.
    pub(super) fn test(
        &self,
        stages: &Stages,
        step: &StepAttempt<'_>,
        tolerance: &Tolerance,
        workspace: &mut ErrorWorkspace,
    ) -> ErrorEstimate {
        let tableau = self.coefficients.tableau;
        let test = ErrorTest {
            modes: self.scheme.contact_modes(),
            tableau,
            maxwell: &self.maxwell,
            heat: &self.heat,
            stages: &stages.rates[..tableau.stages],
            carrier: &stages.carrier[..tableau.stages],
            end: &stages.solver.state,
            contacts: stages.solver.contacts(),
            sticks: stages.solver.sticks(),
            exchange: stages.tracks_energy.then_some(&stages.exchange[..]),
            largest: step.start.largest.with(&stages.solver.forces),
        };
        test.run(step.model, step.span.length, tolerance, workspace)
    }
}

impl Stages {
    /// Values at so many `stages` of the steps of `model`, with sensitivities to these `inputs`.
    pub(super) fn new(model: &Model, stages: usize, tracks_energy: bool, inputs: Vec<Input>) -> Self {
        Self {
            rates: (0..stages).map(|_| StageValues::new(model)).collect(),
            carrier: [CarrierPoint::default(); MAX_STAGES],
            exchange: [BoundaryPowers::default(); MAX_STAGES],
            link_forces: Vec::new(),
            solver: StageSolver::new(model),
            tracks_energy,
            tangents: inputs.into_iter().map(|input| Sensitivity::new(model, input, stages)).collect(),
        }
    }

    /// Prepares stage `i`, at `s` seconds after the start of the carrier's segment, which has moved by `moved` (m)
    /// along x since the start of the step: the history of the masses' motion with the `weights` of the stages, and its
    /// point.
    fn prepare(&mut self, step: &StepAttempt<'_>, i: usize, s: f64, moved: f64, weights: &[f64]) -> StagePoint {
        let (carrier, h) = (step.carrier, step.span.length);
        let mut at = carrier.at(s);
        if carrier.has_bodies() {
            self.prepare_bodies(step, i, s, weights, &mut at);
        }
        self.carrier[i] = at;
        self.collect_history(&step.start.state, h, &weights[..i]);
        StagePoint {
            beta: step.beta,
            carrier: at,
            integrated: self.integrate_carrier(carrier, h, weights, i),
            moved,
            segment_start: ByAxis { x: carrier.profile_position, z: carrier.start.z },
        }
    }

    /// Sets what stage `i` knows of the bodies, and guesses that they move as at the stage before: `at` is the carrier.
    fn prepare_bodies(&mut self, step: &StepAttempt<'_>, i: usize, s: f64, weights: &[f64], at: &mut CarrierPoint) {
        let (carrier, h) = (step.carrier, step.span.length);
        for axis in Axis::ALL.into_iter().filter(|&axis| carrier.is_body(axis)) {
            let Jet { position: start, speed: start_rate, .. } = self.carrier[0][axis];
            let mut star = BodyHistory { rate: start_rate, moved: 0.0, start };
            for (earlier, weight) in self.carrier[..i].iter().zip(weights) {
                star.rate += h * weight * earlier[axis].acceleration;
                star.moved += h * weight * earlier[axis].speed;
            }
            let speed = self.carrier[i - 1][axis].speed;
            let position = start + (star.moved + step.beta * speed);
            at[axis] = Jet { position, speed, acceleration: (speed - star.rate) / step.beta };
            let outside = carrier.outside_at(step.model, axis, s, at[axis]);
            if let (Some((_, outside)), Some(border)) = (outside, &mut self.solver.border) {
                border.prepare(axis, star, outside);
            }
        }
    }

    /// Sets the starred values: the contributions of the earlier stages, with these weights, in a step of length `h`.
    fn collect_history(&mut self, state: &State, h: f64, weights: &[f64]) {
        let history = &mut self.solver.history;
        let earlier = &self.rates;
        let sum = |star: &mut [f64], start: &[f64], rate: fn(&StageValues) -> &[f64]| {
            let counting = earlier.iter().zip(weights).filter(|(_, weight)| **weight != 0.0);
            let terms = counting.map(|(stage, weight)| (h * weight, rate(stage)));
            weighted_sum(star, std::iter::once((1.0, start)).chain(terms));
        };
        sum(&mut history.elongation_x, &state.elongation_x, |stage| &stage.velocity_x);
        sum(&mut history.elongation_z, &state.elongation_z, |stage| &stage.velocity_z);
        sum(&mut history.velocity_x, &state.velocity_x, |stage| &stage.acceleration_x);
        sum(&mut history.velocity_z, &state.velocity_z, |stage| &stage.acceleration_z);
    }

    /// The displacement of the carrier from the start of the step to stage `i` along x and z, m, by the method's own
    /// quadrature of its rate.
    ///
    /// So the elongations are integrated as the differences that they are, ė = ẋ - u̇, and the velocities relative to
    /// the carrier's, with -ü as a load: a carrier that oscillates widely causes no error in a layer that moves with
    /// it. The starred velocities take up the error of the quadrature of ü for u̇.
    fn integrate_carrier(&mut self, carrier: &Carrier, h: f64, weights: &[f64], i: usize) -> ByAxis<f64> {
        let CarrierQuadrature { moved, gained } = CarrierQuadrature::new(&self.carrier[..=i], weights, h);
        let error = self.carrier[i].rates() - self.carrier[0].rates() - gained;
        let history = &mut self.solver.history;
        // On straight paths the quadrature is exact, and so it is of a body, which is integrated.
        for (axis, star) in [(Axis::X, &mut history.velocity_x), (Axis::Z, &mut history.velocity_z)] {
            if error[axis] != 0.0 && !carrier.is_body(axis) {
                star.iter_mut().for_each(|star| *star += error[axis]);
            }
        }
        moved
    }

    /// Sets the velocities from which Newton's iterations of stage `i` start.
    fn guess(&mut self, step: &StepAttempt<'_>, i: usize, guess: &InitialGuess) {
        match guess {
            InitialGuess::Extrapolated(weights) => self.guess_extrapolated(step, &weights[i][..i]),
            InitialGuess::Limited => self.guess_limited(step, i),
        }
    }

    fn guess_extrapolated(&mut self, step: &StepAttempt<'_>, weights: &[f64]) {
        let (solver, state) = (&mut self.solver, &step.start.state);
        let earlier = self.rates.iter().zip(weights).filter(|(_, weight)| **weight != 0.0);
        solver.guess(state, earlier.map(|(stage, weight)| (step.beta * weight, stage)));
        if step.model.friction.depends_on_speed() {
            solver.limit_guess(&state.velocity_x, MAX_GUESSED);
        }
    }

    fn guess_limited(&mut self, step: &StepAttempt<'_>, i: usize) {
        with_widest_vectors(
            #[inline(always)]
            || self.set_limited_guess(step, i),
        );
    }

    #[inline(always)]
    fn set_limited_guess(&mut self, step: &StepAttempt<'_>, i: usize) {
        let (known, guess, history) = (&self.rates[i - 1], &mut self.solver.state, &self.solver.history);
        let carrier = self.carrier[i].x.speed.abs() + self.carrier[i].z.speed.abs();
        // Slices of one length, so that an index into one of them is one into all.
        let mode = &guess.mode[..];
        let k = mode.len();
        let (star_x, star_z) = (&history.velocity_x[..k], &history.velocity_z[..k]);
        let (known_x, known_z) = (&known.acceleration_x[..k], &known.acceleration_z[..k]);
        let (guess_x, guess_z) = (&mut guess.velocity_x[..k], &mut guess.velocity_z[..k]);
        for i in 0..k {
            let (v_x, v_z) = (star_x[i], star_z[i]);
            let most = carrier + v_x.abs() + v_z.abs();
            let moves = if mode[i] == Mode::Stick { 0.0 } else { 1.0 };
            guess_x[i] = moves * (v_x + (step.beta * known_x[i]).min(most).max(-most));
            guess_z[i] = moves * (v_z + (step.beta * known_z[i]).min(most).max(-most));
        }
    }

    /// Solves stage `i`, which is prepared, at `s` seconds after the start of the carrier's segment, and computes the
    /// powers at it.
    fn solve(
        &mut self,
        step: &StepAttempt<'_>,
        point: &mut StagePoint,
        i: usize,
        s: f64,
        convergence: ConvergenceTest,
    ) -> Result<(), NoConvergence> {
        let StepAttempt { model, carrier, .. } = *step;
        self.solver.solve(model, point, convergence, &mut self.rates[i])?;
        self.carrier[i] = point.carrier;
        if self.tracks_energy {
            let solver = &self.solver;
            self.exchange[i] =
                BoundaryPowers::with_friction(model, &solver.friction_power, &point.carrier, &solver.forces);
            self.exchange[i].measured = solver.measured_powers(model, &self.rates[i]);
            self.exchange[i].add_bodies(model, carrier, s, &point.carrier);
        }
        Ok(())
    }

    /// Keeps the forces of the links at stage `i`, just solved. The next stage writes its own over those that the
    /// solver gets in exchange.
    fn keep_link_forces(&mut self, i: usize) {
        if let Some([x, z]) = self.link_forces.get_mut(i - 1) {
            let [vertical, horizontal, ..] = &mut self.solver.forces.link.0;
            std::mem::swap(x, horizontal);
            std::mem::swap(z, vertical);
        }
    }

    /// Computes the tangents at stage `i`, just solved, at `s` seconds after the start of the carrier's motion; the
    /// stages have `weights`.
    fn vary(
        &mut self,
        step: &StepAttempt<'_>,
        heat: &StageHeat,
        point: &StagePoint,
        i: usize,
        s: f64,
        weights: &[f64],
    ) {
        if self.tangents.is_empty() {
            return;
        }
        self.solver.factor_at_solution(step.model, point.beta);
        let stage = Solved { i, s, h: step.span.length, weights, rates: &self.rates[i], point, heat };
        for tangent in &mut self.tangents {
            tangent.solve_stage(step.model, &mut self.solver, &stage);
        }
    }

    /// Accepts the last attempted step, which ended with stage `last`: its end becomes the `start` of the next one.
    pub(super) fn accept(&mut self, start: &mut LayerState, last: usize) {
        std::mem::swap(&mut start.state, &mut self.solver.state);
        std::mem::swap(&mut start.rates, &mut self.rates[last]);
        start.exchange = self.exchange[last];
        start.largest = start.largest.with(&self.solver.forces);
        for tangent in &mut self.tangents {
            tangent.accept(last);
        }
    }
}
