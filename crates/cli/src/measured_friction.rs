//! Measured friction beside that of a model: the picture, and how far points are off.

use asperity::element::OperatingPoint;
use asperity_study::calibration::{Cluster, Condition, CurveGrid, Measured, in_words};
use asperity_study::decimals::{as_given, rounded};

use super::figure::{Curve, Panel, PanelRow, SideBySide, Stroke};

/// A point that is off, in a line.
pub(crate) fn off(measured: &Measured, model: f64, deviations: f64) -> String {
    format!(
        "line {}, {}: {} measured, {} found, off by {} standard deviations",
        measured.line,
        in_words(&measured.point),
        rounded(measured.friction, 4),
        rounded(model, 4),
        rounded(deviations, 2),
    )
}

/// Friction of a model at some points.
#[derive(Clone, Debug)]
pub(crate) struct ModelCurves {
    /// What it is; of solid lines it is not said, for these have the name of their colour.
    pub(crate) name: &'static str,
    pub(crate) stroke: Stroke,
    pub(crate) points: Vec<(OperatingPoint, f64)>,
}

/// Measured points with bars of a standard deviation to each side, and curves: a panel a temperature and way, and a colour
/// a pressure, or of one temperature and way a panel a pressure.
pub(crate) fn picture(title: &str, grid: &CurveGrid, measured: &[Measured], curves: &[ModelCurves]) -> SideBySide {
    let held = |condition: &Condition| {
        let kelvin = condition.temperature.map(|cluster| format!("{} K", rounded(cluster.mean, 5)));
        let way = condition.way.map(|way| format!("after {}", as_given(rounded(way, 4), "m")));
        kelvin.into_iter().chain(way).collect::<Vec<_>>().join(", ")
    };
    let pascal = |pressure: &Cluster| as_given(rounded(pressure.mean, 4), "Pa");
    let of = |pressure: &Cluster, condition: &Condition, look: usize, name: String| {
        let is_on = |point: &OperatingPoint| grid.is_on(point, pressure, condition);
        let rows = measured.iter().filter(|row| is_on(&row.point));
        let bar = |row: &Measured| {
            let (speed, sigma) = (row.point.speed, row.sigma_or_assumed());
            let points = vec![(speed, row.friction - sigma), (speed, row.friction + sigma)];
            Curve { name: String::new(), look, stroke: Stroke::Line, points }
        };
        let rings = Curve {
            name: "measured".to_owned(),
            look,
            stroke: Stroke::Rings,
            points: rows.clone().map(|row| (row.point.speed, row.friction)).collect(),
        };
        let curve = |model: &ModelCurves| {
            let mut points: Vec<(f64, f64)> =
                model.points.iter().filter(|(point, _)| is_on(point)).map(|(point, mu)| (point.speed, *mu)).collect();
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            let name = if model.stroke == Stroke::Line { name.clone() } else { model.name.to_owned() };
            Curve { name, look, stroke: model.stroke, points }
        };
        let has_data = rows.clone().next().is_some();
        let all = curves.iter().map(curve).chain(rows.map(bar)).chain([rings]);
        if has_data { all.collect() } else { Vec::new() }
    };
    let panels = match &grid.conditions[..] {
        [condition] => {
            let each = grid.pressures.iter();
            each.map(|pressure| Panel { title: pascal(pressure), curves: of(pressure, condition, 0, held(condition)) })
                .collect()
        }
        several => several
            .iter()
            .map(|condition| {
                let each = grid.pressures.iter().enumerate();
                let curves = each.flat_map(|(look, pressure)| of(pressure, condition, look, pascal(pressure)));
                Panel { title: held(condition), curves: curves.collect() }
            })
            .collect(),
    };
    let row = PanelRow { y_title: "friction coefficient".into(), panels };
    SideBySide { title: title.to_owned(), x_title: "speed in m/s".into(), rows: vec![row] }
}
