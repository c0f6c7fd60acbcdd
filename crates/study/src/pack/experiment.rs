//! The experiment of an FMU as tables: its inputs at times, and what the program itself gets along them.
//!
//! It goes into `extra/org.fmi-standard.fmi-ls-ref/`: what comes with an FMU that tells what it is and shows that it runs
//! as it should, listed in a manifest by FMI-LS-REF, the layered standard of the Modelica Association for references.

use std::io;
use std::path::Path;

use asperity::element::{FrictionTable, Node, PointContact, Quantity};
use asperity::patch::Patch;
use asperity::scene::{Backing, Input, OutputGroup, Phase, Scene, Value};
use asperity::seal::Seal;
use asperity::simulation::SimulationError;
use asperity_fmi::{CommunicationStep, Definition, Inputs, Kind, Role, VariableRef, VariableTable};
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};

use super::archive::ArchiveEntry;
use super::description::{Nominals, Xml, clean, document, start};
use crate::decimals::{real, rounded, short};
use crate::robustness::{Budget, at_tolerance};
use crate::runner::{self, InputSample, Rows, Runner};

/// The result's tolerance over that of the FMU.
const TIGHTER: f64 = 0.1;
/// What the result may cost, in steps of a mass; the experiment ends where it is used up. A step costs as much besides as one
/// of so many masses.
const WORK: u64 = 1_000_000;
const STEP: u64 = 16;
/// Bytes of the result: of so many columns that it would be larger it has fewer rows.
const BYTES: usize = 60_000;
/// Significant digits of the result, and the bytes that a number takes with them.
const DIGITS: usize = 9;
const BYTES_OF_NUMBER: usize = 15;
/// An experiment has so many rows, or there is none.
const FEWEST_ROWS: usize = 10;
/// What the names of outputs begin with that are no part of a result: they tell of the run, or of single masses.
const LEFT_OUT: [&str; 4] = ["solver.", "energy.residual", "element[", "cell["];
/// The estimated error of the run, as a share of the largest force, and its steps.
const ERROR: &str = "solver.error";
const STEPS: &str = "solver.steps";

/// The two tables.
#[derive(Debug)]
pub(super) struct ExperimentTables {
    pub(super) inputs: String,
    pub(super) result: String,
    /// What the result is, in a sentence.
    pub(super) description: String,
    /// Where the experiment ends early: where, and why.
    pub(super) early_end: Option<String>,
    /// The largest values of inputs and outputs, to a power of ten.
    pub(super) nominals: Nominals,
    /// The file of the two, by MA-HS-Experiments.
    setup: ExperimentSetup,
}

/// What the file of an experiment says of it.
#[derive(Clone, Copy, Debug)]
struct ExperimentSetup {
    /// From and to, s.
    times: [f64; 2],
    /// The longest time from row to row, s.
    step: f64,
    /// The relative tolerance; `None` where the model has none.
    tolerance: Option<f64>,
}

