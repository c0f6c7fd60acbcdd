//! `asperity sweep`: the friction coefficient over speed, load and temperature, as a table and a plot.

mod convergence;
mod load_search;
mod low_end;
mod method;
mod plan;
mod plot;
mod point;
mod printed;
mod slide;
mod solved;
mod swept;
mod table_file;
pub(super) mod values;
mod window;

use std::path::{Path, PathBuf};

use asperity::element::{Load, OperatingPoint};
use asperity::model::Model;
use asperity::scene::{Initial, OutputGroup, ParameterError, Path as Displacement, Phase, Scene, Wlf};

use super::cli::{Sliding, Sweep};
use super::draft::TablePlace;
use super::files::{FileError, check_outputs, default_output, load_without_run, named, picture_beside, print_beside};
use super::interrupt::Farewell;
use super::terminal::{self, lines, warn};
use load_search::{heights, rest_separation};
pub(crate) use method::Method;
pub use method::{MethodError, SlidingOptions, SweepMethod};
pub use plan::{Loads, SweepOptions, SweepPlan};
pub(crate) use plot::as_given;
use point::SteadySliding;
use point::{MIN_BLOCKS, PointResult};
pub(crate) use point::{SMALL as SMALL_FRICTION, StopBounds};
use slide::Blocks;
pub(crate) use solved::status as solved_status;
pub(crate) use swept::{Swept, SweptPoint};
use table_file::TableFile;
pub(crate) use table_file::fingerprint as table_fingerprint;
pub use table_file::{StoredRow, SweepTable, TableFileError};
use values::Values;

/// `asperity sweep` failed, or not all of its points are steady.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are")]
pub enum SweepError {
    #[error("the scene has [carrier.x]; expected none, since a sweep prescribes the speed")]
    BodyAlongX,
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    TableFile(#[from] TableFileError),
    #[error("cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    #[error(
        "--pressures: the scene is in the direct form, which has no width and so no area: give --forces, F_z of the whole \
         layer in N"
    )]
    NoArea,
    #[error("expected --pressures or --forces, the loads to sweep over")]
    NoLoad,
    #[error("--temperatures: the scene has no material.wlf, so nothing in it depends on the temperature")]
    NoWlf,
    #[error("--master: the scene has no material.wlf, by whose factors speeds would be shifted")]
    NoMaster,
    #[error("--temperatures: {0}")]
    Temperature(ParameterError),
    #[error("{}: not a study of this scene's convergence: {problem}", .path.display())]
    NotAStudy { path: PathBuf, problem: String },
    #[error(transparent)]
    NeverSteady(#[from] NeverSteady),
    #[error(transparent)]
    Method(#[from] MethodError),
    #[error("{failed} of {total} points are not steady or failed: the column status in {} says why", named(.path))]
    NotSteady { failed: usize, total: usize, path: PathBuf },
}

/// No slide of the layer could become steady.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are")]
pub enum NeverSteady {
    /// The profile, which reaches `longest` (m) from where the layer starts, is too short for the `needed` way (m) of a
    /// point.
    #[error(
        "the profile ends {longest:.4e} m from where the layer starts, and steady sliding takes {needed:.4e} m or more: make it \
         periodic, as `asperity surface --mirror --write` does, or --taper, and give periodic = true in [surface]"
    )]
    ProfileEnds { longest: f64, needed: f64 },
    #[error(
        "material.heat: expected none for steady sliding of the layer, since contacts that slide on warm without end; leave it \
         out and vary material.wlf.temperature, or give --method steady, which has the temperature above the surface's mean"
    )]
    Heats,
}

/// Refuses a scene of which no slide could become steady.
fn check_can_be_steady(scene: &Scene) -> Result<(), NeverSteady> {
    if scene.material.as_ref().is_some_and(|material| material.heat.is_some()) {
        return Err(NeverSteady::Heats);
    }
    let blocks = Blocks::new(scene, 1.0);
    if blocks.has_room(MIN_BLOCKS) {
        return Ok(());
    }
    Err(NeverSteady::ProfileEnds { longest: blocks.longest, needed: MIN_BLOCKS * blocks.length })
}

