//! What a layer and a profile say before any run: where w has to be for a load, about, and how long a block is.

use asperity::model::{LinkKind, Model};
use asperity::scene::Scene;

use super::slide::Way;

/// A periodic profile is gone over whole, block by block, where its period is no longer than so many layers.
const LONGEST_PERIOD: f64 = 20.0;
/// Samples a block at least and at most; between, as many as the block has data points of the profile.
const SAMPLES: (f64, f64) = (128.0, 2048.0);
/// Halvings of the interval in which w lies.
const HALVINGS: usize = 60;

/// Heights of the layer over the profile, pair by pair: all that a layer of bars side by side knows.
#[derive(Clone, Debug)]
pub(super) struct Bars {
    /// z_r of evenly spaced places less Z_i, m: how far each bar would be lifted at w = 0.
    lifts: Vec<f64>,
    /// Stiffness of all bars together, N/m.
    stiffness: f64,
}

impl Bars {
    /// The layer of `model` in the long run: its vertical springs alone.
    pub(super) fn new(model: &Model, heights: &[f64]) -> Self {
        let stiffness = model.links[LinkKind::Vertical as usize].stiffness;
        let stiffness = if stiffness > 0.0 { stiffness } else { model.mass_stiffness() };
        let mut rest = model.rest_z.clone();
        rest.sort_by(f64::total_cmp);
        rest.dedup();
        // Roughness of many heights: some of them stand for all.
        let every = rest.len().div_ceil(16);
        let rest = rest.iter().step_by(every);
        let lifts = rest.flat_map(|z| heights.iter().map(move |height| height - z)).collect();
        Self { lifts, stiffness: stiffness * model.masses() as f64 }
    }

    /// F_z at w, N, and how it grows as w falls, N/m.
    fn force(&self, w: f64) -> (f64, f64) {
        let pressed = self.lifts.iter().map(|lift| lift - w).filter(|pressed| *pressed > 0.0);
        let (sum, count) = pressed.fold((0.0, 0.0), |(sum, count), pressed| (sum + pressed, count + 1.0));
        let each = self.stiffness / self.lifts.len() as f64;
        (each * sum, each * count)
    }

    /// w at which F_z is `load` (N), m, and how F_z grows there as w falls, N/m.
    pub(super) fn displacement(&self, load: f64) -> (f64, f64) {
        let mut high = self.lifts.iter().copied().fold(f64::MIN, f64::max);
        let mut low = self.lifts.iter().copied().fold(f64::MAX, f64::min).min(high) - load / self.stiffness;
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(low, high);
            if self.force(middle).0 > load { low = middle } else { high = middle }
        }
        (low, self.force(low).1)
    }
}

/// Heights of the profile at its data points and between them, m, evenly over the whole of it.
pub(super) fn heights(scene: &Scene, model: &Model) -> Vec<f64> {
    let (first, last) = ends(scene);
    let count = 4 * scene.surface.x.len();
    let place = |i: usize| first + (last - first) * (i as f64 + 0.5) / count as f64;
    (0..count).map(|i| model.surface_at(place(i)).height).collect()
}

/// Clearance and mean roughness above the profile's mean: how far the carrier's rest line is from it at w = 0, m.
pub(super) fn rest_separation(model: &Model, heights: &[f64]) -> f64 {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    mean(&model.rest_z) - mean(heights)
}

/// The way of a layer over the scene's profile at `speed` (m/s).
pub(super) fn way(scene: &Scene, speed: f64) -> Way {
    let (first, last) = ends(scene);
    let length = scene.layer.spacing * scene.layer.masses as f64;
    let flat = scene.surface.z.iter().all(|z| *z == scene.surface.z[0]);
    let period = last - first;
    let whole = scene.surface.periodic && !flat && period <= LONGEST_PERIOD * length;
    let block = if whole { period } else { length };
    let points = block / period * scene.surface.x.len() as f64;
    let samples = points.clamp(SAMPLES.0, SAMPLES.1) as u32;
    if flat || scene.surface.periodic {
        return Way { speed, block, samples, start: 0.0, end: f64::INFINITY };
    }
    let room = (period - length + scene.layer.spacing).max(0.0);
    Way { speed, block, samples, start: first - scene.layer.origin, end: room }
}

fn ends(scene: &Scene) -> (f64, f64) {
    let x = &scene.surface.x;
    (x.first().copied().unwrap_or(0.0), x.last().copied().unwrap_or(1.0))
}
