//! The roughness below the resolution of the profile, as bands of waves (`surface.fine`).

use std::f64::consts::{FRAC_PI_2, TAU};

use serde::Serialize;
use spectrum::isotropic;

use super::{Friction, LARGEST, Material, SelfAffine, Surface};

mod files;
mod spectrum;
mod warnings;

pub use files::{Convention, LEAST_DENSITY, SOFTENING, SPECTRUM};
pub use spectrum::RoughnessSpectrum;
pub use spectrum::{SplitError, SplitSurface};

/// The waves that the profile lacks, and how contacts rub on them; in the material form alone.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FineRoughness {
    /// Which waves there are.
    pub waves: FineWaves,
    /// v_c, m/s at the reference temperature: slower slip rubs as this does. `None` follows `friction.rate_shear` where
    /// there is one.
    pub creep_speed: Option<f64>,
    /// Whether the waves rub by hysteresis; without, they only leave a part of the area in contact.
    pub hysteresis: bool,
    /// By what the moduli are less in the bands.
    pub softening: Softening,
    /// By what the bands are rougher than their law or measurement says; `None`: by nothing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub factors: Option<SpectrumFactors>,
}

/// Which waves the profile lacks.
#[derive(Clone, Debug, PartialEq, Serialize)]
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
    /// Those of a spectrum that was measured.
    Table {
        /// The spectrum.
        spectrum: RoughnessSpectrum,
        /// The longest wavelength, m.
        longest: f64,
        /// The shortest, m.
        shortest: f64,
    },
    /// Those that a filter took from the profile.
    Split {
        /// The wavelength that the filter halves, m.
        split: f64,
        /// The shortest wavelength, m.
        shortest: f64,
        /// The spectrum of what it took.
        spectrum: RoughnessSpectrum,
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
    /// What strain leaves of the moduli there.
    pub factors: ModulusFactors,
}

/// Numbers of `surface.fine` that do not go together.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Clash {
    /// The key of one of them.
    pub(super) key: &'static str,
    pub(super) given: f64,
    pub(super) expected: String,
}

/// What the rubber answers a wave that it slides over, as means over the directions φ of waves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WaveModuli {
    /// ⟨|M(q v cos φ)|²⟩, Pa²: M_b² of a band.
    pub square: f64,
    /// ⟨cos φ Im M(q v cos φ)⟩, Pa: L_b of a band.
    pub loss: f64,
}

/// Bands of a decade of wavelengths.
const PER_DECADE: f64 = 8.0;
/// Part of a band by which a number of bands may be off a whole number.
const ROUNDING: f64 = 1e-9;
/// Directions φ between 0 and π/2 at whose middles the waves of an isotropic surface are taken.
const DIRECTIONS: u32 = 32;
/// By what the density of a spectrum is multiplied.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum SpectrumFactors {
    /// One factor for all waves.
    Whole(f64),
    /// [Decades](decade_of) of wavelengths, rising, and their factors; waves beyond them have that of the nearest.
    Decades(Vec<(i32, f64)>),
}

/// The decade of a wavelength (m): d from 10^d to 10^(d+1) m, so that it is the same in every scene.
pub fn decade_of(wavelength: f64) -> i32 {
    /// Wavelengths that are a power of ten but for this begin its decade.
    const ROUNDING: f64 = 1e-9;
    (wavelength.log10() + ROUNDING).floor() as i32
}

impl SpectrumFactors {
    /// The factor at a wavelength (m).
    pub fn at(&self, wavelength: f64) -> f64 {
        match self {
            Self::Whole(factor) => *factor,
            Self::Decades(decades) => {
                let decade = decade_of(wavelength);
                let nearest = decades.iter().min_by_key(|(other, _)| (other - decade).abs());
                nearest.map_or(1.0, |(_, factor)| *factor)
            }
        }
    }

    /// The factor of a height less 1.
    pub(super) fn of_height(&self, wavelength: f64) -> f64 {
        self.at(wavelength).sqrt() - 1.0
    }
}

