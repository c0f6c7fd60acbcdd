//! A study as text: a row for each run, what is left open, and what will do.

use super::table::RunRow;
use super::variants::Parts;
use super::verdict::{LargestOpen, Open, Pair, Source, Verdict};
use crate::terminal::{LabelledLine, labelled, lines};
use asperity_study::decimals::{decimal, rounded};
use asperity_study::steady::persson::Theory;

/// Titles of the columns after what is counted.
const TITLES: [&str; 12] = [
    "spacing, m",
    "length, m",
    "seed",
    "split, m",
    "r rms",
    "friction",
    "std. error",
    "change",
    "area",
    "std. error",
    "change",
    "time, s",
];

/// The columns that runs without links and without scatter do not have.
const OF_LAYER: [&str; 2] = ["r rms", "std. error"];

/// The runs, each with the change of its values from the one that it is compared with.
pub(super) type Rows<'a> = [(&'a RunRow, Option<Pair>)];

/// The rows as a table with a line for each.
pub(super) fn table(rows: &Rows<'_>, parts: Parts) -> String {
    let titles: Vec<&str> = std::iter::once(parts.name()).chain(TITLES).collect();
    let is_shown = |i: usize| parts == Parts::Masses || titles.get(i).is_none_or(|title| !OF_LAYER.contains(title));
    let shown = |row: Vec<String>| -> Vec<String> {
        row.into_iter().enumerate().filter(|(i, _)| is_shown(*i)).map(|(_, cell)| cell).collect()
    };
    let mut cells = vec![shown(titles.iter().map(|&title| title.to_owned()).collect())];
    let count = cells[0].len();
    cells.extend(rows.iter().map(|(run, change)| shown(fields(run, *change))));
    let widths: Vec<usize> = (0..count)
        .map(|i| cells.iter().filter_map(|row| row.get(i)).map(|cell| cell.chars().count()).max().unwrap_or_default())
        .collect();
    let line = |row: &Vec<String>| {
        let padded: Vec<String> = row.iter().zip(&widths).map(|(cell, &width)| format!("{cell:>width$}")).collect();
        // The status of a run that is not steady takes the place of its values.
        let status = row.get(count).map(|status| format!("  {status}")).unwrap_or_default();
        padded.join("  ").trim_end().to_owned() + &status + "\n"
    };
    cells.iter().map(line).collect()
}

fn fields(run: &RunRow, change: Option<Pair>) -> Vec<String> {
    let dimensions = &run.dimensions;
    let mut fields = vec![
        dimensions.count.to_string(),
        number(dimensions.spacing),
        number(dimensions.length()),
        dimensions.seed.map_or_else(|| "-".into(), |seed| seed.to_string()),
        dimensions.split.map_or_else(|| "-".into(), number),
        run.fit_rms.map_or_else(String::new, |fit_rms| format!("{fit_rms:.3}")),
    ];
    let of = |value: fn(&Pair) -> f64| match &run.outcome {
        Ok(measured) => [
            number(value(&measured.mean)),
            format!("{:.1e}", value(&measured.error)),
            change.map_or_else(String::new, |change| format!("{:+.1} %", 100.0 * value(&change))),
        ],
        Err(_) => ["-", "", ""].map(str::to_owned),
    };
    fields.extend(of(|pair| pair.friction));
    fields.extend(of(|pair| pair.area));
    fields.push(seconds(run.run_time));
    fields.extend(run.outcome.as_ref().err().cloned());
    fields
}

fn number(value: f64) -> String {
    decimal(rounded(value, 4), 1e-3..1e5)
}

fn seconds(time: f64) -> String {
    format!("{:.*}", if time < 10.0 { 2 } else { 0 }, time)
}

fn percent(share: f64) -> String {
    format!("{} %", decimal(rounded(100.0 * share, 2), 1e-3..1e6))
}

/// Persson's theory, what each source leaves open, the coarsest spacing, and the verdict. `ladder` holds the runs with
/// the scene's length and seed.
pub(super) fn judgement(ladder: &[&RunRow], parts: Parts, verdict: &Verdict, error: f64, seeds: Option<u32>) -> String {
    let mut all: Vec<LabelledLine> = Vec::new();
    all.extend(ladder.last().and_then(|run| hysteresis(run)).map(|line| ("Hysteresis", line)));
    all.extend(labelled("Persson", ladder.last().iter().flat_map(|run| theories(&run.theories))));
    all.extend(labelled("Open", verdict.open.iter().map(|open| open_line(open, seeds))));
    all.extend(labelled("Coarsest", coarsest(ladder, parts, verdict, error)));
    all.push(("Verdict", sentence(verdict, error)));
    lines(&all)
}

