//! The plot of a table: friction over speed, its parts dashed.

use std::path::Path;

use asperity::element::Quantity;

use super::table_file::{StoredRow, SweepTable};
use crate::program::figure::{Curve, Figure as _, Panel, SideBySide, Stroke};
use crate::program::files::FileError;

/// Draws friction over speed at `path`: a panel for each temperature, a colour for each load; with one load, one panel
/// and a colour for each temperature.
pub(super) fn draw(path: &Path, table: &SweepTable) -> Result<(), FileError> {
    plot(table).write(path)
}

fn plot(table: &SweepTable) -> SideBySide {
    let (grid, unit) = (&table.header.grid, table.header.load.unit());
    let temperatures = match grid.temperatures.as_slice() {
        [] => vec![None],
        values => values.iter().copied().map(Some).collect(),
    };
    let of = |load: f64, temperature: Option<f64>| {
        let rows = table.rows.iter().filter(|stored| stored.row.is_steady());
        rows.filter(move |stored| stored.row.point.load == load && stored.row.point.temperature == temperature)
    };
    let kelvin = |temperature: Option<f64>| temperature.map(|kelvin| format!("{kelvin} K"));
    let panels = if let [load] = grid.loads[..] {
        let load_name = with_prefix(load, unit);
        let curves = temperatures.iter().enumerate().flat_map(|(look, &temperature)| {
            curves(&kelvin(temperature).unwrap_or_else(|| load_name.clone()), look, of(load, temperature))
        });
        let curves = curves.collect();
        vec![Panel { title: temperatures[0].map(|_| load_name).unwrap_or_default(), curves }]
    } else {
        let panel = |&temperature: &Option<f64>| {
            let loads = grid.loads.iter().enumerate();
            let curves =
                loads.flat_map(|(look, &load)| curves(&with_prefix(load, unit), look, of(load, temperature))).collect();
            Panel { title: kelvin(temperature).unwrap_or_default(), curves }
        };
        temperatures.iter().map(panel).collect()
    };
    SideBySide { x_title: "speed in m/s".into(), y_title: "friction coefficient".into(), panels }
}

/// The friction coefficient and those of its parts that are there and not 0.
fn curves<'a>(name: &str, look: usize, rows: impl Iterator<Item = &'a StoredRow>) -> Vec<Curve> {
    let parts = [Quantity::Friction, Quantity::Hysteresis, Quantity::Adhesion, Quantity::FineHysteresis];
    let mut points = parts.map(|_| Vec::new());
    for row in rows.map(|stored| &stored.row) {
        let values = parts.map(|part| row.value(part));
        if let [Some(_), Some(_), Some(_), _] = values {
            points
                .iter_mut()
                .zip(values)
                .for_each(|(points, value)| points.extend(value.map(|y| (row.point.speed, y))));
        }
    }
    let looks = [
        (name, Stroke::Line),
        ("hysteresis", Stroke::Dashed),
        ("adhesion", Stroke::Dotted),
        ("of it below the profile", Stroke::Rings),
    ];
    let curves =
        looks.into_iter().zip(points).map(|((name, stroke), points)| Curve { name: name.into(), look, stroke, points });
    curves
        .enumerate()
        .filter(|(i, curve)| *i == 0 || curve.points.iter().any(|point| point.1 != 0.0))
        .map(|(_, curve)| curve)
        .collect()
}

/// A quantity with a prefix of its unit: `0.2 MPa`.
pub(crate) fn with_prefix(value: f64, unit: &str) -> String {
    let (prefix, factor) = match value {
        value if value >= 1e5 => ("M", 1e6),
        value if value >= 1e3 => ("k", 1e3),
        value if value >= 0.1 => ("", 1.0),
        value if value >= 1e-4 => ("m", 1e-3),
        _ => ("µ", 1e-6),
    };
    let number = format!("{:.6}", value / factor);
    format!("{} {prefix}{unit}", number.trim_end_matches('0').trim_end_matches('.'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loads_have_a_prefix_of_their_unit() {
        let names = [2e5, 4e4, 20.0, 0.05].map(|value| with_prefix(value, "Pa"));
        assert_eq!(names, ["0.2 MPa", "40 kPa", "20 Pa", "50 mPa"]);
    }
}
