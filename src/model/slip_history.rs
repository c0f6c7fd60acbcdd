//! What the past of a contact says of its friction: the temperature that it has left, and the speed that it remembers.
//!
//! # Temperature
//!
//! The flash temperature of a mass in contact follows from the power that friction makes.
//!
//! The power per area is made at depths as the waves that make it, 2q e^(-2qz), flows into the rubber along the depth and
//! counts with the same weight (docs/foundation.md, section 6; B. N. J. Persson, J. Phys.: Condens. Matter 18, 2006, 7789):
//!
//!   ϑ(t) = ∫ κ(t-t') χ F_T v_t/A dt',   κ(t) = (2/πρc) ∫_0^∞ e^(-Dk²t) G(k)² dk,   G(k) = s_a + Σ_b s_b 4q_b²/(k² + 4q_b²)
//!
//! with the diffusivity D and the parts s_b and s_a that the bands and the surface have in friction. κ is a sum of
//! exponentials, by the trapezoidal rule in ln k.
//!
//! # Memory
//!
//! Contacts are renewed over a way D, and age at rest. Where a scene has such a memory, friction follows not the speed of
//! slip v_t but the state v_s of each mass (A. Perrin, J. R. Rice, G. Zheng, J. Mech. Phys. Solids 43, 1995, 1461,
//! written as a speed; docs/foundation.md, section 7):
//!
//!   dv_s/dt = (v_t² - v_s²)/(2D)

use std::f64::consts::{LN_10, PI, SQRT_2};

use crate::scene::{FineBand, Material, Scene, Wlf};

/// χ κ(t) as Σ_j w_j e^(-t/t_j), from 1 µs to 100 s.
#[derive(Clone, Debug, PartialEq)]
pub struct FlashKernel {
    /// w_j, K m²/J, and t_j, s, from the longest.
    pub terms: Vec<FlashTerm>,
    /// χ, the part of the power of friction that heats the rubber, 1.
    pub share: f64,
}

/// A term of the kernel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlashTerm {
    /// w_j, K m²/J.
    pub weight: f64,
    /// t_j, s.
    pub time: f64,
}

impl FlashTerm {
    /// Its part of the rise of the temperature under a constant flux of 1 W/m² over a `time` (s), K m²/W.
    pub fn rise(&self, time: f64) -> f64 {
        self.weight * self.time * -(-time / self.time).exp_m1()
    }
}

/// The flash temperature ϑ of a contact with the friction T at the speed v_t, as this makes it: ϑ = `known` + `gain` T v_t.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Flash {
    /// What the past has left, K.
    pub known: f64,
    /// K/W.
    pub gain: f64,
    /// From where ϑ is looked for, K.
    pub guess: f64,
}

impl Flash {
    /// A temperature that is held, K.
    pub fn held(known: f64) -> Self {
        Self { known, gain: 0.0, guess: known }
    }
}

/// How the flash temperature shifts the speeds of friction: by a_T(T + ϑ)/a_T(T).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedShift {
    /// C_1 ln 10.
    c1: f64,
    /// C_2, K.
    c2: f64,
    /// T - T_ref, K.
    above: f64,
    /// ln a_T(T).
    at_layer: f64,
}

impl SpeedShift {
    /// The shift of a scene; `None` where friction heats nothing.
    pub fn new(scene: &Scene) -> Option<Self> {
        let material = scene.material.as_ref()?;
        let (Wlf { c1, c2, reference_temperature, temperature }, _) = (material.wlf?, material.heat?);
        let above = temperature - reference_temperature;
        let c1 = c1 * LN_10;
        Some(Self { c1, c2, above, at_layer: -c1 * above / (c2 + above) })
    }

    /// a_T(T + ϑ)/a_T(T) and the derivative of its logarithm by ϑ, 1/K; that at [`Wlf::ABOVE_POLE`] where it is colder.
    pub fn ratio(&self, flash: f64) -> (f64, f64) {
        let above = self.above + flash;
        let (from_pole, is_colder) = ((self.c2 + above).max(Wlf::ABOVE_POLE), self.c2 + above < Wlf::ABOVE_POLE);
        let shift = -self.c1 * (from_pole - self.c2) / from_pole;
        let slope = if is_colder { 0.0 } else { -self.c1 * self.c2 / (from_pole * from_pole) };
        ((shift - self.at_layer).exp(), slope)
    }
}

