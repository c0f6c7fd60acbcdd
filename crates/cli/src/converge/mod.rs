//! `asperity converge`: whether area and friction of a scene depend on its spacing, its length or on chance.

mod summary;
mod table;

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Duration;

use asperity_study::contact::SteadyState;
use asperity_study::converge::{
    self, ConvergeError, ConvergenceOptions, ConvergenceStudy, Ended, Findings, Round, RunRow,
};
use asperity_study::sweep::SlidingOptions;

use super::cli::Converge;
use super::draft::TablePlace;
use super::files::{FileError, check_outputs, default_output, load_without_run, picture_beside, print_beside};
use super::interrupt::Farewell;
use super::output::of_set;
use super::picture;
use super::terminal::{self, warn};
use super::{NOT_REACHED, SUCCESS};
use table::StudyTable;

/// `asperity converge` refused a scene or a file.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ConvergeCommandError {
    #[error(transparent)]
    Study(ConvergeError),
    #[error(transparent)]
    File(#[from] FileError),
    #[error("{}: not the table of a study: {problem}; name another -o, or give --force to replace it", .path.display())]
    NotATable { path: PathBuf, problem: String },
    #[error(
        "{} is the table of another study: of another scene, pressure, speed, error or distance; name another -o, or give \
         --force to replace it",
        .path.display()
    )]
    OtherStudy { path: PathBuf },
}

impl From<ConvergeError> for ConvergeCommandError {
    fn from(error: ConvergeError) -> Self {
        match error {
            ConvergeError::Read(error) => Self::File(of_set(error)),
            error => Self::Study(error),
        }
    }
}

/// Makes the runs, prints the study and draws it.
pub(crate) fn converge(command: &Converge) -> Result<u8, ConvergeCommandError> {
    if command.sliding.friction_error.is_some() {
        let problem = "--friction-error: expected none, since runs are known to a tenth of --error";
        return Err(FileError::value(problem).into());
    }
    let options = options(command);
    let scene = load_without_run(&command.scene, &command.set, |scene| !options.sliding().solves(scene))?;
    let study = ConvergenceStudy::new(&scene, &command.scene, options)?;
    study.warning().iter().for_each(|warning| warn(warning));
    let output = command.output.clone().unwrap_or_else(|| default_output(&command.scene, "converge.csv"));
    let picture = picture_beside(&output, command.plot.as_ref());
    check_outputs([&output].into_iter().chain(&picture), scene.sources(&command.scene))?;
    let place = TablePlace::new(&output)?;
    let (table, runs) = StudyTable::open(&place.path, study.header(), command.force)?;
    let findings = run(&study, runs, &table, &output)?;
    table.finish(&findings)?;
    let rows = summary::table(&findings.changes(), study.parts());
    print_beside([&output], &format!("{rows}\n{}", summary::judgement(&study, &findings)))?;
    drop(table);
    place.finish()?;
    if let Some(path) = &picture {
        picture::write(&converge::picture(&scene.name, &findings.runs), path)?;
    }
    Ok(if findings.verdict.is_converged() { SUCCESS } else { NOT_REACHED })
}

fn options(command: &Converge) -> ConvergenceOptions {
    let Converge { at: SteadyState { pressure, speed }, error, seeds, most_points, sliding, .. } = *command;
    let SlidingOptions { method, way, points, distance, .. } = sliding;
    ConvergenceOptions { pressure, speed, way, error, seeds, method, points, most_points, distance }
}

/// Makes what is missing beside `runs` and shows how far it is.
fn run(
    study: &ConvergenceStudy,
    runs: Vec<RunRow>,
    table: &StudyTable<'_>,
    output: &Path,
) -> Result<Findings, FileError> {
    let bar = terminal::bar(0);
    bar.enable_steady_tick(Duration::from_secs(1));
    let done = bar.clone();
    let _farewell = Farewell::new(output, move || {
        let runs = done.position();
        done.finish_and_clear();
        format!("{runs} runs are done")
    });
    let begun = |round: &Round| {
        bar.set_length(round.all as u64);
        bar.set_position(round.done as u64);
        let counts: Vec<String> = round.counts.iter().map(u64::to_string).collect();
        bar.set_message(format!("now with {} {}", counts.join(", "), study.parts().name()));
    };
    let findings = study.run(runs, begun, |run| {
        if let Err(error) = table.add(run) {
            return ControlFlow::Break(error);
        }
        bar.inc(1);
        ControlFlow::Continue(())
    });
    bar.finish_and_clear();
    findings.map_err(|ended| match ended {
        Ended::Refused(error) => error.into(),
        Ended::Stopped(error) => error,
    })
}
