//! `asperity converge`: whether area and friction of a scene depend on its spacing, its length or on chance.

mod plan;
mod plot;
mod summary;
mod table;
mod variants;
mod verdict;

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

use asperity::element::{Load, OperatingPoint};
use asperity::scene::{LinkKind, Scene};
use cpu_time::ThreadTime;
use indicatif::ProgressBar;
use rayon::prelude::*;

use super::cli::Converge;
use super::draft::TablePlace;
use super::figure::Figure as _;
use super::files::{FileError, check_outputs, default_output, picture_beside, print_beside, sources};
use super::interrupt::Farewell;
use super::sweep::{NeverSteady, StopBounds, check_can_be_steady, relevant, steady_sliding, table_fingerprint};
use super::terminal::{self, warn};
use asperity::steady::persson::{Dimension, Theory};
use plan::{Next, Plan};
use table::{Measured, RunRow, StudyHeader, Table};
use variants::{Template, Variant};
use verdict::{Pair, Study, Verdict};

/// `asperity converge` refused a scene or a file.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ConvergeError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    #[error(
        "{}: the scene is in the direct form: its masses and links do not follow the spacing, so nothing could converge; \
         give [material], layer.width and layer.foundation",
        .path.display()
    )]
    DirectForm { path: PathBuf },
    #[error(
        "{}: layer.roughness has one height for each mass, and none for the masses between at half the spacing: give x too, \
         or another kind",
        .path.display()
    )]
    HeightsAtMasses { path: PathBuf },
    #[error(transparent)]
    NeverSteady(#[from] NeverSteady),
    #[error("{}: expected numbers for layer.masses and layer.spacing", .path.display())]
    Unclear { path: PathBuf },
    #[error("--seeds: neither the scene's surface nor its roughness is self_affine, so nothing depends on a seed")]
    NoSeed,
    #[error(
        "--most-masses: expected at least {least}: the scene has {masses} masses, and its spacing is halved at least once"
    )]
    FewMasses { masses: u64, least: u64 },
    #[error("{}: not the table of a study: {problem}; name another -o, or give --force to replace it", .path.display())]
    NotATable { path: PathBuf, problem: String },
    #[error(
        "{} is the table of another study: of another scene, pressure, speed, error or distance; name another -o, or give \
         --force to replace it",
        .path.display()
    )]
    OtherStudy { path: PathBuf },
}

/// Exit status where not all is within the error.
const OPEN: u8 = 3;
/// Standard error of a run over the error that its changes may have.
const RUN_ERROR: f64 = 0.1;

/// Makes the runs, prints the study and draws it.
pub(crate) fn converge(command: &Converge) -> Result<ExitCode, ConvergeError> {
    let (template, scene) = Template::read(&command.scene, &command.set)?;
    let plan = plan(command, &template)?;
    if let Some(warning) = scene.hard_pressure("--pressure", command.pressure) {
        warn(&warning);
    }
    let output = command.output.clone().unwrap_or_else(|| default_output(&command.scene, "converge.csv"));
    let picture = picture_beside(&output, command.plot.as_ref());
    check_outputs([&output].into_iter().chain(&picture), sources(&command.scene, &scene))?;
    check_can_be_steady(&scene)?;
    let place = TablePlace::new(&output)?;
    let (table, runs) = Table::open(&place.path, header(command, &scene)?, command.force)?;
    let (study, mut runs) = Work { command, template: &template, plan, table: &table, output: &output }.finish(runs)?;
    runs.sort_by_key(|run| run.variant.place());
    let verdict = Verdict::new(&study, command.error);
    let rows: Vec<(&RunRow, Option<Pair>)> = runs.iter().map(|run| (run, change(run, &runs))).collect();
    table.finish(&summary::sentence(&verdict, command.error), &rows)?;
    let ladder: Vec<&RunRow> = runs.iter().filter(|run| run.variant.is_of_ladder()).take(study.ladder.len()).collect();
    let judgement = summary::judgement(&ladder, &verdict, command.error, plan.seeds);
    print_beside([&output], &format!("{}\n{judgement}", summary::table(&rows)))?;
    drop(table);
    place.finish()?;
    if let Some(picture) = &picture {
        plot::picture(&scene.name, &runs).write(picture)?;
    }
    Ok(if verdict.is_converged() { ExitCode::SUCCESS } else { ExitCode::from(OPEN) })
}

/// Seeds where none are asked for.
const SEEDS: u32 = 4;