/// How a kernel becomes a sum of exponentials.
struct KernelFit {
    /// The times between which it is to be right, s.
    shortest: f64,
    longest: f64,
    /// How far the terms go beyond the wave numbers 1/√(Dt) of these times on either side: between their ends the rule
    /// takes its steps, what is beyond is lumped into the first and the last term by its first two moments.
    beyond: f64,
    terms: usize,
}

/// A flash temperature's kernel is right within 2 %, and its integral from 0 within 1 %.
///
/// Recommended 2 to 10 beyond, with 16 to 24 terms. The rule's steps err by 1e-4 of the integral with 3 and 20.
const FLASH_FIT: KernelFit = KernelFit { shortest: 1e-6, longest: 100.0, beyond: 3.0, terms: FlashKernel::TERMS };

/// The rise of a surface over its whole way: its integral from 0 is right within 0.8 %, the least with eight terms.
const SURFACE_FIT: KernelFit = KernelFit { shortest: 1e-3, longest: 1e3, beyond: 1.8, terms: SURFACE_TERMS };

/// The number of terms of a [`surface_kernel`].
pub const SURFACE_TERMS: usize = 8;

/// Steps of the rule on either side of the terms that are lumped: some ten decades of wave numbers.
const LUMPED: usize = 50;

impl KernelFit {
    /// ∫ e^(-Dk²t) g(k) dk of the diffusivity D (m²/s), by the trapezoidal rule in ln k; `density` is k g(k).
    fn exponentials(&self, diffusivity: f64, density: impl Fn(f64) -> f64) -> Vec<FlashTerm> {
        // From wave numbers far below the terms to far above.
        let wave_number = |time: f64| 1.0 / (diffusivity * time).sqrt();
        let (low, high) = (wave_number(self.longest) / self.beyond, wave_number(self.shortest) * self.beyond);
        let step = (high / low).ln() / (self.terms - 1) as f64;
        let term = |j: usize| {
            let k = low * (step * (j as f64 - LUMPED as f64)).exp();
            FlashTerm { weight: density(k) * step, time: 1.0 / (diffusivity * k * k) }
        };
        let all: Vec<FlashTerm> = (0..LUMPED + self.terms + LUMPED).map(term).collect();
        // What is slow counts by κ and its slope, what is fast by the integral of κ and that of tκ.
        let moment = |terms: &[FlashTerm], power: i32| -> f64 {
            terms.iter().map(|term| term.weight * term.time.powi(power)).sum()
        };
        let last = self.terms - 1;
        let (slow, fast) = (&all[..=LUMPED], &all[LUMPED + last..]);
        let mut terms = all[LUMPED..=LUMPED + last].to_vec();
        terms[0] = FlashTerm { weight: moment(slow, 0), time: moment(slow, 0) / moment(slow, -1) };
        let time = moment(fast, 2) / moment(fast, 1);
        terms[last] = FlashTerm { weight: moment(fast, 1) / time, time };
        terms
    }
}

/// χ κ(t) of power that is made at the surface alone, χ/√(πkρc t), as exponentials: under a constant one the rise is
/// 2χ√t/√(πkρc) within 1 % from 1 ms to 1000 s. Of the share χ, the conductivity k (W/(m K)) and the heat capacity ρc
/// (J/(m³ K)).
pub fn surface_kernel(share: f64, conductivity: f64, capacity: f64) -> [FlashTerm; SURFACE_TERMS] {
    let terms = SURFACE_FIT.exponentials(conductivity / capacity, |k| share * 2.0 / (PI * capacity) * k);
    std::array::from_fn(|i| terms[i])
}

/// The speed at whose friction its parts are taken, m/s.
const SPEED_OF_PARTS: f64 = 1.0;

impl FlashKernel {
    /// The number of terms.
    pub const TERMS: usize = 20;

    /// The kernel of a scene; `None` where friction heats nothing.
    pub fn new(scene: &Scene) -> Option<Self> {
        let material = scene.material.as_ref()?;
        let heat = material.heat?;
        let parts = HeatParts::new(scene, material);
        let capacity = material.density * heat.capacity;
        let diffusivity = heat.conductivity / capacity;
        let terms = FLASH_FIT.exponentials(diffusivity, |k| {
            let share = parts.share(k);
            heat.share * 2.0 / (PI * capacity) * k * share * share
        });
        Some(Self { terms, share: heat.share })
    }