/// The tables, with the FMU's names; why there is no experiment.
pub(super) fn tables(definition: &Definition, variables: &VariableTable) -> Result<ExperimentTables, String> {
    let budget = Budget(WORK / (STEP + masses(definition)));
    let tight = tight(definition, budget);
    let columns = columns(definition, variables);
    let motion = InputMotion::new(definition, budget)?;
    let bytes = motion.times.len() * columns.len() * BYTES_OF_NUMBER;
    let motion = motion.thinned(bytes.div_ceil(BYTES));
    let (rows, end) = rows(&tight, &motion, budget)?;
    let early_end = end.map(|why| {
        let (reached, whole) = (motion.times[rows.len() - 1], motion.times[motion.times.len() - 1]);
        format!("its run ends at {} of {} s: {why}", short(reached, 3), short(whole, 3))
    });
    if rows.len() < FEWEST_ROWS {
        return Err(early_end.unwrap_or_else(|| format!("it has less than {FEWEST_ROWS} rows")));
    }
    let found = tight.calculated();
    let index = |name: &str| found.iter().position(|variable| variable.name == name);
    let inputs = variables.entries().map(|(_, variable)| variable);
    let inputs: Vec<&str> =
        inputs.filter(|variable| matches!(variable.role, Role::Input(_))).map(|variable| &*variable.name).collect();
    let shown: Vec<(&str, usize)> = columns.iter().filter_map(|(own, named)| Some((*named, index(own)?))).collect();
    let result_row = |row: &Vec<f64>| shown.iter().map(|&(_, i)| rounded(row[i], DIGITS) + 0.0).collect();
    // The last row has the largest error over the largest force of the whole run; at a first touch, over next to nothing.
    let of_run = |i: usize| rows[rows.len() - 1][i];
    let times = &motion.times[..rows.len()];
    let nominals = inputs.iter().enumerate().map(|(i, name)| (*name, largest(&motion.values[..rows.len()], i)));
    let nominals = nominals.chain(shown.iter().map(|&(name, i)| (name, largest(&rows, i))));
    Ok(ExperimentTables {
        nominals: nominals.filter_map(|(name, value)| Some((name.to_owned(), power_of_ten(value)?))).collect(),
        setup: ExperimentSetup {
            times: [times[0], times[times.len() - 1]],
            step: rounded(times.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max), DIGITS),
            tolerance: definition.default_experiment().and_then(|experiment| experiment.tolerance),
        },
        inputs: table(inputs.into_iter(), &motion.times, motion.values[..rows.len()].iter().cloned()),
        result: table(shown.iter().map(|&(name, _)| name), &motion.times, rows.iter().map(result_row)),
        description: description(index(ERROR).map(of_run)),
        early_end,
    })
}

/// The largest value of a column, without its sign.
fn largest(rows: &[Vec<f64>], column: usize) -> f64 {
    rows.iter().map(|row| row[column].abs()).fold(0.0, f64::max)
}

/// The power of ten next to a value, the same on every machine; `None` of 0.
fn power_of_ten(value: f64) -> Option<f64> {
    (value > 0.0).then(|| format!("1e{}", value.log10().round()).parse().ok()).flatten()
}

/// What a result is whose error is estimated as this share of the largest force.
fn description(error: Option<f64>) -> String {
    let along = format!("What asperity {} gets along the experiment", env!("CARGO_PKG_VERSION"));
    match error {
        Some(error) => {
            format!(
                "{along} at a tenth of the tolerance; its estimated error is {} of the largest force",
                short(error, 2)
            )
        }
        None => along,
    }
}

/// Rows at times, as the FMI tools page asks for them: names in quotes. Readers take a column without points for one of
/// integers.
fn table<'a>(names: impl Iterator<Item = &'a str>, times: &[f64], rows: impl Iterator<Item = Vec<f64>>) -> String {
    let head: Vec<String> = std::iter::once("time").chain(names).map(|name| format!("\"{name}\"")).collect();
    let line = |(time, row): (&f64, Vec<f64>)| {
        let field = |value: f64| if value.fract() == 0.0 { format!("{value:?}") } else { real(value) };
        let fields: Vec<String> = std::iter::once(*time).chain(row).map(field).collect();
        fields.join(",") + "\n"
    };
    head.join(",") + "\n" + &times.iter().zip(rows).map(line).collect::<String>()
}

fn masses(definition: &Definition) -> u64 {
    if let Definition::Layer(scene) = definition { scene.layer.masses as u64 } else { 1 }
}

/// The definition at a tenth of its tolerance with an estimate of its error, each communication step within a budget.
fn tight(definition: &Definition, budget: Budget) -> Definition {
    let scene = match definition {
        Definition::Layer(scene) => scene,
        Definition::Seal(seal) => {
            let mut seal = seal.clone();
            seal.relative_tolerance *= TIGHTER;
            return Definition::Seal(seal);
        }
        Definition::Element(_) | Definition::Patch(_) => return definition.clone(),
    };
    let mut scene = budget.limit(&at_tolerance(scene, TIGHTER * scene.solver.relative_tolerance));
    if !scene.outputs.contains(&OutputGroup::Solver) {
        scene.outputs.push(OutputGroup::Solver);
        scene.outputs.sort();
    }
    scene.into()
}

