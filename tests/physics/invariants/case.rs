//! A scene with a start and a motion of the carrier; it is written as TOML where it fails.

use std::fmt;

use asperity::outputs::{Output, Snapshot, Variable, variables};
use asperity::scene::{Axis, Force, Friction, Link, LinkKind, OutputGroup, Path, RateShear, Scene};
use asperity::simulation::{Motion, Simulation, SimulationError, Start};

use crate::common::largest;
use crate::common::scenes::SceneText;

/// What runs: a scene, how the carrier starts, and its motions one after another.
#[derive(Clone, PartialEq)]
pub(crate) struct Case {
    pub(crate) scene: Scene,
    pub(crate) start: Start,
    pub(crate) motions: Vec<Motion>,
}

impl Case {
    /// The case whose scene is `text`; the motions are its excitation.
    pub(crate) fn from_text(text: &SceneText, start: Start) -> Self {
        let scene = text.scene();
        let motion = |phase: &asperity::scene::Phase| Motion {
            duration: phase.duration,
            u: phase.u,
            w: phase.w,
            ..Motion::default()
        };
        let motions = scene.excitation.iter().map(motion).collect();
        Self { scene, start, motions }
    }

    /// The same with the tolerances, relative and absolute, `factor` times as large.
    pub(crate) fn with_tolerances_times(&self, factor: f64) -> Self {
        let mut case = self.clone();
        case.scene.solver.absolute_tolerance = Some(factor * self.scene.absolute_tolerance());
        case.scene.solver.relative_tolerance *= factor;
        case
    }

    /// The case with one more group of outputs.
    pub(crate) fn with_group(mut self, group: OutputGroup) -> Self {
        self.scene.outputs.push(group);
        self.scene.outputs.sort_unstable();
        self
    }

    /// Whether the layer has a spring or a damper: without one, nothing in the scene says what a short time is.
    pub(crate) fn has_a_time_of_its_own(&self) -> bool {
        let holds = |kind: LinkKind| {
            let link = self.scene.layer.links[kind].as_ref()?;
            let parts = [link.stiffness, link.damping].into_iter().flatten();
            Some(parts.chain(link.maxwell.iter().map(|element| element.stiffness)).any(|part| part > 0.0))
        };
        LinkKind::ALL.into_iter().filter_map(holds).any(|holds| holds)
    }

    /// The kinetic energy of the layer at this speed (m/s), J.
    pub(crate) fn moving(&self, speed: f64) -> f64 {
        0.5 * self.scene.layer.masses as f64 * self.scene.mass() * speed * speed
    }

    /// The run at its start.
    pub(crate) fn started(&self) -> Simulation {
        Simulation::new(&self.scene, &self.start).unwrap_or_else(|error| panic!("{error}"))
    }

    /// All variables that two runs alike must have alike: not the processor time.
    pub(crate) fn variables(&self) -> Vec<Variable> {
        variables(&self.scene).into_iter().filter(|variable| variable.output != Output::RunTime).collect()
    }

    /// A row at the start, and for each motion `rows` even ones, the last at its end.
    pub(crate) fn run(&self, rows: usize) -> Result<Record, SimulationError> {
        let mut record = Record::new(self.variables());
        let mut simulation = self.started();
        record.note(&simulation.snapshot());
        for motion in &self.motions {
            let time = |i: usize| if i == rows { motion.duration } else { motion.duration * i as f64 / rows as f64 };
            let times: Vec<f64> = (1..=rows).map(time).collect();
            simulation.advance_observed(motion, None, &times, |_, now| record.note(now))?;
        }
        Ok(record)
    }

    /// The scene as a file has it, its excitation the motions.
    pub(crate) fn text(&self) -> SceneText {
        let Scene { layer, surface, solver, .. } = &self.scene;
        let word = |value: &dyn fmt::Debug| format!("{value:?}").to_lowercase();
        let text = SceneText::new(layer.masses, layer.spacing, self.scene.mass())
            .set("name", self.scene.name.as_str())
            .set("layer.origin", layer.origin)
            .set("layer.clearance", layer.clearance)
            .set("layer.initial", word(&layer.initial))
            .points(surface.x(), surface.z(), surface.is_periodic())
            .method(&word(&solver.method))
            .tolerances(solver.relative_tolerance, self.scene.absolute_tolerance())
            .set("solver.max_steps", solver.max_steps() as usize)
            .outputs(&self.scene.outputs.iter().map(|group| group.word()).collect::<Vec<_>>());
        let text = if layer.roughness.is_empty() { text } else { text.roughness(&layer.roughness) };
        let text = LinkKind::ALL.into_iter().fold(text, |text, kind| link(text, kind, layer.links[kind].as_ref()));
        let text = self.scene.friction.iter().fold(text, friction);
        let text = Axis::ALL.into_iter().fold(text, |text, axis| carrier(text, &self.scene, axis));
        self.motions.iter().fold(text, |text, motion| text.phase(&phase(motion)))
    }
}

