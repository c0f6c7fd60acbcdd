//! `asperity converge`: whether area and friction of a scene depend on its spacing, its length or on chance.

mod plan;
mod plot;
mod summary;
mod table;
mod variants;
mod verdict;

use std::path::{Path, PathBuf};
use std::time::Duration;

use asperity::element::{Load, OperatingPoint};
use asperity::scene::{LinkKind, Scene};
use asperity_study::steady::{SlidingRubber, SteadySolver};
use cpu_time::ThreadTime;
use indicatif::ProgressBar;
use rayon::prelude::*;

use super::cli::{Converge, SteadyState};
use super::draft::TablePlace;
use super::figure::Figure as _;
use super::files::{FileError, check_outputs, default_output, picture_beside, print_beside};
use super::interrupt::Farewell;
use super::terminal::{self, warn};
use super::{NOT_REACHED, SUCCESS};
use asperity_study::steady::persson::{Roughness, Theory};
use asperity_study::sweep::{
    Method, MethodError, NeverSteady, SlidingOptions, StopBounds, SweepMethod, fingerprint, relevant, steady_sliding,
};
use plan::{Next, Plan};
use table::{Measured, RunRow, StudyHeader, Table};
use variants::{Parts, Template, Variant};
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
    #[error("{}: layer.masses and layer.spacing: expected plain numbers in the file, which the study varies, no texts with units", .path.display())]
    Unclear { path: PathBuf },
    #[error("--seeds: neither the scene's surface nor its roughness is self_affine, so nothing depends on a seed")]
    NoSeed,
    #[error(transparent)]
    Method(#[from] MethodError),
    #[error(
        "--most-{parts}: expected at least {least}: the scene has {own} {parts}, and its spacing is halved at least once"
    )]
    FewParts { parts: &'static str, own: u64, least: u64 },
    #[error("{}: not the table of a study: {problem}; name another -o, or give --force to replace it", .path.display())]
    NotATable { path: PathBuf, problem: String },
    #[error(
        "{} is the table of another study: of another scene, pressure, speed, error or distance; name another -o, or give \
         --force to replace it",
        .path.display()
    )]
    OtherStudy { path: PathBuf },
}

/// Standard error of a run over the error that its changes may have.
const RUN_ERROR: f64 = 0.1;

/// Makes the runs, prints the study and draws it.
pub(crate) fn converge(command: &Converge) -> Result<u8, ConvergeError> {
    let asked = asked(command);
    let (template, scene) = Template::read(&command.scene, &command.set, |scene| !asked.solves(scene))?;
    let (method, of_method) = asked.choose(&scene)?;
    let template = match &method {
        Method::Steady(surface) => template.on_grid(surface),
        Method::Layer => template,
    };
    let plan = plan(command, &template)?;
    let warning = scene.hard_pressure("--pressure", command.at.pressure).filter(|_| matches!(method, Method::Layer));
    warning.iter().for_each(|warning| warn(warning));
    let output = command.output.clone().unwrap_or_else(|| default_output(&command.scene, "converge.csv"));
    let picture = picture_beside(&output, command.plot.as_ref());
    check_outputs([&output].into_iter().chain(&picture), scene.sources(&command.scene))?;
    method.check(&scene)?;
    let place = TablePlace::new(&output)?;
    let (table, runs) =
        Table::open(&place.path, header(command, &scene, &method, of_method, template.parts())?, command.force)?;
    let (study, mut runs) = Work { command, template: &template, plan, table: &table, output: &output }.finish(runs)?;
    runs.sort_by_key(|run| run.variant.place());
    let verdict = Verdict::new(&study, command.error);
    let rows: Vec<(&RunRow, Option<Pair>)> = runs.iter().map(|run| (run, change(run, &runs))).collect();
    table.finish(&summary::sentence(&verdict, command.error), &rows)?;
    let ladder: Vec<&RunRow> = runs.iter().filter(|run| run.variant.is_of_ladder()).take(study.ladder.len()).collect();
    let judgement = summary::judgement(&ladder, template.parts(), &verdict, command.error, plan.seeds);
    print_beside([&output], &format!("{}\n{judgement}", summary::table(&rows, template.parts())))?;
    drop(table);
    place.finish()?;
    if let Some(picture) = &picture {
        plot::picture(&scene.name, &runs).write(picture)?;
    }
    Ok(if verdict.is_converged() { SUCCESS } else { NOT_REACHED })
}

/// Seeds where none are asked for.
const SEEDS: u32 = 4;

/// What a halved spacing may come to where nothing is asked for: masses of a layer, points of a surface.
const MOST: (u32, u32) = (4096, 1 << 21);

fn asked(command: &Converge) -> SlidingOptions {
    let Converge { method, points, distance, .. } = *command;
    SlidingOptions { method, points, error: None, distance }
}