/// The outputs of the result by their own names and those in the FMU: all but those of the run and of single masses.
fn columns<'a>(definition: &Definition, variables: &'a VariableTable) -> Vec<(String, &'a str)> {
    let named = variables.entries().map(|(_, variable)| variable).filter(|variable| variable.is_calculated());
    let is_shown = |own: &VariableRef| {
        matches!(own.role, Role::Output { .. }) && !LEFT_OUT.iter().any(|part| own.name.starts_with(part))
    };
    let all = definition.calculated().into_iter().zip(named);
    all.filter(|(own, _)| is_shown(own)).map(|(own, named)| (own.name, named.name.as_str())).collect()
}

/// The calculated variables row by row, up to where the run fails or its budget is used up, and why it ended there; why none
/// begins.
fn rows(
    definition: &Definition,
    motion: &InputMotion,
    budget: Budget,
) -> Result<(Vec<Vec<f64>>, Option<String>), String> {
    let slots: Vec<usize> = definition.inputs().iter().filter_map(slot).collect();
    let calculated = definition.calculated();
    let steps = calculated.iter().position(|variable| variable.name == STEPS);
    let mut inputs = Inputs::default();
    motion.set(&mut inputs, &slots, 0);
    let mut run = definition.start(&inputs, motion.times[0]).map_err(|error| error.to_string())?;
    let mut values = vec![0.0; calculated.len()];
    run.evaluate(&mut values);
    let mut rows = vec![values.clone()];
    for (i, times) in motion.times.windows(2).enumerate() {
        motion.set(&mut inputs, &slots, i);
        let step = CommunicationStep { time: times[0], h: times[1] - times[0], rule: definition.input_rule() };
        if steps.is_some_and(|steps| values[steps] > budget.0 as f64) {
            return Ok((rows, Some(too_long(definition, budget))));
        }
        if let Err(error) = run.advance(&inputs, &step) {
            return Ok((rows, Some(error.to_string())));
        }
        inputs.complete_step(&step);
        run.evaluate(&mut values);
        rows.push(values.clone());
    }
    Ok((rows, None))
}

/// Why a run is given up that has used up its budget.
fn too_long(definition: &Definition, budget: Budget) -> String {
    format!("it is too long for packing, which takes {} steps at most of {} masses", budget.0, masses(definition))
}

fn slot(input: &VariableRef) -> Option<usize> {
    if let Role::Input(slot) = input.role { Some(slot) } else { None }
}

/// Even intervals of an experiment.
const INTERVALS: u32 = 200;
/// Most rows: those of an excitation of many phases are thinned.
const MOST_ROWS: usize = 250;

/// Values of the inputs, in their order, at times: straight from row to row.
#[derive(Debug)]
pub(super) struct InputMotion {
    /// s, rising.
    pub(super) times: Vec<f64>,
    /// In the inputs' own units.
    pub(super) values: Vec<Vec<f64>>,
}

impl InputMotion {
    /// That of a definition; why there is none, as of a scene without an excitation.
    pub(super) fn new(definition: &Definition, budget: Budget) -> Result<Self, String> {
        let inputs = definition.inputs();
        let no_press = || "its table has no press and slide of an element".to_owned();
        match definition {
            Definition::Layer(scene) if scene.excitation.is_empty() => Err("the scene has no excitation".to_owned()),
            Definition::Layer(scene) => Self::of_layer(scene, budget),
            Definition::Element(contact) => Self::of_element(contact, &inputs).ok_or_else(no_press),
            Definition::Patch(patch) => Self::of_patch(patch, &inputs).ok_or_else(no_press),
            Definition::Seal(seal) => Ok(Self::of_seal(seal, &inputs)),
        }
    }

