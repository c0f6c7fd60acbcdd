//! `asperity sweep`: the friction coefficient over speed, load and temperature, as a table and a picture.

mod error;
mod estimate;
mod file;
mod grid;
mod merge;
mod plot;
mod point;
mod secant;
mod slide;
mod steady;
mod stiffness;
mod table;

use std::path::{Path, PathBuf};

use asperity::model::Model;
use asperity::scene::{Initial, OutputGroup, Path as Motion, Phase, Scene};
use rayon::prelude::*;

use super::arguments::Sweep;
use super::error::ProgramError;
use super::progress;
pub(crate) use error::SweepError;
use file::TableFile;
use grid::{Grid, Point};
pub(crate) use grid::{Shard, Values};
use point::Bounds;
use table::{Header, LoadKind, Table};

/// Makes a table or joins several.
pub(crate) fn sweep(command: &Sweep) -> Result<(), ProgramError> {
    match (&command.scene, &command.speeds, &command.output) {
        (Some(scene), Some(speeds), _) => make(command, scene, speeds),
        (_, _, Some(output)) => join(command, output),
        // clap asks for a scene and speeds, or for tables and an output.
        _ => Ok(()),
    }
}

fn join(command: &Sweep, output: &Path) -> Result<(), ProgramError> {
    super::check_output(output, &command.merge)?;
    let table = merge::merge(&command.merge, output)?;
    finish(command, output, &table)
}

fn make(command: &Sweep, path: &Path, speeds: &Values) -> Result<(), ProgramError> {
    let mut scene = super::load(path)?;
    super::set_parameters(&mut scene, &command.set)?;
    let (load, loads) = load_kind(command, &scene)?;
    let grid = Grid { speeds: speeds.clone(), loads, temperatures: temperatures(command, &scene)? };
    let output = command.output.clone().unwrap_or_else(|| default_output(path));
    super::check_output(&output, &super::sources(path, &scene))?;
    let scene = bare(scene);
    let model = Model::new(&scene);
    let header = Header {
        fingerprint: fingerprint(&scene, command, load)?,
        scene: scene.name.clone(),
        load,
        rest_separation: estimate::rest_separation(&model, &estimate::heights(&scene, &model)),
        grid,
    };
    let file = TableFile::open(&output, &header, command.force)?;
    run(command, &scene, &header, &file)?;
    let table = sorted(file::read(&output)?);
    file::write_table(&output, &header, table.lines.iter().map(|line| line.text.as_str()))?;
    finish(command, &output, &table)
}

/// Does the points that are not done yet, on all cores.
fn run(command: &Sweep, scene: &Scene, header: &Header, file: &TableFile) -> Result<(), ProgramError> {
    let points = header.grid.points();
    let asked = |number: usize| command.shard.is_none_or(|shard| shard.has(number));
    let own: Vec<Point> = points.into_iter().enumerate().filter(|(i, _)| asked(*i)).map(|(_, point)| point).collect();
    let done = |point: &Point| file.done.iter().any(|line| line.point == *point);
    let left: Vec<Point> = own.iter().filter(|point| !done(point)).copied().collect();
    let bar = progress::bar(own.len() as u64);
    bar.set_position((own.len() - left.len()) as u64);
    bar.reset_eta();
    bar.set_message(format!("of {} points", own.len()));
    bar.enable_steady_tick(std::time::Duration::from_secs(1));
    let bounds = Bounds { error: command.error, distance: command.distance };
    let work = left.par_iter().with_max_len(1).try_for_each(|point| {
        let row = point::find(&at(scene, point), point.speed, header.load.force(point.load), bounds);
        file.add(&row.line(point, header))?;
        bar.inc(1);
        Ok(())
    });
    bar.finish_and_clear();
    work
}

/// Draws the picture and says which points are not to be relied on.
fn finish(command: &Sweep, output: &Path, table: &Table) -> Result<(), ProgramError> {
    if command.shard.is_none() {
        let picture = command.plot.clone().unwrap_or_else(|| output.with_extension("svg"));
        super::check_output(&picture, &[vec![output.to_owned()], command.merge.clone()].concat())?;
        plot::draw(&picture, table)?;
    }
    let failed = table.lines.iter().filter(|line| !line.is_steady()).count();
    if failed == 0 {
        return Ok(());
    }
    Err(SweepError::Failed { failed, total: table.lines.len(), path: output.to_owned() }.into())
}

