//! ISO 5436-2 (ISO 25178-72) files: a zip archive with `main.xml` and, beside it, the heights as binary data.
//!
//! A profile, or an areal measurement and one line of it along x, is taken. The standard's unit is the metre. Read as the
//! reference implementation openGPS does: x = offset + increment · index on an incremental axis, of which nothing is
//! stored, and value · increment + offset on an absolute one; of a point's coordinates x, y, z the absolute ones stand
//! one after the other, little endian, x runs fastest. Sizes are bounded before anything is kept.

mod document;
#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;

use std::io::Read;
use std::ops::Range;

use md5::{Digest, Md5};

use asperity::scene::{MOST_HEIGHTS, MapError, Missing, ProfileOptions, line_note};
use asperity::tables::{ANY, ContentError};

use crate::profile::{Areal, MeasuredPoints, MeasuredSurface};
use document::{Archive, Document, MatrixSize, missing, unreadable};

/// What the file is, for messages.
const KIND: &str = "an X3P file";
const CHUNK: usize = 1 << 16;

/// Reads the line that `options` choose, and the map that it is taken of, or why there is none.
pub(super) fn read(bytes: &[u8], options: &ProfileOptions) -> Result<MeasuredSurface, ContentError> {
    let mut archive = Archive::open(bytes)?;
    let document = Document::parse(&archive.main()?)?;
    let size = MatrixSize::new(&document)?;
    let line = size.choose(options.line)?;
    let axes = Axes::read(&document)?;
    if let Some([x, y]) = axes.positions(&size).filter(|_| size.rows > 1 && size.count() <= MOST_HEIGHTS) {
        let [_, heights] = points(&document, &size, 0..size.rows, &mut archive)?;
        let areal = Areal::at(KIND, x, y, heights);
        return areal.surface(options);
    }
    let [x, z] = points(&document, &size, line..line + 1, &mut archive)?;
    let notes = vec![line_note(KIND, line + 1, size.rows, options.line.is_some())];
    let line = MeasuredPoints { x, z, notes, ..MeasuredPoints::default() };
    let expected = || format!("a map of up to {MOST_HEIGHTS} points, its axes x and y incremental (AxisType I)");
    let map = (size.rows > 1).then(|| Err(MapError::Format(expected())));
    match line.z.iter().position(|z| z.is_nan()).filter(|_| options.missing == Missing::Refuse) {
        Some(i) => Err(line.refuse(i, "z", "missing", "a height, or missing = \"fill\" where heights are missing")),
        None => Ok(MeasuredSurface { line, map }),
    }
}

/// An axis: a coordinate from its index or from a value of some type.
#[derive(Clone, Copy, Debug, PartialEq)]
struct CoordinateAxis {
    /// The type of the values; none where they follow from the index.
    stored_as: Option<NumberType>,
    increment: f64,
    offset: f64,
}

/// The type of a value in a binary file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum NumberType {
    /// 16 bits with a sign.
    Short,
    /// 32 bits with a sign.
    Long,
    Float,
    Double,
}

struct Axes([CoordinateAxis; 3]);

/// The x and the heights of the points of some lines; a missing height is NaN.
fn points(
    document: &Document,
    size: &MatrixSize,
    lines: Range<usize>,
    archive: &mut Archive<'_>,
) -> Result<[Vec<f64>; 2], ContentError> {
    if document.is_inline() { inline(document, size, lines) } else { binary(document, size, lines, archive) }
}

/// As [`points`], which stand in the document.
fn inline(document: &Document, size: &MatrixSize, lines: Range<usize>) -> Result<[Vec<f64>; 2], ContentError> {
    let axes = Axes::read(document)?;
    let found = document.points().count();
    if found != size.count() {
        let expected = format!("{}, as many as MatrixDimension says", size.count());
        return Err(ContentError::value(None, "DataList", &format!("{found} points"), &expected));
    }
    let points = document.points().skip(lines.start * size.columns).take(lines.len() * size.columns);
    axes.line(points.enumerate().map(|(i, point)| axes.written(i % size.columns, point)))
}

