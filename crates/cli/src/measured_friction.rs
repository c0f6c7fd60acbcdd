//! Measured friction beside that of a model: the table, the picture, and how far points are off.

use std::path::{Path, PathBuf};

use asperity::element::{Load, OperatingPoint};
use asperity_study::calibration::{Measured, Measurements, MeasurementsError};

use super::figure::{Curve, Panel, PanelRow, SideBySide, Stroke};
use super::files::{self, FileError};
use asperity_study::decimals::{as_given, rounded};

/// A table of measured friction cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum MeasuredFrictionError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error("{}:{error}", .path.display())]
    Table { path: PathBuf, error: MeasurementsError },
}

/// Reads a table; forces act on `area`, m².
pub(crate) fn read(path: &Path, area: f64) -> Result<Measurements, MeasuredFrictionError> {
    let bytes = files::read(path)?;
    let measured = Measurements::parse(&bytes, area);
    measured.map_err(|error| MeasuredFrictionError::Table { path: path.to_owned(), error })
}

/// Points off by more than this times their standard deviation are named.
pub(crate) const FAR_OFF: f64 = 3.0;

/// A point that is off, in a line.
pub(crate) fn off(measured: &Measured, model: f64, deviations: f64) -> String {
    format!(
        "line {}, {}: {} measured, {} found, off by {} standard deviations",
        measured.line,
        describe(&measured.point),
        rounded(measured.friction, 4),
        rounded(model, 4),
        rounded(deviations, 2),
    )
}

/// A point by its pressure.
pub(crate) fn describe(point: &OperatingPoint) -> String {
    let point = OperatingPoint {
        speed: rounded(point.speed, 4),
        load: rounded(point.load, 4),
        temperature: point.temperature.map(|temperature| rounded(temperature, 5)),
    };
    point.describe(Load::Pressure { area: 1.0 })
}

/// Values that are nearly alike, and their mean.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cluster {
    low: f64,
    high: f64,
    mean: f64,
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

/// Pressures and temperatures that belong to one curve.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CurveGrid {
    pressures: Vec<Cluster>,
    /// One that is `None` of data without temperatures.
    temperatures: Vec<Option<Cluster>>,
    /// The least and the largest speed.
    speeds: (f64, f64),
}

impl CurveGrid {
    /// That of some points: pressures within a tenth and temperatures within 3 K of their neighbours are one.
    pub(crate) fn new<'a>(points: impl Iterator<Item = &'a OperatingPoint> + Clone) -> Self {
        let pressures = Cluster::all(points.clone().map(|point| point.load).collect(), |a, b| b > 1.1 * a);
        let temperatures: Vec<f64> = points.clone().filter_map(|point| point.temperature).collect();
        let temperatures: Vec<Option<Cluster>> = match temperatures.is_empty() {
            true => vec![None],
            false => Cluster::all(temperatures, |a, b| b > a + 3.0).into_iter().map(Some).collect(),
        };
        let speeds =
            points.map(|point| point.speed).fold((f64::MAX, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
        Self { pressures, temperatures, speeds }
    }

    /// `count` speeds over those of the data on each of the curves.
    pub(crate) fn points(&self, count: u32) -> Vec<OperatingPoint> {
        let (low, high) = self.speeds;
        let speed = |i: u32| rounded(low * (high / low).powf(f64::from(i) / f64::from(count - 1)), 6);
        let speeds: Vec<f64> = if low < high { (0..count).map(speed).collect() } else { vec![low] };
        let of = |pressure: &Cluster, temperature: &Option<Cluster>| {
            let (load, temperature) = (pressure.mean, temperature.map(|temperature| temperature.mean));
            speeds.iter().map(|&speed| OperatingPoint { speed, load, temperature }).collect::<Vec<_>>()
        };
        let each = self.temperatures.iter().flat_map(|t| self.pressures.iter().map(move |p| (p, t)));
        each.flat_map(|(pressure, temperature)| of(pressure, temperature)).collect()
    }

    fn is_on(&self, point: &OperatingPoint, pressure: &Cluster, temperature: &Option<Cluster>) -> bool {
        let is_as_warm = match (temperature, point.temperature) {
            (Some(cluster), Some(temperature)) => cluster.has(temperature),
            _ => true,
        };
        pressure.has(point.load) && is_as_warm
    }
}

/// Friction of a model at some points.
#[derive(Clone, Debug)]
pub(crate) struct ModelCurves {
    /// What it is; of solid lines it is not said, for these have the name of their colour.
    pub(crate) name: &'static str,
    pub(crate) stroke: Stroke,
    pub(crate) points: Vec<(OperatingPoint, f64)>,
}

/// Measured points with bars of a standard deviation to each side, and curves: a panel a temperature and a colour a
/// pressure, or of one temperature a panel a pressure.
pub(crate) fn picture(title: &str, grid: &CurveGrid, measured: &[Measured], curves: &[ModelCurves]) -> SideBySide {
    let kelvin = |temperature: &Option<Cluster>| {
        temperature.map(|cluster| format!("{} K", rounded(cluster.mean, 5))).unwrap_or_default()
    };
    let pascal = |pressure: &Cluster| as_given(rounded(pressure.mean, 4), "Pa");
    let of = |pressure: &Cluster, temperature: &Option<Cluster>, look: usize, name: String| {
        let is_on = |point: &OperatingPoint| grid.is_on(point, pressure, temperature);
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
    let panels = match &grid.temperatures[..] {
        [temperature] => {
            let each = grid.pressures.iter();
            each.map(|pressure| Panel {
                title: pascal(pressure),
                curves: of(pressure, temperature, 0, kelvin(temperature)),
            })
            .collect()
        }
        several => several
            .iter()
            .map(|temperature| {
                let each = grid.pressures.iter().enumerate();
                let curves = each.flat_map(|(look, pressure)| of(pressure, temperature, look, pascal(pressure)));
                Panel { title: kelvin(temperature), curves: curves.collect() }
            })
            .collect(),
    };
    let row = PanelRow { y_title: "friction coefficient".into(), panels };
    SideBySide { title: title.to_owned(), x_title: "speed in m/s".into(), rows: vec![row] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_that_are_nearly_alike_are_one_curve() {
        let point = |load, kelvin| OperatingPoint { speed: 1.0, load, temperature: Some(kelvin) };
        let points = [point(1e5, 293.0), point(1.02e5, 294.5), point(3e5, 313.0), point(1e5, 293.0)];
        let grid = CurveGrid::new(points.iter());
        assert_eq!((grid.pressures.len(), grid.temperatures.len()), (2, 2));
        assert!((grid.pressures[0].mean - 1.006_666e5).abs() < 1.0);
        assert_eq!(grid.points(5).len(), 4);
    }
}
