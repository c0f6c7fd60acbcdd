//! Measured profiles: files as they come from instruments, and what is done to them before they are a surface.
//!
//! Text holds two columns x, z, see [`text`]; an X3P file holds an image of heights, see [`x3p`].

mod options;
mod plain;
mod text;
#[cfg(feature = "x3p")]
mod x3p;

#[cfg(test)]
mod tests;

use std::io;
use std::path::{Path, PathBuf};

pub use options::{LengthUnit, Missing, ProfileOptions, ThirdColumn, Tilt, UnknownWord};

use super::error::{ContentError, SceneError};
use super::regular_file::read_file;
use super::surface::{Coordinate, Surface, check_points, remove_tilt};
use super::text_table::decode;
use options::MeasuredPoints;

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

/// A profile that was read from a file.
#[derive(Debug)]
pub(super) struct Profile {
    pub(super) surface: Surface,
    pub(super) warnings: Vec<String>,
    /// The file that was read, or that of the extract in its place.
    pub(super) file: PathBuf,
    /// The text that an FMU carries in place of the file, if it was an areal measurement.
    pub(super) extract: Option<String>,
}

#[derive(Debug)]
pub(super) enum ReadFailure {
    Unreadable(io::Error),
    Refused(SceneError),
}

impl Surface {
    /// Reads the profile in the file at `path`, and returns warnings on what may not be meant in it.
    ///
    /// # Errors
    /// [`SceneError`] with the file, the line, the column, what was given and what is allowed.
    pub fn load(path: &Path, options: &ProfileOptions) -> Result<(Self, Vec<String>), SceneError> {
        let bytes = read_file(path).map_err(|error| SceneError::unreadable(path, &error))?;
        let parsed = parse(&bytes, options, false).map_err(|error| error.in_file(path.to_owned()))?;
        Ok((parsed.surface, parsed.warnings))
    }
}

/// Reads the profile at `path`, which is relative to `folder`. Where that file is not there, its extract may be.
pub(super) fn read(folder: &Path, path: &Path, options: &ProfileOptions) -> Result<Profile, ReadFailure> {
    let (file, bytes) = match read_file(&folder.join(path)) {
        Ok(bytes) => (path.to_owned(), bytes),
        Err(error) => {
            let extract = extract_name(path, options);
            let bytes = read_file(&folder.join(&extract)).map_err(|_| ReadFailure::Unreadable(error))?;
            (extract, bytes)
        }
    };
    let is_extract = file != path;
    let parsed = parse(&bytes, options, is_extract);
    let Parsed { surface, warnings, extract } =
        parsed.map_err(|error| ReadFailure::Refused(error.in_file(folder.join(&file))))?;
    let file = if extract.is_some() { extract_name(path, options) } else { file };
    Ok(Profile { surface, warnings, file, extract })
}

/// `road.x3p.line-3.csv` of the third line of `road.x3p`.
fn extract_name(path: &Path, options: &ProfileOptions) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(format!(".line-{}.csv", options.line.unwrap_or(1)));
    name.into()
}

#[derive(Debug)]
struct Parsed {
    surface: Surface,
    warnings: Vec<String>,
    /// The line as text where the file is an areal measurement.
    extract: Option<String>,
}

fn parse(bytes: &[u8], options: &ProfileOptions, is_extract: bool) -> Result<Parsed, ContentError> {
    if bytes.starts_with(b"PK\x03\x04") {
        let raw = read_x3p(bytes, options)?;
        let text = text::write(&raw.x, &raw.z);
        return Ok(Parsed { extract: Some(text), ..finish(raw, options)? });
    }
    if let Some(line) = options.line.filter(|_| !is_extract) {
        let expected = "no such number for a profile: it chooses the line of an areal measurement (X3P)";
        return Err(ContentError::value(None, "line", &line.to_string(), expected));
    }
    let text = decode(bytes).map_err(|error| ContentError::new(Some(1), "", error))?;
    finish(text::read(&text, options)?, options)
}

#[cfg(feature = "x3p")]
fn read_x3p(bytes: &[u8], options: &ProfileOptions) -> Result<MeasuredPoints, ContentError> {
    x3p::read(bytes, options)
}

#[cfg(not(feature = "x3p"))]
fn read_x3p(_: &[u8], _: &ProfileOptions) -> Result<MeasuredPoints, ContentError> {
    let expected = "text: this library was built without the reader of X3P files (feature x3p)";
    Err(ContentError::value(None, "", "a zip archive", expected))
}

/// Converts to metres, fills gaps, removes the tilt and checks the points.
fn finish(mut raw: MeasuredPoints, options: &ProfileOptions) -> Result<Parsed, ContentError> {
    let [x_unit, z_unit] = raw.units;
    to_metres(&mut raw.x, options.x_unit.or(x_unit));
    to_metres(&mut raw.z, options.z_unit.or(z_unit));
    let fill = options.missing == Missing::Fill && raw.z.iter().any(|z| z.is_nan());
    if fill || options.tilt == Tilt::Remove {
        check(&mut raw, false)?;
    }
    if fill {
        fill_gaps(&mut raw);
    }
    if options.tilt == Tilt::Remove {
        remove_tilt(&raw.x, &mut raw.z);
    }
    check(&mut raw, options.periodic)?;
    let surface = Surface::new(raw.x, raw.z, options.periodic);
    Ok(Parsed { surface, warnings: raw.warnings, extract: None })
}

fn to_metres(values: &mut [f64], unit: Option<LengthUnit>) {
    if let Some(unit) = unit.filter(|unit| *unit != LengthUnit::Metre) {
        // Divided, as 2.5 mm are then exactly the number 0.0025.
        values.iter_mut().for_each(|value| *value /= unit.per_metre());
    }
}

fn check(raw: &mut MeasuredPoints, periodic: bool) -> Result<(), ContentError> {
    check_points(&raw.x, &mut raw.z, periodic).map_err(|error| match error.index {
        Some(i) => {
            let (axis, value) = if error.coordinate == Coordinate::X { ("x", raw.x[i]) } else { ("z", raw.z[i]) };
            raw.refuse(i, axis, &format!("{value:?}"), &error.expected)
        }
        None => ContentError::value(raw.lines.last().copied(), "points", &raw.x.len().to_string(), &error.expected),
    })
}

/// Puts points without a height on the straight line between their neighbours, and leaves those at the ends out.
fn fill_gaps(raw: &mut MeasuredPoints) {
    let is_there = |z: &f64| !z.is_nan();
    let first = raw.z.iter().position(is_there).unwrap_or(raw.z.len());
    let end = raw.z.iter().rposition(is_there).map_or(first, |last| last + 1);
    raw.x = raw.x[first..end].to_vec();
    raw.z = raw.z[first..end].to_vec();
    if !raw.lines.is_empty() {
        raw.lines = raw.lines[first..end].to_vec();
    }
    let mut before = 0;
    for i in 0..raw.z.len() {
        if raw.z[i].is_nan() {
            continue;
        }
        interpolate(&raw.x, &mut raw.z, before, i);
        before = i;
    }
}

/// The straight line from point `from` to point `to`, for the points between them.
fn interpolate(x: &[f64], z: &mut [f64], from: usize, to: usize) {
    for i in from + 1..to {
        let share = (x[i] - x[from]) / (x[to] - x[from]);
        z[i] = z[from] + share * (z[to] - z[from]);
    }
}