    /// A stroke of some widths of the lip out and in, at the middle speed of its table.
    fn of_seal(seal: &Seal, inputs: &[VariableRef]) -> Self {
        const WIDTHS: f64 = 3.0;
        let stroke = WIDTHS * seal.width();
        let row = |i: u32| {
            let passed = f64::from(i) / f64::from(INTERVALS / 2);
            let value = |input: &VariableRef| match input.name.as_str() {
                "u" => stroke * if passed > 1.0 { 2.0 - passed } else { passed },
                _ => {
                    if let Some(Value::Real(start)) = input.start {
                        start
                    } else {
                        0.0
                    }
                }
            };
            (passed * stroke / seal.middle_speed(), inputs.iter().map(value).collect())
        };
        let (times, values) = (0..=INTERVALS).map(row).unzip();
        Self { times, values }
    }

    /// Every `every`th row, the first and the last.
    pub(super) fn thinned(self, every: usize) -> Self {
        let last = self.times.len() - 1;
        let is_kept = |i: usize| i.is_multiple_of(every.max(1)) || i == last;
        let kept = |i: &usize| is_kept(*i);
        Self {
            times: (0..=last).filter(kept).map(|i| self.times[i]).collect(),
            values: (0..=last).filter(kept).map(|i| self.values[i].clone()).collect(),
        }
    }

    /// Sets the inputs in these slots to row `i` and their rates to the next.
    pub(super) fn set(&self, inputs: &mut Inputs, slots: &[usize], i: usize) {
        let next = (i + 1).min(self.times.len() - 1);
        let duration = self.times[next] - self.times[i];
        for (column, &slot) in slots.iter().enumerate() {
            let (here, there) = (self.values[i][column], self.values[next][column]);
            inputs.set(slot, here);
            inputs.set_rate(slot, if next > i { (there - here) / duration } else { 0.0 });
        }
    }

    fn of_layer(scene: &Scene, budget: Budget) -> Result<Self, String> {
        let durations = durations(scene, budget)?;
        let total: f64 = durations.iter().sum();
        let rows = Rows::Within { longest: total / f64::from(INTERVALS), parts: 1 };
        let start = runner::start(scene, 0.0);
        let temperature = start.temperature.unwrap_or(scene.input_start(Input::Temperature));
        let mut carrier = InputSample { load: start.load, pull: start.pull, temperature, ..InputSample::default() };
        let mut samples = vec![carrier];
        for (phase, duration) in scene.excitation.iter().zip(durations) {
            let motion = phase.motion(scene.layer.area());
            samples.extend(rows.times(duration).map(|s| carrier.after(&motion, s)));
            carrier = carrier.after(&motion, duration);
        }
        let inputs = scene.inputs();
        let values = |sample: &InputSample| inputs.iter().map(|&input| sample.input(input)).collect();
        let motion = Self {
            times: samples.iter().map(|sample| sample.time).collect(),
            values: samples.iter().map(values).collect(),
        };
        if motion.times.len() < 2 {
            return Err("the excitation takes no time".to_owned());
        }
        let every = motion.times.len().div_ceil(MOST_ROWS);
        Ok(motion.thinned(every))
    }

    fn of_element(contact: &PointContact, inputs: &[VariableRef]) -> Option<Self> {
        let press = Press::new(contact.table(), None)?;
        let [u, w] = [Input::U, Input::W].map(Input::name);
        Some(press.motion(inputs, u, (w, press.depth)))
    }

    fn of_patch(patch: &Patch, inputs: &[VariableRef]) -> Option<Self> {
        let press = Press::new(patch.table(), patch.backing())?;
        Some(press.motion(inputs, "x", ("z", press.depth)))
    }
}

