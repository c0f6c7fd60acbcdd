//! Shared by the tests: layers given in a few words, fixed steps, random numbers.

use asperity::internals::integrator::{
    ContactModes, DenseOutput, DenseWorkspace, ErrorEstimate, Integrator, LayerState, Scheme, TimeSpan, Tolerance,
    Tracked,
};
use asperity::model::{ByAxis, Carrier, Forces, LinkKind, Mode, Model, State, SurfacePoint};
use asperity::scene::{Path, RateShear, Scene};

use crate::common::scenes::{Law, SceneText};

/// A spring, a damper and Maxwell elements (c_j, τ_j).
pub fn link(stiffness: f64, damping: f64, maxwell: &[(f64, f64)]) -> Option<Law> {
    Some(Law::with_maxwell(stiffness, damping, maxwell))
}

/// A scene in a few words.
#[derive(Clone, Debug)]
pub struct Layer {
    pub masses: usize,
    pub mass: f64,
    pub spacing: f64,
    pub clearance: f64,
    /// In the order of [`LinkKind::ALL`].
    pub links: [Option<Law>; 4],
    /// The key `surface`, or nothing.
    pub surface: String,
    /// μ and A τ_0.
    pub friction: Option<(f64, f64)>,
    pub rate_shear: Option<RateShear>,
    /// The key `solver`, or nothing.
    pub solver: String,
}

impl Default for Layer {
    /// One mass without links, 1 m above a flat surface.
    fn default() -> Self {
        Self {
            masses: 1,
            mass: 1.0,
            spacing: 1.0,
            clearance: 1.0,
            links: [None, None, None, None],
            surface: String::new(),
            friction: None,
            rate_shear: None,
            solver: String::new(),
        }
    }
}

impl Layer {
    pub fn scene(&self) -> Scene {
        let mut text = SceneText::new(self.masses, self.spacing, self.mass).set("layer.clearance", self.clearance);
        for (kind, law) in LinkKind::ALL.into_iter().zip(&self.links) {
            text = law.iter().fold(text, |text, law| text.link(kind, law));
        }
        if let Some((coulomb, shear)) = self.friction {
            text = text.coulomb(coulomb).set("friction.shear_force", shear);
        }
        if let Some(law) = &self.rate_shear {
            text = text
                .set("friction.rate_shear.force", law.force.unwrap_or_default())
                .set("friction.rate_shear.reference_speed", law.reference_speed)
                .set("friction.rate_shear.sharpness", law.sharpness)
                .set("friction.rate_shear.creep_speed", law.creep_speed());
        }
        text.with(&self.surface).with(&self.solver).outputs(&OUTPUTS).scene()
    }

    pub fn model(&self) -> Model {
        Model::new(&self.scene())
    }
}

const OUTPUTS: [&str; 7] = ["forces", "dissipation", "friction", "contact", "energy", "solver", "elements"];

/// The surface through points, natural or periodic.
pub fn points(x: &[f64], z: &[f64], periodic: bool) -> String {
    format!("surface = {{ kind = 'points', x = {x:?}, z = {z:?}, periodic = {periodic} }}")
}

/// Steps of lengths that the test chooses.
pub struct Stepper {
    pub model: Model,
    pub carrier: Carrier,
    pub start: LayerState,
    pub integrator: Integrator,
    pub tolerance: Tolerance,
    pub s: f64,
    /// Whether the steps are event-driven or of time-stepping.
    modes: ContactModes,
}

/// Gives a stepper its method.
pub type Method = fn(Stepper) -> Stepper;

/// The method that a stepper has at first.
pub const SEVEN_STAGES: Method = |stepper| stepper;

impl Stepper {
    /// From `state` along the carrier's paths, counted from its position 0. Newton's iterations converge to `tolerance`
    /// (m).
    pub fn new(model: Model, (u, w): (Path, Path), state: State, tolerance: f64) -> Self {
        let carrier = Carrier::new(0.0, ByAxis::default(), ByAxis { x: u, z: w }, &model.profile);
        let tolerance = Tolerance::new(&model, tolerance, tolerance);
        let mut forces = Forces::new(&model);
        let integrator = Integrator::new(&model, Tracked::default(), &[Scheme::Esdirk5, Scheme::Sdirk2]);
        forces.evaluate(&model, &state, &carrier.at(0.0));
        let mut start = LayerState { state, ..LayerState::new(&model) };
        integrator.evaluate_start(&model, &mut start, (&carrier, 0.0), &forces, 1e-9);
        Self { model, carrier, start, integrator, tolerance, s: 0.0, modes: ContactModes::Held }
    }

