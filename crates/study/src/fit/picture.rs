//! The picture of a fit: data as rings, the fit as lines; of several temperatures the master curve.

use std::f64::consts::TAU;

use super::{FittedModuli, Sample, Test};
use crate::decimals::{plain, rounded};
use crate::picture::{Mark, Picture};

/// Points of the fit's curves.
const POINTS_PER_DECADE: f64 = 20.0;

impl FittedModuli {
    /// The moduli, and how the errors add up.
    pub fn picture(&self) -> Picture {
        let unit = if self.counts_cycles() { TAU } else { 1.0 };
        let places = between(self.samples());
        let curves = |name: &str, look: usize, measured: fn(&Sample) -> f64, of_fit: fn((f64, f64)) -> f64| {
            let points = self.samples().iter().map(|sample| [sample.at / unit, measured(sample)]).collect();
            let line = places.iter().map(|&at| [at / unit, of_fit(self.response(at))]).collect();
            [Mark::rings(format!("{name} measured"), look, points), Mark::line(format!("{name} fitted"), look, line)]
        };
        let mut panels = if self.test() == Test::Oscillation {
            let storage = curves("E'", 0, |sample| sample.storage, |(storage, _)| storage);
            let loss = curves("E''", 1, |sample| sample.loss, |(_, loss)| loss);
            let tangent = curves("tan δ", 2, |sample| sample.loss / sample.storage, |(storage, loss)| loss / storage);
            vec![(("modulus", "Pa"), [storage, loss].concat()), (("tan δ", ""), tangent.to_vec())]
        } else {
            let relaxed = curves("E(t)", 0, |sample| sample.storage, |(storage, _)| storage);
            vec![(("modulus", "Pa"), relaxed.to_vec())]
        };
        panels.push((("rms error up to there, %", ""), self.misfit(unit)));
        Picture::stacked((&self.x_title(), ""), panels)
    }

    /// How the errors add up to those of the fit, in per cent, over frequencies in `unit`.
    fn misfit(&self, unit: f64) -> Vec<Mark> {
        /// Of the whole: what is less is not drawn.
        const LEAST: f64 = 0.01;
        let sums = self.cumulative_errors();
        let names: &[&str] = if self.test() == Test::Oscillation { &["E'", "E''"] } else { &["E(t)"] };
        let curve = |(look, name): (usize, &&str)| {
            let whole = sums.last().map_or(0.0, |sums| sums[1 + look]);
            let seen = sums.iter().filter(|sums| sums[1 + look] > LEAST * whole);
            let points = seen.map(|sums| [sums[0] / unit, 100.0 * sums[1 + look]]).collect();
            Mark::line(format!("{name} off the fit"), look, points)
        };
        names.iter().enumerate().map(curve).collect()
    }

    fn x_title(&self) -> String {
        let quantity = match (self.test(), self.counts_cycles()) {
            (Test::Relaxation, _) => "time in s",
            (Test::Oscillation, true) => "frequency in Hz",
            (Test::Oscillation, false) => "angular frequency in rad/s",
        };
        let shifted = |reference: f64| format!("{quantity}, shifted to {} K", plain(rounded(reference, 6)));
        self.reference().map_or_else(|| quantity.into(), shifted)
    }
}

/// Angular frequencies or times over the range of `samples`, evenly spaced in the logarithm.
fn between(samples: &[Sample]) -> Vec<f64> {
    let places = samples.iter().map(|sample| sample.at.log10());
    let (low, high) = places.fold((f64::MAX, f64::MIN), |(low, high), place| (low.min(place), high.max(place)));
    let intervals = ((high - low) * POINTS_PER_DECADE).ceil().max(1.0);
    (0..=intervals as usize).map(|i| 10.0_f64.powf(low + (high - low) * i as f64 / intervals)).collect()
}
