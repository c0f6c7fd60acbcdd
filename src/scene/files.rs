//! The files that a scene names: how they are read, and what of them an FMU carries.
//!
//! The engine reads canonical files alone ([`CanonicalFiles`]): columns in SI units, with all that the scene's options ask
//! for done already. Those of instruments and people are read by other [`FileFormats`], and carried in their canonical form.

use std::fmt;
use std::fs;
use std::io::{Error, Result as IoResult};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::error::SceneError;
use super::fine_roughness::{Convention, SPECTRUM};
use super::height_map::Seam;
use super::material::SERIES;
use super::profile::ProfileOptions;
use super::surface::{Surface, check_points};
use crate::tables::{ContentError, Dimension, FileKind, GivenColumns, ReadTable, ReadingNote, Role, canonical};

/// The formats of files that a scene is read with.
///
/// Each method makes of the bytes of a file what it holds, or tells what is wrong in it.
#[expect(clippy::missing_errors_doc, reason = "all have the same")]
pub trait FileFormats: fmt::Debug + Send + Sync {
    /// A surface.
    fn surface(&self, bytes: &[u8], options: &ProfileOptions) -> Result<LoadedProfile, ContentError>;

    /// A table of a kind.
    fn table(&self, bytes: &[u8], kind: &FileKind, columns: &GivenColumns) -> Result<ReadTable, ContentError>;

    /// The relaxation times and moduli of tension of a Prony series.
    fn series(
        &self,
        bytes: &[u8],
        elastic: ElasticConstants,
        columns: &GivenColumns,
    ) -> Result<ReadTable, ContentError>;

    /// The isotropic power spectrum of a surface.
    fn spectrum(&self, bytes: &[u8], convention: Convention, columns: &GivenColumns)
    -> Result<ReadTable, ContentError>;
}

/// What relates the moduli of a file to those of the scene.
#[derive(Clone, Copy, Debug)]
pub struct ElasticConstants {
    /// ν.
    pub poisson_ratio: f64,
    /// E_∞, Pa.
    pub equilibrium_modulus: f64,
}

/// A profile that was read by itself.
#[derive(Debug)]
pub struct LoadedProfile {
    /// Its points.
    pub surface: Surface,
    /// What may not be meant in it.
    pub warnings: Vec<String>,
    /// How it was read: columns and units, found or assumed.
    pub notes: Vec<ReadingNote>,
}

/// Canonical files alone: those in an FMU.
#[derive(Clone, Copy, Debug)]
pub struct CanonicalFiles;

/// The columns of a profile in its canonical form.
const PROFILE_ROLES: [Role; 2] = [Role::new("x", "", Dimension::Length), Role::new("z", "", Dimension::Length)];
const PROFILE: FileKind = FileKind { least: 2, ..FileKind::new("a profile", &PROFILE_ROLES, "x [m] and z [m]") };

impl FileFormats for CanonicalFiles {
    fn surface(&self, bytes: &[u8], options: &ProfileOptions) -> Result<LoadedProfile, ContentError> {
        let table = PROFILE.read_canonical(bytes)?;
        let (x, mut z) = (table.values("x").to_vec(), table.values("z").to_vec());
        check_points(&x, &mut z, options.periodic).map_err(|error| {
            let line = table.lines.get(error.index.unwrap_or(0)).copied();
            ContentError::value(line, "points", &x.len().to_string(), &error.expected)
        })?;
        let surface = Surface::new(x, z, options.periodic);
        let slopes = surface.check_slopes();
        slopes.map_err(|expected| ContentError::value(None, "points", "", &expected.to_string()))?;
        Ok(LoadedProfile { surface, warnings: Vec::new(), notes: Vec::new() })
    }

    fn table(&self, bytes: &[u8], kind: &FileKind, _: &GivenColumns) -> Result<ReadTable, ContentError> {
        kind.read_canonical(bytes)
    }

    fn series(&self, bytes: &[u8], _: ElasticConstants, _: &GivenColumns) -> Result<ReadTable, ContentError> {
        SERIES.read_canonical(bytes)
    }

    fn spectrum(&self, bytes: &[u8], _: Convention, _: &GivenColumns) -> Result<ReadTable, ContentError> {
        SPECTRUM.read_canonical(bytes)
    }
}

/// A file that a scene names, and what an FMU carries of it.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneFile {
    /// As the scene names it, relative to its folder.
    pub path: PathBuf,
    /// As an FMU carries it.
    pub carried_name: PathBuf,
    /// Its columns, in SI units; `None` of what no run depends on, which an FMU does not carry.
    content: Option<Arc<Columns>>,
}

