//! Numbers as people and instruments write them, and words for those that are missing.
//!
//! A number may have decimals behind a point or a comma, and signs between thousands: blanks of all kinds, apostrophes, and
//! the other one of point and comma, where they group by threes throughout.

/// The sign before decimals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Decimal {
    /// 1.5
    Point,
    /// 1,5
    Comma,
}

/// Words for a value that is not there.
const MISSING: [&str; 12] =
    ["nan", "n/a", "na", "#n/a", "null", "none", "bad", "missing", "invalid", "void", "#div/0!", "."];

/// Whether a field says in one of the usual ways that there is no value.
pub fn is_missing(field: &str) -> bool {
    field.chars().all(|sign| "*-".contains(sign)) || MISSING.iter().any(|word| field.eq_ignore_ascii_case(word))
}

/// Whether a field is a number, whatever sign stands before its decimals; also one in per cent.
pub fn is_number(field: &str) -> bool {
    let field = field.strip_suffix('%').map_or(field, str::trim_end);
    Decimal::Point.read(field).is_some() || Decimal::Comma.read(field).is_some()
}

/// The number in a field that stands by itself, in a line of settings: with a point or a comma before its decimals.
pub fn number(field: &str) -> Option<f64> {
    let plain = if field.contains('.') { field.to_owned() } else { field.replacen(',', ".", 1) };
    Decimal::Point.read(&plain)
}

impl Decimal {
    /// The number in a field, if it is one; it may be NaN.
    pub fn read(self, field: &str) -> Option<f64> {
        if self == Self::Point
            && let Ok(number) = field.parse()
        {
            return Some(number);
        }
        let begins = field.starts_with(|letter: char| letter.is_ascii_digit() || "+-.,\u{2212}".contains(letter));
        if !begins {
            return None;
        }
        let field = field.replace('\u{2212}', "-");
        // FORTRAN's double precision: 1.0D-03.
        let end = field.find(['e', 'E', 'd', 'D']).unwrap_or(field.len());
        let (mantissa, exponent) = field.split_at(end);
        let sign = if self == Self::Point { '.' } else { ',' };
        let (whole, decimals) = mantissa.split_once(sign).map_or((mantissa, None), |(whole, rest)| (whole, Some(rest)));
        let whole = without_groups(whole, if sign == '.' { ',' } else { '.' }, exponent.is_empty())?;
        let decimals = decimals.map_or_else(String::new, |digits| format!(".{digits}"));
        format!("{whole}{decimals}{}", exponent.replace(['d', 'D'], "e")).parse().ok()
    }
}

/// The digits before the decimals without signs between thousands; `None` where such do not group by threes.
fn without_groups(whole: &str, other: char, may_group: bool) -> Option<String> {
    let is_sign = |letter: char| letter == other || "'\u{2019}\u{a0}\u{202f}\u{2009} ".contains(letter);
    let Some(sign) = whole.chars().find(|letter| is_sign(*letter)) else { return Some(whole.to_owned()) };
    let digits = whole.trim_start_matches(['-', '+']);
    let mut groups = digits.split(sign);
    let first = groups.next().unwrap_or_default();
    let all_digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let is_first = first.len() <= 3 && all_digits(first) && !first.starts_with('0');
    let grouped = may_group && is_first && groups.all(|group| group.len() == 3 && all_digits(group));
    grouped.then(|| whole.replace(sign, ""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_as_instruments_write_them() {
        use Decimal::{Comma, Point};
        for (text, decimal, value) in [
            ("1,5", Comma, 1.5),
            ("-,25", Comma, -0.25),
            ("1.5D-03", Point, 1.5e-3),
            ("\u{2212}2", Point, -2.0),
            ("1e5", Comma, 1e5),
            ("4 869.6", Point, 4869.6),
            ("4\u{a0}869,6", Comma, 4869.6),
            ("-12\u{202f}345", Point, -12345.0),
            ("4'869.6", Point, 4869.6),
            ("1.234.567,8", Comma, 1234567.8),
            ("1,234,567.8", Point, 1234567.8),
        ] {
            assert_eq!(decimal.read(text), Some(value), "{text}");
        }
        for text in ["x", "", "E", "d5", "12:30", "1 2", "0 123", "12 34", "1'234 567", "1 234e5", "5,5,5"] {
            assert!(!is_number(text), "{text}");
        }
    }
}