impl FineWaves {
    /// The bands, of rubber that strain does not soften; none where the modulus is given.
    pub(super) fn bands(&self, surface: &Surface) -> Vec<FineBand> {
        match self {
            &Self::SelfAffine { hurst, rms_slope, longest, shortest } => {
                self_affine_bands(hurst, rms_slope, longest, shortest)
            }
            Self::Table { spectrum, longest, shortest } => spectrum.bands(*longest, *shortest),
            Self::Split { spectrum, shortest, .. } => spectrum.bands(spectrum.wavelengths()[0], *shortest),
            Self::Continued { shortest } => surface.self_affine().map_or_else(Vec::new, |law| law.continued(*shortest)),
            Self::Modulus { .. } => Vec::new(),
        }
    }

    /// The spectrum that was measured, if it was.
    pub fn spectrum(&self) -> Option<&RoughnessSpectrum> {
        match self {
            Self::Table { spectrum, .. } | Self::Split { spectrum, .. } => Some(spectrum),
            Self::SelfAffine { .. } | Self::Continued { .. } | Self::Modulus { .. } => None,
        }
    }

    /// The shortest wavelength, m; `None` where the modulus is given.
    pub fn shortest(&self) -> Option<f64> {
        match self {
            Self::SelfAffine { shortest, .. }
            | Self::Table { shortest, .. }
            | Self::Split { shortest, .. }
            | Self::Continued { shortest } => Some(*shortest),
            Self::Modulus { .. } => None,
        }
    }

    /// Whether there are bands: waves that the rubber meets with a modulus of its own.
    pub fn has_bands(&self) -> bool {
        !matches!(self, Self::Modulus { .. })
    }
}

impl FineRoughness {
    /// What it is, in a few words.
    pub fn describe(&self) -> String {
        let waves = match &self.waves {
            FineWaves::SelfAffine { hurst, rms_slope, longest, shortest } => {
                format!("hurst {hurst:?}, rms_slope {rms_slope:?}, from {longest:?} m to {shortest:?} m")
            }
            FineWaves::Table { longest, shortest, .. } => {
                format!("a spectrum from {longest:?} m to {shortest:?} m")
            }
            FineWaves::Split { split, shortest, .. } => {
                format!("the measured line's below {split:?} m, down to {shortest:?} m")
            }
            FineWaves::Continued { shortest } => format!("the profile's law down to {shortest:?} m"),
            FineWaves::Modulus { rms_slope, modulus } => {
                return format!("rms_slope {rms_slope:?}, modulus {modulus:?} Pa");
            }
        };
        let hysteresis = if self.hysteresis { "" } else { ", real area alone" };
        let softening = self.softening.describe().map_or_else(String::new, |softening| format!(", {softening}"));
        format!("{waves}{hysteresis}{softening}")
    }

    /// What it misses in the friction of a scene: the key of its own that is wrong then, none where it is all of it,
    /// and what is expected.
    pub(super) fn misses(&self, friction: Option<&Friction>) -> Option<(Option<&'static str>, &'static str)> {
        let has_rate_shear = friction.is_some_and(|friction| friction.rate_shear.is_some());
        let rubs = friction.is_some_and(|friction| friction.coulomb.is_some() || friction.shear_strength.is_some());
        if self.creep_speed.is_some() && has_rate_shear {
            return Some((Some("creep_speed"), "no such key beside friction.rate_shear, whose own creep speed counts"));
        }
        let expected = "hysteresis, or friction with coulomb, shear_strength or rate_shear: else nothing rubs";
        let only_area = !self.hysteresis || !self.waves.has_bands();
        (only_area && !rubs && !has_rate_shear).then_some(((!self.hysteresis).then_some("hysteresis"), expected))
    }

