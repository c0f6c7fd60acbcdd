//! Lines with labels, of which summaries are made.

/// A line with a label; without one it continues the line above.
pub type LabelledLine = (&'static str, String);

/// Lines of which the first has the label.
pub fn labelled(label: &'static str, texts: impl IntoIterator<Item = String>) -> Vec<LabelledLine> {
    texts.into_iter().enumerate().map(|(i, text)| (if i == 0 { label } else { "" }, text)).collect()
}