fn link(text: SceneText, kind: LinkKind, link: Option<&Link>) -> SceneText {
    let Some(link) = link else { return text };
    let maxwell: Vec<_> = link.maxwell.iter().map(|one| (one.stiffness, one.relaxation_time)).collect();
    let table = format!("layer.{}", kind.name());
    text.numbers(&table, &[("stiffness", link.stiffness), ("damping", link.damping)]).maxwell(kind, &maxwell)
}

fn carrier(text: SceneText, scene: &Scene, axis: Axis) -> SceneText {
    let Some(body) = scene.carrier[axis].as_ref() else { return text };
    let numbers = [
        ("mass", Some(body.mass)),
        ("stiffness", body.stiffness),
        ("damping", body.damping),
        ("load", body.load),
        ("pull", body.pull),
        ("start", body.start),
        ("start_rate", body.start_rate),
    ];
    text.numbers(&format!("carrier.{}", axis.name()), &numbers)
}

fn friction(text: SceneText, friction: &Friction) -> SceneText {
    let Friction { coulomb, shear_force, shear_strength: _, rate_shear, memory } = friction;
    let numbers = [("coulomb", *coulomb), ("shear_force", *shear_force), ("memory", *memory)];
    let text = text.numbers("friction", &numbers);
    let Some(RateShear { force, strength: _, reference_speed, sharpness, creep_speed }) = *rate_shear else {
        return text;
    };
    let numbers = [
        ("force", force),
        ("reference_speed", Some(reference_speed)),
        ("sharpness", Some(sharpness)),
        ("creep_speed", creep_speed),
    ];
    text.numbers("friction.rate_shear", &numbers)
}

fn phase(motion: &Motion) -> String {
    let path = |name: &str, path: &Path| {
        let Path { rate, amplitude, frequency } = *path;
        let sine = format!(", {name}_sine = {{ amplitude = {amplitude:?}, frequency = {frequency:?} }}");
        format!(", {name}_rate = {rate:?}{}", if amplitude == 0.0 { "" } else { &sine })
    };
    let force = |name: &str, force: &Force| {
        let start = force.start.map_or(String::new(), |start| format!(", {name} = {start:?}"));
        if *force == Force::default() { String::new() } else { start + &path(name, &force.change) }
    };
    let (forces, along_u) = (force("load", &motion.load) + &force("pull", &motion.pull), path("u", &motion.u));
    format!("duration = {:?}{along_u}{}{forces}", motion.duration, path("w", &motion.w))
}

impl fmt::Debug for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "# {:?}\n{}", self.start, self.text().text())
    }
}

/// The output groups of every case: those with an account of energy, and every mass. The group `solver` costs a second
/// run.
pub(crate) const GROUPS: [OutputGroup; 6] = [
    OutputGroup::Forces,
    OutputGroup::Dissipation,
    OutputGroup::Friction,
    OutputGroup::Contact,
    OutputGroup::Energy,
    OutputGroup::Elements,
];

/// The rows of a run.
#[derive(Clone, Debug)]
pub(crate) struct Record {
    pub(crate) variables: Vec<Variable>,
    pub(crate) rows: Vec<Vec<f64>>,
    /// u and w at each row, m.
    pub(crate) carrier: Vec<(f64, f64)>,
}

impl Record {
    pub(crate) fn new(variables: Vec<Variable>) -> Self {
        Self { variables, rows: Vec::new(), carrier: Vec::new() }
    }

    pub(crate) fn note(&mut self, snapshot: &Snapshot<'_>) {
        let mut values = vec![0.0; self.variables.len()];
        snapshot.evaluate(&self.variables, &mut values);
        self.rows.push(values);
        self.carrier.push((snapshot.displacement.x, snapshot.displacement.z));
    }

    /// The column of an output that the scene has; `None` where it has not.
    pub(crate) fn get(&self, output: Output) -> Option<Vec<f64>> {
        let index = self.variables.iter().position(|variable| variable.output == output)?;
        Some(self.rows.iter().map(|row| row[index]).collect())
    }

    /// The column of an output that every scene has.
    pub(crate) fn column(&self, output: Output) -> Vec<f64> {
        self.get(output).unwrap_or_else(|| panic!("no {output:?}"))
    }

    /// Every number to the last bit, row by row.
    pub(crate) fn bits(&self) -> Vec<Vec<u64>> {
        self.rows.iter().map(|row| row.iter().map(|value| value.to_bits()).collect()).collect()
    }

    /// The largest absolute value of an output; 0 where the scene does not have it.
    pub(crate) fn largest(&self, output: Output) -> f64 {
        self.get(output).map_or(0.0, |column| largest(&column))
    }
}
