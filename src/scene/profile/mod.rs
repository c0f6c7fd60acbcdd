//! Measured profiles: files as they come from instruments, and what is done to them before they are a surface.
//!
//! Text holds two columns x, z, see [`header`] and [`super::text_table`]; an X3P file holds them in its own way, see
//! [`x3p`].

mod header;
mod repair;
mod table;
mod words;
#[cfg(feature = "x3p")]
mod x3p;

#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};
use std::{fs, io};

pub use words::UnknownWord;

use super::error::Place;
use super::points::{self, Axis};
use super::text_table::decode;
use super::{Problem, SceneError, Surface};

/// How a file is to be read. What is not given is as the file says, or else as the defaults are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ProfileOptions {
    /// Unit of x; none: the one in the file, or else the metre.
    pub x_unit: Option<LengthUnit>,
    /// Unit of z; as for x.
    pub z_unit: Option<LengthUnit>,
    /// What becomes of points without a height.
    pub missing: Missing,
    /// What becomes of the profile's tilt.
    pub tilt: Tilt,
    /// What a third column says; none: its name in the header tells.
    pub third_column: Option<ThirdColumn>,
    /// The line of an areal measurement, from 1; none where there is but one.
    pub line: Option<usize>,
    /// Whether the profile is repeated for ever.
    pub periodic: bool,
}

/// A unit of length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LengthUnit {
    /// m
    Metre,
    /// mm
    Millimetre,
    /// µm
    Micrometre,
    /// nm
    Nanometre,
}

/// What becomes of points without a height.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Missing {
    /// The file is refused.
    #[default]
    Refuse,
    /// They lie on the straight line between their neighbours; at the ends, which have but one, they are left out.
    Fill,
}

/// What becomes of the profile's tilt.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tilt {
    /// It stays, and so does the mean height.
    #[default]
    Keep,
    /// The least squares line is subtracted: it becomes z = 0.
    Remove,
}

/// What a third column says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ThirdColumn {
    /// It marks the points whose height does not count.
    Invalid,
    /// It marks those whose height counts.
    Valid,
    /// Nothing, as what stands to the right of it.
    Ignore,
}

/// A line of an areal measurement, as an FMU carries it: text in place of the file that it was taken from.
#[derive(Clone, Debug, PartialEq)]
pub struct Extract {
    /// The file that it was taken from, as the scene names it.
    pub source: PathBuf,
    /// Its own name, beside that file.
    pub name: PathBuf,
    /// Two columns, x and z in m.
    pub text: String,
}

/// The least squares line of a profile as a curve: a point weighs as much as the steps beside it, however uneven they
/// are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// The middle of the profile, m.
    pub x: f64,
    /// The mean height, m.
    pub z: f64,
    /// The tilt, 1.
    pub slope: f64,
}

/// What comes of a file.
#[derive(Debug)]
pub(super) struct Profile {
    pub(super) surface: Surface,
    pub(super) warnings: Vec<String>,
    /// The file that was read, in the place of which an FMU carries the text, if there is one.
    pub(super) file: PathBuf,
    pub(super) extract: Option<String>,
}

/// Points as they stand in a file.
#[derive(Clone, Debug, Default, PartialEq)]
struct Raw {
    x: Vec<f64>,
    /// NaN where it is missing.
    z: Vec<f64>,
    /// The lines of the points in the file; none where it has no lines.
    lines: Vec<usize>,
    /// The units of x and z that the file names.
    units: [Option<LengthUnit>; 2],
    warnings: Vec<String>,
}

/// What is wrong in a profile, before it is known which file that is.
#[derive(Clone, Debug, PartialEq, Eq)]
struct ProfileError {
    line: Option<usize>,
    key: String,
    problem: Problem,
}

impl LengthUnit {
    /// How many of it are a metre.
    fn per_metre(self) -> f64 {
        match self {
            Self::Metre => 1.0,
            Self::Millimetre => 1e3,
            Self::Micrometre => 1e6,
            Self::Nanometre => 1e9,
        }
    }
}

impl Surface {
    /// Reads the profile in the file at `path`, and tells what is worth knowing about it though it can be used.
    ///
    /// # Errors
    /// [`SceneError`] with the file, the line, the column, what was given and what is allowed.
    pub fn load(path: &Path, options: &ProfileOptions) -> Result<(Self, Vec<String>), SceneError> {
        let file = |line| Place { file: path.to_owned(), line };
        let bytes = fs::read(path).map_err(|error| {
            let problem = Problem::Unreadable { given: String::new(), reason: error.to_string() };
            SceneError::new(file(None), "", problem)
        })?;
        let read = parse(&bytes, options, false);
        let (surface, warnings, _) =
            read.map_err(|error| SceneError::new(file(error.line), error.key, error.problem))?;
        Ok((surface, warnings))
    }
}

/// Why no profile was read.
#[derive(Debug)]
pub(super) enum Failure {
    /// There is no such file.
    Unreadable(io::Error),
    /// What is in it is no profile.
    Refused(SceneError),
}