    /// χ κ(t), K m²/J.
    pub fn value(&self, time: f64) -> f64 {
        self.terms.iter().map(|term| term.weight * (-time / term.time).exp()).sum()
    }

    /// The rise of the temperature under a constant flux of 1 W/m² over a time (s), K m²/W.
    pub fn rise(&self, time: f64) -> f64 {
        self.terms.iter().map(|term| term.rise(time)).sum()
    }
}

/// The parts s_b and s_a that bands and surface have in friction at p → 0, together 1.
#[derive(Clone, Debug)]
pub struct HeatParts {
    /// q_b (rad/m) and s_b.
    bands: Vec<(f64, f64)>,
    surface: f64,
}

impl HeatParts {
    /// Those of a scene of this material.
    pub fn new(scene: &Scene, material: &Material) -> Self {
        let bands = scene.fine_bands();
        let speed = SPEED_OF_PARTS.max(scene.fine_creep_speed());
        // μ_h of each band and A_r/(A p), for p → 0.
        let mut stress_square = 0.0;
        let rubs = scene.has_fine_hysteresis();
        let friction = |band: &FineBand| {
            let moduli = band.moduli(material, speed);
            let own = band.gradient_square * moduli.square;
            let middle = stress_square + 0.5 * own;
            stress_square += own;
            if rubs {
                3.0 * SQRT_2 / (4.0 * PI.sqrt()) * band.gradient_square * moduli.loss / middle.sqrt()
            } else {
                0.0
            }
        };
        let of_bands: Vec<f64> = bands.iter().map(friction).collect();
        let shear = scene.shear_strength_at(speed) * 2.0 / stress_square.sqrt();
        let surface = shear + scene.friction.as_ref().and_then(|friction| friction.coulomb).unwrap_or(0.0);
        let whole = of_bands.iter().sum::<f64>() + surface;
        // Nothing rubs, or all of a contact touches for there are no waves.
        if whole <= 0.0 || !whole.is_finite() {
            return Self { bands: Vec::new(), surface: 1.0 };
        }
        let bands = bands.iter().zip(&of_bands).map(|(band, part)| (band.wave_number, part / whole)).collect();
        Self { bands, surface: surface / whole }
    }

    /// G(k) at the wave number k (rad/m) along the depth, 1.
    pub fn share(&self, k: f64) -> f64 {
        let band = |&(q, part): &(f64, f64)| part * 4.0 * q * q / (k * k + 4.0 * q * q);
        self.surface + self.bands.iter().map(band).sum::<f64>()
    }
}

/// What is known of the flash temperature and of the remembered speed of a contact before its friction is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SlipHistory {
    /// The flash temperature as friction makes it.
    pub flash: Flash,
    /// The remembered speed as v_t makes it; `None`: that of slip itself, as in even sliding.
    pub memory: Option<SpeedMemory>,
}

impl SlipHistory {
    /// Even sliding at this flash temperature, K.
    pub fn even(flash: f64) -> Self {
        Self { flash: Flash::held(flash), memory: None }
    }
}

/// The speed v_s that a contact remembers, as its speed v_t makes it: v_s = `base` + `weight` (v_t² - v_s²).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpeedMemory {
    /// What the past has left, m/s.
    pub base: f64,
    /// β/(2D) of the time β in which v_s follows, s/m.
    pub weight: f64,
}

/// v_s at one v_t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RememberedSpeed {
    /// v_s, m/s.
    pub value: f64,
    /// ∂v_s/∂v_t.
    pub by_speed: f64,
    /// ∂v_s by the base.
    pub by_base: f64,
}

impl SpeedMemory {
    /// A speed that is held, m/s.
    pub fn held(speed: f64) -> Self {
        Self { base: speed, weight: 0.0 }
    }

    /// v_s at `speed`, v_t in m/s of either sign; 0 where a step is so long that there is none.
    #[inline]
    pub fn at(&self, speed: f64) -> RememberedSpeed {
        let known = self.base + self.weight * (speed * speed);
        if known <= 0.0 {
            return RememberedSpeed { value: 0.0, by_speed: 0.0, by_base: 0.0 };
        }
        let value = 2.0 * known / (1.0 + (1.0 + 4.0 * self.weight * known).sqrt());
        let by_base = 1.0 / (1.0 + 2.0 * self.weight * value);
        RememberedSpeed { value, by_speed: 2.0 * self.weight * speed * by_base, by_base }
    }
}

