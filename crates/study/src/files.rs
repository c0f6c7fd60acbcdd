//! Scenes, patches, seals and other files, read.

use std::path::Path;

use asperity::model::EvenSliding;
use asperity::patch::Patch;
use asperity::scene::{FileFormats as _, Scene, SceneFile, Setting, read_file, read_text};
use asperity::seal::Seal;
use asperity::simulation::passed_phases;
use asperity::tables::{FileKind, GivenColumns, ReadTable};
use asperity_formats::Instruments;

use crate::error::Error;
use crate::uncertainty::{Uncertainty, covariance_file};

/// Reads a scene from `text`, its keys set to other values, as if it were the content of `file`.
///
/// # Errors
/// Where the text or what is set in it is refused.
pub fn parse_scene(text: &str, file: &Path, set: &[Setting]) -> Result<Scene, Error> {
    let mut scene = Scene::parse_with(text, file, &Instruments, set)?;
    let (_, warnings) = Uncertainty::of(&scene)?;
    scene.warnings.extend(warnings);
    scene.files.extend(covariance_file(&scene).map(SceneFile::not_carried));
    EvenSliding::settle(&mut scene);
    let passed = passed_phases(&scene);
    scene.warnings.extend(passed);
    Ok(scene)
}

/// Reads the scene at `path`, its keys set to other values.
///
/// # Errors
/// Where the file cannot be read, or its text or what is set in it is refused.
pub fn load_scene(path: &Path, set: &[Setting]) -> Result<Scene, Error> {
    parse_scene(&text(path)?, path, set)
}

/// Reads the patch at `path`, its keys set to other values.
///
/// # Errors
/// As for [`load_scene`].
pub fn load_patch(path: &Path, set: &[Setting]) -> Result<Patch, Error> {
    Ok(Patch::parse_with(&text(path)?, path, &Instruments, set)?)
}

/// Reads the seal at `path`, its keys set to other values.
///
/// # Errors
/// As for [`load_scene`].
pub fn load_seal(path: &Path, set: &[Setting]) -> Result<Seal, Error> {
    Ok(Seal::parse_with(&text(path)?, path, &Instruments, set)?)
}

/// The text of the file at `path`.
///
/// # Errors
/// Where it cannot be read.
pub fn text(path: &Path) -> Result<String, Error> {
    read_text(path).map_err(Error::io("read", path))
}

/// The bytes of the file at `path`.
///
/// # Errors
/// Where it cannot be read.
pub fn bytes(path: &Path) -> Result<Vec<u8>, Error> {
    read_file(path).map_err(Error::io("read", path))
}

// Which columns of a table hold what, where their names do not say it. Not a doc comment: that would be the description of
// the commands that have it.
#[expect(missing_docs, reason = "clap would print it")]
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize, clap::Args)]
#[serde(default)]
pub struct ColumnOptions {
    /// Which column of the data is which, by its name or number, as in speed=v2. May be repeated.
    #[arg(long = "column", value_name = "ROLE=COLUMN", value_parser = given_column, requires = "data")]
    pub columns: Vec<(String, String)>,
}

/// A role and the name or the number of its column.
///
/// # Errors
/// With what is expected, in words.
pub fn given_column(text: &str) -> Result<(String, String), String> {
    let parted = text.split_once('=').map(|(key, name)| (key.trim().to_owned(), name.trim().to_owned()));
    parted
        .filter(|(key, name)| !key.is_empty() && !name.is_empty())
        .ok_or_else(|| "expected ROLE=COLUMN, such as speed=v2".into())
}

/// The table of a kind in the file at `path`, text or a workbook.
///
/// # Errors
/// Where it cannot be read, or is no such table.
pub fn read_table(path: &Path, kind: &FileKind, columns: &GivenColumns) -> Result<ReadTable, Error> {
    Instruments.table(&bytes(path)?, kind, columns).map_err(Error::content(path))
}

/// The file's name without its folder.
pub fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}
