//! The implicit Runge-Kutta method: one step of the layer with its modes held, its error, and what lies within it.

mod dense;
mod rates;
mod stage;
mod tableau;
mod tangent;
mod tolerance;

pub use dense::Dense;
pub use rates::Rates;
pub use stage::NoConvergence;
pub use tableau::{ESDIRK5, Tableau};
pub use tolerance::Tolerance;

use crate::model::{Carrier, CarrierPoint, Forces, LinkKind, Mode, Model, Power, State};
use stage::{StagePoint, StageSolver};
use tangent::{Tangent, Target};

/// The method that the integrator uses.
pub const METHOD: Tableau<7> = ESDIRK5;

/// Number of stages, the explicit one included.
pub const STAGES: usize = METHOD.c.len();

/// The stages of one step, and room for them.
#[derive(Clone, Debug)]
pub struct Integrator {
    /// The rates of the stages; those of the first are the rates at the start of the step.
    stages: Vec<Rates>,
    /// The powers of the stages.
    powers: [Power; STAGES],
    solver: StageSolver,
    predictor: [[f64; STAGES]; STAGES],
    accounts_energy: bool,
    /// How the run follows the targets of u and w; empty where nobody asks.
    tangents: Vec<Tangent>,
}

/// What the steps follow beside the state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Followed {
    /// The powers of the channels.
    pub energy: bool,
    /// The forces' sensitivities to the carrier's targets.
    pub tangents: bool,
}

/// A step that was tried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attempt {
    /// The error estimate over the tolerance: at most 1 for a good step.
    pub error: f64,
    /// The error estimate of F_z, N.
    pub force_error: f64,
}

impl Integrator {
    /// Room for steps of `model`.
    pub fn new(model: &Model, followed: Followed) -> Self {
        let targets: &[Target] = if followed.tangents { &[Target::U, Target::W] } else { &[] };
        Self {
            stages: vec![Rates::new(model); STAGES],
            powers: [Power::default(); STAGES],
            solver: StageSolver::new(model),
            predictor: predictor(&METHOD.c),
            accounts_energy: followed.energy,
            tangents: targets.iter().map(|&target| Tangent::new(model, target)).collect(),
        }
    }

    /// The rates at the start of the step.
    pub fn start_rates(&self) -> &Rates {
        &self.stages[0]
    }

    /// Puts back the rates at the start of a step.
    pub fn restore(&mut self, rates: &Rates, power: Power) {
        self.stages[0].copy_from(rates);
        self.powers[0] = power;
    }

    /// The powers at the start of the step.
    pub fn start_power(&self) -> Power {
        self.powers[0]
    }

    /// Newton's iterations since the start.
    pub fn iterations(&self) -> u64 {
        self.solver.iterations
    }

    /// Computes the rates at the start of a step afresh, from the forces in `state`: needed at the start, after an event
    /// and at a kink.
    pub fn begin(&mut self, model: &Model, state: &State, carrier: &CarrierPoint, forces: &Forces) {
        self.stages[0].evaluate(model, state, forces);
        if self.accounts_energy {
            self.powers[0] = Power::evaluate(model, state, carrier, forces);
        }
    }

    /// Tries a step of length `h` from `state`, `s` seconds after the start of the carrier's piece.
    ///
    /// # Errors
    /// [`NoConvergence`] where a stage could not be solved.
    pub fn attempt(
        &mut self,
        model: &Model,
        state: &State,
        carrier: &Carrier,
        (s, h): (f64, f64),
        tolerance: &Tolerance,
    ) -> Result<Attempt, NoConvergence> {
        self.solver.state.mode.copy_from_slice(&state.mode);
        self.solver.state.ground.copy_from_slice(&state.ground);
        for i in 1..STAGES {
            let at = carrier.at(s + METHOD.c[i] * h);
            self.collect_history(state, h, i, carrier.moved(s, METHOD.c[i] * h));
            self.predict(state, h, i);
            let point = StagePoint {
                beta: METHOD.gamma() * h,
                carrier: at,
                place: carrier.place + at.du,
                w: carrier.w + at.dw,
            };
            self.solver.solve(model, &point, tolerance.newton(point.beta), &mut self.stages[i])?;
            if self.accounts_energy {
                self.powers[i] = Power::evaluate(model, &self.solver.state, &at, &self.solver.forces);
            }
            self.vary(model, &point, (s, h), i);
        }
        Ok(self.error(model, carrier, (s, h), tolerance))
    }