fn plan(command: &Converge, template: &Template) -> Result<Plan, ConvergeError> {
    let (masses, most) = (template.masses(), u64::from(command.most_masses));
    let max_halvings = (most / masses).checked_ilog2().unwrap_or_default();
    if max_halvings == 0 {
        return Err(ConvergeError::FewMasses { masses, least: 2 * masses });
    }
    if command.seeds.is_some() && !template.has_seed() {
        return Err(ConvergeError::NoSeed);
    }
    let seeds = template.has_seed().then_some(command.seeds.unwrap_or(SEEDS));
    Ok(Plan { error: command.error, max_halvings, seeds, has_split: template.has_split() })
}

fn header(command: &Converge, scene: &Scene) -> Result<StudyHeader, ConvergeError> {
    let Converge { pressure, speed, error, distance, .. } = *command;
    let settings = format!("converge {pressure:?} {speed:?} {error:?} {distance:?}");
    let fingerprint = table_fingerprint(&relevant(scene.clone()), &settings)?;
    Ok(StudyHeader { scene: scene.name.clone(), fingerprint, pressure, speed, error })
}

/// The change of a run's values from those of the run that it is compared with.
fn change(run: &RunRow, runs: &[RunRow]) -> Option<Pair> {
    let reference = run.variant.reference()?;
    let before = runs.iter().find(|run| run.variant == reference)?;
    Some(run.mean()?.change_from(&before.mean()?))
}

/// The runs that are to be made.
#[derive(Clone, Copy, Debug)]
struct Work<'a> {
    command: &'a Converge,
    template: &'a Template,
    plan: Plan,
    table: &'a Table,
    output: &'a Path,
}

impl Work<'_> {
    /// Makes what is missing beside `runs`; those that do not depend on each other on all cores.
    fn finish(&self, mut runs: Vec<RunRow>) -> Result<(Study, Vec<RunRow>), FileError> {
        let bar = terminal::bar(0);
        bar.enable_steady_tick(Duration::from_secs(1));
        let done = bar.clone();
        let _farewell = Farewell::new(self.output, move || {
            let runs = done.position();
            done.finish_and_clear();
            format!("{runs} runs are done")
        });
        loop {
            let outcome = |variant| runs.iter().find(|run| run.variant == variant).map(RunRow::mean);
            let missing = match self.plan.next(outcome) {
                Next::Done(study) => {
                    bar.finish_and_clear();
                    return Ok((study, runs));
                }
                Next::Runs(missing) => missing,
            };
            self.show(&bar, runs.len(), &missing);
            let made: Result<Vec<RunRow>, FileError> =
                missing.par_iter().with_max_len(1).map(|&variant| self.make(variant, &bar)).collect();
            runs.extend(made?);
        }
    }

    /// Shows what is made now.
    fn show(&self, bar: &ProgressBar, done: usize, missing: &[Variant]) {
        bar.set_length((done + missing.len() + self.plan.following(missing)) as u64);
        bar.set_position(done as u64);
        let masses = missing.iter().map(|&variant| self.template.dimensions(variant).masses.to_string());
        bar.set_message(format!("now with {} masses", masses.collect::<Vec<_>>().join(", ")));
    }

    fn make(&self, variant: Variant, bar: &ProgressBar) -> Result<RunRow, FileError> {
        let scene = self.template.scene(variant)?;
        let clock = ThreadTime::now();
        let outcome = self.measure(&scene);
        let run_time = clock.elapsed().as_secs_f64();
        let Converge { pressure, speed, .. } = *self.command;
        let theories = [Dimension::One, Dimension::Two]
            .map(|dimension| Theory::new(&scene, pressure, speed, dimension).unwrap_or_default());
        let fit_rms = scene.quality(LinkKind::Vertical).map_or(0.0, |quality| quality.rms);
        let dimensions = self.template.dimensions(variant);
        let run = RunRow { variant, dimensions, fit_rms, outcome, theories, run_time };
        self.table.add(&run)?;
        bar.inc(1);
        Ok(run)
    }

    /// Friction and area in steady sliding, or why there is none.
    fn measure(&self, scene: &Scene) -> Result<Measured, String> {
        let Converge { pressure, speed, error, distance, .. } = *self.command;
        let area = scene.layer.area().ok_or("the layer has no width")?;
        let point = OperatingPoint { speed, load: pressure, temperature: None };
        let bounds = StopBounds { error: RUN_ERROR * error, distance };
        let sliding = steady_sliding(scene, &point, Load::Pressure { area }, bounds)?;
        Ok(Measured {
            mean: Pair { friction: sliding.friction(), area: sliding.contact_ratio },
            error: Pair { friction: sliding.friction_error, area: sliding.contact_error },
            hysteresis: sliding.hysteresis(),
        })
    }
}