    /// The same by the scheme of order 3.
    pub fn by_four_stages(self) -> Self {
        let integrator = Integrator::new(&self.model, Tracked::default(), &[Scheme::Esdirk3]);
        Self { integrator, ..self }
    }

    /// The same with the energies of the layer and of parts of it.
    pub fn with_energies(self) -> Self {
        let Self { model, carrier, mut start, .. } = self;
        let tracked = Tracked { energy: true, ..Tracked::default() };
        let mut integrator = Integrator::new(&model, tracked, &[self.integrator.event_driven()]);
        integrator.keep_link_forces(&model);
        let mut forces = Forces::new(&model);
        forces.evaluate(&model, &start.state, &carrier.at(0.0));
        integrator.evaluate_start(&model, &mut start, (&carrier, 0.0), &forces, 1e-9);
        Self { model, carrier, start, integrator, ..self }
    }

    /// The same by the method of two stages.
    pub fn by_two_stages(self) -> Self {
        Self { modes: ContactModes::SetValued, ..self }
    }

    /// Attempts a step without accepting it.
    pub fn attempt(&mut self, h: f64) -> ErrorEstimate {
        let start = (&self.model, &self.start, &self.carrier);
        let span = TimeSpan { start: self.s, length: h };
        self.integrator.attempt(self.modes, start, span, &self.tolerance).unwrap()
    }

    /// Attempts and accepts a step of length `h`.
    pub fn step(&mut self, h: f64) {
        self.attempt(h);
        self.integrator.accept(&mut self.start);
        self.s += h;
    }

    /// Makes `steps` steps to the time `end`.
    pub fn run(&mut self, end: f64, steps: u32) {
        let h = (end - self.s) / f64::from(steps);
        (0..steps).for_each(|_| self.step(h));
    }

    /// The dense output of the last attempted step, of length `h`.
    pub fn dense(&self, h: f64) -> DenseOutput<'_> {
        self.integrator.dense(&self.model, &self.carrier, &self.start.state, TimeSpan { start: self.s, length: h })
    }

    /// The state at the fraction `theta` of the last attempted step, of length `h`.
    pub fn within(&self, h: f64, theta: f64) -> State {
        let mut state = self.start.state.clone();
        self.dense(h).state_at(theta, &mut DenseWorkspace::new(&self.model), &mut state);
        state
    }

    /// F_x and F_z at the fraction `theta` of the last attempted step, of length `h`: from sums, and from its state
    /// there.
    pub fn on_carrier(&mut self, h: f64, theta: f64) -> [ByAxis<f64>; 2] {
        let state = self.within(h, theta);
        let span = TimeSpan { start: self.s, length: h };
        let mut forces = Forces::new(&self.model);
        forces.evaluate(&self.model, &state, &self.carrier.at(span.at(theta)));
        let Self { model, carrier, start, integrator, .. } = self;
        let mut workspace = DenseWorkspace::new(model);
        let summed = integrator.on_carrier((model, carrier, &start.state), span, theta, &mut workspace);
        [summed, ByAxis::from_fn(|axis| forces.on_carrier(axis))]
    }
}

/// A τ_f(v), N, of the speed in the direction of slip, by its formula.
pub fn strength(law: &RateShear, speed: f64) -> f64 {
    let decades = (speed.max(law.creep_speed()) / law.reference_speed).log10();
    law.force.unwrap_or_default() * (-law.sharpness * decades.powi(2)).exp()
}

/// A carrier that moves at a constant rate.
pub fn at_rate(rate: f64) -> Path {
    Path { rate, ..Path::default() }
}

/// The order log2(error(h)/error(h/2)) seen in errors at halved steps, by the last pair.
pub fn last_order(errors: &[f64]) -> f64 {
    let [.., coarse, fine] = errors else { panic!("two errors at least") };
    (coarse / fine).log2()
}

/// One free mass at rest on links with so many Maxwell elements.
pub fn one_mass(maxwell: usize) -> State {
    let zeros = |count| vec![0.0; count];
    State {
        elongation_x: zeros(1),
        elongation_z: zeros(1),
        velocity_x: zeros(1),
        velocity_z: zeros(1),
        maxwell: zeros(maxwell),
        flash: Vec::new(),
        memory: Vec::new(),
        mode: vec![Mode::Free],
        surface: vec![SurfacePoint::default()],
    }
}
