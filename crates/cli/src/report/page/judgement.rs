//! The section on errors over the tolerance and estimates over errors, of one scene or of several, and its picture.

use std::io;

use asperity_study::robustness::{KEPT, TIGHTER};

use super::robustness::factors;
use super::{NOTHING, grouped, head, number, short, three_digits};
use asperity_study::html::{Cell, fill, table};
use asperity_study::report::{Judgement, Ratios};

const TEMPLATE: &str = include_str!("judgement.html");

/// A scene's name with its runs.
pub(in crate::report) type SceneJudgements<'a> = (&'a str, &'a [Judgement]);

/// The section, with its picture as SVG. Of one scene all runs at its tolerances are listed.
pub(in crate::report) fn judgements(scenes: &[SceneJudgements<'_>], picture: &str) -> io::Result<String> {
    let runs = match scenes {
        [(_, runs)] => format!("<h3>All runs</h3>\n<div class=\"scroll\">\n{}\n</div>", all_runs(runs)?),
        _ => String::new(),
    };
    let perturbed = scenes.iter().any(|(_, runs)| runs.iter().any(|run| run.perturbation.is_some()));
    let fields = [
        ("picture", picture.into()),
        ("summary", summary(scenes)?),
        ("runs", runs),
        ("kept", KEPT.to_string()),
        ("perturbed", if perturbed { perturbed_text() } else { String::new() }),
    ];
    Ok(fill(TEMPLATE, &fields))
}

fn perturbed_text() -> String {
    format!(
        " Scaled runs are those of the section on robustness, at the scene's own tolerance, against runs at a tolerance {TIGHTER} times lower."
    )
}

/// Runs that a line of the summary is about.
struct Group<'a> {
    scene: &'a str,
    name: String,
    runs: Vec<&'a Judgement>,
}

/// The groups of runs, in their order.
fn groups<'a>(scene: &'a str, runs: impl Iterator<Item = &'a Judgement>) -> Vec<Group<'a>> {
    Judgement::groups(runs).into_iter().map(|(name, runs)| Group { scene, name, runs }).collect()
}

/// A line for each scene and method; of several scenes, first those of all of them together.
fn summary(scenes: &[SceneJudgements<'_>]) -> io::Result<String> {
    let mut all = Vec::new();
    if scenes.len() > 1 {
        all.push(groups("all", scenes.iter().flat_map(|(_, runs)| runs.iter())));
    }
    all.extend(scenes.iter().map(|(scene, runs)| groups(scene, runs.iter())));
    let lines: Vec<(usize, &Group<'_>)> =
        all.iter().enumerate().flat_map(|(i, groups)| groups.iter().map(move |group| (i, group))).collect();
    let mut names = head(&["scene", "runs"], &["that count", "left out"]);
    for ratio in ["error over tolerance", "estimate over error"] {
        names.extend(head(&[], &[&format!("{ratio}: median"), "within ten times", "worst"]));
        names.extend(head(&["of"], &[]));
    }
    table(&names, &grouped(&lines, |(scene, _)| *scene, |(_, group)| group_cells(group)))
}

fn group_cells(group: &Group<'_>) -> Vec<Cell> {
    let counted = group.runs.iter().filter(|run| run.counts()).count();
    let left_out = group.runs.len() - counted;
    let mut cells = vec![group.scene.into(), group.name.as_str().into()];
    cells.extend([counted, left_out].map(|count| number(count.to_string())));
    cells.extend(ratio_cells(Ratios::from_errors(&group.runs)));
    cells.extend(ratio_cells(Ratios::from_estimates(&group.runs)));
    cells
}

fn ratio_cells(ratios: Option<Ratios<'_>>) -> [Cell; 4] {
    let Some(Ratios { median, within, worst, of }) = ratios else {
        return [number(NOTHING), number(NOTHING), number(NOTHING), NOTHING.into()];
    };
    let of = of.perturbation.map_or_else(|| format!("{:e}", of.tolerance), factors);
    [number(three_digits(median)), number(format!("{:.0} %", 100.0 * within)), number(three_digits(worst)), of.into()]
}

/// Every run of the scene as it is.
fn all_runs(runs: &[Judgement]) -> io::Result<String> {
    let runs: Vec<&Judgement> = runs.iter().filter(|run| run.perturbation.is_none()).collect();
    let figures = ["tolerance", "error", "over the tolerance", "estimate", "over the error"];
    let names: Vec<Cell> = [head(&["method"], &figures), head(&["warns", "left out"], &[])].concat();
    table(&names, &grouped(&runs, |run| run.method.as_str(), |run| run_cells(run)))
}

fn run_cells(run: &Judgement) -> Vec<Cell> {
    let class = if run.counts() { "number" } else { "number below" };
    let ratio = |ratio: f64| Cell { class: class.into(), ..Cell::from(three_digits(ratio)) };
    vec![
        run.method.as_str().into(),
        number(format!("{:e}", run.tolerance)),
        short(Some(run.error)),
        ratio(run.error_over_tolerance()),
        short(Some(run.estimate.error)),
        ratio(run.estimate_over_error()),
        run.warning().into(),
        run.standing.name().into(),
    ]
}