/// The durations of the phases, s; those that a force ends are found by a run within a budget, whose phases up to there
/// count; why none of them is over within it.
fn durations(scene: &Scene, budget: Budget) -> Result<Vec<f64>, String> {
    let is_open = |phase: &Phase| phase.until_force.is_some() || phase.until_pressure.is_some();
    if !scene.excitation.iter().any(is_open) {
        return Ok(scene.excitation.iter().map(|phase| phase.duration).collect());
    }
    let failed = |error: SimulationError| match error {
        SimulationError::TooManySteps { .. } => too_long(&scene.clone().into(), budget),
        error => error.to_string(),
    };
    let mut runner = Runner::new(&budget.limit(scene), Rows::PerPhase(1), 0.0).map_err(failed)?;
    let mut durations = Vec::new();
    for (i, phase) in scene.excitation.iter().enumerate() {
        match runner.run_phase(phase, |_, _| std::ops::ControlFlow::Continue(())) {
            Ok(duration) => durations.push(duration),
            Err(error) if durations.iter().sum::<f64>() <= 0.0 => {
                return Err(format!("its run ends within phase {}: {}", i + 1, failed(error)));
            }
            Err(_) => break,
        }
    }
    Ok(durations)
}

/// A short press to the middle of a table, and a slide to and fro there.
struct Press {
    /// How far it is pressed from just above the touch, m: negative.
    depth: f64,
    /// Speed of the slide, m/s.
    speed: f64,
    /// The time in which what sticks passes the way to slip, s.
    stick_time: f64,
}

/// The rows of each part, and its duration over the time to slip.
const PRESS: (u32, f64) = (40, 20.0);
const SLIDE: (u32, f64) = (60, 10.0);

impl Press {
    /// Of contacts of `table` alone, or with a backing, which gives way where they are in full contact.
    fn new(table: &FrictionTable, backing: Option<Backing>) -> Option<Self> {
        let grid = &table.grid;
        let middle = |axis: &[f64]| axis.len() / 2;
        let node = Node {
            temperature: middle(&grid.temperatures),
            load: middle(&grid.loads).min(grid.loads.len().checked_sub(2)?),
            speed: middle(&grid.speeds),
        };
        let clear = PointContact::new(table.clone()).clear_displacement();
        let behind = backing.filter(|_| table.is_full_contact(node));
        let behind = behind.map_or(0.0, |backing| grid.loads[node.load] / backing.normal);
        let depth = table.value(Quantity::Separation, node) - table.rest_separation - clear - behind;
        let speed = *grid.speeds.get(node.speed)?;
        let stick_time = table.stick_time_at(node, backing)?;
        (depth < 0.0).then_some(Self { depth, speed, stick_time })
    }

    /// All inputs at their start values but these two.
    fn motion(&self, inputs: &[VariableRef], along: &str, (down, depth): (&str, f64)) -> InputMotion {
        let mut motion = InputMotion { times: Vec::new(), values: Vec::new() };
        let (mut time, mut u) = (0.0, 0.0);
        let mut row = |time: f64, u: f64, z: f64| {
            let value = |input: &VariableRef| {
                let start = if let Some(Value::Real(start)) = input.start { start } else { 0.0 };
                match input.name.as_str() {
                    name if name == along => start + u,
                    name if name == down => start + z,
                    _ => start,
                }
            };
            motion.times.push(time);
            motion.values.push(inputs.iter().map(value).collect());
        };
        row(time, u, 0.0);
        let step = |(rows, times): (u32, f64)| times * self.stick_time / f64::from(rows);
        for i in 1..=PRESS.0 {
            time += step(PRESS);
            row(time, u, depth * f64::from(i) / f64::from(PRESS.0));
        }
        for direction in [1.0, -1.0] {
            for _ in 0..SLIDE.0 {
                time += step(SLIDE);
                u += direction * self.speed * step(SLIDE);
                row(time, u, depth);
            }
        }
        motion
    }
}

