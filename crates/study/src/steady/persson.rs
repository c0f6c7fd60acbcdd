//! Persson's theory of contact and friction beside the runs, as an orientation.
//!
//! B. N. J. Persson, J. Chem. Phys. 115, 2001, 3840. Waves of the profile are added in the order of their wave numbers
//! q. Those up to m press with the mean square σ_m² = Σ z_n² <|K M(q_n v cos φ)|²>, so the part P_m = erf(p/(√2 σ_m))
//! of the surface is in contact, and μ = (1/p) Σ q_m z_m² K <cos φ Im M(q_m v cos φ)> P_m S_m. S is 1, or ½ + ½P² for
//! contacts that deform less than the whole surface would. The waves that the profile lacks follow in bands; the area is
//! that of the profile's waves, as the contact ratio of a run is.

use std::f64::consts::{PI, SQRT_2};

use asperity::scene::{ElasticBody, FineBand, FineRoughness, Material, Scene, Spectrum, Surface, WaveModuli};

/// Area and friction by the theory.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Theory {
    /// In contact over the whole by the waves of the profile, 1.
    pub area: f64,
    /// Friction coefficient with S = 1.
    pub friction: f64,
    /// Friction coefficient with S = ½ + ½P².
    pub friction_reduced: f64,
}

/// Whether the waves of the profile are those of ridges across the motion, or those of a line on an isotropic surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Roughness {
    /// Ridges across the motion.
    Ridges,
    /// An isotropic surface, of which the profile is a line.
    Isotropic,
}

impl Theory {
    /// Area and friction of the waves that the layer of `scene` resolves and of those that the profile lacks, sliding at
    /// `speed` (m/s) under `pressure` (Pa); `None` in the direct form.
    pub fn new(scene: &Scene, pressure: f64, speed: f64, roughness: Roughness) -> Option<Self> {
        let parts = Part::all(scene, speed, roughness)?;
        Some(Self::of(&parts, pressure))
    }

    /// Area, friction and friction reduced.
    pub fn values(&self) -> [f64; 3] {
        [self.area, self.friction, self.friction_reduced]
    }

    fn of(parts: &[Part], pressure: f64) -> Self {
        let mut theory = Self { area: 1.0, friction: 0.0, friction_reduced: 0.0 };
        for (part, in_contact) in in_contact(parts, pressure) {
            if !part.is_fine {
                theory.area = in_contact;
            }
            let friction = part.loss * in_contact / pressure;
            theory.friction += friction;
            theory.friction_reduced += friction * 0.5 * (1.0 + in_contact * in_contact);
        }
        theory
    }
}

/// What a wave of an isotropic surface, or a band of waves that the profile lacks, gives of friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaveFriction {
    /// q, rad/m.
    pub wave_number: f64,
    /// Whether the profile lacks it.
    pub is_fine: bool,
    /// Its part of the friction coefficient by hysteresis, with S = ¾ + ¼P².
    friction: f64,
}

/// The friction coefficient of an isotropic surface by the theory, and its parts, with the factors of the law of the
/// waves that the profile lacks (docs/foundation.md, section 5).
#[derive(Clone, Debug, PartialEq)]
pub struct WholeFriction {
    /// Of each wave, in the order of q.
    pub by_wave: Vec<WaveFriction>,
    /// What Coulomb's friction and the shear of the area that touches add.
    pub adhesion: f64,
}

impl WholeFriction {
    /// That of `scene` at `speed` (m/s) under `pressure` (Pa); without waves in the direct form.
    pub fn new(scene: &Scene, pressure: f64, speed: f64) -> Self {
        let parts = Part::all(scene, speed, Roughness::Isotropic).unwrap_or_default();
        let of = |(part, in_contact): (&Part, f64)| {
            let Part { wave_number, is_fine, loss, .. } = *part;
            let reduced = in_contact * (0.75 + 0.25 * in_contact * in_contact);
            WaveFriction { wave_number, is_fine, friction: loss * reduced / pressure }
        };
        let by_wave = in_contact(&parts, pressure).map(of).collect();
        let stress = parts.iter().map(|part| part.stress_square).sum::<f64>().sqrt();
        // σ is ½√Σ of the law on a half-space.
        let touches = libm::erf(0.5 * PI.sqrt() * pressure / stress);
        let at_reference = speed * scene.material.as_ref().map_or(1.0, Material::shift_factor);
        let coulomb = scene.friction.as_ref().and_then(|friction| friction.coulomb).unwrap_or(0.0);
        let adhesion = coulomb + touches * scene.shear_strength_at(at_reference) / pressure;
        Self { by_wave, adhesion }
    }

    /// Its part by the hysteresis of some waves.
    pub fn hysteresis(&self, of: impl Fn(&WaveFriction) -> bool) -> f64 {
        self.by_wave.iter().filter(|wave| of(wave)).fold(0.0, |sum, wave| sum + wave.friction)
    }

    /// All of it.
    pub fn friction(&self) -> f64 {
        self.hysteresis(|_| true) + self.adhesion
    }
}