    /// Checks that its numbers go together, and with the profile.
    pub(super) fn check(&self, surface: &Surface) -> Result<(), Clash> {
        let clash = |key, given, expected| Err(Clash { key, given, expected });
        match (&self.waves, surface.self_affine()) {
            (&FineWaves::SelfAffine { longest, shortest, .. } | &FineWaves::Table { longest, shortest, .. }, _)
                if longest <= shortest =>
            {
                clash("longest", longest, format!("more than {shortest:?} m, the shortest"))
            }
            (FineWaves::Table { spectrum, longest, shortest }, _) if !spectrum.covers(*longest, *shortest) => {
                let ends = spectrum.wavelengths();
                let (key, given) = if *longest > ends[0] { ("longest", *longest) } else { ("shortest", *shortest) };
                clash(key, given, format!("wavelengths that the spectrum covers, {:?} m to {:?} m", ends[0], ends[1]))
            }
            (FineWaves::Split { spectrum, shortest, .. }, _) if *shortest >= spectrum.wavelengths()[0] => {
                let longest = spectrum.wavelengths()[0];
                clash("shortest", *shortest, format!("less than {longest:?} m, where the finer waves begin"))
            }
            (&FineWaves::Continued { shortest }, None) => {
                let expected =
                    "longest, split or spectrum beside it: the surface is not self_affine, it has no law to continue";
                clash("shortest", shortest, expected.into())
            }
            (&FineWaves::Continued { shortest }, Some(law)) if shortest >= law.cut_off => {
                clash("shortest", shortest, format!("less than {:?} m, the surface's own cut-off", law.cut_off))
            }
            _ => self.check_gradient(surface),
        }
    }

    /// A spectrum, or a law that goes on, may rise beyond all numbers.
    fn check_gradient(&self, surface: &Surface) -> Result<(), Clash> {
        let square: f64 = self.waves.bands(surface).iter().map(|band| band.gradient_square).sum();
        match self.waves.shortest() {
            Some(given) if square.is_nan() || square > LARGEST * LARGEST => {
                Err(Clash { key: "shortest", given, expected: format!("waves with a gradient up to {LARGEST:e}") })
            }
            _ => Ok(()),
        }
    }
}

impl FineBand {
    /// Waves of rubber that strain does not soften.
    fn new(wave_number: f64, gradient_square: f64) -> Self {
        Self { wave_number, gradient_square, factors: ModulusFactors::ONE }
    }

    /// What `material`, softened, answers at its reference temperature as it slides at `speed` (m/s).
    pub fn moduli(&self, material: &Material, speed: f64) -> WaveModuli {
        WaveModuli::of_all_directions(|cosine| {
            let (storage, loss) = material.complex_plane_modulus_at_reference(self.wave_number * speed * cosine);
            (self.factors.storage * storage, self.factors.loss * loss)
        })
    }
}

impl WaveModuli {
    /// Those of waves across the motion, to which the rubber answers with these M' and M'', Pa.
    pub fn across((storage, loss): (f64, f64)) -> Self {
        Self { square: storage * storage + loss * loss, loss }
    }

    /// Those of waves of all directions: `at` gives M' and M'' (Pa) for cos φ.
    pub fn of_all_directions(at: impl Fn(f64) -> (f64, f64)) -> Self {
        let mut sum = Self::default();
        for i in 0..DIRECTIONS {
            let cosine = (FRAC_PI_2 * (f64::from(i) + 0.5) / f64::from(DIRECTIONS)).cos();
            let one = Self::across(at(cosine));
            sum.square += one.square;
            sum.loss += cosine * one.loss;
        }
        let mean = 1.0 / f64::from(DIRECTIONS);
        Self { square: mean * sum.square, loss: mean * sum.loss }
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
    let band = |(wave_number, weight)| FineBand::new(wave_number, scale * weight);
    wave_numbers.into_iter().zip(weights).map(band).collect()
}

impl SelfAffine {
    /// The law from its own cut-off down to the wavelength `shortest` (m).
    fn continued(&self, shortest: f64) -> Vec<FineBand> {
        let (wave_numbers, width) = middles(self.cut_off, shortest);
        // C1 of a profile is a density of lines, C of a map is what is asked for.
        let exponent = if self.size_y.is_some() { -2.0 } else { -1.0 } - 2.0 * self.hurst;
        let at_roll_off = self.plateau() * (TAU / self.roll_off).powf(-exponent);
        let band = |q: f64| {
            let law = at_roll_off * q.powf(exponent);
            let density = if self.size_y.is_some() { law } else { isotropic(q, law, self.hurst) };
            FineBand::new(q, gradient_square(q, density, width))
        };
        wave_numbers.into_iter().map(band).collect()
    }
}

impl RoughnessSpectrum {
    /// The bands between two wavelengths (m).
    fn bands(&self, longest: f64, shortest: f64) -> Vec<FineBand> {
        let (wave_numbers, width) = middles(longest, shortest);
        wave_numbers.into_iter().map(|q| FineBand::new(q, gradient_square(q, self.density(q), width))).collect()
    }
}

/// h'² = 2π q⁴ C Δln q of the isotropic spectrum C (m⁴) at q (rad/m) over a `width` in ln q.
fn gradient_square(q: f64, spectrum: f64, width: f64) -> f64 {
    TAU * q.powi(4) * spectrum * width
}

impl Material {
    /// The fastest rate 1/τ_j at the reference temperature, 1/s, that of E_∞/η among them; `None` for a material whose
    /// modulus is the same at every frequency.
    pub fn fastest_rate(&self) -> Option<f64> {
        let glassy = self.equilibrium_modulus + self.prony.iter().map(|term| term.modulus).sum::<f64>();
        let viscous = self.viscosity.filter(|&viscosity| viscosity > 0.0).map(|viscosity| glassy / viscosity);
        let terms = self.prony.iter().filter(|term| term.modulus > 0.0).map(|term| 1.0 / term.relaxation_time);
        terms.chain(viscous).reduce(f64::max)
    }
}

/// By what the moduli are less in the bands, where rubber is strained by tens of per cent.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Softening {
    /// s, 1: both moduli, whatever the strain.
    Factor(f64),
    /// By the strain, which rises; at least two rows. Factors are linear in its logarithm, and held beyond the ends.
    Table(Vec<SofteningRow>),
}

