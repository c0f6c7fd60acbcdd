//! A run of a case by the library along its excitation. Every row is checked by the rules.

use std::path::Path;
use std::sync::Arc;

use asperity::outputs::{self, Snapshot, Variable};
use asperity::scene::{ByAxis, Scene};
use asperity::simulation::{Inaccuracy, Motion, Simulation, SimulationError, Start};
use asperity_study::robustness::{ForceHistory, ScaledQuantity};
use toml::{Table, Value};

use crate::catalogue::{self, Case};
use crate::rules::{Finding, Limits};

/// Steps tried that a run may take, whatever its scene: 10⁴ periods take tens of steps each with any method.
pub const MAX_STEPS: u64 = 1_000_000;
/// A tight run may take so many times more.
const OF_TIGHT: u64 = 10;

/// The rows of a run and what was found.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// The variables that are not the elements'.
    pub names: Arc<Vec<String>>,
    /// Time and these variables.
    pub rows: Vec<(f64, Vec<f64>)>,
    /// The carrier's path between the rows, m.
    pub path: f64,
    /// What it ended with before its end.
    pub error: Option<Stop>,
    /// The absolute tolerance of a position as a force on one mass, N: no force is known better.
    pub known: f64,
    /// Number of masses.
    pub masses: f64,
    /// Whether it warns that it does not converge.
    pub warns: bool,
    /// What did not hold.
    pub findings: Vec<Finding>,
}

impl Outcome {
    /// A column by its name; empty where the scene has no such variable.
    pub fn column(&self, name: &str) -> Vec<f64> {
        let index = self.names.iter().position(|other| other == name);
        index.map_or_else(Vec::new, |index| self.rows.iter().map(|(_, values)| values[index]).collect())
    }

    pub fn forces(&self) -> ForceHistory {
        let [x, z] = ["F_x", "F_z"].map(|name| self.column(name));
        let times = self.rows.iter().map(|(time, _)| *time).collect();
        ForceHistory { times, rows: x.into_iter().zip(z).map(|(x, z)| [x, z]).collect() }
    }

    /// The last value, 0 where there is none.
    pub fn last(&self, name: &str) -> f64 {
        self.column(name).last().copied().unwrap_or_default()
    }

    /// The largest absolute value.
    pub fn largest(&self, name: &str) -> f64 {
        self.column(name).iter().fold(0.0, |largest: f64, value| largest.max(value.abs()))
    }

    /// Steps tried.
    pub fn work(&self) -> f64 {
        self.last("solver.steps") + self.last("solver.rejected")
    }
}

/// Why a run ended before its end.
#[derive(Clone, Debug, PartialEq)]
pub struct Stop {
    /// Which error: a variant of [`SimulationError`], or what else.
    pub name: &'static str,
    pub text: String,
}

impl From<SimulationError> for Stop {
    fn from(error: SimulationError) -> Self {
        let name = match error {
            SimulationError::TooManySteps { .. } | SimulationError::TooMuchWork { .. } => "TooManySteps",
            SimulationError::StepTooSmall { .. } => "StepTooSmall",
            SimulationError::Folded { .. } => "Folded",
            SimulationError::OutOfRange { .. } => "OutOfRange",
            SimulationError::Scene(_) => "Scene",
            SimulationError::Memory(_) => "Memory",
            SimulationError::Interrupted { .. } => "Interrupted",
        };
        Self { name, text: error.to_string() }
    }
}

const OUTPUTS: [&str; 7] = ["forces", "dissipation", "friction", "contact", "energy", "solver", "elements"];

/// The scene's file with this method, the tolerance times `tight`.
pub fn scene_text(case: &Case, method: &str, tight: f64) -> String {
    let mut table = case.scene.clone();
    table.insert("name".into(), Value::String("extreme".into()));
    // A tight run needs no estimate of its error, which would take an even tighter one.
    let asked = OUTPUTS.iter().filter(|group| tight == 1.0 || **group != "solver");
    let outputs: Vec<_> = asked.map(|group| Value::String((*group).into())).collect();
    table.entry("fmu").or_insert(Value::Table(Table::from_iter([("outputs".into(), Value::Array(outputs))])));
    let solver = table.entry("solver").or_insert(Value::Table(Table::new())).as_table_mut().unwrap();
    let relative = solver.get("relative_tolerance").map_or(1e-6, catalogue::number);
    solver.insert("relative_tolerance".into(), Value::Float(relative * tight));
    if let Some(absolute) = solver.get("absolute_tolerance").map(catalogue::number) {
        solver.insert("absolute_tolerance".into(), Value::Float(absolute * tight));
    }
    solver.insert("method".into(), Value::String(method.into()));
    let most = if tight < 1.0 { OF_TIGHT * MAX_STEPS } else { MAX_STEPS };
    solver.entry("max_steps").or_insert(Value::Integer(most as i64));
    catalogue::text(&table)
}

