//! The power law of a spectrum: Hurst exponent, roll-off, cut-off.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;

use serde::Serialize;

use super::spectrum::Band;

/// A spectrum that is constant up to the roll-off and falls as q^(-1-2H) from there on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Law {
    /// H
    pub(super) hurst: f64,
    /// Its standard error, as far as the bands' scatter tells.
    pub(super) hurst_error: f64,
    /// The wavelength 2π/q above which the spectrum is constant, m; none where no such place is seen.
    pub(super) roll_off_wavelength: Option<f64>,
    /// The shortest and the longest wavelength of the power law, m.
    pub(super) wavelengths: [f64; 2],
    /// Whether the spectrum goes on below the shortest one, but not by this law: a cut-off, a filter, noise.
    pub(super) ends: bool,
    /// The constant part, or the longest wavelength's: ln of m³.
    level: f64,
}

/// Fewest bands of a power law, and its least length: half a decade.
const FEWEST_BANDS: usize = 4;
const SHORTEST_SPAN: f64 = 1.15;
/// It falls by more than so many of its errors.
const FALLS: f64 = 3.0;
/// The variance of ln C that no number of modes takes away: a spectrum follows its law so well and no better.
const VARIANCE: f64 = 0.01;
/// What a band costs that the law does not reach: it is left out where it lies more than three of its errors off.
const LEFT_OUT: f64 = 9.0;
/// What a roll-off costs: it must explain more than chance does.
const ROLL_OFF: f64 = 6.0;
/// Places of a roll-off that are tried from one band to the next.
const FINE: usize = 8;

/// A band as the law sees it.
#[derive(Clone, Copy, Debug)]
struct Point {
    /// ln q
    x: f64,
    /// ln C
    y: f64,
    /// Over its variance.
    weight: f64,
}

/// A law up to one of the bands, and what it costs.
struct Fit {
    level: f64,
    exponent: f64,
    error: f64,
    cost: f64,
}

impl Law {
    /// The law that fits the bands best, over as many of them as it can; where `wavelengths` (m) are given, over all of
    /// these and without a roll-off. None where nothing falls by a power law.
    pub(super) fn of(bands: &[Band], wavelengths: Option<&RangeInclusive<f64>>) -> Option<Self> {
        let inside = |band: &&Band| wavelengths.is_none_or(|range| range.contains(&(TAU / band.wave_number)));
        let seen = bands.iter().filter(inside).filter(|band| band.density > 0.0);
        let bands: Vec<Point> = seen.map(Point::of).collect();
        let mut best: Option<(f64, Self)> = None;
        let ends = if wavelengths.is_some() { bands.len().max(FEWEST_BANDS) } else { FEWEST_BANDS }..=bands.len();
        for end in ends {
            for knee in 0..if wavelengths.is_some() { 1 } else { FINE * end } {
                let Some(fit) = Fit::of(&bands[..end], knee) else { continue };
                let penalty = LEFT_OUT * (bands.len() - end) as f64 + if knee > 0 { ROLL_OFF } else { 0.0 };
                if best.as_ref().is_none_or(|(cost, _)| fit.cost + penalty < *cost) {
                    best = Some((fit.cost + penalty, fit.law(&bands, end, knee)));
                }
            }
        }
        best.map(|(_, law)| law)
    }

    /// C of the law at a wave number, m³.
    pub(super) fn density(&self, wave_number: f64) -> f64 {
        let longest = self.roll_off_wavelength.unwrap_or(self.wavelengths[1]);
        let fallen = (wave_number * longest / TAU).ln().max(0.0);
        (self.level - (1.0 + 2.0 * self.hurst) * fallen).exp()
    }
}

impl Point {
    fn of(band: &Band) -> Self {
        let weight = 1.0 / (1.0 / band.modes as f64 + VARIANCE);
        Self { x: band.wave_number.ln(), y: band.density.ln(), weight }
    }
}

