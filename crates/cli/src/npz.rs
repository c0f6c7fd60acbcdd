//! Arrays for numpy: an archive that `numpy.load` reads.

use std::borrow::Cow;
use std::io::{Cursor, Write as _};

use zip::ZipWriter;
use zip::result::ZipResult;
use zip::write::SimpleFileOptions;

/// An array of numbers, in the order of its last index.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Array<'a> {
    pub(crate) name: &'a str,
    /// Its length along each index; empty for a single number.
    pub(crate) shape: Vec<usize>,
    pub(crate) values: Values<'a>,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Values<'a> {
    Reals(Cow<'a, [f64]>),
    /// From -128 to 127.
    Integers(Vec<i8>),
}

impl<'a> Array<'a> {
    /// An array of reals with one index.
    pub(crate) fn line(name: &'a str, values: impl Into<Cow<'a, [f64]>>) -> Self {
        let values = values.into();
        Self { name, shape: vec![values.len()], values: Values::Reals(values) }
    }

    /// A single number.
    pub(crate) fn single(name: &'a str, value: f64) -> Self {
        Self { name, shape: Vec::new(), values: Values::Reals(vec![value].into()) }
    }

    /// The file of the array in the archive, in numpy's format 1.0: the length and the text of a header, padded to a
    /// multiple of 64 bytes, and the values.
    fn file(&self) -> Vec<u8> {
        const START: [u8; 8] = *b"\x93NUMPY\x01\x00";
        let (kind, values): (_, Vec<u8>) = match &self.values {
            Values::Reals(values) => ("<f8", values.iter().flat_map(|value| value.to_le_bytes()).collect()),
            Values::Integers(values) => ("|i1", values.iter().map(|value| value.cast_unsigned()).collect()),
        };
        // Python's tuple of one has a comma too.
        let shape: String = self.shape.iter().map(|length| format!("{length},")).collect();
        let header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({shape}), }}");
        let before = START.len() + size_of::<u16>();
        let length = (before + header.len() + 1).next_multiple_of(64) - before;
        let mut bytes = START.to_vec();
        bytes.extend((length as u16).to_le_bytes());
        bytes.extend(format!("{header:<width$}\n", width = length - 1).bytes());
        bytes.extend(values);
        bytes
    }
}

/// The archive of `arrays`.
pub(crate) fn npz<'a>(arrays: impl IntoIterator<Item = Array<'a>>) -> ZipResult<Vec<u8>> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for array in arrays {
        archive.start_file(format!("{}.npy", array.name), SimpleFileOptions::default())?;
        archive.write_all(&array.file())?;
    }
    Ok(archive.finish()?.into_inner())
}