    /// The tangents at a stage just solved.
    fn vary(&mut self, model: &Model, point: &StagePoint, (s, h): (f64, f64), i: usize) {
        if self.tangents.is_empty() {
            return;
        }
        self.solver.factor_at_solution(model, point.beta);
        for tangent in &mut self.tangents {
            tangent.collect_history(h, i);
            let carrier = tangent.carrier(s + METHOD.c[i] * h);
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
    pub fn refresh_tangents(&mut self, model: &Model, state: &State, forces: &Forces, s: f64) {
        for tangent in &mut self.tangents {
            tangent.evaluate_rates(model, state, forces, &self.stages[0].acceleration_x, s);
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

    /// F_z at the end of the step tried last, N.
    pub fn end_force_z(&self) -> f64 {
        self.solver.forces.on_carrier_z()
    }

    /// Bytes that the stages hold, those to go back to included.
    pub fn bytes(&self) -> usize {
        let rates = &self.stages[0];
        let masses = rates.velocity_x.len();
        let by_link: usize = rates.maxwell_force.iter().map(Vec::len).sum();
        let floats = (STAGES + 1) * (6 * masses + rates.maxwell.len() + by_link);
        // The starred values, and three blocks, a right side and a climb a mass.
        let solver = 4 * masses + rates.maxwell.len() + by_link + (3 * 4 + 2 + 2) * masses;
        (floats + solver) * size_of::<f64>()
    }

    /// The rates at the stages of the step tried last.
    pub fn stages(&self) -> &[Rates] {
        &self.stages
    }

    /// Energies through the channels over the step of length `h` tried last.
    pub fn energies(&self, h: f64) -> Power {
        let mut sum = Power::default();
        for (weight, power) in METHOD.weights().iter().zip(&self.powers) {
            sum.add(h * weight, power);
        }
        sum
    }

    /// Takes the step tried last: `state` becomes its end, and the rates there those at the start of the next step.
    pub fn accept(&mut self, state: &mut State) {
        std::mem::swap(state, &mut self.solver.state);
        self.stages.swap(0, STAGES - 1);
        self.powers.swap(0, STAGES - 1);
        for tangent in &mut self.tangents {
            tangent.accept();
        }
    }

    /// The starred values of stage `i`: what the earlier stages give.
    fn collect_history(&mut self, state: &State, h: f64, i: usize, (du, dw): (f64, f64)) {
        let history = &mut self.solver.history;
        let earlier = &self.stages[..i];
        let weights = &METHOD.a[i];
        for (star, e) in history.elongation_x.iter_mut().zip(&state.elongation_x) {
            *star = e - du;
        }
        for (star, e) in history.elongation_z.iter_mut().zip(&state.elongation_z) {
            *star = e - dw;
        }
        history.velocity_x.copy_from_slice(&state.velocity_x);
        history.velocity_z.copy_from_slice(&state.velocity_z);
        for (stage, weight) in earlier.iter().zip(weights) {
            let step = h * weight;
            add(&mut history.elongation_x, step, &stage.velocity_x);
            add(&mut history.elongation_z, step, &stage.velocity_z);
            add(&mut history.velocity_x, step, &stage.acceleration_x);
            add(&mut history.velocity_z, step, &stage.acceleration_z);
        }
        // Row by row, so that the sum stays in the nearest cache whatever the number of elements.
        for start in (0..history.maxwell.len()).step_by(HISTORY_CHUNK) {
            let range = start..(start + HISTORY_CHUNK).min(history.maxwell.len());
            let star = &mut history.maxwell[range.clone()];
            star.copy_from_slice(&state.maxwell[range.clone()]);
            for (stage, weight) in earlier.iter().zip(weights) {
                add(star, h * weight, &stage.maxwell[range.clone()]);
            }
        }
    }

    /// The velocities from which Newton's iterations start. For slipping masses the accelerations of the earlier stages are
    /// extrapolated; free ones, whose equations are linear, start where they were, since a guess far off costs digits.
    fn predict(&mut self, start: &State, h: f64, i: usize) {
        let beta = METHOD.gamma() * h;
        let state = &mut self.solver.state;
        state.velocity_x.copy_from_slice(&start.velocity_x);
        state.velocity_z.copy_from_slice(&start.velocity_z);
        let earlier = self.stages[..i].iter().zip(&self.predictor[i]);
        for mass in (0..start.mode.len()).filter(|&mass| start.mode[mass].slips()) {
            let acceleration: f64 = earlier.clone().map(|(stage, weight)| weight * stage.acceleration_x[mass]).sum();
            state.velocity_x[mass] = self.solver.history.velocity_x[mass] + beta * acceleration;
        }
    }

    /// The embedded estimate in the tolerance's norm, and of F_z.
    ///
    /// The carrier's displacement is known, not integrated; yet a step must be able to see it: the dense output, the
    /// events between the stages and the energies do. So what the method would miss of it counts as an error too: where
    /// every mass sticks, there is no other.
    fn error(&self, model: &Model, carrier: &Carrier, (s, h): (f64, f64), tolerance: &Tolerance) -> Attempt {
        let rates = carrier.at(s + h);
        let end = &self.solver.state;
        let vertical = &model.links[LinkKind::Vertical as usize];
        let (u, w) = carrier_error(carrier, (s, h));
        let (mut sum, mut force_error) = (0.0, 0.0);
        for i in 0..model.masses() {
            let of = |component: fn(&Rates) -> &Vec<f64>| h * self.weighed(|stage| component(stage)[i]);
            let (x, v_x) = (of(|r| &r.velocity_x), of(|r| &r.acceleration_x));
            let (z, v_z) = match end.mode[i] {
                Mode::Free => (of(|r| &r.velocity_z), of(|r| &r.acceleration_z)),
                _ => (end.ground[i].slope * x, end.ground[i].slope * v_x),
            };
            sum += tolerance.position(x, end.elongation_x[i]) + tolerance.position(z, end.elongation_z[i]);
            sum += tolerance.position(u, end.elongation_x[i]) + tolerance.position(w, end.elongation_z[i]);
            sum += tolerance.velocity(v_x, end.velocity_x[i] - rates.u_rate);
            sum += tolerance.velocity(v_z, end.velocity_z[i] - rates.w_rate);
            force_error += vertical.stiffness * z + vertical.damping * v_z;
        }
        for kind in LinkKind::ALL {
            let elongation = if kind.is_along_x() { &end.elongation_x } else { &end.elongation_z };
            for i in 0..self.stages[0].maxwell_force[kind as usize].len() {
                let force = h * self.weighed(|stage| stage.maxwell_force[kind as usize][i]);
                let e = if kind.is_lateral() { elongation[i + 1] - elongation[i] } else { elongation[i] };
                sum += tolerance.maxwell(kind, force, e);
                if kind == LinkKind::Vertical {
                    force_error += force;
                }
            }
        }
        Attempt { error: (sum / model.masses() as f64).sqrt(), force_error }
    }

    /// Σ (b_i - b̂_i) of a quantity of the stages.
    #[inline]
    fn weighed(&self, quantity: impl Fn(&Rates) -> f64) -> f64 {
        self.stages.iter().zip(&METHOD.error).map(|(stage, weight)| weight * quantity(stage)).sum()
    }
}

/// The embedded estimate of u and w, as if their rates were integrated, m.
fn carrier_error(carrier: &Carrier, (s, h): (f64, f64)) -> (f64, f64) {
    let stages = METHOD.c.iter().zip(&METHOD.error).map(|(c, weight)| (carrier.at(s + c * h), h * weight));
    stages.fold((0.0, 0.0), |(u, w), (at, weight)| (u + weight * at.u_rate, w + weight * at.w_rate))
}

/// Maxwell variables whose history is summed at a time: 16 KiB of sums.
const HISTORY_CHUNK: usize = 2048;

/// sum += factor · term.
#[inline]
fn add(sum: &mut [f64], factor: f64, term: &[f64]) {
    if factor == 0.0 {
        return;
    }
    for (sum, term) in sum.iter_mut().zip(term) {
        *sum += factor * term;
    }
}

/// Weights that extrapolate from the earlier stages to each stage: Lagrange's through the latest three of distinct place.
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
