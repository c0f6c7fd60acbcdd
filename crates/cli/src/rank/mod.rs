//! `asperity rank`: scenes in the order of their friction, and how sure that is.

mod summary;

use std::time::Duration;

use asperity_study::Error;
use asperity_study::progress::Stop;
use asperity_study::rank::{self, RankFound, RankPlan, RankScene, Weights, measured_ranking, table};
use asperity_study::uncertainty::SampleOptions;

use super::cli::Rank;
use super::files::{self, check_outputs, load_without_run, picture_beside, print_beside, write};
use super::picture;
use super::terminal::{self, warn};
use super::{NOT_REACHED, SUCCESS};

/// Ranks scenes, writes the table and the picture.
pub(crate) fn rank(command: &Rank) -> Result<u8, Error> {
    let picture = picture_beside(&command.output, command.plot.as_ref());
    let scenes = scenes(command)?;
    let sources = scenes.iter().flat_map(|scene| scene.scene.sources(&scene.file));
    let taken = sources.chain(command.weights.iter().chain(&command.data).cloned()).collect();
    check_outputs([&command.output].into_iter().chain(&picture), taken)?;
    let plan = RankPlan::new(scenes, command.options.clone(), samples(command))?;
    plan.warnings().iter().for_each(|warning| warn(warning));
    let weights = command.weights.as_deref().map(Weights::read).transpose()?.unwrap_or_default();
    files::tell(&weights.notes);
    let found = found(&plan, &weights)?;
    let columns = &command.columns.columns;
    let measured = command.data.as_deref().map(|data| measured_ranking(&plan, &found, data, columns)).transpose()?;
    files::tell(measured.iter().flat_map(|measured| &measured.notes));
    found.ranking.warnings().iter().for_each(|warning| warn(warning));
    write(&command.output, table(&found.ranking))?;
    if let Some(path) = &picture {
        picture::write(&rank::picture(&found), path)?;
    }
    let files: Vec<_> = std::iter::once(&command.output).chain(&picture).collect();
    let summary = summary::text(&plan, &found.ranking, measured.as_ref(), &files);
    print_beside([&command.output], &summary)?;
    Ok(if found.ranking.is_sure() { SUCCESS } else { NOT_REACHED })
}

fn scenes(command: &Rank) -> Result<Vec<RankScene>, Error> {
    let solves = command.options.sliding;
    let scene = |file: &std::path::PathBuf| -> Result<RankScene, Error> {
        // It says what is to be said of the scene.
        let scene = load_without_run(file, &command.set, |scene| !solves.solves(scene))?;
        Ok(RankScene { scene, file: file.clone() })
    };
    command.scenes.iter().map(scene).collect()
}

fn samples(command: &Rank) -> SampleOptions {
    SampleOptions { count: command.samples as usize, seed: command.seed }
}

fn found(plan: &RankPlan, weights: &Weights) -> Result<RankFound, Error> {
    let bar = terminal::bar(plan.sweeps() as u64);
    bar.set_message(format!("of {} sweeps", plan.sweeps()));
    bar.enable_steady_tick(Duration::from_secs(1));
    let found = plan.find(weights, &Stop::default(), &|| bar.inc(1));
    bar.finish_and_clear();
    found
}
