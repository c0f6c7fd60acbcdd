//! The real area of contact below the spacing of the masses, on which adhesive friction acts.
//!
//! On the roughness that the profile lacks a contact of the area A touches on
//!
//!   A_r = A erf(x),   x = √π F_N/(A M_c h'_s),
//!
//! with the root mean square gradient h'_s of that roughness and the modulus M_c at which its waves pass. The form is
//! B. N. J. Persson's (J. Chem. Phys. 115, 2001, 3840); its factor gives A_r/A = 2p/(M h') at low pressure, where
//! simulations of rough surfaces agree (N. Prodanov, W. B. Dapp and M. H. Müser, Tribol. Lett. 53, 2014, 433).

use std::f64::consts::PI;

use crate::math::{cubic, interval_of};
use crate::scene::Scene;

/// Distance of ln v over which the slopes of the table are taken: its square and the roundings over it are small.
const NEARBY: f64 = 1.0e-4;

/// The law of one mass in contact.
#[derive(Clone, Debug)]
pub struct RealAreaLaw {
    /// A, m².
    area: f64,
    /// v_c, m/s: up to this speed the area is that at rest.
    creep_speed: f64,
    /// ln v of the table; one entry where M_c is the same at every speed.
    log_speeds: Vec<f64>,
    /// ln(M_c h'_s) there, and its slopes over ln v; M_c in Pa.
    log_stresses: Vec<f64>,
    slopes: Vec<f64>,
}

/// The part A_r/A of the area that touches, and its derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AreaShare {
    /// A_r/A, 1.
    pub value: f64,
    /// By F_N, 1/N.
    pub by_normal: f64,
    /// By the speed, s/m.
    pub by_speed: f64,
}

/// Entries of the table in a decade of speeds.
const PER_DECADE: f64 = 16.0;
/// The table ends where the modulus has come to its limits: this factor beyond the rates 1/τ of the material.
const MARGIN: f64 = 1.0e4;

impl RealAreaLaw {
    /// The law of a scene; `None` where the scene has no roughness below its profile.
    pub fn new(scene: &Scene) -> Option<Self> {
        let roughness = scene.fine_roughness().filter(|roughness| roughness.gradient() > 0.0)?;
        let area = scene.layer.element_area()?;
        let creep_speed = scene.rate_shear().map_or(0.0, |law| law.creep_speed());
        let material = scene.material.as_ref()?;
        let log_speeds = match (roughness.wave_numbers(), material.rates()) {
            (Some(waves), Some(rates)) => log_speeds(rates.0 / waves.1 / MARGIN, rates.1 / waves.0 * MARGIN),
            _ => vec![0.0],
        };
        let stress = |log_speed: &f64| roughness.stress(material, log_speed.exp()).max(f64::MIN_POSITIVE).ln();
        let log_stresses: Vec<f64> = log_speeds.iter().map(stress).collect();
        let slope = |log_speed: &f64| (stress(&(log_speed + NEARBY)) - stress(&(log_speed - NEARBY))) / (2.0 * NEARBY);
        let mut slopes: Vec<f64> = log_speeds.iter().map(slope).collect();
        keep_monotone(&log_speeds, &log_stresses, &mut slopes);
        Some(Self { area, creep_speed, log_speeds, log_stresses, slopes })
    }

    /// Whether the area changes with the speed.
    pub fn depends_on_speed(&self) -> bool {
        self.log_speeds.len() > 1
    }

    /// v_c, m/s, or the speed below which the modulus is that at rest.
    pub fn creep_speed(&self) -> f64 {
        self.creep_speed.max(self.log_speeds[0].exp())
    }

    /// The speeds that the modulus is tabulated for, m/s, ascending.
    pub fn speeds(&self) -> impl Iterator<Item = f64> {
        self.log_speeds.iter().map(|log_speed| log_speed.exp())
    }

    /// The share at rest under the normal force F_N, N.
    pub fn at_rest(&self, normal: f64) -> AreaShare {
        self.share(normal, 0.0)
    }

    /// A_r/A at rest under F_N (N): out of the way of contacts that touch on all of their area.
    #[inline(never)]
    pub fn share_at_rest(&self, normal: f64) -> f64 {
        self.at_rest(normal).value
    }

    /// The share under F_N (N) at a `speed` of either sign, m/s.
    pub fn share(&self, normal: f64, speed: f64) -> AreaShare {
        if normal <= 0.0 {
            return AreaShare::default();
        }
        let (stress, by_speed) = self.stress(speed.abs());
        let scale = 1.0 / (self.area * stress);
        let x = PI.sqrt() * normal * scale;
        let by_normal = 2.0 * (-x * x).exp() * scale;
        let by_stress = -normal / stress * by_normal;
        let sign = 1.0_f64.copysign(speed);
        AreaShare { value: libm::erf(x), by_normal, by_speed: by_stress * by_speed * sign }
    }

