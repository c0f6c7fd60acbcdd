//! How warm the contacts of a surface in steady sliding are.
//!
//! Solves ϑ = κ * χ(τ q1 v) by pseudo-transient continuation: implicit steps of dϑ/dt = κ * χ(τ q1 v) - ϑ, each by Newton's
//! method, with a time step δ that grows. Where a contact is so cold that friction rises with its temperature there are several
//! solutions, and neither fixed-point iteration nor Newton's method alone converges.
//!
//! # Over the way
//!
//! Rubber of one temperature begins to slide. Over the way s = v t its surface warms by
//!
//!   ΔT(t) = ∫_0^t κ(t-t') χ Q(t') dt',   Q = v mean(τ q1)
//!
//! with Q of each place from steady sliding there. The march goes over places even in ln s; Q is linear in t between them, and
//! constant up to the first.

use asperity::math::{dot, sum};
use rustfft::num_complex::Complex;

use super::contact::Contact;
use super::heat::HeatResponse;
use super::krylov::Gmres;
use super::linear::{gather, scatter};
use super::rubber::{SlidingRubber, Slope};
use super::surface::SurfaceGrid;
use super::transform::Convolution;

/// Accuracy of ϑ over its largest.
const FLASH_ACCURACY: f64 = 1.0e-5;
/// The most steps for it, and the most iterations of one.
pub(super) const MOST_STEPS: usize = 400;
const MOST_ITERATIONS: usize = 40;
/// The accuracy of a step over the residual.
const STEP_ACCURACY: f64 = 0.05;
/// Time steps are such that no contact changes by more than this in one, K.
const USUAL_STEP: f64 = 10.0;

/// The points of a surface that touch, and what slides over them.
#[derive(Debug)]
pub(super) struct RubbingContact<'a> {
    pub(super) rubber: &'a SlidingRubber,
    pub(super) contact: &'a Contact,
    /// Of all points of the surface.
    pub(super) slopes: &'a [Slope],
    /// m/s.
    pub(super) speed: f64,
}

/// Contacts that warm, with the memory of the method.
#[derive(Debug)]
pub(super) struct WarmingContact<'a> {
    rubbing: RubbingContact<'a>,
    convolution: &'a mut Convolution,
    kernel: Vec<Complex<f64>>,
    field: Vec<f64>,
    /// The area of the surface that a point stands for, as a share of the whole.
    share: f64,
    gmres: Gmres,
}

/// How the whole surface warms: by `known` + `gain` Q under the mean power Q (W/m²).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SurfaceRise {
    /// K.
    pub(super) known: f64,
    /// χ times a part of ∫κ, K m²/W.
    pub(super) gain: f64,
}

/// Temperatures of the points in contact above that of the rubber, and what they lack of their fixed point.
#[derive(Clone, Debug)]
pub(super) struct Warmth {
    /// ΔT + ϑ, K.
    pub(super) rises: Vec<f64>,
    /// What κ * χ(τ q1 v) is more than that, K.
    residual: Vec<f64>,
    /// Its Euclidean norm.
    norm: f64,
    /// τ q1 v, W/m², and its derivative by ϑ.
    power: Vec<f64>,
    by_flash: Vec<f64>,
    /// Whether it came to its fixed point.
    pub(super) is_solved: bool,
}

impl<'a> WarmingContact<'a> {
    /// On the grid of `surface`.
    pub(super) fn new(
        rubbing: RubbingContact<'a>,
        heat: &HeatResponse,
        surface: &SurfaceGrid,
        convolution: &'a mut Convolution,
    ) -> Self {
        let kernel = heat.kernel(surface, rubbing.speed);
        let (field, share) = (vec![0.0; rubbing.slopes.len()], surface.share_of_point());
        Self { rubbing, convolution, kernel, field, share, gmres: Gmres::default() }
    }

    /// Contacts as warm as the rubber.
    pub(super) fn cold(&self) -> Warmth {
        let zeros = || vec![0.0; self.rubbing.contact.points.len()];
        let (rises, residual, power, by_flash) = (zeros(), zeros(), zeros(), zeros());
        Warmth { rises, residual, norm: 0.0, power, by_flash, is_solved: false }
    }

    /// Mean power of friction per area of the surface, W/m².
    pub(super) fn mean_power(&self, warmth: &Warmth) -> f64 {
        self.share * sum(&warmth.power)
    }

