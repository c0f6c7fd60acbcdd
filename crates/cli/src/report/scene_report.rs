//! The report of one scene: its runs, and what is written of them.

use std::path::{Path, PathBuf};

use asperity::scene::Scene;

use asperity_study::Error;
use asperity_study::report::{
    Judgement, Peers, ReportOptions, SceneReport, communication_picture, communication_table, errors_table, read_peers,
    robustness_table, tolerance_picture,
};

use super::folder::{COMMUNICATION, ERRORS, INDEX, JUDGEMENTS, ReportFolder, STRESS};
use super::{ReportError, page, stem, write_judgements};
use crate::cli::Report;
use crate::files::{load, write};
use crate::terminal::{Bars, warn};

/// A scene that can be run, its folder and its peers.
#[derive(Debug)]
pub(super) struct WrittenReport<'a> {
    command: &'a Report,
    path: &'a Path,
    scene: Scene,
    folder: ReportFolder,
    peers: Peers,
}

/// What is run.
fn options(command: &Report) -> ReportOptions {
    ReportOptions {
        tolerances: command.tolerances.0.clone(),
        points: command.rows,
        repeat: command.repeat,
        stress: command.stress,
        stress_time: command.stress_time,
    }
}

impl<'a> WrittenReport<'a> {
    /// Reads what is needed and checks it, before anything is run or written.
    pub(super) fn prepare(command: &'a Report, path: &'a Path, folder: &Path) -> Result<Self, ReportError> {
        let scene = load(path, &command.set)?;
        SceneReport::check(&scene, &options(command)).map_err(ReportError::of(path))?;
        let taken: Vec<PathBuf> = scene.sources(path).into_iter().chain(command.peers.clone()).collect();
        let folder = ReportFolder::new(folder, &[ERRORS, JUDGEMENTS, COMMUNICATION], &taken)?;
        let peers = peers_of(command, path, &scene)?;
        Ok(Self { command, path, scene, folder, peers })
    }

    /// The files that are read.
    pub(super) fn sources(&self) -> impl Iterator<Item = PathBuf> + use<> {
        self.scene.sources(self.path).into_iter().chain(self.command.peers.clone())
    }

    /// Runs the scene and writes its report. Returns how its runs keep what they promise.
    pub(super) fn run(&self) -> Result<Vec<Judgement>, ReportError> {
        let command = self.command;
        let results = SceneReport::run(&self.scene, &options(command), &Bars::new().watch());
        let results = results.map_err(ReportError::of(self.path))?;
        results.reference.warnings.iter().for_each(|warning| warn(warning));
        self.folder.create()?;
        self.write(&results)?;
        Ok(results.judgements)
    }

    fn write(&self, results: &SceneReport) -> Result<(), Error> {
        let Self { command, scene, folder, peers, .. } = self;
        let SceneReport { reference, tolerances, communication, robustness, judgements } = results;
        // This program's runs, then whole processes, its own and the peers'.
        let rows = [tolerances.as_slice(), &peers.rows].concat();
        let name = scene.name.as_str();
        write(&folder.file(ERRORS, "csv"), errors_table(name, reference, &rows))?;
        write(&folder.file(COMMUNICATION, "csv"), communication_table(name, reference, communication))?;
        let picture = folder.draw(ERRORS, &tolerance_picture(reference, &rows))?;
        let mut sections = vec![page::tolerances(command, reference, &rows, &picture).map_err(folder.error())?];
        sections.push(write_judgements(folder, &[(name, judgements)])?);
        let picture = folder.draw(COMMUNICATION, &communication_picture(reference, communication))?;
        sections.push(page::communication(scene, reference, communication, &picture).map_err(folder.error())?);
        if let Some(robustness) = robustness {
            write(&folder.file(STRESS, "csv"), robustness_table(name, robustness))?;
            sections.push(page::robustness(scene, robustness).map_err(folder.error())?);
        }
        folder.write(INDEX, page::page(scene, &sections).map_err(folder.error())?)
    }
}

/// The peers' rows of this scene; warns where the file has none.
fn peers_of(command: &Report, scene_path: &Path, scene: &Scene) -> Result<Peers, ReportError> {
    let Some(path) = &command.peers else { return Ok(Peers::default()) };
    let peers = read_peers(path, &[&scene.name, &stem(scene_path)])?;
    if peers.rows.is_empty() {
        let there = peers.scenes.join(", ");
        warn(&format!("{}: no lines of the scene {}; there are {there}", path.display(), scene.name));
    }
    Ok(peers)
}
