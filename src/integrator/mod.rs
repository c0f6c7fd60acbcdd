//! The implicit Runge-Kutta method: one step of the layer with its modes held, its error, and what lies within it.

mod dense;
mod energy;
mod error;
mod maxwell;
mod rates;
mod sdirk;
mod stage;
mod tableau;
mod tangent;
mod tolerance;
mod within;

pub use dense::{DenseOutput, DenseWorkspace};
pub use rates::{NO_LIMIT, Rates};
pub use sdirk::{SDIRK2, TWO_STAGES};
pub use stage::NoConvergence;
pub use tableau::{ESDIRK5, Tableau, WeightsWithin};
pub use tolerance::Tolerance;
pub use within::TwoStageDense;

use serde::{Deserialize, Serialize};

use crate::math::weighted_sum;
use crate::model::{Carrier, CarrierPoint, ChannelEnergies, Exchange, Forces, Model, State};
use error::{ErrorTest, ErrorWorkspace};
use maxwell::Maxwell;
use sdirk::TwoStages;
use stage::{Accuracy, StagePoint, StageSolver};
use tangent::{Tangent, Target};

/// The method that the integrator uses.
pub const METHOD: Tableau<7> = ESDIRK5;

/// Number of stages, the explicit one included.
pub const STAGES: usize = METHOD.c.len();

/// The stages of one step, and workspace for them.
#[derive(Clone, Debug)]
pub struct Integrator {
    /// The rates of the stages; those of the first are the rates at the start of the step.
    stages: Vec<Rates>,
    /// The carrier at the stages.
    carrier: [CarrierPoint; STAGES],
    /// The powers through the surface and the carrier at the stages.
    exchange: [Exchange; STAGES],
    maxwell: Maxwell<STAGES>,
    solver: StageSolver,
    error_workspace: ErrorWorkspace,
    predictor: [[f64; STAGES]; STAGES],
    weights_within: WeightsWithin<STAGES>,
    /// The other method, for steps of two stages.
    two_stages: TwoStages,
    accounts_energy: bool,
    /// How the run follows the targets of u and w; empty where nobody asks.
    tangents: Vec<Tangent>,
}

/// The layer at the start of a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepStart {
    /// The state.
    pub state: State,
    /// The rates there.
    pub rates: Rates,
    /// The powers through the surface and the carrier there, W: 0 where no energy is accounted for.
    pub exchange: Exchange,
}

impl StepStart {
    /// A layer of `model` at rest and free.
    pub fn new(model: &Model) -> Self {
        let state = State::new(model.masses(), model.maxwell_variables());
        Self { state, rates: Rates::new(model), exchange: Exchange::default() }
    }

    /// Copies `other`, of the same model, without allocating.
    pub fn copy_from(&mut self, other: &Self) {
        self.state.copy_from(&other.state);
        self.rates.copy_from(&other.rates);
        self.exchange = other.exchange;
    }
}

/// What the steps follow beside the state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tracked {
    /// The powers of the channels.
    pub energy: bool,
    /// The forces' sensitivities to the carrier's targets.
    pub tangents: bool,
}

/// Which steps an integrator has workspace for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Steps {
    /// Steps of [`METHOD`] alone.
    Accurate,
    /// Steps of two stages alone.
    TwoStages,
    /// Both.
    Both,
}

impl Steps {
    fn accurate(self) -> bool {
        self != Self::TwoStages
    }

    fn two_stages(self) -> bool {
        self != Self::Accurate
    }

    /// Stages, the one at the start included.
    fn stages(self) -> usize {
        if self.accurate() { STAGES } else { TWO_STAGES }
    }
}

/// A step that was tried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attempt {
    /// The error estimate over the tolerance: at most 1 for a good step.
    pub error: f64,
    /// What the step did not see of the carrier's motion over the free masses, against the tolerance: of account only
    /// where one of them may touch.
    pub unseen: f64,
}

