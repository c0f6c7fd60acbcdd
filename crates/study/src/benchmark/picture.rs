//! The pictures of a benchmark: errors over run time and over the communication step, what runs keep of what they promise,
//! and what becomes of them under stress.

use super::communication::{CommunicationRow, MasterInputs};
use super::judgement::{Judgement, Standing, median};
use super::reference::{Comparison, Reference};
use super::stress::{Stress, Trial};
use super::tables::Peer;
use super::tolerances::ToleranceRow;
use super::trace::{Errors, QUANTITIES};
use crate::picture::{Fill, Ladders, Mark, Picture, Point, Shape, Stroke};
use crate::robustness::{KEPT, ScaledQuantity, factor};

/// A run that is drawn: of what, how, its tolerance, its time (s), its errors.
type DrawnRun<'a> = (&'a str, Stroke, f64, f64, Errors);

/// Errors over run time, one line for each method and, dashed, for each whole process of the `peers`, with the tolerances
/// at its ends.
pub fn tolerance_picture(reference: &Reference, rows: &[ToleranceRow], peers: &[Peer]) -> Picture {
    let own = rows.iter().filter_map(|row| {
        let figures = row.result.as_ref().ok()?;
        Some((row.method, Stroke::Solid, row.tolerance, figures.time()?, figures.errors))
    });
    let peers = peers.iter().map(|peer| (peer.name.as_str(), Stroke::Dashed, peer.tolerance, peer.time, peer.errors));
    let runs: Vec<_> = own.chain(peers).collect();
    let panels = panels(reference, |quantity, floor| {
        let line = |(look, runs): (usize, &[DrawnRun<'_>])| {
            let seen = |&(_, _, tolerance, time, errors): &DrawnRun<'_>| Some(([time, errors[quantity]?], tolerance));
            let (points, tolerances): (Vec<Point>, Vec<f64>) = runs.iter().filter_map(seen).unzip();
            // Those between are powers of ten.
            let last = tolerances.len().saturating_sub(1);
            let label = |(i, tolerance): (usize, &f64)| {
                if i == 0 || i == last { format!("{tolerance:e}") } else { String::new() }
            };
            let (name, stroke, ..) = runs[0];
            ladder(name, look, points, (stroke, tolerances.iter().enumerate().map(label).collect()), floor)
        };
        runs.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)).enumerate().flat_map(line).collect()
    });
    Picture::of(vec![Picture::ladders(("run time", "s"), &panels)])
}

/// A line with labelled symbols, which are hollow where nothing is known; nothing without points.
fn ladder(
    name: &str,
    look: usize,
    points: Vec<Point>,
    (stroke, labels): (Stroke, Vec<String>),
    floor: Option<f64>,
) -> Vec<Mark> {
    if points.is_empty() {
        return Vec::new();
    }
    let mut marks = vec![Mark::broken(name, look, points.clone(), stroke)];
    for (fill, is_below) in [(Fill::Full, false), (Fill::Hollow, true)] {
        let own =
            || points.iter().zip(&labels).filter(|(point, _)| floor.is_some_and(|floor| point[1] < floor) == is_below);
        let mut mark = Mark::symbols(name, look, own().map(|(point, _)| *point).collect(), fill);
        if let Shape::Points { labels, .. } = &mut mark.shape {
            *labels = own().map(|(_, label)| label.clone()).collect();
        }
        marks.push(mark);
    }
    marks
}