    /// How warm contacts are on a surface that warms so, from how warm they were, in at most so many steps.
    pub(super) fn solve(&mut self, surface: SurfaceRise, mut now: Warmth, most: usize) -> Warmth {
        self.kernel[0] = Complex::from(self.share * surface.gain);
        self.evaluate(&mut now, surface.known);
        let count = now.rises.len();
        let (mut step, mut left, mut power) = (vec![0.0; count], vec![0.0; count], vec![0.0; count]);
        let (mut gmres, mut time_step) = (std::mem::take(&mut self.gmres), 1.0);
        for _ in 0..most {
            if now.is_solved {
                break;
            }
            // The step by how much is left: (1/δ + 1 - κ * χ (τ q1)' v) step = residual.
            step.fill(0.0);
            left.copy_from_slice(&now.residual);
            let tolerance = STEP_ACCURACY * now.norm;
            gmres.solve(&mut step, &mut left, tolerance, MOST_ITERATIONS, |from, direction, image| {
                direction.copy_from_slice(from);
                power.iter_mut().zip(from.iter().zip(&now.by_flash)).for_each(|(power, (from, by))| *power = by * from);
                self.warmed(&power, image);
                image.iter_mut().zip(from).for_each(|(image, from)| *image = (1.0 + 1.0 / time_step) * from - *image);
            });
            now.rises.iter_mut().zip(&step).for_each(|(rise, step)| *rise += step);
            self.evaluate(&mut now, surface.known);
            time_step *= (USUAL_STEP / largest(&step)).clamp(0.3, 3.0);
        }
        self.gmres = gmres;
        now
    }

    fn warmed(&mut self, power: &[f64], warmed: &mut [f64]) {
        let points = &self.rubbing.contact.points;
        scatter(points, power, &mut self.field);
        self.convolution.apply(&mut self.field, &self.kernel);
        gather(points, &self.field, warmed);
    }

    fn evaluate(&mut self, now: &mut Warmth, known: f64) {
        let RubbingContact { rubber, contact, slopes, speed } = self.rubbing;
        let points = contact.points.iter().zip(&contact.pressures).zip(&now.rises);
        for (i, ((&point, &pressure), &rise)) in points.enumerate() {
            let at = rubber.sliding(pressure, &slopes[point as usize], speed, rise);
            (now.power[i], now.by_flash[i]) = (speed * at.friction, speed * at.by_flash);
        }
        self.warmed(&now.power, &mut now.residual);
        now.residual.iter_mut().zip(&now.rises).for_each(|(residual, rise)| *residual += known - rise);
        now.norm = dot(&now.residual, &now.residual).sqrt();
        // Every one is known to a part of the largest.
        now.is_solved = largest(&now.residual) <= FLASH_ACCURACY * largest(&now.rises);
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, value| value.abs().max(largest))
}

/// The places of a march, and the first of them over the whole way.
const PLACES: usize = 20;
const FIRST: f64 = 1.0e-3;
/// The most steps at a place but the last. At the first, where the surface is still cold, contacts often do not come to rest;
/// what they make there counts little at the end.
const STEPS_ON_THE_WAY: usize = 60;

/// What came before a place: the times (s), and the mean powers there, W/m².
#[derive(Debug, Default)]
struct Past {
    times: Vec<f64>,
    powers: Vec<f64>,
}

impl Past {
    /// How the surface warms up to `time`, after the last of these.
    fn rise(&self, heat: &HeatResponse, time: f64) -> SurfaceRise {
        let (Some(&last), Some(&power)) = (self.times.last(), self.powers.last()) else {
            return SurfaceRise { known: 0.0, gain: heat.rises(time)[0] };
        };
        let twice = |since: f64| heat.rises(time - since)[1];
        let segments = self.times.windows(2).zip(self.powers.windows(2));
        let of_segments = segments.map(|(times, powers)| {
            (powers[1] - powers[0]) / (times[1] - times[0]) * (twice(times[0]) - twice(times[1]))
        });
        let gain = twice(last) / (time - last);
        SurfaceRise { known: self.powers[0] * heat.rises(time)[0] + of_segments.sum::<f64>() - power * gain, gain }
    }
}

/// How warm contacts are after the `way` (m) at the `speed` (m/s), and by how much the whole surface has warmed, K.
pub(super) fn march(warming: &mut WarmingContact<'_>, heat: &HeatResponse, speed: f64, way: f64) -> (Warmth, f64) {
    let (mut past, mut warmth, mut rise) = (Past::default(), warming.cold(), 0.0);
    for place in 0..PLACES {
        let left = 1.0 - place as f64 / (PLACES - 1) as f64;
        let time = way / speed * FIRST.powf(left);
        let surface = past.rise(heat, time);
        let most = if place + 1 == PLACES { MOST_STEPS } else { STEPS_ON_THE_WAY };
        warmth = warming.solve(surface, warmth, most);
        let power = warming.mean_power(&warmth);
        rise = surface.known + surface.gain * power;
        past.times.push(time);
        past.powers.push(power);
    }
    (warmth, rise)
}
