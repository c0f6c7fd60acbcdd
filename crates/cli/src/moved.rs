//! `asperity simulate --patch` and `--seal`: moves a patch, or the rod of a seal, along a motion file and writes a result
//! file.

use std::path::{Path, PathBuf};

use asperity::outputs::OutputType;
use asperity::patch::PatchRun;
use asperity::scene::Unit;
use asperity::seal::SealRun;
use asperity_study::csv::Field;
use asperity_study::decimals::with_prefix;
use asperity_study::motion::{MotionFile, MotionRow};
use asperity_study::patch_history::PatchHistory;
use asperity_study::picture::Picture;
use asperity_study::seal_history::SealHistory;
use asperity_study::{Context as _, Error};

use crate::files::{check_outputs, load_patch, load_seal, named, print_beside, tell};
use crate::picture;
use crate::result_file::CsvWriter;
use crate::simulate::{NOT_STARTED, Simulate, ended_at};
use crate::terminal::{lines, warn};

/// Moves the patch, writes the rows and draws the plot.
pub(crate) fn simulate_patch(command: &Simulate, patch_file: &Path, motion_file: &Path) -> Result<(), Error> {
    let patch = load_patch(patch_file, &command.set)?;
    let output = checked_output(command, patch_file, patch.sources(patch_file), motion_file)?;
    let motion = MotionFile::of_patch(motion_file, &patch)?;
    tell(&motion.notes);
    let variables = patch.variables();
    let outputs = variables.iter().map(|variable| Column::new(&variable.name, variable.unit, variable.kind));
    let mut rows = RowWriter::new(&output, &motion, command, outputs.collect())?;
    let mut history = command.plot.is_some().then(|| PatchHistory::new(&patch, &motion.times()));
    let mut run = PatchRun::new(&patch, &motion.start_of_patch(&patch)).context(NOT_STARTED)?;
    let record = |run: &mut PatchRun, values: Vec<f64>| {
        run.take_warnings().iter().for_each(|warning| warn(warning));
        run.evaluate(&variables, &mut rows.values);
        if let Some(history) = &mut history {
            history.add(run);
        }
        rows.write(values)
    };
    let result = follow(&mut run, (&motion, motion.motions_of_patch(&patch)), PatchRun::advance, record)?;
    let forces = rows.finish("force.")?;
    result.map_err(|error| ended_at(error, run.time(), &output))?;
    finish(command, &output, (forces, motion.rows().len(), run.time()), history.map(|history| history.picture()))
}

/// Moves the rod of the seal, writes the rows and draws the plot.
pub(crate) fn simulate_seal(command: &Simulate, seal_file: &Path, motion_file: &Path) -> Result<(), Error> {
    let seal = load_seal(seal_file, &command.set)?;
    let output = checked_output(command, seal_file, seal.sources(seal_file), motion_file)?;
    let motion = MotionFile::of_seal(motion_file, &seal)?;
    tell(&motion.notes);
    let variables = seal.variables();
    let outputs = variables.iter().map(|variable| Column::new(&variable.name, variable.unit, OutputType::Real));
    let mut rows = RowWriter::new(&output, &motion, command, outputs.collect())?;
    let mut history = command.plot.is_some().then(|| SealHistory::new(&seal, &motion.times()));
    let mut run = SealRun::new(&seal, &motion.start_of_seal(&seal)).context(NOT_STARTED)?;
    let record = |run: &mut SealRun, values: Vec<f64>| {
        run.take_warnings().iter().for_each(|warning| warn(warning));
        run.evaluate(&variables, &mut rows.values);
        if let Some(history) = &mut history {
            history.add(run);
        }
        rows.write(values)
    };
    let result = follow(&mut run, (&motion, motion.motions_of_seal(&seal)), SealRun::advance, record)?;
    let forces = rows.finish("F_")?;
    result.map_err(|error| ended_at(error, run.time(), &output))?;
    finish(command, &output, (forces, motion.rows().len(), run.time()), history.map(|history| history.picture()))
}

