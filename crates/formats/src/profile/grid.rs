//! Heights over a grid, and the line along x that is taken of them.

use asperity::scene::{
    HeightMap, LengthUnit, MOST_HEIGHTS, MapError, Missing, ProfileOptions, Tilt, line_note, peak_to_valley,
};
use asperity::tables::{ContentError, ReadingNote, Unit};

use super::points::{MeasuredPoints, MeasuredSurface, take_out};

/// An areal measurement: lines along x, one after the other along y.
#[derive(Debug)]
pub struct Areal {
    /// What the file is, for messages: "an SDF file".
    kind: &'static str,
    /// The positions of the points of a line.
    x: Vec<f64>,
    /// The positions of the lines.
    y: Vec<f64>,
    /// Line by line; NaN where there is none.
    heights: Vec<f64>,
    /// The unit of x, if it is not the metre; numbers of the spacing are in m.
    pub x_unit: Option<Unit>,
    /// The unit of y, if it is not that of x.
    pub y_unit: Option<Unit>,
    /// The unit of the heights that the file names.
    pub unit: Option<Unit>,
    /// Whether its heights grow downwards, as far as the file tells.
    is_depth: bool,
    /// How it was read.
    pub notes: Vec<ReadingNote>,
}

impl Areal {
    /// `size` points along x and lines along y at even `spacing`, m.
    pub fn even(kind: &'static str, size: [usize; 2], spacing: [f64; 2], heights: Vec<f64>) -> Self {
        let positions = |axis: usize| (0..size[axis]).map(|i| spacing[axis] * i as f64).collect();
        Self {
            kind,
            x: positions(0),
            y: positions(1),
            heights,
            x_unit: None,
            y_unit: None,
            unit: None,
            is_depth: false,
            notes: Vec::new(),
        }
    }

    /// Lines at these positions along y with points at these along x.
    pub fn at(kind: &'static str, x: Vec<f64>, y: Vec<f64>, heights: Vec<f64>) -> Self {
        Self { kind, x, y, heights, x_unit: None, y_unit: None, unit: None, is_depth: false, notes: Vec::new() }
    }

    /// A matrix, whose first row and column may be positions: they rise evenly but for the corner. Those that count points
    /// are left out for the given spacing; others are it, or must agree with it.
    pub(super) fn of_matrix(columns: usize, heights: Vec<f64>, options: &ProfileOptions) -> Result<Self, ContentError> {
        const KIND: &str = "a matrix of heights";
        let rows = heights.len() / columns;
        let x: Vec<f64> = heights[1..columns].to_vec();
        let y: Vec<f64> = heights.iter().skip(columns).step_by(columns).copied().collect();
        let given = <[f64; 2]>::try_from(&options.spacing[..]).ok();
        if !(rises(&x) && rises(&y)) {
            let expected = "the distances along x and y in m, spacing = [DX, DY] (--spacing DX,DY)";
            let spacing = given.ok_or_else(|| ContentError::value(None, "spacing", "not given", expected))?;
            return Ok(Self::even(KIND, [columns, rows], spacing, heights));
        }
        let inner: Vec<f64> = heights.chunks_exact(columns).skip(1).flat_map(|row| row[1..].iter().copied()).collect();
        let counts = |positions: &[f64]| positions.windows(2).all(|pair| pair[1] - pair[0] == 1.0);
        let text = "its first row and column are positions".to_owned();
        let note = ReadingNote { text, assumed: true };
        let unit = options.x_unit.map(LengthUnit::unit);
        let axes =
            Self { x_unit: unit, y_unit: unit, notes: vec![note], ..Self::at(KIND, x.clone(), y.clone(), inner) };
        let Some(spacing) = given else {
            let expected = "the unit of its first row and column, which are positions: x_unit (--x-unit), or unit";
            return unit.map(|_| axes).ok_or_else(|| ContentError::value(None, "x_unit", "not given", expected));
        };
        if counts(&x) && counts(&y) {
            return Ok(axes.evenly(spacing));
        }
        let in_metres = |positions: &[f64]| unit.unwrap_or(Unit::ONE).to_si(positions[1] - positions[0]);
        let steps = [in_metres(&x), in_metres(&y)];
        let agrees = |axis: usize| (steps[axis] / spacing[axis] - 1.0).abs() < EVEN;
        if agrees(0) && agrees(1) {
            return Ok(axes.evenly(spacing));
        }
        let given = format!("{spacing:?} m");
        let expected = format!(
            "{steps:?} m, the steps of the matrix's first row and column, which rise evenly and are positions; x_unit \
             (--x-unit) says in which unit these are"
        );
        Err(ContentError::value(None, "spacing", &given, &expected))
    }