/// Errors over the communication step: the largest and, dashed, the root mean squares.
pub fn communication_picture(reference: &Reference, rows: &[CommunicationRow]) -> Picture {
    let panels = panels(reference, |quantity, floor| {
        let line = |given: MasterInputs, look: usize, mean_square: bool| {
            let pick = |row: &CommunicationRow| {
                let (figures, mean_squares) = row.result.as_ref().ok()?;
                let errors: Errors = if mean_square { (*mean_squares)? } else { figures.errors };
                Some([row.step?, errors[quantity]?])
            };
            let points: Vec<Point> = rows.iter().filter(|row| row.given == given).filter_map(pick).collect();
            let (kind, stroke) = if mean_square { (", root mean square", Stroke::Dashed) } else { ("", Stroke::Solid) };
            let labels = vec![String::new(); points.len()];
            ladder(&format!("{}{kind}", given.name()), look, points, (stroke, labels), floor)
        };
        let given = [(MasterInputs::Rates, 0), (MasterInputs::Values, 1)].into_iter();
        given
            .flat_map(|(given, look)| [false, true].map(|mean_square| line(given, look, mean_square)).concat())
            .collect()
    });
    Picture::of(vec![Picture::ladders(("communication step", "s"), &panels)])
}

/// A panel for each quantity that the scene has, with the marks of its number over the error of the reference; if it has
/// none, an empty one of F_z.
fn panels(reference: &Reference, marks: impl Fn(usize, Option<f64>) -> Vec<Mark>) -> Vec<Ladders> {
    let there = (0..QUANTITIES.len()).filter(|&quantity| reference.own[quantity].is_some());
    let mut shown: Vec<usize> = there.collect();
    if shown.is_empty() {
        shown.push(1);
    }
    let panel = |quantity: usize| {
        let floor = reference.own[quantity].filter(|own| own.is_finite());
        let title = title(quantity, reference.comparison);
        Ladders { title, floor, across: Vec::new(), marks: marks(quantity, floor) }
    };
    shown.into_iter().map(panel).collect()
}

fn title(quantity: usize, comparison: Comparison) -> String {
    let means = if comparison.is_of_means() && quantity != 2 { ", means" } else { "" };
    format!("error of {}{means}", QUANTITIES[quantity])
}

/// A run's ratio.
type Ratio = fn(&Judgement) -> f64;
/// The looks of methods by their names; any other has the last.
const METHODS: [&str; 2] = ["event", "step"];
/// In the legend.
const LEFT_OUT: &str = "left out: sensitive";

/// Errors over the tolerance and estimates over the errors: medians as lines, single runs as rings.
pub fn judgement_picture<'a>(runs: impl Iterator<Item = &'a Judgement>) -> Picture {
    let runs: Vec<&Judgement> = runs.collect();
    let panel = |title: &str, ratio: Ratio, across: &[f64]| Ladders {
        title: title.into(),
        floor: None,
        across: across.into(),
        marks: judged(&runs, ratio),
    };
    let panels = [
        panel("error over tolerance", Judgement::error_over_tolerance, &[0.3, 3.0, KEPT]),
        panel("estimate over error", Judgement::estimate_over_error, &[1.0 / KEPT, KEPT]),
    ];
    Picture::of(vec![Picture::ladders(("relative tolerance", ""), &panels)])
}

/// A line for each method, rings where it has several runs at a tolerance or scaled ones, and those left out.
fn judged(runs: &[&Judgement], ratio: Ratio) -> Vec<Mark> {
    let points = |runs: &[&Judgement]| runs.iter().map(|run| [run.tolerance, ratio(run)]).collect::<Vec<_>>();
    let (mut rings, mut lines) = (Vec::new(), Vec::new());
    for (name, runs) in Judgement::groups(runs.iter().copied().filter(|run| run.counts())) {
        let look = METHODS.iter().position(|method| *method == runs[0].method).unwrap_or(METHODS.len());
        let medians = medians(points(&runs));
        let is_scaled = runs[0].scaled.is_some();
        if is_scaled || medians.len() < runs.len() {
            let name = if is_scaled { name.clone() } else { format!("{name}, single runs") };
            rings.push(Mark::rings(name, look, points(&runs)));
        }
        if !is_scaled {
            lines.extend(Mark::marked(&name, look, medians));
        }
    }
    let left_out: Vec<&Judgement> = runs.iter().copied().filter(|run| run.standing == Standing::Sensitive).collect();
    if !left_out.is_empty() {
        rings.push(Mark::rings(LEFT_OUT, METHODS.len() + 1, points(&left_out)));
    }
    // Over the rings.
    rings.into_iter().chain(lines).collect()
}