/// Takes a run from row to row; why it ended before the last of them.
///
/// # Errors
/// Where a row cannot be recorded.
fn follow<'a, R, M, E>(
    run: &mut R,
    (motion, steps): (&MotionFile, impl Iterator<Item = (M, &'a MotionRow)>),
    advance: fn(&mut R, &M) -> Result<(), E>,
    mut record: impl FnMut(&mut R, Vec<f64>) -> Result<(), Error>,
) -> Result<Result<(), E>, Error> {
    record(run, motion.values(&motion.rows()[0]))?;
    for (step, row) in steps {
        if let Err(error) = advance(run, &step) {
            return Ok(Err(error));
        }
        record(run, motion.values(row))?;
    }
    Ok(Ok(()))
}

/// The result file, which overwrites nothing that is read.
fn checked_output(
    command: &Simulate,
    file: &Path,
    mut sources: Vec<PathBuf>,
    motion_file: &Path,
) -> Result<PathBuf, Error> {
    sources.push(motion_file.to_owned());
    let output = command.output(file);
    check_outputs([&output].into_iter().chain(&command.plot), sources)?;
    Ok(output)
}

/// Draws the plot, and prints the forces at the end of so many rows, at a time (s).
fn finish(
    command: &Simulate,
    output: &PathBuf,
    (forces, rows, time): (String, usize, f64),
    drawn: Option<Picture>,
) -> Result<(), Error> {
    if let (Some(path), Some(drawn)) = (&command.plot, drawn) {
        picture::write(&drawn, path)?;
    }
    let files = [output.as_path()].into_iter().chain(command.plot.as_deref()).map(named).collect::<Vec<_>>();
    let summary = lines(&[
        ("At the end", forces),
        ("Run", format!("{} steps to t = {time} s", rows - 1)),
        ("Written", files.join(", ")),
    ]);
    print_beside([output], &summary)
}

/// A column of a result.
struct Column {
    name: String,
    unit: Unit,
    kind: OutputType,
}

impl Column {
    fn new(name: &str, unit: Unit, kind: OutputType) -> Self {
        Self { name: name.to_owned(), unit, kind }
    }
}

/// Writes the rows of a run to the file.
struct RowWriter {
    outputs: Vec<Column>,
    /// Those of the row to be written.
    values: Vec<f64>,
    writer: CsvWriter,
}

impl RowWriter {
    fn new(output: &Path, motion: &MotionFile, command: &Simulate, outputs: Vec<Column>) -> Result<Self, Error> {
        let of_outputs = outputs.iter().map(|column| (column.name.as_str(), column.unit));
        let columns = motion.columns().into_iter().chain(of_outputs);
        let names: Vec<String> = columns.map(|(name, unit)| command.head().of(name, unit)).collect();
        let writer = CsvWriter::create(output, names.iter().map(String::as_str))?;
        Ok(Self { values: vec![0.0; outputs.len()], writer, outputs })
    }

    /// Writes the row of the present instant, behind the values of the motion.
    fn write(&mut self, motion: Vec<f64>) -> Result<(), Error> {
        let outputs = self.outputs.iter().zip(&self.values).map(|(column, &value)| Field { kind: column.kind, value });
        let motion = motion.into_iter().map(|value| Field { kind: OutputType::Real, value });
        self.writer.write_values(motion.chain(outputs))
    }

    /// Ends the file; what the last row has of those whose names begin so.
    fn finish(self, shown: &str) -> Result<String, Error> {
        self.writer.finish()?;
        let shown = self.outputs.iter().zip(&self.values).filter(|(column, _)| column.name.starts_with(shown));
        let text = |(column, &value): (&Column, &f64)| {
            format!("{} {}", column.name, with_prefix(value, value, column.unit.name()))
        };
        Ok(shown.map(text).collect::<Vec<_>>().join(", "))
    }
}
