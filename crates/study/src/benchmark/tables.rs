//! The tables of a benchmark, and that of other programs, which is read.

use std::env::consts::{ARCH, OS};
use std::fs;
use std::path::Path;
use std::thread::available_parallelism;

use asperity::table::{Cell, Column, Header, Table};
use asperity::tables::ContentError;

use super::communication::CommunicationRow;
use super::judgement::Judgement;
use super::reference::Reference;
use super::run::{Counts, RunFigures};
use super::stress::Stress;
use super::tolerances::ToleranceRow;
use super::trace::{Errors, QUANTITIES};
use crate::Error;
use crate::csv;
use crate::robustness::{ScaledQuantity, factor};

/// The version of each table.
const VERSION: u64 = 1;

/// The header of a table: what it is of, and of which program on which machine.
fn header(kind: &str, scene: Option<&str>) -> Header {
    let build = if cfg!(debug_assertions) { "development" } else { "release" };
    let build = format!("asperity {}, {build} build", env!("CARGO_PKG_VERSION"));
    let header = Header::new((&format!("asperity {kind}"), VERSION)).with_some("scene", scene).with("build", &build);
    // Where the machine does not say what it is, its architecture and system.
    let cpu = value("/proc/cpuinfo", "model name", ':').unwrap_or_else(|| ARCH.into());
    let system = value("/etc/os-release", "PRETTY_NAME", '=').unwrap_or_else(|| OS.into());
    let kernel = fs::read_to_string("/proc/sys/kernel/osrelease").unwrap_or_default();
    let cores = available_parallelism().map_or(1, usize::from) as u64;
    header.with("cpu", &cpu).with_whole("cores", cores).with("system", &format!("{system} {kernel}"))
}

/// The first value of a key in a file of lines "key: value".
fn value(path: &str, key: &str, separator: char) -> Option<String> {
    found(&fs::read_to_string(path).ok()?, key, separator)
}

fn found(text: &str, key: &str, separator: char) -> Option<String> {
    let pairs = text.lines().filter_map(|line| line.split_once(separator));
    let mut values = pairs.filter(|(name, _)| name.trim() == key).map(|(_, value)| value.trim().trim_matches('"'));
    values.find(|value| !value.is_empty()).map(str::to_owned)
}

/// Columns of numbers, each beginning so and followed by the name of a quantity that runs are compared by.
fn of_quantities(start: &str) -> impl Iterator<Item = Column> {
    QUANTITIES.iter().map(move |quantity| Column::numbers(format!("{start}_{quantity}"), ""))
}

fn numbers<const N: usize>(names: [&str; N]) -> impl Iterator<Item = Column> {
    names.into_iter().map(|name| Column::numbers(name, ""))
}

fn words<const N: usize>(names: [&str; N]) -> impl Iterator<Item = Column> {
    names.into_iter().map(|name| Column::words(name, ""))
}

fn run_time() -> Column {
    Column::numbers("run_time", "s")
}

fn cell(value: Option<f64>) -> Cell {
    value.into()
}

fn count(value: Option<u64>) -> Cell {
    value.map(|count| count as f64).into()
}

/// A ratio of counts or times, rounded to the digits that it is worth.
fn rounded(ratio: f64) -> f64 {
    const DIGITS: f64 = 1e4;
    (ratio * DIGITS).round() / DIGITS
}

/// The quantities whose errors are below the reference's own.
fn below(reference: &Reference, errors: &Errors) -> Cell {
    let names = QUANTITIES.iter().zip(reference.below(errors)).filter(|(_, below)| *below).map(|(name, _)| *name);
    names.collect::<Vec<_>>().join(" ").into()
}

