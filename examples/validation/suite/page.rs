//! The page as text.

use super::row::{Claim, Comparison, Entry, Row};
use super::{elastic, reference, road, rough, viscoelastic};
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

/// What no row claims.
const KNOWN: &str = "\
Known beyond the rows:

- The *layer* of a simulation or an FMU is a chain of masses on fitted links. Beside a half-plane its area
  and friction are within 17 and 13 % at 256 masses, within 11 and 10 % at 512; on rough profiles that the
  masses resolve its area is up to 68 % too large, and on slopes of 0.9 its friction up to 2.8 times the
  solver's ([steady.md](steady.md), [performance.md](performance.md)).
- A *period* that is short beside what the rubber remembers costs friction: 18 % where it is 1.6 times
  vτE₀/E_∞, 1.8 % at 6.4 times ([Hunter's cylinder](#a-cylinder-sliding-on-a-standard-linear-solid)).
- The solver closes *gaps* below 10⁻⁷ of the surface's peak to valley. Cylinders here are cut off at four
  half-widths for that: with flanks as high as a period of 50 half-widths makes them, the contact is found 1
  % too wide.
- *Heat* flows along the depth alone: good above 0.1 m/s for contacts of 0.2 mm, 3 to 4 % off below 10 mm/s
  ([Jaeger's strip](#the-flash-temperature-of-a-moving-contact)).
- *Linear* rubber: large strains do not move the normal problem. Of incompressible rubber finite
  strain makes [0.5 % of friction](#friction-near-one-on-a-wave) at peak slopes of 0.3; no row tests a compound that softens.

";

/// The text of docs/validation.md.
pub fn page(made: &[Made]) -> String {
    let mut text = HEAD.to_owned();
    text += &disagreements(made);
    text += KNOWN;
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

/// The error that uses most of its claim, and the claim; of values between bounds alone how many are.
fn summary(comparison: &Comparison) -> [String; 2] {
    let rows = &comparison.rows;
    match comparison.worst() {
        Some(worst) => [error(worst), claim(worst)],
        None if rows.len() == 1 => [format!("{} {}", rows[0].quantity, error(&rows[0])), claim(&rows[0])],
        None => {
            let within = rows.iter().filter(|row| row.agrees()).count();
            [format!("{within} of {} within bounds", rows.len()), "all".to_owned()]
        }
    }
}

/// A comparison whole.
pub fn section(entry: &Entry, comparison: &Comparison) -> String {
    let Entry { title, source, file, .. } = entry;
    let beside = format!("Beside: {source}. Computed by [{file}](../{file}).");
    let mut text = format!("## {title}\n\n{}\n\n{}\n\n", filled(&comparison.about), filled(&beside));
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
        text += &format!("\n{}\n", filled(&comparison.remark));
    }
    text
}

/// In lines of a document's width.
fn filled(text: &str) -> String {
    textwrap::fill(text, textwrap::Options::new(110).break_words(false))
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
const SHOWN: [Entry; 5] = [elastic::CYLINDER, viscoelastic::ROLLING, rough::AREA, reference::CASES, road::LAYER];

/// The README's table: rows of the page.
pub fn readme_table(made: &[Made]) -> String {
    let mut text = "| what | beside | error | claimed |\n|---|---|---|---|\n".to_owned();
    for Entry { title, .. } in SHOWN {
        for (entry, comparison) in made.iter().filter(|(entry, _)| entry.title == title) {
            let [error, claim] = summary(comparison);
            text += &format!("| {title} | {} | {error} | {claim} |\n", entry.reference);
        }
    }
    text
}

/// The README with another table.
pub fn with_table(readme: &str, made: &str) -> String {
    let old = table(readme).expect("the README has its marks");
    let [begin, end] = MARKS;
    readme.replacen(&format!("{begin}{old}{end}"), &format!("{begin}{made}{end}"), 1)
}

/// The README's table.
pub fn table(readme: &str) -> Option<&str> {
    Some(readme.split_once(MARKS[0])?.1.split_once(MARKS[1])?.0)
}

impl Entry {
    /// The comparison made, as the page has it.
    pub fn section(&'static self) -> String {
        section(self, &(self.compare)())
    }
}
