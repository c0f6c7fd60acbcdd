//! The flash temperature of a mass in contact: how it follows from the power that friction makes.
//!
//! The power per area is made at depths as the waves that make it, 2q e^(-2qz), flows into the rubber along the depth and
//! counts with the same weight (docs/foundation.md, section 6; B. N. J. Persson, J. Phys.: Condens. Matter 18, 2006, 7789):
//!
//!   ϑ(t) = ∫ κ(t-t') χ F_T v_t/A dt',   κ(t) = (2/πρc) ∫_0^∞ e^(-Dk²t) G(k)² dk,   G(k) = s_a + Σ_b s_b 4q_b²/(k² + 4q_b²)
//!
//! with the diffusivity D and the parts s_b and s_a that the bands and the surface have in friction. κ is a sum of
//! exponentials, by the trapezoidal rule in ln k.

use std::f64::consts::{PI, SQRT_2};

use crate::scene::{FineBand, Material, Scene};

/// χ κ(t) as Σ_j w_j e^(-t/t_j), from [`SHORTEST`] to [`LONGEST`].
#[derive(Clone, Debug, PartialEq)]
pub struct FlashKernel {
    /// w_j, K m²/J, and t_j, s, from the longest.
    pub terms: Vec<FlashTerm>,
}

/// A term of the kernel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlashTerm {
    /// w_j, K m²/J.
    pub weight: f64,
    /// t_j, s.
    pub time: f64,
}

/// The times between which the kernel is right within 2 %, and its integral from 0 within 1 %, s.
const SHORTEST: f64 = 1e-6;
const LONGEST: f64 = 100.0;
/// The terms, and how far they go beyond the wave numbers 1/√(Dt) of these times, to the small and to the large side.
///
/// Recommended 18 to 24, 5 to 20 and 20 to 50. Between them the integral from 0 needs what κ does before the shortest time.
const TERMS: usize = 20;
const BEYOND: (f64, f64) = (10.0, 30.0);

/// The speed at whose friction its parts are taken, m/s.
const SPEED_OF_PARTS: f64 = 1.0;

impl FlashKernel {
    /// The kernel of a scene; `None` where friction heats nothing.
    pub fn new(scene: &Scene) -> Option<Self> {
        let material = scene.material.as_ref()?;
        let heat = material.heat?;
        let parts = HeatParts::new(scene, material);
        let capacity = material.density * heat.capacity;
        let diffusivity = heat.conductivity / capacity;
        let wave_number = |time: f64| 1.0 / (diffusivity * time).sqrt();
        let (low, high) = (wave_number(LONGEST) / BEYOND.0, wave_number(SHORTEST) * BEYOND.1);
        let step = (high / low).ln() / (TERMS - 1) as f64;
        let term = |j: usize| {
            let k = low * (step * j as f64).exp();
            // The first stands for all smaller wave numbers, too: a geometric series.
            let width = if j == 0 { step / (1.0 - (-step).exp()) } else { step };
            let share = parts.share(k);
            let weight = heat.share * 2.0 / (PI * capacity) * k * share * share * width;
            FlashTerm { weight, time: 1.0 / (diffusivity * k * k) }
        };
        Some(Self { terms: (0..TERMS).map(term).collect() })
    }

    /// χ κ(t), K m²/J.
    pub fn value(&self, time: f64) -> f64 {
        self.terms.iter().map(|term| term.weight * (-time / term.time).exp()).sum()
    }

    /// The rise of the temperature under a constant flux of 1 W/m² over a time (s), K m²/W.
    pub fn rise(&self, time: f64) -> f64 {
        self.terms.iter().map(|term| term.weight * term.time * -(-time / term.time).exp_m1()).sum()
    }
}

/// The parts s_b and s_a that bands and surface have in friction at p → 0, together 1.
#[derive(Clone, Debug)]
struct HeatParts {
    /// q_b (rad/m) and s_b.
    bands: Vec<(f64, f64)>,
    surface: f64,
}

impl HeatParts {
    fn new(scene: &Scene, material: &Material) -> Self {
        let (bands, softening) = (scene.fine_bands(), scene.fine.as_ref().map_or(1.0, |fine| fine.softening));
        let speed = SPEED_OF_PARTS.max(scene.fine_creep_speed());
        // μ_h of each band and A_r/(A p), for p → 0.
        let mut stress_square = 0.0;
        let rubs = scene.has_fine_hysteresis();
        let friction = |band: &FineBand| {
            let moduli = band.moduli(material, softening, speed);
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
        if whole <= 0.0 {
            return Self { bands: Vec::new(), surface: 1.0 };
        }
        let bands = bands.iter().zip(&of_bands).map(|(band, part)| (band.wave_number, part / whole)).collect();
        Self { bands, surface: surface / whole }
    }

    /// G(k).
    fn share(&self, k: f64) -> f64 {
        let band = |&(q, part): &(f64, f64)| part * 4.0 * q * q / (k * k + 4.0 * q * q);
        self.surface + self.bands.iter().map(band).sum::<f64>()
    }
}