/// The scene with this method, the tolerance times `tight`.
pub fn scene(case: &Case, method: &str, tight: f64) -> Scene {
    let text = scene_text(case, method, tight);
    let scene = Scene::parse(&text, Path::new("extreme.toml")).unwrap_or_else(|error| panic!("{}: {error}", case.name));
    case.perturbation.apply(&scene).unwrap_or_else(|error| panic!("{}: {error}", case.name))
}

/// Follows the excitation by the library.
pub fn by_library(case: &Case, method: &str, tight: f64) -> Outcome {
    follow(case, &scene(case, method, tight))
}

/// The same with these quantities `factor` times as large.
pub fn by_library_scaled(
    case: &Case,
    method: &str,
    tight: f64,
    (quantities, factor): (&[ScaledQuantity], f64),
) -> Outcome {
    let mut scene = scene(case, method, tight);
    let scaled = quantities.iter().try_for_each(|quantity| quantity.scale(&mut scene, factor));
    scaled.unwrap_or_else(|error| panic!("{}: {error}", case.name));
    follow(case, &scene)
}

fn follow(case: &Case, scene: &Scene) -> Outcome {
    let first = scene.excitation.first();
    let start = Start {
        u_rate: first.map_or(0.0, |phase| phase.u.at(0.0).speed),
        w_rate: first.map_or(0.0, |phase| phase.w.at(0.0).speed),
        load: scene.first_load(),
        pull: scene.first_pull(),
        ..case.start
    };
    let mut watch = Watch::new(scene, case.undamped);
    let mut simulation = match Simulation::new(scene, &start) {
        Ok(simulation) => simulation,
        Err(error) => return watch.end(Some(error.into())),
    };
    watch.look(&simulation.snapshot());
    for phase in &scene.excitation {
        let load = phase.load(scene.layer.area());
        let motion =
            Motion { duration: phase.duration, u: phase.u, w: phase.w, load, pull: phase.pull(), ..Motion::REST };
        let rows: Vec<f64> = (1..=case.rows)
            .map(|i| if i == case.rows { phase.duration } else { phase.duration * f64::from(i) / f64::from(case.rows) })
            .collect();
        let before = (watch.values_of(&simulation.snapshot()), simulation.state());
        if let Err(error) = simulation.advance_observed(&motion, None, &rows, |_, snapshot| watch.look(snapshot)) {
            let after = (watch.values_of(&simulation.snapshot()), simulation.state());
            watch.limits.kept(&before, &after, &mut watch.outcome.findings);
            return watch.end(Some(error.into()));
        }
    }
    watch.outcome.warns = matches!(simulation.inaccuracy(), Some(Inaccuracy::Divergence { .. }));
    watch.end(None)
}

/// Looks at the rows of a run.
pub struct Watch {
    pub variables: Vec<Variable>,
    pub outcome: Outcome,
    pub limits: Limits,
    pub values: Vec<f64>,
    carrier: Option<[f64; 2]>,
}

impl Watch {
    pub fn new(scene: &Scene, adds_up: bool) -> Self {
        let variables = outputs::variables(scene);
        let names = variables.iter().filter(|v| v.is_output()).map(|v| v.name.clone()).collect();
        let limits = Limits::new(scene, adds_up);
        Self {
            outcome: Outcome {
                names: Arc::new(names),
                known: limits.force,
                masses: scene.layer.masses as f64,
                ..Outcome::default()
            },
            limits,
            values: vec![0.0; variables.len()],
            carrier: None,
            variables,
        }
    }

    fn look(&mut self, snapshot: &Snapshot<'_>) {
        snapshot.evaluate(&self.variables, &mut self.values);
        let ByAxis { x: u, z: w } = snapshot.displacement;
        self.note(snapshot.time, [u, w]);
    }

    /// Takes `values` as the row at `time`, with the carrier at u and w.
    pub fn note(&mut self, time: f64, carrier: [f64; 2]) {
        let [from_u, from_w] = *self.carrier.get_or_insert(carrier);
        self.outcome.path += (carrier[0] - from_u).abs() + (carrier[1] - from_w).abs();
        self.carrier = Some(carrier);
        self.limits.check_row((time, carrier[0]), &self.variables, &self.values, &mut self.outcome.findings);
        let globals = self.outcome.names.len();
        self.outcome.rows.push((time, self.values[..globals].to_vec()));
    }

    /// All values but the processor time.
    pub fn values_of(&mut self, snapshot: &Snapshot<'_>) -> Vec<f64> {
        snapshot.evaluate(&self.variables, &mut self.values);
        let counts = self.variables.iter().zip(&self.values);
        counts.filter(|(variable, _)| variable.name != "solver.run_time").map(|(_, value)| *value).collect()
    }

    /// The outcome of the whole.
    pub fn end(mut self, error: Option<Stop>) -> Outcome {
        self.outcome.error = error;
        self.limits.check_run(&mut self.outcome);
        self.outcome
    }
}
