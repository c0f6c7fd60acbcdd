//! `asperity report`: what the runs of scenes cost and how accurate they are, as tables, pictures and pages.

mod folder;
mod page;
mod scene_report;

use std::path::{Path, PathBuf};

use asperity_study::Error;
use asperity_study::report::{self, Judgement, judgement_picture, judgements_table};

use super::cli::Report;
use super::files::write;
use folder::{INDEX, JUDGEMENTS, ReportFolder};
use page::SceneJudgements;
use scene_report::WrittenReport;

/// `asperity report` failed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ReportError {
    #[error(transparent)]
    File(#[from] Error),
    #[error("{}: {source}", .scene.display())]
    Scene { scene: PathBuf, source: report::ReportError },
    #[error("two scenes have the same folder: {}", .0.display())]
    SameFolder(PathBuf),
}

impl ReportError {
    /// For `map_err`: of the scene at `path`.
    fn of(path: &Path) -> impl FnOnce(report::ReportError) -> Self + use<> {
        let scene = path.to_owned();
        move |source| Self::Scene { scene, source }
    }
}

/// Runs the scenes in every way and writes the results: of one scene into the folder, of several into folders within
/// it, with a page of all.
pub(crate) fn report(command: &Report) -> Result<(), ReportError> {
    let [path] = command.scenes.as_slice() else { return report_all(command) };
    WrittenReport::prepare(command, path, &command.output)?.run().map(drop)
}

fn report_all(command: &Report) -> Result<(), ReportError> {
    let paths: Vec<PathBuf> = command.scenes.iter().map(|scene| command.output.join(stem(scene))).collect();
    for (i, path) in paths.iter().enumerate() {
        if paths[..i].contains(path) {
            return Err(ReportError::SameFolder(path.clone()));
        }
    }
    let scenes = command.scenes.iter().zip(&paths);
    let reports =
        scenes.map(|(scene, path)| WrittenReport::prepare(command, scene, path)).collect::<Result<Vec<_>, _>>()?;
    let folder = ReportFolder::new(
        &command.output,
        &[JUDGEMENTS],
        &reports.iter().flat_map(WrittenReport::sources).collect::<Vec<_>>(),
    )?;
    let judgements = reports.iter().map(WrittenReport::run).collect::<Result<Vec<_>, _>>()?;
    let names: Vec<String> = command.scenes.iter().map(|scene| stem(scene)).collect();
    Ok(write_overview(&folder, &names, &judgements)?)
}

/// Writes the page of several scenes.
fn write_overview(folder: &ReportFolder, names: &[String], judgements: &[Vec<Judgement>]) -> Result<(), Error> {
    let scenes = names.iter().zip(judgements).map(|(name, judgements)| (name.as_str(), judgements.as_slice()));
    let section = write_judgements(folder, &scenes.collect::<Vec<_>>())?;
    folder.write(INDEX, page::overview(names, section))
}

/// Writes the table and the picture of errors over the tolerance, and returns the section.
fn write_judgements(folder: &ReportFolder, scenes: &[SceneJudgements<'_>]) -> Result<String, Error> {
    write(&folder.file(JUDGEMENTS, "csv"), judgements_table(scenes.iter().copied()))?;
    let picture = folder.draw(JUDGEMENTS, &judgement_picture(scenes.iter().flat_map(|(_, runs)| runs.iter())))?;
    page::judgements(scenes, &picture).map_err(folder.error())
}

/// The name of a file without folder and ending.
fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}
