//! The roughness below the resolution of the profile, as bands of waves.

use std::f64::consts::TAU;

use super::{Material, RealArea, Scene, SelfAffine};

/// Bands of waves that the profile lacks.
#[derive(Clone, Debug, PartialEq)]
pub struct FineRoughness {
    /// Wave number (rad/m) and mean square gradient (1) of each; without a wave number where the modulus is given.
    bands: Vec<(Option<f64>, f64)>,
    /// M_c at every speed, Pa; `None`: the material's at the frequency of each wave.
    modulus: Option<f64>,
}

/// Bands of a law that goes on.
const BANDS: usize = 32;

impl Scene {
    /// The roughness that the friction law adds to the profile, if it does.
    pub fn fine_roughness(&self) -> Option<FineRoughness> {
        let RealArea { rms_slope, wavelength, modulus, cut_off_wavelength } = self.friction.as_ref()?.real_area?;
        let bands = match (rms_slope, cut_off_wavelength) {
            (Some(slope), _) => vec![(wavelength.map(|length| TAU / length), slope * slope)],
            (None, Some(cut_off)) => self.surface.self_affine()?.continued(cut_off),
            (None, None) => return None,
        };
        Some(FineRoughness { bands, modulus })
    }
}

impl RealArea {
    /// What it is, in a few words.
    pub fn describe(&self) -> String {
        let Self { rms_slope, wavelength, modulus, cut_off_wavelength } = self;
        let part = |name: &str, value: &Option<f64>, unit: &str| value.map(|value| format!("{name} {value:?}{unit}"));
        let parts = [
            part("rms_slope", rms_slope, ""),
            part("wavelength", wavelength, " m"),
            part("modulus", modulus, " Pa"),
            part("cut_off_wavelength", cut_off_wavelength, " m"),
        ];
        parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
    }
}

impl FineRoughness {
    /// h'_s, 1: the root mean square gradient.
    pub fn gradient(&self) -> f64 {
        self.bands.iter().map(|band| band.1).sum::<f64>().sqrt()
    }

    /// The least and the largest wave number, rad/m; `None` where the modulus is given.
    pub fn wave_numbers(&self) -> Option<(f64, f64)> {
        if self.modulus.is_some() {
            return None;
        }
        let of = |band: Option<&(Option<f64>, f64)>| band.and_then(|band| band.0);
        Some((of(self.bands.first())?, of(self.bands.last())?))
    }

    /// M_c h'_s at a speed (m/s), Pa: √(Σ |M(qv)|² h'²) over the bands.
    pub fn stress(&self, material: &Material, speed: f64) -> f64 {
        let modulus = |wave_number: &Option<f64>| match (self.modulus, wave_number) {
            (Some(modulus), _) => modulus,
            (None, q) => {
                let (storage, loss) = material.complex_modulus(q.unwrap_or(0.0) * speed);
                material.plane_modulus(storage.hypot(loss))
            }
        };
        self.bands.iter().map(|(q, square)| modulus(q).powi(2) * square).sum::<f64>().sqrt()
    }

    /// The bands: wave number (rad/m) and mean square gradient (1).
    pub fn bands(&self) -> impl Iterator<Item = (f64, f64)> {
        self.bands.iter().filter_map(|&(q, square)| Some((q?, square)))
    }
}

impl SelfAffine {
    /// The bands, even in ln q, of the law from its own cut-off down to the wavelength `cut_off` (m): an isotropic
    /// surface has the mean square gradient 2 ∫ q² C dq over each.
    fn continued(&self, cut_off: f64) -> Vec<(Option<f64>, f64)> {
        let (low, high) = (TAU / self.cut_off, TAU / cut_off);
        let edge = |b: usize| low * (high / low).powf(b as f64 / BANDS as f64);
        let exponent = 2.0 - 2.0 * self.hurst;
        let plateau = self.plateau() * (TAU / self.roll_off).powf(1.0 + 2.0 * self.hurst);
        let integral = |a: f64, b: f64| {
            // ∫ q^(1-2H) dq, with its limit ln(b/a) for H = 1.
            if exponent == 0.0 { (b / a).ln() } else { (b.powf(exponent) - a.powf(exponent)) / exponent }
        };
        let band = |b: usize| {
            let (a, b) = (edge(b), edge(b + 1));
            (Some((a * b).sqrt()), 2.0 * plateau * integral(a, b))
        };
        (0..BANDS).map(band).collect()
    }
}

impl Material {
    /// The least and the largest rate 1/τ_j at the layer's temperature, 1/s, that of E_∞/η among them; `None` for a
    /// material whose modulus is the same at every frequency.
    pub fn rates(&self) -> Option<(f64, f64)> {
        let shift = self.shift_factor();
        let glassy = self.equilibrium_modulus + self.prony.iter().map(|term| term.modulus).sum::<f64>();
        let viscous = self.viscosity.filter(|&viscosity| viscosity > 0.0).map(|viscosity| glassy / viscosity);
        let terms = self.prony.iter().filter(|term| term.modulus > 0.0).map(|term| 1.0 / term.relaxation_time);
        let rates = terms.chain(viscous).map(|rate| rate / shift);
        let (low, high) = rates.fold((f64::MAX, 0.0), |(low, high), rate: f64| (rate.min(low), rate.max(high)));
        (high > 0.0).then_some((low, high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean square gradient of the bands is the integral over all of them, here by a sum of many modes.
    #[test]
    fn the_law_goes_on() {
        for hurst in [0.7, 1.0] {
            let law =
                SelfAffine { length: 0.1, points: 4000, hurst, rms: 2e-5, roll_off: 5e-3, cut_off: 1e-4, seed: 1 };
            let step = TAU / 0.1;
            let modes = 1001..=100_000;
            let plateau = law.rms.powi(2)
                / (1..=1000_u32).map(|m| (f64::from(m) / 20.0).max(1.0).powf(-1.0 - 2.0 * hurst)).sum::<f64>();
            let square =
                |m: u32| 2.0 * (f64::from(m) * step).powi(2) * plateau * (f64::from(m) / 20.0).powf(-1.0 - 2.0 * hurst);
            let expected: f64 = modes.map(square).sum();
            let found: f64 = law.continued(1e-6).iter().map(|band| band.1).sum();
            // The sum over modes against the integral: half a mode of a thousand at the lower end.
            assert!((found / expected - 1.0).abs() < 2e-3, "{found} {expected}");
        }
    }
}
