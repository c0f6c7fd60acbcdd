//! ISO 5436-2 (ISO 25178-72) files: a zip archive with `main.xml` and, beside it, the heights as binary data.
//!
//! A profile or one line of an areal measurement along x is taken. The standard's unit is the metre. Read as the
//! reference implementation openGPS does: x = offset + increment · index on an incremental axis, of which nothing is
//! stored, and value · increment + offset on an absolute one; of a point's coordinates x, y, z the absolute ones stand
//! one after the other, little endian, x runs fastest. Sizes are bounded before anything is kept.

mod archive;
mod document;
mod points;
#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;

use super::{Missing, ProfileError, ProfileOptions, Raw, refuse};
use archive::Archive;
use document::Document;

/// The most points of a measurement: more than 16 000 by 16 000.
const MOST_POINTS: usize = 1 << 28;
/// The most points of a line.
const MOST_COLUMNS: usize = 1 << 24;

/// Reads the line that `options` choose.
pub(super) fn read(bytes: &[u8], options: &ProfileOptions) -> Result<Raw, ProfileError> {
    let mut archive = Archive::open(bytes)?;
    let document = Document::parse(&archive.main()?)?;
    let grid = Grid::of(&document)?;
    let line = grid.choose(options.line)?;
    let [x, z] = if document.is_inline() {
        points::inline(&document, &grid, line)?
    } else {
        points::binary(&document, &grid, line, &mut archive)?
    };
    let raw = Raw { x, z, ..Raw::default() };
    match raw.z.iter().position(|z| z.is_nan()).filter(|_| options.missing == Missing::Refuse) {
        Some(i) => Err(raw.refuse(i, "z", "missing", "a height, or missing = \"fill\" where heights are missing")),
        None => Ok(raw),
    }
}

/// How many points there are.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Grid {
    /// Points of a line.
    columns: usize,
    /// Lines.
    rows: usize,
}

impl Grid {
    fn of(document: &Document) -> Result<Self, ProfileError> {
        let feature = document.text("Record1.FeatureType").unwrap_or("SUR");
        if !["PRF", "SUR"].contains(&feature) {
            return Err(refuse(None, "FeatureType", feature, "PRF or SUR, a profile or an areal measurement"));
        }
        let grid = match document.whole("Record3.ListDimension")? {
            Some(columns) => Self { columns, rows: 1 },
            None => {
                let size = |key: &str| document.whole(key)?.ok_or_else(|| missing(key));
                let layers = size("MatrixDimension.SizeZ")?;
                if layers != 1 {
                    return Err(refuse(None, "MatrixDimension.SizeZ", &layers.to_string(), "1: one height a place"));
                }
                Self { columns: size("MatrixDimension.SizeX")?, rows: size("MatrixDimension.SizeY")? }
            }
        };
        let count = grid.columns.checked_mul(grid.rows);
        if grid.columns <= MOST_COLUMNS && count.is_some_and(|count| (1..=MOST_POINTS).contains(&count)) {
            return Ok(grid);
        }
        let given = format!("{} by {} points", grid.columns, grid.rows);
        let expected = format!("1 to {MOST_POINTS} points, at most {MOST_COLUMNS} of them in a line");
        Err(refuse(None, "MatrixDimension", &given, &expected))
    }

    fn count(&self) -> usize {
        self.columns * self.rows
    }

    /// The line, from 0, that was asked for by a number from 1; none is needed where there is but one.
    fn choose(&self, line: Option<usize>) -> Result<usize, ProfileError> {
        let rows = self.rows;
        match line {
            None if rows == 1 => Ok(0),
            None => Err(refuse(
                None,
                "line",
                "not given",
                &format!("a whole number from 1 to {rows}: there are {rows} lines"),
            )),
            Some(line) if line <= rows => Ok(line - 1),
            Some(line) => Err(refuse(
                None,
                "line",
                &line.to_string(),
                &format!("a whole number from 1 to {rows}, the lines that there are"),
            )),
        }
    }
}

fn missing(key: &str) -> ProfileError {
    refuse(None, key, "not there", "an element of main.xml")
}
