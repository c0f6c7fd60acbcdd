//! The stiffnesses of the links to the carrier and between the masses that come nearest to those of a body's surface.

use serde::Serialize;

use super::waves::Waves;

/// A foundation by springs α and between them β: (α + βD²) M is its stiffness against a wave, D = (2/Δx) sin(qΔx/2).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Stiffness {
    /// α of the links to the carrier over the plane modulus, 1/m.
    pub alpha: f64,
    /// β of the lateral links over the plane modulus, m.
    pub beta: f64,
}

/// Below this part of the mean of D² its differences are roundings: there is one wave.
const ONE_WAVE: f64 = 1.0e-12;

impl Stiffness {
    /// The least squares of (α + βD²)/K(q) - 1 over the weighted wave numbers of `waves`, α and β not negative; of one
    /// wave alone, half of K by each.
    pub(super) fn fitted(waves: &Waves, body: impl Fn(f64) -> f64) -> Self {
        let term = |(wave_number, weight): (f64, f64)| {
            let flexibility = 1.0 / body(wave_number);
            [weight, flexibility, waves.difference_square(wave_number)]
        };
        let terms: Vec<[f64; 3]> = waves.weighted().map(term).collect();
        let sum = |value: &dyn Fn(f64, f64) -> f64| -> f64 {
            terms.iter().map(|&[weight, flexibility, square]| weight * value(flexibility, square)).sum()
        };
        // βD² with D² less its mean is orthogonal to α: nothing is lost by squaring the condition.
        let (ones, squares) = (sum(&|f, _| f * f), sum(&|f, _| f));
        let mean = sum(&|f, d| f * f * d) / ones;
        let variance = sum(&|f, d| (f * (d - mean)).powi(2));
        if variance <= (ONE_WAVE * mean).powi(2) * ones {
            let half = 0.5 * squares / ones;
            return Self { alpha: half, beta: half / mean };
        }
        let beta = sum(&|f, d| f * (d - mean)) / variance;
        let alpha = squares / ones - beta * mean;
        match (alpha < 0.0, beta < 0.0) {
            (true, _) => Self { alpha: 0.0, beta: sum(&|f, d| f * d) / sum(&|f, d| (f * d).powi(2)) },
            (_, true) => Self { alpha: squares / ones, beta: 0.0 },
            _ => Self { alpha, beta },
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::in_tests::assert_relative;
    use crate::scene::Scene;

    fn waves(masses: usize, spacing: f64, surface: &str) -> Waves {
        let text = format!(
            "name = 'w'\nlayer = {{ masses = {masses}, spacing = {spacing:?}, mass = 1.0 }}\nsurface = {{ {surface} }}"
        );
        let scene = Scene::parse(&text, "waves.toml".as_ref()).unwrap_or_else(|error| unreachable!("{error}"));
        Waves::new(&scene.layer, &scene.surface)
    }

    const ROUGH: &str = "kind = 'self_affine', length = 1e-2, points = 2000, hurst = 0.8, rms = 1e-5, \
                         roll_off_wavelength = 2e-3, cut_off_wavelength = 5e-5, seed = 3";
    const SINE: &str = "kind = 'sinusoid', amplitude = 1e-5, wavelength = 1e-3, points_per_wavelength = 1024";

    #[test]
    fn links_fitted_to_themselves_are_themselves() {
        for surface in [ROUGH, SINE, "kind = 'flat'"] {
            let waves = waves(200, 5e-5, surface);
            for (alpha, beta) in [(1e3, 2e-5), (1e6, 1e-6), (10.0, 1e-3)] {
                let fit = Stiffness::fitted(&waves, |q| alpha + beta * waves.difference_square(q));
                assert_relative(fit.alpha, alpha, 1e-9);
                assert_relative(fit.beta, beta, 1e-9);
            }
        }
    }

    /// Of a sine on a fine grid α = 0.837 K and βq² = 0.174 K.
    #[test]
    fn a_sine_on_a_half_plane_has_its_known_shares() {
        let q = TAU / 1e-3;
        let fit = Stiffness::fitted(&waves(4096, 1e-3 / 1024.0, SINE), |q| 0.5 * q);
        assert_relative(fit.alpha, 0.837 * 0.5 * q, 1e-2);
        assert_relative(fit.beta, 0.174 * 0.5 / q, 1e-2);
    }

    #[test]
    fn one_wave_is_shared_by_halves() {
        // The shortest wave that the masses resolve has its tail beyond.
        let waves = waves(8, 1e-3 / 2.0, "kind = 'sinusoid', amplitude = 1e-5, wavelength = 1e-3");
        let q = TAU / 1e-3;
        let fit = Stiffness::fitted(&waves, |q| 0.5 * q);
        assert_relative(fit.alpha, 0.25 * q, 1e-12);
        assert_relative(fit.beta, 0.25 * q / waves.difference_square(q), 1e-12);
    }

    #[test]
    fn no_stiffness_is_negative() {
        let waves = waves(200, 5e-5, ROUGH);
        let falling = Stiffness::fitted(&waves, |q| 1.0 / q);
        assert!(falling.beta == 0.0 && falling.alpha > 0.0, "{falling:?}");
        let steep = Stiffness::fitted(&waves, |q| q.powi(4));
        assert!(steep.alpha == 0.0 && steep.beta > 0.0, "{steep:?}");
    }

    #[test]
    fn the_unit_of_length_scales_both() {
        let (one, other) = (waves(200, 5e-5, ROUGH), waves(200, 5e-2, &thousandfold()));
        let (one, other) = (Stiffness::fitted(&one, |q| 0.5 * q), Stiffness::fitted(&other, |q| 0.5 * q));
        assert_relative(other.alpha, one.alpha / 1e3, 1e-9);
        assert_relative(other.beta, one.beta * 1e3, 1e-9);
    }

    fn thousandfold() -> String {
        ROUGH.replace("1e-2", "10.0").replace("1e-5,", "1e-2,").replace("2e-3", "2.0").replace("5e-5", "5e-2")
    }
}
