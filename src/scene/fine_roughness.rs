//! The roughness below the resolution of the profile, as bands of waves (`surface.fine`).

use std::f64::consts::{FRAC_PI_2, TAU};

use serde::Serialize;

use super::{Friction, Layer, Material, Scene, SelfAffine, Surface, complex_stiffness};

/// The waves that the profile lacks, and how contacts rub on them; in the material form alone.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FineRoughness {
    /// Which waves there are.
    pub waves: FineWaves,
    /// v_c, m/s at the reference temperature: slower slip rubs as this does. `None` follows `friction.rate_shear` where there
    /// is one.
    pub creep_speed: Option<f64>,
    /// Whether the waves rub by hysteresis; without, they only leave a part of the area in contact.
    pub hysteresis: bool,
    /// s, 1: by what the moduli are less in the bands, where rubber is strained by tens of per cent.
    pub softening: f64,
}

/// Which waves the profile lacks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum FineWaves {
    /// An isotropic self-affine surface.
    SelfAffine {
        /// H, 1.
        hurst: f64,
        /// Root mean square gradient of all its waves, 1.
        rms_slope: f64,
        /// Their longest wavelength, m.
        longest: f64,
        /// Their shortest, m.
        shortest: f64,
    },
    /// The profile's own law, which goes on below its cut-off.
    Continued {
        /// The shortest wavelength, m.
        shortest: f64,
    },
    /// Contacts that flatten by a modulus that is given, the same at every speed.
    Modulus {
        /// Root mean square gradient, 1.
        rms_slope: f64,
        /// M_c, Pa.
        modulus: f64,
    },
}

/// Waves of about one length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FineBand {
    /// q_b, rad/m: the middle in ln q.
    pub wave_number: f64,
    /// h'_b², 1: the mean square of the gradient.
    pub gradient_square: f64,
}

/// What the rubber answers a wave that it slides over, as means over the directions of waves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BandModuli {
    /// M_b² = ⟨|M(q v cos φ)|²⟩, Pa².
    pub square: f64,
    /// L_b = ⟨cos φ Im M(q v cos φ)⟩, Pa.
    pub loss: f64,
}

/// Bands of a decade of wavelengths.
const PER_DECADE: f64 = 8.0;
/// Part of a band by which a number of bands may be off a whole number.
const ROUNDING: f64 = 1e-9;
/// Directions φ between 0 and π/2 at whose middles the waves of an isotropic surface are taken.
const DIRECTIONS: u32 = 32;
/// v_c where nothing gives it, m/s.
const CREEP_SPEED: f64 = 1e-6;

impl Scene {
    /// The bands of waves that the profile lacks; none without them, or where their modulus is given.
    pub fn fine_bands(&self) -> Vec<FineBand> {
        match self.fine.as_ref().map(|fine| fine.waves) {
            Some(FineWaves::SelfAffine { hurst, rms_slope, longest, shortest }) => {
                self_affine_bands(hurst, rms_slope, longest, shortest)
            }
            Some(FineWaves::Continued { shortest }) => {
                self.surface.self_affine().map_or(Vec::new(), |law| law.continued(shortest))
            }
            Some(FineWaves::Modulus { .. }) | None => Vec::new(),
        }
    }

    /// The root mean square gradient of the waves that the profile lacks, 1.
    pub fn fine_gradient(&self) -> f64 {
        match self.fine.as_ref().map(|fine| fine.waves) {
            Some(FineWaves::Modulus { rms_slope, .. }) => rms_slope,
            _ => self.fine_bands().iter().map(|band| band.gradient_square).sum::<f64>().sqrt(),
        }
    }

    /// v_c, m/s at the reference temperature: slip on the roughness below the profile is no slower.
    pub fn fine_creep_speed(&self) -> f64 {
        let of_shear = self.friction.as_ref().and_then(|friction| friction.rate_shear).map(|law| law.creep_speed());
        self.fine.as_ref().and_then(|fine| fine.creep_speed).or(of_shear).unwrap_or(CREEP_SPEED)
    }
}

impl FineRoughness {
    /// What it is, in a few words.
    pub fn describe(&self) -> String {
        let waves = match self.waves {
            FineWaves::SelfAffine { hurst, rms_slope, longest, shortest } => {
                format!("hurst {hurst:?}, rms_slope {rms_slope:?}, from {longest:?} m to {shortest:?} m")
            }
            FineWaves::Continued { shortest } => format!("the profile's law down to {shortest:?} m"),
            FineWaves::Modulus { rms_slope, modulus } => {
                return format!("rms_slope {rms_slope:?}, modulus {modulus:?} Pa");
            }
        };
        let hysteresis = if self.hysteresis { "" } else { ", real area alone" };
        let softening = if self.softening < 1.0 { format!(", softening {:?}", self.softening) } else { String::new() };
        format!("{waves}{hysteresis}{softening}")
    }

