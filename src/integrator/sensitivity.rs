//! Forward sensitivities of the run to the carrier's targets, along the stages of the steps (docs/theory.md, section
//! 8).
//!
//! Over a motion of the carrier of duration T, let one of its displacements, or of the forces on it, end at û + ε
//! instead of û. On the way it differs by ε s/T, and its rate by ε/T. All quantities here are derivatives with respect
//! to ε at ε = 0, with the contact modes held. At a stage they solve the same linear system as Newton's corrections,
//! with another right side.

use nalgebra::Vector2;

use super::heat::StageHeat;
use super::stage::{SlipVariation, SlippingMass, StagePoint, StageSolver};
use super::stage_values::StageValues;
use crate::model::{
    Axis, ByAxis, DrivenBody, Forces, Input, LinkKind, LinkMotion, MaxwellRow, Mode, Model, SlipFriction, SlipHistory,
    SpatialMeasure, SpeedMemory, State, SurfacePoint, TangentsOf,
};

/// The variation of the layer's state: dimensionless for positions, 1/s for velocities. Or its rate of change, each
/// part that of the part of the state.
#[derive(Clone, Debug)]
struct Variation {
    /// Of the displacements ξ_i, in the inertial frame.
    x: Vec<f64>,
    /// Of the displacements ζ_i.
    z: Vec<f64>,
    /// Of ẋ_i.
    v_x: Vec<f64>,
    /// Of ż_i.
    v_z: Vec<f64>,
    /// Of the elongations a_j of the Maxwell elements.
    maxwell: Vec<f64>,
    /// Of the remembered speeds.
    memory: Vec<f64>,
    /// Of the parts ϑ_j of the flash temperatures, K; no rate of them is needed.
    flash: Vec<f64>,
    /// Of the displacements and speeds of the bodies along x and z.
    bodies: CarrierVariation,
}

/// The variation of the carrier at one instant: of its displacements and speeds along x and z.
type CarrierVariation = ByAxis<[f64; 2]>;

/// The derivative of a run with respect to the target of one input.
#[derive(Clone, Debug)]
pub(super) struct Sensitivity {
    input: Input,
    /// Duration of the carrier's motion, s.
    duration: f64,
    /// At the start of the step.
    start: Variation,
    /// At the stage, and so at the end of the step; before a stage is solved, the contribution of the earlier ones.
    end: Variation,
    /// The rates at the stages.
    stages: Vec<Variation>,
    /// The variations of the heat fluxes at the stages, W/m²; empty where friction heats nothing.
    heat_fluxes: Vec<Vec<f64>>,
    /// The variation of what is known of the flash temperatures at the stage, K; likewise.
    known_flash: Vec<f64>,
    links: LinkVariation,
}

/// The variation of the forces of the links, and workspace for that of their motion.
#[derive(Clone, Debug)]
struct LinkVariation {
    forces: Forces,
    /// Positions relative to the carrier, and velocities where they are not those of the state; no elements.
    motion: Variation,
    /// What links in spatial measure are measured by at the instant of the last evaluation.
    measure: Option<Box<SpatialMeasure>>,
    /// The variations of twice their energies, J.
    energies: [Vec<f64>; 2],
}

impl Variation {
    fn new(model: &Model) -> Self {
        let zero = vec![0.0; model.masses()];
        let [maxwell, memory, flash] = [model.maxwell_variables(), model.memory_variables(), model.flash_variables()]
            .map(|count| vec![0.0; count]);
        let (x, z, v_x) = (zero.clone(), zero.clone(), zero.clone());
        Self { x, z, v_x, v_z: zero, maxwell, memory, flash, bodies: ByAxis::default() }
    }

    fn parts(&self) -> [&[f64]; 6] {
        [&self.x, &self.z, &self.v_x, &self.v_z, &self.maxwell, &self.memory]
    }

    fn parts_mut(&mut self) -> [&mut [f64]; 6] {
        [&mut self.x, &mut self.z, &mut self.v_x, &mut self.v_z, &mut self.maxwell, &mut self.memory]
    }

