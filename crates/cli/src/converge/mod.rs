//! `asperity converge`: whether area and friction of a scene depend on its spacing, its length or on chance.

mod summary;

use std::ops::ControlFlow;
use std::path::Path;
use std::path::PathBuf;
use std::time::Duration;

use asperity_study::Error;
use asperity_study::converge::{self, ConvergenceOptions, ConvergenceStudy, Ended, Findings, Round, RunRow};
use clap::Args;

use super::cli::values::{self, Set, example};
use super::files::{check_outputs, default_output, load_without_run, picture_beside, print_beside};
use super::interrupt::Farewell;
use super::output::{NOT_REACHED, SUCCESS};
use super::picture;
use super::table_file::TableFile;
use super::terminal::{self, warn};

#[derive(Debug, Args)]
#[command(override_usage = "asperity converge [OPTIONS] --pressure <PRESSURE> --speed <SPEED>\n       <SCENE.toml>")]
#[command(after_help = example!("asperity converge scenes/two-maxima/two-maxima.toml --pressure 2bar --speed 0.1 -o study.csv"))]
pub(crate) struct Converge {
    /// The scene file, in the material form; its excitation and outputs are not used.
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: PathBuf,
    #[command(flatten)]
    pub(crate) options: ConvergenceOptions,
    /// The table to write, - for standard output; an existing table of the same study is continued. Default: the
    /// scene's file name with .converge.csv.
    #[arg(short, long, value_name = "TABLE.csv")]
    pub(crate) output: Option<PathBuf>,
    /// The plot to write, as SVG or PNG according to the file name. Default: the table's name with .svg.
    #[arg(long, value_name = "OUT.svg", value_parser = values::picture())]
    pub(crate) plot: Option<PathBuf>,
    /// Replaces an existing table instead of continuing it.
    #[arg(long)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) set: Set,
}

/// Makes the runs, prints the study and draws it.
pub(crate) fn converge(command: &Converge) -> Result<u8, Error> {
    let scene = load_without_run(&command.scene, &command.set, |scene| !command.options.sliding.solves(scene))?;
    let study = ConvergenceStudy::new(&scene, &command.scene, command.options)?;
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
