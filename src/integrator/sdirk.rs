//! The two-stage method of the time-stepping driver: SDIRK2 of R. Alexander (SIAM J. Numer. Anal. 14, 1977), with
//! γ = 1 - 1/√2 of order 2, L-stable and stiffly accurate. Every step takes two stages, whatever happens within it.

use super::error::ErrorTest;
use super::maxwell::Maxwell;
use super::stage::{Accuracy, NoConvergence};
use super::{Attempt, Integrator, Rates, STAGES, StepStart, Tableau, Tolerance, WeightsWithin, energy};
use crate::model::{Carrier, CarrierPoint, ChannelEnergies, Forces, Mode, Model, State};

/// The two stages, and before them the start of the step: the method needs its rates for a guess alone.
pub const TWO_STAGES: usize = 3;

/// γ: the place of the first stage and the weight of each stage in itself.
pub(super) const GAMMA: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

/// The error of a step counts as this share of h (k_2 - k_1), k the rates at the stages: γ is what the method differs
/// by from implicit Euler, of order 1.
///
/// Ten times γ makes the forces of a rough layer err by about the relative tolerance, as the step's length follows the
/// root of this. Smaller makes longer steps.
const ESTIMATE: f64 = 10.0 * GAMMA;

/// The method, the start of the step counted as a stage without weight.
pub const SDIRK2: Tableau<TWO_STAGES> = Tableau {
    a: [[0.0; 3], [0.0, GAMMA, 0.0], [0.0, 1.0 - GAMMA, GAMMA]],
    c: [0.0, GAMMA, 1.0],
    error: [0.0, -ESTIMATE, ESTIMATE],
    embedded_order: 1,
};

/// Newton's iterations are left to this multiple of what they are left to in the other method. Iterating is what a step
/// costs, and what a correction leaves is known to be less than this.
const NEWTON_SLACK: f64 = 2.0;
/// The same where friction depends on the speed. Corrections fall slowly there, and what they leave is seen ten times
/// over by the estimate of the error, as [`ESTIMATE`] over γ: steps would follow it and not the motion.
const STEEP_SLACK: f64 = 0.1;

/// What the two stages weigh up to the fraction `theta` of the step: the line through their rates, integrated.
#[inline]
pub(super) fn integrated(theta: f64) -> (f64, f64) {
    let last = theta * (0.5 * theta - GAMMA) / (1.0 - GAMMA);
    (theta - last, last)
}

/// What the method keeps beside the stages.
#[derive(Clone, Debug)]
pub(super) struct TwoStages {
    maxwell: Maxwell<TWO_STAGES>,
    weights_within: WeightsWithin<TWO_STAGES>,
}

impl TwoStages {
    /// Room for steps of `model`, if it is used.
    pub(super) fn new(model: &Model, used: bool) -> Self {
        let bend = 0.5 / (1.0 - GAMMA);
        Self {
            maxwell: if used { Maxwell::new(model) } else { Maxwell::none() },
            // Those of `integrated`, by powers.
            weights_within: WeightsWithin::of_powers(
                [0.0, 1.0 + 2.0 * GAMMA * bend, -2.0 * GAMMA * bend],
                [0.0, -bend, bend],
            ),
        }
    }

    /// Numbers that this holds.
    pub(super) fn floats(&self) -> usize {
        self.maxwell.floats()
    }
}

impl Integrator {
    /// Tries a step of two stages of length `h` from `start`, `s` seconds after the start of the carrier's piece.
    ///
    /// # Errors
    /// [`NoConvergence`] where a stage could not be solved.
    pub fn attempt_two_stages(
        &mut self,
        model: &Model,
        start: &StepStart,
        carrier: &Carrier,
        (s, h): (f64, f64),
        tolerance: &Tolerance,
    ) -> Result<Attempt, NoConvergence> {
        let beta = GAMMA * h;
        let state = &start.state;
        self.begin_step(start);
        let slack = if model.rate_shear.is_some() { STEEP_SLACK } else { NEWTON_SLACK };
        self.carrier[0] = carrier.at(s);
        self.solver.begin(model, state, beta);
        self.two_stages.maxwell.begin(model, &SDIRK2, &state.maxwell, h);
        for i in 1..TWO_STAGES {
            let stage = (i, SDIRK2.c[i], &SDIRK2.a[i][..]);
            let point = self.prepare_stage(state, carrier, (s, h), stage, beta);
            self.two_stages.maxwell.known_forces(i, &self.stages[..i], &mut self.solver.history.force);
            self.guess(&state.mode, beta, i);
            self.solve_stage(model, &point, (s, h), stage, Accuracy::new(tolerance, beta, slack))?;
        }
        let (maxwell, end) = (&self.two_stages.maxwell, &mut self.solver.state);
        maxwell.finish(model, &state.maxwell, &self.stages, &mut end.maxwell);
        let (stages, carrier) = (&self.stages[..], &self.carrier[..TWO_STAGES]);
        let (end, contacts) = (&self.solver.state, self.solver.contacts());
        let test = ErrorTest { tableau: &SDIRK2, maxwell, stages, carrier, end, contacts };
        let attempt = test.error(model, h, tolerance, &mut self.error_workspace);
        // Touches are looked for where the step ends, so the carrier has to be seen whether masses are near or not.
        Ok(Attempt { error: attempt.error.hypot(attempt.unseen), ..attempt })
    }

