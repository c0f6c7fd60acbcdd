//! A scene with a start and a motion of the carrier; it is written as TOML where it fails.

use std::fmt;
use std::path::Path as FilePath;

use asperity::outputs::{Output, Snapshot, Variable, variables};
use asperity::scene::{Axis, Force, Friction, LinkKind, OutputGroup, Path, RateShear, Scene};
use asperity::simulation::{Motion, Simulation, SimulationError, Start};

/// What runs: a scene, how the carrier starts, and its motions one after another.
#[derive(Clone, PartialEq)]
pub(crate) struct Case {
    pub(crate) scene: Scene,
    pub(crate) start: Start,
    pub(crate) motions: Vec<Motion>,
}

impl Case {
    /// The case whose scene is `text`; the motions are its excitation.
    pub(crate) fn from_text(text: &str, start: Start) -> Self {
        let scene = Scene::parse(text, FilePath::new("case.toml")).unwrap_or_else(|error| panic!("{error}\n{text}"));
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
    pub(crate) fn text(&self) -> String {
        let tables = self.tables();
        tables.into_iter().flatten().collect()
    }

    /// The tables of the file: the four links' apart, for their order is free.
    pub(crate) fn tables(&self) -> [Vec<String>; 3] {
        let Scene { name, layer, solver, outputs, .. } = &self.scene;
        let words: Vec<String> = outputs.iter().map(|group| format!("{:?}", group.name())).collect();
        let absolute = self.scene.absolute_tolerance();
        let (method, relative) = (solver.method, solver.relative_tolerance);
        let head = format!(
            "name = {name:?}\n[layer]\nmasses = {}\nspacing = {:?}\norigin = {:?}\nclearance = {:?}\nmass = {:?}\n\
             initial = \"{}\"\n{}",
            layer.masses,
            layer.spacing,
            layer.origin,
            layer.clearance,
            self.scene.mass(),
            format!("{:?}", layer.initial).to_lowercase(),
            roughness(&layer.roughness),
        );
        let surface = &self.scene.surface;
        let tail = vec![
            format!("[surface]\nkind = \"points\"\nperiodic = {}\n", surface.is_periodic()),
            format!("x = {:?}\nz = {:?}\n", surface.x(), surface.z()),
            self.scene.friction.as_ref().map_or(String::new(), friction),
            Axis::ALL.into_iter().map(|axis| carrier(&self.scene, axis)).collect(),
            format!("[solver]\nmethod = \"{}\"\n", format!("{method:?}").to_lowercase()),
            format!("relative_tolerance = {relative:?}\nabsolute_tolerance = {absolute:?}\n"),
            format!("max_steps = {}\n[fmu]\noutputs = [{}]\n", solver.max_steps, words.join(", ")),
            self.motions.iter().map(phase).collect(),
        ];
        [vec![head], self.links(), tail]
    }

    fn links(&self) -> Vec<String> {
        let link = |kind: LinkKind| {
            let link = self.scene.layer.links[kind].as_ref()?;
            let name = kind.name();
            let element = |c: f64, tau: f64| format!("{{ stiffness = {c:?}, relaxation_time = {tau:?} }}");
            let maxwell: Vec<String> =
                link.maxwell.iter().map(|one| element(one.stiffness, one.relaxation_time)).collect();
            Some(format!(
                "[layer.{name}]\n{}{}maxwell = [{}]\n",
                number("stiffness", link.stiffness),
                number("damping", link.damping),
                maxwell.join(", ")
            ))
        };
        LinkKind::ALL.into_iter().filter_map(link).collect()
    }
}

fn number(key: &str, value: Option<f64>) -> String {
    value.map_or(String::new(), |value| format!("{key} = {value:?}\n"))
}

fn roughness(heights: &[f64]) -> String {
    if heights.is_empty() { String::new() } else { format!("roughness = {{ kind = \"points\", z = {heights:?} }}\n") }
}

fn carrier(scene: &Scene, axis: Axis) -> String {
    let Some(body) = &scene.carrier[axis] else { return String::new() };
    let numbers = [
        number("mass", Some(body.mass)),
        number("stiffness", body.stiffness),
        number("damping", body.damping),
        number("load", body.load),
        number("pull", body.pull),
        number("start", body.start),
        number("start_rate", body.start_rate),
    ];
    format!("[carrier.{}]\n{}", axis.name(), numbers.concat())
}

fn friction(friction: &Friction) -> String {
    let Friction { coulomb, shear_force, shear_strength: _, rate_shear, real_area: _ } = friction;
    let rate_shear = rate_shear.map_or(String::new(), |law| {
        let RateShear { force, strength: _, reference_speed, sharpness, creep_speed } = law;
        let numbers = [
            number("force", force),
            number("reference_speed", Some(reference_speed)),
            number("sharpness", Some(sharpness)),
            number("creep_speed", creep_speed),
        ];
        format!("[friction.rate_shear]\n{}", numbers.concat())
    });
    format!("[friction]\n{}{}{rate_shear}", number("coulomb", *coulomb), number("shear_force", *shear_force))
}

fn phase(motion: &Motion) -> String {
    let path = |name: &str, path: &Path| {
        let Path { rate, amplitude, frequency } = *path;
        let sine = format!("{name}_sine = {{ amplitude = {amplitude:?}, frequency = {frequency:?} }}\n");
        format!("{name}_rate = {rate:?}\n{}", if amplitude == 0.0 { "" } else { &sine })
    };
    let force = |name: &str, force: &Force| {
        if *force == Force::default() { String::new() } else { number(name, force.start) + &path(name, &force.change) }
    };
    let (forces, along_u) = (force("load", &motion.load) + &force("pull", &motion.pull), path("u", &motion.u));
    format!("[[excitation]]\nduration = {:?}\n{along_u}{}{forces}", motion.duration, path("w", &motion.w))
}

impl fmt::Debug for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "# {:?}\n{}", self.start, self.text())
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

/// The largest absolute value; NaN counts as infinite.
pub(crate) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, value| if value.is_nan() { f64::INFINITY } else { largest.max(value.abs()) })
}
