//! The catalogue as a table: a CSV file, a page, and counts on the terminal.

use std::collections::BTreeMap;
use std::fs;

use crate::catalogue::Case;
use crate::common;
use crate::html::{self, Cell};
use crate::judge::{FLOOR, Verdict};
use crate::run;

const HEAD: [&str; 12] = [
    "scene",
    "phrase",
    "method",
    "status",
    "steps",
    "events",
    "rejected",
    "energy_residual",
    "true_error",
    "estimate",
    "run_time",
    "what",
];

/// Writes `extreme.csv` and `extreme.html` below the folder where cargo builds.
pub fn write(verdicts: &[Verdict]) {
    let folder = common::target().join("extreme");
    fs::create_dir_all(&folder).unwrap();
    let mut file = csv::Writer::from_path(folder.join("extreme.csv")).unwrap();
    file.write_record(HEAD).unwrap();
    let rows: Vec<[String; 12]> = verdicts.iter().map(fields).collect();
    rows.iter().for_each(|row| file.write_record(row).unwrap());
    file.flush().unwrap();
    let head = HEAD.map(Cell::from);
    let cell = |(i, text): (usize, &String)| Cell {
        class: if (4..11).contains(&i) { "number" } else { "" }.into(),
        ..Cell::from(text)
    };
    let cells: Vec<Vec<Cell>> = rows.iter().map(|row| row.iter().enumerate().map(cell).collect()).collect();
    let table = html::table(&head, &cells).unwrap();
    let template = include_str!("page.html");
    let page = html::fill(template, &[("table", table), ("count", verdicts.len().to_string())]);
    fs::write(folder.join("extreme.html"), page).unwrap();
    println!("the table: {}", folder.join("extreme.html").display());
}

fn fields(verdict: &Verdict) -> [String; 12] {
    let number = |value: f64| if value.is_nan() { String::new() } else { format!("{value:.2e}") };
    let count = |value: f64| format!("{value:.0}");
    let findings = verdict.findings.iter().map(|finding| format!("{}: {}", finding.rule, finding.text));
    let status = match (&verdict.error, verdict.findings.is_empty()) {
        (None, true) => "kept",
        (Some(_), true) => "stopped with a reason",
        (_, false) => "finding",
    };
    [
        verdict.case.clone(),
        verdict.phrase.clone(),
        verdict.way.name().into(),
        status.into(),
        count(verdict.steps),
        count(verdict.events),
        count(verdict.rejected),
        number(verdict.residual),
        number(verdict.true_error),
        number(verdict.estimate),
        number(verdict.time),
        verdict.error.clone().into_iter().chain(findings).collect::<Vec<_>>().join("; "),
    ]
}

/// Writes the scene files of the findings below `extreme/scenes`, for the program.
pub fn write_scenes(cases: &[Case], verdicts: &[Verdict]) {
    let folder = common::target().join("extreme/scenes");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    for case in cases {
        let found = verdicts.iter().find(|verdict| verdict.case == case.name && !verdict.findings.is_empty());
        let Some(verdict) = found else { continue };
        let method = if verdict.way.name().starts_with("event") { "event" } else { "step" };
        let letter = |letter: char| if letter.is_alphanumeric() { letter } else { '-' };
        let name: String = case.name.chars().map(letter).take(80).collect();
        fs::write(folder.join(name + ".toml"), run::scene_text(case, method, 1.0)).unwrap();
    }
}

/// How many scenes and runs there were, by phrase.
pub fn print_counts(cases: &[Case], verdicts: &[Verdict]) {
    let mut phrases: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    cases.iter().for_each(|case| phrases.entry(&case.phrase).or_default().0 += 1);
    verdicts.iter().for_each(|verdict| phrases.entry(&verdict.phrase).or_default().1 += 1);
    let fmu = verdicts.iter().filter(|verdict| verdict.way.is_fmu()).count();
    println!("{} scenes, {} runs, {fmu} of them through the C interface", cases.len(), verdicts.len());
    for (phrase, (scenes, runs)) in phrases {
        println!("{scenes:5} scenes {runs:5} runs  {phrase}");
    }
}

/// How the estimated error compares with the true one.
pub fn print_ratios(verdicts: &[Verdict]) {
    let both = verdicts.iter().filter(|verdict| verdict.true_error.is_finite() && verdict.error.is_none());
    let mut ratios: Vec<(f64, &Verdict)> = both.map(|verdict| (ratio(verdict), verdict)).collect();
    ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
    if ratios.is_empty() {
        return;
    }
    let within = ratios.iter().filter(|(ratio, _)| (0.1..=10.0).contains(ratio)).count();
    let quantile = |share: f64| ratios[((ratios.len() - 1) as f64 * share).round() as usize].0;
    println!(
        "solver.error over the true error, {} runs: {:.1} % within ten",
        ratios.len(),
        100.0 * within as f64 / ratios.len() as f64
    );
    for share in [0.0, 0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99, 1.0] {
        println!("  quantile {share:4}: {:.1e}", quantile(share));
    }
    for (ratio, verdict) in ratios.iter().take(12).chain(ratios.iter().rev().take(6)) {
        println!(
            "  {ratio:.1e}: {} [{}], true {:.1e}, estimated {:.1e}",
            verdict.case,
            verdict.way.name(),
            verdict.true_error,
            verdict.estimate
        );
    }
}

/// Estimate over true error; both below the floor count as equal.
fn ratio(verdict: &Verdict) -> f64 {
    verdict.estimate.max(FLOOR) / verdict.true_error.max(FLOOR)
}