fn plan(command: &Converge, template: &Template) -> Result<Plan, ConvergeError> {
    let parts = template.parts();
    let most = command.most_points.unwrap_or(if parts == Parts::Masses { MOST.0 } else { MOST.1 });
    let within = |halvings: &u32| template.contacts(*halvings) <= u64::from(most);
    let max_halvings = (1..u32::BITS).take_while(within).count() as u32;
    if max_halvings == 0 {
        let [own, least] = [0, 1].map(|halvings| template.contacts(halvings));
        return Err(ConvergeError::FewParts { parts: parts.name(), own, least });
    }
    if command.seeds.is_some() && !template.has_seed() {
        return Err(ConvergeError::NoSeed);
    }
    let seeds = template.has_seed().then_some(command.seeds.unwrap_or(SEEDS));
    let (has_length, has_split) = (template.has_length(), template.has_split());
    Ok(Plan { error: command.error, max_halvings, has_length, seeds, has_split })
}

fn header(
    command: &Converge,
    scene: &Scene,
    method: &Method,
    of_method: String,
    parts: Parts,
) -> Result<StudyHeader, ConvergeError> {
    let Converge { at: SteadyState { pressure, speed }, error, distance, .. } = *command;
    let of_method_alone = method.settings(|| format!("{distance:?}"));
    let settings = format!("converge {pressure:?} {speed:?} {error:?} {of_method_alone}");
    let fingerprint = fingerprint(&relevant(scene.clone()), &settings)?;
    Ok(StudyHeader { scene: scene.name.clone(), fingerprint, method: of_method, parts, pressure, speed, error })
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
        let counts = missing.iter().map(|&variant| self.template.dimensions(variant).count.to_string());
        let parts = self.template.parts().name();
        bar.set_message(format!("now with {} {parts}", counts.collect::<Vec<_>>().join(", ")));
    }

    fn make(&self, variant: Variant, bar: &ProgressBar) -> Result<RunRow, FileError> {
        let scene = self.template.scene(variant)?;
        let clock = ThreadTime::now();
        let dimensions = self.template.dimensions(variant);
        let is_of_layer = self.template.parts() == Parts::Masses;
        let outcome = if is_of_layer { self.measure(&scene) } else { self.solve(&scene, dimensions.count) };
        let run_time = clock.elapsed().as_secs_f64();
        let Converge { at: SteadyState { pressure, speed }, .. } = *self.command;
        let theories = [Roughness::Ridges, Roughness::Isotropic]
            .map(|roughness| Theory::new(&scene, pressure, speed, roughness).unwrap_or_default());
        let fit_rms = is_of_layer.then(|| scene.quality(LinkKind::Vertical).map_or(0.0, |quality| quality.rms));
        let run = RunRow { variant, dimensions, fit_rms, outcome, theories, run_time };
        self.table.add(&run)?;
        bar.inc(1);
        Ok(run)
    }

    /// Friction and area in steady sliding on so many points along x, or why there is none.
    fn solve(&self, scene: &Scene, points: u64) -> Result<Measured, String> {
        let points = u32::try_from(points).map_err(|_| format!("{points} points are too many"))?;
        let asked = SlidingOptions { method: Some(SweepMethod::Steady), points: Some(points), ..asked(self.command) };
        let (method, _) = asked.choose(scene).map_err(|error| error.to_string())?;
        let (Method::Steady(surface), Some(rubber)) = (method, SlidingRubber::new(scene)) else {
            return Err("not to be solved for".into());
        };
        let slide = SteadySolver::new(surface).slide(&rubber, self.command.at.speed, self.command.at.pressure);
        if let Some(problem) = slide.problem().filter(|problem| !problem.leaves_friction()) {
            return Err(problem.to_string());
        }
        Ok(Measured {
            mean: Pair { friction: slide.friction(), area: slide.area },
            error: Pair { friction: 0.0, area: 0.0 },
            hysteresis: slide.profile_hysteresis + slide.fine_hysteresis.unwrap_or_default(),
        })
    }

    /// Friction and area of the layer in steady sliding, or why there is none.
    fn measure(&self, scene: &Scene) -> Result<Measured, String> {
        let Converge { at: SteadyState { pressure, speed }, error, distance, .. } = *self.command;
        let area = scene.layer.area().ok_or("the layer has no width")?;
        let point = OperatingPoint { speed, load: pressure, temperature: None };
        let bounds = StopBounds { error: RUN_ERROR * error, distance };
        let sliding =
            steady_sliding(scene, &point, Load::Pressure { area }, bounds).map_err(|problem| problem.to_string())?;
        Ok(Measured {
            mean: Pair { friction: sliding.friction(), area: sliding.contact_ratio },
            error: Pair { friction: sliding.friction_error, area: sliding.contact_error },
            hysteresis: sliding.hysteresis(),
        })
    }
}
