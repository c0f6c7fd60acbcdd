//! `asperity simulate`: runs a scene along its excitation, writes a result file and draws what is asked for.

use std::borrow::Cow;
use std::fmt::Display;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use asperity::outputs::{OutputType, Snapshot, Variable, variables};
use asperity::scene::Scene;
use asperity::simulation::MethodSwitch;
use asperity_study::csv::Head;
use asperity_study::masses::{self, ElementField, ElementHistory, Instant, Span};
use asperity_study::run_figures::{RunFigures, implausible_run};
use asperity_study::runner::RunOptions;
use asperity_study::runner::{InputSample, Rows, Runner};
use asperity_study::time_history::TimeHistory;
use asperity_study::{Context as _, Error};
use clap::builder::{StringValueParser, TypedValueParser};
use clap::{ArgGroup, Args};
use indicatif::ProgressBar;

use super::cli::values::{self, Set, animation, arrays, example, seconds};
use super::files::{self, check_outputs, default_output, ends_in, load, named, print_beside};
use super::npz::{Array, Values, npz};
use super::picture;
use super::result_file::ResultWriter;
use super::terminal::{LabelledLine, bar, is_verbose, lines, note, warn};

#[derive(Debug, Args)]
#[command(override_usage = "asperity simulate [OPTIONS]\n       <SCENE.toml|--patch <PATCH.toml>|--seal <SEAL.toml>>")]
#[command(group(ArgGroup::new("simulated").required(true).args(["scene", "patch", "seal"])))]
#[command(after_help = example!("asperity simulate scenes/tread-block/tread-block.toml -o block.csv --plot block.svg"))]
pub(crate) struct Simulate {
    /// The scene file.
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: Option<PathBuf>,
    /// A patch file: moves a contact patch along the motion instead.
    #[arg(long, value_name = "PATCH.toml", requires = "motion", conflicts_with = "rows")]
    pub(crate) patch: Option<PathBuf>,
    /// A seal file: moves the rod under a lip with a film along the motion instead.
    #[arg(long, value_name = "SEAL.toml", requires = "motion")]
    #[arg(conflicts_with_all = ["rows", "animate", "contact", "elements", "stats"])]
    pub(crate) seal: Option<PathBuf>,
    /// The motion of a patch: columns time, x, y, z, roll, pitch, yaw, with a tread transport.speed, and temperature; of a
    /// seal: time, u, and sealed_pressure, w and temperature where they change. One step from row to row.
    #[arg(long, value_name = "MOTION.csv", conflicts_with = "scene")]
    pub(crate) motion: Option<PathBuf>,
    /// The result file to write; - for standard output. Default: the name of the scene, patch or seal with .csv, in this
    /// folder.
    #[arg(short, long, value_name = "OUT.csv")]
    output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) options: RunOptions,
    #[command(flatten)]
    pub(crate) set: Set,
    /// Plots forces, contacts and dissipation over time, as SVG or PNG according to the file name.
    #[arg(long, value_name = "OUT.svg", value_parser = values::picture())]
    pub(crate) plot: Option<PathBuf>,
    /// Animates the contact: the layer on its profile, pressure, stick and slip, flash temperature, forces. A page for
    /// a browser (.html), or a row of pictures (.png: OUT-001.png and so on).
    #[arg(long, value_name = "OUT.html", value_parser = animation(), conflicts_with = "patch")]
    pub(crate) animate: Option<PathBuf>,
    /// Draws the layer, the profile and the pressure at a time in s, as SVG or PNG; the result file has a row there
    /// too. May be repeated.
    #[arg(long, value_name = "TIME=OUT.svg", value_parser = moment(), conflicts_with = "patch")]
    pub(crate) contact: Vec<(f64, PathBuf)>,
    /// Writes position, forces, mode and flash temperature of all masses as arrays of numpy, a line for each result
    /// row, and the profile.
    #[arg(long, value_name = "OUT.npz", value_parser = arrays(), conflicts_with = "patch")]
    pub(crate) elements: Option<PathBuf>,
    /// Writes units behind the names of the result file's columns: F_x [N].
    #[arg(long)]
    units: bool,
    /// Also prints what the run cost, and what would make it cheaper.
    #[arg(long, conflicts_with = "patch")]
    pub(crate) stats: bool,
}