/// dv_s/dt, m/s², of a contact that slips at `speed`, remembers `remembered` (m/s) and renews over the way D = `way`, m.
#[inline]
pub fn memory_rate(way: f64, speed: f64, remembered: f64) -> f64 {
    // (v_t² - v_s²)/(2D) without cancellation.
    (speed.abs() - remembered) * (speed.abs() + remembered) / (2.0 * way)
}

/// v_s, m/s, of a contact that remembers `remembered` and then sticks for a `time` (s): 1/v_s grows by t/(2D).
#[inline]
pub fn aged(way: f64, remembered: f64, time: f64) -> f64 {
    remembered / (1.0 + remembered * time / (2.0 * way))
}

#[cfg(test)]
mod tests {
    use super::*;

    const WAY: f64 = 5e-5;

    /// v_s = v tanh(vt/2D + artanh(v_s0/v)) at a constant v, by implicit Euler steps: of order 1.
    #[test]
    fn a_constant_speed_is_followed_as_the_equation_says() {
        let (speed, from, time) = (0.3_f64, 0.05_f64, 2e-4);
        let exact = speed * (speed * time / (2.0 * WAY) + (from / speed).atanh()).tanh();
        let error = |steps: u32| {
            let weight = time / f64::from(steps) / (2.0 * WAY);
            let end = (0..steps).fold(from, |base, _| SpeedMemory { base, weight }.at(speed).value);
            (end - exact).abs()
        };
        let ratio = error(200) / error(400);
        assert!((ratio - 2.0).abs() < 0.05, "{ratio}");
        assert!(error(400) < 1e-3 * exact);
    }

    /// Whatever the speed its solution is positive and satisfies v_s + a v_s² = b + a v_t²; its derivatives are quotients'.
    #[test]
    fn the_remembered_speed_solves_its_equation() {
        for (base, weight) in [(0.1, 0.0), (0.1, 5.0), (1e-9, 1e6), (-1e-3, 10.0), (-1.0, 10.0)] {
            let memory = SpeedMemory { base, weight };
            for speed in [-3.0, -1e-6, 0.0, 1e-3, 0.3, 20.0] {
                let found = memory.at(speed);
                let known = base + weight * speed * speed;
                if known <= 0.0 {
                    assert_eq!(found.value, 0.0);
                    continue;
                }
                let left = found.value + weight * found.value * found.value;
                assert!(found.value > 0.0 && (left - known).abs() < 1e-14 * known, "{memory:?} {speed}");
                let quotient =
                    |up: RememberedSpeed, down: RememberedSpeed, step: f64| (up.value - down.value) / (2.0 * step);
                let (of_speed, of_base) = (1e-6 * speed.abs().max(1e-3), 1e-6 * known);
                let by_speed = quotient(memory.at(speed + of_speed), memory.at(speed - of_speed), of_speed);
                let moved = |by: f64| SpeedMemory { base: base + by, ..memory }.at(speed);
                let by_base = quotient(moved(of_base), moved(-of_base), of_base);
                // The third derivatives times the step squared, and roundings over the step.
                let near = |found: f64, quotient: f64| (found - quotient).abs() < 1e-5 * (1.0 + quotient.abs());
                assert!(near(found.by_speed, by_speed), "{memory:?} {speed}: {found:?} {by_speed}");
                assert!(near(found.by_base, by_base), "{memory:?} {speed}: {found:?} {by_base}");
            }
        }
    }

    /// 1/v_s grows by t/2D at rest, in one step as in two.
    #[test]
    fn what_rests_ages() {
        let (speed, time) = (2.0, 3e-3);
        let whole = aged(WAY, speed, time);
        assert!((1.0 / whole - (1.0 / speed + time / (2.0 * WAY))).abs() < 1e-12);
        assert!((aged(WAY, aged(WAY, speed, 0.4 * time), 0.6 * time) / whole - 1.0).abs() < 1e-14);
        assert_eq!(aged(WAY, 0.0, time), 0.0);
    }
}
