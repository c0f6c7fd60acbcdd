//! `asperity converge`: whether area and friction of a scene depend on its spacing, its length or on chance.

mod summary;

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Duration;

use asperity_study::Error;
use asperity_study::contact::SteadyState;
use asperity_study::converge::{self, ConvergenceOptions, ConvergenceStudy, Ended, Findings, Round, RunRow};
use asperity_study::sweep::SlidingOptions;

use super::cli::Converge;
use super::files::{check_outputs, default_output, load_without_run, picture_beside, print_beside};
use super::interrupt::Farewell;
use super::picture;
use super::table_file::TableFile;
use super::terminal::{self, warn};
use super::{NOT_REACHED, SUCCESS};

/// Makes the runs, prints the study and draws it.
pub(crate) fn converge(command: &Converge) -> Result<u8, Error> {
    if command.sliding.friction_error.is_some() {
        return Err(Error::value("--friction-error: expected none, since runs are known to a tenth of --error"));
    }
    let options = options(command);
    let scene = load_without_run(&command.scene, &command.set, |scene| !options.sliding().solves(scene))?;
    let study = ConvergenceStudy::new(&scene, &command.scene, options)?;
    study.warning().iter().for_each(|warning| warn(warning));
    let output = command.output.clone().unwrap_or_else(|| default_output(&command.scene, "converge.csv"));
    let picture = picture_beside(&output, command.plot.as_ref());
    check_outputs([&output].into_iter().chain(&picture), scene.sources(&command.scene))?;
    let header = study.header();
    let (file, runs) = TableFile::open(&output, &header.table(None), command.force, |table| Ok(header.runs(table)))?;
    let findings = run(&study, runs, &file, &output)?;
    file.finish(&study.table(&findings))?;
    let rows = summary::table(&findings.changes(), study.parts());
    print_beside([&output], &format!("{rows}\n{}", summary::judgement(&study, &findings)))?;
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
fn run(study: &ConvergenceStudy, runs: Vec<RunRow>, file: &TableFile, output: &Path) -> Result<Findings, Error> {
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
        if let Err(error) = file.add(&run.cells(None)) {
            return ControlFlow::Break(error);
        }
        bar.inc(1);
        ControlFlow::Continue(())
    });
    bar.finish_and_clear();
    findings.map_err(|ended| match ended {
        Ended::Refused(error) => error,
        Ended::Stopped(error) => error,
    })
}
