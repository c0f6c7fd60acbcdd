//! The masses of a run as arrays of numpy.

use std::borrow::Cow;
use std::path::Path;

use asperity::outputs::OutputType;

use asperity_study::Error;
use asperity_study::masses::{ElementField, ElementHistory, Instant};

use crate::files;
use crate::npz::{Array, Values, npz};

/// Writes the rows' times, displacements and forces, the fields of the masses with a line for each row, the masses'
/// positions at rest, the area that each stands for where the scene gives it, and the data points of the profile.
pub(crate) fn write_arrays(history: &ElementHistory, path: &Path) -> Result<(), Error> {
    let of_rows = |value: fn(&Instant) -> f64| history.rows().iter().map(value).collect::<Vec<_>>();
    let lines = [
        Array::line("time", of_rows(|row| row.time)),
        Array::line("u", of_rows(|row| row.u)),
        Array::line("w", of_rows(|row| row.w)),
        Array::line("F_x", of_rows(|row| row.force_x)),
        Array::line("F_z", of_rows(|row| row.force_z)),
        Array::line("rest_x", history.rest()),
        Array::line("profile_x", history.surface().x()),
        Array::line("profile_z", history.surface().z()),
    ];
    let area = history.area().map(|area| Array::single("area", area));
    let fields = history.fields().fields().iter().map(|field| array(field, history.rest().len()));
    let archive = npz(lines.into_iter().chain(area).chain(fields));
    let archive = archive.map_err(|error| Error::value(format!("cannot write {}: {error}", path.display())))?;
    files::write(path, archive)
}

fn array(field: &ElementField, masses: usize) -> Array<'_> {
    let values = match field.kind {
        OutputType::Real => Values::Reals(Cow::Borrowed(&field.values)),
        OutputType::Integer => Values::Integers(field.values.iter().map(|&value| value as i8).collect()),
    };
    Array { name: &field.name, shape: vec![field.values.len() / masses, masses], values }
}
