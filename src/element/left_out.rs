//! How well a table's points serve: the errors of looking them up in the rest.

use super::friction_table::{FrictionTable, Node, TableAxis};
use super::grid::OperatingPoint;
use super::law::{Law, LawAtSpeed};
use super::quantity::Quantity;

/// The interpolation errors of a table along an axis, found by leaving its inner points out one by one and looking them
/// up in the rest.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftOut {
    /// `speed`, `pressure` or `force`, `temperature`.
    pub axis: &'static str,
    /// The largest error of the friction coefficient, as a share of it, and where; `None` where the axis has no inner
    /// point.
    pub friction: Option<(f64, OperatingPoint)>,
    /// The largest error of F_z at the separation of the point, as a share of it, and where; `None` of a table with points in
    /// full contact, whose separation does not tell it.
    pub force_z: Option<(f64, OperatingPoint)>,
}

/// Leaves out the speeds, the pressures and the temperatures between the first and the last, one by one.
///
/// The steps that are interpolated over are then twice as long as the table's: of a method of third order, the table's
/// own errors are some eight times smaller.
pub fn left_out(table: &FrictionTable) -> [LeftOut; 3] {
    TableAxis::ALL.map(|axis| {
        let name = match axis {
            TableAxis::Speed => "speed",
            TableAxis::Load => table.load.name(),
            TableAxis::Temperature => "temperature",
        };
        let mut result = LeftOut { axis: name, friction: None, force_z: None };
        for index in 1..axis.values(&table.grid).len().saturating_sub(1) {
            result.leave_out(table, axis, index);
        }
        result
    })
}

impl LeftOut {
    /// Looks the points at `index` of an axis up in the rest of the table.
    fn leave_out(&mut self, table: &FrictionTable, axis: TableAxis, index: usize) {
        let rest = table.without(axis, index);
        let indices = |other: TableAxis| {
            if other == axis { index..index + 1 } else { 0..other.values(&table.grid).len().max(1) }
        };
        for temperature in indices(TableAxis::Temperature) {
            let kelvin = table.grid.temperatures.get(temperature).copied();
            let law = Law::new(&rest, kelvin.unwrap_or(0.0));
            for speed in indices(TableAxis::Speed) {
                let curve = LawAtSpeed::new(&law, table.grid.speeds[speed]);
                indices(TableAxis::Load)
                    .for_each(|load| self.compare(table, &curve, Node { temperature, load, speed }));
            }
        }
    }

    fn compare(&mut self, table: &FrictionTable, curve: &LawAtSpeed, node: Node) {
        let point = table.point(node);
        if !table.needs_backing() {
            let found = curve.at(-table.value(Quantity::Separation, node));
            keep_larger(&mut self.force_z, found.normal.value / table.load.force(point.load) - 1.0, point);
        }
        let friction = curve.at_pressure(Quantity::Friction, point.load);
        keep_larger(&mut self.friction, friction / table.value(Quantity::Friction, node) - 1.0, point);
    }
}

fn keep_larger(largest: &mut Option<(f64, OperatingPoint)>, error: f64, point: OperatingPoint) {
    let error = error.abs();
    if error.is_finite() && largest.is_none_or(|(other, _)| error > other) {
        *largest = Some((error, point));
    }
}