    /// The velocities from which Newton's iterations start: where the accelerations known last lead to. Just after a
    /// jump those of a stiff layer are no guide: no mass is guessed to change its velocity by more than what moves
    /// anyway.
    fn guess(&mut self, mode: &[Mode], beta: f64, i: usize) {
        let (known, guess, history) = (&self.stages[i - 1], &mut self.solver.state, &self.solver.history);
        let carried = self.carrier[i].u_rate.abs() + self.carrier[i].w_rate.abs();
        for (i, mode) in mode.iter().enumerate() {
            let (v_x, v_z) = (history.velocity_x[i], history.velocity_z[i]);
            let most = carried + v_x.abs() + v_z.abs();
            let moves = if *mode == Mode::Stick { 0.0 } else { 1.0 };
            guess.velocity_x[i] = moves * (v_x + (beta * known.acceleration_x[i]).clamp(-most, most));
            guess.velocity_z[i] = moves * (v_z + (beta * known.acceleration_z[i]).clamp(-most, most));
        }
    }

    /// How long a step of two stages with an error of the tolerance would be, as a share of the step of length `h` of
    /// the other method that was tried last: by the change of velocities and accelerations through it.
    pub fn two_stage_share(&self, h: f64, tolerance: &Tolerance) -> f64 {
        let (first, last, end) = (&self.stages[0], &self.stages[STAGES - 1], &self.solver.state);
        let carrier: &CarrierPoint = &self.carrier[STAGES - 1];
        let mut sum = 0.0;
        for i in 0..end.mode.len() {
            let change = |of: fn(&Rates) -> &[f64]| (ESTIMATE * h * (of(last)[i] - of(first)[i])).powi(2);
            sum += change(|rates| &rates.velocity_x) / tolerance.of_position(end.elongation_x[i])
                + change(|rates| &rates.velocity_z) / tolerance.of_position(end.elongation_z[i])
                + change(|rates| &rates.acceleration_x) / tolerance.of_velocity(end.velocity_x[i] - carrier.u_rate)
                + change(|rates| &rates.acceleration_z) / tolerance.of_velocity(end.velocity_z[i] - carrier.w_rate);
        }
        let error = (sum / end.mode.len() as f64).sqrt();
        // The two stages are nearer to each other than the ends of a step, and the error grows with the square of the
        // step.
        1.0 / (error * (1.0 - GAMMA)).sqrt()
    }

    /// Energies through the channels over the step of two stages of length `h` from `start` tried last, up to its
    /// fraction `theta`.
    pub fn two_stage_energies(&mut self, model: &Model, start: &State, h: f64, theta: f64) -> ChannelEnergies {
        let workspace = &self.two_stages;
        let weights = if theta < 1.0 { &workspace.weights_within.at(theta) } else { SDIRK2.weights() };
        let stages = (&self.stages[..], &self.exchange[..]);
        energy::through(model, &workspace.maxwell, &start.maxwell, stages, (h, weights), self.error_workspace.any())
    }

    /// The Maxwell elements' elongations at the first stage of the step of two stages from `start` tried last, into
    /// `a`.
    pub fn first_stage_maxwell(&self, model: &Model, start: &State, a: &mut [f64]) {
        self.two_stages.maxwell.at_stage(model, 1, (&start.maxwell, &self.stages), a);
    }

    /// The end of the step of two stages tried last, open to changes: state, forces and rates; and the rates at its
    /// first stage.
    pub fn open_end(&mut self) -> (&mut State, &mut Forces, &mut Rates, &Rates) {
        let (earlier, last) = self.stages.split_at_mut(TWO_STAGES - 1);
        (&mut self.solver.state, &mut self.solver.forces, &mut last[0], &earlier[1])
    }

    /// Accepts the step of two stages tried last: its end becomes the start of the next one.
    pub fn accept_two_stages(&mut self, start: &mut StepStart) {
        self.accept_stage(start, TWO_STAGES - 1);
    }

    /// Puts the modes' constraints, after changes at the end of a step just taken, into the tangents.
    pub fn refresh_tangents_after(&mut self, model: &Model, start: &StepStart, s: f64) {
        let forces = &self.solver.forces;
        for tangent in &mut self.tangents {
            tangent.evaluate_rates(model, &start.state, forces, &start.rates.acceleration_x, s);
        }
    }
}