/// The part of a run's friction that Persson's theory is of.
fn hysteresis(run: &RunRow) -> Option<String> {
    let measured = run.outcome.as_ref().ok()?;
    let (part, whole) = (number(measured.hysteresis), number(measured.mean.friction));
    Some(format!("{part} of the friction of {whole} at the finest spacing: the part that Persson's theory is of"))
}

fn theories(theories: &[Theory; 2]) -> [String; 2] {
    let line = |theory: &Theory, surface: &str| {
        let [area, friction, reduced] = theory.values().map(number);
        format!("area {area}, hysteresis {reduced} to {friction}: {surface}, an orientation")
    };
    [line(&theories[0], "ridges across the motion"), line(&theories[1], "an isotropic surface of this profile")]
}

fn open_line(open: &Open, seeds: Option<u32>) -> String {
    let name = open.source.name();
    let Some(shares) = open.shares else { return format!("{name:<9}not known: a run is missing or not steady") };
    let of = match open.source {
        Source::Spacing => "the last change; an area is of first order, as much again is left of it".to_owned(),
        Source::Length => "the change with twice the length".to_owned(),
        Source::Split => {
            "the change with the profile down to half its shortest wave and the finer ones from there".into()
        }
        Source::Chance => format!("the standard deviation over {} seeds", seeds.unwrap_or_default()),
    };
    format!("{name:<9}friction {}, area {}: {of}", percent(shares.friction), percent(shares.area))
}

fn coarsest(ladder: &[&RunRow], parts: Parts, verdict: &Verdict, error: f64) -> [String; 2] {
    let line = |name: &str, halvings: Option<usize>| {
        let Some(run) = halvings.and_then(|halvings| ladder.get(halvings)) else {
            return format!("{name:<9}none of these spacings is within {}", percent(error));
        };
        let times = [Some(run), ladder.first(), ladder.last()].map(|run| run.map_or(0.0, |run| run.run_time));
        let [own, first, last] = times.map(seconds);
        let (parts, count, spacing) = (parts.name(), run.dimensions.count, number(run.dimensions.spacing));
        format!(
            "{name:<9}{parts} = {count}, spacing = {spacing} m within {}: {own} s (the scene's own {first} s, the finest \
             {last} s)",
            percent(error)
        )
    };
    [line("friction", verdict.coarsest[0]), line("area", verdict.coarsest[1])]
}

/// The verdict in a sentence.
pub(super) fn sentence(verdict: &Verdict, error: f64) -> String {
    let start = if verdict.is_converged() { "converged" } else { "not converged" };
    match verdict.largest() {
        Some(LargestOpen { source, share: Some((quantity, share)) }) => {
            let against = if share <= error { "within" } else { "more than" };
            let (name, share, error) = (source.name(), percent(share), percent(error));
            format!("{start}: {name} leaves most open, {share} of the {quantity}, {against} {error}")
        }
        Some(LargestOpen { source, share: None }) => {
            format!("{start}: what {} leaves open is not known", source.name())
        }
        None => start.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::verdict::Study;
    use super::*;

    #[test]
    fn the_verdict_names_what_leaves_most_open() {
        let pair = |friction: f64, area: f64| Pair { friction, area };
        let ladder = vec![pair(0.5, 0.102), pair(0.5, 0.1)];
        let study = Study { ladder, length: Some(Some(pair(0.5, 0.1))), split: None, seeds: None };
        assert_eq!(
            sentence(&Verdict::new(&study, 0.05), 0.05),
            "converged: spacing leaves most open, 2 % of the area, within 5 %"
        );
        assert_eq!(
            sentence(&Verdict::new(&study, 0.01), 0.01),
            "not converged: spacing leaves most open, 2 % of the area, more than 1 %"
        );
        let study = Study { length: Some(None), ..study };
        assert_eq!(sentence(&Verdict::new(&study, 0.05), 0.05), "not converged: what length leaves open is not known");
    }
}
