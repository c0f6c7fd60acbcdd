//! Files of instruments and of road descriptions that are no tables of text: known by how they begin.
//!
//! Files of other makers are refused by their names, with what to do.

mod binary;
mod crg;
mod erd;
mod gwyddion;
mod plu;
mod sdf;
mod sur;
#[cfg(test)]
mod tests;

use asperity::scene::Areal;
use asperity::scene::ContentError;
use asperity::scene::MeasuredSurface;
use asperity::scene::{MeasuredPoints, ProfileOptions};
use asperity::tables::{Dimension, Unit};

/// The points of a file that is one of these; `None` of any other.
pub(super) fn read(bytes: &[u8], options: &ProfileOptions) -> Option<Result<MeasuredSurface, ContentError>> {
    type Read = fn(&[u8], &ProfileOptions) -> Result<MeasuredSurface, ContentError>;
    let readers: [(bool, Read); 6] = [
        (sdf::is_sdf(bytes), |bytes, options| sdf::read(bytes)?.surface(options)),
        (sur::is_sur(bytes), |bytes, options| sur::read(bytes)?.surface(options)),
        (crg::is_crg(bytes), |bytes, options| crg::read(bytes)?.surface(options)),
        (erd::is_erd(bytes), |bytes, options| Ok(MeasuredSurface { line: erd::read(bytes, options)?, map: None })),
        (gwyddion::is_text(bytes), |bytes, options| gwyddion::read(bytes)?.surface(options)),
        (plu::is_plu(bytes), |bytes, options| plu::read(bytes)?.surface(options)),
    ];
    if let Some((_, read)) = readers.into_iter().find(|(is_it, _)| *is_it) {
        return Some(read(bytes, options));
    }
    foreign(bytes).map(Err)
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

/// Formats that are known by their first bytes and not read: the bytes, what it is, and what to do.
const FOREIGN: [(&[u8], &str); 21] = [
    (b"GWYP", "a native Gwyddion file (gwy)"),
    (b"Gwyddion Simple Field", "a Gwyddion Simple Field (gsf)"),
    (b"Gwyddion XYZ Field", "a Gwyddion XYZ field (gxyzf)"),
    (b"DSCOMPRESSED", "a compressed SUR file of Digital Surf"),
    (b"\x01\x00Directory", "an OPD file of Veeco or Wyko"),
    (b"Wyko ASCII Data File", "an ASC file of Wyko"),
    (b"\x88\x1b\x03\x6f", "a DAT file of Zygo MetroPro"),
    (b"\x88\x1b\x03\x70", "a DAT file of Zygo MetroPro"),
    (b"\x88\x1b\x03\x71", "a DAT file of Zygo MetroPro"),
    (b"Zygo ASCII Data File", "a text file of Zygo"),
    (b"AliconaImaging", "an AL3D file of Alicona"),
    (b"VK4_", "a VK4 file of Keyence"),
    (b"VK6", "a VK6 file of Keyence"),
    (b"\\*File list", "a file of a Nanoscope"),
    (b"\\*Force file list", "a force file of a Nanoscope"),
    (b"FRTM_", "an FRT file"),
    (b"\x89HDF\r\n\x1a\n", "an HDF5 file"),
    (b"CDF", "a netCDF file"),
    (b"\x93NUMPY", "a NumPy array"),
    (b"MATLAB ", "a file of MATLAB"),
    (b"LASF", "a LAS point cloud"),
];

/// Formats that hold no heights.
const PICTURES: [(&[u8], &str); 8] = [
    (b"\x89PNG", "a PNG picture"),
    (b"II*\0", "a TIFF picture"),
    (b"MM\0*", "a TIFF picture"),
    (b"\xff\xd8\xff", "a JPEG picture"),
    (b"BM", "a BMP picture"),
    (b"%PDF", "a PDF document"),
    (b"\x1f\x8b", "a gzip archive"),
    (b"\xd0\xcf\x11\xe0", "an old workbook of Excel"),
];

fn foreign(bytes: &[u8]) -> Option<ContentError> {
    const EXPORT: &str = "a file that is read: export x and z as text or CSV, or the surface as X3P, SDF or SUR, with \
                          the software of the instrument or with Gwyddion";
    let begins = |table: &'static [(&[u8], &str)]| {
        table.iter().find(|(magic, _)| bytes.starts_with(magic)).map(|(_, name)| *name)
    };
    if let Some(name) = begins(&FOREIGN) {
        return Some(refuse(name, EXPORT));
    }
    let is_text =
        || std::str::from_utf8(&bytes[..bytes.len().min(4096)]).is_ok() && !bytes[..bytes.len().min(4096)].contains(&0);
    begins(&PICTURES).filter(|name| *name != "a BMP picture" || !is_text()).map(|name| refuse(name, EXPORT))
}
