//! `asperity report`: what a scene's runs cost and how right they are, as tables, pictures and one page.
//!
//! Each part of the report has its data, its pictures and tables, and its section of the page.

mod communication;
mod ladder;
mod page;
mod peers;
mod pictures;
mod progress;
mod reference;
mod runs;
mod stress;
mod table;
mod trace;

use std::fs;
use std::path::{Path, PathBuf};

use asperity::scene::Scene;

use super::arguments::Report;
use super::error::ProgramError;
use super::figure::{Figure as _, Ladders};
use ladder::Ladder;
use peers::Peers;
use progress::Progress;
use stress::Stress;

/// The page.
const PAGE: &str = "index.html";
/// The table and the pictures of errors and run times, without their endings.
const ERRORS: &str = "error-run-time";
/// The table of the scene under stress.
const STRESS: &str = "stress";
/// Those of errors and communication steps.
const COMMUNICATION: &str = "error-communication-step";

/// Runs the scene in every way and writes what came of it.
pub(crate) fn report(command: &Report) -> Result<(), ProgramError> {
    let mut scene = super::load(&command.scene)?;
    super::set_parameters(&mut scene, &command.set)?;
    if scene.excitation.is_empty() {
        return Err(ProgramError::NoRun("has no [[excitation]]: the carrier rests, and there is no run to report on"));
    }
    let folder = Folder::new(command, &scene)?;
    let peers = read_peers(command, &scene)?;
    let parts = run(command, &scene, peers)?;
    folder.create()?;
    table::write_errors(&folder.file(ERRORS, "csv"), &scene.name, &parts.reference, &parts.rows)?;
    table::write_communication(
        &folder.file(COMMUNICATION, "csv"),
        &scene.name,
        &parts.reference,
        &parts.communication,
    )?;
    if let Some(stress) = &parts.stress {
        table::write_stress(&folder.file(STRESS, "csv"), &scene.name, stress)?;
    }
    let errors = folder.draw(ERRORS, &pictures::errors(&parts.reference, &parts.rows))?;
    let communication = pictures::communication(&parts.reference, &parts.communication);
    let communication = folder.draw(COMMUNICATION, &communication)?;
    let page_file = folder.path.join(PAGE);
    write_page(&page_file, command, &scene, &parts, [&errors, &communication])
        .map_err(|source| ProgramError::file("write", &page_file)(source))
}

/// Writes the page; `pictures` are those of its sections, in their order.
fn write_page(
    path: &Path,
    command: &Report,
    scene: &Scene,
    parts: &Parts,
    [errors, communication]: [&str; 2],
) -> std::io::Result<()> {
    let mut sections = vec![page::accuracy(command, parts, errors)?, page::communication(scene, parts, communication)?];
    if let Some(stress) = &parts.stress {
        sections.push(page::stress(scene, stress)?);
    }
    fs::write(path, page::page(scene, &sections)?)
}

/// What the report's parts show.
#[derive(Debug)]
struct Parts {
    reference: reference::Reference,
    /// This program's rungs, then the peers'.
    rows: Vec<ladder::Row>,
    communication: Vec<communication::Row>,
    /// The scene under stress, where that was asked for.
    stress: Option<Stress>,
}

fn run(command: &Report, scene: &Scene, peers: Peers) -> Result<Parts, ProgramError> {
    let scene = runs::watched(scene);
    let tolerances = &command.tolerances.0;
    let ladder = Ladder { tolerances, points: command.points, repeat: command.repeat };
    let tightest = tolerances.last().copied().unwrap_or_default();
    let by_steps = communication::ladder_weight(tightest / 10.0, scene.solver.relative_tolerance);
    let progress = Progress::new(reference::search_weight(tightest) + ladder.weight() + by_steps);
    let reference = reference::find(&scene, tolerances, command.points, &progress);
    let reference = reference.inspect_err(|_| progress.finish()).map_err(ProgramError::Reference)?;
    if reference.scene.excitation.iter().all(|phase| phase.duration <= 0.0) {
        progress.finish();
        return Err(ProgramError::NoRun("takes no time: every phase of its [[excitation]] ends at once"));
    }
    let mut rows = ladder.run(&reference, &progress);
    let communication = communication::climb(&reference, &progress);
    progress.finish();
    rows.extend(peers.rows);
    let stress =
        (command.stress > 0).then(|| stress::run(&reference, command.stress, command.points, command.stress_time));
    Ok(Parts { reference, rows, communication, stress })
}

/// The peers' rows of this scene; a file that has none of it is worth a warning.
fn read_peers(command: &Report, scene: &Scene) -> Result<Peers, ProgramError> {
    let Some(path) = &command.peers else { return Ok(Peers::default()) };
    let stem = command.scene.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let peers = peers::read(path, &[&scene.name, &stem])?;
    if peers.rows.is_empty() {
        let there = peers.scenes.join(", ");
        super::warn(&format!("{}: no lines of the scene {}; there are {there}", path.display(), scene.name));
    }
    Ok(peers)
}

/// Where the report goes.
#[derive(Debug)]
struct Folder {
    path: PathBuf,
}

impl Folder {
    /// The folder that the command names; none of the files to come takes the place of one that is read.
    fn new(command: &Report, scene: &Scene) -> Result<Self, ProgramError> {
        let folder = Self { path: command.output.clone() };
        let taken: Vec<PathBuf> =
            super::sources(&command.scene, scene).into_iter().chain(command.peers.clone()).collect();
        let files = [ERRORS, COMMUNICATION].into_iter().flat_map(|name| ["csv", "svg", "png"].map(|end| (name, end)));
        let others = [folder.file(STRESS, "csv"), folder.path.join(PAGE)];
        for file in files.map(|(name, end)| folder.file(name, end)).chain(others) {
            super::check_output(&file, &taken)?;
        }
        Ok(folder)
    }

    fn create(&self) -> Result<(), ProgramError> {
        fs::create_dir_all(&self.path).map_err(ProgramError::file("create", &self.path))
    }

    fn file(&self, name: &str, ending: &str) -> PathBuf {
        self.path.join(format!("{name}.{ending}"))
    }

    /// Draws a picture as SVG and PNG and returns the text of the SVG.
    fn draw(&self, name: &str, picture: &Ladders) -> Result<String, ProgramError> {
        let [svg_file, png_file] = ["svg", "png"].map(|ending| self.file(name, ending));
        picture.write(&png_file)?;
        let svg = picture.svg().map_err(|error| ProgramError::picture(&svg_file, &*error))?;
        fs::write(&svg_file, &svg).map_err(ProgramError::file("write", &svg_file))?;
        Ok(svg)
    }
}
