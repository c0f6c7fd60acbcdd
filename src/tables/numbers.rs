//! Numbers as people and instruments write them, and words for those that are missing.

/// Reads the numbers of a table: with decimal points or with decimal commas, but not with both, for commas may then
/// stand between thousands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NumberStyle {
    decimal_comma: bool,
    points: bool,
    commas: bool,
    /// The sign between thousands.
    thousands: Option<char>,
}

/// A table has numbers with points and others with commas.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected {}", NumberStyle::EXPECTED)]
pub struct MixedDecimals;

impl NumberStyle {
    /// What a table must have.
    pub const EXPECTED: &str = "numbers with decimal points or with decimal commas, not both in one file";

    /// That of a table whose numbers are still to be read.
    pub fn new(decimal_comma: bool) -> Self {
        Self { decimal_comma, points: false, commas: false, thousands: None }
    }

    /// The same with a sign between thousands.
    #[must_use]
    pub(super) fn with_thousands(self, thousands: Option<char>) -> Self {
        Self { thousands, ..self }
    }

    /// The number in a field, if it is one; it may be NaN.
    ///
    /// # Errors
    /// [`MixedDecimals`] where numbers before had the other sign.
    pub fn read(&mut self, field: &str) -> Result<Option<f64>, MixedDecimals> {
        if let Some(sign) = self.thousands.filter(|sign| field.contains(*sign)) {
            return self.read_plain(&field.replace(sign, ""));
        }
        self.read_plain(field)
    }

    fn read_plain(&mut self, field: &str) -> Result<Option<f64>, MixedDecimals> {
        let value = number(field, self.decimal_comma);
        if value.is_some() { self.add(field).map(|()| value) } else { Ok(None) }
    }

    /// Notes the sign in a number.
    ///
    /// # Errors
    /// As [`NumberStyle::read`].
    fn add(&mut self, field: &str) -> Result<(), MixedDecimals> {
        self.points |= field.contains('.');
        self.commas |= field.contains(',');
        if self.points && self.commas && field.contains(['.', ',']) { Err(MixedDecimals) } else { Ok(()) }
    }
}

/// Words for a value that is not there.
pub const MISSING: [&str; 12] =
    ["nan", "n/a", "na", "#n/a", "null", "none", "bad", "missing", "invalid", "void", "#div/0!", "."];

/// Whether a field says in one of the usual ways that there is no value.
pub fn is_missing(field: &str) -> bool {
    field.chars().all(|sign| "*-".contains(sign)) || MISSING.iter().any(|word| field.eq_ignore_ascii_case(word))
}

/// The number in a field; it may be NaN. Where `decimal_comma`, a comma may stand before the decimals.
pub fn number(field: &str, decimal_comma: bool) -> Option<f64> {
    if let Ok(number) = field.parse() {
        return Some(number);
    }
    let begins = field.starts_with(|letter: char| letter.is_ascii_digit() || "+-.,\u{2212}".contains(letter));
    if !begins {
        return None;
    }
    let plain = field.replace('\u{2212}', "-");
    let plain = if decimal_comma && !plain.contains('.') { plain.replacen(',', ".", 1) } else { plain };
    // FORTRAN's double precision: 1.0D-03.
    plain.parse().or_else(|_| plain.replace(['D', 'd'], "e").parse()).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_as_instruments_write_them() {
        for (text, value) in [("1,5", 1.5), ("-,25", -0.25), ("1.5D-03", 1.5e-3), ("\u{2212}2", -2.0), ("1e5", 1e5)] {
            assert_eq!(number(text, true), Some(value), "{text}");
        }
        for text in ["1.234,5", "1,234,5", "x", "", "E", "d5", "12:30"] {
            assert_eq!(number(text, true), None, "{text}");
        }
        let mut style = NumberStyle::new(true);
        let read = ["1.5", "2", "x", "1,234"].map(|field| style.read(field));
        assert_eq!(read, [Ok(Some(1.5)), Ok(Some(2.0)), Ok(None), Err(MixedDecimals)]);
    }
}
