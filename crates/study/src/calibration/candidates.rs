//! The points among which those to measure next are chosen.

use asperity::element::OperatingPoint;
use asperity::scene::Scene;

use super::options::CandidateOptions;
use crate::decimals::rounded;

/// The grid that is asked for; else one that reaches a decade of speed, a factor of two of pressure and 20 K beyond the
/// measurements.
pub(super) fn candidates(scene: &Scene, measured: &[OperatingPoint], asked: &CandidateOptions) -> Vec<OperatingPoint> {
    let pressures = asked.pressures.clone();
    let pressures = pressures.unwrap_or_else(|| in_logarithm(3, range(measured, |point| Some(point.load)), 2.0));
    let speeds = asked.speeds.clone();
    let speeds = speeds.unwrap_or_else(|| in_logarithm(9, range(measured, |point| Some(point.speed)), 10.0));
    let own =
        range(measured, |point| point.temperature).map(|(low, high)| even(5, (low - 20.0, high + 20.0)).collect());
    let kelvin: Option<Vec<f64>> = asked.temperatures.clone().or(own);
    let is_possible = |kelvin: &f64| scene.with_temperature(*kelvin).check().is_ok();
    let temperatures: Vec<Option<f64>> = match kelvin {
        Some(kelvin) if measured.iter().any(|point| point.temperature.is_some()) => {
            kelvin.into_iter().filter(is_possible).map(|kelvin| Some(rounded(kelvin, 5))).collect()
        }
        _ => vec![None],
    };
    let mut ways: Vec<Option<f64>> = Vec::new();
    for point in measured {
        if !ways.contains(&point.way) {
            ways.push(point.way);
        }
    }
    let mut points = Vec::new();
    for &temperature in &temperatures {
        for &load in &pressures {
            let at = |way| speeds.iter().map(move |&speed| OperatingPoint { speed, load, temperature, way });
            points.extend(ways.iter().flat_map(|&way| at(way)));
        }
    }
    points
}

/// The least and the largest value of the points that have it.
fn range(points: &[OperatingPoint], value: impl Fn(&OperatingPoint) -> Option<f64>) -> Option<(f64, f64)> {
    points.iter().filter_map(value).fold(None, |range, value| {
        Some(range.map_or((value, value), |(low, high): (f64, f64)| (low.min(value), high.max(value))))
    })
}

fn even(count: u32, (low, high): (f64, f64)) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| low + (high - low) * f64::from(i) / f64::from(count - 1))
}

/// Values even in the logarithm, from a factor below the range to one above it.
fn in_logarithm(count: u32, range: Option<(f64, f64)>, factor: f64) -> Vec<f64> {
    let range = range.map(|(low, high)| ((low / factor).ln(), (high * factor).ln()));
    range.map_or_else(Vec::new, |range| even(count, range).map(|value| rounded(value.exp(), 3)).collect())
}