    /// The motion of the links of masses that move so relative to the carrier, whose speeds are varied, too.
    fn links(&self, carrier: &CarrierVariation) -> LinkMotion<'_> {
        LinkMotion {
            elongation: ByAxis { x: &self.x, z: &self.z },
            velocity: ByAxis { x: &self.v_x, z: &self.v_z },
            carrier_rate: carrier.map(|[_, rate]| rate),
            ends: Default::default(),
        }
    }
}

impl Sensitivity {
    pub(super) fn new(model: &Model, input: Input, stages: usize) -> Self {
        let heated = if model.flash.is_some() { model.masses() } else { 0 };
        Self {
            input,
            duration: 1.0,
            start: Variation::new(model),
            end: Variation::new(model),
            stages: vec![Variation::new(model); stages],
            heat_fluxes: vec![vec![0.0; heated]; stages],
            known_flash: vec![0.0; heated],
            links: LinkVariation::new(model),
        }
    }

    /// Begins a motion of the carrier of `duration` (s). The present state does not depend on its target.
    pub(super) fn begin(&mut self, duration: f64) {
        self.duration = duration;
        for part in self.start.parts_mut() {
            part.fill(0.0);
        }
        self.start.flash.fill(0.0);
        self.start.bodies = ByAxis::default();
    }

    /// The carrier's variation `s` seconds after the start of its motion, with `bodies` the displacements and speeds of
    /// bodies.
    fn carrier(&self, model: &Model, s: f64, bodies: &CarrierVariation) -> CarrierVariation {
        let driven = self.input.axis().filter(|_| self.input.is_displacement());
        ByAxis::from_fn(|axis| match model.bodies[axis] {
            Some(_) => bodies[axis],
            None if driven == Some(axis) => self.ramp(s),
            None => [0.0; 2],
        })
    }

    /// The variation of the input `s` seconds after the start of the motion, and its rate, 1/s.
    fn ramp(&self, s: f64) -> [f64; 2] {
        [s / self.duration, 1.0 / self.duration]
    }

    /// The variation of what acts from outside on the body along `axis`, displaced and moving as given.
    fn on_body(&self, body: &DrivenBody, axis: Axis, s: f64, [displacement, rate]: [f64; 2]) -> f64 {
        let [input, input_rate] = if self.input.axis() == Some(axis) { self.ramp(s) } else { [0.0; 2] };
        let (drive, drive_rate, force) = match self.input {
            Input::U | Input::W => (input, input_rate, 0.0),
            Input::Load => (0.0, 0.0, -input),
            Input::Pull => (0.0, 0.0, input),
            Input::Temperature => (0.0, 0.0, 0.0),
        };
        force - body.stiffness * (displacement - drive) - body.damping * (rate - drive_rate)
    }

    /// Writes the contribution of the earlier stages, with these weights, in a step of length `h` to `end`.
    fn collect_history(&mut self, h: f64, weights: &[f64]) {
        // The starred values of [1], varied: δy* = δy_0 + h Σ_{j<i} a_ij δẏ_j.
        for (end, start) in self.end.parts_mut().into_iter().zip(self.start.parts()) {
            end.copy_from_slice(start);
        }
        for (stage, weight) in self.stages.iter().zip(weights) {
            for (sum, term) in self.end.parts_mut().into_iter().zip(stage.parts()) {
                add(sum, h * weight, term);
            }
        }
        // Alike of the bodies, whose displacements and speeds are states, too.
        self.end.bodies = self.start.bodies;
        for (stage, weight) in self.stages.iter().zip(weights) {
            for axis in Axis::ALL {
                let (sums, rates) = (&mut self.end.bodies[axis], stage.bodies[axis]);
                sums.iter_mut().zip(rates).for_each(|(sum, rate)| *sum += h * weight * rate);
            }
        }
    }

