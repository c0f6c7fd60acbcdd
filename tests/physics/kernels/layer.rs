//! Shared by the tests: layers given in a few words, fixed steps, random numbers.

use std::path::Path as FilePath;

use asperity::integrator::{
    ContactModes, DenseOutput, DenseWorkspace, ErrorEstimate, Integrator, LayerState, Scheme, StepSpan, Tolerance,
    Tracked,
};
use asperity::model::{Axis, ByAxis, Carrier, Forces, LinkKind, Model, State};
use asperity::outputs::Snapshot;
use asperity::scene::{Path, RateShear, Scene};

/// A spring, a damper and Maxwell elements (c_j, τ_j).
#[derive(Clone, Debug, Default)]
pub struct Link {
    pub stiffness: f64,
    pub damping: f64,
    pub maxwell: Vec<(f64, f64)>,
}

impl Link {
    pub fn new(stiffness: f64, damping: f64, maxwell: &[(f64, f64)]) -> Option<Self> {
        Some(Self { stiffness, damping, maxwell: maxwell.to_vec() })
    }
}

/// A scene in a few words.
#[derive(Clone, Debug)]
pub struct Layer {
    pub masses: usize,
    pub mass: f64,
    pub spacing: f64,
    pub clearance: f64,
    /// In the order of [`LinkKind::ALL`].
    pub links: [Option<Link>; 4],
    /// The lines of `[surface]`.
    pub surface: String,
    /// μ and A τ_0.
    pub friction: Option<(f64, f64)>,
    pub rate_shear: Option<RateShear>,
    /// The lines of `[solver]`.
    pub solver: String,
}

pub const FLAT: &str = "kind = \"flat\"";

impl Default for Layer {
    /// One mass without links, 1 m above a flat surface.
    fn default() -> Self {
        Self {
            masses: 1,
            mass: 1.0,
            spacing: 1.0,
            clearance: 1.0,
            links: [None, None, None, None],
            surface: FLAT.into(),
            friction: None,
            rate_shear: None,
            solver: String::new(),
        }
    }
}

impl Layer {
    pub fn scene(&self) -> Scene {
        let Self { masses, mass, spacing, clearance, .. } = self;
        let mut text = format!(
            "name = \"test\"\n[layer]\nmasses = {masses}\nmass = {mass:e}\nspacing = {spacing:e}\n\
             clearance = {clearance:e}\n"
        );
        for (kind, link) in LinkKind::ALL.iter().zip(&self.links) {
            if let Some(Link { stiffness, damping, maxwell }) = link {
                let element = |(c, tau): &(f64, f64)| format!("{{ stiffness = {c:e}, relaxation_time = {tau:e} }}");
                let maxwell: Vec<String> = maxwell.iter().map(element).collect();
                text += &format!("[layer.{}]\nstiffness = {stiffness:e}\ndamping = {damping:e}\n", kind.name());
                text += &format!("maxwell = [{}]\n", maxwell.join(", "));
            }
        }
        text += &format!("[surface]\n{}\n", self.surface);
        if self.friction.is_some() || self.rate_shear.is_some() {
            text += "[friction]\n";
        }
        if let Some((coulomb, shear)) = self.friction {
            text += &format!("coulomb = {coulomb:e}\nshear_force = {shear:e}\n");
        }
        if let Some(law) = &self.rate_shear {
            let RateShear { force, reference_speed, sharpness, .. } = law;
            let force = force.unwrap_or_default();
            text += &format!(
                "rate_shear = {{ force = {force:e}, reference_speed = {reference_speed:e}, sharpness = {sharpness:e}, \
                 creep_speed = {:e} }}\n",
                law.creep_speed()
            );
        }
        text += &format!("[solver]\n{}\n[fmu]\noutputs = {OUTPUTS}\n", self.solver);
        Scene::parse(&text, FilePath::new("test.toml")).unwrap_or_else(|error| panic!("{error}\n{text}"))
    }

    pub fn model(&self) -> Model {
        Model::new(&self.scene())
    }
}

const OUTPUTS: &str = r#"["forces", "dissipation", "friction", "contact", "energy", "solver", "elements"]"#;

/// `[surface]` of the natural or periodic spline through points.
pub fn points(x: &[f64], z: &[f64], periodic: bool) -> String {
    format!("kind = \"points\"\nx = {x:?}\nz = {z:?}\nperiodic = {periodic}")
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
        let span = StepSpan { start: self.s, length: h };
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
        self.integrator.dense(&self.model, &self.carrier, &self.start.state, StepSpan { start: self.s, length: h })
    }

    /// The state at the fraction `theta` of the last attempted step, of length `h`.
    pub fn within(&self, h: f64, theta: f64) -> State {
        let mut state = self.start.state.clone();
        self.dense(h).state_at(theta, &mut DenseWorkspace::new(&self.model), &mut state);
        state
    }

    /// F_x and F_z at the fraction `theta` of the last attempted step, of length `h`: from sums, and from its state there.
    pub fn on_carrier(&mut self, h: f64, theta: f64) -> [(f64, f64); 2] {
        let state = self.within(h, theta);
        let span = StepSpan { start: self.s, length: h };
        let mut forces = Forces::new(&self.model);
        forces.evaluate(&self.model, &state, &self.carrier.at(span.at(theta)));
        let Self { model, carrier, start, integrator, .. } = self;
        let mut workspace = DenseWorkspace::new(model);
        let summed = integrator.on_carrier((model, carrier, &start.state), span, theta, &mut workspace);
        [summed, (forces.on_carrier(Axis::X), forces.on_carrier(Axis::Z))]
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

/// The largest absolute value.
pub fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |largest, value: f64| if value.is_nan() { f64::NAN } else { value.abs().max(largest) })
}

/// Every output of a run but the processor time, as bits.
pub fn outputs(scene: &Scene, snapshot: &Snapshot<'_>) -> Vec<(String, u64)> {
    let variables = asperity::outputs::variables(scene);
    let mut values = vec![0.0; variables.len()];
    snapshot.evaluate(&variables, &mut values);
    let named = variables.into_iter().zip(values);
    named.filter(|(v, _)| v.name != "solver.run_time").map(|(v, value)| (v.name, value.to_bits())).collect()
}

/// The value of one output.
pub fn output(scene: &Scene, snapshot: &Snapshot<'_>, name: &str) -> f64 {
    let outputs = outputs(scene, snapshot);
    f64::from_bits(outputs.iter().find(|(other, _)| other == name).unwrap_or_else(|| panic!("no {name}")).1)
}

/// Numbers that are the same in every run: splitmix64 of S. Vigna.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Evenly from `low` to `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 * 2.0_f64.powi(-53)
    }

    /// One of 0 … `count` - 1.
    pub fn below(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }
}
