//! `asperity sweep`: the friction coefficient over speed, load and temperature, as a table and a plot.

mod map;
mod plot;
mod printed;
mod samples;
mod table_file;
mod ways;

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use asperity::element::{OperatingPoint, TableHeader};
use asperity::scene::{Scene, Wlf};
use asperity_study::progress::Stop;
use asperity_study::sweep::{
    Loads, NotAStudy, SlidingOptions, SweepError, SweepOptions, SweepPlan, SweepTable, verdict,
};
use asperity_study::uncertainty::UncertaintyError;

use super::cli::{Sliding, Sweep};
use super::draft::TablePlace;
use super::figure::Figure as _;
use super::files::{
    FileError, check_outputs, default_output, load_without_run, named, picture_beside, print_beside, read, write,
};
use super::flags::with_flags;
use super::interrupt::Farewell;
use super::terminal::{self, LabelledLine, lines, warn};
use crate::cli::sweep_values::Values;
use map::{MapError, Maps};
use table_file::{TableFile, TableFileError};

/// `asperity sweep` failed, or not all of its points are steady.
#[derive(Debug, thiserror::Error)]
pub(crate) enum SweepCommandError {
    #[error(transparent)]
    Sweep(#[from] SweepError),
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Uncertainty(#[from] UncertaintyError),
    #[error(transparent)]
    TableFile(#[from] TableFileError),
    #[error(transparent)]
    Map(#[from] MapError),
    #[error("expected --pressures or --forces, the loads to sweep over")]
    NoLoad,
    #[error("--master: the scene has no material.wlf, by whose factors speeds would be shifted")]
    NoMaster,
    #[error("{}: not a study of this scene's convergence: {problem}", .path.display())]
    NotAStudy { path: PathBuf, problem: NotAStudy },
    #[error("{}: is there, and a table over --ways is not continued: name another -o, or give --force to replace it", .0.display())]
    IsThere(PathBuf),
    #[error("{failed} of {total} points are not steady or failed: the column status in {} says why", named(.path))]
    NotSteady { failed: usize, total: usize, path: PathBuf },
}

/// Computes a table or merges several.
pub(crate) fn sweep(command: &Sweep) -> Result<(), SweepCommandError> {
    match (&command.scene, &command.speeds, &command.output) {
        (Some(scene), Some(speeds), _) => compute(command, scene, speeds),
        (_, _, Some(output)) => merge(command, output),
        // clap requires a scene and speeds, or tables and an output.
        _ => Ok(()),
    }
}

fn merge(command: &Sweep, output: &PathBuf) -> Result<(), SweepCommandError> {
    let picture = picture(command, output);
    let taken = command.merge.iter().chain(&command.data).cloned().collect();
    check_outputs([output].into_iter().chain(&picture), taken)?;
    let place = TablePlace::new(output)?;
    let table = table_file::merge(&command.merge, &place.path, command.force)?;
    place.finish()?;
    let maps = maps(command, &table.header, output)?;
    finish(output, &table, &Pictures { friction: picture.as_deref(), maps, master: None }, (&[], &[]))
}

fn compute(command: &Sweep, path: &Path, speeds: &Values) -> Result<(), SweepCommandError> {
    let scene = load_without_run(path, &command.set, |scene| !command.sliding.options().solves(scene))?;
    let output = command
        .output
        .clone()
        .unwrap_or_else(|| default_output(path, if command.ways.is_some() { "ways.csv" } else { "sweep.csv" }));
    let picture = picture(command, &output);
    let study = study_file(command.converged.as_ref(), path);
    let taken = scene.sources(path).into_iter().chain(study.clone()).chain(command.data.clone()).collect();
    let beside = samples::files(command, &output);
    check_outputs([&output].into_iter().chain(&picture).chain(&command.master).chain(&beside), taken)?;
    let master = match &command.master {
        Some(path) => Some((path.as_path(), wlf(&scene).ok_or(SweepCommandError::NoMaster)?)),
        None => None,
    };
    if let Some(ways) = &command.ways {
        return over_ways(command, &scene, &options(command, speeds)?, (&ways.0, &output, picture.as_deref()));
    }
    let convergence = study_verdict(study.as_deref(), &scene.name)?;
    let plan = samples::plan(command, scene, (&options(command, speeds)?, convergence))?;
    plan.warning().iter().for_each(|warning| warn(&with_flags(warning)));
    let maps = maps(command, plan.header(), &output)?;
    let place = TablePlace::new(&output)?;
    let file = TableFile::open(&place.path, plan.header(), command.force)?;
    run(command, &plan, &file, &output)?;
    let mut table =
        SweepTable { header: plan.header().clone(), ..SweepTable::read(&place.path).map_err(TableFileError::from)? };
    table.sort();
    let found = plan.warnings(table.rows.iter().map(|stored| &stored.row));
    found.iter().for_each(|warning| warn(&with_flags(warning)));
    table.conclude(&output);
    write(&place.path, table.text())?;
    drop(file);
    place.finish()?;
    let said = samples::write(command, &plan, &table, &beside)?;
    finish(&output, &table, &Pictures { friction: picture.as_deref(), maps, master }, (&said, &beside))
}

/// Sweeps over several ways.
fn over_ways(
    command: &Sweep,
    scene: &Scene,
    options: &SweepOptions,
    (ways, output, picture): (&[f64], &PathBuf, Option<&Path>),
) -> Result<(), SweepCommandError> {
    if output.exists() && !command.force {
        return Err(SweepCommandError::IsThere(output.to_owned()));
    }
    let [total, failed] = ways::sweep(scene, options, ways, (output, picture))?;
    let files = [output.as_path()].into_iter().chain(picture).map(named).collect::<Vec<_>>().join(", ");
    print_beside([output], &lines(&[("Points", format!("{total}, at {} ways", ways.len())), ("Written", files)]))?;
    if failed == 0 { Ok(()) } else { Err(SweepCommandError::NotSteady { failed, total, path: output.to_owned() }) }
}

/// The table of the study named, or of the one that `asperity converge` has written for the scene; `None` without one.
fn study_file(named: Option<&PathBuf>, scene_file: &Path) -> Option<PathBuf> {
    let usual = default_output(scene_file, "converge.csv");
    named.cloned().or(Some(usual).filter(|usual| usual.exists()))
}

/// The verdict of the study at `path` on `scene`.
fn study_verdict(path: Option<&Path>, scene: &str) -> Result<Option<String>, SweepCommandError> {
    let Some(path) = path else { return Ok(None) };
    let text = String::from_utf8_lossy(&read(path)?).into_owned();
    match verdict(&text, scene) {
        Ok(verdict) => Ok(Some(verdict)),
        Err(problem) => Err(SweepCommandError::NotAStudy { path: path.to_owned(), problem }),
    }
}

fn options(command: &Sweep, speeds: &Values) -> Result<SweepOptions, SweepCommandError> {
    let loads = match (&command.pressures, &command.forces) {
        (_, Some(forces)) => Loads::Forces(forces.0.clone()),
        (Some(pressures), None) => Loads::Pressures(pressures.0.clone()),
        (None, None) => return Err(SweepCommandError::NoLoad),
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
    let work = plan.find(&left, &Stop::default(), |row| {
        if let Err(error) = file.add(&row) {
            return ControlFlow::Break(error);
        }
        bar.inc(1);
        ControlFlow::Continue(())
    });
    bar.finish_and_clear();
    work.break_value().map_or(Ok(()), Err)
}

impl Sliding {
    /// What of it is not the command line's.
    pub(crate) fn options(&self) -> SlidingOptions {
        let Self { method, way, points, friction_error: error, distance, .. } = *self;
        SlidingOptions { method, way, points, error, distance }
    }
}

/// The picture to draw; none of a shard.
fn picture(command: &Sweep, output: &Path) -> Option<PathBuf> {
    if command.shard.is_some() { None } else { picture_beside(output, command.plot.as_ref()) }
}

/// The maps that are asked for, if any are, of the table at `output`.
fn maps(command: &Sweep, header: &TableHeader, output: &Path) -> Result<Option<Maps>, MapError> {
    let Some(over) = command.over else { return Ok(None) };
    if picture(command, output).is_none() {
        return Err(MapError::NoPicture { over, output: output.to_owned() });
    }
    Maps::new(over, header, output, command.data.as_ref()).map(Some)
}

/// What is drawn of a table.
struct Pictures<'a> {
    /// Friction over speed, ...
    friction: Option<&'a Path>,
    /// ... or, in its place, maps.
    maps: Option<Maps>,
    /// The master curve, with the compound's shift.
    master: Option<(&'a Path, Wlf)>,
}

/// Draws the pictures; prints friction and what lies at the low end; counts the points that are not steady.
fn finish(
    output: &PathBuf,
    table: &SweepTable,
    pictures: &Pictures<'_>,
    (said, beside): (&[LabelledLine], &[PathBuf]),
) -> Result<(), SweepCommandError> {
    let Pictures { friction, maps, master } = pictures;
    friction.map_or(Ok(()), |path| match maps {
        Some(maps) => maps.picture(table).write(path),
        None => plot::draw(path, table),
    })?;
    master.map_or(Ok(()), |(path, wlf)| plot::draw_master(path, table, &wlf))?;
    let mut summary = printed::lines(table);
    summary.extend(table.header.low_end.iter().map(|low_end| ("Low end", low_end.clone())));
    summary.extend(maps.iter().filter_map(|_| Some(("No result", Maps::empty(table)?))));
    summary.extend_from_slice(said);
    let files = [output.as_path()].into_iter().chain(*friction).chain(master.map(|(path, _)| path));
    let files = files.chain(beside.iter().map(PathBuf::as_path)).map(named);
    summary.push(("Written", files.collect::<Vec<_>>().join(", ")));
    print_beside([output], &lines(&summary))?;
    let (failed, total) = (table.rows.iter().filter(|stored| !stored.row.is_result()).count(), table.rows.len());
    if failed == 0 { Ok(()) } else { Err(SweepCommandError::NotSteady { failed, total, path: output.to_owned() }) }
}

/// The shift of the compound with temperature.
fn wlf(scene: &Scene) -> Option<Wlf> {
    scene.material.as_ref().and_then(|material| material.wlf)
}
