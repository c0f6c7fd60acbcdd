//! What lines of settings above a profile or a map say: units, and how many points there are at which distances.
//!
//! A line counts only as `key: value` (or `key = value`, `key;value`) of a key that is known; what is used is quoted, and
//! must agree with what is there.

use asperity::scene::ProfileOptions;
use asperity::tables::{ContentError, Dimension, ReadingNote, Unit, shortened};

use super::points::MeasuredPoints;
use crate::text::{Block, Line, number};

/// Keys of the number of points of a line, of the number of lines, and of the distance of points; in lower case, blanks,
/// `_` and `-` left out.
const POINTS: &str = "width, columns, nx, samps/line, samples/line, samplesperline, pointsperline, points/line, xpoints, \
                      numpoints, numberofpoints, xpixels, xsize, horizontal";
const LINES: &str = "height, rows, ny, numberoflines, lines, ypoints, numprofiles, ypixels, ysize, vertical";
const STEP: &str =
    "spacing, step, dx, xstep, xspacing, increment, xincrement, samplinginterval, interval, sampleinterval";

/// The settings above a block.
#[derive(Debug, Default)]
pub(super) struct Settings<'a> {
    /// The units of x and z that lines such as `X-Unit: mm` set.
    pub(super) units: [Option<Unit>; 2],
    /// The lines that set something.
    pub(super) lines: Vec<Line<'a>>,
    /// Those that set units.
    of_units: Vec<Line<'a>>,
    points: Option<(usize, Line<'a>)>,
    size_y: Option<(usize, Line<'a>)>,
    /// With its unit, where one is named.
    step: Option<(f64, bool, Line<'a>)>,
}

/// The grid that a header states.
#[derive(Debug)]
pub(super) struct Size<'a> {
    /// Of a line.
    pub(super) points: usize,
    /// Their number.
    pub(super) lines: usize,
    /// Where it stands.
    pub(super) line: usize,
    /// What stands there.
    pub(super) text: &'a str,
}

impl<'a> Settings<'a> {
    /// Those in some lines.
    pub(super) fn of(above: &[Line<'a>]) -> Self {
        let mut found = Self::default();
        for &(line, text) in above {
            if let Some((axes, unit)) = unit_setting(text) {
                axes.iter().for_each(|&axis| found.units[axis] = Some(unit));
                found.of_units.push((line, text));
                found.lines.push((line, text));
                continue;
            }
            let Some((key, value)) = key_and_value(text) else { continue };
            let is_of = |keys: &str| keys.split(", ").any(|known| known == key);
            let whole = || value.parse().ok().map(|count| (count, (line, text)));
            if is_of(POINTS) && whole().is_some() {
                found.points = whole();
            } else if is_of(LINES) && whole().is_some() {
                found.size_y = whole();
            } else if is_of(STEP) {
                found.step = length(value).map(|(step, has_unit)| (step, has_unit, (line, text)));
            } else {
                continue;
            }
            found.lines.push((line, text));
        }
        found
    }

    /// The lines above a block that set nothing.
    pub(super) fn others(&self, block: &Block<'a>) -> Vec<Line<'a>> {
        block.above.iter().filter(|line| !self.lines.contains(line)).copied().collect()
    }

    /// The grid, where both numbers are stated.
    pub(super) fn size(&self) -> Option<Size<'a>> {
        let ((points, _), (lines, (line, text))) = (self.points?, self.size_y?);
        Some(Size { points, lines, line, text })
    }

    /// The lines that are used, quoted.
    pub(super) fn notes(&self) -> impl Iterator<Item = ReadingNote> {
        let note = |(line, text): &Line<'_>| format!("line {line} says \"{}\"", shortened(text));
        self.of_units.iter().map(note).map(|text| ReadingNote { text, assumed: false })
    }

    /// Refuses a map of another size than is stated.
    ///
    /// # Errors
    /// [`ContentError`] with the line that states it.
    pub(super) fn check_size(&self, [nx, ny]: [usize; 2]) -> Result<(), ContentError> {
        for (stated, found, what) in [(self.points, nx, "points a line"), (self.size_y, ny, "lines")] {
            if let Some((count, line)) = stated.filter(|(count, _)| *count != found) {
                return Err(disagrees(line, &format!("{found} {what}, as there are"), &count.to_string()));
            }
        }
        Ok(())
    }

    /// Refuses a profile with another number of points, or at other distances, than is stated.
    ///
    /// # Errors
    /// [`ContentError`] with the line that states it.
    pub(super) fn check_points(
        &self,
        count: usize,
        raw: &MeasuredPoints,
        options: &ProfileOptions,
    ) -> Result<(), ContentError> {
        if let Some((stated, line)) = self.points.filter(|(stated, _)| *stated != count) {
            let expected = format!("{count}, the number of rows; of a scan one line alone");
            return Err(disagrees(line, &expected, &stated.to_string()));
        }
        let Some((stated, has_unit, line)) = self.step else { return Ok(()) };
        let unit = options.x_unit.map(asperity::scene::LengthUnit::unit).or(raw.units[0]).unwrap_or(Unit::ONE);
        let (Some(first), Some(last)) = (raw.x.first(), raw.x.last()) else { return Ok(()) };
        let written = (last - first).abs() / (raw.x.len().max(2) - 1) as f64;
        let found = if raw.is_spaced { written } else { unit.to_si(written) };
        let stated = if has_unit { stated } else { unit.to_si(stated) };
        /// Of positions that are rounded.
        const ROUNDING: f64 = 0.01;
        // Of a spacing without a unit nothing is known but where x has the same.
        let is_known = has_unit || !raw.is_spaced;
        if is_known && (found / stated - 1.0).abs() > ROUNDING {
            return Err(disagrees(line, &format!("{found:e} m, the distance of the points"), &format!("{stated:e} m")));
        }
        Ok(())
    }
}

fn disagrees((line, text): Line<'_>, expected: &str, given: &str) -> ContentError {
    ContentError::value(Some(line), &format!("\"{}\"", shortened(text)), given, expected)
}

/// Of `Samps/line: 50`, `Width,32`: the key as it is compared, and the value.
fn key_and_value(text: &str) -> Option<(String, &str)> {
    let (key, value) = text.split_once([':', '=', ';', ',', '\t']).or_else(|| text.rsplit_once(' '))?;
    let key = key.trim().trim_matches('"').to_lowercase();
    let key: String = key.chars().filter(|letter| !(letter.is_whitespace() || "_-".contains(*letter))).collect();
    Some((key, value.trim().trim_matches(['"', ';', ',', '\t'])))
}

/// A length in m, where it has a unit.
fn length(value: &str) -> Option<(f64, bool)> {
    let end = value.find(|letter: char| letter.is_whitespace() || letter.is_alphabetic() && !"eE".contains(letter));
    let (digits, unit) = value.split_at(end.unwrap_or(value.len()));
    let number = number(digits.trim()).filter(|number| *number > 0.0)?;
    match unit.trim() {
        "" => Some((number, false)),
        unit => Unit::parse(unit).filter(|unit| unit.is_of(Dimension::Length)).map(|unit| (unit.to_si(number), true)),
    }
}

/// Of a line such as `X-Unit: mm` or `unit;um`: the axes, 0 for x and 1 for z, and their unit.
fn unit_setting(line: &str) -> Option<(&'static [usize], Unit)> {
    let (key, value) = key_and_value(line)?;
    let unit = Unit::parse(value).filter(|unit| unit.is_of(Dimension::Length))?;
    let axis = key.strip_suffix("units").or_else(|| key.strip_suffix("unit"))?;
    match axis {
        "" | "length" | "all" | "data" => Some((&[0, 1], unit)),
        "x" | "horizontal" | "lateral" => Some((&[0], unit)),
        "z" | "y" | "height" | "vertical" | "value" => Some((&[1], unit)),
        _ => None,
    }
}