impl Integrator {
    /// Room for steps of `model`.
    pub fn new(model: &Model, followed: Tracked, steps: Steps) -> Self {
        let targets: &[Target] = if followed.tangents { &[Target::U, Target::W] } else { &[] };
        Self {
            stages: vec![Rates::new(model); steps.stages()],
            carrier: [CarrierPoint::default(); STAGES],
            exchange: [Exchange::default(); STAGES],
            maxwell: if steps.accurate() { Maxwell::new(model) } else { Maxwell::none() },
            solver: StageSolver::new(model),
            error_workspace: ErrorWorkspace::new(model),
            predictor: predictor(&METHOD.c),
            weights_within: WeightsWithin::new(&METHOD),
            two_stages: TwoStages::new(model, steps.two_stages()),
            accounts_energy: followed.energy,
            tangents: targets.iter().map(|&target| Tangent::new(model, target, steps.stages())).collect(),
        }
    }

    /// Newton's iterations since the start.
    pub fn iterations(&self) -> u64 {
        self.solver.iterations
    }

    /// Evaluates the rates and the powers at the start of a step from the `forces` in its state: needed at the start of
    /// a run, after an event and at a kink.
    pub fn evaluate_start(&self, model: &Model, start: &mut StepStart, carrier: &CarrierPoint, forces: &Forces) {
        start.rates.evaluate(model, &start.state, forces);
        if self.accounts_energy {
            start.exchange = Exchange::evaluate(model, &start.state, carrier, forces);
        }
    }

    /// Makes the start of a step its first stage.
    fn begin_step(&mut self, start: &StepStart) {
        self.stages[0].copy_from(&start.rates);
        self.exchange[0] = start.exchange;
    }

    /// Tries a step of length `h` from `start`, `s` seconds after the start of the carrier's piece.
    ///
    /// # Errors
    /// [`NoConvergence`] where a stage could not be solved.
    pub fn attempt(
        &mut self,
        model: &Model,
        start: &StepStart,
        carrier: &Carrier,
        (s, h): (f64, f64),
        tolerance: &Tolerance,
    ) -> Result<Attempt, NoConvergence> {
        let beta = METHOD.gamma() * h;
        let state = &start.state;
        self.begin_step(start);
        self.carrier[0] = carrier.at(s);
        self.solver.begin(model, state, beta);
        self.maxwell.begin(model, &METHOD, &state.maxwell, h);
        for i in 1..STAGES {
            let stage = (i, METHOD.c[i], &METHOD.a[i][..]);
            let point = self.prepare_stage(state, carrier, (s, h), stage, beta);
            self.maxwell.known_forces(i, &self.stages[..i], &mut self.solver.history.force);
            self.predict(state, beta, i);
            self.solve_stage(model, &point, (s, h), stage, Accuracy::new(tolerance, beta, 1.0))?;
        }
        self.maxwell.finish(model, &state.maxwell, &self.stages, &mut self.solver.state.maxwell);
        let test = ErrorTest {
            tableau: &METHOD,
            maxwell: &self.maxwell,
            stages: &self.stages,
            carrier: &self.carrier,
            end: &self.solver.state,
            contacts: self.solver.contacts(),
        };
        Ok(test.error(model, h, tolerance, &mut self.error_workspace))
    }

    /// The motion that the earlier stages of a step of length `h` from `state`, `s` seconds after the start of the
    /// carrier's piece, give to stage `i`, with its place `c` and its weights; and where it stands.
    fn prepare_stage(
        &mut self,
        state: &State,
        carrier: &Carrier,
        (s, h): (f64, f64),
        (i, c, weights): (usize, f64, &[f64]),
        beta: f64,
    ) -> StagePoint {
        let at = carrier.at(s + c * h);
        self.carrier[i] = at;
        self.collect_motion(state, (h, &weights[..i]));
        let driven = self.drive((h, weights), i);
        let moved = carrier.moved(s, c * h).0;
        StagePoint {
            beta,
            carrier: at,
            driven,
            moved,
            profile_position: carrier.profile_position + at.du,
            w: carrier.w + at.dw,
        }
    }

    /// Solves a stage that is prepared, to `accuracy`, and what follows from it.
    fn solve_stage(
        &mut self,
        model: &Model,
        point: &StagePoint,
        (s, h): (f64, f64),
        (i, c, weights): (usize, f64, &[f64]),
        accuracy: Accuracy,
    ) -> Result<(), NoConvergence> {
        self.solver.solve(model, point, accuracy, &mut self.stages[i])?;
        if self.accounts_energy {
            let solver = &self.solver;
            self.exchange[i] = Exchange::evaluate(model, &solver.state, &point.carrier, &solver.forces);
        }
        self.vary(model, point, (s + c * h, h), (i, weights));
        Ok(())
    }