    /// Puts the constraints of the contact modes into the variation at the start of a step, `s` seconds after the start
    /// of the motion, and computes its rates there. The carrier is at `profile_position`, m.
    pub(super) fn evaluate_rates(
        &mut self,
        model: &Model,
        state: &State,
        forces: &Forces,
        accelerations: &[f64],
        (s, profile_position): (f64, f64),
    ) {
        let carrier = self.carrier(model, s, &self.start.bodies);
        // Masses in contact stay on the profile, sticking ones where they are.
        for i in 0..model.masses() {
            if let Some(mass) = Constrained::new(state, i, self.start.x[i], self.start.v_x[i]) {
                (self.start.z[i], self.start.v_x[i], self.start.v_z[i]) = (mass.z, mass.v_x, mass.v_z);
            }
        }
        self.links.evaluate(model, &self.start, &carrier, Some((forces, state)));
        // All of δϑ is known at the start: the sum of its parts.
        for i in 0..self.known_flash.len() {
            self.known_flash[i] = self.start.flash.iter().skip(i).step_by(model.masses()).sum();
        }
        self.set_mass_rates(model, state, forces, accelerations);
        for i in 0..self.known_flash.len() {
            self.heat_fluxes[0][i] = self.heat_flux(model, state, forces, i, &state.history(i), &self.start);
        }
        // δv̇_s = (v_t δv_t - v_s δv_s)/D.
        if let Some(way) = model.friction.memory {
            for i in 0..model.masses() {
                let driven = v_t_varied(model, state, profile_position, i, &self.start);
                let remembered = state.memory[i] * self.start.memory[i];
                self.stages[0].memory[i] = (driven - remembered) / way;
            }
        }
        // δ of M U̇ = ΣF_i plus what acts from outside, the equation of motion behind [21].
        for axis in Axis::ALL {
            let Some(body) = &model.bodies[axis] else { continue };
            let motion = self.start.bodies[axis];
            let acceleration = (self.links.forces.on_carrier(axis) + self.on_body(body, axis, s, motion)) / body.mass;
            self.stages[0].bodies[axis] = [motion[1], acceleration];
        }
        // δȧ_j = δė - δa_j/τ_j of the Maxwell elements.
        for row in &model.rows {
            let start = self.start.maxwell[row.range.clone()].iter().zip(&self.links.forces.rate[row.kind]);
            for (rate, (a, elongation_rate)) in self.stages[0].maxwell[row.range.clone()].iter_mut().zip(start) {
                *rate = elongation_rate - a / row.relaxation_time;
            }
        }
    }

    /// Computes the rates of the masses at the start of a step from the variations of the state and of the forces there.
    fn set_mass_rates(&mut self, model: &Model, state: &State, forces: &Forces, accelerations: &[f64]) {
        for i in 0..model.masses() {
            let on_mass = self.links.forces.on_mass(i);
            let (x, v_x) = (self.start.x[i], self.start.v_x[i]);
            let a_x = match state.mode[i] {
                // m δẍ = δf_x.
                Mode::Free => on_mass.x / model.mass,
                Mode::Stick => 0.0,
                // m q² δẍ by all that [6] has in it.
                Mode::Forward | Mode::Backward => {
                    let history = state.history(i);
                    let (slip, friction) =
                        SlippingMass::from_state(model, state, forces, i, accelerations[i], &history);
                    let by = SlipVariation { x, velocity: v_x, forces: on_mass };
                    let of_past = self.of_past(i, &friction, &self.start);
                    slip.variation(model, forces.on_mass(i), &by, &friction, of_past) / (model.mass * slip.q2())
                }
            };
            let rates = &mut self.stages[0];
            (rates.x[i], rates.z[i], rates.v_x[i]) = (v_x, self.start.v_z[i], a_x);
            // Of contacts it is not used: their ż follows from ẋ.
            rates.v_z[i] = on_mass.z / model.mass;
        }
    }

    /// The input whose target is varied.
    pub(super) fn input(&self) -> Input {
        self.input
    }

    /// The derivatives at the start of the next step, `s` seconds after the start of the motion.
    pub(super) fn tangents(&mut self, model: &Model, s: f64) -> TangentsOf {
        let carrier = self.carrier(model, s, &self.start.bodies);
        self.links.evaluate(model, &self.start, &carrier, None);
        TangentsOf { force: ByAxis::from_fn(|axis| self.links.forces.on_carrier(axis)), body: self.start.bodies }
    }

