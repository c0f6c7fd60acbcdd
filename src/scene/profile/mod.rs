//! Measured profiles: files as they come from instruments, and what is done to them before they are a surface.
//!
//! Text holds columns x and z, see [`text`]; what is no text is read by the [`FileFormats`] that a scene is read with.
//! An FMU carries text in place of all that is no text of x and z.

mod areal;
mod header;
mod options;
mod roles;
mod sentinels;
mod text;

#[cfg(test)]
mod tests;

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

pub use areal::{Areal, line_note};
pub use options::{Depth, LengthUnit, MeasuredPoints, Missing, ProfileOptions, ThirdColumn, Tilt, UnknownWord};

use super::error::SceneError;
use super::height_map::Seam;
use super::regular_file::read_file;
use super::surface::{Coordinate, Surface, check_points, remove_tilt};
use super::{HeightMap, MapError};
use crate::tables::{ContentError, ReadingNote, Sheets, Unit, decode};
use text::Content;

/// A line of an areal measurement, as an FMU carries it: text in place of the file that it was taken from.
#[derive(Clone, Debug, PartialEq)]
pub struct Extract {
    /// The file that it was taken from, as the scene names it.
    pub source: PathBuf,
    /// Its own name, beside that file.
    pub name: PathBuf,
    /// Two columns, x and z in m; or a sheet of a workbook.
    pub text: String,
}

/// A profile that was read from a file.
#[derive(Debug)]
pub(super) struct Profile {
    pub(super) surface: Surface,
    pub(super) warnings: Vec<String>,
    pub(super) notes: Vec<ReadingNote>,
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
    /// Reads the profile in the file at `path`, one of text or of `formats`.
    ///
    /// # Errors
    /// [`SceneError`] with the file, the line, the column, what was given and what is allowed.
    pub fn load(path: &Path, options: &ProfileOptions, formats: &dyn FileFormats) -> Result<LoadedProfile, SceneError> {
        let bytes = read_file(path).map_err(|error| SceneError::unreadable(path, &error))?;
        let parsed = parse(&bytes, options, formats, false).map_err(|error| error.in_file(path.to_owned()))?;
        Ok(LoadedProfile { surface: parsed.surface, warnings: parsed.warnings, notes: parsed.notes })
    }
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

/// Reads the profile at `path`, which is relative to `folder`. Where that file is not there, its extract may be.
pub(super) fn read(
    folder: &Path,
    path: &Path,
    options: &ProfileOptions,
    formats: &dyn FileFormats,
) -> Result<Profile, ReadFailure> {
    let (file, bytes) = match read_file(&folder.join(path)) {
        Ok(bytes) => (path.to_owned(), bytes),
        Err(error) => {
            let extract = extract_name(path, options);
            let bytes = read_file(&folder.join(&extract)).map_err(|_| ReadFailure::Unreadable(error))?;
            (extract, bytes)
        }
    };
    let is_extract = file != path;
    let parsed = parse(&bytes, options, formats, is_extract);
    let Parsed { surface, warnings, notes, extract } =
        parsed.map_err(|error| ReadFailure::Refused(error.in_file(folder.join(&file))))?;
    let file = if extract.is_some() { extract_name(path, options) } else { file };
    Ok(Profile { surface, warnings, notes, file, extract })
}

/// `road.x3p.line-3.csv` of the third line of `road.x3p`; `road.x3p.line.csv` of the one that is taken if none is
/// chosen.
fn extract_name(path: &Path, options: &ProfileOptions) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(options.line.map_or_else(|| ".line.csv".into(), |line| format!(".line-{line}.csv")));
    name.into()
}

#[derive(Debug)]
struct Parsed {
    surface: Surface,
    warnings: Vec<String>,
    notes: Vec<ReadingNote>,
    /// The line as text where the file is no text of x and z.
    extract: Option<String>,
}

fn parse(
    bytes: &[u8],
    options: &ProfileOptions,
    formats: &dyn FileFormats,
    is_extract: bool,
) -> Result<Parsed, ContentError> {
    if is_extract {
        let of_text = of_extract(options);
        let Content::Profile(raw) = read_text(bytes, &of_text)? else { return Err(no_profile()) };
        return finish(raw, &of_text);
    }
    let MeasuredSurface { line: mut raw, map } = match formats.read(bytes, options) {
        Some(read) => read?,
        None => match read_text(bytes, options)? {
            Content::Profile(raw) => {
                check_line(options)?;
                check_tilt(options)?;
                let parsed = finish(raw, options)?;
                return with_seams(parsed, options);
            }
            map => map.line(options)?,
        },
    };
    if map.is_none() {
        check_tilt(options)?;
    }
    in_metres(&mut raw, options)?;
    let text = text::write(&raw.x, &raw.z);
    let parsed = finish(raw, &of_extract(options))?;
    with_seams(Parsed { extract: Some(text), surface: parsed.surface.with_map(map), ..parsed }, options)
}

/// How the line of an areal measurement is read: it has x and z in m, whatever the file had that it stands for, and that
/// of a periodic map is without the tilt of the map already.
fn of_extract(options: &ProfileOptions) -> ProfileOptions {
    ProfileOptions {
        x_unit: None,
        z_unit: None,
        columns: Vec::new(),
        spacing: Vec::new(),
        third_column: None,
        depth: Some(Depth::Up),
        tilt: if options.periodic { Tilt::Keep } else { options.tilt },
        ..options.clone()
    }
}

