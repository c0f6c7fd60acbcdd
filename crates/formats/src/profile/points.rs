//! Points as they stand in a file, and numbers in them that stand for a height that was not measured: -9999, 1e38 and the
//! like.

use asperity::scene::{HeightMap, MapError, Missing};
use asperity::tables::{ContentError, ReadingNote, Unit};

/// A surface as it was measured: the line that the options choose, and the map that it is taken of, or why there is
/// none.
#[derive(Debug)]
pub struct MeasuredSurface {
    /// The line along x.
    pub line: MeasuredPoints,
    /// The map, or what is expected of one; `None` of a single line.
    pub map: Option<Result<HeightMap, MapError>>,
}

/// Points as they stand in a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeasuredPoints {
    /// Positions.
    pub x: Vec<f64>,
    /// Heights; NaN where one is missing.
    pub z: Vec<f64>,
    /// The lines of the points in the file; none where it has no lines.
    pub lines: Vec<usize>,
    /// The units of x and z that the file names.
    pub units: [Option<Unit>; 2],
    /// Whether x follows from a spacing, which is in m whatever the units are.
    pub is_spaced: bool,
    /// Whether they grow downwards, as far as the file tells.
    pub is_depth: bool,
    /// How they were read.
    pub notes: Vec<ReadingNote>,
}

impl MeasuredPoints {
    /// Adds a point in a line of the file.
    pub(super) fn push(&mut self, line: usize, x: f64, z: f64) {
        self.x.push(x);
        self.z.push(z);
        self.lines.push(line);
    }

    /// Turns points whose x falls.
    pub(super) fn turn(&mut self) {
        self.x.reverse();
        self.z.reverse();
        self.lines.reverse();
        let text = "x falls throughout: the points are taken from the last to the first".to_owned();
        self.notes.push(ReadingNote { text, assumed: false });
    }

    /// Refuses point `i`, by its line or else by its number from 1.
    pub fn refuse(&self, i: usize, axis: &str, given: &str, expected: &str) -> ContentError {
        match self.lines.get(i) {
            Some(&line) => ContentError::value(Some(line), axis, given, expected),
            None => ContentError::value(None, &format!("{axis}[{}]", i + 1), given, expected),
        }
    }
}

/// Numbers that instruments are known to write so, beside those of nines and the largest; others are told by standing
/// there more than once.
const KNOWN: [f64; 5] = [32_767.0, 32_768.0, 2_147_483_647.0, 2_147_483_648.0, 1_000_001.0];
/// No height is as large.
const LARGEST: f64 = 1e29;
/// They lie as many times the range of the rest away from it.
const FAR: f64 = 10.0;

/// Refuses such a number by its line, or takes it for a missing height.
pub(super) fn take_out(raw: &mut MeasuredPoints, missing: Missing) -> Result<(), ContentError> {
    while let Some(value) = sentinel(&raw.z) {
        let is_it = |z: &f64| *z == value;
        let count = raw.z.iter().filter(|z| is_it(z)).count();
        let first = raw.z.iter().position(is_it).unwrap_or(0);
        let times = if count == 1 { "once".to_owned() } else { format!("{count} times") };
        let what = format!("{times}, more than {FAR} times the range of all other heights away from them");
        if missing == Missing::Refuse {
            let expected = "a height, or missing = \"fill\" where it stands for one that was not measured";
            return Err(raw.refuse(first, "z", &format!("{value:?} ({what})"), expected));
        }
        raw.z.iter_mut().filter(|z| is_it(z)).for_each(|z| *z = f64::NAN);
        raw.notes.push(ReadingNote {
            text: format!("{value:?} is taken for a missing height: it stands there {what}"),
            assumed: true,
        });
    }
    Ok(())
}

/// The largest or the smallest height, where it is far from all others and known, or stands there several times.
fn sentinel(heights: &[f64]) -> Option<f64> {
    let known = || heights.iter().copied().filter(|z| !z.is_nan());
    let ends = known()
        .fold(None, |ends: Option<(f64, f64)>, z| Some(ends.map_or((z, z), |(low, high)| (low.min(z), high.max(z)))));
    let (low, high) = ends?;
    [low, high].into_iter().find(|&end| {
        let others = known().filter(|z| *z != end).fold(None, |range: Option<(f64, f64)>, z| {
            Some(range.map_or((z, z), |(low, high)| (low.min(z), high.max(z))))
        });
        let Some((low, high)) = others else { return false };
        let range = high - low;
        let distance = (end - low).abs().min((end - high).abs());
        let is_known = KNOWN.contains(&end.abs()) || end.abs() >= LARGEST || is_of_nines(end);
        let count = known().filter(|z| *z == end).count();
        // Of two levels each is far from the other.
        distance > FAR * range && (is_known || (count > 1 && range > 0.0))
    })
}

/// -9999, 999.9 and the like.
fn is_of_nines(value: f64) -> bool {
    let digits = value.abs().to_string().replace('.', "");
    digits.len() > 2 && digits.chars().all(|digit| digit == '9')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_far_from_all_others_is_no_height() {
        let cases: [(&[f64], Option<f64>); 11] = [
            (&[0.0, 1.0, -99.9, 2.0], Some(-99.9)),
            (&[0.0, 1.0, 99.0, 2.0], None),
            (&[0.0, 1.0, -9999.0, 2.0], Some(-9999.0)),
            (&[0.0, 1.0, -5000.0, 2.0, -5000.0], Some(-5000.0)),
            (&[0.0, 1e-6, 2e-6, 1e29], Some(1e29)),
            (&[0.0, 1.0, -5000.0, 2.0], None),
            (&[0.0, 0.0, 1.0, 1.0], None),
            (&[0.0, 1.0, 2.0, 20.0, 20.0], None),
            (&[0.0, 0.0, -9999.0], Some(-9999.0)),
            (&[f64::NAN, 3.0], None),
            (&[], None),
        ];
        for (heights, expected) in cases {
            assert_eq!(sentinel(heights), expected, "{heights:?}");
        }
    }
}
