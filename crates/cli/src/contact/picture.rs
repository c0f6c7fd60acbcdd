//! The picture of a contact: curves along a profile, maps over a map.

use std::path::Path;

use asperity_study::contact::ContactFields;
use asperity_study::steady::SurfaceGrid;

use crate::figure::{
    Colours, ContactCurves, Curve, FieldMap, Figure as _, LinearPanel, LinearStack, Marks, RUBBER_SLIDES, Stroke,
    SurfaceMaps,
};
use crate::files::FileError;
use asperity_study::decimals::rounded;

/// Draws the fields on a surface of which the share `area` is in contact.
pub(super) fn write(surface: &SurfaceGrid, fields: &ContactFields, area: f64, path: &Path) -> Result<(), FileError> {
    if surface.size.ny > 1 { maps(surface, fields, area).write(path) } else { curves(fields).write(path) }
}

/// The profile with the rubber's surface above it, and the pressure below.
fn curves(fields: &ContactFields) -> ContactCurves {
    let curve = |name: &str, look: usize, values: Vec<f64>| Curve {
        name: name.to_owned(),
        look,
        stroke: Stroke::Line,
        points: fields.x.iter().copied().zip(values).collect(),
    };
    let rubber = fields.heights.iter().zip(&fields.gaps).map(|(height, gap)| height + gap).collect();
    let heights = vec![curve("rubber", 1, rubber), curve("surface", 0, fields.heights.clone())];
    let pressure = vec![curve("pressure", 1, fields.pressures.clone())];
    ContactCurves(LinearStack {
        x: ("x", "m"),
        panels: vec![
            LinearPanel { quantity: "height", unit: "m", curves: heights },
            LinearPanel { quantity: "pressure", unit: "Pa", curves: pressure },
        ],
    })
}

/// Pressure, gap, and where on the heights the contact is.
fn maps(surface: &SurfaceGrid, fields: &ContactFields, area: f64) -> SurfaceMaps {
    let is_touched = |pressure: &f64| *pressure > 0.0;
    let marks = |name: String, stand_out: bool, of: &dyn Fn(&f64) -> bool| {
        Some(Marks { name, stand_out, points: fields.pressures.iter().map(of).collect() })
    };
    let map = |quantity: &'static str, unit: &'static str, values: &[f64], colours: Colours, marks: Option<Marks>| {
        FieldMap { quantity, unit, values: values.to_vec(), colours, marks }
    };
    let free = marks("no contact".into(), false, &|pressure| !is_touched(pressure));
    let contact = marks(format!("contact, {} % of the area", rounded(100.0 * area, 3)), true, &is_touched);
    SurfaceMaps {
        nx: surface.size.nx,
        extents: [surface.length, surface.width],
        arrow: RUBBER_SLIDES,
        maps: vec![
            map("pressure", "Pa", &fields.pressures, Colours::Viridis, free),
            map("gap", "m", &fields.gaps, Colours::Blues, None),
            map("height", "m", &fields.heights, Colours::Greys, contact),
        ],
    }
}
