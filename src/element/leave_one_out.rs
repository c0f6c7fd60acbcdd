//! How well a table is interpolated, from the table alone: each inner point left out and looked up again.

use super::law::{Curve, Law};
use super::table::{Place, Quantity, Table};

/// What leaving out the points of an axis, one after another, tells.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftOut {
    /// Of which axis.
    pub axis: &'static str,
    /// The largest error of the friction coefficient, as a share of it, and where; `None` where the axis has no inner
    /// point.
    pub friction: Option<(f64, Place)>,
    /// That of F_z at the separation of the point.
    pub force_z: Option<(f64, Place)>,
}

/// Leaves out the speeds, the pressures and the temperatures between the first and the last, one by one.
///
/// The steps that are interpolated over are then twice as long as the table's: of a method of third order, the table's
/// own errors are some eight times smaller.
pub fn left_out(table: &Table) -> [LeftOut; 3] {
    let axes: [(&'static str, usize); 3] = [
        ("speed", table.speeds.len()),
        (table.load.name(), table.pressures.len()),
        ("temperature", table.temperatures.len()),
    ];
    std::array::from_fn(|axis| {
        let mut result = LeftOut { axis: axes[axis].0, friction: None, force_z: None };
        for at in 1..axes[axis].1.saturating_sub(1) {
            result.add(table, &table.without(axis, at), (axis, at));
        }
        result
    })
}

impl LeftOut {
    /// The points of `table` that `rest` has not, at the place `at` of an axis.
    fn add(&mut self, table: &Table, rest: &Table, (axis, at): (usize, usize)) {
        let counts = [table.speeds.len(), table.pressures.len(), table.temperatures.len().max(1)];
        let of = |other: usize| if other == axis { at..at + 1 } else { 0..counts[other] };
        for k in of(2) {
            let temperature = table.temperatures.get(k).copied();
            let law = Law::new(rest, temperature.unwrap_or(0.0));
            for j in of(0) {
                let curve = Curve::new(&law, table.speeds[j]);
                for i in of(1) {
                    let place =
                        Place { speed: table.speeds[j], pressure: table.pressures[i], load: table.load, temperature };
                    let value = |quantity| table.value(quantity, (k, i, j));
                    let found = curve.at(-value(Quantity::Separation));
                    let force = place.pressure * table.nominal_area;
                    note(&mut self.force_z, (found.normal.value / force - 1.0, place));
                    let friction = curve.at_pressure(Quantity::Friction, place.pressure);
                    note(&mut self.friction, (friction / value(Quantity::Friction) - 1.0, place));
                }
            }
        }
    }
}

/// Keeps the larger error.
fn note(largest: &mut Option<(f64, Place)>, (error, place): (f64, Place)) {
    let error = error.abs();
    if error.is_finite() && largest.is_none_or(|(other, _)| error > other) {
        *largest = Some((error, place));
    }
}