/// The folder of the layered standard, and the files in it that are read again.
pub(super) const FOLDER: &str = "extra/org.fmi-standard.fmi-ls-ref";
pub(super) const MANIFEST: &str = "extra/org.fmi-standard.fmi-ls-ref/fmi-ls-manifest.xml";
pub(super) const EXPERIMENT: &str = "extra/org.fmi-standard.fmi-ls-ref/experiment.csv";
pub(super) const RESULT: &str = "extra/org.fmi-standard.fmi-ls-ref/result.csv";
/// What is left out of it and why, a line each: no part of the standard, so beside its folder.
pub(super) const LEFT_OUT_FILE: &str = "extra/org.asperity/left-out.txt";
/// More than this is left out, the parameter set first: bytes.
const MOST_BYTES: usize = 100_000;

/// What comes with an FMU.
#[derive(Debug)]
pub(super) struct References {
    /// The files of the folder.
    pub(super) entries: Vec<ArchiveEntry>,
    /// What is left out of it and why.
    pub(super) left_out: Vec<String>,
    /// What variables are by size, as the experiment has them.
    pub(super) nominals: Nominals,
}

/// The files of the folder. `resources` are the paths of the files in resources/; `variables` have the names that the
/// FMU's have.
///
/// # Errors
/// Where a document cannot be written.
pub(super) fn entries(
    definition: &Definition,
    variables: &VariableTable,
    (resources, has_picture): (&[&str], bool),
) -> io::Result<References> {
    let mut related: Vec<Related> = resources.iter().map(|name| Related::resource(name)).collect();
    related.push(Related::new("../../documentation/index.html", "document", "What it computes, its variables"));
    related.extend(has_picture.then(|| Related::new("../../model.png", "document", "A picture of it")));
    let mut files = Vec::new();
    let (mut left_out, mut nominals) = (Vec::new(), Nominals::new());
    let found = tables(definition, variables).map_err(|why| left_out.push(format!("no experiment and result: {why}")));
    if let Ok(found) = found {
        left_out.extend(found.early_end.map(|early| format!("a part of the experiment alone: {early}")));
        related.push(Related::new(
            "experiment.exp",
            "experiment/smoke-test",
            "Inputs along which the result is got again",
        ));
        related.push(Related::new("experiment.csv", "other", "Inputs at times, straight from row to row"));
        related.push(Related::new("result.csv", "result", &found.description));
        files.push(("experiment.exp", experiment(&definition.name(), &found.setup)?));
        files.extend([("experiment.csv", found.inputs.into_bytes()), ("result.csv", found.result.into_bytes())]);
        nominals = found.nominals;
    }
    let size: usize = files.iter().map(|(_, bytes)| bytes.len()).sum();
    let parameters = parameter_set(&definition.name(), variables)?;
    match parameters {
        Some(parameters) if size + parameters.len() <= MOST_BYTES => {
            related.push(Related::new("parameters.ssv", "parameter", "The start values of all parameters"));
            files.push(("parameters.ssv", parameters));
        }
        Some(_) => left_out.push(format!("no set of parameters: with it there were more than {MOST_BYTES} bytes")),
        None => (),
    }
    files.push(("fmi-ls-manifest.xml", manifest(&related)?));
    let entry = |(name, bytes)| ArchiveEntry::new(format!("{FOLDER}/{name}"), bytes);
    let mut entries: Vec<ArchiveEntry> = files.into_iter().map(entry).collect();
    if !left_out.is_empty() {
        entries.push(ArchiveEntry::new(LEFT_OUT_FILE, left_out.join("\n") + "\n"));
    }
    Ok(References { entries, left_out, nominals })
}

