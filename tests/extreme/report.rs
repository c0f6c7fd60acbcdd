//! The catalogue as a table: a CSV file, a page, and counts on the terminal.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;

use crate::catalogue::Case;
use crate::common;
use crate::html::{self, Cell};
use crate::judge::Verdict;
use crate::run;

const HEAD: [&str; 13] = [
    "scene",
    "phrase",
    "item",
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
    let rows: Vec<[String; 13]> = verdicts.iter().map(fields).collect();
    rows.iter().for_each(|row| file.write_record(row).unwrap());
    file.flush().unwrap();
    fs::write(folder.join("extreme.html"), page(verdicts, &rows)).unwrap();
    println!("the table: {}", folder.join("extreme.html").display());
}

/// The table as a page, phrase by phrase.
fn page(verdicts: &[Verdict], rows: &[[String; 13]]) -> String {
    const SHOWN: [&str; 11] = [
        "scene",
        "item",
        "method",
        "status",
        "steps",
        "rejected",
        "energy residual",
        "true error",
        "estimate",
        "s",
        "what",
    ];
    let kind = |i: usize, text: &str| match (i, text) {
        (4, "finding") => "finding",
        (4, "stopped with a reason") => "stopped",
        (5..=11, _) => "number",
        _ => "",
    };
    let cell = |(i, text): (usize, &String)| Cell { class: kind(i, text).into(), ..Cell::from(text) };
    // The phrase stands above its rows; events are in the file alone.
    let shown = |i: usize| i != 1 && i != 6;
    let line = |row: &[String; 13]| row.iter().enumerate().filter(|(i, _)| shown(*i)).map(cell).collect::<Vec<_>>();
    let mut lines = Vec::new();
    for (i, row) in rows.iter().enumerate() {
        if i == 0 || rows[i - 1][1] != row[1] {
            lines.push(vec![Cell { class: "phrase".into(), span: SHOWN.len(), ..Cell::from(&row[1]) }]);
        }
        lines.push(line(row));
    }
    let head: Vec<Cell> = SHOWN
        .into_iter()
        .enumerate()
        .map(|(i, name)| Cell { class: if (4..=9).contains(&i) { "number" } else { "" }.into(), ..Cell::from(name) })
        .collect();
    let table = html::table(&head, &lines).unwrap();
    html::fill(include_str!("page.html"), &[("summary", summary(verdicts)), ("table", table)])
}

/// The counts in a sentence.
fn summary(verdicts: &[Verdict]) -> String {
    let scenes: BTreeSet<&str> = verdicts.iter().map(|verdict| verdict.case.as_str()).collect();
    let count = |of: &dyn Fn(&Verdict) -> bool| verdicts.iter().filter(|verdict| of(verdict)).count();
    let fmu = count(&|verdict| verdict.way.is_fmu());
    let found = count(&|verdict| !verdict.findings.is_empty());
    let stopped = count(&|verdict| verdict.error.is_some() && verdict.findings.is_empty());
    let tried: f64 = verdicts.iter().map(|verdict| verdict.steps + verdict.rejected).sum();
    format!(
        "{} scenes, {} runs, {fmu} of them through the C interface, {:.1} million steps tried: {} kept all that must hold, \
         {stopped} stopped with a reason that is right, {found} have findings",
        scenes.len(),
        verdicts.len(),
        tried / 1e6,
        verdicts.len() - stopped - found,
    )
}

