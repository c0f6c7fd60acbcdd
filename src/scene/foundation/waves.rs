//! The waves of a surface that a layer resolves, and what each counts in the fit of the links.

use std::f64::consts::{PI, TAU};

use crate::scene::spectrum::Spectrum;
use crate::scene::{Layer, Surface};

/// A wave of the profile or of the layer's roughness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    /// Wave number q, rad/m.
    pub wave_number: f64,
    /// Mean square height z², m².
    pub mean_square: f64,
    /// Weight w = q² z², the mean square slope: the stress power of full contact but for constants.
    pub weight: f64,
}

/// Weighted wave numbers that the links of a layer are fitted at.
#[derive(Clone, Debug, PartialEq)]
pub struct Waves {
    /// Spacing Δx of the masses, m.
    spacing: f64,
    /// The waves from 2π/(kΔx) to π/Δx, in order of their wave numbers.
    pub resolved: Vec<Wave>,
    /// Part of the weight of all waves that is beyond π/Δx, 1.
    pub beyond: f64,
    /// λ_c, m: the longest wavelength at and below which there is no more than 1 % of the weight of all waves; 0 where
    /// there are no waves.
    pub shortest: f64,
    /// Root mean square slope of all waves, 1.
    pub slope: f64,
}

/// Waves of less than this part of the largest weight are roundings of the transform.
const ROUNDING: f64 = 1.0e-20;
/// A wave lies within the band if it does but for rounding.
const EDGE: f64 = 1.0e-9;

/// The tail of a wave of the weight 1: the edges of a contact, whose pressure falls as q^-3 in power, add
/// 0.3 ∫ ρ^-3 […] dρ from ρ = 1 to 16.
const TAIL: f64 = 0.3;
const TAIL_END: f64 = 16.0;
const STEPS: usize = 32;

impl Waves {
    /// The waves of `surface` and of the roughness of `layer`; where the layer resolves none, even ones of the same
    /// weight.
    pub(crate) fn new(layer: &Layer, surface: &Surface) -> Self {
        let (spacing, length) = (layer.spacing, layer.spacing * layer.masses as f64);
        let mut waves = waves(&Spectrum::new(surface));
        if !layer.roughness.is_empty() {
            waves.extend(self::waves(&Spectrum::from_roughness(&layer.roughness, length)));
        }
        let largest = waves.iter().map(|wave| wave.weight).fold(0.0, f64::max);
        waves.retain(|wave| wave.weight > ROUNDING * largest);
        waves.sort_by(|a, b| a.wave_number.total_cmp(&b.wave_number));
        let whole = weight_of(&waves);
        let (low, high) = layer.band();
        let beyond: f64 = waves.iter().filter(|wave| !is_within(wave.wave_number, high)).map(|wave| wave.weight).sum();
        let shortest = shortest_wavelength(&waves);
        waves.retain(|wave| layer.resolves(wave.wave_number));
        if waves.is_empty() {
            waves = even(low.min(high), high);
        }
        let beyond = if whole > 0.0 { beyond / whole } else { 0.0 };
        Self { spacing, resolved: waves, beyond, shortest, slope: whole.sqrt() }
    }

    /// Every wave number of the fit (rad/m), with its weight: the waves, and the tail of each up to π/Δx.
    pub(super) fn weighted(&self) -> impl Iterator<Item = (f64, f64)> {
        let last = PI / self.spacing;
        let ratio = |j: usize| TAIL_END.powf((j as f64 + 0.5) / STEPS as f64);
        let tail = move |wave: &Wave| {
            let wave = *wave;
            (0..STEPS).map(move |j| {
                let ratio = ratio(j);
                (wave.wave_number * ratio, wave.weight * TAIL * TAIL_END.ln() / STEPS as f64 / (ratio * ratio))
            })
        };
        let waves = self.resolved.iter();
        let all = waves.flat_map(move |wave| std::iter::once((wave.wave_number, wave.weight)).chain(tail(wave)));
        all.filter(move |(wave_number, _)| is_within(*wave_number, last))
    }

    /// D², 1/m²: what a wave of the heights of the masses is multiplied by where the lateral links pull,
    /// D = (2/Δx) sin(qΔx/2).
    pub(super) fn difference_square(&self, wave_number: f64) -> f64 {
        (2.0 / self.spacing * (0.5 * wave_number * self.spacing).sin()).powi(2)
    }

    /// The waves that carry 5 to 95 % of the weight.
    pub fn carrying(&self) -> &[Wave] {
        let whole = weight_of(&self.resolved);
        let mut sum = 0.0;
        let shares: Vec<f64> = self
            .resolved
            .iter()
            .map(|wave| {
                sum += wave.weight;
                sum / whole
            })
            .collect();
        let start = shares.partition_point(|share| *share < 0.05);
        let end = shares.partition_point(|share| *share < 0.95) + 1;
        &self.resolved[start.min(self.resolved.len())..end.min(self.resolved.len())]
    }
}

impl Layer {
    /// The wave numbers 2π/(kΔx) and π/Δx of the longest and of the shortest wave that the masses resolve, rad/m.
    fn band(&self) -> (f64, f64) {
        (TAU / (self.spacing * self.masses as f64), PI / self.spacing)
    }

    /// Whether the masses resolve a wave of this wave number, rad/m.
    pub fn resolves(&self, wave_number: f64) -> bool {
        let (low, high) = self.band();
        low <= wave_number * (1.0 + EDGE) && is_within(wave_number, high)
    }
}

fn weight_of(waves: &[Wave]) -> f64 {
    waves.iter().map(|wave| wave.weight).sum()
}

fn shortest_wavelength(waves: &[Wave]) -> f64 {
    let mut below = 0.0;
    let most = 0.01 * weight_of(waves);
    let within = |wave: &&Wave| {
        below += wave.weight;
        below <= most
    };
    let last = waves.iter().rev().take_while(within).last().or(waves.last());
    last.map_or(0.0, |wave| TAU / wave.wave_number)
}

fn is_within(wave_number: f64, last: f64) -> bool {
    wave_number <= last * (1.0 + EDGE)
}

fn waves(spectrum: &Spectrum) -> Vec<Wave> {
    spectrum.modes().map(|(wave_number, mean_square)| Wave::new(wave_number, mean_square)).collect()
}

impl Wave {
    fn new(wave_number: f64, mean_square: f64) -> Self {
        Self { wave_number, mean_square, weight: wave_number * wave_number * mean_square }
    }
}

/// Waves of the weight 1 at the middles of even steps of ln q.
fn even(low: f64, high: f64) -> Vec<Wave> {
    let wave_number = |j: usize| low * (high / low).powf((j as f64 + 0.5) / STEPS as f64);
    (0..STEPS).map(|j| Wave { wave_number: wave_number(j), mean_square: 0.0, weight: 1.0 }).collect()
}
