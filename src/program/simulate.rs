//! `asperity simulate`: runs a scene along its excitation.

use asperity::outputs::{Variable, variables};
use asperity::scene::Scene;
use asperity::simulation::{Handover, Simulation};
use indicatif::ProgressBar;

use super::arguments::Simulate;
use super::error::ProgramError;
use super::excitation::{Carrier, Rows, Run};
use super::plot::History;
use super::progress;
use super::result_file::ResultWriter;

/// Positions of the progress bar: fine enough to move at every row of a usual run.
const PROGRESS_LENGTH: f64 = 1000.0;

/// Runs the scene, writes the rows, draws the plot.
pub(crate) fn simulate(command: &Simulate) -> Result<(), ProgramError> {
    let mut scene = super::load(&command.scene)?;
    super::set_parameters(&mut scene, &command.set)?;
    check_outputs(&scene, command)?;
    if scene.excitation.is_empty() {
        super::warn("the scene has no [[excitation]]: the carrier rests, and the start is all there is");
    }
    let mut recorder = Recorder::new(&scene, command)?;
    let result = record(&scene, command, &mut recorder);
    let history = recorder.finish()?;
    result?;
    match (&command.plot, history) {
        (Some(path), Some(history)) => history.draw(path, &scene.name),
        _ => Ok(()),
    }
}

fn check_outputs(scene: &Scene, command: &Simulate) -> Result<(), ProgramError> {
    let mut taken = super::sources(&command.scene, scene);
    super::check_output(&command.output, &taken)?;
    taken.push(command.output.clone());
    command.plot.as_ref().map_or(Ok(()), |plot| super::check_output(plot, &taken))
}

fn record(scene: &Scene, command: &Simulate, recorder: &mut Recorder) -> Result<(), ProgramError> {
    let shown = recorder.history.as_ref().map_or_else(|| scene.clone(), |history| history.scene().clone());
    let mut run = Run::new(&shown, Rows::PerPhase(command.points)).map_err(ProgramError::Start)?;
    let result = run.follow(&scene.excitation, |carrier, simulation| recorder.row(carrier, simulation));
    tell_of_handovers(&run.take_handovers());
    result.map(drop).map_err(|source| ProgramError::Run { source, time: recorder.time, output: command.output.clone() })
}

/// Handovers that are told one by one.
const HANDOVERS_TOLD: usize = 10;

fn tell_of_handovers(handovers: &[Handover]) {
    for handover in handovers.iter().take(HANDOVERS_TOLD) {
        super::note(&handover.to_string());
    }
    if handovers.len() > HANDOVERS_TOLD {
        super::note(&format!("and {} more handovers", handovers.len() - HANDOVERS_TOLD));
    }
}

/// Takes the rows of a run: into the file, the plot and the progress bar.
struct Recorder {
    variables: Vec<Variable>,
    values: Vec<f64>,
    writer: ResultWriter,
    history: Option<History>,
    progress: ProgressBar,
    duration: f64,
    time: f64,
    /// The first failure to write: the run itself cannot be stopped from a row.
    failure: Option<ProgramError>,
}

impl Recorder {
    fn new(scene: &Scene, command: &Simulate) -> Result<Self, ProgramError> {
        let variables = variables(scene);
        Ok(Self {
            values: vec![0.0; variables.len()],
            writer: ResultWriter::create(&command.output, &variables)?,
            variables,
            history: command.plot.is_some().then(|| History::new(scene)),
            progress: progress::bar(PROGRESS_LENGTH as u64),
            duration: scene.excitation.iter().map(|phase| phase.duration).sum(),
            time: 0.0,
            failure: None,
        })
    }

    fn row(&mut self, carrier: Carrier, simulation: &mut Simulation) {
        if self.failure.is_some() {
            return;
        }
        simulation.evaluate(&self.variables, &mut self.values);
        self.failure = self.writer.write(carrier, &self.values).err();
        if let Some(history) = &mut self.history {
            history.add(carrier.time, simulation);
        }
        self.time = carrier.time;
        self.show_progress();
    }

    fn show_progress(&self) {
        if self.duration > 0.0 {
            self.progress.set_position((PROGRESS_LENGTH * self.time / self.duration) as u64);
            self.progress.set_message(format!("t = {:.4e} s", self.time));
        }
    }

    fn finish(self) -> Result<Option<History>, ProgramError> {
        self.progress.finish_and_clear();
        self.writer.finish()?;
        self.failure.map_or(Ok(self.history), Err)
    }
}