impl Simulate {
    /// The result file of a run of what is in the file `simulated`.
    pub(crate) fn output(&self, simulated: &Path) -> PathBuf {
        self.output.clone().unwrap_or_else(|| default_output(simulated, "csv"))
    }

    /// What is above the columns of the result file.
    pub(crate) fn head(&self) -> Head {
        if self.units { Head::NameAndUnit } else { Head::Name }
    }
}

/// A time in s, and a file for a plot of that instant.
fn moment() -> impl TypedValueParser<Value = (f64, PathBuf)> {
    StringValueParser::new().try_map(|text| {
        let (time, path) = text.split_once('=').ok_or("expected TIME=OUT.svg, such as 2e-3=contact.svg")?;
        let path = PathBuf::from(path);
        let is_picture = ["svg", "png"].into_iter().any(|ending| ends_in(&path, ending));
        if !is_picture {
            return Err("expected a name that ends in .svg or .png after TIME=".to_owned());
        }
        Ok((seconds(time)?, path))
    })
}

/// What is said before why a run cannot start.
pub(crate) const NOT_STARTED: &str = "the run cannot start";

/// Why a run ended at `time` (s), and where its rows are.
pub(crate) fn ended_at(error: impl Display, time: f64, output: &Path) -> Error {
    Error::run(format!("{error}; the rows so far, up to t = {time} s, are in {}", named(output)))
}

/// Runs the scene, writes the rows and draws what is asked for.
pub(crate) fn simulate(command: &Simulate, path: &Path) -> Result<(), Error> {
    let scene = load(path, &command.set)?;
    let output = command.output(path);
    let pictures = command.plot.iter().chain(&command.animate).chain(&command.elements);
    let outputs = [&output].into_iter().chain(pictures).chain(command.contact.iter().map(|(_, picture)| picture));
    check_outputs(outputs, scene.sources(path))?;
    check_end(command, scene.duration())?;
    if scene.excitation.is_empty() {
        warn("the scene has no [[excitation]]: the carrier rests, and the result file has the initial row only");
    }
    Rows::PerPhase(command.options.rows).check(&scene, numbers_of_masses(&scene, command)).context(NOT_STARTED)?;
    let mut recorder = Recorder::new(&scene, command, &output)?;
    let result = run(&scene, command, &mut recorder)?;
    let (history, elements) = recorder.finish()?;
    let mut summary = result?;
    if let (Some(path), Some(history)) = (&command.plot, history) {
        picture::write(&history.picture(), path)?;
    }
    if let Some(elements) = elements {
        write_elements(&elements, command)?;
    }
    summary.push(("Written", written(command, &output)));
    print_beside([&output], &lines(&summary))
}

/// Whether what shows the masses is asked for.
fn shows_elements(command: &Simulate) -> bool {
    command.animate.is_some() || command.elements.is_some() || !command.contact.is_empty()
}

/// Numbers of all masses that are kept of a row.
fn numbers_of_masses(scene: &Scene, command: &Simulate) -> usize {
    /// Place, forces, mode and flash temperature.
    const OF_MASS: usize = 6;
    if shows_elements(command) { OF_MASS * scene.layer.masses } else { 0 }
}

/// The files of a run.
fn written(command: &Simulate, output: &Path) -> String {
    let pictures = command.contact.iter().map(|(_, picture)| picture);
    let others = [&command.plot, &command.animate, &command.elements].into_iter().flatten();
    let files = others.chain(pictures).map(|path| path.display().to_string());
    [named(output)].into_iter().chain(files).collect::<Vec<_>>().join(", ")
}

