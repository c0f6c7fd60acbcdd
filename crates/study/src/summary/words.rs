//! Lines, words and numbers of a summary.

use asperity::scene::{Parameter, Scene, Value};

use crate::decimals::{decimal, rounded};

/// A line with a label; without one it continues the line above.
pub type LabelledLine = (&'static str, String);

/// Lines of which the first has the label.
pub fn labelled(label: &'static str, texts: impl IntoIterator<Item = String>) -> Vec<LabelledLine> {
    texts.into_iter().enumerate().map(|(i, text)| (if i == 0 { label } else { "" }, text)).collect()
}

/// Stands for what the scene does not give.
pub(super) const LEFT_OUT: &str = "left out";

/// A number for reading: five digits, as of 293.15 K.
pub(super) fn number(value: f64) -> String {
    decimal(rounded(value, 5), 1e-3..1e6)
}

/// The same with six digits.
pub(super) fn six_digits(value: f64) -> String {
    decimal(rounded(value, 6), 1e-3..1e6)
}

pub(super) fn or_left_out(value: Option<f64>, unit: &str) -> String {
    value.map_or_else(|| LEFT_OUT.into(), |value| format!("{}{unit}", number(value)))
}

/// The word that the scene file has for `parameter`.
pub(super) fn word(scene: &Scene, parameter: Parameter) -> String {
    match scene.parameter(parameter) {
        Value::Text(word) => word,
        other => other.to_string(),
    }
}

/// Lines that begin with a name each; the name of an earlier one in place of lines that are the same.
pub(super) fn each_once(parts: impl IntoIterator<Item = (&'static str, Vec<String>)>) -> Vec<String> {
    let mut said: Vec<(&'static str, Vec<String>)> = Vec::new();
    let mut rows = Vec::new();
    for (name, lines) in parts {
        match said.iter().find(|(_, earlier)| *earlier == lines && lines != [LEFT_OUT]) {
            Some((earlier, _)) if !lines.is_empty() => rows.push(format!("{name:<12}as {earlier}")),
            _ => {
                let heads = std::iter::once(name).chain(std::iter::repeat(""));
                rows.extend(heads.zip(&lines).map(|(head, line)| format!("{head:<12}{line}")));
                said.push((name, lines));
            }
        }
    }
    rows
}

/// What is said of the fluid where there is none.
pub(super) const DRY: &str = "none: the contact is dry (a lip with a film: --seal)";
