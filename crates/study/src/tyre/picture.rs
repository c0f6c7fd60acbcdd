//! Slip curves as a picture.

use super::magic::{Direction, MagicFormula};
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
    /// The first panel, and what that is off by.
    fitted: (Direction, Of<'static>),
}

const SIDES: [Side; 2] = [
    Side {
        x: ("longitudinal slip κ", ""),
        of: |point| [point.slip, point.angle.to_degrees()],
        fixed: |angle| format!("α = {}°", short(angle, 3)),
        panels: [(("F_x", "N"), |rolling| rolling.force[0]), (("share that slides", ""), |rolling| rolling.sliding)],
        fitted: (Direction::Along, ("F_x less fit", "N")),
    },
    Side {
        x: ("slip angle α", "°"),
        of: |point| [point.angle.to_degrees(), point.slip],
        fixed: |slip| format!("κ = {}", short(slip, 3)),
        panels: [(("F_y", "N"), |rolling| rolling.force[1]), (("M_z", "N m"), |rolling| rolling.moment_z)],
        fitted: (Direction::Across, ("F_y less fit", "N")),
    },
];

/// A curve: what is the same along it, and its points.
struct Curve<'a> {
    at: SlipConditions,
    fixed: f64,
    points: Vec<(f64, &'a Rolling)>,
}

impl SlipCurves {
    /// F_x and the share that slides over the slip, F_y and M_z over the slip angle: colours tell loads, strokes all else. With
    /// a formula that was fitted, points are rings, lines its coefficients over loads, and what these are off by is below.
    pub fn picture(&self, fit: Option<&MagicFormula>) -> Picture {
        let sides: Vec<Vec<Panel>> = SIDES.iter().filter_map(|side| self.panels(side, fit)).collect();
        let row = |i: usize| Row { panels: sides.iter().map(|panels| panels[i].clone()).collect(), ..Row::default() };
        Picture::of((0..sides.first().map_or(0, Vec::len)).map(row).collect()).titled(&self.name)
    }

    /// The panels of a side from top to bottom, if there is a curve over it.
    fn panels(&self, side: &Side, fit: Option<&MagicFormula>) -> Option<Vec<Panel>> {
        let curves = self.curves(side);
        let looks: Vec<Look> = curves.iter().map(|curve| look(&curves, side, curve)).collect();
        let xs = curves.iter().flat_map(|curve| curve.points.iter().map(|point| point.0));
        let x = Axis::linear(side.x, xs, Fit::Tight);
        let panel = |of: Of<'_>, marks: Vec<Mark>, height: f64| {
            Panel::new(x.clone(), Axis::linear(of, ys(&marks), Fit::Round), marks).sized(420.0, height)
        };
        let lines = |value: &dyn Fn(&Curve<'_>, f64, &Rolling) -> Option<f64>| -> Vec<Mark> {
            let line = |(curve, (name, colour, stroke)): (&Curve<'_>, &Look)| {
                let point = |&(x, rolling): &(f64, &Rolling)| Some([x, value(curve, x, rolling)?]);
                Mark::broken(name.clone(), *colour, curve.points.iter().filter_map(point).collect(), *stroke)
            };
            curves.iter().zip(&looks).map(line).filter(|mark| mark.points().next().is_some()).collect()
        };
        let [(first, force), (second, value)] = side.panels;
        let second = panel(second, lines(&|_, _, rolling| Some(value(rolling))), 260.0);
        let (direction, off) = side.fitted;
        let fitted = |curve: &Curve<'_>, x: f64| {
            let of_loads = fit.filter(|_| curve.fixed == 0.0)?.over_loads(direction, curve.at)?;
            Some(of_loads.force(curve.at.load, if direction == Direction::Across { x.to_radians() } else { x }))
        };
        if fit.is_none() {
            return (!curves.is_empty())
                .then(|| vec![panel(first, lines(&|_, _, rolling| Some(force(rolling))), 260.0), second]);
        }
        let mut marks = lines(&|curve, x, _| fitted(curve, x));
        marks.extend(curves.iter().zip(&looks).map(|(curve, (_, colour, _))| {
            Mark::rings("", *colour, curve.points.iter().map(|&(x, rolling)| [x, force(rolling)]).collect())
        }));
        let residual = lines(&|curve, x, rolling| Some(force(rolling) - fitted(curve, x)?));
        (!curves.is_empty()).then(|| vec![panel(first, marks, 260.0), panel(off, residual, 130.0), second])
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
type Look = (String, usize, Stroke);

fn look(curves: &[Curve<'_>], side: &Side, curve: &Curve<'_>) -> Look {
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
