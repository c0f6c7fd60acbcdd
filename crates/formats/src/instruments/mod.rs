//! Files of instruments and of road descriptions that are no tables of text: known by how they begin.
//!
//! Files of other kinds that are no text are refused by their names, with what to do.

mod crg;
mod matrices;
mod shared;
#[cfg(test)]
mod tests;

use asperity::tables::ContentError;

use crate::profile::Areal;
use shared::refuse;

/// The points of a file that is one of these; `None` of any other.
pub(super) fn read(bytes: &[u8]) -> Option<Result<Areal, ContentError>> {
    type Read = fn(&[u8]) -> Result<Areal, ContentError>;
    let readers: [(bool, Read); 4] = [
        (matrices::is_sdf(bytes), matrices::read_sdf),
        (matrices::is_sur(bytes), matrices::read_sur),
        (crg::is_crg(bytes), crg::read),
        (matrices::is_gwyddion(bytes), matrices::read_gwyddion),
    ];
    readers.into_iter().find(|(is_it, _)| *is_it).map(|(_, read)| read(bytes))
}

/// Files that are known by their first bytes and not read; of ERD the text would look like a table of x and z.
const FOREIGN: &[(&[u8], &str)] = &[
    (b"GWYO", "Gwyddion"),
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
    (b"ARROW1", "Arrow"),
    (b"FEA1", "Feather"),
    (b"SQLite format 3", "SQLite"),
    (b"TDSm", "LabVIEW, TDMS"),
    (b"MDF     ", "MDF"),
    (b"CDF\x01", "NetCDF"),
    (b"CDF\x02", "NetCDF"),
    (b"\x89HDF\r\n\x1a\n", "HDF5"),
    (b"\x89PNG", "PNG"),
    (b"II*\0", "TIFF"),
    (b"MM\0*", "TIFF"),
    (b"\xff\xd8\xff", "JPEG"),
    (b"%PDF", "PDF"),
    (b"\x1f\x8b", "gzip"),
    (b"BZh", "bzip2"),
    (b"\xfd7zXZ", "xz"),
    (b"\x28\xb5\x2f\xfd", "Zstandard"),
    (b"7z\xbc\xaf", "7-Zip"),
];

/// The error of a file that is known and not read.
pub(super) fn foreign(bytes: &[u8]) -> Option<ContentError> {
    let (_, kind) = FOREIGN.iter().find(|(magic, _)| bytes.starts_with(magic))?;
    let what = format!("a file of {kind}, which is not read");
    let expected =
        "columns as text, CSV or a workbook; a surface as X3P, SDF, SUR or text of x and z: export it as one of these";
    Some(refuse(&what, expected))
}
