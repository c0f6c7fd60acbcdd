//! How tables of moduli are read, and what a row says.

use asperity::tables::Unit;

use super::sample::Sample;

/// Units given on the command line, by the names of columns.
pub(super) type GivenUnits = [(String, Unit)];

/// What a row of a table says of one curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MeasuredPoint {
    /// Line number in the file.
    pub(super) line: usize,
    pub(super) sample: Sample,
    /// K.
    pub(super) temperature: Option<f64>,
    /// a_T as the table has it.
    pub(super) shift: Option<f64>,
    /// b_T as the table has it.
    pub(super) vertical: Option<f64>,
    /// The measurement that it belongs to, where the table numbers them.
    pub(super) set: Option<f64>,
}

/// How a table is read beside what it says.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reading<'a> {
    pub(super) ignored: &'a [String],
    /// Columns that are said to be those of roles.
    pub(super) columns: &'a [(String, String)],
    pub(super) units: &'a GivenUnits,
    /// The frequency of a table without one, rad/s.
    pub(super) frequency: Option<f64>,
    /// Of moduli of shear.
    pub(super) poisson_ratio: f64,
    /// "Storage modulus" without a letter is G'.
    pub(super) shear: bool,
}
