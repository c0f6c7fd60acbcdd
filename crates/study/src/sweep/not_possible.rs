//! Numbers that no state of sliding has.

use asperity::tables::POSITIVE;

/// A number that no state of sliding has.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("`{option}`: expected {POSITIVE} in {unit}, found {found:?}")]
pub struct NotPossible {
    /// The option that it was given for.
    pub option: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// The number.
    pub found: f64,
}

impl NotPossible {
    /// Checks numbers of an option.
    ///
    /// # Errors
    /// Where one of them is out of range.
    pub fn check(option: &'static str, unit: &'static str, values: &[f64]) -> Result<(), Self> {
        let found = values.iter().copied().find(|value| !POSITIVE.holds(*value));
        found.map_or(Ok(()), |found| Err(Self { option, unit, found }))
    }
}
