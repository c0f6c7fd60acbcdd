//! Options as the command line has them, in texts of the study, which names them in backquotes: `pressures`.

use std::fmt::Display;

/// The text with `--pressures` for each `` `pressures` ``; what else stands in backquotes stays.
pub(crate) fn with_flags(text: impl Display) -> String {
    let text = text.to_string();
    let is_option = |part: &str| part.starts_with(|c: char| c.is_ascii_lowercase()) && part.bytes().all(is_of_option);
    let quoted = |(i, part): (usize, &str)| match i % 2 {
        0 => part.to_owned(),
        _ if is_option(part) => format!("--{}", part.replace('_', "-")),
        _ => format!("`{part}`"),
    };
    // A backquote without another is none.
    if text.matches('`').count() % 2 == 1 { text } else { text.split('`').enumerate().map(quoted).collect() }
}

fn is_of_option(byte: u8) -> bool {
    byte.is_ascii_lowercase() || byte == b'_'
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_alone_have_dashes() {
        let text = "`most_points`: as `asperity surface --mirror` does, or `points`";
        assert_eq!(with_flags(text), "--most-points: as `asperity surface --mirror` does, or --points");
        assert_eq!(with_flags("a`b: expected `free`"), "a`b: expected `free`");
    }
}