    /// What it misses in the rest of a scene, in words.
    pub(super) fn misses(&self, layer: &Layer, friction: Option<&Friction>) -> Option<&'static str> {
        let has_rate_shear = friction.is_some_and(|friction| friction.rate_shear.is_some());
        let rubs = friction.is_some_and(|friction| friction.coulomb.is_some() || friction.shear_strength.is_some());
        if layer.width.is_none() {
            return Some("layer.width beside fine: contacts have an area");
        }
        if self.creep_speed.is_some() && has_rate_shear {
            return Some("no fine.creep_speed beside friction.rate_shear, whose own counts");
        }
        let only_area = !self.hysteresis || matches!(self.waves, FineWaves::Modulus { .. });
        (only_area && !rubs && !has_rate_shear)
            .then_some("fine with hysteresis, or friction with coulomb, shear_strength or rate_shear")
    }

    /// Whether its numbers go together, and with the profile.
    ///
    /// # Errors
    /// What is expected.
    pub(super) fn check(&self, surface: &Surface) -> Result<(), String> {
        match (self.waves, surface.self_affine()) {
            (FineWaves::SelfAffine { longest, shortest, .. }, _) if longest <= shortest => {
                Err(format!("longest > {shortest} m, the shortest"))
            }
            (FineWaves::Continued { .. }, None) => {
                Err("shortest alone with a self_affine surface, whose law it continues".into())
            }
            (FineWaves::Continued { shortest }, Some(law)) if shortest >= law.cut_off => {
                Err(format!("shortest < {:?} m, the surface's own cut-off", law.cut_off))
            }
            _ => Ok(()),
        }
    }
}

impl FineBand {
    /// What `material` answers at its reference temperature as it slides at `speed` (m/s), softened by `softening`.
    pub fn moduli(&self, material: &Material, softening: f64, speed: f64) -> BandModuli {
        let mut sum = BandModuli::default();
        for i in 0..DIRECTIONS {
            let cosine = (FRAC_PI_2 * (f64::from(i) + 0.5) / f64::from(DIRECTIONS)).cos();
            let (storage, loss) = material.plane_moduli_at_reference(self.wave_number * speed * cosine);
            sum.square += storage * storage + loss * loss;
            sum.loss += cosine * loss;
        }
        let mean = 1.0 / f64::from(DIRECTIONS);
        BandModuli { square: softening * softening * mean * sum.square, loss: softening * mean * sum.loss }
    }
}

impl Material {
    /// The real and the imaginary part of M(ω) = E*(ω)/(1 - ν²), Pa, at the reference temperature, ω in rad/s.
    fn plane_moduli_at_reference(&self, omega: f64) -> (f64, f64) {
        let elements = self.prony.iter().map(|term| term.element());
        let viscosity = self.viscosity.unwrap_or(0.0);
        let (storage, loss) = complex_stiffness(self.equilibrium_modulus, viscosity, elements, omega);
        (self.plane_modulus(storage), self.plane_modulus(loss))
    }
}

/// The middles of bands even in ln q between two wavelengths (m), and the width of a band in ln q.
fn middles(longest: f64, shortest: f64) -> (Vec<f64>, f64) {
    let count = (PER_DECADE * (longest / shortest).log10() - ROUNDING).ceil().max(1.0);
    let width = (longest / shortest).ln() / count;
    let middle = |b: usize| TAU / longest * (width * (b as f64 + 0.5)).exp();
    ((0..count as usize).map(middle).collect(), width)
}

/// h'_b² ∝ q_b^(2-2H), together the square of `rms_slope`.
fn self_affine_bands(hurst: f64, rms_slope: f64, longest: f64, shortest: f64) -> Vec<FineBand> {
    let (wave_numbers, _) = middles(longest, shortest);
    // Relative to the first, so that no power overflows.
    let weights: Vec<f64> = wave_numbers.iter().map(|q| (q / wave_numbers[0]).powf(2.0 - 2.0 * hurst)).collect();
    let scale = rms_slope * rms_slope / weights.iter().sum::<f64>();
    let band = |(wave_number, weight)| FineBand { wave_number, gradient_square: scale * weight };
    wave_numbers.into_iter().zip(weights).map(band).collect()
}

impl SelfAffine {
    /// The law from its own cut-off down to the wavelength `shortest` (m).
    fn continued(&self, shortest: f64) -> Vec<FineBand> {
        let at_roll_off = self.plateau() * (TAU / self.roll_off).powf(1.0 + 2.0 * self.hurst);
        let (wave_numbers, width) = middles(self.cut_off, shortest);
        let band = |q: f64| {
            let of_lines = at_roll_off * q.powf(-1.0 - 2.0 * self.hurst);
            FineBand { wave_number: q, gradient_square: gradient_square(q, isotropic(q, of_lines, self.hurst), width) }
        };
        wave_numbers.into_iter().map(band).collect()
    }
}

/// h'² = 2π q⁴ C Δln q of the isotropic spectrum C (m⁴) at q (rad/m) over a `width` in ln q.
fn gradient_square(q: f64, spectrum: f64, width: f64) -> f64 {
    TAU * q.powi(4) * spectrum * width
}

/// C (m⁴) of the isotropic surface whose lines have the spectrum C1 (m³) ∝ q^-(1+2H): (C1/q) Γ(1+H)/(2√π Γ(½+H)).
fn isotropic(q: f64, of_lines: f64, hurst: f64) -> f64 {
    let ratio = (libm::lgamma(1.0 + hurst) - libm::lgamma(0.5 + hurst)).exp();
    of_lines / q * ratio / (2.0 * std::f64::consts::PI.sqrt())
}

impl Material {
    /// The fastest rate 1/τ_j at the reference temperature, 1/s, that of E_∞/η among them; `None` for a material whose modulus
    /// is the same at every frequency.
    pub fn fastest_rate(&self) -> Option<f64> {
        let glassy = self.equilibrium_modulus + self.prony.iter().map(|term| term.modulus).sum::<f64>();
        let viscous = self.viscosity.filter(|&viscosity| viscosity > 0.0).map(|viscosity| glassy / viscosity);
        let terms = self.prony.iter().filter(|term| term.modulus > 0.0).map(|term| 1.0 / term.relaxation_time);
        terms.chain(viscous).reduce(f64::max)
    }
}
