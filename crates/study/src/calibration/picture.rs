//! Measured friction beside that of a model.

use asperity::element::OperatingPoint;

use super::{Cluster, Condition, CurveGrid, Measured};
use crate::decimals::{as_given, rounded};
use crate::picture::{Mark, Picture, Stroke};

/// Friction of a model at some points.
#[derive(Clone, Debug)]
pub struct ModelCurves {
    /// What it is; of solid lines it is not said, for these have the name of their colour.
    pub name: &'static str,
    /// How it is drawn.
    pub stroke: Stroke,
    /// Each point with its friction.
    pub points: Vec<(OperatingPoint, f64)>,
}

/// Measured points with bars of a standard deviation to each side, and curves: a panel a temperature and way, and a colour
/// a pressure, or of one temperature and way a panel a pressure.
pub fn picture(title: &str, grid: &CurveGrid, measured: &[Measured], curves: &[ModelCurves]) -> Picture {
    let held = |condition: &Condition| {
        let kelvin = condition.temperature.map(|cluster| format!("{} K", rounded(cluster.mean, 5)));
        let way = condition.way.map(|way| format!("after {}", as_given(rounded(way, 4), "m")));
        kelvin.into_iter().chain(way).collect::<Vec<_>>().join(", ")
    };
    let pascal = |pressure: &Cluster| as_given(rounded(pressure.mean, 4), "Pa");
    let of = |pressure: &Cluster, condition: &Condition, look: usize, name: &str| {
        let is_on = |point: &OperatingPoint| grid.is_on(point, pressure, condition);
        let rows = measured.iter().filter(|row| is_on(&row.point));
        let bar = |row: &Measured| {
            let (speed, sigma) = (row.point.speed, row.sigma_or_assumed());
            Mark::line("", look, vec![[speed, row.friction - sigma], [speed, row.friction + sigma]])
        };
        let places = rows.clone().map(|row| [row.point.speed, row.friction]).collect();
        let curve = |model: &ModelCurves| {
            let on = model.points.iter().filter(|(point, _)| is_on(point));
            let mut points: Vec<_> = on.map(|(point, friction)| [point.speed, *friction]).collect();
            points.sort_by(|a, b| a[0].total_cmp(&b[0]));
            Mark::broken(if model.stroke == Stroke::Solid { name } else { model.name }, look, points, model.stroke)
        };
        let has_data = rows.clone().next().is_some();
        let all = curves.iter().map(curve).chain(rows.map(bar)).chain([Mark::rings("measured", look, places)]);
        if has_data { all.collect() } else { Vec::new() }
    };
    let panels = match &grid.conditions[..] {
        [condition] => {
            let each = grid.pressures.iter();
            each.map(|pressure| (pascal(pressure), of(pressure, condition, 0, &held(condition)))).collect()
        }
        several => several
            .iter()
            .map(|condition| {
                let each = grid.pressures.iter().enumerate();
                let curves = each.flat_map(|(look, pressure)| of(pressure, condition, look, &pascal(pressure)));
                (held(condition), curves.collect())
            })
            .collect(),
    };
    Picture::side_by_side(("speed", "m/s"), vec![("friction coefficient", panels)]).titled(title)
}