    /// Accepts the last attempted step, which ended with stage `last`.
    pub(super) fn accept(&mut self, last: usize) {
        std::mem::swap(&mut self.start, &mut self.end);
        self.stages.swap(0, last);
        self.heat_fluxes.swap(0, last);
    }

    /// Solves stage `i` of a step of length `h` (s) for the tangent: into `end` and the rates of the stage. The
    /// `solver` has solved the stage itself, which lies `s` seconds after the start of the motion and has these
    /// `rates`, and has factored its matrix there; `weights` are those of the earlier stages.
    pub(super) fn solve_stage(&mut self, model: &Model, solver: &mut StageSolver, stage: &Solved<'_>) {
        let &Solved { i, s, h, weights, rates, point, heat } = stage;
        // The starred values, and δϑ as far as the stages before determine it, [26].
        self.collect_history(h, &weights[..i]);
        heat.vary(i, &self.start.flash, &self.heat_fluxes[..i], &mut self.known_flash);
        // δf at δv = 0 of [16]; the known part of a body's motion is that without its speed, an unknown.
        let known = self.end.bodies.map(|[displacement, _]| [displacement, 0.0]);
        let carrier = self.carrier(model, s, &known);
        self.links.evaluate_known(model, solver, point.beta, &self.end, &carrier);
        for i in 0..model.masses() {
            solver.system.right[i] = self.right_side(model, solver, i, point.beta, rates.acceleration_x[i]);
        }
        // The border [22]: [21] varied, its unknown δU not.
        for axis in Axis::ALL {
            if let Some(body) = &model.bodies[axis] {
                let history = self.end.bodies[axis];
                let outside = self.on_body(body, axis, s, [history[0], 0.0]) + body.mass / point.beta * history[1];
                solver.set_border_right(axis, &self.links.forces, outside);
            }
        }
        // J of the stage's own solution serves: from δv all else follows, as in the stage itself.
        let found = solver.solve_bordered();
        for axis in Axis::ALL {
            self.set_body(axis, found[axis as usize], point.beta, i);
        }
        self.set_masses(model, solver, point.beta, i);
        self.set_elements(model, point.beta, &self.carrier(model, s, &self.end.bodies), i);
        // The friction of this stage enters δϑ of those behind it, and of the end.
        if !self.known_flash.is_empty() {
            self.set_heat(model, solver, s, i);
            if heat.ends_with(i) {
                let fluxes = self.heat_fluxes.iter().map(Vec::as_slice);
                heat.at_end(&self.start.flash, fluxes, &mut self.end.flash);
            }
        }
        self.set_memory(model, solver, point, i);
    }

    /// What friction changes by with the past of mass `i`, N, for the variation `of` the state in which the remembered
    /// speeds are varied as far as they are known.
    fn of_past(&self, i: usize, friction: &SlipFriction, of: &Variation) -> f64 {
        let by = |derivative: f64, known: &[f64]| known.get(i).map_or(0.0, |known| derivative * known);
        by(friction.by_flash, &self.known_flash) + by(friction.by_memory, &of.memory)
    }

    /// Computes the variations of the remembered speeds at stage `stage` from those of the masses.
    fn set_memory(&mut self, model: &Model, solver: &StageSolver, point: &StagePoint, stage: usize) {
        for i in 0..model.memory_variables() {
            let Some(SpeedMemory { weight, .. }) = solver.memory.of_mass(i) else { continue };
            // v_s + a v_s² = b + a v_t² varied.
            let (state, known) = (&solver.state, self.end.memory[i]);
            let driven = 2.0 * weight * v_t_varied(model, state, point.profile_position(), i, &self.end);
            self.end.memory[i] = (known + driven) / (1.0 + 2.0 * weight * state.memory[i]);
            self.stages[stage].memory[i] = (self.end.memory[i] - known) / point.beta;
        }
    }

