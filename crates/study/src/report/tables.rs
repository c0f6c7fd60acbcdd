//! The tables as CSV files: those that a report writes, and that of other programs, which it reads.

use std::path::Path;

use asperity::tables::ContentError;

use crate::robustness::{Perturbation, ScaledQuantity};

use super::communication::CommunicationRow;
use super::figures::RunFigures;
use super::judgement::Judgement;
use super::machine::{Machine, build};
use super::reference::Reference;
use super::robustness::Robustness;
use super::tolerances::{NoFigures, Timed, ToleranceRow};
use super::trace::{Errors, OF_ALL_SCENES, QUANTITIES};
use crate::csv::{self, text};
use crate::decimals::real;
use crate::error::Error;

/// The columns of errors and run times: errors over the largest value, processor time in s. Tables of other programs
/// have these columns.
const MEASURED: [&str; 10] = [
    "scene",
    "program",
    "method",
    "tolerance",
    "error_F_x",
    "error_F_z",
    "error_E_diss",
    "run_time",
    "steps",
    "events",
];

/// What those of other programs may have too: what the time is that of, how many timings there are and their spread.
const TIMED: &str = "timed";
const SPREAD: &str = "most_above_least";
const TIMINGS: &str = "runs";

/// What this program adds to them.
const ADDED: &str = "timed,most_above_least,runs,rejected,newton_iterations,energy_residual,estimate,below_reference,failure,\
    cpu,cores,system,build,error_u,error_w";

const COMMUNICATION: &str = "scene,given,communication_step,error_F_x,error_F_z,error_E_diss,mean_square_error_F_x,\
    mean_square_error_F_z,mean_square_error_E_diss,run_time,steps,events,below_reference,failure,error_u,error_w,mean_square_error_u,mean_square_error_w";

const JUDGEMENTS: &str = "scene,stiffness,mass,relaxation_times,speed,carrier_mass,drive,load,communication_step,method,tolerance,error,\
    error_over_tolerance,estimate,estimate_over_error,warned,left_out";

const ROBUSTNESS: &str = "scene,stiffness,mass,relaxation_times,speed,carrier_mass,drive,load,communication_step,status,reason,error,\
    moved_start_changes,energy_residual,steps,times_the_steps,rejected,events,newton_iterations";

/// The table of errors and run times, the reference first.
pub fn errors_table(scene: &str, reference: &Reference, rows: &[ToleranceRow]) -> String {
    let own = ToleranceRow::from_reference(reference);
    let machine = Machine::here();
    let records = std::iter::once(&own).chain(rows).map(|row| {
        let figures = row.result.as_ref().copied().unwrap_or_default();
        let mut fields = vec![scene.to_owned(), row.program.clone(), row.method.clone(), real(row.tolerance)];
        let errors = figures.errors.map(optional);
        fields.extend_from_slice(&errors[..OF_ALL_SCENES]);
        fields.push(optional(figures.time));
        fields.extend([figures.steps, figures.events].map(count));
        fields.extend([row.timed.name().to_owned(), optional(figures.spread.map(short)), count(figures.timings)]);
        fields.extend([figures.rejected, figures.iterations].map(count));
        fields.extend([figures.residual, figures.estimate.map(|estimate| estimate.error)].map(optional));
        fields.push(below(reference, &figures.errors));
        fields.push(row.result.as_ref().err().map(ToString::to_string).unwrap_or_default());
        fields.extend(measured_on(row.timed, &machine));
        fields.extend_from_slice(&errors[OF_ALL_SCENES..]);
        fields
    });
    text(MEASURED.into_iter().chain(ADDED.split(',')), records)
}

/// The columns on machine and build; those of a file of other programs are in that file.
fn measured_on(timed: Timed, machine: &Machine) -> [String; 4] {
    match timed {
        Timed::RunAlone => [machine.cpu.clone(), machine.cores.to_string(), machine.system.clone(), build()],
        Timed::WholeProcess => [const { String::new() }; 4],
    }
}

/// The table of errors and communication steps.
pub fn communication_table(scene: &str, reference: &Reference, rows: &[CommunicationRow]) -> String {
    let records = rows.iter().map(|row| {
        let (figures, mean_square) = row.result.clone().unwrap_or_default();
        let mut fields = vec![scene.to_owned(), row.given.name().to_owned(), optional(row.step)];
        let kinds = [figures.errors, mean_square.unwrap_or_default()].map(|errors| errors.map(optional));
        kinds.iter().for_each(|errors| fields.extend_from_slice(&errors[..OF_ALL_SCENES]));
        fields.push(optional(figures.time));
        fields.extend([figures.steps, figures.events].map(count));
        fields.push(below(reference, &figures.errors));
        fields.push(row.result.as_ref().err().map(ToString::to_string).unwrap_or_default());
        kinds.iter().for_each(|errors| fields.extend_from_slice(&errors[OF_ALL_SCENES..]));
        fields
    });
    text(COMMUNICATION.split(','), records)
}

