//! The stiffness of an elastic body's surface against a wave of pressure or of traction.

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
    use super::*;
    use crate::in_tests::assert_relative;

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
