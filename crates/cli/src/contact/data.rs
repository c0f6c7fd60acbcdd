//! The fields of a contact as a table, and as arrays of numpy.

use std::borrow::Cow;
use std::fmt::Write as _;

use asperity_study::contact::ContactFields;
use zip::result::ZipResult;

use crate::npz::{self, Array, Values};

/// A table with a line for each point.
pub(super) fn csv(fields: &ContactFields) -> String {
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
pub(super) fn npz(fields: &ContactFields) -> ZipResult<Vec<u8>> {
    let shape = vec![fields.y.len(), fields.x.len()];
    let field = |name, values| Array { name, shape: shape.clone(), values: Values::Reals(Cow::Borrowed(values)) };
    npz::npz([
        Array::line("x", &fields.x),
        Array::line("y", &fields.y),
        field("height", &fields.heights[..]),
        field("pressure", &fields.pressures[..]),
        field("gap", &fields.gaps[..]),
    ])
}