/// The experiment with its tables, in the form of MA-HS-Experiments.
fn experiment(name: &str, setup: &ExperimentSetup) -> io::Result<Vec<u8>> {
    let [start, stop, step] = [setup.times[0], setup.times[1], setup.step].map(real);
    let tolerance = setup.tolerance.map(real);
    let content = |xml: &mut Xml| {
        let times = [("startTime", &*start), ("stopTime", &*stop), ("stepSize", &*step)];
        xml.create_element("TransientSimulation").with_attributes(times).write_empty()?;
        xml.create_element("Stimuli").with_attribute(("source", "experiment.csv")).write_empty()?;
        xml.create_element("References").with_attribute(("source", "result.csv")).write_empty()?;
        Ok(())
    };
    let name = clean(name);
    document(|xml| {
        xml.create_element("Experiments")
            .with_attribute(("name", name.as_str()))
            .write_inner_content(|xml| {
                xml.create_element("Experiment")
                    .with_attribute(("name", "smoke test"))
                    .with_attribute(("description", "The inputs go straight from row to row, with rates given"))
                    .with_attributes(tolerance.as_deref().map(|tolerance| ("tolerance", tolerance)))
                    .write_inner_content(content)
                    .map(drop)
            })
            .map(drop)
    })
}

/// Characters of a path that stand for themselves in a URI (RFC 3986, section 3.3).
const OF_PATH: &AsciiSet = &NON_ALPHANUMERIC.remove(b'/').remove(b'.').remove(b'-').remove(b'_').remove(b'~');

/// A file that comes with an FMU.
#[derive(Debug)]
struct Related {
    /// Its place, from the manifest's folder.
    source: String,
    /// What it is for, as the standard calls it.
    role: &'static str,
    description: String,
}

impl Related {
    fn new(source: &str, role: &'static str, description: &str) -> Self {
        Self { source: source.into(), role, description: description.into() }
    }

    /// A file in resources/.
    fn resource(name: &str) -> Self {
        Self::new(&format!("../../{name}"), "model", "What the FMU simulates, as it was packed")
    }

    /// The media type.
    fn media_type(&self) -> &'static str {
        match Path::new(&self.source).extension().and_then(|extension| extension.to_str()) {
            Some("toml") => "application/toml",
            Some("exp") => "application/x-ma-hs-experiments",
            Some("csv") => "text/csv",
            Some("txt") => "text/plain",
            Some("html") => "text/html",
            Some("png") => "image/png",
            Some("ssv") => "application/x-ssp-parameter-set",
            _ => "application/octet-stream",
        }
    }
}

/// The manifest of these files, fmi-ls-manifest.xml of FMI-LS-REF, 1.0.0-beta.1.
fn manifest(files: &[Related]) -> io::Result<Vec<u8>> {
    let related = |xml: &mut Xml, file: &Related| {
        xml.create_element("Related")
            .with_attribute(("type", file.media_type()))
            .with_attribute(("source", utf8_percent_encode(&file.source, OF_PATH).to_string().as_str()))
            .with_attribute(("role", file.role))
            .with_attribute(("description", clean(&file.description).as_str()))
            .write_empty()
            .map(drop)
    };
    document(|xml| {
        xml.create_element("fmiReferences")
            .with_attribute(("xmlns:fmi-ls", "http://fmi-standard.org/fmi-ls-manifest"))
            .with_attribute(("fmi-ls:fmi-ls-name", "org.fmi-standard.fmi-ls-ref"))
            .with_attribute(("fmi-ls:fmi-ls-version", "1.0.0-beta.1"))
            // The standard fixes these words.
            .with_attribute((
                "fmi-ls:fmi-ls-description",
                "Layered Standard providing information on related files included in an FMU.",
            ))
            .write_inner_content(|xml| files.iter().try_for_each(|file| related(xml, file)))
            .map(drop)
    })
}

fn parameters(variables: &VariableTable) -> impl Iterator<Item = &VariableRef> {
    let is_parameter = |variable: &&VariableRef| matches!(variable.role, Role::Parameter(_));
    variables.entries().map(|(_, variable)| variable).filter(is_parameter)
}