/// A wave of the profile, or a band of waves that it lacks, as the material meets it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Part {
    /// q, rad/m.
    wave_number: f64,
    /// What it adds to σ², Pa².
    stress_square: f64,
    /// What it loses per distance and area in full contact, Pa.
    loss: f64,
    /// Whether the profile lacks it.
    is_fine: bool,
}

impl Part {
    /// Those that the layer of `scene` resolves and the bands below, at `speed` (m/s); `None` in the direct form.
    fn all(scene: &Scene, speed: f64, roughness: Roughness) -> Option<Vec<Self>> {
        let material = scene.material.as_ref()?;
        let body = scene.layer.body(material)?;
        let profile = resolved(scene).into_iter().map(|wave| Self::of_profile(wave, material, body, speed, roughness));
        let at_reference = speed * material.shift_factor();
        let bands = scene.fine.iter().flat_map(|fine| {
            let bands = scene.fine_bands().into_iter();
            bands.map(move |band| Self::of_band(band, fine, material, body, at_reference))
        });
        Some(profile.chain(bands).collect())
    }

    /// Of a wave of the profile: q in rad/m and mean square height in m².
    fn of_profile(
        (wave_number, mean_square): (f64, f64),
        material: &Material,
        body: ElasticBody,
        speed: f64,
        roughness: Roughness,
    ) -> Self {
        let (stiffness, square) = (body.normal(wave_number), roughness.factor() * mean_square);
        let moduli = roughness.moduli(material, wave_number * speed);
        Self {
            wave_number,
            stress_square: square * stiffness * stiffness * moduli.square,
            loss: wave_number * square * stiffness * moduli.loss,
            is_fine: false,
        }
    }

    /// Of a band, which is isotropic whatever the profile is; `speed` in m/s at the reference temperature.
    fn of_band(band: FineBand, fine: &FineRoughness, material: &Material, body: ElasticBody, speed: f64) -> Self {
        let FineBand { wave_number, gradient_square, .. } = band;
        let moduli = band.moduli(material, speed);
        let ratio = body.normal(wave_number) / wave_number;
        Self {
            wave_number,
            stress_square: gradient_square * ratio * ratio * moduli.square,
            loss: if fine.hysteresis { gradient_square * ratio * moduli.loss } else { 0.0 },
            is_fine: true,
        }
    }
}

/// Each of the waves, in the order of q, and the part P of the surface that is in contact on it under `pressure` (Pa). A
/// wave counts in its own P whole, a band, which is wide, by half.
fn in_contact(parts: &[Part], pressure: f64) -> impl Iterator<Item = (&Part, f64)> {
    let mut variance = 0.0;
    parts.iter().map(move |part| {
        let own = if part.is_fine { 0.5 } else { 1.0 };
        let seen = variance + own * part.stress_square;
        variance += part.stress_square;
        (part, libm::erf(pressure / (SQRT_2 * seen.sqrt())))
    })
}

impl Roughness {
    /// An isotropic surface has twice the mean square height that is in a wave of its lines, by the angles.
    fn factor(self) -> f64 {
        match self {
            Self::Ridges => 1.0,
            Self::Isotropic => 2.0,
        }
    }

    /// What a material answers its waves, which are met with ω cos φ (rad/s) by their directions φ.
    fn moduli(self, material: &Material, omega: f64) -> WaveModuli {
        match self {
            Self::Ridges => WaveModuli::across(material.complex_plane_modulus(omega)),
            Self::Isotropic => WaveModuli::of_all_directions(|cosine| material.complex_plane_modulus(omega * cosine)),
        }
    }
}

/// All waves of a profile, to be met at any speed and pressure.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfileWaves {
    /// q (rad/m) and mean square height, m².
    waves: Vec<(f64, f64)>,
    roughness: Roughness,
}

impl ProfileWaves {
    /// Those of a surface: of a map as of an isotropic one, else of ridges.
    pub fn new(surface: &Surface) -> Self {
        let roughness = if surface.map().is_some() { Roughness::Isotropic } else { Roughness::Ridges };
        Self { waves: Spectrum::new(surface).modes().collect(), roughness }
    }

    /// Area and friction of the waves in rubber of a `material` as part of a `body`, at `speed` (m/s) under `pressure`, Pa.
    pub fn sliding(&self, material: &Material, body: ElasticBody, speed: f64, pressure: f64) -> Theory {
        let part = |&wave: &(f64, f64)| Part::of_profile(wave, material, body, speed, self.roughness);
        Theory::of(&self.waves.iter().map(part).collect::<Vec<_>>(), pressure)
    }
}

