//! What commands print: numbers, rows, standard output.

use std::io::Write as _;
use std::ops::Range;
use std::path::Path;

use super::error::ProgramError;

/// A row: its name, empty where the row goes on with the one above, and its text.
pub(crate) type Row = (&'static str, String);

/// Rows below each other, a line each, their texts aligned.
pub(crate) fn lines(rows: &[Row]) -> String {
    rows.iter().map(|(name, text)| format!("{name:<12}{text}\n")).collect()
}

/// Prints what a command was asked for.
pub(crate) fn print(text: &str) -> Result<(), ProgramError> {
    let out = Path::new("standard output");
    std::io::stdout().write_all(text.as_bytes()).map_err(ProgramError::file("write", out))
}

/// The shortest decimal that reads back as the same number; with an exponent where its size is not `plain`.
pub(crate) fn decimal(value: f64, plain: Range<f64>) -> String {
    if value == 0.0 || plain.contains(&value.abs()) { format!("{value}") } else { format!("{value:e}") }
}

/// A number with so many digits.
pub(crate) fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits - 1).parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_far_from_one_have_an_exponent_and_few_digits_if_asked_for() {
        assert_eq!([0.0, 1e-3, -12.5, 1e5].map(|value| decimal(value, 1e-3..1e5)), ["0", "0.001", "-12.5", "1e5"]);
        assert_eq!(
            [rounded(0.1 + 0.2, 12), rounded(-1234.5, 2), rounded(f64::INFINITY, 3)],
            [0.3, -1200.0, f64::INFINITY]
        );
    }

    #[test]
    fn rows_are_aligned() {
        assert_eq!(lines(&[("Scene", "a".into()), ("", "b".into())]), "Scene       a\n            b\n");
    }
}
