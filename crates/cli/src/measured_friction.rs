//! How far measured friction is off that of a model.

use asperity_study::calibration::{Measured, in_words};
use asperity_study::decimals::rounded;

/// A point that is off, in a line.
pub(crate) fn off(measured: &Measured, model: f64, deviations: f64) -> String {
    format!(
        "line {}, {}: {} measured, {} found, off by {} standard deviations",
        measured.line,
        in_words(&measured.point),
        rounded(measured.friction, 4),
        rounded(model, 4),
        rounded(deviations, 2),
    )
}
