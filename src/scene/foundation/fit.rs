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

/// The body that a layer stands for: what lies below its surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ElasticBody {
    /// An elastic half-plane.
    HalfPlane,
    /// A layer bonded to a rigid base.
    Bonded {
        /// Thickness H, m.
        thickness: f64,
        /// Poisson's ratio ν, 1.
        poisson_ratio: f64,
    },
}

/// Below this a = qH the difference sinh 2a - 2a is taken from its series.
const THIN: f64 = 0.01;

impl ElasticBody {
    /// K(q), 1/m: a pressure wave p_q of the wave number q (rad/m) moves the surface along its normal by p_q/(M K(q)),
    /// with the plane modulus M, in plane strain (K. L. Johnson, *Contact Mechanics*, 1985, section 13.2).
    pub fn normal(self, wave_number: f64) -> f64 {
        self.stiffness(wave_number, normal_numerator)
    }

    /// K(q) of a wave of tangential traction and the displacement along it, 1/m.
    pub fn tangential(self, wave_number: f64) -> f64 {
        self.stiffness(wave_number, tangential_numerator)
    }

    /// q/(2S), where S = `numerator`/(2κ cosh 2a + 4a² + 1 + κ²), κ = 3 - 4ν, a = qH, is the layer's compliance over
    /// that of the half-plane; above and below the line times e^(-2a), which does not overflow.
    fn stiffness(self, wave_number: f64, numerator: fn(f64, f64) -> f64) -> f64 {
        let Self::Bonded { thickness, poisson_ratio } = self else { return 0.5 * wave_number };
        let (a, kappa) = (wave_number * thickness, 3.0 - 4.0 * poisson_ratio);
        let decay = (-2.0 * a).exp();
        let denominator = kappa * (1.0 + decay * decay) + (4.0 * a * a + 1.0 + kappa * kappa) * decay;
        0.5 * wave_number * denominator / numerator(a, kappa)
    }
}

/// (2κ sinh 2a - 4a) e^(-2a)
fn normal_numerator(a: f64, kappa: f64) -> f64 {
    let decay = (-2.0 * a).exp();
    if a < THIN {
        let square = 4.0 * a * a;
        // sinh 2a - 2a
        let excess = 2.0 * a * square / 6.0 * (1.0 + square / 20.0 * (1.0 + square / 42.0));
        return (2.0 * kappa * excess + 4.0 * a * (kappa - 1.0)) * decay;
    }
    kappa * (1.0 - decay * decay) - 4.0 * a * decay
}

/// (2κ sinh 2a + 4a) e^(-2a)
fn tangential_numerator(a: f64, kappa: f64) -> f64 {
    let decay = (-2.0 * a).exp();
    kappa * -(-4.0 * a).exp_m1() + 4.0 * a * decay
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

    fn bonded(thickness: f64, poisson_ratio: f64) -> ElasticBody {
        ElasticBody::Bonded { thickness, poisson_ratio }
    }

    #[test]
    fn a_thick_layer_is_a_half_plane() {
        for poisson_ratio in [0.0, 0.3, 0.5] {
            let body = bonded(1.0, poisson_ratio);
            // What is left of the base is e^(-2a).
            assert_relative(body.normal(40.0), ElasticBody::HalfPlane.normal(40.0), 1e-15);
            assert_relative(body.tangential(1e4), ElasticBody::HalfPlane.tangential(1e4), 1e-15);
        }
    }

    #[test]
    fn a_thin_layer_is_in_uniaxial_strain_and_in_simple_shear() {
        let h = 2e-3;
        for nu in [0.0, 0.3, 0.48] {
            let body = bonded(h, nu);
            // The next term is of the order a²/(1-2ν)².
            assert_relative(body.normal(1e-3 / h), (1.0 - nu) * (1.0 - nu) / ((1.0 - 2.0 * nu) * h), 1e-3);
            assert_relative(body.tangential(1e-3 / h), (1.0 - nu) / (2.0 * h), 1e-2);
        }
        let q = 1e-3 / h;
        // Incompressible: the next term is of the order a².
        assert_relative(bonded(h, 0.5).normal(q), 3.0 / (4.0 * q * q * h.powi(3)), 1e-5);
    }

    #[test]
    fn the_series_joins_the_closed_form() {
        for nu in [0.3, 0.49, 0.5] {
            let (below, above) = (THIN * (1.0 - 1e-9), THIN * (1.0 + 1e-9));
            let ratio = normal_numerator(above, 3.0 - 4.0 * nu) / normal_numerator(below, 3.0 - 4.0 * nu);
            // Three powers of a at most; the closed form loses four digits at ν = 0.5.
            assert!((ratio - 1.0).abs() < 1e-8, "{nu}: {ratio}");
        }
    }

    #[test]
    fn the_surface_moves_as_naviers_equations_say() {
        for (a, nu) in [(0.05, 0.3), (0.5, 0.3), (1.0, 0.45), (2.0, 0.0), (4.0, 0.48), (1.0, 0.5 - 1e-9)] {
            let body = bonded(1.0, nu);
            // Fourth order with 4000 steps: far below 1e-6.
            assert_relative(body.normal(a), navier(a, nu, [0.0, 1.0]), 1e-6);
            assert_relative(body.tangential(a), navier(a, nu, [1.0, 0.0]), 1e-6);
        }
    }

    /// Navier's equations of a layer of thickness 1 and shear modulus 1 under a wave of the tractions (τ, σ) on its
    /// surface: the stiffness over the plane modulus against the displacement along the traction.
    ///
    /// With u = U sin qx, w = W cos qx, τ = T sin qx and σ = N cos qx they are four ordinary equations over the depth,
    /// here integrated from the base by Runge and Kutta's method; two solutions are combined to the given tractions.
    fn navier(q: f64, nu: f64, traction: [f64; 2]) -> f64 {
        let lambda = 2.0 * nu / (1.0 - 2.0 * nu);
        let slope = |y: [f64; 4]| {
            let [u, w, t, n] = y;
            let w_z = (n - lambda * q * u) / (lambda + 2.0);
            let sigma_x = (lambda + 2.0) * q * u + lambda * w_z;
            [t + q * w, w_z, q * sigma_x, -q * t]
        };
        let integrate = |start: [f64; 4]| {
            let steps = 4000;
            let h = 1.0 / f64::from(steps);
            let step = |y: [f64; 4], k: [f64; 4], c: f64| [0, 1, 2, 3].map(|i| y[i] + c * k[i]);
            (0..steps).fold(start, |y, _| {
                let k1 = slope(y);
                let k2 = slope(step(y, k1, h / 2.0));
                let k3 = slope(step(y, k2, h / 2.0));
                let k4 = slope(step(y, k3, h));
                [0, 1, 2, 3].map(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
            })
        };
        let (first, second) = (integrate([0.0, 0.0, 1.0, 0.0]), integrate([0.0, 0.0, 0.0, 1.0]));
        let determinant = first[2] * second[3] - first[3] * second[2];
        let p = (traction[0] * second[3] - traction[1] * second[2]) / determinant;
        let r = (traction[1] * first[2] - traction[0] * first[3]) / determinant;
        let moved = [0, 1].map(|i| p * first[i] + r * second[i]);
        let displacement = if traction[0] == 0.0 { moved[1] } else { moved[0] };
        // M = 2G/(1-ν)
        (1.0 - nu) / 2.0 / displacement
    }
}
