//! The report of one scene: its runs, and what is written of them.

use std::path::{Path, PathBuf};

use asperity::scene::Scene;

use super::convergence::{CommunicationLadder, CommunicationRow, ToleranceLadder, ToleranceRow};
use super::folder::{COMMUNICATION, ERRORS, INDEX, JUDGEMENTS, ReportFolder, STRESS};
use super::judgement::Judgement;
use super::reference::Reference;
use super::robustness::Robustness;
use super::run::{self, Progress};
use super::tables::{self, Peers};
use super::{ReportError, page, stem, write_judgements};
use crate::cli::Report;
use crate::files::{FileError, load};
use crate::terminal::warn;

/// A scene that can be run, its folder and its peers.
#[derive(Debug)]
pub(super) struct SceneReport<'a> {
    command: &'a Report,
    path: &'a Path,
    scene: Scene,
    folder: ReportFolder,
    peers: Peers,
}

impl<'a> SceneReport<'a> {
    /// Reads what is needed and checks it, before anything is run or written.
    pub(super) fn prepare(command: &'a Report, path: &'a Path, folder: &Path) -> Result<Self, ReportError> {
        let scene = load(path, &command.set)?;
        if scene.excitation.is_empty() {
            let why = "has no [[excitation]]: the carrier rests, and there is no run to report on";
            return Err(ReportError::NoRun { scene: path.to_owned(), why });
        }
        let taken: Vec<PathBuf> = scene.sources(path).into_iter().chain(command.peers.clone()).collect();
        let folder = ReportFolder::new(folder, &[ERRORS, JUDGEMENTS, COMMUNICATION], &taken)?;
        let peers = read_peers(command, path, &scene)?;
        Ok(Self { command, path, scene, folder, peers })
    }

    /// The files that are read.
    pub(super) fn sources(&self) -> impl Iterator<Item = PathBuf> + use<> {
        self.scene.sources(self.path).into_iter().chain(self.command.peers.clone())
    }

    /// Runs the scene and writes its report. Returns how its runs keep what they promise.
    pub(super) fn run(&self) -> Result<Vec<Judgement>, ReportError> {
        let results = SceneResults::run(self.command, self.path, &self.scene, &self.peers)?;
        self.folder.create()?;
        self.write(&results)?;
        Ok(results.judgements)
    }

    fn write(&self, results: &SceneResults) -> Result<(), FileError> {
        let Self { command, scene, folder, .. } = self;
        let SceneResults { reference, rows, communication, robustness, judgements } = results;
        let name = scene.name.as_str();
        tables::write_errors(&folder.file(ERRORS, "csv"), name, reference, rows)?;
        tables::write_communication(&folder.file(COMMUNICATION, "csv"), name, reference, communication)?;
        let picture = folder.draw(ERRORS, &page::tolerance_picture(reference, rows))?;
        let mut sections = vec![page::tolerances(command, reference, rows, &picture).map_err(folder.error())?];
        sections.push(write_judgements(folder, &[(name, judgements)])?);
        let picture = folder.draw(COMMUNICATION, &page::communication_picture(reference, communication))?;
        sections.push(page::communication(scene, reference, communication, &picture).map_err(folder.error())?);
        if let Some(robustness) = robustness {
            tables::write_robustness(&folder.file(STRESS, "csv"), name, robustness)?;
            sections.push(page::robustness(scene, robustness).map_err(folder.error())?);
        }
        folder.write(INDEX, page::page(scene, &sections).map_err(folder.error())?)
    }
}

#[derive(Debug)]
struct SceneResults {
    reference: Reference,
    /// This program's runs, then whole processes, its own and the peers'.
    rows: Vec<ToleranceRow>,
    communication: Vec<CommunicationRow>,
    /// Where it was asked for.
    robustness: Option<Robustness>,
    judgements: Vec<Judgement>,
}

impl SceneResults {
    fn run(command: &Report, path: &Path, scene: &Scene, peers: &Peers) -> Result<Self, ReportError> {
        let scene = run::watched(scene);
        let tolerances = &command.tolerances.0;
        let ladder = ToleranceLadder { tolerances, points: command.points, repeat: command.repeat };
        let tightest = tolerances.last().copied().unwrap_or_default();
        let by_steps = CommunicationLadder::weight(tightest / 10.0, scene.solver.relative_tolerance);
        let progress = Progress::new(Reference::weight(tightest) + ladder.weight() + by_steps);
        let reference = Reference::find(&scene, tolerances, command.points, &progress)
            .map_err(|failure| ReportError::Reference { scene: path.to_owned(), failure })?;
        if reference.scene.excitation.iter().all(|phase| phase.duration <= 0.0) {
            let why = "takes no time: every phase of its [[excitation]] ends at once";
            return Err(ReportError::NoRun { scene: path.to_owned(), why });
        }
        let mut rows = ladder.run(&reference, &progress);
        let communication = CommunicationLadder::new(&reference, &progress).run();
        drop(progress);
        ladder.time(&reference, &mut rows);
        let robustness = (command.stress > 0)
            .then(|| Robustness::run(&reference, command.stress, command.points, command.stress_time));
        let mut judgements: Vec<Judgement> = Judgement::from_tolerances(&reference, &rows).collect();
        let method = page::method(&scene);
        judgements.extend(robustness.iter().flat_map(|all| Judgement::from_perturbations(all, &method)));
        rows.extend(peers.rows.iter().cloned());
        Ok(Self { reference, rows, communication, robustness, judgements })
    }
}

/// The peers' rows of this scene; warns where the file has none.
fn read_peers(command: &Report, scene_path: &Path, scene: &Scene) -> Result<Peers, ReportError> {
    let Some(path) = &command.peers else { return Ok(Peers::default()) };
    let peers = tables::read_peers(path, &[&scene.name, &stem(scene_path)])?;
    if peers.rows.is_empty() {
        let there = peers.scenes.join(", ");
        warn(&format!("{}: no lines of the scene {}; there are {there}", path.display(), scene.name));
    }
    Ok(peers)
}