    /// The tangents at the stage just solved, the `i`-th, at `s` in a step of length `h`; the earlier ones have
    /// `weights`.
    fn vary(&mut self, model: &Model, point: &StagePoint, (s, h): (f64, f64), (i, weights): (usize, &[f64])) {
        if self.tangents.is_empty() {
            return;
        }
        self.solver.factor_at_solution(model, point.beta);
        for tangent in &mut self.tangents {
            tangent.collect_history(h, &weights[..i]);
            let carrier = tangent.carrier(s);
            self.solver.vary(model, point, &carrier, tangent, (i, &self.stages[i]));
        }
    }

    /// Whether anybody asks for tangents.
    pub fn has_tangents(&self) -> bool {
        !self.tangents.is_empty()
    }

    /// Begins the tangents of a motion of the carrier of `duration` (s).
    pub fn begin_tangents(&mut self, duration: f64) {
        for tangent in &mut self.tangents {
            tangent.begin(duration);
        }
    }

    /// Computes the tangents' rates at the start of a step afresh, `s` seconds after the start of the carrier's motion.
    pub fn refresh_tangents(&mut self, model: &Model, start: &StepStart, forces: &Forces, s: f64) {
        for tangent in &mut self.tangents {
            tangent.evaluate_rates(model, &start.state, forces, &start.rates.acceleration_x, s);
        }
    }

    /// ∂F_x/∂u, ∂F_x/∂w, ∂F_z/∂u, ∂F_z/∂w by the targets of the motion, `s` seconds after its start, N/m.
    pub fn tangents(&mut self, model: &Model, s: f64) -> [f64; 4] {
        let mut by_target = self.tangents.iter_mut().map(|tangent| tangent.carrier_forces(model, s));
        let (u, w) = (by_target.next().unwrap_or_default(), by_target.next().unwrap_or_default());
        [u.0, w.0, u.1, w.1]
    }

    /// The state at the end of the step tried last.
    pub fn end(&self) -> &State {
        &self.solver.state
    }

    /// The forces at the end of the step tried last.
    pub fn end_forces(&self) -> &Forces {
        &self.solver.forces
    }

    /// Bytes that the stages hold, those to go back to included.
    pub fn bytes(&self) -> usize {
        let rates = &self.stages[0];
        let masses = rates.velocity_x.len();
        let links: usize = rates.elongation_rate.iter().map(Vec::len).sum();
        let stages = self.stages.len() + 1;
        // By mass: the rates and the starred values; five blocks and a right side; a row, a column and a slip; errors.
        let by_mass = stages * 6 + 4 + (5 * 4 + 2) + (3 + 3 + 11) + 5;
        let elements = 2 * (self.maxwell.floats() + self.two_stages.floats());
        let tangents: usize = self.tangents.iter().map(Tangent::floats).sum();
        (by_mass * masses + stages * links + elements + tangents) * size_of::<f64>()
    }

    /// The rates at the stages of the step tried last.
    pub fn stages(&self) -> &[Rates] {
        &self.stages
    }

