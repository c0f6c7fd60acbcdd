//! What a table of moduli is read with, and what a row of it gives.

use super::columns::GivenUnits;
use super::sample::Sample;

/// A row of measured moduli.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MeasuredPoint {
    /// Line number in the file.
    pub(super) line: usize,
    pub(super) sample: Sample,
    /// K.
    pub(super) temperature: Option<f64>,
    /// a_T as the table has it.
    pub(super) shift: Option<f64>,
    /// The measurement that it belongs to, where the table numbers them.
    pub(super) set: Option<f64>,
}

/// How a table is read beside what it says.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reading<'a> {
    pub(super) ignored: &'a [String],
    pub(super) units: &'a GivenUnits,
    /// The frequency of a table without one, rad/s.
    pub(super) frequency: Option<f64>,
    /// Of moduli of shear.
    pub(super) poisson_ratio: f64,
    /// "Storage modulus" without a letter is G'.
    pub(super) shear: bool,
}
