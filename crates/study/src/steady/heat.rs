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
use asperity::model::HeatParts;
use asperity::scene::Scene;

/// The step of ln k of the trapezoidal rule: it errs by e^(-π²/(2 step)), 4e-6, as the pole of the integrand is π/4 away.
const STEP: f64 = 0.4;
/// Steps to either side of √(ω/D): what is beyond is e^-8 of the integral's scale.
const REACH: i64 = 20;

/// Steps to either side of 1/√(Dt): what is beyond is e^-12 of the integral's scale.
const REACH_IN_TIME: i64 = 30;

/// 1 - e^-x and x - (1 - e^-x).
fn risen(x: f64) -> (f64, f64) {
    let rise = -(-x).exp_m1();
    // Where their difference would be of roundings, by its series.
    let of_rise = if x < 1e-3 { x * x * (0.5 - x / 6.0 * (1.0 - 0.25 * x)) } else { x - rise };
    (rise, of_rise)
}

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

    /// χ ∫_0^t κ and χ ∫_0^t ∫_0^t' κ at the time t (s), K m²/W and K m² s/W.
    pub fn rises(&self, time: f64) -> [f64; 2] {
        let middle = (-0.5 * (self.diffusivity * time).ln() / STEP).round() as i64;
        let (mut once, mut twice) = (0.0, 0.0);
        for place in middle - REACH_IN_TIME..=middle + REACH_IN_TIME {
            let k = (STEP * place as f64).exp();
            let (rate, weight) = (self.diffusivity * k * k, k * self.parts.share(k).powi(2));
            let (rise, of_rise) = risen(rate * time);
            once += weight * rise / rate;
            twice += weight * of_rise / (rate * rate);
        }
        [once, twice].map(|sum| self.scale * STEP * sum)
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Heat made at the surface alone: κ(t) = 1/√(πλρc t), so κ̂(ω) = 1/√(iω λρc), at every frequency.
    #[test]
    fn heat_of_the_surface_warms_as_a_half_space() {
        let text = "name = 'h'\nlayer = { foundation = 'half_space', masses = 8, spacing = 1e-4, width = 1e-2 }\n\
                    material = { density = 1100.0, poisson_ratio = 0.49, equilibrium_modulus = 5e6, prony = [], \
                    wlf = { c1 = 7.0, c2 = 120.0, reference_temperature = 293.0, temperature = 293.0 }, \
                    heat = { conductivity = 0.25, capacity = 1700.0, share = 0.5 } }\n\
                    friction = { coulomb = 0.5 }\n\
                    surface = { kind = 'sinusoid', amplitude = 1e-5, wavelength = 1e-3, \
                    fine = { hurst = 0.8, rms_slope = 1e-9, longest = 1e-3, shortest = 1e-4, hysteresis = false } }";
        let scene = Scene::parse(text, "heat.toml".as_ref()).unwrap_or_else(|error| unreachable!("{error}"));
        let Some(response) = HeatResponse::new(&scene) else { unreachable!("the scene has heat") };
        let effusivity = (0.25_f64 * 1700.0 * 1100.0).sqrt();
        for step in [1e-3, 1.0, 1e6] {
            for (i, value) in response.at_multiples(step, 100).into_iter().enumerate() {
                let omega = step * (i + 1) as f64;
                let exact = Complex::new(0.5, -0.5) * (2.0_f64.sqrt() * 0.5 / (effusivity * omega.sqrt()));
                // What the rule leaves out beyond its ends, e^-8.
                assert!((value - exact).norm() < 1e-3 * exact.norm(), "{omega}: {value} for {exact}");
            }
        }
    }

    /// Of bands and surface: the rise by the terms of a layer's contacts is right within 1 %, and its integral is that of it.
    #[test]
    fn rises_are_those_of_the_kernel() {
        let text = "name = 'h'\nlayer = { foundation = 'half_space', masses = 8, spacing = 1e-4, width = 1e-2 }\n\
                    material = { density = 1100.0, poisson_ratio = 0.49, equilibrium_modulus = 5e6, prony = [ \
                    { modulus = 2e7, relaxation_time = 1e-6 } ], \
                    wlf = { c1 = 7.0, c2 = 120.0, reference_temperature = 293.0, temperature = 293.0 }, \
                    heat = { conductivity = 0.25, capacity = 1700.0, share = 0.5 } }\n\
                    friction = { shear_strength = 1e6 }\n\
                    surface = { kind = 'sinusoid', amplitude = 1e-5, wavelength = 1e-3, \
                    fine = { hurst = 0.8, rms_slope = 1.0, longest = 1e-3, shortest = 1e-6 } }";
        let scene = Scene::parse(text, "heat.toml".as_ref()).unwrap_or_else(|error| unreachable!("{error}"));
        let (Some(response), Some(kernel)) = (HeatResponse::new(&scene), asperity::model::FlashKernel::new(&scene))
        else {
            unreachable!("the scene has heat")
        };
        for time in [1e-5, 1e-3, 0.1, 10.0] {
            let [rise, twice] = response.rises(time);
            assert!((rise / kernel.rise(time) - 1.0).abs() < 1e-2, "{time}");
            // Simpson's rule over √t, in which the rise is smooth.
            let at = |i: usize| {
                let root = (i as f64 / 64.0) * time.sqrt();
                if i == 0 { 0.0 } else { 2.0 * root * response.rises(root * root)[0] }
            };
            let weight = |i: usize| {
                if i == 0 || i == 64 {
                    1.0
                } else if i % 2 == 1 {
                    4.0
                } else {
                    2.0
                }
            };
            let simpson: f64 = (0..=64).map(|i| weight(i) * at(i)).sum::<f64>() * time.sqrt() / 192.0;
            assert!((twice / simpson - 1.0).abs() < 1e-4, "{time}: {twice} for {simpson}");
        }
    }
}