    /// The same heights at an even spacing, m.
    fn evenly(self, spacing: [f64; 2]) -> Self {
        let even = Self::even(self.kind, self.size(), spacing, self.heights);
        Self { notes: self.notes, ..even }
    }

    /// How many points there are along x, and lines along y.
    pub(super) fn size(&self) -> [usize; 2] {
        [self.x.len(), self.y.len()]
    }

    /// Points on a grid in any order of lines; each line with all its points, one after the other along x or along y.
    pub(super) fn of_points(raw: MeasuredPoints, y: &[f64], y_unit: Option<Unit>) -> Result<Self, ContentError> {
        let (x_values, y_values) = (sorted(&raw.x), sorted(y));
        if x_values.len() * y_values.len() != raw.x.len() {
            let given =
                format!("{} points with {} values of x and {} of y", raw.x.len(), x_values.len(), y_values.len());
            let expected = "a grid with a height at each x and y; or columns = { x = \"x\", z = \"z\" } of one line";
            return Err(ContentError::value(raw.lines.first().copied(), "points", &given, expected));
        }
        let mut heights = vec![f64::NAN; raw.x.len()];
        for ((x, y), z) in raw.x.iter().zip(y).zip(&raw.z) {
            let at = |values: &[f64], value: f64| values.partition_point(|other| *other < value);
            heights[at(&y_values, *y) * x_values.len() + at(&x_values, *x)] = *z;
        }
        let [x_unit, unit] = raw.units;
        let (kind, is_depth) = ("a map of points", raw.is_depth);
        Ok(Self { kind, x: x_values, y: y_values, heights, x_unit, y_unit, unit, is_depth, notes: raw.notes })
    }

    /// The line that `options` choose, and the map, or why there is none; no map of a single line.
    ///
    /// # Errors
    /// [`ContentError`] where there is no such line, or heights are missing and may not be.
    pub fn surface(&self, options: &ProfileOptions) -> Result<MeasuredSurface, ContentError> {
        let is_map = self.x.len() > 1 && self.y.len() > 1;
        if is_map && options.periodic && options.tilt == Tilt::Remove {
            return self.level(options)?.surface(&ProfileOptions { tilt: Tilt::Keep, ..options.clone() });
        }
        Ok(MeasuredSurface { line: self.line(options)?, map: is_map.then(|| self.whole(options)) })
    }

    /// The heights above their least squares plane.
    fn level(&self, options: &ProfileOptions) -> Result<Self, ContentError> {
        let refuse = |error: MapError| ContentError::value(None, "tilt", "\"remove\"", &error.to_string());
        for (axis, positions) in [("x", &self.x), ("y", &self.y)] {
            even_step(positions).ok_or_else(|| refuse(MapError::Uneven(axis)))?;
        }
        let heights = self.known_heights(options.missing).map_err(refuse)?;
        // On an even grid the plane is the same whatever the steps are.
        let level = HeightMap::new(self.x.len(), [1.0; 2], heights).without_plane();
        let (x, y, notes) = (self.x.clone(), self.y.clone(), self.notes.clone());
        Ok(Self { x, y, heights: level.heights().to_vec(), notes, ..*self })
    }

