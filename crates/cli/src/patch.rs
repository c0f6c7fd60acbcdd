//! `asperity simulate --patch`: moves a patch along a motion file and writes a result file.

use std::path::Path;

use asperity::outputs::OutputType;
use asperity::patch::{Patch, PatchRun, PatchVariable};
use asperity_study::csv::Field;
use asperity_study::decimals::with_prefix;
use asperity_study::motion::MotionFile;
use asperity_study::patch_history::PatchHistory;
use asperity_study::{Context as _, Error};

use crate::files::{check_outputs, load_patch, named, print_beside, tell};
use crate::picture;
use crate::result_file::CsvWriter;
use crate::simulate::{NOT_STARTED, Simulate, ended_at};
use crate::terminal::{lines, warn};

/// Moves the patch, writes the rows and draws the plot.
pub(crate) fn simulate(command: &Simulate, patch_file: &Path, motion_file: &Path) -> Result<(), Error> {
    let patch = load_patch(patch_file, &command.set)?;
    let mut taken = patch.sources(patch_file);
    taken.push(motion_file.to_owned());
    let output = command.output(patch_file);
    check_outputs([&output].into_iter().chain(&command.plot), taken)?;
    let motion = MotionFile::read(motion_file, &patch)?;
    tell(&motion.notes);
    let mut recorder = PatchRecorder::new(&patch, &motion, &output, command)?;
    let mut run = PatchRun::new(&patch, &motion.start()).context(NOT_STARTED)?;
    recorder.row(&mut run, motion.values(&motion.rows()[0]))?;
    let mut result = Ok(());
    for (step, row) in motion.motions() {
        if let Err(error) = run.advance(&step) {
            result = Err(ended_at(error, run.time(), &output));
            break;
        }
        recorder.row(&mut run, motion.values(row))?;
    }
    let forces = recorder.forces();
    let history = recorder.finish()?;
    result?;
    if let (Some(path), Some(history)) = (&command.plot, history) {
        picture::write(&history.picture(), path)?;
    }
    let steps = format!("{} steps to t = {} s", motion.rows().len() - 1, run.time());
    let files = [output.as_path()].into_iter().chain(command.plot.as_deref()).map(named).collect::<Vec<_>>();
    let summary = lines(&[("At the end", forces), ("Run", steps), ("Written", files.join(", "))]);
    print_beside([&output], &summary)
}

/// Writes the rows of a run to the file and keeps them for the plot.
struct PatchRecorder {
    variables: Vec<PatchVariable>,
    values: Vec<f64>,
    writer: CsvWriter,
    history: Option<PatchHistory>,
}

impl PatchRecorder {
    fn new(patch: &Patch, motion: &MotionFile, output: &Path, command: &Simulate) -> Result<Self, Error> {
        let variables = patch.variables();
        let of_variables = variables.iter().map(|variable| (variable.name.as_str(), variable.unit));
        let columns = motion.columns().into_iter().chain(of_variables);
        let names: Vec<String> = columns.map(|(name, unit)| command.head().of(name, unit)).collect();
        Ok(Self {
            values: vec![0.0; variables.len()],
            writer: CsvWriter::create(output, names.iter().map(String::as_str))?,
            history: command.plot.is_some().then(|| PatchHistory::new(patch, &motion.times())),
            variables,
        })
    }

    /// Writes the row of the present instant, and says what the run has to say.
    fn row(&mut self, run: &mut PatchRun, motion: Vec<f64>) -> Result<(), Error> {
        run.take_warnings().iter().for_each(|warning| warn(warning));
        run.evaluate(&self.variables, &mut self.values);
        let variables = self.variables.iter().zip(&self.values);
        let variables = variables.map(|(variable, &value)| Field { kind: variable.kind, value });
        let motion = motion.into_iter().map(|value| Field { kind: OutputType::Real, value });
        self.writer.write_values(motion.chain(variables))?;
        if let Some(history) = &mut self.history {
            history.add(run);
        }
        Ok(())
    }

    /// The forces of the last row.
    fn forces(&self) -> String {
        let is_shown = |variable: &PatchVariable| variable.name.starts_with("force.");
        let shown = self.variables.iter().zip(&self.values).filter(|(variable, _)| is_shown(variable));
        let text = |(variable, &value): (&PatchVariable, &f64)| {
            format!("{} {}", variable.name, with_prefix(value, value, variable.unit.name()))
        };
        shown.map(text).collect::<Vec<_>>().join(", ")
    }

    fn finish(self) -> Result<Option<PatchHistory>, Error> {
        self.writer.finish()?;
        Ok(self.history)
    }
}