    /// Computes the variations of the heat fluxes at stage `stage` from those of the state.
    fn set_heat(&mut self, model: &Model, solver: &StageSolver, s: f64, stage: usize) {
        // δf at the solution; the forces were those of the known part.
        let carrier = self.carrier(model, s, &self.end.bodies);
        self.links.evaluate(model, &self.end, &carrier, Some((&solver.forces, &solver.state)));
        for i in 0..model.masses() {
            let history = solver.slip_history(i);
            self.heat_fluxes[stage][i] = self.heat_flux(model, &solver.state, &solver.forces, i, &history, &self.end);
        }
    }

    /// The variation of the heat flux F_T v_t/A of mass `i`, W/m², for the variation `of` the state and those of the
    /// links' forces: δF_T = ∂T/∂F_N δF_N + ∂T/∂v_t δv_t + ∂T/∂ϑ δϑ.
    fn heat_flux(
        &self,
        model: &Model,
        state: &State,
        forces: &Forces,
        i: usize,
        history: &SlipHistory,
        of: &Variation,
    ) -> f64 {
        let mode = state.mode[i];
        if !mode.slips() {
            return 0.0;
        }
        let (slip, friction) = SlippingMass::from_state(model, state, forces, i, 0.0, history);
        // δF_N and δv_t by the motion along the profile and by δf.
        let by = SlipVariation { x: of.x[i], velocity: of.v_x[i], forces: self.links.forces.on_mass(i) };
        let contact = slip.contact_variation(model.mass, forces.on_mass(i), &by);
        let change = friction.by_normal * contact.normal
            + friction.by_speed * mode.direction() * contact.speed
            + self.of_past(i, &friction, of);
        // δQ = (v_t δT + T δv_t)/A, with v_t in the direction of slip.
        let v_t = mode.direction() * slip.speed();
        (change * v_t + friction.force() * mode.direction() * contact.speed) / model.element_area
    }

    /// Takes the variation of a body at stage `stage` from its speed `found`.
    fn set_body(&mut self, axis: Axis, found: f64, beta: f64, stage: usize) {
        // [1]: δU̇ = (δU - δU*)/β, and the displacement is its starred value plus β δU.
        let [displacement, rate] = &mut self.end.bodies[axis];
        self.stages[stage].bodies[axis] = [found, (found - *rate) / beta];
        (*displacement, *rate) = (*displacement + beta * found, found);
    }

    /// The right side of the linear system for mass `i`, whose ẍ is `acceleration`.
    fn right_side(&self, model: &Model, solver: &StageSolver, i: usize, beta: f64, acceleration: f64) -> Vector2<f64> {
        let inertia = model.mass / beta;
        let on_mass = self.links.forces.on_mass(i);
        let (v_x, v_z) = (self.end.v_x[i], self.end.v_z[i]);
        match solver.state.mode[i] {
            // The first line of [16].
            Mode::Free => Vector2::new(on_mass.x + inertia * v_x, on_mass.z + inertia * v_z),
            // δẋ = 0.
            Mode::Stick => Vector2::zeros(),
            // The second line: -δR with δẋ = 0, in which ẍ is varied by δẋ* alone.
            Mode::Forward | Mode::Backward => {
                let history = solver.slip_history(i);
                let (slip, friction) =
                    SlippingMass::from_state(model, &solver.state, &solver.forces, i, acceleration, &history);
                let by = SlipVariation { x: self.end.x[i], velocity: 0.0, forces: on_mass };
                let of_past = self.of_past(i, &friction, &self.end);
                let varied = slip.variation(model, solver.forces.on_mass(i), &by, &friction, of_past);
                Vector2::new(varied + inertia * slip.q2() * v_x, 0.0)
            }
        }
    }

