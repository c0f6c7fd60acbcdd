//! `asperity report`: what the runs of a scene cost and how accurate they are, as tables, pictures and one page.

mod convergence;
mod page;
mod reference;
mod robustness;
mod run;
mod tables;
mod trace;

use std::path::PathBuf;
use std::{fs, io};

use asperity::robustness::RunFailure;
use asperity::scene::Scene;

use super::cli::Report;
use super::figure::{Figure as _, Ladders};
use super::files::{FileError, check_output, load, set_parameters, sources, write};
use super::result_file::ResultFileError;
use super::terminal::warn;
use convergence::{CommunicationRow, CommunicationSteps, ToleranceLadder, ToleranceRow};
use reference::Reference;
use robustness::Robustness;
use run::Progress;
use tables::Peers;

/// `asperity report` failed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ReportError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Peers(#[from] ResultFileError),
    #[error("the scene {0}")]
    NoRun(&'static str),
    #[error("no reference: not even the loosest tolerance comes to its end: {0}")]
    Reference(RunFailure),
}

const PAGE: &str = "index.html";
/// The table and the pictures of errors and run times, without their endings.
const ERRORS: &str = "error-run-time";
/// Those of errors and communication steps.
const COMMUNICATION: &str = "error-communication-step";
/// The table of the perturbed runs.
const STRESS: &str = "stress";

/// Runs the scene in every way and writes the results.
pub(crate) fn report(command: &Report) -> Result<(), ReportError> {
    let mut scene = load(&command.scene)?;
    set_parameters(&mut scene, &command.set)?;
    if scene.excitation.is_empty() {
        return Err(ReportError::NoRun("has no [[excitation]]: the carrier rests, and there is no run to report on"));
    }
    let folder = Folder::new(command, &scene)?;
    let peers = read_peers(command, &scene)?;
    let parts = Parts::run(command, &scene, peers)?;
    fs::create_dir_all(&folder.path).map_err(FileError::io("create", &folder.path))?;
    let errors = folder.file(ERRORS, "csv");
    tables::write_errors(&errors, &scene.name, &parts.reference, &parts.rows)?;
    let communication = folder.file(COMMUNICATION, "csv");
    tables::write_communication(&communication, &scene.name, &parts.reference, &parts.communication)?;
    if let Some(robustness) = &parts.robustness {
        tables::write_robustness(&folder.file(STRESS, "csv"), &scene.name, robustness)?;
    }
    let errors = folder.draw(ERRORS, &page::tolerance_picture(&parts.reference, &parts.rows))?;
    let communication = page::communication_picture(&parts.reference, &parts.communication);
    let communication = folder.draw(COMMUNICATION, &communication)?;
    let file = folder.path.join(PAGE);
    let page = parts.page(command, &scene, &errors, &communication).map_err(FileError::io("write", &file))?;
    Ok(write(&file, page)?)
}

#[derive(Debug)]
struct Parts {
    reference: Reference,
    /// This program's runs, then the peers'.
    rows: Vec<ToleranceRow>,
    communication: Vec<CommunicationRow>,
    /// Where it was asked for.
    robustness: Option<Robustness>,
}

impl Parts {
    fn run(command: &Report, scene: &Scene, peers: Peers) -> Result<Self, ReportError> {
        let scene = run::watched(scene);
        let tolerances = &command.tolerances.0;
        let ladder = ToleranceLadder { tolerances, points: command.points, repeat: command.repeat };
        let tightest = tolerances.last().copied().unwrap_or_default();
        let by_steps = CommunicationSteps::weight(tightest / 10.0, scene.solver.relative_tolerance);
        let progress = Progress::new(Reference::weight(tightest) + ladder.weight() + by_steps);
        let reference = Reference::find(&scene, tolerances, command.points, &progress);
        let reference = reference.map_err(ReportError::Reference)?;
        if reference.scene.excitation.iter().all(|phase| phase.duration <= 0.0) {
            return Err(ReportError::NoRun("takes no time: every phase of its [[excitation]] ends at once"));
        }
        let mut rows = ladder.run(&reference, &progress);
        rows.extend(peers.rows);
        let communication = CommunicationSteps::new(&reference, &progress).run();
        drop(progress);
        let robustness = (command.stress > 0)
            .then(|| Robustness::run(&reference, command.stress, command.points, command.stress_time));
        Ok(Self { reference, rows, communication, robustness })
    }

    /// The page, with the pictures of errors and communication steps as SVG.
    fn page(&self, command: &Report, scene: &Scene, errors: &str, communication: &str) -> io::Result<String> {
        let mut sections = vec![
            page::tolerances(command, &self.reference, &self.rows, errors)?,
            page::communication(scene, &self.reference, &self.communication, communication)?,
        ];
        if let Some(robustness) = &self.robustness {
            sections.push(page::robustness(scene, robustness)?);
        }
        page::page(scene, &sections)
    }
}

/// The peers' rows of this scene; warns where the file has none.
fn read_peers(command: &Report, scene: &Scene) -> Result<Peers, ReportError> {
    let Some(path) = &command.peers else { return Ok(Peers::default()) };
    let stem = command.scene.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let peers = tables::read_peers(path, &[&scene.name, &stem])?;
    if peers.rows.is_empty() {
        let there = peers.scenes.join(", ");
        warn(&format!("{}: no lines of the scene {}; there are {there}", path.display(), scene.name));
    }
    Ok(peers)
}

/// The folder that the report is written to.
#[derive(Debug)]
struct Folder {
    path: PathBuf,
}

impl Folder {
    /// Checks that no file written takes the place of one that is read.
    fn new(command: &Report, scene: &Scene) -> Result<Self, FileError> {
        let folder = Self { path: command.output.clone() };
        let taken: Vec<PathBuf> = sources(&command.scene, scene).into_iter().chain(command.peers.clone()).collect();
        let drawn = [ERRORS, COMMUNICATION].into_iter().flat_map(|name| ["csv", "svg", "png"].map(|end| (name, end)));
        let others = [folder.file(STRESS, "csv"), folder.path.join(PAGE)];
        let mut files = drawn.map(|(name, end)| folder.file(name, end)).chain(others);
        files.try_for_each(|file| check_output(&file, &taken))?;
        Ok(folder)
    }

    fn file(&self, name: &str, ending: &str) -> PathBuf {
        self.path.join(format!("{name}.{ending}"))
    }

    /// Draws a picture as SVG and PNG. Returns the text of the SVG.
    fn draw(&self, name: &str, picture: &Ladders) -> Result<String, FileError> {
        let [svg_file, png_file] = ["svg", "png"].map(|ending| self.file(name, ending));
        let svg = picture.svg().map_err(|error| FileError::picture(&svg_file, &*error))?;
        write(&svg_file, &svg)?;
        picture.write(&png_file)?;
        Ok(svg)
    }
}