/// The medians at each tolerance.
fn medians(mut points: Vec<Point>) -> Vec<Point> {
    points.sort_by(|a, b| b[0].total_cmp(&a[0]).then(a[1].total_cmp(&b[1])));
    let same = points.chunk_by(|a, b| a[0] == b[0]);
    same.map(|same| [same[0][0], median(&same.iter().map(|point| point[1]).collect::<Vec<_>>())]).collect()
}

/// What is drawn of a run.
type Figure<'a> = dyn Fn(&Trial) -> Option<f64> + 'a;

/// Errors over the tolerance and steps over those due, over the factor of each quantity: a line goes as far as runs come to
/// their ends, and what is sensitive or has nothing to be compared with is hollow.
pub fn stress_picture(stress: &Stress) -> Picture {
    let error = |trial: &Trial| Some(trial.outcome.as_ref().ok()?.accuracy.error()?.share / stress.tolerance);
    let work = |trial: &Trial| stress.times_the_steps(trial);
    let quantities = stress.quantities();
    let marks = |figure: &Figure<'_>| {
        quantities.iter().enumerate().flat_map(|(look, &quantity)| line(stress, quantity, look, figure)).collect()
    };
    let panels = vec![(("error over tolerance", ""), marks(&error)), (("steps over those due", ""), marks(&work))];
    Picture::stacked(("factor", ""), panels)
}

/// The line of a quantity, broken where a run has no figure, and its symbols.
fn line(stress: &Stress, quantity: ScaledQuantity, look: usize, figure: &Figure<'_>) -> Vec<Mark> {
    let is_relied_on = |trial: &Trial| {
        trial.outcome.as_ref().is_ok_and(|ended| ended.accuracy.error().is_some() && ended.accuracy.moved().is_none())
    };
    let runs = stress.of(quantity);
    let point = |(power, trial): &(i32, &Trial)| Some(([factor(*power), figure(trial)?], is_relied_on(trial)));
    let points: Vec<Option<(Point, bool)>> = runs.iter().map(point).collect();
    let parts = points.split(Option::is_none).filter(|part| !part.is_empty());
    let lines = parts.map(|part| Mark::line(quantity.name(), look, part.iter().flatten().map(|(at, _)| *at).collect()));
    let mut marks: Vec<Mark> = lines.collect();
    for (fill, kept) in [(Fill::Full, true), (Fill::Hollow, false)] {
        let own = points.iter().flatten().filter(|(_, is_relied_on)| *is_relied_on == kept);
        marks.push(Mark::symbols(quantity.name(), look, own.map(|(at, _)| *at).collect(), fill));
    }
    marks
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::benchmark::run::Estimate;

    fn run(method: &str, tolerance: f64, error: f64, standing: Standing) -> Judgement {
        let (method, estimate) = (method.into(), Estimate { error, warned: false });
        Judgement { scaled: None, method, tolerance, error, estimate, floor: 0.0, standing }
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
        let picture = judgement_picture(runs.iter());
        let marks = picture.rows[0].panels[0].marks.iter().filter(|mark| !mark.name.is_empty());
        let drawn: Vec<_> = marks.clone().map(|mark| (mark.name.as_str(), mark.points().count())).collect();
        let expected = [("event, single runs", 3), (LEFT_OUT, 1), ("event", 2), ("event", 2), ("step", 1), ("step", 1)];
        assert_eq!(drawn, expected);
        let median = marks.clone().nth(2).and_then(|mark| mark.points().next()).unwrap();
        assert!((median[1] - 2.0).abs() < 1e-12, "{median:?}");
    }
}
