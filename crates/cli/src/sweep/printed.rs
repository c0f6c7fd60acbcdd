//! The friction of a table as lines of text: a line for each speed, a column for each load, a block for each
//! temperature; and what there is in its samples.

use asperity::element::{PointStatus, Quantity};

use crate::terminal::{LabelledLine, labelled};
use asperity_study::decimals::{as_given, rounded, with_prefix};
use asperity_study::sweep::{Matters, Sampled, SweepRow, SweepTable};

/// Most speeds and most loads that are printed: a terminal's worth.
const MOST: (usize, usize) = (60, 7);
/// Characters of a column.
const WIDTH: usize = 12;
/// Behind friction that cannot be relied on, ...
const NOT_STEADY: char = '*';
/// ... and behind that of full contact.
const FULL_CONTACT: char = '+';

/// Friction over speed and load; none of a table too large to be read in a terminal.
pub(super) fn lines(table: &SweepTable) -> Vec<LabelledLine> {
    let (grid, unit) = (&table.header.grid, table.header.load.unit());
    if grid.speeds.len() > MOST.0 || grid.loads.len() > MOST.1 {
        return Vec::new();
    }
    let temperatures: Vec<Option<f64>> = match grid.temperatures.as_slice() {
        [] => vec![None],
        values => values.iter().copied().map(Some).collect(),
    };
    let mut texts: Vec<String> = Vec::new();
    for temperature in temperatures {
        let of_block = || table.rows.iter().filter(move |row| row.point.temperature == temperature);
        let title = temperature.map_or_else(|| "speed".to_owned(), |kelvin| format!("{kelvin} K"));
        texts.push(columns(title, grid.loads.iter().map(|&load| as_given(load, unit))));
        for &speed in &grid.speeds {
            let friction = |&load: &f64| {
                let found = of_block().find(|row| row.point.speed == speed && row.point.load == load);
                found.map_or_else(String::new, friction)
            };
            texts.push(columns(with_prefix(speed, speed, "m/s"), grid.loads.iter().map(friction)));
        }
    }
    let has = |status: fn(&PointStatus) -> bool| table.rows.iter().any(|row| status(&row.status));
    if has(|status| !status.is_result()) {
        texts.push(format!("{NOT_STEADY} not steady"));
    }
    if has(|status| *status == PointStatus::FullContact) {
        texts.push(format!(
            "{FULL_CONTACT} full contact: friction and area, but no stiffness; serves a patch with a backing"
        ));
    }
    labelled("Friction", texts)
}

fn friction(row: &SweepRow) -> String {
    let value = row.value(Quantity::Friction).map_or_else(|| "-".to_owned(), |value| rounded(value, 4).to_string());
    match row.status {
        PointStatus::Steady => value,
        PointStatus::FullContact => format!("{value}{FULL_CONTACT}"),
        PointStatus::Problem(_) => format!("{value}{NOT_STEADY}"),
    }
}

fn columns(first: String, others: impl Iterator<Item = String>) -> String {
    let columns: String = others.map(|text| format!("{text:<WIDTH$}")).collect();
    format!("{first:<WIDTH$}{columns}").trim_end().to_owned()
}

/// What there is in the samples of a table.
pub(super) fn samples(table: &SweepTable, matters: &Matters) -> Vec<LabelledLine> {
    let mut said = Vec::from_iter(table.header.samples.map(|samples| {
        let anew = if samples.redrawn == 0 { String::new() } else { format!(", {} drawn anew", samples.redrawn) };
        ("Samples", format!("{} of seed {}{anew}; friction's quantiles are in the table", samples.count, samples.seed))
    }));
    said.extend(widest(table));
    said.extend(matters_lines(matters));
    said
}

/// The band of friction where it is widest over its median.
fn widest(table: &SweepTable) -> Option<LabelledLine> {
    let band = |row: &SweepRow| {
        let [low, median, high] = [0.05, 0.5, 0.95].map(|p| row.samples.as_ref()?.quantile(Sampled::Friction, p));
        let (low, median, high) = (low?, median?, high?);
        Some(((high - low) / median.max(f64::MIN_POSITIVE), [low, median, high], row.point))
    };
    let (_, [low, median, high], point) =
        table.rows.iter().filter_map(band).max_by(|one, other| one.0.total_cmp(&other.0))?;
    let [low, median, high] = [low, median, high].map(|friction| rounded(friction, 3));
    let at = point.describe(table.header.load);
    Some(("Widest", format!("{low} to {high} in 90 % of the samples, median {median}, at {at}")))
}

/// Letters of the longest bar.
const LONGEST: f64 = 30.0;

/// A line with a bar for each key and what is left.
fn matters_lines(matters: &Matters) -> Vec<LabelledLine> {
    let Some(mean) = &matters.mean else {
        return vec![("Matters", "not known: more samples are needed than there are numbers to draw".to_owned())];
    };
    let largest = matters.largest();
    let width =
        largest.iter().map(|(name, _)| name.chars().count()).chain([matters.rest.len()]).max().unwrap_or_default();
    let bar = |share: f64| "\u{2588}".repeat((LONGEST * share.min(1.0)).round() as usize);
    let of_key = largest.iter().map(|(name, index)| {
        format!("{name:<width$}  {:>4.0} % ± {:<3.0} {}", 100.0 * index.share, 100.0 * index.error, bar(index.share))
    });
    let rest = format!("{:<width$}  {:>4.0} %       {}", matters.rest, 100.0 * mean.rest, bar(mean.rest));
    labelled("Matters", of_key.chain([rest]).map(|line| line.trim_end().to_owned()))
}