fn fields(verdict: &Verdict) -> [String; 13] {
    let number = |value: f64| match value {
        value if value.is_nan() => String::new(),
        0.0 => "0".into(),
        value => format!("{value:.1e}"),
    };
    let count = |value: f64| format!("{value:.0}");
    let findings = verdict.findings.iter().map(|finding| format!("{}: {}", finding.rule, finding.text));
    let reason = (!verdict.reason.is_empty()).then(|| verdict.reason.clone());
    let status = match (&verdict.error, verdict.findings.is_empty()) {
        (None, true) => "kept",
        (Some(_), true) => "stopped with a reason",
        (_, false) => "finding",
    };
    [
        verdict.case.clone(),
        verdict.phrase.clone(),
        verdict.item.clone(),
        verdict.way.name().into(),
        status.into(),
        count(verdict.steps),
        count(verdict.events),
        count(verdict.rejected),
        number(verdict.residual),
        number(verdict.true_error),
        number(verdict.estimate),
        number(verdict.time),
        verdict
            .error
            .iter()
            .map(|error| error.text.clone())
            .chain(reason)
            .chain(findings)
            .collect::<Vec<_>>()
            .join("; "),
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

/// Writes what does not hold below `extreme/known.toml`, as `data/known.toml` lists it.
pub fn write_findings(verdicts: &[Verdict]) {
    let entry = |verdict: &Verdict| {
        let rules: Vec<&str> = verdict.findings.iter().map(|finding| finding.rule).collect();
        let seen: Vec<&str> = verdict.findings.iter().map(|finding| finding.text.as_str()).collect();
        let (case, way) = (&verdict.case, verdict.way.name());
        let (rules, seen) = (rules.join(" "), seen.join("; "));
        format!("\n[[finding]]\nscene = {case:?}\nway = {way:?}\nrules = {rules:?}\nseen = {seen:?}\n")
    };
    let found = verdicts.iter().filter(|verdict| !verdict.findings.is_empty());
    let text: String = found.map(entry).collect();
    fs::write(common::target().join("extreme/known.toml"), text).unwrap();
}

/// How many scenes and runs there were, by phrase and item.
pub fn print_counts(cases: &[Case], verdicts: &[Verdict]) {
    let mut items: BTreeMap<(&str, &str), (usize, usize)> = BTreeMap::new();
    cases.iter().for_each(|case| items.entry((&case.phrase, &case.item)).or_default().0 += 1);
    verdicts.iter().for_each(|verdict| items.entry((&verdict.phrase, &verdict.item)).or_default().1 += 1);
    println!("{}", summary(verdicts));
    for ((phrase, item), (scenes, runs)) in items {
        println!("{scenes:5} scenes {runs:5} runs  {phrase}: {item}");
    }
}

/// The least share of the library's runs whose estimated error is within a factor of ten of the true one.
const HONEST: f64 = 0.95;
/// How the estimated error compares with the true one over the library's runs that have a tight one beside them.
pub fn print_ratios(verdicts: &[Verdict]) {
    let ratios = ratios(verdicts);
    let count = ratios.len() as f64;
    let quantile = |share: f64| ratios[((count - 1.0) * share).round() as usize].0;
    println!("solver.error over the true error, {count} runs: {:.1} % within ten", 100.0 * within_ten(&ratios));
    let open = ratios.iter().filter(|(_, verdict)| verdict.true_error.max(verdict.estimate) > verdict.floor);
    let open: Vec<_> = open.copied().collect();
    println!("  {} of them above what can be known: {:.1} % within ten", open.len(), 100.0 * within_ten(&open));
    if !ratios.is_empty() {
        for share in [0.0, 0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99, 1.0] {
            println!("  quantile {share:4}: {:.1e}", quantile(share));
        }
    }
    let out = ratios.iter().filter(|(ratio, _)| !TEN.contains(ratio));
    out.for_each(|(ratio, verdict)| println!("  {}", line(*ratio, verdict)));
}

/// The estimates are right within a factor of ten in all but a few runs.
pub fn check_honesty(verdicts: &[Verdict]) {
    let share = within_ten(&ratios(verdicts));
    assert!(share >= HONEST, "solver.error: {:.1} % within ten of the true error", 100.0 * share);
}

const TEN: std::ops::RangeInclusive<f64> = 0.1..=10.0;

/// Estimate over true error, rising.
fn ratios(verdicts: &[Verdict]) -> Vec<(f64, &Verdict)> {
    let both = |verdict: &&Verdict| !verdict.way.is_fmu() && verdict.true_error.is_finite();
    let mut ratios: Vec<_> = verdicts.iter().filter(both).map(|verdict| (verdict.ratio(), verdict)).collect();
    ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
    ratios
}

fn within_ten(ratios: &[(f64, &Verdict)]) -> f64 {
    let within = ratios.iter().filter(|(ratio, _)| TEN.contains(ratio)).count();
    within as f64 / ratios.len().max(1) as f64
}

fn line(ratio: f64, verdict: &Verdict) -> String {
    format!(
        "{ratio:.1e}: {} [{}], true {:.1e}, estimated {:.1e}, known {:.1e}",
        verdict.case,
        verdict.way.name(),
        verdict.true_error,
        verdict.estimate,
        verdict.floor
    )
}
