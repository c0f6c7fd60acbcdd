//! Measured profiles and maps: files as they come from instruments and people, and what is done to them before they are a
//! surface.

mod grid;
mod header;
mod points;
mod text;

#[cfg(test)]
mod tests;

use asperity::scene::{
    Coordinate, Depth, LengthUnit, LoadedProfile, Missing, ProfileOptions, Surface, Tilt, check_points, remove_tilt,
};
use asperity::tables::{ContentError, Unit};

use crate::text::decode;

pub use grid::Areal;
pub use points::{MeasuredPoints, MeasuredSurface};
use text::Content;
pub use text::ROLES;

/// The surface of a text.
pub fn read_text(bytes: &[u8], options: &ProfileOptions) -> Result<LoadedProfile, ContentError> {
    match text::read(&decode(bytes)?, options)? {
        Content::Profile(points) => {
            check_line(options)?;
            check_tilt(options)?;
            finish(points, options)
        }
        Content::Map(areal) => of_measured(areal.surface(options)?, options),
    }
}

/// The surface of an areal measurement: the line that the options choose, and the map.
pub fn of_measured(
    MeasuredSurface { line: mut points, map }: MeasuredSurface,
    options: &ProfileOptions,
) -> Result<LoadedProfile, ContentError> {
    if map.is_none() {
        check_tilt(options)?;
    }
    in_metres(&mut points, options)?;
    // Its plane is that of the map.
    let tilt = if options.periodic { Tilt::Keep } else { options.tilt };
    let in_metres = ProfileOptions { x_unit: None, z_unit: None, depth: Some(Depth::Up), tilt, ..options.clone() };
    let read = finish(points, &in_metres)?;
    Ok(LoadedProfile { surface: read.surface.with_map(map), ..read })
}

/// A period has no tilt but that of a map, whose plane is no plane of its line.
fn check_tilt(options: &ProfileOptions) -> Result<(), ContentError> {
    let is_level = !(options.periodic && options.tilt == Tilt::Remove);
    let expected = "\"keep\" for a periodic profile, whose ends meet as they are";
    if is_level { Ok(()) } else { Err(ContentError::value(None, "tilt", "\"remove\"", expected)) }
}

/// A profile has one line.
fn check_line(options: &ProfileOptions) -> Result<(), ContentError> {
    let Some(line) = options.line else { return Ok(()) };
    let expected = "no such number for a profile: it chooses the line of an areal measurement";
    Err(ContentError::value(None, "line", &line.to_string(), expected))
}

/// Takes out what stands for no height, turns depths over, and converts to metres.
fn in_metres(raw: &mut MeasuredPoints, options: &ProfileOptions) -> Result<(), ContentError> {
    points::take_out(raw, options.missing)?;
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
fn finish(mut raw: MeasuredPoints, options: &ProfileOptions) -> Result<LoadedProfile, ContentError> {
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
    Ok(LoadedProfile { surface, warnings: Vec::new(), notes: raw.notes })
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
