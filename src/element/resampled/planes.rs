//! The temperatures at which a law is kept where elements have temperatures of their own.

use crate::element::friction_table::FrictionTable;
use crate::element::law::Law;

/// Distance of planes, K, at most; closer where the table bends with the temperature so that p and μp would err by more
/// than their tolerance at the table's points; and how many there are at most.
const MAX_DISTANCE: f64 = 2.0;
const PLANE_TOLERANCE: f64 = 1e-3;
const MAX_PLANES: f64 = 400.0;

/// Temperatures at which a law is kept, evenly from the first of its table to the last.
#[derive(Clone, Copy, Debug)]
pub(super) struct Planes {
    /// The least, K.
    pub(super) first: f64,
    /// From one to the next, K.
    pub(super) distance: f64,
    pub(super) count: usize,
    /// Cells of a plane.
    pub(super) cells: usize,
}

impl Planes {
    /// Those of a table of several temperatures, with so many cells each.
    pub(super) fn new(table: &FrictionTable, law: &Law, cells: usize) -> Option<Self> {
        let [first, .., last] = *table.grid.temperatures.as_slice() else { return None };
        // A straight line over a parabola is off by its second derivative times the distance² over 8.
        let distance = (8.0 * PLANE_TOLERANCE / law.bend_over_temperature()).sqrt().min(MAX_DISTANCE);
        let steps = ((last - first) / distance).ceil().clamp(1.0, MAX_PLANES - 1.0);
        Some(Self { first, distance: (last - first) / steps, count: steps as usize + 1, cells })
    }

    pub(super) fn temperature(&self, plane: usize) -> f64 {
        self.first + self.distance * plane as f64
    }

    /// Up to this approach (m) there is no contact at any speed and any plane's temperature.
    pub(super) fn earliest_touch(&self, law: &mut Law) -> f64 {
        let touch = |plane: usize| {
            law.set_temperature(self.temperature(plane));
            law.earliest_touch()
        };
        (0..self.count).map(touch).fold(f64::INFINITY, f64::min)
    }
}
