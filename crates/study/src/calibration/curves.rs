//! The curves that measured points make: pressures and temperatures that are nearly alike are one; and their picture.

use asperity::element::OperatingPoint;

use super::measurements::Measured;
use crate::decimals::{as_given, rounded};
use crate::picture::{Mark, Picture, Stroke};

/// Values that are nearly alike, and their mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cluster {
    low: f64,
    high: f64,
    /// The mean of the values.
    pub mean: f64,
}

impl Cluster {
    /// Parts values where the next is more than `gap` above the one before.
    fn all(mut values: Vec<f64>, gap: impl Fn(f64, f64) -> bool) -> Vec<Self> {
        values.sort_by(f64::total_cmp);
        let parts = values.chunk_by(|a, b| !gap(*a, *b));
        parts
            .map(|part| Self {
                low: part[0],
                high: part[part.len() - 1],
                mean: if part[0] == part[part.len() - 1] {
                    part[0]
                } else {
                    part.iter().sum::<f64>() / part.len() as f64
                },
            })
            .collect()
    }

    fn has(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }
}

/// What is held along a curve beside the pressure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Condition {
    /// Temperature, K; `None` of data without any.
    pub temperature: Option<Cluster>,
    /// The way slid, m; `None` of data without any.
    pub way: Option<f64>,
}

impl Condition {
    fn all(temperatures: Vec<Option<Cluster>>, ways: Vec<Option<f64>>) -> Vec<Self> {
        let with = |temperature| ways.iter().map(move |&way| Self { temperature, way });
        temperatures.into_iter().flat_map(with).collect()
    }

    fn has(&self, point: &OperatingPoint) -> bool {
        let is_as_warm = match (self.temperature, point.temperature) {
            (Some(cluster), Some(temperature)) => cluster.has(temperature),
            _ => true,
        };
        is_as_warm && self.way == point.way
    }
}

/// Pressures, temperatures and ways that belong to one curve.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveGrid {
    /// Pressures, Pa.
    pub pressures: Vec<Cluster>,
    /// What else was held along a curve.
    pub conditions: Vec<Condition>,
    /// The least and the largest speed.
    speeds: (f64, f64),
}

impl CurveGrid {
    /// That of some points: pressures within a tenth and temperatures within 3 K of their neighbours are one.
    pub fn new<'a>(points: impl Iterator<Item = &'a OperatingPoint> + Clone) -> Self {
        let pressures = Cluster::all(points.clone().map(|point| point.load).collect(), |a, b| b > 1.1 * a);
        let temperatures: Vec<f64> = points.clone().filter_map(|point| point.temperature).collect();
        let temperatures: Vec<Option<Cluster>> = match temperatures.is_empty() {
            true => vec![None],
            false => Cluster::all(temperatures, |a, b| b > a + 3.0).into_iter().map(Some).collect(),
        };
        let speeds = points
            .clone()
            .map(|point| point.speed)
            .fold((f64::MAX, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
        let mut ways: Vec<Option<f64>> = points.map(|point| point.way).collect();
        ways.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
        ways.dedup();
        Self { pressures, conditions: Condition::all(temperatures, ways), speeds }
    }

    /// `count` speeds over those of the data on each of the curves.
    pub fn points(&self, count: u32) -> Vec<OperatingPoint> {
        let (low, high) = self.speeds;
        let speed = |i: u32| rounded(low * (high / low).powf(f64::from(i) / f64::from(count - 1)), 6);
        let speeds: Vec<f64> = if low < high { (0..count).map(speed).collect() } else { vec![low] };
        let of = |pressure: &Cluster, condition: &Condition| {
            let (load, temperature) = (pressure.mean, condition.temperature.map(|temperature| temperature.mean));
            let way = condition.way;
            speeds.iter().map(|&speed| OperatingPoint { speed, load, temperature, way }).collect::<Vec<_>>()
        };
        let each = self.conditions.iter().flat_map(|c| self.pressures.iter().map(move |p| (p, c)));
        each.flat_map(|(pressure, condition)| of(pressure, condition)).collect()
    }

    /// Whether a point is on the curve of a pressure and what else is held.
    pub fn is_on(&self, point: &OperatingPoint, pressure: &Cluster, condition: &Condition) -> bool {
        pressure.has(point.load) && condition.has(point)
    }
}

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
    Picture::side_by_side(("speed", "m/s"), vec![(("friction coefficient", ""), panels)]).titled(title)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_that_are_nearly_alike_are_one_curve() {
        let point = |load, kelvin| OperatingPoint { speed: 1.0, load, temperature: Some(kelvin), way: None };
        let points = [point(1e5, 293.0), point(1.02e5, 294.5), point(3e5, 313.0), point(1e5, 293.0)];
        let grid = CurveGrid::new(points.iter());
        assert_eq!((grid.pressures.len(), grid.conditions.len()), (2, 2));
        assert!((grid.pressures[0].mean - 1.006_666e5).abs() < 1.0);
        assert_eq!(grid.points(5).len(), 4);
        let slid = points.map(|point| OperatingPoint { way: Some(0.01 * point.load / 1e5), ..point });
        assert_eq!(CurveGrid::new(slid.iter()).conditions.len(), 6, "three ways at two temperatures");
    }
}