impl Fit {
    /// ln C = level - exponent · max(0, ln q - ln q_r), weighted least squares, with the roll-off at place `knee`.
    fn of(bands: &[Point], knee: usize) -> Option<Self> {
        let start = knee_at(bands, knee)?;
        let fallen = |band: &Point| (band.x - start).max(0.0);
        let falling = bands.iter().filter(|band| fallen(band) > 0.0).count();
        if falling + usize::from(knee == 0) < FEWEST_BANDS || fallen(bands.last()?) < SHORTEST_SPAN {
            return None;
        }
        let sum = |value: &dyn Fn(&Point) -> f64| bands.iter().map(|band| band.weight * value(band)).sum::<f64>();
        let whole = sum(&|_| 1.0);
        let (x, y) = (sum(&fallen) / whole, sum(&|band| band.y) / whole);
        let variance = sum(&|band| (fallen(band) - x).powi(2));
        let exponent = -sum(&|band| (fallen(band) - x) * (band.y - y)) / variance;
        let level = y + exponent * x;
        let cost = sum(&|band| (band.y - level + exponent * fallen(band)).powi(2));
        let error = variance.sqrt().recip();
        (exponent > FALLS * error).then_some(Self { level, exponent, error, cost })
    }

    fn law(&self, bands: &[Point], end: usize, knee: usize) -> Law {
        let start = knee_at(bands, knee).unwrap_or_default().exp();
        Law {
            hurst: (self.exponent - 1.0) / 2.0,
            hurst_error: self.error / 2.0,
            roll_off_wavelength: (knee > 0).then_some(TAU / start),
            wavelengths: [TAU / bands[end - 1].x.exp(), TAU / start],
            ends: end < bands.len(),
            level: self.level,
        }
    }
}

/// ln q of a place between two bands, counted in parts from the first band on.
fn knee_at(bands: &[Point], knee: usize) -> Option<f64> {
    let at = |i: usize| bands.get(i).map(|band| band.x);
    let (low, part) = (at(knee / FINE)?, (knee % FINE) as f64 / FINE as f64);
    if part == 0.0 { Some(low) } else { Some(low + part * (at(knee / FINE + 1)? - low)) }
}

#[cfg(test)]
mod tests {
    use asperity::math::SplitMix64;

    use super::*;

    /// 12 bands a decade from 10 rad/m, with so many modes, constant to `q_r`, falling with H to `q_c`, hardly there
    /// beyond.
    fn bands(hurst: f64, q_r: f64, q_c: f64, noise: f64) -> Vec<Band> {
        let mut random = SplitMix64::new(1);
        let band = |i: u32| {
            let wave_number = 10_f64.powf(1.0 + f64::from(i) / 12.0);
            let modes = (wave_number / 60.0).ceil() as usize;
            let scatter = noise * (random.unit() - 0.5) / (modes as f64).sqrt();
            let law = (wave_number / q_r).max(1.0).powf(-1.0 - 2.0 * hurst);
            let density = 1e-12 * law * scatter.exp() * if wave_number > q_c { 1e-9 } else { 1.0 };
            Band { wave_number, density, modes }
        };
        (0..48).map(band).collect()
    }

    #[test]
    fn the_exponent_and_its_range_are_found() {
        for hurst in [0.3, 0.8, 1.0] {
            let law = Law::of(&bands(hurst, 200.0, 3e4, 0.0), None).unwrap();
            assert!((law.hurst - hurst).abs() < 0.005, "{law:?}");
            assert!((law.roll_off_wavelength.unwrap() / (TAU / 200.0) - 1.0).abs() < 0.05, "{law:?}");
            assert!(law.ends && (law.wavelengths[0] / (TAU / 3e4) - 1.0).abs() < 0.25, "{law:?}");
            assert!((law.density(100.0) / 1e-12 - 1.0).abs() < 0.02, "{law:?}");
        }
        let law = Law::of(&bands(0.6, 1.0, 1e9, 0.0), None).unwrap();
        assert!(law.roll_off_wavelength.is_none() && !law.ends, "{law:?}");
        assert!((law.hurst - 0.6).abs() < 0.001, "{law:?}");
    }

    #[test]
    fn scatter_moves_it_by_its_error() {
        let law = Law::of(&bands(0.8, 200.0, 1e9, 1.0), None).unwrap();
        assert!((law.hurst - 0.8).abs() < 3.0 * law.hurst_error && law.hurst_error < 0.03, "{law:?}");
    }

    #[test]
    fn a_range_can_be_given_and_a_constant_is_no_law() {
        let asked = 5e-4..=5e-3;
        let law = Law::of(&bands(0.8, 200.0, 3e4, 0.0), Some(&asked)).unwrap();
        assert!((law.hurst - 0.8).abs() < 0.005 && law.wavelengths.iter().all(|length| asked.contains(length)));
        assert!(Law::of(&bands(0.8, 1e9, 1e9, 0.0), None).is_none());
        assert!(Law::of(&[], None).is_none());
    }
}