    /// The line that `options` choose, or the middle one. That of a periodic map is closed by its first height, unless
    /// the map's edges repeat each other.
    fn line(&self, options: &ProfileOptions) -> Result<MeasuredPoints, ContentError> {
        let (width, lines) = (self.x.len(), self.y.len());
        let line = match options.line {
            Some(line) if line <= lines => line,
            Some(line) => {
                let expected = format!("a whole number from 1 to {lines}");
                return Err(ContentError::value(None, "line", &line.to_string(), &expected));
            }
            None => lines.div_ceil(2),
        };
        let mut notes = self.notes.clone();
        notes.push(line_note(self.kind, line, lines, options.line.is_some()));
        let here = (line - 1) * width..line * width;
        // A period has no ends to leave out: its gaps are filled as those of the map are.
        let filled = (options.periodic && options.missing == Missing::Fill).then(|| self.known_heights(Missing::Fill));
        let filled = filled.and_then(Result::ok);
        let heights = filled.as_ref().unwrap_or(&self.heights);
        let (mut x, mut z) = (self.x.clone(), heights[here].to_vec());
        let is_open = options.periodic && width > 2 && !repeat_their_start(heights, width);
        if let Some(step) = even_step(&self.x).filter(|_| is_open) {
            x.push(x[width - 1] + step);
            z.push(z[0]);
        }
        let units = [self.x_unit, self.unit];
        let is_spaced = !options.spacing.is_empty();
        let raw =
            MeasuredPoints { x, z, units, is_spaced, is_depth: self.is_depth, notes, ..MeasuredPoints::default() };
        match raw.z.iter().position(|z| z.is_nan()).filter(|_| options.missing == Missing::Refuse) {
            Some(i) => Err(raw.refuse(i, "z", "missing", "a height, or missing = \"fill\" where heights are missing")),
            None => Ok(raw),
        }
    }

    fn whole(&self, options: &ProfileOptions) -> Result<HeightMap, MapError> {
        // Positions and heights in metres.
        let unit =
            |given: Option<LengthUnit>, own: Option<Unit>| given.map(LengthUnit::unit).or(own).unwrap_or(Unit::ONE);
        let along = |own: Option<Unit>| if options.spacing.is_empty() { unit(options.x_unit, own) } else { Unit::ONE };
        let z_unit = unit(options.z_unit, self.unit);
        let step = |axis, positions: &[f64], unit: Unit| {
            even_step(positions).map(|step| unit.to_si(step)).ok_or(MapError::Uneven(axis))
        };
        let y_unit = along(self.y_unit.or(self.x_unit));
        let spacing = [step("x", &self.x, along(self.x_unit))?, step("y", &self.y, y_unit)?];
        let (nx, ny) = (self.x.len(), self.y.len());
        if self.heights.len() > MOST_HEIGHTS {
            return Err(MapError::TooLarge { nx, ny });
        }
        let mut heights = self.known_heights(options.missing)?;
        let sign = if options.turns_over(self.is_depth) { -1.0 } else { 1.0 };
        heights.iter_mut().for_each(|z| *z = sign * z_unit.to_si(*z));
        // Lines follow each other in +y.
        if spacing[1] < 0.0 {
            heights = heights.chunks_exact(nx).rev().flatten().copied().collect();
        }
        let map = HeightMap::new(nx, spacing.map(f64::abs), heights);
        let map = match (options.periodic, options.tilt) {
            (true, _) => map.without_repetition(),
            (false, Tilt::Remove) => map.without_plane(),
            (false, Tilt::Keep) => map,
        };
        map.check()?;
        Ok(map)
    }