/// As [`points`], from the binary file of an archive.
fn binary(
    document: &Document,
    size: &MatrixSize,
    lines: Range<usize>,
    archive: &mut Archive<'_>,
) -> Result<[Vec<f64>; 2], ContentError> {
    let axes = Axes::read(document)?;
    let bytes = axes.bytes();
    let part = LinkedFile { link: "PointDataLink", checksum: "MD5ChecksumPointData", length: size.count() * bytes };
    let first = lines.start * size.columns;
    let kept = first * bytes..lines.end * size.columns * bytes;
    let data = part.read(document, archive, kept)?.ok_or_else(|| missing("DataLink.PointDataLink"))?;
    let part =
        LinkedFile { link: "ValidPointsLink", checksum: "MD5ChecksumValidPoints", length: size.count().div_ceil(8) };
    let mask = part.read(document, archive, 0..part.length)?;
    // The first point is the lowest bit of the first byte.
    let bit = |i: usize| mask.as_ref().is_none_or(|mask| mask[i / 8] >> (i % 8) & 1 == 1);
    axes.line(data.chunks_exact(bytes).enumerate().map(|(i, point)| {
        let (x, z) = axes.stored(i % size.columns, point);
        Ok((x, if bit(first + i) { z } else { f64::NAN }))
    }))
}

impl Axes {
    fn read(document: &Document) -> Result<Self, ContentError> {
        let [x, y, z] = ["CX", "CY", "CZ"].map(|name| CoordinateAxis::read(document, name));
        let (x, y, z) = (x?, y?, z?);
        if z.stored_as.is_none() {
            return Err(ContentError::value(None, "CZ.AxisType", "I", "A: absolute heights"));
        }
        Ok(Self([x, y, z]))
    }

    /// Where points of a line stand along x, and lines along y, where both follow from their numbers.
    fn positions(&self, size: &MatrixSize) -> Option<[Vec<f64>; 2]> {
        let [x, y, _] = self.0;
        let of = |axis: CoordinateAxis, count: usize| (0..count).map(|i| axis.coordinate(i as f64)).collect();
        let incremental = x.stored_as.is_none() && y.stored_as.is_none();
        incremental.then(|| [of(x, size.columns), of(y, size.rows)])
    }

    fn bytes(&self) -> usize {
        self.0.iter().filter_map(|axis| axis.stored_as).map(NumberType::bytes).sum()
    }

    /// x and height of point `i` of a line, from its bytes.
    fn stored(&self, i: usize, point: &[u8]) -> (f64, f64) {
        let mut at = 0;
        let [x, _, z] = self.0.map(|axis| match axis.stored_as {
            None => axis.coordinate(i as f64),
            Some(number) => {
                at += number.bytes();
                axis.coordinate(number.value(&point[at - number.bytes()..at]))
            }
        });
        (x, z)
    }

    /// The coordinates of a point written as text, `x;y;z`, or the absolute coordinates alone. An empty text is a
    /// missing height.
    fn written(&self, i: usize, point: &str) -> Result<(f64, f64), ContentError> {
        let wrong = || {
            ContentError::value(None, &format!("DataList[{}]", i + 1), point, "coordinates, separated by semicolons")
        };
        let number = |text: Option<&str>| match text.map(str::trim) {
            None | Some("") => Ok(f64::NAN),
            Some(text) => text.parse::<f64>().map_err(|_| wrong()),
        };
        let [x, _, z] = self.0;
        let height = z.coordinate(number(point.rsplit(';').next())?);
        let x_value = if x.stored_as.is_some() { number(point.split(';').next())? } else { i as f64 };
        Ok((x.coordinate(x_value), height))
    }

    /// Collects a line; x must be a number, a height that is none or out of range is missing.
    fn line(
        &self,
        points: impl Iterator<Item = Result<(f64, f64), ContentError>>,
    ) -> Result<[Vec<f64>; 2], ContentError> {
        let (mut positions, mut heights) = (Vec::new(), Vec::new());
        for point in points {
            let (x, z) = point?;
            if !ANY.holds(x) {
                let key = format!("x[{}]", positions.len() + 1);
                return Err(ContentError::value(None, &key, &format!("{x:?}"), &ANY.to_string()));
            }
            positions.push(x);
            heights.push(if ANY.holds(z) { z } else { f64::NAN });
        }
        Ok([positions, heights])
    }
}

