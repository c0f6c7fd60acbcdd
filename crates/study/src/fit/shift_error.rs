//! Why moduli of several temperatures do not become those of one.

/// Moduli of several temperatures cannot be put together.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are")]
pub enum ShiftError {
    #[error(
        "the temperatures run through from {from:.2} to {to:.2} K: rows of one temperature each have no range in \
         common; expected `wlf` C1,C2,TREF or `shifts` SHIFTS.csv, or rows at a few temperatures"
    )]
    Ramp { from: f64, to: f64 },
    #[error(
        "{temperature:.2} K has rows at one {what} alone: shift factors are found where curves overlap; expected `wlf` \
         C1,C2,TREF or `shifts` SHIFTS.csv"
    )]
    OnePlace { temperature: f64, what: &'static str },
    #[error("some rows have a temperature and others have none")]
    Mixed,
    #[error("{file} has no factor for {temperature:.2} K, within {within} K")]
    NoFactor { file: String, temperature: f64, within: f64 },
    #[error("the table has no temperatures to shift by `shifts`")]
    NoTemperatures,
    #[error("`vertical` density: expected a temperature of each row, and frequencies that are not reduced")]
    NoDensity,
    #[error("`vertical` multiply: expected a column b_T in the table, or in that of `shifts`")]
    NoVertical,
    #[error("a_T at {temperature:.2} K differs from row to row: {from} and {to}")]
    Factors { temperature: f64, from: f64, to: f64 },
}