    /// The step of length `h` from `start`, `s` seconds after the start of the carrier's piece, that was tried last,
    /// seen from within.
    pub fn dense<'a>(
        &'a self,
        model: &'a Model,
        carrier: &'a Carrier,
        start: &'a StepStart,
        (s, h): (f64, f64),
    ) -> DenseOutput<'a> {
        let carriers = [self.carrier[0], self.carrier[STAGES - 1]];
        let end = (self.end(), &self.stages[STAGES - 1]);
        DenseOutput { model, carrier, s, h, carriers, start: (&start.state, &start.rates), end }
    }

    /// Energies through the channels over the step of length `h` from `start` tried last, up to its fraction `theta`.
    pub fn energies(&mut self, model: &Model, start: &State, h: f64, theta: f64) -> ChannelEnergies {
        let weights = if theta < 1.0 { &self.weights_within.at(theta) } else { METHOD.weights() };
        let stages = (&self.stages[..], &self.exchange[..]);
        energy::through(model, &self.maxwell, &start.maxwell, stages, (h, weights), self.error_workspace.any())
    }

    /// Accepts the step tried last: its end becomes the start of the next one.
    pub fn accept(&mut self, start: &mut StepStart) {
        self.accept_stage(start, STAGES - 1);
    }

    /// Takes the step tried last, which ended with stage `last`.
    fn accept_stage(&mut self, start: &mut StepStart, last: usize) {
        std::mem::swap(&mut start.state, &mut self.solver.state);
        std::mem::swap(&mut start.rates, &mut self.stages[last]);
        start.exchange = self.exchange[last];
        for tangent in &mut self.tangents {
            tangent.accept(last);
        }
    }

    /// The starred values: what the earlier stages of a step of length `h`, with these weights, give to a stage.
    fn collect_motion(&mut self, state: &State, (h, weights): (f64, &[f64])) {
        let history = &mut self.solver.history;
        let earlier = &self.stages;
        let sum = |star: &mut [f64], start: &[f64], rate: fn(&Rates) -> &[f64]| {
            let counting = earlier.iter().zip(weights).filter(|(_, weight)| **weight != 0.0);
            let terms = counting.map(|(stage, weight)| (h * weight, rate(stage)));
            weighted_sum(star, std::iter::once((1.0, start)).chain(terms));
        };
        sum(&mut history.elongation_x, &state.elongation_x, |stage| &stage.velocity_x);
        sum(&mut history.elongation_z, &state.elongation_z, |stage| &stage.velocity_z);
        sum(&mut history.velocity_x, &state.velocity_x, |stage| &stage.acceleration_x);
        sum(&mut history.velocity_z, &state.velocity_z, |stage| &stage.acceleration_z);
    }

    /// How far stage `i` takes the carrier to have moved, along x and z, m: by the method's own quadrature of its rate.
    ///
    /// So the elongations are integrated as the differences that they are, ė = ẋ - u̇, and the velocities against the
    /// carrier's, with -ü as a load: a carrier that swings far leaves no error in a layer that swings with it. The
    /// starred velocities take over what the quadrature of ü misses of u̇.
    fn drive(&mut self, (h, weights): (f64, &[f64]), i: usize) -> (f64, f64) {
        let (mut moved, mut missed) = ((0.0, 0.0), (0.0, 0.0));
        for (at, weight) in self.carrier[..=i].iter().zip(weights) {
            let step = h * weight;
            moved = (moved.0 + step * at.u_rate, moved.1 + step * at.w_rate);
            missed = (missed.0 + step * at.u_acceleration, missed.1 + step * at.w_acceleration);
        }
        let (start, here) = (&self.carrier[0], &self.carrier[i]);
        let history = &mut self.solver.history;
        let by_x = here.u_rate - start.u_rate - missed.0;
        let by_z = here.w_rate - start.w_rate - missed.1;
        // Along straight paths there is nothing to take over.
        for (star, by) in [(&mut history.velocity_x, by_x), (&mut history.velocity_z, by_z)] {
            if by != 0.0 {
                star.iter_mut().for_each(|star| *star += by);
            }
        }
        moved
    }

    /// The velocities from which Newton's iterations start. For slipping masses the accelerations of the earlier stages
    /// are extrapolated; free ones, whose equations are linear, start where they were, since a guess far off costs
    /// digits.
    fn predict(&mut self, start: &State, beta: f64, i: usize) {
        let solver = &mut self.solver;
        solver.state.velocity_x.copy_from_slice(&start.velocity_x);
        solver.state.velocity_z.copy_from_slice(&start.velocity_z);
        let earlier = self.stages[..i].iter().zip(&self.predictor[i]).filter(|(_, weight)| **weight != 0.0);
        for mass in 0..start.mode.len() {
            if start.mode[mass].slips() {
                let acceleration: f64 =
                    earlier.clone().map(|(stage, weight)| weight * stage.acceleration_x[mass]).sum();
                solver.state.velocity_x[mass] = solver.history.velocity_x[mass] + beta * acceleration;
            }
        }
    }
}

/// Weights that extrapolate from the earlier stages to each stage: Lagrange's through the latest three of distinct
/// place.
fn predictor(c: &[f64; STAGES]) -> [[f64; STAGES]; STAGES] {
    let mut weights = [[0.0; STAGES]; STAGES];
    for i in 1..STAGES {
        let nodes = i.saturating_sub(3)..i;
        for j in nodes.clone() {
            weights[i][j] = nodes.clone().filter(|&m| m != j).map(|m| (c[i] - c[m]) / (c[j] - c[m])).product();
        }
    }
    weights
}