/// The table of errors and run times, the reference first: errors over the largest value, processor time. Where a run did
/// not come to its end there is the reason.
pub fn errors_table(scene: &str, reference: &Reference, rows: &[ToleranceRow]) -> Table {
    let columns = words(["method"]).chain(numbers(["tolerance"])).chain(of_quantities("error")).chain([run_time()]);
    let counted = ["most_above_least", "runs", "steps", "rejected", "events", "newton_iterations", "energy_residual"];
    let columns =
        columns.chain(numbers(counted)).chain(numbers(["estimate"])).chain(words(["below_reference", "failure"]));
    let mut table = Table::new(header("errors and run times", Some(scene)), columns);
    for row in std::iter::once(&ToleranceRow::from_reference(reference)).chain(rows) {
        let figures = row.result.as_ref().ok();
        let errors = figures.map(|figures| figures.errors).unwrap_or_default();
        let counts = figures.map(|figures| figures.counts);
        let of_counts = |number: fn(&Counts) -> u64| count(counts.as_ref().map(number));
        let mut cells = vec![row.method.into(), row.tolerance.into()];
        cells.extend(errors.map(Cell::from));
        cells.push(cell(figures.and_then(RunFigures::time)));
        cells.push(cell(figures.and_then(RunFigures::spread).map(rounded)));
        cells.push(count(figures.map(|figures| figures.times.len() as u64)));
        cells.extend([of_counts(|counts| counts.steps), of_counts(|counts| counts.rejected)]);
        cells.extend([of_counts(|counts| counts.events), of_counts(|counts| counts.iterations)]);
        cells.push(cell(counts.map(|counts| counts.residual)));
        cells.push(cell(figures.and_then(|figures| figures.estimate).map(|estimate| estimate.error)));
        cells.extend([below(reference, &errors), row.result.clone().err().unwrap_or_default().into()]);
        table.push(cells);
    }
    table
}

/// The table of errors and communication steps. Where a run did not come to its end there is the reason.
pub fn communication_table(scene: &str, reference: &Reference, rows: &[CommunicationRow]) -> Table {
    let columns = words(["given"]).chain([Column::numbers("communication_step", "s")]);
    let columns = columns.chain(of_quantities("error")).chain(of_quantities("mean_square_error")).chain([run_time()]);
    let columns = columns.chain(numbers(["steps", "events"])).chain(words(["below_reference", "failure"]));
    let mut table = Table::new(header("errors and communication steps", Some(scene)), columns);
    for row in rows {
        let figures = row.result.as_ref().ok().map(|(figures, _)| figures);
        let mean_squares = row.result.as_ref().ok().and_then(|(_, mean_squares)| *mean_squares);
        let errors = figures.map(|figures| figures.errors).unwrap_or_default();
        let mut cells = vec![row.given.name().into(), cell(row.step)];
        cells.extend(errors.into_iter().chain(mean_squares.unwrap_or_default()).map(Cell::from));
        cells.push(cell(figures.and_then(RunFigures::time)));
        cells.extend(
            [figures.map(|figures| figures.counts.steps), figures.map(|figures| figures.counts.events)].map(count),
        );
        let failure = row.result.as_ref().err().map(ToString::to_string);
        cells.extend([below(reference, &errors), failure.unwrap_or_default().into()]);
        table.push(cells);
    }
    table
}

/// What is scaled and by which factor: nothing by 1 in the scene as it is.
fn scaled(scaled: Option<(ScaledQuantity, i32)>) -> [Cell; 2] {
    let name = scaled.map_or("", |(quantity, _)| quantity.name());
    [name.into(), scaled.map_or(1.0, |(_, power)| factor(power)).into()]
}

/// The table of the runs under stress, that of the scene as it is first: what is scaled, and the outcome.
pub fn stress_table(scene: &str, stress: &Stress) -> Table {
    let outcome = ["error", "moved_start_changes", "energy_residual", "steps", "times_the_steps", "rejected", "events"];
    let columns =
        words(["scaled"]).chain(numbers(["factor"])).chain(words(["status", "reason"])).chain(numbers(outcome));
    let header = header("runs under stress", Some(scene)).with("method", &stress.method);
    let header = header.with_number("tolerance", stress.tolerance, "");
    let mut table = Table::new(header, columns.chain(numbers(["newton_iterations"])));
    for trial in std::iter::once(&stress.unscaled).chain(&stress.scaled) {
        let ended = trial.outcome.as_ref().ok();
        let accuracy = ended.map(|ended| &ended.accuracy);
        let of_counts = |number: fn(&Counts) -> u64| count(ended.map(|ended| number(&ended.counts)));
        let mut cells = Vec::from(scaled(trial.scaled));
        cells.extend([stress.verdict(trial).name().into(), stress.reason(trial).into()]);
        cells.push(cell(accuracy.and_then(|accuracy| Some(accuracy.error()?.share))));
        cells.push(cell(accuracy.and_then(|accuracy| accuracy.moved())));
        cells.push(cell(ended.map(|ended| ended.counts.residual)));
        cells.extend([of_counts(|counts| counts.steps), cell(stress.times_the_steps(trial).map(rounded))]);
        cells.extend([of_counts(|counts| counts.rejected), of_counts(|counts| counts.events)]);
        cells.push(of_counts(|counts| counts.iterations));
        table.push(cells);
    }
    table
}