/// The table of the perturbed runs: the factors of what is scaled, and the outcome.
pub fn robustness_table(scene: &str, robustness: &Robustness) -> String {
    let records = robustness.trials().map(|(perturbation, trial)| {
        let mut fields = vec![scene.to_owned()];
        fields.extend(factors(*perturbation));
        fields.extend([robustness.verdict(trial).name().to_owned(), robustness.reason(trial)]);
        let (accuracy, counts) = (trial.ended().map(|ended| &ended.accuracy), trial.counts());
        let error = accuracy.and_then(|accuracy| Some(accuracy.error()?.share));
        let moved = accuracy.and_then(|accuracy| accuracy.moved());
        fields.extend([error, moved, counts.map(|counts| counts.residual)].map(optional));
        fields.push(count(counts.map(|counts| counts.steps)));
        fields.push(optional(robustness.times_the_steps(trial).map(short)));
        let rest = counts.map(|counts| [counts.rejected, counts.events, counts.iterations]);
        fields.extend([0, 1, 2].map(|i| count(rest.map(|rest| rest[i]))));
        fields
    });
    text(ROBUSTNESS.split(','), records)
}

/// The table of errors over tolerances and estimates over errors of some scenes, each with its name.
pub fn judgements_table<'a>(scenes: impl IntoIterator<Item = (&'a str, &'a [Judgement])>) -> String {
    let runs = scenes.into_iter().flat_map(|(scene, runs)| runs.iter().map(move |run| (scene, run)));
    let records = runs.map(|(scene, run)| {
        let mut fields = vec![scene.to_owned()];
        fields.extend(factors(run.perturbation.unwrap_or_default()));
        let ratios = [run.error_over_tolerance(), run.estimate_over_error()];
        fields.extend([run.method.clone(), real(run.tolerance), real(run.error), real(ratios[0])]);
        fields.extend([real(run.estimate.error), real(ratios[1])]);
        fields.extend([run.warning(), run.standing.name()].map(str::to_owned));
        fields
    });
    text(JUDGEMENTS.split(','), records)
}

/// The factors of everything that may be scaled.
fn factors(perturbation: Perturbation) -> [String; 8] {
    ScaledQuantity::ALL.map(|quantity| optional(perturbation.factor(quantity)))
}

/// A ratio of counts or times, rounded to the digits that it is worth.
fn short(ratio: f64) -> f64 {
    const DIGITS: f64 = 1e4;
    (ratio * DIGITS).round() / DIGITS
}

fn optional(value: Option<f64>) -> String {
    value.map_or_else(String::new, real)
}

fn count(value: Option<u64>) -> String {
    value.map_or_else(String::new, |count| count.to_string())
}

/// The quantities whose errors are below the reference's own.
fn below(reference: &Reference, errors: &Errors) -> String {
    let flags = reference.below(errors);
    let names = QUANTITIES.iter().zip(flags).filter(|(_, below)| *below).map(|(name, _)| *name);
    names.collect::<Vec<_>>().join(" ")
}

/// Runs of whole processes, measured elsewhere: other programs, and this one beside them.
#[derive(Debug, Default)]
pub struct Peers {
    /// The rows of the scene.
    pub rows: Vec<ToleranceRow>,
    /// All scenes of the file, each once.
    pub scenes: Vec<String>,
}

/// Reads the rows of the scene with one of these `names` whose times are those of whole processes. The file has the
/// columns of `MEASURED`, and perhaps `TIMED`, `SPREAD` and `TIMINGS`; others are ignored.
///
/// # Errors
/// Where the file cannot be read, a column is missing, or a field is no number.
pub fn read_peers(path: &Path, names: &[&str]) -> Result<Peers, Error> {
    let file = csv::read(path)?;
    let refuse = |error| Error::content(path)(error);
    let mut columns = [0; MEASURED.len()];
    for (column, name) in columns.iter_mut().zip(MEASURED) {
        *column = file.column(name).map_err(refuse)?;
    }
    let optional_columns = [TIMED, SPREAD, TIMINGS].map(|name| file.column(name).ok());
    let mut peers = Peers::default();
    for record in &file.rows {
        let fields = columns.map(|column| &*record.fields[column]);
        let more = optional_columns.map(|column| column.map_or("", |column| &*record.fields[column]));
        if !peers.scenes.iter().any(|scene| scene == fields[0]) {
            peers.scenes.push(fields[0].to_owned());
        }
        if names.contains(&fields[0]) && more[0] != Timed::RunAlone.name() {
            peers.rows.push(row(record.line, fields, more).map_err(refuse)?);
        }
    }
    Ok(peers)
}

/// A row without a time is that of a run that did not come to its end.
fn row(
    line: usize,
    fields: [&str; MEASURED.len()],
    [_, spread, timings]: [&str; 3],
) -> Result<ToleranceRow, ContentError> {
    let figure = |column: usize| number(line, MEASURED[column], fields[column]);
    let tolerance = figure(3)?.ok_or_else(|| ContentError::value(Some(line), MEASURED[3], fields[3], "a tolerance"))?;
    let time = figure(7)?;
    let count = |number: Option<f64>| number.map(|count| count as u64);
    let figures = RunFigures {
        errors: [figure(4)?, figure(5)?, figure(6)?, None, None],
        time,
        spread: number(line, SPREAD, spread)?,
        timings: count(number(line, TIMINGS, timings)?),
        steps: count(figure(8)?),
        events: count(figure(9)?),
        ..RunFigures::default()
    };
    let result = if time.is_some() { Ok(figures) } else { Err(NoFigures::NoTime) };
    let [program, method] = [fields[1], fields[2]].map(str::to_owned);
    Ok(ToleranceRow { program, method, tolerance, timed: Timed::WholeProcess, result })
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