    /// Takes the masses' variations at stage `i` from the solution of the linear system.
    fn set_masses(&mut self, model: &Model, solver: &StageSolver, beta: f64, stage: usize) {
        let (end, rates) = (&mut self.end, &mut self.stages[stage]);
        for i in 0..model.masses() {
            let found = solver.system.right[i];
            // [1]: δe = δe* + β δv.
            let history = ByAxis { x: end.v_x[i], z: end.v_z[i] };
            end.x[i] += beta * found.x;
            (end.v_x[i], end.v_z[i]) = (found.x, found.y);
            // In contact δz = s δx and δż = s δẋ + κẋ δx instead.
            match Constrained::new(&solver.state, i, end.x[i], found.x) {
                Some(mass) => (end.z[i], end.v_x[i], end.v_z[i]) = (mass.z, mass.v_x, mass.v_z),
                None => end.z[i] += beta * found.y,
            }
            // [1]: δv̇ = (δv - δv*)/β. A sticking mass has δẋ = 0 whatever its history.
            (rates.x[i], rates.z[i]) = (end.v_x[i], end.v_z[i]);
            let sticks = solver.state.mode[i] == Mode::Stick;
            rates.v_x[i] = if sticks { 0.0 } else { (end.v_x[i] - history.x) / beta };
            rates.v_z[i] = (end.v_z[i] - history.z) / beta;
        }
    }

    /// Computes the Maxwell elements' variations at stage `i` from those of the masses.
    fn set_elements(&mut self, model: &Model, beta: f64, carrier: &CarrierVariation, stage: usize) {
        let (end, rates) = (&mut self.end, &mut self.stages[stage]);
        let motion = end.links(carrier);
        for kind in LinkKind::ALL {
            motion.elongation_rates(kind, &mut self.links.forces.rate[kind]);
        }
        for row in &model.rows {
            // δa_i = g (δa* + β δė_i) with g = 1/(1 + β/τ), section 8; its rate is (δa_i - δa*)/β.
            let g = row.relaxation_time / (row.relaxation_time + beta);
            let elongation_rates = &self.links.forces.rate[row.kind];
            let a = end.maxwell[row.range.clone()].iter_mut().zip(&mut rates.maxwell[row.range.clone()]);
            for ((a, rate), elongation_rate) in a.zip(elongation_rates) {
                let found = g * (*a + beta * elongation_rate);
                *rate = (found - *a) / beta;
                *a = found;
            }
        }
    }
}

impl LinkVariation {
    fn new(model: &Model) -> Self {
        let zeros =
            |kind: LinkKind| if model.is_measured(kind) { vec![0.0; kind.count(model.masses())] } else { Vec::new() };
        let mut forces = Forces::new(model);
        // Variations are measured by that of the forces that are varied.
        let measure = forces.spatial.take();
        let motion = Variation { maxwell: Vec::new(), ..Variation::new(model) };
        Self { forces, motion, measure, energies: SpatialMeasure::LINKS.map(zeros) }
    }

    /// Computes the variation of the forces for those of the state, `of`, and of the carrier, at these forces and this
    /// state; `None`: of the forces on the carrier alone, at those of the last evaluation.
    fn evaluate(&mut self, model: &Model, of: &Variation, carrier: &CarrierVariation, at: Option<(&Forces, &State)>) {
        // δe = δξ - δu and δζ - δw of the links to the carrier.
        for i in 0..model.masses() {
            self.motion.x[i] = of.x[i] - carrier.x[0];
            self.motion.z[i] = of.z[i] - carrier.z[0];
        }
        let motion = LinkMotion { velocity: ByAxis { x: &of.v_x, z: &of.v_z }, ..self.motion.links(carrier) };
        // δF = c δe + d δė + Σ_j c_j δa_j.
        for kind in LinkKind::ALL {
            self.forces.spring_and_damper(kind, &model.links[kind], &motion);
        }
        for row in &model.rows {
            add(&mut self.forces.link[row.kind], row.stiffness, &of.maxwell[row.range.clone()]);
        }
        self.measure(model, at, &of.x, false, |_, index| of.maxwell[index]);
    }

    /// Sums the variations up that are evaluated by the links' laws, in spatial measure where they are, at these forces
    /// and this state: `x` (m) are the variations of positions, and `of_element` (m) those of the elements, the part by
    /// the rates excepted where that is said to be `by_rate`.
    fn measure(
        &mut self,
        model: &Model,
        at: Option<(&Forces, &State)>,
        x: &[f64],
        by_rate: bool,
        of_element: impl Fn(&MaxwellRow, usize) -> f64,
    ) {
        let Some(measure) = &mut self.measure else { return self.forces.sum_on_masses() };
        if let Some((Forces { spatial: Some(now), .. }, state)) = at {
            let rates = by_rate.then_some(&self.forces.rate);
            now.vary_energies(model, (&self.motion.z, rates), state, of_element, &mut self.energies);
            measure.copy_from(now);
        }
        self.forces.vary_measure(measure, x, &self.energies);
    }

