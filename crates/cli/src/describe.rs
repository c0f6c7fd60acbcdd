//! `asperity describe`: summarises a scene, a patch or a seal.

use std::path::{Path, PathBuf};

use asperity::scene::{Scene, Setting};
use asperity_study::summary::{
    self, DescribedScene, described, described_patch, described_seal, described_shortly, missing_backing,
};
use asperity_study::{Context as _, Error};
use clap::{ArgGroup, Args};

use super::cli::values::{self, Set, example};
use super::files::{check_outputs, load, load_patch, load_seal, print};
use super::picture;
use super::simulate::NOT_STARTED;
use super::terminal::{LabelledLine, is_verbose, lines, screen_lines, warn};

#[derive(Debug, Args)]
#[command(override_usage = "asperity describe [OPTIONS]\n       <SCENE.toml|--patch <PATCH.toml>|--seal <SEAL.toml>>")]
#[command(group(ArgGroup::new("described").required(true).args(["scene", "patch", "seal"])))]
#[command(after_help = example!("asperity describe scenes/road/road.toml"))]
pub(crate) struct Describe {
    /// The scene file.
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: Option<PathBuf>,
    /// A patch file: summarises a contact patch instead.
    #[arg(long, value_name = "PATCH.toml", conflicts_with_all = ["json", "plot"])]
    pub(crate) patch: Option<PathBuf>,
    /// A seal file: summarises a lip with a film instead.
    #[arg(long, value_name = "SEAL.toml", conflicts_with_all = ["json", "plot"])]
    pub(crate) seal: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) set: Set,
    /// Prints the whole scene as one JSON object in SI units: links as constants, the profile as data points. Absent
    /// entries are null or empty.
    #[arg(long)]
    pub(crate) json: bool,
    /// Plots the stiffness of the links over that of the material's surface, over wavelength, and the friction below the
    /// profile over speed at three temperatures, as SVG or PNG according to the file name.
    #[arg(long, value_name = "OUT.svg", value_parser = values::picture())]
    pub(crate) plot: Option<PathBuf>,
}

/// Prints the summary of a scene.
pub(crate) fn describe(command: &Describe, path: &Path) -> Result<(), Error> {
    let scene = load(path, &command.set)?;
    if let Some(output) = &command.plot {
        let drawn = summary::picture(&scene).ok_or_else(nothing_to_plot)?;
        check_outputs([output], scene.sources(path))?;
        picture::write(&drawn, output)?;
    }
    let text = if command.json { json(&scene)? } else { text(&scene)? };
    print(&text)
}

fn nothing_to_plot() -> Error {
    Error::scene("--plot: the scene has no [material], so its links stand for no body to compare them with")
}

/// Prints the summary of a patch.
pub(crate) fn describe_patch(path: &Path, set: &[Setting]) -> Result<(), Error> {
    let patch = load_patch(path, set)?;
    missing_backing(&patch).iter().for_each(|warning| warn(warning));
    print(&screen_lines(&described_patch(&patch)))
}

/// Prints the summary of a seal.
pub(crate) fn describe_seal(path: &Path, set: &[Setting]) -> Result<(), Error> {
    print(&screen_lines(&described_seal(&load_seal(path, set)?)))
}

fn json(scene: &Scene) -> Result<String, Error> {
    Ok(serde_json::to_string(&DescribedScene::new(scene))? + "\n")
}

fn text(scene: &Scene) -> Result<String, Error> {
    if is_verbose() {
        return Ok(lines(&described(scene).context(NOT_STARTED)?));
    }
    Ok(screen_lines(&[described_shortly(scene).context(NOT_STARTED)?, more()].concat()))
}

fn more() -> Vec<LabelledLine> {
    vec![("More", "-v: links, their elements and what reduce replaces, outputs, tables, the bands' law, memory".into())]
}