impl CoordinateAxis {
    fn read(document: &Document, name: &str) -> Result<Self, ContentError> {
        let key = |field: &str| format!("{name}.{field}");
        let axis_type = document.required(&key("AxisType"))?;
        let incremental = match axis_type {
            "I" => true,
            "A" => false,
            other => return Err(ContentError::value(None, &key("AxisType"), other, "I or A, incremental or absolute")),
        };
        let stored_as = if incremental { None } else { Some(NumberType::read(document, &key("DataType"))?) };
        // On an absolute axis an increment of 0 says as little as none.
        let increment = document.number(&key("Increment"))?.filter(|increment| incremental || *increment != 0.0);
        let offset = document.number(&key("Offset"))?.unwrap_or(0.0);
        match increment {
            Some(increment) => Ok(Self { stored_as, increment, offset }),
            None if incremental => Err(missing(&key("Increment"))),
            None => Ok(Self { stored_as, increment: 1.0, offset }),
        }
    }

    fn coordinate(&self, value: f64) -> f64 {
        self.offset + self.increment * value
    }
}

impl NumberType {
    fn read(document: &Document, key: &str) -> Result<Self, ContentError> {
        Ok(match document.required(key)? {
            "I" => Self::Short,
            "L" => Self::Long,
            "F" => Self::Float,
            "D" => Self::Double,
            other => return Err(ContentError::value(None, key, other, "one of I, L, F, D")),
        })
    }

    fn bytes(self) -> usize {
        match self {
            Self::Short => 2,
            Self::Long | Self::Float => 4,
            Self::Double => 8,
        }
    }

    fn value(self, bytes: &[u8]) -> f64 {
        match (self, bytes) {
            (Self::Short, &[a, b]) => i16::from_le_bytes([a, b]).into(),
            (Self::Long, &[a, b, c, d]) => i32::from_le_bytes([a, b, c, d]).into(),
            (Self::Float, &[a, b, c, d]) => f32::from_le_bytes([a, b, c, d]).into(),
            (Self::Double, &[a, b, c, d, e, f, g, h]) => f64::from_le_bytes([a, b, c, d, e, f, g, h]),
            _ => f64::NAN,
        }
    }
}

/// A file that the document links to.
struct LinkedFile {
    link: &'static str,
    checksum: &'static str,
    /// The bytes that it must have.
    length: usize,
}

impl LinkedFile {
    /// The bytes of a range, where the document names the file. All are looked at for the checksum, but not kept.
    fn read(
        &self,
        document: &Document,
        archive: &mut Archive<'_>,
        kept: Range<usize>,
    ) -> Result<Option<Vec<u8>>, ContentError> {
        let Some(link) = document.text(&format!("DataLink.{}", self.link)) else { return Ok(None) };
        let mut file = archive.linked(link)?;
        let mut chunk = vec![0; CHUNK];
        let (mut digest, mut data, mut start) = (Md5::new(), Vec::new(), 0);
        loop {
            let count = file.read(&mut chunk).map_err(|error| unreadable(link, &error))?;
            let end = start + count;
            if count == 0 || end > self.length {
                self.check_length(end)?;
                break;
            }
            digest.update(&chunk[..count]);
            let inside = |offset: usize| offset.clamp(start, end) - start;
            data.extend_from_slice(&chunk[inside(kept.start)..inside(kept.end)]);
            start = end;
        }
        self.check_sum(document, &digest.finalize())?;
        Ok(Some(data))
    }

    fn check_length(&self, found: usize) -> Result<(), ContentError> {
        let given = if found > self.length { "more bytes".into() } else { format!("{found} bytes") };
        let expected = format!("{} bytes, as MatrixDimension and Axes say", self.length);
        if found == self.length { Ok(()) } else { Err(ContentError::value(None, self.link, &given, &expected)) }
    }

    /// A checksum that is there must be right: the file is damaged, or its data are no longer what they were.
    fn check_sum(&self, document: &Document, digest: &[u8]) -> Result<(), ContentError> {
        let found: String = digest.iter().map(|byte| format!("{byte:02x}")).collect();
        match document.text(&format!("DataLink.{}", self.checksum)) {
            Some(given) if !given.eq_ignore_ascii_case(&found) => Err(ContentError::value(
                None,
                self.checksum,
                given,
                &format!("{found}, the checksum of the data that are there"),
            )),
            _ => Ok(()),
        }
    }
}