/// Refuses a picture of a time after the run's `end` (s).
fn check_end(command: &Simulate, end: f64) -> Result<(), Error> {
    /// Relative rounding error of a sum of durations.
    const ROUNDING: f64 = 1e-9;
    let late = command.contact.iter().find(|(time, _)| *time > end * (1.0 + ROUNDING));
    late.map_or(Ok(()), |&(time, _)| Err(Error::value(format!("--contact {time}: the run ends at t = {end} s"))))
}

/// Writes what shows the masses.
fn write_elements(elements: &ElementHistory, command: &Simulate) -> Result<(), Error> {
    if let Some(path) = &command.elements {
        write_arrays(elements, path)?;
    }
    match &command.animate {
        Some(path) if ends_in(path, "html") => {
            let page = masses::animation(elements).map_err(|error| files::not_drawn(path, error))?;
            files::write(path, page)?;
        }
        Some(path) => write_frames(elements, path)?,
        None => (),
    }
    // A phase that a force ends may end the run before its nominal duration.
    check_end(command, elements.rows().last().map_or(0.0, |row| row.time))?;
    for (time, path) in &command.contact {
        if let Some(row) = elements.row_at(*time) {
            picture::write(&elements.picture(row), path)?;
        }
    }
    Ok(())
}

/// Draws the masses in a row of pictures, of which there are at most as many as one likes to wait for.
fn write_frames(elements: &ElementHistory, path: &Path) -> Result<(), Error> {
    const MOST: usize = 100;
    let rows = elements.evenly_in_time(MOST);
    let span = Span::over(elements, &rows);
    picture::write_all(rows.len(), |i| elements.frame(rows[i], span), path)
}

/// Runs the scene; what the run comes to, or why it ended before its end.
///
/// # Errors
/// Where it cannot start, or its rows cannot be written: what is recorded of it is of no use then.
fn run(scene: &Scene, command: &Simulate, recorder: &mut Recorder) -> Result<Result<Vec<LabelledLine>, Error>, Error> {
    let rows = Rows::PerPhase(command.options.rows);
    let runner = Runner::new(recorder.shown(scene), rows, 0.0).context(NOT_STARTED)?;
    let mut runner = runner.with_rows_at(command.contact.iter().map(|&(time, _)| time).collect());
    let mut written = Ok(());
    let result = runner.run(&scene.excitation, |carrier, snapshot| {
        written = recorder.row(carrier, snapshot);
        if written.is_ok() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    });
    // Without the rows the rest of the run, which may take hours, is of no use.
    written?;
    runner.take_warnings().iter().for_each(|warning| warn(warning));
    print_method_switches(&runner.take_method_switches());
    if let Some(inaccuracy) = runner.simulation().inaccuracy() {
        warn(&inaccuracy.to_string());
    }
    if let Err(error) = result {
        return Ok(Err(ended_at(error, recorder.time, &recorder.output)));
    }
    let shown = recorder.shown(scene);
    implausible_run(shown, &recorder.figures, runner.simulation()).iter().for_each(|warning| warn(warning));
    let mut summary = recorder.figures.lines(shown, runner.simulation());
    if command.stats {
        summary.extend(recorder.figures.statistics(shown, runner.simulation()));
    }
    Ok(Ok(summary))
}

/// The switches of method *auto* in one line, each with why where every note is asked for.
fn print_method_switches(switches: &[MethodSwitch]) {
    const MOST: usize = 4;
    if is_verbose() {
        switches.iter().for_each(|switch| note(&switch.to_string()));
        return;
    }
    let brief = |switch: &MethodSwitch| {
        let driver = if switch.to_time_stepping { "time-stepping" } else { "event-driven" };
        format!("{driver} from t = {:.4e} s on", switch.time)
    };
    let mut texts: Vec<String> = switches.iter().take(MOST).map(brief).collect();
    if switches.len() > MOST {
        texts.push(format!("and {} more switches (-v prints all)", switches.len() - MOST));
    }
    if !texts.is_empty() {
        note(&format!("method auto: {}", texts.join(", ")));
    }
}