/// A row of a table of softening.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SofteningRow {
    /// The strain, 1.
    pub strain: f64,
    /// The factors there.
    pub factors: ModulusFactors,
}

/// Factors on the real (storage) and the imaginary (loss) part of a modulus.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ModulusFactors {
    /// On the storage modulus, 1.
    pub storage: f64,
    /// On the loss modulus, 1.
    pub loss: f64,
}

impl ModulusFactors {
    /// Of rubber that strain does not soften.
    pub const ONE: Self = Self { storage: 1.0, loss: 1.0 };
}

impl Softening {
    /// The factors at a `strain` ≥ 0, 1.
    pub fn factors(&self, strain: f64) -> ModulusFactors {
        let rows = match self {
            Self::Factor(factor) => return ModulusFactors { storage: *factor, loss: *factor },
            Self::Table(rows) => rows,
        };
        let above = rows.partition_point(|row| row.strain <= strain);
        match (above.checked_sub(1).and_then(|below| rows.get(below)), rows.get(above)) {
            (Some(below), Some(above)) => {
                let part = (strain / below.strain).ln() / (above.strain / below.strain).ln();
                let between = |low: f64, high: f64| low + part * (high - low);
                let (low, high) = (below.factors, above.factors);
                ModulusFactors { storage: between(low.storage, high.storage), loss: between(low.loss, high.loss) }
            }
            (Some(end), None) | (None, Some(end)) => end.factors,
            (None, None) => ModulusFactors::ONE,
        }
    }

