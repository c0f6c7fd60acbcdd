//! Slip curves as a picture.

use super::rolling::Rolling;
use super::slip::{SlipConditions, SlipCurves, SlipPoint};
use crate::decimals::{short, temperature_as_given};
use crate::picture::{Axis, Fit, Mark, Of, Panel, Picture, Row, Stroke, ys};

/// What a panel shows of a point.
type Shown = (Of<'static>, fn(&Rolling) -> f64);

/// Curves over one of both slips.
struct Side {
    x: Of<'static>,
    /// What they are over, and what is the same along one of them.
    of: fn(&SlipPoint) -> [f64; 2],
    /// How that is named.
    fixed: fn(f64) -> String,
    panels: [Shown; 2],
}

const SIDES: [Side; 2] = [
    Side {
        x: ("longitudinal slip κ", ""),
        of: |point| [point.slip, point.angle.to_degrees()],
        fixed: |angle| format!("α = {}°", short(angle, 3)),
        panels: [(("F_x", "N"), |rolling| rolling.force[0]), (("share that slides", ""), |rolling| rolling.sliding)],
    },
    Side {
        x: ("slip angle α", "°"),
        of: |point| [point.angle.to_degrees(), point.slip],
        fixed: |slip| format!("κ = {}", short(slip, 3)),
        panels: [(("F_y", "N"), |rolling| rolling.force[1]), (("M_z", "N m"), |rolling| rolling.moment_z)],
    },
];

/// A curve: what is the same along it, and its points.
struct Curve<'a> {
    at: SlipConditions,
    fixed: f64,
    points: Vec<(f64, &'a Rolling)>,
}

impl SlipCurves {
    /// F_x and the share that slides over the slip, F_y and M_z over the slip angle: colours tell loads, strokes all else.
    pub fn picture(&self) -> Picture {
        let sides: Vec<[Panel; 2]> = SIDES.iter().filter_map(|side| self.panels(side)).collect();
        let row = |i: usize| Row { panels: sides.iter().map(|panels| panels[i].clone()).collect(), ..Row::default() };
        Picture::of(vec![row(0), row(1)]).titled(&self.name)
    }

    /// The panels of a side, if there is a curve over it.
    fn panels(&self, side: &Side) -> Option<[Panel; 2]> {
        let curves = self.curves(side);
        let x =
            Axis::linear(side.x, curves.iter().flat_map(|curve| curve.points.iter().map(|point| point.0)), Fit::Tight);
        let panel = |(of, value): Shown| {
            let mark = |curve: &Curve<'_>| {
                let points = curve.points.iter().map(|&(x, rolling)| [x, value(rolling)]).collect();
                let (name, look, stroke) = named(&curves, side, curve);
                Mark::broken(name, look, points, stroke)
            };
            let marks: Vec<Mark> = curves.iter().map(mark).collect();
            Panel::new(x.clone(), Axis::linear(of, ys(&marks), Fit::Round), marks).sized(420.0, 260.0)
        };
        (!curves.is_empty()).then(|| side.panels.map(panel))
    }

    /// The curves of two points or more.
    fn curves(&self, side: &Side) -> Vec<Curve<'_>> {
        let mut curves: Vec<Curve<'_>> = Vec::new();
        for (point, rolling) in self.steady() {
            let [x, fixed] = (side.of)(point);
            match curves.iter_mut().find(|curve| (curve.at, curve.fixed) == (point.at, fixed)) {
                Some(curve) => curve.points.push((x, rolling)),
                None => curves.push(Curve { at: point.at, fixed, points: vec![(x, rolling)] }),
            }
        }
        curves.retain(|curve| curve.points.len() > 1);
        curves.iter_mut().for_each(|curve| curve.points.sort_by(|a, b| a.0.total_cmp(&b.0)));
        curves
    }
}

/// The name of a curve by what differs among all, its colour and its stroke.
fn named(curves: &[Curve<'_>], side: &Side, curve: &Curve<'_>) -> (String, usize, Stroke) {
    let others = |curve: &Curve<'_>| (curve.at.temperature, curve.at.speed, curve.fixed);
    let colour = place(curves.iter().map(|curve| curve.at.load), curve.at.load);
    let stroke = place(curves.iter().map(others), others(curve));
    let mut name = format!("{} N", short(curve.at.load, 4));
    if differ(curves.iter().map(|curve| curve.at.speed)) {
        name += &format!(", {} m/s", short(curve.at.speed, 3));
    }
    if let (Some(kelvin), true) = (curve.at.temperature, differ(curves.iter().map(|curve| curve.at.temperature))) {
        name += &format!(", {}", temperature_as_given(kelvin));
    }
    if differ(curves.iter().map(|curve| curve.fixed)) {
        name += &format!(", {}", (side.fixed)(curve.fixed));
    }
    (name, colour, [Stroke::Solid, Stroke::Dashed, Stroke::Dotted][stroke % 3])
}

/// The number of a value among all, each once.
fn place<T: PartialEq>(all: impl Iterator<Item = T>, value: T) -> usize {
    let mut seen: Vec<T> = Vec::new();
    for one in all {
        if one == value {
            break;
        }
        if !seen.contains(&one) {
            seen.push(one);
        }
    }
    seen.len()
}

fn differ<T: PartialEq>(mut all: impl Iterator<Item = T>) -> bool {
    all.next().is_some_and(|first| all.any(|one| one != first))
}