/// A period has no tilt but that of a map, whose plane is no plane of its line.
fn check_tilt(options: &ProfileOptions) -> Result<(), ContentError> {
    let is_level = !(options.periodic && options.tilt == Tilt::Remove);
    let expected = "\"keep\" for a periodic profile, whose ends meet as they are";
    if is_level { Ok(()) } else { Err(ContentError::value(None, "tilt", "\"remove\"", expected)) }
}

/// Refuses a periodic surface whose ends do not meet, and warns where they hardly do.
fn with_seams(mut parsed: Parsed, options: &ProfileOptions) -> Result<Parsed, ContentError> {
    if !options.periodic {
        return Ok(parsed);
    }
    let surface = &parsed.surface;
    let seams = match surface.map() {
        Some(map) => Seam::of_map(map),
        None => Vec::from_iter(Seam::of_profile(surface.x(), surface.z())),
    };
    let warnings = Seam::check(&seams).map_err(|expected| ContentError::value(None, "periodic", "true", &expected))?;
    parsed.warnings.extend(warnings);
    Ok(parsed)
}

fn read_text(bytes: &[u8], options: &ProfileOptions) -> Result<Content, ContentError> {
    text::read(&decode(bytes)?, options)
}

fn no_profile() -> ContentError {
    ContentError::value(None, "columns", "x, y and z", "x and z")
}

/// A profile has one line.
fn check_line(options: &ProfileOptions) -> Result<(), ContentError> {
    let Some(line) = options.line else { return Ok(()) };
    let expected = "no such number for a profile: it chooses the line of an areal measurement";
    Err(ContentError::value(None, "line", &line.to_string(), expected))
}

/// A surface as it was measured: the line that the options choose, and the map that it is taken of, or why there is
/// none.
#[derive(Debug)]
pub struct MeasuredSurface {
    /// The line along x.
    pub line: MeasuredPoints,
    /// The map, or what is expected of one; `None` of a single line.
    pub map: Option<Result<HeightMap, MapError>>,
}

/// The formats of files that a scene is read with, beside text of columns.
pub trait FileFormats: fmt::Debug + Send + Sync {
    /// The measurement that a file of these `bytes` holds; `None` of a file of another format.
    fn read(&self, bytes: &[u8], options: &ProfileOptions) -> Option<Result<MeasuredSurface, ContentError>>;

    /// The sheets of a workbook of these `bytes`, as text; `None` of another file.
    fn sheets(&self, bytes: &[u8]) -> Option<Result<Sheets, ContentError>>;
}

/// No format but text: that of the files in an FMU.
#[derive(Clone, Copy, Debug)]
pub struct TextAlone;

impl FileFormats for TextAlone {
    fn read(&self, bytes: &[u8], _: &ProfileOptions) -> Option<Result<MeasuredSurface, ContentError>> {
        is_archive(bytes).then(|| Err(no_archive()))
    }

    fn sheets(&self, bytes: &[u8]) -> Option<Result<Sheets, ContentError>> {
        is_archive(bytes).then(|| Err(no_archive()))
    }
}

fn is_archive(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PK\x03\x04")
}

fn no_archive() -> ContentError {
    ContentError::value(None, "", "a zip archive", "text of columns")
}

/// Takes out what stands for no height, turns depths over, and converts to metres.
fn in_metres(raw: &mut MeasuredPoints, options: &ProfileOptions) -> Result<(), ContentError> {
    sentinels::take_out(raw, options.missing)?;
    if options.turns_over(std::mem::take(&mut raw.is_depth)) {
        raw.z.iter_mut().for_each(|z| *z = -*z);
    }
    let [x_unit, z_unit] = std::mem::take(&mut raw.units);
    if !raw.is_spaced {
        to_metres(&mut raw.x, options.x_unit.map(LengthUnit::unit).or(x_unit));
    }
    to_metres(&mut raw.z, options.z_unit.map(LengthUnit::unit).or(z_unit));
    Ok(())
}

/// Converts to metres, fills gaps, removes the tilt and checks the points.
fn finish(mut raw: MeasuredPoints, options: &ProfileOptions) -> Result<Parsed, ContentError> {
    in_metres(&mut raw, options)?;
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
    surface.check_slopes().map_err(|expected| {
        ContentError::value(raw.lines.first().copied(), "points", &closest(&surface), &expected.to_string())
    })?;
    Ok(Parsed { surface, warnings: raw.warnings, notes: raw.notes, extract: None })
}

/// The shortest step along x, for a message.
fn closest(surface: &Surface) -> String {
    let steps = surface.x().windows(2).map(|pair| pair[1] - pair[0]);
    format!("steps along x down to {:e} m", steps.fold(f64::INFINITY, f64::min))
}

fn to_metres(values: &mut [f64], unit: Option<Unit>) {
    if let Some(unit) = unit.filter(|unit| !unit.is_si()) {
        values.iter_mut().for_each(|value| *value = unit.to_si(*value));
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
