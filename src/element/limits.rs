//! How far a table reaches, but for rounding.

/// Share of a limit by which a number may exceed it: rounding, as of a master that goes to the very end of a table.
pub(crate) const ROUNDING: f64 = 1e-9;

/// The pressures and the largest speed that count as within a table.
#[derive(Clone, Copy, Debug)]
pub struct TableLimits {
    /// The least pressure, Pa.
    pub least_pressure: f64,
    /// The largest pressure, Pa.
    pub pressure: f64,
    /// m/s.
    pub speed: f64,
}

impl TableLimits {
    /// Those of a table with these pressures (Pa), the least and the largest, and this largest speed (m/s).
    pub(super) fn new((least, largest): (f64, f64), speed: f64) -> Self {
        let [above, below] = [1.0 + ROUNDING, 1.0 - ROUNDING];
        Self { least_pressure: least * below, pressure: largest * above, speed: speed * above }
    }

    /// Whether an element at a pressure (Pa) and a speed (m/s) is beyond the table, which `hold` warns of and `refuse`
    /// refuses: an element that lifts goes below the least pressure, and one that stands below the least speed.
    pub fn is_beyond(&self, pressure: f64, speed: f64) -> bool {
        pressure > self.pressure || speed > self.speed
    }

    /// Whether it is beyond the table or below its least pressure.
    pub fn is_outside(&self, pressure: f64, speed: f64) -> bool {
        self.is_beyond(pressure, speed) || pressure < self.least_pressure
    }
}