type Columns = Vec<(&'static str, Dimension, Vec<f64>)>;

impl SceneFile {
    /// One that no run depends on, and no FMU carries.
    pub fn not_carried(path: PathBuf) -> Self {
        Self { carried_name: path.clone(), path, content: None }
    }

    pub(super) fn of_table(NamedTable { path, columns: given }: NamedTable, table: ReadTable) -> Self {
        let columns = table.columns.into_iter().map(|column| (column.key, column.dimension, column.values));
        let content = Some(Arc::new(columns.collect()));
        Self { carried_name: NamedTable::carried_name(&path, &given), path, content }
    }

    pub(super) fn of_surface(path: PathBuf, options: &ProfileOptions, surface: &Surface) -> Self {
        let columns = [("x", surface.x()), ("z", surface.z())];
        let columns = columns.into_iter().map(|(key, values)| (key, Dimension::Length, values.to_vec()));
        let content = Some(Arc::new(columns.collect()));
        Self { carried_name: options.carried_name(&path), path, content }
    }

    /// Its bytes in an FMU, which may carry nothing of it.
    pub fn carried(&self) -> Option<Vec<u8>> {
        let columns = self.content.as_ref()?.iter();
        let columns: Vec<_> = columns.map(|(key, dimension, values)| (*key, *dimension, &values[..])).collect();
        Some(canonical(&columns).into_bytes())
    }
}

/// A table in a file, as a scene names it.
#[derive(Debug)]
pub(super) struct NamedTable {
    /// Relative to the scene's folder.
    pub(super) path: PathBuf,
    /// Columns whose names do not say what they are.
    pub(super) columns: Vec<(String, String)>,
}

impl NamedTable {
    /// What an FMU carries of a table is named by.
    pub(super) fn carried_name(path: &Path, columns: &GivenColumns) -> PathBuf {
        carried_name(path, None, (!columns.is_empty()).then(|| format!("{columns:?}")))
    }
}

impl ProfileOptions {
    /// What an FMU carries of a profile is named by.
    pub(super) fn carried_name(&self, path: &Path) -> PathBuf {
        let as_read = Self { line: None, periodic: false, ..self.clone() };
        carried_name(path, self.line, (as_read != Self::default()).then(|| format!("{as_read:?}")))
    }
}

/// `road.x3p.line-3.csv` of the third line of `road.x3p`: what is carried is text, and one file may be read in several ways.
fn carried_name(path: &Path, line: Option<usize>, as_read: Option<String>) -> PathBuf {
    let is_text = path.extension().is_some_and(|ending| ["csv", "txt", "dat"].iter().any(|text| ending == *text));
    let mut name = path.as_os_str().to_owned();
    if let Some(line) = line {
        name.push(format!(".line-{line}"));
    }
    if let Some(options) = &as_read {
        // Fowler, Noll and Vo's hash.
        let hash = |hash: u32, byte: u8| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193);
        name.push(format!(".{:08x}", options.bytes().fold(0x811c_9dc5, hash)));
    }
    if !is_text || line.is_some() || as_read.is_some() {
        name.push(".csv");
    }
    name.into()
}

impl Surface {
    /// Reads the profile in the file at `path`, one of `formats`.
    ///
    /// # Errors
    /// [`SceneError`] with the file, the line, the column, what was given and what is allowed.
    pub fn load(path: &Path, options: &ProfileOptions, formats: &dyn FileFormats) -> Result<LoadedProfile, SceneError> {
        let bytes = read_file(path).map_err(|error| SceneError::unreadable(path, &error))?;
        let read = formats.surface(&bytes, options).and_then(|read| with_seams(read, options));
        read.map_err(|error| error.in_file(path.to_owned()))
    }
}

/// Refuses a periodic surface whose ends do not meet, and warns where they hardly do.
pub(super) fn with_seams(mut read: LoadedProfile, options: &ProfileOptions) -> Result<LoadedProfile, ContentError> {
    if !options.periodic {
        return Ok(read);
    }
    let surface = &read.surface;
    let seams = match surface.map() {
        Some(map) => Seam::of_map(map),
        None => Vec::from_iter(Seam::of_profile(surface.x(), surface.z())),
    };
    let warnings = Seam::check(&seams).map_err(|expected| ContentError::value(None, "periodic", "true", &expected))?;
    read.warnings.extend(warnings);
    Ok(read)
}

/// Says which line of an areal measurement was taken.
pub fn line_note(kind: &str, line: usize, lines: usize, is_chosen: bool) -> ReadingNote {
    let assumed = lines > 1 && !is_chosen;
    let which = if assumed { ", the middle one: line takes another" } else { "" };
    ReadingNote { text: format!("{kind}: line {line} of {lines} along x{which}"), assumed }
}

/// The content of the regular file at `path`; links are followed.
///
/// # Errors
/// Where it cannot be read, or is a folder, a pipe or a device.
pub fn read_file(path: &Path) -> IoResult<Vec<u8>> {
    check_regular(path)?;
    fs::read(path)
}

/// [`read_file`] as text.
///
/// # Errors
/// As for [`read_file`], and where it is not UTF-8.
pub fn read_text(path: &Path) -> IoResult<String> {
    check_regular(path)?;
    fs::read_to_string(path)
}

/// Before it is opened: to open a pipe is to wait for its writer.
fn check_regular(path: &Path) -> IoResult<()> {
    let kind = fs::metadata(path)?.file_type();
    if kind.is_file() {
        return Ok(());
    }
    let found = if kind.is_dir() { "a folder" } else { "a pipe or a device" };
    Err(Error::other(format!("expected a regular file, found {found}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_regular_file_is_refused() {
        let refused = |path: &str| read_file(Path::new(path)).unwrap_err().to_string();
        assert_eq!(refused(env!("CARGO_MANIFEST_DIR")), "expected a regular file, found a folder");
        #[cfg(unix)]
        assert_eq!(refused("/dev/zero"), "expected a regular file, found a pipe or a device");
        assert!(read_text(&Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml")).is_ok());
    }
}