/// Computes a table or merges several.
pub(crate) fn sweep(command: &Sweep) -> Result<(), SweepError> {
    match (&command.scene, &command.speeds, &command.output) {
        (Some(scene), Some(speeds), _) => compute(command, scene, speeds),
        (_, _, Some(output)) => merge(command, output),
        // clap requires a scene and speeds, or tables and an output.
        _ => Ok(()),
    }
}

fn merge(command: &Sweep, output: &PathBuf) -> Result<(), SweepError> {
    let picture = picture(command, output);
    check_outputs([output].into_iter().chain(&picture), command.merge.clone())?;
    let place = TablePlace::new(output)?;
    let table = SweepTable::merge(&command.merge, &place.path, command.force)?;
    place.finish()?;
    finish(output, &table, picture.as_deref(), None)
}

fn compute(command: &Sweep, path: &Path, speeds: &Values) -> Result<(), SweepError> {
    let scene = load_without_run(path, &command.set, |scene| !command.sliding.options().solves(scene))?;
    let output = command.output.clone().unwrap_or_else(|| default_output(path, "sweep.csv"));
    let picture = picture(command, &output);
    let study = convergence::file(command.converged.as_ref(), path);
    let taken = scene.sources(path).into_iter().chain(study.clone()).collect();
    check_outputs([&output].into_iter().chain(&picture).chain(&command.master), taken)?;
    let master = match &command.master {
        Some(path) => Some((path.as_path(), wlf(&scene).ok_or(SweepError::NoMaster)?)),
        None => None,
    };
    let convergence = convergence::found(study.as_deref(), &scene.name)?;
    let plan = SweepPlan::new(scene, &options(command, speeds)?, convergence)?;
    plan.warning().iter().for_each(|warning| warn(warning));
    let place = TablePlace::new(&output)?;
    let file = TableFile::open(&place.path, plan.header(), command.force)?;
    run(command, &plan, &file, &output)?;
    let mut table = SweepTable { header: plan.header().clone(), ..SweepTable::read(&place.path)? };
    table.sort();
    let few = plan.few_points(table.rows.iter().map(|stored| &stored.row));
    few.iter().for_each(|warning| warn(warning));
    table.find_low_end(&output);
    table.write(&place.path)?;
    drop(file);
    place.finish()?;
    finish(&output, &table, picture.as_deref(), master)
}

fn options(command: &Sweep, speeds: &Values) -> Result<SweepOptions, SweepError> {
    let loads = match (&command.pressures, &command.forces) {
        (_, Some(forces)) => Loads::Forces(forces.0.clone()),
        (Some(pressures), None) => Loads::Pressures(pressures.0.clone()),
        (None, None) => return Err(SweepError::NoLoad),
    };
    Ok(SweepOptions {
        speeds: speeds.0.clone(),
        loads,
        temperatures: command.temperatures.as_ref().map(|values| values.0.clone()),
        sliding: command.sliding.options(),
    })
}

/// Computes the points that are not done yet, on all cores.
fn run(command: &Sweep, plan: &SweepPlan, file: &TableFile, output: &Path) -> Result<(), FileError> {
    let in_shard = |index: usize| command.shard.is_none_or(|shard| shard.has(index));
    let points = plan.header().grid.points().enumerate().filter(|(index, _)| in_shard(*index)).map(|(_, point)| point);
    let points: Vec<OperatingPoint> = points.collect();
    let is_done = |point: &OperatingPoint| file.done.iter().any(|stored| stored.row.point == *point);
    let left: Vec<OperatingPoint> = points.iter().filter(|point| !is_done(point)).copied().collect();
    let bar = terminal::bar(points.len() as u64);
    bar.set_position((points.len() - left.len()) as u64);
    bar.reset_eta();
    bar.set_message(format!("of {} points", points.len()));
    bar.enable_steady_tick(std::time::Duration::from_secs(1));
    let done = bar.clone();
    let _farewell = Farewell::new(output, move || {
        let (points, all) = (done.position(), done.length().unwrap_or_default());
        done.finish_and_clear();
        format!("{points} of {all} points are done")
    });
    let work = plan.find(&left, None, |row| {
        file.add(&row)?;
        bar.inc(1);
        Ok(())
    });
    bar.finish_and_clear();
    work
}

