//! A study as text: a row for each run, what is left open, and what will do.

use asperity::element::PointStatus;
use asperity_study::converge::{ConvergenceStudy, Findings, Open, Pair, Parts, RunRow, Source, Verdict, percent};
use asperity_study::decimals::{decimal, rounded};
use asperity_study::steady::persson::Theory;

use crate::terminal::{LabelledLine, labelled, lines};

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
    let of = |value: fn(&Pair) -> f64| match &run.measured {
        Some(measured) => [
            number(value(&measured.mean)),
            format!("{:.1e}", value(&measured.error)),
            change.map_or_else(String::new, |change| format!("{:+.1} %", 100.0 * value(&change))),
        ],
        None => ["-", "", ""].map(str::to_owned),
    };
    fields.extend(of(|pair| pair.friction));
    fields.extend(of(|pair| pair.area));
    fields.push(seconds(run.run_time));
    if let PointStatus::Problem(problem) = &run.status {
        fields.push(problem.clone());
    }
    fields
}

fn number(value: f64) -> String {
    decimal(rounded(value, 4), 1e-3..1e5)
}

fn seconds(time: f64) -> String {
    format!("{:.*}", if time < 10.0 { 2 } else { 0 }, time)
}

/// Persson's theory, what each source leaves open, the coarsest spacing, and the verdict.
pub(super) fn judgement(study: &ConvergenceStudy, findings: &Findings) -> String {
    let (ladder, verdict) = (findings.ladder(), &findings.verdict);
    let mut all: Vec<LabelledLine> = Vec::new();
    all.extend(ladder.last().and_then(|run| hysteresis(run)).map(|line| ("Hysteresis", line)));
    all.extend(labelled("Persson", ladder.last().iter().flat_map(|run| theories(&run.theories))));
    let no_length = (!study.has_length()).then(|| {
        let name = Source::Length.name();
        format!("{name:<9}not varied: the surface is one period, and there is no more of it")
    });
    all.extend(labelled("Open", verdict.open.iter().map(|open| open_line(open, study.seeds())).chain(no_length)));
    all.extend(labelled("Coarsest", coarsest(&ladder, study.parts(), verdict, study.header().error)));
    all.push(("Verdict", verdict.sentence()));
    lines(&all)
}

/// The part of a run's friction that Persson's theory is of.
fn hysteresis(run: &RunRow) -> Option<String> {
    let measured = run.measured.as_ref()?;
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
