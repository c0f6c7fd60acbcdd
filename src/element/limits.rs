//! How far a table reaches, but for rounding.

/// Share of a limit by which a number may exceed it: rounding, as of a master that goes to the very end of a table.
pub(crate) const ROUNDING: f64 = 1e-9;

/// The largest pressure and speed that count as within a table.
#[derive(Clone, Copy, Debug)]
pub struct TableLimits {
    /// Pa.
    pub pressure: f64,
    /// m/s.
    pub speed: f64,
}

impl TableLimits {
    /// Those of a table with this largest pressure (Pa) and speed (m/s).
    pub(super) fn new(pressure: f64, speed: f64) -> Self {
        Self { pressure: pressure * (1.0 + ROUNDING), speed: speed * (1.0 + ROUNDING) }
    }

    /// Whether an element at a pressure (Pa) and a speed (m/s) is beyond the table.
    pub fn is_beyond(&self, pressure: f64, speed: f64) -> bool {
        pressure > self.pressure || speed > self.speed
    }
}