impl Sliding {
    /// What of it is not the command line's.
    pub(crate) fn options(&self) -> SlidingOptions {
        let Self { method, points, error, distance } = *self;
        SlidingOptions { method, points, error, distance }
    }
}

/// The picture to draw; none of a shard.
fn picture(command: &Sweep, output: &Path) -> Option<PathBuf> {
    if command.shard.is_some() { None } else { picture_beside(output, command.plot.as_ref()) }
}

/// Draws friction over speed and, with the compound's shift, the master curve; prints friction and what lies at the low
/// end; counts the points that are not steady.
fn finish(
    output: &PathBuf,
    table: &SweepTable,
    picture: Option<&Path>,
    master: Option<(&Path, Wlf)>,
) -> Result<(), SweepError> {
    picture.map_or(Ok(()), |path| plot::draw(path, table))?;
    master.map_or(Ok(()), |(path, wlf)| plot::draw_master(path, table, &wlf))?;
    let mut summary = if terminal::is_quiet() { Vec::new() } else { printed::lines(table) };
    summary.extend(table.header.low_end.iter().map(|low_end| ("Low end", low_end.clone())));
    if !terminal::is_quiet() {
        let files = [output.as_path()].into_iter().chain(picture).chain(master.map(|(path, _)| path)).map(named);
        summary.push(("Written", files.collect::<Vec<_>>().join(", ")));
    }
    print_beside([output], &lines(&summary))?;
    let (failed, total) = (table.rows.iter().filter(|stored| !stored.row.is_steady()).count(), table.rows.len());
    if failed == 0 { Ok(()) } else { Err(SweepError::NotSteady { failed, total, path: output.to_owned() }) }
}

/// The shift of the compound with temperature.
fn wlf(scene: &Scene) -> Option<Wlf> {
    scene.material.as_ref().and_then(|material| material.wlf)
}

/// Separation of the carrier's rest line and the profile's mean line at w = 0, m.
pub(crate) fn separation_at_rest(scene: &Scene) -> f64 {
    let model = Model::new(scene);
    rest_separation(&model, &heights(scene, &model))
}

/// The scene without what a sweep does not depend on, and with the outputs that it reads.
pub(crate) fn relevant(scene: Scene) -> Scene {
    use OutputGroup::{Contact, Dissipation, Energy, Forces, Friction};
    let outputs = vec![Forces, Dissipation, Friction, Contact, Energy];
    let mut scene = Scene { outputs, excitation: Vec::new(), description: None, ..scene };
    scene.layer.initial = Initial::Relaxed;
    scene
}

/// The scene of one point. `solver.reduce` depends on the speed and on the duration of its excitation: as steady motion
/// has no end, no Maxwell element becomes a spring.
fn scene_at(scene: &Scene, point: &OperatingPoint) -> Scene {
    let mut scene = scene.with_temperature(point.temperature);
    let u = Displacement { rate: point.speed, ..Displacement::default() };
    scene.excitation = vec![Phase {
        duration: asperity::scene::LARGEST,
        u,
        w: Displacement::default(),
        until_force: None,
        until_pressure: None,
        ..Phase::default()
    }];
    scene
}

/// Steady sliding at one point, known to `bounds`; where the layer does not become steady, the status of the point.
pub(crate) fn steady_sliding(
    scene: &Scene,
    point: &OperatingPoint,
    load: Load,
    bounds: StopBounds,
) -> Result<SteadySliding, String> {
    let scene = scene_at(&relevant(scene.clone()), point);
    steady(point::sliding(&scene, point.speed, load.force(point.load), bounds, None))
}

/// Steady sliding at one point with the carrier held at `w` (m), where the load is near that of the point.
fn steady_sliding_at(
    scene: &Scene,
    point: &OperatingPoint,
    w: f64,
    load: Load,
    bounds: StopBounds,
) -> Result<SteadySliding, String> {
    let scene = scene_at(&relevant(scene.clone()), point);
    steady(point::sliding_at(&scene, point.speed, w, load.force(point.load), bounds))
}

fn steady(result: PointResult) -> Result<SteadySliding, String> {
    match result.sliding {
        Some(sliding) if result.status == asperity::element::STEADY => Ok(sliding),
        _ => Err(result.status),
    }
}
