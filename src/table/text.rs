//! Numbers and fields as files have them.

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

/// A word as one field: in quotation marks where it needs them, line ends replaced by blanks.
pub(super) fn quoted(word: &str) -> String {
    let word = word.replace(['\n', '\r'], " ");
    if word.contains([',', '"']) { format!("\"{}\"", word.replace('"', "\"\"")) } else { word }
}

/// The fields of a line, without blanks around them. One in quotation marks may hold commas, and quotation marks
/// doubled.
pub(super) fn fields(line: &str) -> Vec<String> {
    let (mut all, mut field, mut is_quoted) = (Vec::new(), String::new(), false);
    let mut letters = line.chars().peekable();
    while let Some(letter) = letters.next() {
        match letter {
            '"' if is_quoted && letters.next_if_eq(&'"').is_some() => field.push('"'),
            // They open at the start of a field alone.
            '"' if is_quoted || field.trim().is_empty() => is_quoted = !is_quoted,
            ',' if !is_quoted => all.push(std::mem::take(&mut field).trim().to_owned()),
            letter => field.push(letter),
        }
    }
    all.push(field.trim().to_owned());
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_in_quotes_hold_commas_and_quotes() {
        assert_eq!(fields(r#"1, "a, ""b""" ,,5" c"#), ["1", r#"a, "b""#, "", r#"5" c"#]);
        assert_eq!((fields(""), fields(&quoted("a, \"b\"\nc"))), (vec![String::new()], vec!["a, \"b\" c".to_owned()]));
    }

    #[test]
    fn numbers_are_short_and_read_back_as_the_same() {
        for (value, text) in [(0.0, "0"), (1e-5, "1e-5"), (0.1 + 0.2, "0.30000000000000004"), (-2.5e20, "-2.5e20")] {
            assert_eq!((number(value).as_str(), parsed(text)), (text, Some(value)));
        }
        assert!(parsed("").is_some_and(f64::is_nan) && parsed("inf").is_none() && parsed("nan").is_none());
        assert_eq!(cell(f64::NAN), "");
    }
}
