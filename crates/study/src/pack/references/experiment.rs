//! The experiment of an FMU as tables: its inputs at times, and what the program itself gets along them.

use asperity::scene::OutputGroup;
use asperity_fmi::{CommunicationStep, Definition, Inputs, Role, VariableRef, VariableTable};

use super::motion::InputMotion;
use crate::decimals::{real, rounded, short};
use crate::robustness::{Budget, at_tolerance};

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
const LEFT_OUT: [&str; 3] = ["solver.", "energy.residual", "element["];
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
}

/// The tables, with the FMU's names; `None` where there is no experiment.
pub(super) fn tables(definition: &Definition, variables: &VariableTable) -> Option<ExperimentTables> {
    let budget = Budget(WORK / (STEP + masses(definition)));
    let tight = tight(definition, budget);
    let columns = columns(definition, variables);
    let motion = InputMotion::new(definition, budget)?;
    let bytes = motion.times.len() * columns.len() * BYTES_OF_NUMBER;
    let motion = motion.thinned(bytes.div_ceil(BYTES));
    let rows = rows(&tight, &motion, budget)?;
    if rows.len() < FEWEST_ROWS {
        return None;
    }
    let found = tight.calculated();
    let index = |name: &str| found.iter().position(|variable| variable.name == name);
    let inputs = variables.entries().map(|(_, variable)| variable);
    let inputs = inputs.filter(|variable| matches!(variable.role, Role::Input(_))).map(|variable| &*variable.name);
    let shown: Vec<(&str, usize)> = columns.iter().filter_map(|(own, named)| Some((*named, index(own)?))).collect();
    let result_row = |row: &Vec<f64>| shown.iter().map(|&(_, i)| rounded(row[i], DIGITS) + 0.0).collect();
    let largest = |i: usize| rows.iter().map(|row| row[i]).fold(0.0, f64::max);
    Some(ExperimentTables {
        inputs: table(inputs, &motion.times, motion.values[..rows.len()].iter().cloned()),
        result: table(shown.iter().map(|&(name, _)| name), &motion.times, rows.iter().map(result_row)),
        description: description(index(ERROR).map(largest)),
    })
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
    let Definition::Layer(scene) = definition else { return definition.clone() };
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

/// The calculated variables row by row, up to where the run fails or its budget is used up; `None` where none begins.
fn rows(definition: &Definition, motion: &InputMotion, budget: Budget) -> Option<Vec<Vec<f64>>> {
    let slots: Vec<usize> = definition.inputs().iter().filter_map(slot).collect();
    let calculated = definition.calculated();
    let steps = calculated.iter().position(|variable| variable.name == STEPS);
    let mut inputs = Inputs::default();
    motion.set(&mut inputs, &slots, 0);
    let mut run = definition.start(&inputs, motion.times[0]).ok()?;
    let mut values = vec![0.0; calculated.len()];
    run.evaluate(&mut values);
    let mut rows = vec![values.clone()];
    for (i, times) in motion.times.windows(2).enumerate() {
        motion.set(&mut inputs, &slots, i);
        let step =
            CommunicationStep { time: times[0], h: times[1] - times[0], extrapolation: definition.extrapolation() };
        let is_over = steps.is_some_and(|steps| values[steps] > budget.0 as f64);
        if is_over || run.advance(&inputs, &step).is_err() {
            break;
        }
        inputs.complete_step(step.h);
        run.evaluate(&mut values);
        rows.push(values.clone());
    }
    Some(rows)
}

fn slot(input: &VariableRef) -> Option<usize> {
    if let Role::Input(slot) = input.role { Some(slot) } else { None }
}