    /// What it is, in a few words; `None` where it changes nothing.
    fn describe(&self) -> Option<String> {
        match self {
            Self::Factor(1.0) => None,
            Self::Factor(factor) => Some(format!("softening {factor:?}")),
            Self::Table(rows) => {
                let [first, last] = [rows.first()?, rows.last()?].map(|row| row.strain);
                Some(format!("softening of a table of strains from {first:?} to {last:?}"))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::scene::Scene;

    /// Rubber of two terms on a flat surface with these waves.
    fn scene(fine: FineRoughness) -> Scene {
        let text = "name = 'f'\nlayer = { masses = 4, spacing = 1e-4, thickness = 1e-3, width = 1e-2 }\n\
                    surface = { kind = 'flat' }\n[material]\ndensity = 1100\npoisson_ratio = 0.49\n\
                    equilibrium_modulus = 1e6\nprony = [{ modulus = 5e6, relaxation_time = 1e-5 }]\n";
        let scene = Scene::parse(text, Path::new("f.toml")).unwrap_or_else(|error| unreachable!("{error}"));
        Scene { fine: Some(fine), ..scene }
    }

    fn bands(waves: FineWaves, softening: Softening) -> Vec<FineBand> {
        scene(FineRoughness { waves, creep_speed: None, hysteresis: true, softening, factors: None }).fine_bands()
    }

    const LAW: FineWaves = FineWaves::SelfAffine { hurst: 0.7, rms_slope: 0.9, longest: 2e-3, shortest: 5e-6 };

    /// C ∝ q^-2(1+H) in a table with rows of its own: the same bands, but for a constant.
    #[test]
    fn a_self_affine_table_has_the_bands_of_the_law() {
        let row = |i: u32| {
            let q = 1e3 * 10_f64.powf(f64::from(i) / 3.0);
            [q, q.powf(-3.4)]
        };
        let spectrum = RoughnessSpectrum::new((0..=10).map(row).collect());
        let table = bands(FineWaves::Table { spectrum, longest: 2e-3, shortest: 5e-6 }, Softening::Factor(1.0));
        let law = bands(LAW, Softening::Factor(1.0));
        assert_eq!((table.len(), law.len()), (21, 21));
        let ratio = law[0].gradient_square / table[0].gradient_square;
        for (one, other) in table.iter().zip(&law) {
            assert_eq!(one.wave_number, other.wave_number);
            assert!((ratio * one.gradient_square / other.gradient_square - 1.0).abs() < 1e-12, "{one:?} {other:?}");
        }
    }

    /// Both moduli by s: M_b² by s², L_b by s.
    #[test]
    fn a_factor_softens_both_moduli() {
        let (hard, soft) = (bands(LAW, Softening::Factor(1.0)), bands(LAW, Softening::Factor(0.4)));
        let fine = FineRoughness {
            waves: LAW,
            creep_speed: None,
            hysteresis: true,
            softening: Softening::Factor(1.0),
            factors: None,
        };
        let material = scene(fine).material;
        for (hard, soft) in hard.iter().zip(&soft) {
            let [hard, soft] = [hard, soft].map(|band| material.as_ref().map(|rubber| band.moduli(rubber, 0.1)));
            let (hard, soft) = (hard.unwrap_or_default(), soft.unwrap_or_default());
            assert!((soft.square / hard.square / 0.16 - 1.0).abs() < 1e-14);
            assert!((soft.loss / hard.loss / 0.4 - 1.0).abs() < 1e-14);
        }
    }

    /// The strain of a band is half the gradient of all waves down to its own.
    #[test]
    fn a_table_softens_by_the_strain_of_each_band() {
        let row = |strain, storage, loss| SofteningRow { strain, factors: ModulusFactors { storage, loss } };
        let table = Softening::Table(vec![row(1e-3, 1.0, 1.0), row(1.0, 0.1, 0.7)]);
        let mut gradient_square = 0.0;
        for band in bands(LAW, table) {
            gradient_square += band.gradient_square;
            let decades = (0.5 * gradient_square.sqrt() / 1e-3).log10();
            let expected = [1.0 - 0.3 * decades, 1.0 - 0.1 * decades];
            let found = [band.factors.storage, band.factors.loss];
            assert!(found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-12), "{band:?}");
        }
        assert!((gradient_square - 0.81).abs() < 1e-12);
    }

    #[test]
    fn factors_are_linear_in_the_logarithm_and_held_at_the_ends() {
        let row = |strain, storage, loss| SofteningRow { strain, factors: ModulusFactors { storage, loss } };
        let table = Softening::Table(vec![row(0.001, 1.0, 1.0), row(0.1, 0.5, 1.5), row(1.0, 0.25, 0.75)]);
        let at = |strain: f64| {
            let factors = table.factors(strain);
            [factors.storage, factors.loss]
        };
        assert_eq!((at(0.0), at(1e-3), at(1.0), at(7.0)), ([1.0; 2], [1.0; 2], [0.25, 0.75], [0.25, 0.75]));
        let middle = at(0.01);
        // Roundings of logarithms.
        assert!((middle[0] - 0.75).abs() < 1e-15 && (middle[1] - 1.25).abs() < 1e-15, "{middle:?}");
        assert_eq!(at(0.1), [0.5, 1.5]);
    }
}