/// The table of errors over tolerances and estimates over errors of some scenes, each with its name.
pub fn judgements_table<'a>(scenes: impl IntoIterator<Item = (&'a str, &'a [Judgement])>) -> Table {
    let figures = ["tolerance", "error", "error_over_tolerance", "estimate", "estimate_over_error"];
    let columns =
        words(["scene", "scaled"]).chain(numbers(["factor"])).chain(words(["method"])).chain(numbers(figures));
    let mut table = Table::new(header("errors over tolerances", None), columns.chain(words(["warned", "left_out"])));
    for (scene, run) in scenes.into_iter().flat_map(|(scene, runs)| runs.iter().map(move |run| (scene, run))) {
        let [quantity, factor] = scaled(run.scaled);
        let mut cells = vec![scene.into(), quantity, factor, run.method.as_str().into()];
        let ratios = [run.error_over_tolerance(), run.estimate_over_error()];
        cells.extend([run.tolerance, run.error, ratios[0], run.estimate.error, ratios[1]].map(Cell::from));
        let warning = if run.estimate.warned { "does not converge" } else { "" };
        cells.extend([warning.into(), run.standing.name().into()]);
        table.push(cells);
    }
    table
}

/// The columns of a table of other programs: errors over the largest value, processor time in s.
const MEASURED: [&str; 8] =
    ["scene", "program", "method", "tolerance", "error_F_x", "error_F_z", "error_E_diss", "run_time"];

/// A run that was measured elsewhere, as a whole process.
#[derive(Clone, Debug, PartialEq)]
pub struct Peer {
    /// Program and method.
    pub name: String,
    /// The relative tolerance.
    pub tolerance: f64,
    /// Its errors.
    pub errors: Errors,
    /// Processor time, s.
    pub time: f64,
}

/// Runs of whole processes, measured elsewhere: other programs, and this one beside them.
#[derive(Debug, Default)]
pub struct Peers {
    /// Those of the scene that came to their ends.
    pub runs: Vec<Peer>,
    /// All scenes of the file, each once.
    pub scenes: Vec<String>,
}

/// Reads the runs of the scene with one of these `names`. A run without a time did not come to its end.
///
/// # Errors
/// Where the file cannot be read, a column is missing, or a field is no number.
pub fn read_peers(path: &Path, names: &[&str]) -> Result<Peers, Error> {
    let file = csv::read(path)?;
    let columns = MEASURED.iter().map(|name| file.column(name)).collect::<Result<Vec<_>, _>>();
    let columns = columns.map_err(Error::content(path))?;
    let mut peers = Peers::default();
    for record in &file.rows {
        let fields: Vec<&str> = columns.iter().map(|&column| &*record.fields[column]).collect();
        if !peers.scenes.iter().any(|scene| scene == fields[0]) {
            peers.scenes.push(fields[0].to_owned());
        }
        if names.contains(&fields[0]) {
            peers.runs.extend(peer(record.line, &fields).map_err(Error::content(path))?);
        }
    }
    // Those of a program and method one after the other.
    peers.runs.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(peers)
}

fn peer(line: usize, fields: &[&str]) -> Result<Option<Peer>, ContentError> {
    let figure = |column: usize| number(line, MEASURED[column], fields[column]);
    let tolerance = figure(3)?.ok_or_else(|| ContentError::value(Some(line), MEASURED[3], fields[3], "a tolerance"))?;
    let errors = [figure(4)?, figure(5)?, figure(6)?, None, None];
    let name = format!("{} {}", fields[1], fields[2]);
    Ok(figure(7)?.map(|time| Peer { name, tolerance, errors, time }))
}

/// A number; `None` where the field is empty or NaN.
fn number(line: usize, column: &str, text: &str) -> Result<Option<f64>, ContentError> {
    if text.is_empty() {
        return Ok(None);
    }
    let refuse = |_| ContentError::value(Some(line), column, &format!("{text:?}"), "a number");
    let number: f64 = text.parse().map_err(refuse)?;
    Ok(Some(number).filter(|number| !number.is_nan()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_machine_is_what_its_files_say() {
        let cpu = "processor\t: 0\nmodel name\t: Some CPU @ 2.0: fast\nprocessor\t: 1\nmodel name\t: Another";
        assert_eq!(found(cpu, "model name", ':').as_deref(), Some("Some CPU @ 2.0: fast"));
        assert_eq!(found("ID=some\nPRETTY_NAME=\"Some OS 1\"", "PRETTY_NAME", '=').as_deref(), Some("Some OS 1"));
        assert_eq!(found("processor\t: 0", "model name", ':'), None);
    }
}