/// Reads the profile at `path`, which is relative to `folder`. Where that file is not there, its line as text may be.
pub(super) fn read(folder: &Path, path: &Path, options: &ProfileOptions) -> Result<Profile, Failure> {
    let (file, bytes) = match fs::read(folder.join(path)) {
        Ok(bytes) => (path.to_owned(), bytes),
        Err(error) => {
            let extract = extract_name(path, options);
            let bytes = fs::read(folder.join(&extract)).map_err(|_| Failure::Unreadable(error))?;
            (extract, bytes)
        }
    };
    let is_extract = file != path;
    let (surface, warnings, extract) = parse(&bytes, options, is_extract).map_err(|error| {
        let place = Place { file: folder.join(&file), line: error.line };
        Failure::Refused(SceneError::new(place, error.key, error.problem))
    })?;
    let file = if extract.is_some() { extract_name(path, options) } else { file };
    Ok(Profile { surface, warnings, file, extract })
}

/// `road.x3p.line-3.csv` of the third line of `road.x3p`.
fn extract_name(path: &Path, options: &ProfileOptions) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(format!(".line-{}.csv", options.line.unwrap_or(1)));
    name.into()
}

type Parsed = (Surface, Vec<String>, Option<String>);

/// The surface, the warnings, and the line as text where the file is an areal measurement.
fn parse(bytes: &[u8], options: &ProfileOptions, is_extract: bool) -> Result<Parsed, ProfileError> {
    if bytes.starts_with(b"PK\x03\x04") {
        let raw = read_x3p(bytes, options)?;
        let text = table::write(&raw.x, &raw.z);
        let (surface, warnings) = finish(raw, options)?;
        return Ok((surface, warnings, Some(text)));
    }
    if let Some(line) = options.line.filter(|_| !is_extract) {
        let expected = "no such number for a profile: it chooses the line of an areal measurement (X3P)";
        return Err(refuse(None, "line", &line.to_string(), expected));
    }
    let text =
        decode(bytes).map_err(|error| ProfileError { line: Some(1), key: String::new(), problem: error.into() })?;
    let (surface, warnings) = finish(table::read(&text, options)?, options)?;
    Ok((surface, warnings, None))
}

#[cfg(feature = "x3p")]
fn read_x3p(bytes: &[u8], options: &ProfileOptions) -> Result<Raw, ProfileError> {
    x3p::read(bytes, options)
}

#[cfg(not(feature = "x3p"))]
fn read_x3p(_: &[u8], _: &ProfileOptions) -> Result<Raw, ProfileError> {
    let expected = "text: this library was built without the reader of X3P files (feature x3p)";
    Err(refuse(None, "", "a zip archive", expected))
}

/// Metres, without gaps and tilt, checked.
fn finish(mut raw: Raw, options: &ProfileOptions) -> Result<(Surface, Vec<String>), ProfileError> {
    let [x_unit, z_unit] = raw.units;
    to_metres(&mut raw.x, options.x_unit.or(x_unit));
    to_metres(&mut raw.z, options.z_unit.or(z_unit));
    let fill = options.missing == Missing::Fill && raw.z.iter().any(|z| z.is_nan());
    if fill || options.tilt == Tilt::Remove {
        check(&mut raw, false)?;
    }
    if fill {
        repair::fill(&mut raw);
    }
    if options.tilt == Tilt::Remove {
        repair::remove_tilt(&raw.x, &mut raw.z);
    }
    check(&mut raw, options.periodic)?;
    Ok((Surface { x: raw.x, z: raw.z, periodic: options.periodic }, raw.warnings))
}

fn to_metres(values: &mut [f64], unit: Option<LengthUnit>) {
    if let Some(unit) = unit.filter(|unit| *unit != LengthUnit::Metre) {
        // Divided, as 2.5 mm are then exactly the number 0.0025.
        values.iter_mut().for_each(|value| *value /= unit.per_metre());
    }
}

fn check(raw: &mut Raw, periodic: bool) -> Result<(), ProfileError> {
    points::check(&raw.x, &mut raw.z, periodic).map_err(|refusal| match refusal.index {
        Some(i) => {
            let (axis, value) = if refusal.axis == Axis::X { ("x", raw.x[i]) } else { ("z", raw.z[i]) };
            raw.refuse(i, axis, &format!("{value:?}"), &refusal.expected)
        }
        None => refuse(raw.lines.last().copied(), "points", &raw.x.len().to_string(), &refusal.expected),
    })
}

impl Raw {
    /// Refuses point `i`, by its line or else by its number from 1.
    fn refuse(&self, i: usize, axis: &str, given: &str, expected: &str) -> ProfileError {
        match self.lines.get(i) {
            Some(&line) => refuse(Some(line), axis, given, expected),
            None => refuse(None, &format!("{axis}[{}]", i + 1), given, expected),
        }
    }
}

fn refuse(line: Option<usize>, key: &str, given: &str, expected: &str) -> ProfileError {
    let problem = Problem::Value { given: given.to_owned(), expected: expected.to_owned() };
    ProfileError { line, key: key.to_owned(), problem }
}
