//! The page as text.

use super::row::{Claim, Comparison, Entry, Row};
use asperity_study::decimals::{percent, short};

/// Comparisons with what came out of them, in the order of the page.
pub type Made = (&'static Entry, Comparison);

const HEAD: &str = "\
# What to trust, and how far

What asperity computes, beside closed solutions, independent programs and published values. The reference solutions
were written for this page and share no code with what they are compared with. `cargo run --release --example
validation` makes the page and its pictures; the comparisons marked with * are made anew by every test run, which fails
where a figure here is no longer what comes out.

";

/// The text of docs/validation.md.
pub fn page(made: &[Made]) -> String {
    let mut text = HEAD.to_owned();
    text += &disagreements(made);
    text += "## Overview\n\n| what | beside | error | claimed | agrees |\n|---|---|---|---|---|\n";
    made.iter().for_each(|(entry, comparison)| text += &overview(entry, comparison));
    made.iter().for_each(|(entry, comparison)| text += &format!("\n{}", section(entry, comparison)));
    text
}

/// What does not agree comes first.
fn disagreements(made: &[Made]) -> String {
    let mut text = "## What does not agree\n\n".to_owned();
    let before = text.len();
    for (entry, comparison) in made {
        for row in comparison.rows.iter().filter(|row| !row.agrees()) {
            let beside = match row.claim {
                Claim::Between(..) => format!("not {}", expected(row)),
                _ => format!("for {}, off by {}, claimed {}", expected(row), error(row), claim(row)),
            };
            text += &format!("- **{}**, {}: {} {beside}. ", entry.title, row.quantity, value(row.found, row.unit));
            text += &format!("{}\n", link(entry));
        }
    }
    if text.len() == before {
        text += "Every row below agrees within what it claims.\n";
    }
    text + "\n"
}

fn link(entry: &Entry) -> String {
    format!("[Why](#{})", anchor(entry.title))
}

/// As mdBook and GitHub name a heading.
fn anchor(title: &str) -> String {
    let kept = title.chars().filter(|c| c.is_alphanumeric() || *c == ' ' || *c == '-' || *c == '_');
    kept.collect::<String>().to_lowercase().replace(' ', "-")
}

fn overview(entry: &Entry, comparison: &Comparison) -> String {
    let [error, claim] = summary(comparison);
    let star = if entry.quick { " *" } else { "" };
    let agrees = if comparison.agrees() { "yes" } else { "**no**" };
    let Entry { title, reference, .. } = entry;
    format!("| [{title}](#{}){star} | {reference} | {error} | {claim} | {agrees} |\n", anchor(title))
}

/// The error that uses most of its claim, and the claim.
fn summary(comparison: &Comparison) -> [String; 2] {
    let worst = comparison.worst();
    [error(worst), claim(worst)]
}

/// A comparison whole.
pub fn section(entry: &Entry, comparison: &Comparison) -> String {
    let Entry { title, source, file, .. } = entry;
    let mut text =
        format!("## {title}\n\n{}\n\nBeside: {source}. Computed by [{file}](../{file}).\n\n", comparison.about);
    text += "| quantity | expected | found | error | claimed | agrees |\n|---|---|---|---|---|---|\n";
    for row in &comparison.rows {
        let (expected, found) = (expected(row), value(row.found, row.unit));
        let agrees = if row.agrees() { "yes" } else { "**no**" };
        text += &format!("| {} | {expected} | {found} | {} | {} | {agrees} |\n", row.quantity, error(row), claim(row));
    }
    for picture in &comparison.pictures {
        text += &format!("\n![{}](validation/{})\n", picture.caption, picture.file);
    }
    if !comparison.remark.is_empty() {
        text += &format!("\n{}\n", comparison.remark);
    }
    text
}

fn value(value: f64, unit: &str) -> String {
    let number = short(value, 5);
    if unit.is_empty() { number } else { format!("{number} {unit}") }
}

fn expected(row: &Row) -> String {
    match row.claim {
        Claim::Between(low, high) => format!("{} to {}", short(low, 5), value(high, row.unit)),
        _ => value(row.expected, row.unit),
    }
}

/// Roundings differ from processor to processor.
const ROUNDING: f64 = 1e-9;

fn error(row: &Row) -> String {
    match (row.claim, row.error()) {
        (Claim::Between(..), _) => value(row.found, row.unit),
        (_, error) if error < ROUNDING => "below 1e-9".to_owned(),
        (_, error) => part(error, 2),
    }
}

fn claim(row: &Row) -> String {
    match row.claim {
        Claim::Share(share) => part(share, 2),
        Claim::Of(_, share) => format!("{} of the whole", part(share, 2)),
        Claim::Between(..) => expected(row),
    }
}

fn part(share: f64, digits: usize) -> String {
    if share >= 1e-4 { percent(share, digits) } else { short(share, digits) }
}

/// Between these lines of the README.
const MARKS: [&str; 2] = ["<!-- from docs/validation.md -->\n", "<!-- end -->\n"];

/// The titles of the README's rows.
const SHOWN: [&str; 5] = ["", "", "", "", ""];

/// The README's table: rows of the page.
pub fn readme_table(made: &[Made]) -> String {
    let mut text = "| what | beside | error | claimed |\n|---|---|---|---|\n".to_owned();
    for title in SHOWN {
        for (entry, comparison) in made.iter().filter(|(entry, _)| entry.title == title) {
            let [error, claim] = summary(comparison);
            text += &format!("| {title} | {} | {error} | {claim} |\n", entry.reference);
        }
    }
    text
}

/// The README with another table.
pub fn with_table(readme: &str, table: &str) -> String {
    let Some((before, rest)) = readme.split_once(MARKS[0]) else { return readme.to_owned() };
    let Some((_, after)) = rest.split_once(MARKS[1]) else { return readme.to_owned() };
    format!("{before}{}{table}{}{after}", MARKS[0], MARKS[1])
}

impl Entry {
    /// The comparison made, as the page has it.
    pub fn section(&'static self) -> String {
        section(self, &(self.compare)())
    }
}
