//! Numbers as files have them.

/// The shortest decimal that reads back as the same number; far from 1 with an exponent.
pub fn number(value: f64) -> String {
    if value == 0.0 || (1e-4..1e16).contains(&value.abs()) { format!("{value}") } else { format!("{value:e}") }
}

/// The field of a number; empty where there is none.
pub(super) fn cell(value: f64) -> String {
    if value.is_nan() { String::new() } else { number(value) }
}

/// The number of a field, NaN where that is empty; `None` where it is none.
pub(super) fn parsed(field: &str) -> Option<f64> {
    if field.is_empty() { Some(f64::NAN) } else { field.parse().ok().filter(|number: &f64| number.is_finite()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_read_back_as_the_same() {
        for (value, text) in [(0.0, "0"), (1e-5, "1e-5"), (0.1 + 0.2, "0.30000000000000004"), (-2.5e20, "-2.5e20")] {
            assert_eq!((number(value).as_str(), parsed(text)), (text, Some(value)));
        }
        assert!(parsed("").is_some_and(f64::is_nan) && parsed("inf").is_none() && parsed("nan").is_none());
        assert_eq!(cell(f64::NAN), "");
    }
}
