//! Files of instruments and of road descriptions that are no tables of text: known by how they begin.
//!
//! Files of other kinds that are no text are refused by their names, with what to do.

mod binary;
mod crg;
mod gwyddion;
mod sdf;
mod sur;
#[cfg(test)]
mod tests;

use asperity::tables::{ContentError, Dimension, Unit};

use crate::profile::Areal;

/// The points of a file that is one of these; `None` of any other.
pub(super) fn read(bytes: &[u8]) -> Option<Result<Areal, ContentError>> {
    type Read = fn(&[u8]) -> Result<Areal, ContentError>;
    let readers: [(bool, Read); 4] = [
        (sdf::is_sdf(bytes), sdf::read),
        (sur::is_sur(bytes), sur::read),
        (crg::is_crg(bytes), crg::read),
        (gwyddion::is_text(bytes), gwyddion::read),
    ];
    readers.into_iter().find(|(is_it, _)| *is_it).map(|(_, read)| read(bytes))
}

/// The most heights of a file.
const MOST: usize = 1 << 28;

/// Refuses a size that no file can have, before memory is taken for it.
fn check_size(kind: &str, size: [usize; 2]) -> Result<(), ContentError> {
    let count = size[0].checked_mul(size[1]).filter(|&count| count > 0 && count <= MOST);
    let error = || {
        ContentError::value(
            None,
            "size",
            &format!("{} × {}", size[0], size[1]),
            &format!("{kind} of up to {MOST} heights"),
        )
    };
    count.map(|_| ()).ok_or_else(error)
}

/// Refuses a step that is none.
fn check_step(kind: &str, step: f64) -> Result<f64, ContentError> {
    let expected = format!("a distance of points above 0 in {kind}");
    if step > 0.0 && step.is_finite() {
        Ok(step)
    } else {
        Err(ContentError::value(None, "spacing", &format!("{step:?}"), &expected))
    }
}

/// The unit of length that a file names at `key`.
fn length_unit(key: &str, text: &str) -> Result<Unit, ContentError> {
    let unit = Unit::parse(text).filter(|unit| unit.dimension == Dimension::Length);
    let expected = format!("a unit of length: {}", Dimension::Length.units());
    unit.ok_or_else(|| ContentError::value(None, key, &format!("\"{text}\""), &expected))
}

/// The error of a file that is known but cannot be read.
fn refuse(kind: &str, what: &str) -> ContentError {
    ContentError::value(None, "", kind, what)
}

/// Files that are known by their first bytes and not read; of ERD the text would look like a table of x and z.
const FOREIGN: [(&[u8], &str); 19] = [
    (b"GWYP", "Gwyddion"),
    (b"DSCOMPRESSED", "Digital Surf, compressed"),
    (b"ERDFILE", "ERD"),
    (b"VK3_", "VK3 of Keyence"),
    (b"VK4_", "VK4 of Keyence"),
    (b"VK6_", "VK6 of Keyence"),
    (b"AliconaImaging", "AL3D of Alicona"),
    (b"\x01\0Directory", "OPD of Wyko"),
    (b"\\*File list", "SPM of Nanoscope"),
    (b"MATLAB 5.0 MAT-file", "MATLAB"),
    (b"\x93NUMPY", "NumPy"),
    (b"PAR1", "Parquet"),
    (b"\x89HDF\r\n\x1a\n", "HDF5"),
    (b"\x89PNG", "PNG"),
    (b"II*\0", "TIFF"),
    (b"MM\0*", "TIFF"),
    (b"\xff\xd8\xff", "JPEG"),
    (b"%PDF", "PDF"),
    (b"\x1f\x8b", "gzip"),
];

/// The error of a file that is known and not read.
pub(super) fn foreign(bytes: &[u8]) -> Option<ContentError> {
    let (_, kind) = FOREIGN.iter().find(|(magic, _)| bytes.starts_with(magic))?;
    let what = format!("a file of {kind}, which is not read");
    let expected =
        "columns as text, CSV or a workbook; a surface as X3P, SDF, SUR or text of x and z: export it as one of these";
    Some(refuse(&what, expected))
}