    /// All heights, as they stand in the file; what is missing is filled along its line, or refused.
    fn known_heights(&self, missing: Missing) -> Result<Vec<f64>, MapError> {
        let mut all = MeasuredPoints { z: self.heights.clone(), ..MeasuredPoints::default() };
        // Numbers that stand for no height are gaps too; they are counted below.
        take_out(&mut all, Missing::Fill)?;
        let (mut heights, nx) = (all.z, self.x.len());
        let Some(first) = heights.iter().position(|z| z.is_nan()) else { return Ok(heights) };
        if missing == Missing::Refuse {
            let count = heights.iter().filter(|z| z.is_nan()).count();
            let (line, point) = (first / nx + 1, first % nx + 1);
            return Err(MapError::Missing { count, line, point });
        }
        let mut is_whole = true;
        for line in heights.chunks_exact_mut(nx) {
            is_whole &= fill_evenly(line);
        }
        if is_whole {
            return Ok(heights);
        }
        // Lines without any height are filled from those beside them.
        for i in 0..nx {
            let mut column: Vec<f64> = heights.iter().skip(i).step_by(nx).copied().collect();
            if !fill_evenly(&mut column) {
                return Err(MapError::OnlyGaps);
            }
            heights.iter_mut().skip(i).step_by(nx).zip(column).for_each(|(z, filled)| *z = filled);
        }
        Ok(heights)
    }
}

/// Largest difference of a position from an even one, as a share of the step: positions are rounded.
const EVEN: f64 = 1e-3;
/// Edges that repeat each other may differ by this part of the peak-to-valley height.
const ROUNDING: f64 = 1e-12;

/// Whether lines of `width` heights all end at the height they start from, as far as these are known.
fn repeat_their_start(heights: &[f64], width: usize) -> bool {
    let known: Vec<f64> = heights.iter().copied().filter(|z| !z.is_nan()).collect();
    let tolerance = ROUNDING * peak_to_valley(&known);
    let differs = |line: &[f64]| (line[width - 1] - line[0]).abs() > tolerance;
    !heights.chunks_exact(width).any(differs)
}

/// The step of even positions, with its sign.
fn even_step(positions: &[f64]) -> Option<f64> {
    let (first, last) = (*positions.first()?, *positions.last()?);
    let step = (last - first) / (positions.len() - 1) as f64;
    let is_even = |(i, x): (usize, &f64)| (x - first - step * i as f64).abs() <= EVEN * step.abs();
    (step != 0.0 && positions.iter().enumerate().all(is_even)).then_some(step)
}

/// Puts gaps on the straight line between the known heights beside them, and those at an end at the height of the
/// nearest; `false` where none is known.
fn fill_evenly(heights: &mut [f64]) -> bool {
    let known: Vec<usize> = (0..heights.len()).filter(|&i| !heights[i].is_nan()).collect();
    let (Some(&first), Some(&last)) = (known.first(), known.last()) else { return false };
    let (at_first, at_last) = (heights[first], heights[last]);
    heights[..first].fill(at_first);
    heights[last + 1..].fill(at_last);
    for ends in known.windows(2) {
        let (from, to) = (heights[ends[0]], heights[ends[1]]);
        let count = (ends[1] - ends[0]) as f64;
        for i in ends[0] + 1..ends[1] {
            heights[i] = from + (i - ends[0]) as f64 / count * (to - from);
        }
    }
    true
}

/// Whether numbers rise by even steps, as positions do.
pub(super) fn rises(numbers: &[f64]) -> bool {
    numbers.len() > 2
        && numbers.iter().all(|number| number.is_finite())
        && even_step(numbers).is_some_and(|step| step > 0.0)
}

/// Several lines of a scan behind each other, whose grid is not known.
pub(super) fn refuse_lines(line: Option<usize>, given: &str) -> ContentError {
    let expected = "one line of a scan: a file for each; or columns x, y, z, or a matrix of heights";
    ContentError::value(line, "lines of a scan", given, expected)
}

/// The values, each once, in order.
fn sorted(values: &[f64]) -> Vec<f64> {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}