/// The start values of the parameters of the model called `name`, as a parameter set of SSP 1.0 (SSV); `None` where it has
/// none.
fn parameter_set(name: &str, variables: &VariableTable) -> io::Result<Option<Vec<u8>>> {
    if parameters(variables).next().is_none() {
        return Ok(None);
    }
    let written = document(|xml| {
        xml.create_element("ssv:ParameterSet")
            .with_attribute(("xmlns:ssv", "http://ssp-standard.org/SSP1/SystemStructureParameterValues"))
            .with_attribute(("version", "1.0"))
            .with_attribute(("name", format!("{} as packed", clean(name)).as_str()))
            .write_inner_content(|xml| {
                let all = |xml: &mut Xml| parameters(variables).try_for_each(|variable| parameter(xml, variable));
                xml.create_element("ssv:Parameters").write_inner_content(all).map(drop)
            })
            .map(drop)
    });
    written.map(Some)
}

fn parameter(xml: &mut Xml, variable: &VariableRef) -> io::Result<()> {
    let kind = match variable.kind {
        Kind::Real => "ssv:Real",
        Kind::Integer => "ssv:Integer",
        Kind::Boolean => "ssv:Boolean",
        Kind::Text => "ssv:String",
    };
    let value = start(variable).unwrap_or_default();
    let write =
        |xml: &mut Xml| xml.create_element(kind).with_attribute(("value", value.as_str())).write_empty().map(drop);
    xml.create_element("ssv:Parameter")
        .with_attribute(("name", variable.name.as_str()))
        .write_inner_content(write)
        .map(drop)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layer(masses: u32, phases: &str) -> Definition {
        let text = format!(
            "name = 's'\nlayer = {{ masses = {masses}, spacing = 1e-4, mass = 1e-7, clearance = 2.1e-5, \
             vertical = {{ stiffness = 2e3, damping = 8e-3 }}, horizontal = {{ stiffness = 1e3 }} }}\n\
             surface = {{ kind = 'sinusoid', amplitude = 2e-5, wavelength = 8e-4 }}\nexcitation = [{phases}]"
        );
        Scene::parse(&text, "s.toml".as_ref()).unwrap().into()
    }

    fn found(definition: &Definition) -> Result<ExperimentTables, String> {
        tables(definition, &definition.variables())
    }

    /// At the first touch the error is that of a force that is next to nothing.
    #[test]
    fn the_error_of_a_result_is_that_over_the_largest_force_of_the_whole_run() {
        let definition = layer(8, "{ duration = 5e-3, w_rate = -0.01 }");
        let said = found(&definition).unwrap().description;
        let budget = Budget(WORK / (STEP + 8));
        let tight = tight(&definition, budget);
        let (rows, _) = rows(&tight, &InputMotion::new(&definition, budget).unwrap(), budget).unwrap();
        let error = tight.calculated().iter().position(|variable| variable.name == ERROR).unwrap();
        let expected = format!("its estimated error is {} of the largest force", short(rows[rows.len() - 1][error], 2));
        assert!(said.ends_with(&expected), "{said}: {expected}");
    }

    #[test]
    fn an_experiment_that_is_left_out_or_ends_early_says_why() {
        assert_eq!(found(&layer(8, "")).unwrap_err(), "the scene has no excitation");
        // It touches after 100 s of 1e4, and then passes 60 000 waves from row to row.
        let long = "{ duration = 1e4, w_rate = -1e-8, u_rate = 1.0 }";
        let why = found(&layer(8, long)).unwrap_err();
        assert!(why.starts_with("its run ends at ") && why.contains("steps"), "{why}");
        let until = long.replace(" }", ", until_force = 1e3 }");
        let why = found(&layer(8, &until)).unwrap_err();
        assert!(why.starts_with("its run ends within phase 1: it is too long for packing"), "{why}");
    }

    #[test]
    fn a_path_becomes_a_uri() {
        let text = String::from_utf8(manifest(&[Related::resource("resources/my road #2.csv")]).unwrap()).unwrap();
        assert!(text.contains("source=\"../../resources/my%20road%20%232.csv\""), "{text}");
        assert!(text.contains("type=\"text/csv\"") && text.contains("role=\"model\""), "{text}");
    }
}
