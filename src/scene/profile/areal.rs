//! Heights over a grid, and the line along x that is taken of them.

use super::options::{MeasuredPoints, Missing, ProfileOptions, ReadingNote};
use crate::scene::error::ContentError;
use crate::scene::text_table::Unit;

/// An areal measurement: lines along x, one after the other along y.
#[derive(Debug)]
pub(super) struct Areal {
    /// What the file is, for messages: "an SDF file".
    kind: &'static str,
    /// The positions of the points of a line.
    x: Vec<f64>,
    /// The positions of the lines.
    y: Vec<f64>,
    /// Line by line; NaN where there is none.
    heights: Vec<f64>,
    /// The unit of x, if it is not the metre; numbers of the spacing are in m.
    pub(super) x_unit: Option<Unit>,
    /// The unit of the heights that the file names.
    pub(super) unit: Option<Unit>,
    pub(super) notes: Vec<ReadingNote>,
}

impl Areal {
    /// `size` points along x and lines along y at even `spacing`, m.
    pub(super) fn even(kind: &'static str, size: [usize; 2], spacing: [f64; 2], heights: Vec<f64>) -> Self {
        let positions = |axis: usize| (0..size[axis]).map(|i| spacing[axis] * i as f64).collect();
        Self { kind, x: positions(0), y: positions(1), heights, x_unit: None, unit: None, notes: Vec::new() }
    }

    /// Points on a grid in any order of lines; each line with all its points, one after the other along x or along y.
    pub(super) fn of_points(raw: MeasuredPoints, y: &[f64]) -> Result<Self, ContentError> {
        let (x_values, y_values) = (sorted(&raw.x), sorted(y));
        if x_values.len() * y_values.len() != raw.x.len() {
            let given =
                format!("{} points with {} values of x and {} of y", raw.x.len(), x_values.len(), y_values.len());
            let expected = "a grid with a height at each x and y; or columns = [\"x\", \"z\"] of one line";
            return Err(ContentError::value(raw.lines.first().copied(), "points", &given, expected));
        }
        let mut heights = vec![f64::NAN; raw.x.len()];
        for ((x, y), z) in raw.x.iter().zip(y).zip(&raw.z) {
            let at = |values: &[f64], value: f64| values.partition_point(|other| *other < value);
            heights[at(&y_values, *y) * x_values.len() + at(&x_values, *x)] = *z;
        }
        let [x_unit, unit] = raw.units;
        Ok(Self { kind: "a map of points", x: x_values, y: y_values, heights, x_unit, unit, notes: raw.notes })
    }

    /// The line that `options` choose, or the middle one.
    pub(super) fn line(self, options: &ProfileOptions) -> Result<MeasuredPoints, ContentError> {
        let lines = self.y.len();
        let line = match options.line {
            Some(line) if line <= lines => line,
            Some(line) => {
                let expected = format!("a whole number from 1 to {lines}");
                return Err(ContentError::value(None, "line", &line.to_string(), &expected));
            }
            None => lines.div_ceil(2),
        };
        let mut notes = self.notes;
        notes.push(line_note(self.kind, line, lines, options.line.is_some()));
        let width = self.x.len();
        let z = self.heights[(line - 1) * width..line * width].to_vec();
        let units = [self.x_unit, self.unit];
        let is_spaced = !options.spacing.is_empty();
        let raw = MeasuredPoints { x: self.x, z, units, is_spaced, notes, ..MeasuredPoints::default() };
        match raw.z.iter().position(|z| z.is_nan()).filter(|_| options.missing == Missing::Refuse) {
            Some(i) => Err(raw.refuse(i, "z", "missing", "a height, or missing = \"fill\" where heights are missing")),
            None => Ok(raw),
        }
    }
}

/// Says which line was taken.
pub(super) fn line_note(kind: &str, line: usize, lines: usize, is_chosen: bool) -> ReadingNote {
    let assumed = lines > 1 && !is_chosen;
    let which = if assumed { ", the middle one: `line` takes another" } else { "" };
    ReadingNote { text: format!("{kind}: line {line} of {lines} along x{which}"), assumed }
}

/// The values, each once, in order.
fn sorted(values: &[f64]) -> Vec<f64> {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}
