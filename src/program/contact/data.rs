//! The fields of a contact as a table, and as arrays of numpy.

use std::fmt::Write as _;
use std::io::{Cursor, Write as _};

use zip::ZipWriter;
use zip::result::ZipResult;
use zip::write::SimpleFileOptions;

use super::Fields;

/// A table with a line for each point.
pub(super) fn csv(fields: &Fields) -> String {
    let mut text = "x [m],y [m],height [m],pressure [Pa],gap [m]\n".to_owned();
    let places = fields.y.iter().flat_map(|y| fields.x.iter().map(move |x| (x, y)));
    let values = fields.heights.iter().zip(&fields.pressures).zip(&fields.gaps);
    for ((x, y), ((height, pressure), gap)) in places.zip(values) {
        // Writing to a text does not fail.
        let _ = writeln!(text, "{x:?},{y:?},{height:?},{pressure:?},{gap:?}");
    }
    text
}

/// The arrays x and y, and height, pressure and gap with a row for each y, as `numpy.load` reads them.
pub(super) fn npz(fields: &Fields) -> ZipResult<Vec<u8>> {
    let (nx, ny) = (fields.x.len(), fields.y.len());
    let of_points = format!("({ny}, {nx})");
    let arrays = [
        ("x", format!("({nx},)"), &fields.x),
        ("y", format!("({ny},)"), &fields.y),
        ("height", of_points.clone(), &fields.heights),
        ("pressure", of_points.clone(), &fields.pressures),
        ("gap", of_points, &fields.gaps),
    ];
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, shape, values) in arrays {
        archive.start_file(format!("{name}.npy"), SimpleFileOptions::default())?;
        archive.write_all(&npy(&shape, values))?;
    }
    Ok(archive.finish()?.into_inner())
}

/// An array of numpy's format 1.0: the length and the text of a header, padded to a multiple of 64 bytes, and the values.
fn npy(shape: &str, values: &[f64]) -> Vec<u8> {
    const START: [u8; 8] = *b"\x93NUMPY\x01\x00";
    let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
    let length =
        (START.len() + size_of::<u16>() + header.len() + 1).next_multiple_of(64) - START.len() - size_of::<u16>();
    let mut bytes = START.to_vec();
    bytes.extend((length as u16).to_le_bytes());
    bytes.extend(format!("{header:<width$}\n", width = length - 1).bytes());
    bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    bytes
}
