//! `asperity rank`: scenes in the order of their friction, and how sure that is.

mod summary;

use std::path::PathBuf;
use std::time::Duration;

use asperity_study::Error;
use asperity_study::progress::Stop;
use asperity_study::rank::{self, RankFound, RankOptions, RankPlan, RankScene, measured_ranking, table};
use clap::{ArgGroup, Args};

use super::cli::values::{self, Set, example};
use super::files::{self, check_outputs, load_without_run, picture_beside, print_beside, write};
use super::output::{NOT_REACHED, SUCCESS};
use super::picture;
use super::terminal::{self, warn};

#[derive(Debug, Args)]
#[command(
    override_usage = "asperity rank [OPTIONS] --speeds <VALUES>\n       <--pressures <VALUES>|--forces <VALUES>> <SCENE.toml> <SCENE.toml>..."
)]
#[command(group(ArgGroup::new("over").required(true).args(["speeds"])))]
#[command(group(ArgGroup::new("loads").required(true).args(["pressures", "forces"])))]
#[command(after_help = example!(
    "asperity rank scenes/road/road.toml scenes/two-maxima/two-maxima.toml --speeds 0.1..10/5 --pressures 2bar \\\n\
    \x20     --temperatures 10°C,30°C -o rank.csv"
))]
pub(crate) struct Rank {
    /// The scene files, two or more; the index of the first is 100.
    #[arg(value_name = "SCENE.toml", num_args = 2.., required = true)]
    pub(crate) scenes: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) options: RankOptions,
    /// The table to write, a row for each point and scene, - for standard output.
    #[arg(short, long, value_name = "TABLE.csv", default_value = "rank.csv")]
    pub(crate) output: PathBuf,
    /// The picture to write, as SVG or PNG according to the file name: indices with their bands, and which scene has the largest
    /// friction over speed and temperature. Default: the table's name with .svg.
    #[arg(long, value_name = "OUT.svg", value_parser = values::picture())]
    pub(crate) plot: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) set: Set,
}

/// Ranks scenes, writes the table and the picture.
pub(crate) fn rank(command: &Rank) -> Result<u8, Error> {
    let options = &command.options;
    let picture = picture_beside(&command.output, command.plot.as_ref());
    let scenes = scenes(command)?;
    let sources = scenes.iter().flat_map(|scene| scene.scene.sources(&scene.file));
    let taken = sources.chain(options.weights.iter().chain(&options.data).cloned()).collect();
    check_outputs([&command.output].into_iter().chain(&picture), taken)?;
    let plan = RankPlan::new(scenes, options, &Stop::default())?;
    plan.warnings().iter().for_each(|warning| warn(warning));
    let found = found(&plan)?;
    let measured = options
        .data
        .as_deref()
        .map(|data| measured_ranking(&plan, &found, data, &options.columns.columns))
        .transpose()?;
    measured.iter().for_each(|measured| files::tell(&measured.notes));
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
    let solves = command.options.sweep.sliding;
    let scene = |file: &PathBuf| -> Result<RankScene, Error> {
        // It says what is to be said of the scene.
        let scene = load_without_run(file, &command.set, |scene| !solves.solves(scene))?;
        Ok(RankScene { scene, file: file.clone() })
    };
    command.scenes.iter().map(scene).collect()
}

fn found(plan: &RankPlan) -> Result<RankFound, Error> {
    let bar = terminal::bar(plan.sweeps() as u64);
    bar.set_message(format!("of {} sweeps", plan.sweeps()));
    bar.enable_steady_tick(Duration::from_secs(1));
    let found = plan.find(&Stop::default(), &|| bar.inc(1));
    bar.finish_and_clear();
    found
}