/// The waves of the profile that the layer resolves.
fn resolved(scene: &Scene) -> Vec<(f64, f64)> {
    Spectrum::new(&scene.surface).modes().filter(|(wave_number, _)| scene.layer.resolves(*wave_number)).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_2_PI, TAU};

    use asperity::scene::PronyTerm;

    use super::*;
    use crate::in_tests::assert_relative;

    fn rubber(prony: Vec<PronyTerm>) -> Material {
        let (density, poisson_ratio, equilibrium_modulus) = (1e3, 0.5, 3e6);
        Material { density, poisson_ratio, equilibrium_modulus, viscosity: None, prony, wlf: None, heat: None }
    }

    fn viscoelastic() -> Material {
        rubber(vec![PronyTerm { modulus: 2e7, relaxation_time: 1e-4 }])
    }

    /// A self-affine spectrum of 200 waves.
    fn rough() -> Vec<(f64, f64)> {
        (1..=200_u32).map(|m| (1e3 * f64::from(m), 1e-12 * f64::from(m).powf(-2.6))).collect()
    }

    /// Area and friction of waves (q in rad/m, mean square height in m²) in the order of q, at 0.3 m/s.
    fn on_half_plane(waves: &[(f64, f64)], material: &Material, pressure: f64, roughness: Roughness) -> Theory {
        let part = |&wave: &(f64, f64)| Part::of_profile(wave, material, ElasticBody::HalfPlane, 0.3, roughness);
        Theory::of(&waves.iter().map(part).collect::<Vec<_>>(), pressure)
    }

    /// One wave a cos qx in full contact, as Westergaard's: μ = (qa)² Im M(qv)/(4p).
    #[test]
    fn one_wave_in_full_contact_loses_what_westergaard_says() {
        let (q, a, material) = (5e3, 1e-5, viscoelastic());
        let wave = [(q, 0.5 * a * a)];
        // Im M of one Maxwell element, by its own formula.
        let x = q * 0.3 * 1e-4;
        let loss = 2e7 / 0.75 * x / (1.0 + x * x);
        let pressure = 1e8;
        let theory = on_half_plane(&wave, &material, pressure, Roughness::Ridges);
        let exact = (q * a).powi(2) * loss / (4.0 * pressure);
        // σ is some 5e5 Pa: erf is 1 to the last digit.
        assert_relative(theory.area, 1.0, 1e-15);
        assert_relative(theory.friction, exact, 1e-14);
        assert_relative(theory.friction_reduced, exact, 1e-14);
    }

    /// At low pressure erf x = 2x/√π: A/A_0 = √(8/π) p/(M h'), with h' the slope of the profile in one dimension and √2
    /// times that, the gradient, in two.
    #[test]
    fn the_area_at_low_pressure_is_a_straight_line() {
        let (waves, material) = (rough(), rubber(Vec::new()));
        let slope = waves.iter().map(|(q, square)| q * q * square).sum::<f64>().sqrt();
        let (pressure, modulus) = (10.0, 3e6 / 0.75);
        let line = 2.0 * FRAC_2_PI.sqrt() * pressure / (modulus * slope);
        // erf x = 2x/√π (1 - x²/3), x some 1e-4.
        assert_relative(on_half_plane(&waves, &material, pressure, Roughness::Ridges).area, line, 1e-6);
        assert_relative(on_half_plane(&waves, &material, pressure, Roughness::Isotropic).area, line / SQRT_2, 1e-6);
    }

    /// At low pressure friction does not depend on it, and contacts that are small have S = ½.
    #[test]
    fn friction_at_low_pressure_does_not_depend_on_it() {
        let (waves, material) = (rough(), viscoelastic());
        let at = |pressure: f64| on_half_plane(&waves, &material, pressure, Roughness::Isotropic);
        let (low, lower) = (at(10.0), at(1.0));
        assert_relative(low.friction, lower.friction, 1e-4);
        assert_relative(low.friction, 2.0 * low.friction_reduced, 1e-4);
    }

    /// A dashpot alone, Im M = ωη': <|M|²> = <cos² φ> = ½ of that along the motion, and the same half of the loss.
    #[test]
    fn an_isotropic_surface_is_the_mean_over_all_directions() {
        let material = Material { equilibrium_modulus: 1e-30, viscosity: Some(1e3), ..rubber(Vec::new()) };
        let (one, two) = (Roughness::Ridges.moduli(&material, 50.0), Roughness::Isotropic.moduli(&material, 50.0));
        // The rule of middles is exact for cos² φ.
        assert_relative(two.square, 0.5 * one.square, 1e-14);
        assert_relative(two.loss, 0.5 * one.loss, 1e-14);
        // In full contact twice the heights make up for it: a surface loses what its lines do.
        let waves = rough();
        let loss = |roughness| on_half_plane(&waves, &material, 1e9, roughness).friction;
        assert_relative(loss(Roughness::Isotropic), loss(Roughness::Ridges), 1e-12);
    }

    #[test]
    fn waves_below_the_spacing_and_beyond_the_length_are_left_out() {
        let text = "name = 'w'\nlayer = { masses = 8, spacing = 1.0, mass = 1.0 }\nsurface = { kind = 'flat' }";
        let scene = Scene::parse(text, "w.toml".as_ref()).unwrap();
        let resolved = |m: i32| scene.layer.resolves(TAU * f64::from(m) / 16.0);
        // 2π/(kΔx) is m = 2, π/Δx is m = 8.
        assert_eq!((1..20).filter(|&m| resolved(m)).collect::<Vec<_>>(), [2, 3, 4, 5, 6, 7, 8]);
    }
}
