//! The flash temperature of a surface of rubber in steady sliding.
//!
//! A point of rubber at x was at x - v t' a time t' before, so what friction makes at the waves q_x has warmed it by
//!
//!   ϑ_q = κ̂(q_x v) χ (T v/A)_q,   κ̂(ω) = ∫_0^∞ κ(t) e^(-iωt) dt = (2/πρc) ∫_0^∞ G(k)²/(Dk² + iω) dk
//!
//! with the kernel κ of one contact ([`HeatParts`]). ϑ counts from the mean along the line of sliding, which grows with all
//! that went before.

use std::f64::consts::PI;

use rustfft::num_complex::Complex;

use super::surface::SurfaceGrid;
use crate::model::HeatParts;
use crate::scene::Scene;

/// The step of ln k of the trapezoidal rule: it errs by e^(-π²/(2 step)), 4e-6, as the pole of the integrand is π/4 away.
const STEP: f64 = 0.4;
/// Steps to either side of √(ω/D): what is beyond is e^-8 of the integral's scale.
const REACH: i64 = 20;

/// How a surface warms under power that is even along its depth but for the waves that make it.
#[derive(Clone, Debug)]
pub struct HeatResponse {
    /// D, m²/s.
    diffusivity: f64,
    /// χ 2/(πρc), K m³/J.
    scale: f64,
    parts: HeatParts,
}

impl HeatResponse {
    /// That of a scene; `None` where friction heats nothing.
    pub fn new(scene: &Scene) -> Option<Self> {
        let material = scene.material.as_ref()?;
        let heat = material.heat?;
        let capacity = material.density * heat.capacity;
        Some(Self {
            diffusivity: heat.conductivity / capacity,
            scale: heat.share * 2.0 / (PI * capacity),
            parts: HeatParts::new(scene, material),
        })
    }

    /// χ κ̂ at the angular frequencies `step`, 2 `step`, … (rad/s), K m²/W.
    pub fn at_multiples(&self, step: f64, count: usize) -> Vec<Complex<f64>> {
        // The same even steps of ln k for all frequencies, each with k G².
        let place = |omega: f64| (0.5 * (omega / self.diffusivity).ln() / STEP).round() as i64;
        let (first, last) = (place(step) - REACH, place(step * count as f64) + REACH);
        let node = |place: i64| {
            let k = (STEP * place as f64).exp();
            (self.diffusivity * k * k, k * self.parts.share(k).powi(2))
        };
        let nodes: Vec<(f64, f64)> = (first..=last).map(node).collect();
        let value = |n: usize| {
            let omega = step * n as f64;
            let start = (place(omega) - REACH - first) as usize;
            let (mut real, mut imaginary) = (0.0, 0.0);
            for (rate, weight) in &nodes[start..=start + 2 * REACH as usize] {
                let part = weight / (rate * rate + omega * omega);
                real += rate * part;
                imaginary -= part;
            }
            self.scale * STEP * Complex::new(real, omega * imaginary)
        };
        (1..=count).map(value).collect()
    }

    /// The kernel that makes ϑ (K) of the power per area (W/m²) on the grid of `surface` at `speed`, m/s.
    pub(super) fn kernel(&self, surface: &SurfaceGrid, speed: f64) -> Vec<Complex<f64>> {
        let (size, share) = (surface.size, surface.share_of_point());
        let step = surface.wave_number(1) * speed;
        let mean = std::iter::once(Complex::from(0.0));
        let columns = mean.chain(self.at_multiples(step, size.columns() - 1)).enumerate().map(|(column, value)| {
            if size.is_shortest(column) { Complex::from(share * value.re) } else { share * value }
        });
        columns.flat_map(|value| std::iter::repeat_n(value, size.ny)).collect()
    }
}
