//! `asperity simulate`: runs a scene along its excitation, writes a result file and draws what is asked for.

use std::path::{Path, PathBuf};

use asperity::outputs::{Snapshot, Variable, variables};
use asperity::scene::Scene;
use asperity::simulation::{MethodSwitch, SimulationError};
use indicatif::ProgressBar;

use super::cli::Simulate;
use super::elements::{ArraysError, ElementHistory, Span};
use super::figure::{Figure as _, LayerPicture, TimeHistory, write_film};
use super::files::{FileError, check_outputs, ends_in, load, named, sources};
use super::interrupt::fail;
use super::result_file::ResultWriter;
use super::runner::{CarrierSample, Rows, Runner};
use super::terminal::{bar, note, warn};

/// `asperity simulate` failed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum SimulateError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Arrays(#[from] ArraysError),
    #[error("--contact {time}: the run ends at t = {end} s")]
    AfterEnd { time: f64, end: f64 },
    #[error("the run cannot start: {0}")]
    Start(SimulationError),
    #[error("{source}; the rows so far, up to t = {time} s, are in {}", named(.output))]
    Run { source: SimulationError, time: f64, output: PathBuf },
}

/// Runs the scene, writes the rows and draws what is asked for.
pub(crate) fn simulate(command: &Simulate, path: &Path) -> Result<(), SimulateError> {
    let scene = load(path, &command.set)?;
    let output = command.output(path);
    let pictures = command.plot.iter().chain(&command.animate).chain(&command.elements);
    let outputs = [&output].into_iter().chain(pictures).chain(command.contact.iter().map(|(_, picture)| picture));
    check_outputs(outputs, sources(path, &scene))?;
    check_end(command, scene.duration())?;
    if scene.excitation.is_empty() {
        warn("the scene has no [[excitation]]: the carrier rests, and the result file has the initial row only");
    }
    let mut recorder = Recorder::new(&scene, command, &output)?;
    let result = run(&scene, command, &mut recorder);
    if let Err(error @ SimulateError::Start(_)) = result {
        return Err(error);
    }
    let (history, elements) = recorder.finish()?;
    result?;
    if let (Some(path), Some(history)) = (&command.plot, history) {
        history.write(path)?;
    }
    elements.map_or(Ok(()), |elements| write_elements(&elements, command))
}

/// Refuses a picture of a time after the run's `end` (s).
fn check_end(command: &Simulate, end: f64) -> Result<(), SimulateError> {
    /// Relative rounding error of a sum of durations.
    const ROUNDING: f64 = 1e-9;
    let late = command.contact.iter().find(|(time, _)| *time > end * (1.0 + ROUNDING));
    late.map_or(Ok(()), |&(time, _)| Err(SimulateError::AfterEnd { time, end }))
}

/// Writes what shows the masses.
fn write_elements(elements: &ElementHistory, command: &Simulate) -> Result<(), SimulateError> {
    if let Some(path) = &command.elements {
        elements.write_arrays(path)?;
    }
    match &command.animate {
        Some(path) if ends_in(path, "html") => elements.write_page(path)?,
        Some(path) => write_frames(elements, path)?,
        None => (),
    }
    // A phase that a force ends may end the run before its nominal duration.
    check_end(command, elements.rows().last().map_or(0.0, |row| row.time))?;
    for (time, path) in &command.contact {
        if let Some(row) = elements.row_at(*time) {
            LayerPicture::alone(elements, row).write(path)?;
        }
    }
    Ok(())
}

/// Animates the masses in pictures, of which there are at most as many as one likes to wait for.
fn write_frames(elements: &ElementHistory, path: &Path) -> Result<(), FileError> {
    const MOST: usize = 100;
    let rows = elements.evenly_in_time(MOST);
    let span = Span::over(elements, &rows);
    write_film(rows.len(), |i| LayerPicture::in_film(elements, rows[i], span), path)
}

fn run(scene: &Scene, command: &Simulate, recorder: &mut Recorder) -> Result<(), SimulateError> {
    let shown = recorder.history.as_ref().map_or(scene, TimeHistory::scene);
    let runner = Runner::new(shown, Rows::PerPhase(command.points), 0.0).map_err(SimulateError::Start)?;
    let mut runner = runner.with_rows_at(command.contact.iter().map(|&(time, _)| time).collect());
    let result = runner.run(&scene.excitation, |carrier, snapshot| recorder.row(carrier, snapshot));
    runner.take_warnings().iter().for_each(|warning| warn(warning));
    print_method_switches(&runner.take_method_switches());
    if let Some(inaccuracy) = runner.simulation().inaccuracy() {
        warn(&inaccuracy.to_string());
    }
    match result {
        Ok(_) => Ok(()),
        Err(source) => Err(SimulateError::Run { source, time: recorder.time, output: recorder.output.clone() }),
    }
}

fn print_method_switches(switches: &[MethodSwitch]) {
    const MOST: usize = 10;
    for switch in switches.iter().take(MOST) {
        note(&switch.to_string());
    }
    if switches.len() > MOST {
        note(&format!("and {} more method switches", switches.len() - MOST));
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
    progress: ProgressBar,
    duration: f64,
    time: f64,
}

const PROGRESS_LENGTH: f64 = 1000.0;

impl Recorder {
    fn new(scene: &Scene, command: &Simulate, output: &Path) -> Result<Self, FileError> {
        let variables = variables(scene);
        let shows_elements = command.animate.is_some() || command.elements.is_some() || !command.contact.is_empty();
        Ok(Self {
            values: vec![0.0; variables.len()],
            output: output.to_owned(),
            writer: ResultWriter::create(output, &scene.inputs(), &variables)?,
            variables,
            history: command.plot.is_some().then(|| TimeHistory::new(scene)),
            elements: shows_elements.then(|| ElementHistory::new(scene)),
            progress: bar(PROGRESS_LENGTH as u64),
            duration: scene.duration(),
            time: 0.0,
        })
    }

    fn row(&mut self, carrier: CarrierSample, snapshot: &Snapshot<'_>) {
        snapshot.evaluate(&self.variables, &mut self.values);
        if let Err(error) = self.writer.write(carrier, &self.values) {
            // An observer cannot stop the run, which may take hours.
            fail(&error);
        }
        if let Some(history) = &mut self.history {
            history.add(carrier.time, snapshot);
        }
        if let Some(elements) = &mut self.elements {
            elements.add(carrier.time, snapshot);
        }
        self.time = carrier.time;
        if self.duration > 0.0 && !self.progress.is_hidden() {
            self.progress.set_position((PROGRESS_LENGTH * self.time / self.duration) as u64);
            self.progress.set_message(format!("t = {:.4e} s", self.time));
        }
    }

    fn finish(self) -> Result<(Option<TimeHistory>, Option<ElementHistory>), FileError> {
        self.progress.finish_and_clear();
        self.writer.finish()?;
        Ok((self.history, self.elements))
    }
}