/// The table with its rows in the order of the points.
fn sorted(mut table: Table) -> Table {
    let points = table.header.grid.points();
    table.lines.sort_by_key(|line| points.iter().position(|point| *point == line.point));
    table
}

fn default_output(scene: &Path) -> PathBuf {
    let stem = scene.file_stem().unwrap_or(scene.as_os_str());
    PathBuf::from(stem).with_extension("sweep.csv")
}

fn load_kind(command: &Sweep, scene: &Scene) -> Result<(LoadKind, Values), SweepError> {
    match (&command.pressures, &command.forces) {
        (_, Some(forces)) => Ok((LoadKind::Force, forces.clone())),
        (Some(pressures), None) => {
            let area = scene.layer.area().ok_or(SweepError::NoArea)?;
            Ok((LoadKind::Pressure { area }, pressures.clone()))
        }
        (None, None) => Err(SweepError::NoLoad),
    }
}

/// Those asked for, or the scene's own; `None` where it has none.
fn temperatures(command: &Sweep, scene: &Scene) -> Result<Option<Values>, ProgramError> {
    let own = scene.material.as_ref().and_then(|material| material.wlf.as_ref()).map(|wlf| wlf.temperature);
    let Some(own) = own else {
        return if command.temperatures.is_some() { Err(SweepError::NoWlf.into()) } else { Ok(None) };
    };
    let values = command.temperatures.clone().unwrap_or_else(|| Values(vec![own]));
    for &temperature in &values.0 {
        let refused = |refusal| ProgramError::Temperature { option: "--temperatures", refusal };
        with_temperature(scene, temperature).check().map_err(refused)?;
    }
    Ok(Some(values))
}

fn with_temperature(scene: &Scene, temperature: f64) -> Scene {
    let mut scene = scene.clone();
    if let Some(wlf) = scene.material.as_mut().and_then(|material| material.wlf.as_mut()) {
        wlf.temperature = temperature;
    }
    scene
}

/// The scene without what is no matter to a sweep, and with the outputs that it reads.
fn bare(scene: Scene) -> Scene {
    use OutputGroup::{Contact, Dissipation, Energy, Forces, Friction};
    let outputs = vec![Forces, Dissipation, Friction, Contact, Energy];
    let mut scene = Scene { outputs, excitation: Vec::new(), description: None, ..scene };
    scene.layer.initial = Initial::Relaxed;
    scene
}

/// The scene of one point. Its excitation is there for `solver.reduce`, which goes by the speed and by how long a run
/// is: steady motion has no end, so that no element is a spring.
fn at(scene: &Scene, point: &Point) -> Scene {
    let mut scene = match point.temperature {
        Some(temperature) => with_temperature(scene, temperature),
        None => scene.clone(),
    };
    let u = Motion { rate: point.speed, ..Motion::default() };
    scene.excitation = vec![Phase {
        duration: asperity::scene::LARGEST,
        u,
        w: Motion::default(),
        until_force: None,
        until_pressure: None,
    }];
    scene
}

fn fingerprint(scene: &Scene, command: &Sweep, load: LoadKind) -> Result<String, ProgramError> {
    // Whatever the temperature is: each point has its own.
    let scene = with_temperature(scene, 0.0);
    let settings = format!("{} {:?} {:?}", load.name(), command.error, command.distance);
    table::fingerprint(&scene, &settings).map_err(ProgramError::Json)
}

/// What a layer does in steady sliding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sliding {
    /// Where the carrier is, m.
    pub(crate) w: f64,
    /// Mean F_z, N.
    pub(crate) force_z: f64,
    /// Mean force against the motion, N.
    pub(crate) drag: f64,
    /// Power lost, W.
    pub(crate) power: f64,
}

/// One point of a sweep of `scene`, a `load` being the force on the layer (N); what is wrong in words where it is not
/// steady.
pub(crate) fn sliding(
    scene: &Scene,
    speed: f64,
    load: f64,
    temperature: Option<f64>,
    error: f64,
) -> Result<Sliding, String> {
    let scene = at(&bare(scene.clone()), &Point { speed, load, temperature });
    let row = point::find(&scene, speed, load, Bounds { error, distance: None });
    let found = (row.status == table::STEADY).then_some(()).and_then(|()| {
        let (w, force_z, [friction, ..]) = (row.w?, row.force?, row.friction?);
        Some(Sliding { w, force_z, drag: friction * force_z, power: row.power.iter().flatten().sum() })
    });
    found.ok_or(row.status)
}