    /// Computes the variation of the forces at a stage for the known part of the motion: δe* and δa* are in `history`, and
    /// the unknown velocities are not varied.
    fn evaluate_known(
        &mut self,
        model: &Model,
        solver: &StageSolver,
        beta: f64,
        history: &Variation,
        carrier: &CarrierVariation,
    ) {
        let known = &mut self.motion;
        for i in 0..model.masses() {
            // Of a contact δz = s δx* and δż = κẋ δx* are known already.
            let (z, v_z) = match Constrained::new(&solver.state, i, history.x[i], 0.0) {
                Some(mass) => (mass.z, mass.v_z),
                None => (history.z[i], 0.0),
            };
            known.x[i] = history.x[i] - carrier.x[0];
            known.z[i] = z - carrier.z[0];
            known.v_z[i] = v_z;
        }
        // [4] with D in place of d, and δH = Σ_j c_j g δa*_j.
        let motion = known.links(carrier);
        for kind in LinkKind::ALL {
            self.forces.spring_and_damper(kind, &solver.laws[kind], &motion);
        }
        for row in &model.rows {
            let weight = row.stiffness * row.relaxation_time / (row.relaxation_time + beta);
            add(&mut self.forces.link[row.kind], weight, &history.maxwell[row.range.clone()]);
        }
        let followed = |row: &MaxwellRow, index: usize| {
            row.relaxation_time / (row.relaxation_time + beta) * history.maxwell[index]
        };
        self.measure(model, Some((&solver.forces, &solver.state)), &history.x, true, followed);
    }
}

/// A stage that is solved, for which tangents are to be computed.
#[derive(Clone, Copy)]
pub(super) struct Solved<'a> {
    /// Its index.
    pub i: usize,
    /// Its time after the start of the carrier's motion, s.
    pub s: f64,
    /// The length of the step, s.
    pub h: f64,
    /// The row a_ij of the tableau.
    pub weights: &'a [f64],
    pub rates: &'a StageValues,
    pub point: &'a StagePoint,
    pub heat: &'a StageHeat,
}

/// v_t δv_t of mass `i` for the variation `of` the state, (m/s)², where the carrier is at `profile_position` (m): 0 where
/// it sticks.
fn v_t_varied(model: &Model, state: &State, profile_position: f64, i: usize, of: &Variation) -> f64 {
    let SurfacePoint { slope, curvature, .. } = state.surface_under(model, i, profile_position);
    let v = state.velocity_x[i];
    // v_t² = (1 + s²) ẋ² and δs = κ δx.
    (1.0 + slope * slope) * v * of.v_x[i] + slope * curvature * of.x[i] * v * v
}

/// sum += factor · term.
fn add(sum: &mut [f64], factor: f64, term: &[f64]) {
    for (sum, term) in sum.iter_mut().zip(term) {
        *sum += factor * term;
    }
}

/// The variations of ζ, ẋ and ż of a mass in contact, which its constraint ties to those of ξ and ẋ.
struct Constrained {
    z: f64,
    v_x: f64,
    v_z: f64,
}

impl Constrained {
    /// Of mass `i` of `state`, for the variations of ξ and ẋ; `None` for a free mass.
    fn new(state: &State, i: usize, x: f64, v_x: f64) -> Option<Self> {
        let (surface, v) = (&state.surface[i], state.velocity_x[i]);
        match state.mode[i] {
            Mode::Free => None,
            Mode::Stick => Some(Self { z: surface.slope * x, v_x: 0.0, v_z: 0.0 }),
            Mode::Forward | Mode::Backward => {
                Some(Self { z: surface.slope * x, v_x, v_z: surface.slope * v_x + surface.curvature * v * x })
            }
        }
    }
}