/// Writes the rows of a run to the file, keeps them for pictures and moves the progress bar.
struct Recorder {
    variables: Vec<Variable>,
    values: Vec<f64>,
    output: PathBuf,
    writer: ResultWriter,
    history: Option<TimeHistory>,
    elements: Option<ElementHistory>,
    figures: RunFigures,
    progress: ProgressBar,
    duration: f64,
    time: f64,
}

const PROGRESS_LENGTH: f64 = 1000.0;

impl Recorder {
    fn new(scene: &Scene, command: &Simulate, output: &Path) -> Result<Self, Error> {
        let variables = variables(scene);
        Ok(Self {
            values: vec![0.0; variables.len()],
            output: output.to_owned(),
            writer: ResultWriter::create(output, &scene.inputs(), &variables, command.head())?,
            variables,
            history: command.plot.is_some().then(|| TimeHistory::new(scene)),
            elements: shows_elements(command).then(|| ElementHistory::new(scene)),
            figures: RunFigures::default(),
            progress: bar(PROGRESS_LENGTH as u64),
            duration: scene.duration(),
            time: 0.0,
        })
    }

    /// The `scene`, with the output groups that the plot needs.
    fn shown<'a>(&'a self, scene: &'a Scene) -> &'a Scene {
        self.history.as_ref().map_or(scene, TimeHistory::scene)
    }

    fn row(&mut self, carrier: InputSample, snapshot: &Snapshot<'_>) -> Result<(), Error> {
        snapshot.evaluate(&self.variables, &mut self.values);
        self.writer.write(carrier, &self.values)?;
        if let Some(history) = &mut self.history {
            history.add(carrier.time, snapshot);
        }
        if let Some(elements) = &mut self.elements {
            elements.add(carrier.time, snapshot);
        }
        self.figures.add(snapshot);
        self.time = carrier.time;
        if self.duration > 0.0 && !self.progress.is_hidden() {
            self.progress.set_position((PROGRESS_LENGTH * self.time / self.duration) as u64);
            self.progress.set_message(format!("t = {:.4e} s", self.time));
        }
        Ok(())
    }

    fn finish(self) -> Result<(Option<TimeHistory>, Option<ElementHistory>), Error> {
        self.progress.finish_and_clear();
        self.writer.finish()?;
        Ok((self.history, self.elements))
    }
}

/// Writes the rows' times, displacements and forces, the fields of the masses with a line for each row, the masses'
/// positions at rest, the area that each stands for where the scene gives it, and the data points of the profile.
fn write_arrays(history: &ElementHistory, path: &Path) -> Result<(), Error> {
    let of_rows = |value: fn(&Instant) -> f64| history.rows().iter().map(value).collect::<Vec<_>>();
    let lines = [
        Array::line("time", of_rows(|row| row.time)),
        Array::line("u", of_rows(|row| row.u)),
        Array::line("w", of_rows(|row| row.w)),
        Array::line("F_x", of_rows(|row| row.force_x)),
        Array::line("F_z", of_rows(|row| row.force_z)),
        Array::line("rest_x", history.rest()),
        Array::line("profile_x", history.surface().x()),
        Array::line("profile_z", history.surface().z()),
    ];
    let area = history.area().map(|area| Array::single("area", area));
    let fields = history.fields().fields().iter().map(|field| array(field, history.rest().len()));
    let archive = npz(lines.into_iter().chain(area).chain(fields));
    let archive = archive.map_err(|error| Error::value(format!("cannot write {}: {error}", path.display())))?;
    files::write(path, archive)
}

fn array(field: &ElementField, masses: usize) -> Array<'_> {
    let values = match field.kind {
        OutputType::Real => Values::Reals(Cow::Borrowed(&field.values)),
        OutputType::Integer => Values::Integers(field.values.iter().map(|&value| value as i8).collect()),
    };
    Array { name: &field.name, shape: vec![field.values.len() / masses, masses], values }
}