    /// M_c h'_s at a speed ≥ 0, Pa, and its derivative by the speed, Pa s/m.
    fn stress(&self, speed: f64) -> (f64, f64) {
        let last = self.log_speeds.len() - 1;
        let slow = speed <= self.creep_speed;
        let at = speed.max(self.creep_speed).ln();
        if last == 0 || at <= self.log_speeds[0] {
            return (self.log_stresses[0].exp(), 0.0);
        }
        let (log_stress, slope) = if at >= self.log_speeds[last] {
            // With a viscosity the modulus grows with the speed without end.
            let slope = self.slopes[last];
            (self.log_stresses[last] + slope * (at - self.log_speeds[last]), slope)
        } else {
            let i = interval_of(&self.log_speeds, at);
            let found = cubic(&self.log_speeds, &self.log_stresses, &self.slopes, i, at);
            (found.value, found.slope)
        };
        let stress = log_stress.exp();
        (stress, if slow { 0.0 } else { stress * slope / speed })
    }
}

/// Limits the slopes so that no cubic between two entries falls: to three times the secants beside (F. N. Fritsch and
/// R. E. Carlson, SIAM J. Numer. Anal. 17, 1980).
fn keep_monotone(x: &[f64], y: &[f64], slopes: &mut [f64]) {
    let secant = |i: usize| (y[i + 1] - y[i]) / (x[i + 1] - x[i]);
    for i in 0..slopes.len().saturating_sub(1) {
        let most = 3.0 * secant(i).max(0.0);
        (slopes[i], slopes[i + 1]) = (slopes[i].clamp(0.0, most), slopes[i + 1].clamp(0.0, most));
    }
}

/// Even steps of ln v from `low` to `high`, m/s.
fn log_speeds(low: f64, high: f64) -> Vec<f64> {
    let decades = (high / low).log10();
    let steps = (decades * PER_DECADE).ceil().max(1.0);
    (0..=steps as usize).map(|i| low.ln() + i as f64 / steps * (high / low).ln()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(real_area: &str, prony: &str) -> RealAreaLaw {
        let text = format!(
            "name = 'r'\nsurface = {{ kind = 'flat' }}\nfmu = {{ outputs = [] }}
             layer = {{ masses = 2, spacing = 1e-4, foundation = 'half_space', width = 1e-2 }}
             material = {{ density = 1100, poisson_ratio = 0.5, equilibrium_modulus = 3e6, prony = {prony} }}
             friction = {{ shear_strength = 1e6, real_area = {real_area} }}"
        );
        let scene = Scene::parse(&text, "real-area.toml".as_ref()).unwrap_or_else(|error| unreachable!("{error}"));
        RealAreaLaw::new(&scene).unwrap_or_else(|| unreachable!("no law"))
    }

    const PRONY: &str = "[{ modulus = 5e7, relaxation_time = 1e-5 }, { modulus = 1e6, relaxation_time = 1e-2 }]";
    const BAND: &str = "{ rms_slope = 0.8, wavelength = 1e-5 }";

    #[test]
    fn at_low_pressure_it_is_twice_the_pressure_over_modulus_and_slope() {
        let law = law("{ rms_slope = 0.5, modulus = 4e6 }", "[]");
        let found = law.at_rest(1e-6).value;
        // x² /3 of erf's series.
        assert!((found / (2.0 * 1.0 / (4e6 * 0.5)) - 1.0).abs() < 1e-6, "{found}");
        assert_eq!(law.at_rest(1e3).value, 1.0);
        assert_eq!(law.at_rest(-1.0), AreaShare::default());
        assert!(!law.depends_on_speed());
    }

    /// M_c is that of the material at the frequency of the wave, between the entries of the table too.
    #[test]
    fn the_modulus_is_that_at_which_the_waves_pass() {
        let law = law(BAND, PRONY);
        let q = std::f64::consts::TAU / 1e-5;
        for speed in [1e-9_f64, 1e-6, 3.3e-4, 0.0271, 1.77, 1e3] {
            let terms = [(5e7, 1e-5), (1e6, 1e-2)];
            let part = |(modulus, tau): (f64, f64)| {
                let x = q * speed * tau;
                (modulus * x * x / (1.0 + x * x), modulus * x / (1.0 + x * x))
            };
            let storage = 3e6 + terms.iter().map(|&term| part(term).0).sum::<f64>();
            let loss: f64 = terms.iter().map(|&term| part(term).1).sum();
            let expected = storage.hypot(loss) / 0.75 * 0.8;
            // The error of a cubic at 16 entries a decade, h⁴/384 times the fourth derivative, which is of the order of
            // one.
            assert!((law.stress(speed).0 / expected - 1.0).abs() < 5e-6, "{speed}");
        }
    }

    #[test]
    fn derivatives_are_those_of_difference_quotients() {
        let law = law(BAND, PRONY);
        for normal in [1e-3, 0.1, 5.0] {
            for speed in [1e-6_f64, 2e-4, 0.03, 4.0] {
                let found = law.share(normal, speed);
                let quotient = |f: &dyn Fn(f64) -> f64, at: f64| (f(at * 1.0001) - f(at * 0.9999)) / (0.0002 * at);
                let by_normal = quotient(&|normal| law.share(normal, speed).value, normal);
                let by_speed = quotient(&|speed| law.share(normal, speed).value, speed);
                // The third derivative times the square of 1e-4, and roundings over 1e-4.
                let near = |a: f64, b: f64, scale: f64| (a - b).abs() < 1e-6 * b.abs() + 1e-11 * scale;
                assert!(near(found.by_normal, by_normal, 1.0 / normal), "{found:?} {by_normal}");
                assert!(near(found.by_speed, by_speed, 1.0 / speed), "{found:?} {by_speed}");
                assert_eq!(law.share(normal, -speed).by_speed, -found.by_speed);
            }
        }
    }
}
