//! The picture of a study: friction and area over the spacing.

use super::{Pair, RunRow};
use crate::picture::{Mark, Picture, Stroke};
use crate::steady::persson::Theory;

/// A curve of Persson's theory: its name, its stroke, which of the two surfaces, and its value.
type TheoryCurve = (&'static str, Stroke, usize, fn(&Theory) -> f64);

const FRICTIONS: [TheoryCurve; 4] = [
    ("Persson's hysteresis, ridges", Stroke::Dashed, 0, |theory| theory.friction),
    ("the same with S = ½ + ½P²", Stroke::Dotted, 0, |theory| theory.friction_reduced),
    ("Persson's hysteresis, isotropic", Stroke::Dashed, 1, |theory| theory.friction),
    ("the same, isotropic, with S = ½ + ½P²", Stroke::Dotted, 1, |theory| theory.friction_reduced),
];
const AREAS: [TheoryCurve; 2] = [
    ("Persson, ridges", Stroke::Dashed, 0, |theory| theory.area),
    ("Persson, isotropic", Stroke::Dashed, 1, |theory| theory.area),
];

/// The runs of the study `title`, those with another length or seed as circles.
pub fn picture(title: &str, runs: &[RunRow]) -> Picture {
    let marks = |value: fn(&Pair) -> f64, part: Option<Mark>, theories: &[TheoryCurve]| {
        let theories = theories.iter().map(|theory| theory_curve(runs, *theory));
        let all = measured(runs, value).into_iter().chain(part).chain(theories);
        all.filter(|mark| mark.points().next().is_some()).collect::<Vec<_>>()
    };
    let panels = vec![
        (("friction coefficient", ""), marks(|pair| pair.friction, Some(hysteresis(runs)), &FRICTIONS)),
        (("area in contact over the whole", ""), marks(|pair| pair.area, None, &AREAS)),
    ];
    Picture::stacked(("spacing", "m"), panels).titled(title)
}

fn measured(runs: &[RunRow], value: fn(&Pair) -> f64) -> Vec<Mark> {
    let points = |has: fn(&RunRow) -> bool| {
        let point = |run: &RunRow| Some([run.dimensions.spacing, value(&run.mean()?)]);
        runs.iter().filter(|run| has(run)).filter_map(point).collect::<Vec<_>>()
    };
    let mut marks = Mark::marked("this scene", 0, points(|run| run.variant.is_of_ladder())).to_vec();
    marks.extend([
        Mark::rings("twice the length", 1, points(|run| run.variant.doubled)),
        Mark::rings("another split", 4, points(|run| run.variant.split)),
        Mark::rings("other seeds", 2, points(|run| run.variant.seed_shift > 0)),
    ]);
    marks
}

/// The part of the friction that the theory is of; no points where that is all of it.
fn hysteresis(runs: &[RunRow]) -> Mark {
    /// Share of the friction coefficient below which two curves look like one.
    const SEEN: f64 = 0.01;
    let of = |run: &RunRow| {
        let measured = run.measured.as_ref()?;
        Some((run.dimensions.spacing, measured.hysteresis, measured.mean.friction))
    };
    let ladder: Vec<_> = runs.iter().filter(|run| run.variant.is_of_ladder()).filter_map(of).collect();
    let differs = ladder.iter().any(|(_, part, whole)| (whole - part).abs() > SEEN * whole.abs());
    let points = ladder.iter().filter(|_| differs).map(|&(spacing, part, _)| [spacing, part]).collect();
    Mark::line("its hysteresis", 3, points)
}

fn theory_curve(runs: &[RunRow], (name, stroke, surface, value): TheoryCurve) -> Mark {
    let ladder = runs.iter().filter(|run| run.variant.is_of_ladder());
    let points = ladder.map(|run| [run.dimensions.spacing, value(&run.theories[surface])]).collect();
    Mark::broken(name, 5 + surface, points, stroke)
}
