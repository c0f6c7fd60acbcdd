//! The picture of a study: friction and area over the spacing.

use asperity_study::converge::{Pair, RunRow};
use asperity_study::steady::persson::Theory;

use crate::figure::{Curve, Panel, Stacked, Stroke};

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
pub(super) fn picture(title: &str, runs: &[RunRow]) -> Stacked {
    let panel = |title: &str, value: fn(&Pair) -> f64, parts: Vec<Curve>, theories: &[TheoryCurve]| {
        let mut curves = measured(runs, value).to_vec();
        curves.extend(parts);
        curves.extend(theories.iter().map(|theory| theory_curve(runs, *theory)));
        curves.retain(|curve| !curve.points.is_empty());
        Panel { title: title.into(), curves }
    };
    let panels = vec![
        panel("friction coefficient", |pair| pair.friction, vec![hysteresis(runs)], &FRICTIONS),
        panel("area in contact over the whole", |pair| pair.area, Vec::new(), &AREAS),
    ];
    Stacked { title: title.to_owned(), x_title: "spacing in m".into(), panels }
}

fn measured(runs: &[RunRow], value: fn(&Pair) -> f64) -> [Curve; 4] {
    let curve = |name: &str, look: usize, stroke: Stroke, has: fn(&RunRow) -> bool| {
        let point = |run: &RunRow| Some((run.dimensions.spacing, value(&run.mean()?)));
        let points = runs.iter().filter(|run| has(run)).filter_map(point).collect();
        Curve { name: name.into(), look, stroke, points }
    };
    [
        curve("this scene", 0, Stroke::Marked, |run| run.variant.is_of_ladder()),
        curve("twice the length", 1, Stroke::Rings, |run| run.variant.doubled),
        curve("another split", 4, Stroke::Rings, |run| run.variant.split),
        curve("other seeds", 2, Stroke::Rings, |run| run.variant.seed_shift > 0),
    ]
}

/// The part of the friction that the theory is of; no points where that is all of it.
fn hysteresis(runs: &[RunRow]) -> Curve {
    /// Share of the friction coefficient below which two curves look like one.
    const SEEN: f64 = 0.01;
    let of = |run: &RunRow| {
        let measured = run.measured.as_ref()?;
        Some((run.dimensions.spacing, measured.hysteresis, measured.mean.friction))
    };
    let ladder: Vec<_> = runs.iter().filter(|run| run.variant.is_of_ladder()).filter_map(of).collect();
    let differs = ladder.iter().any(|(_, part, whole)| (whole - part).abs() > SEEN * whole.abs());
    let points = ladder.iter().filter(|_| differs).map(|&(spacing, part, _)| (spacing, part)).collect();
    Curve { name: "its hysteresis".into(), look: 3, stroke: Stroke::Line, points }
}

fn theory_curve(runs: &[RunRow], (name, stroke, surface, value): TheoryCurve) -> Curve {
    let ladder = runs.iter().filter(|run| run.variant.is_of_ladder());
    let points = ladder.map(|run| (run.dimensions.spacing, value(&run.theories[surface]))).collect();
    Curve { name: name.into(), look: 5 + surface, stroke, points }
}
