//! The section on errors over the tolerance and estimates over errors, of one scene or of several, and its picture.

use std::io;

use asperity_study::robustness::{KEPT, TIGHTER};

use super::robustness::factors;
use super::{NOTHING, grouped, head, number, short, three_digits};
use crate::figure::{Ladder, LadderPanel, Ladders, Rung, Stroke};
use asperity_study::html::{Cell, fill, table};
use asperity_study::report::{Judgement, Ratios, Standing, median};

const TEMPLATE: &str = include_str!("judgement.html");
/// A run's ratio, in the figure.
type Ratio = fn(&Judgement) -> f64;
/// The looks of methods in the figure by their names; any other has the last.
const METHODS: [&str; 2] = ["event", "step"];
/// In the legend.
const LEFT_OUT: &str = "left out: sensitive";

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

/// The name of the group that a run belongs to.
fn group_name(run: &Judgement) -> String {
    if run.perturbation.is_some() { format!("{}, scaled", run.method) } else { run.method.clone() }
}

/// The groups of runs, in their order.
fn groups<'a>(scene: &'a str, runs: impl Iterator<Item = &'a Judgement>) -> Vec<Group<'a>> {
    let mut groups: Vec<Group<'a>> = Vec::new();
    for run in runs {
        let name = group_name(run);
        match groups.iter_mut().find(|group| group.name == name) {
            Some(group) => group.runs.push(run),
            None => groups.push(Group { scene, name, runs: vec![run] }),
        }
    }
    groups
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

/// Both ratios over the tolerance: medians as lines, single runs as rings.
pub(in crate::report) fn judgement_picture(scenes: &[SceneJudgements<'_>]) -> Ladders {
    let runs: Vec<&Judgement> = scenes.iter().flat_map(|(_, runs)| runs.iter()).collect();
    let panel = |title: &str, ratio: Ratio, lines: &[f64]| LadderPanel {
        title: title.into(),
        floor: None,
        lines: lines.into(),
        ladders: ladders(&runs, ratio),
    };
    let panels = vec![
        panel("error over tolerance", Judgement::error_over_tolerance, &[0.3, 3.0, KEPT]),
        panel("estimate over error", Judgement::estimate_over_error, &[1.0 / KEPT, KEPT]),
    ];
    Ladders { x_title: "relative tolerance".into(), panels }
}

/// A line for each method, rings where it has several runs at a tolerance or scaled ones, and those left out.
fn ladders(runs: &[&Judgement], ratio: Ratio) -> Vec<Ladder> {
    let rings = |name: &str, look: usize, runs: Vec<&&Judgement>| Ladder {
        name: name.into(),
        stroke: Stroke::Rings,
        look,
        rungs: runs.into_iter().map(|run| rung(run.tolerance, ratio(run))).collect(),
    };
    let (mut ladders, mut lines) = (Vec::new(), Vec::new());
    for group in groups("", runs.iter().copied().filter(|run| run.counts())) {
        let look = METHODS.iter().position(|method| *method == group.runs[0].method).unwrap_or(METHODS.len());
        let medians = medians(&group.runs, ratio);
        let is_scaled = group.runs[0].perturbation.is_some();
        if is_scaled || medians.len() < group.runs.len() {
            let name = if is_scaled { group.name.clone() } else { format!("{}, single runs", group.name) };
            ladders.push(rings(&name, look, group.runs.iter().collect()));
        }
        if !is_scaled {
            lines.push(Ladder { name: group.name, stroke: Stroke::Line, look, rungs: medians });
        }
    }
    let left_out: Vec<&&Judgement> = runs.iter().filter(|run| run.standing == Standing::Sensitive).collect();
    if !left_out.is_empty() {
        ladders.push(rings(LEFT_OUT, METHODS.len() + 1, left_out));
    }
    // Over the rings.
    ladders.extend(lines);
    ladders
}

fn rung(x: f64, y: f64) -> Rung {
    Rung { x, y, label: String::new() }
}

/// The medians of the runs at each tolerance.
fn medians(runs: &[&Judgement], ratio: Ratio) -> Vec<Rung> {
    let mut pairs: Vec<(f64, f64)> = runs.iter().map(|run| (run.tolerance, ratio(run))).collect();
    pairs.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.total_cmp(&b.1)));
    let same = pairs.chunk_by(|a, b| a.0 == b.0);
    same.map(|same| rung(same[0].0, median(&same.iter().map(|pair| pair.1).collect::<Vec<_>>()))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_study::report::Estimate;

    fn run(method: &str, tolerance: f64, error: f64, standing: Standing) -> Judgement {
        let (method, estimate) = (method.into(), Estimate { error, warned: false });
        Judgement { perturbation: None, method, tolerance, error, estimate, floor: 0.0, standing }
    }

    #[test]
    fn medians_are_lines_and_single_runs_rings() {
        use Standing::{Counts, Sensitive};
        let runs = [
            run("event", 1e-2, 1e-2, Counts),
            run("event", 1e-2, 4e-2, Counts),
            run("event", 1e-3, 1e-3, Counts),
            run("event", 1e-3, 1.0, Sensitive),
            run("step", 1e-2, 1e-2, Counts),
        ];
        let picture = judgement_picture(&[("a", &runs[..3]), ("b", &runs[3..])]);
        let drawn = picture.panels[0].ladders.iter().map(|ladder| (ladder.name.as_str(), ladder.rungs.len()));
        let expected = [("event, single runs", 3), (LEFT_OUT, 1), ("event", 2), ("step", 1)];
        assert_eq!(drawn.collect::<Vec<_>>(), expected);
        assert!((picture.panels[0].ladders[2].rungs[0].y - 2.0).abs() < 1e-12, "{picture:?}");
    }
}
