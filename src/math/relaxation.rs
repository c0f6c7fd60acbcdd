//! Exponential relaxation driven by a polynomial.

/// Weights of the exact solution of da/dθ = ṗ(θ) - z a: a(θ) = `decay` a(0) + Σ_m `driven[m]` p_m for
/// ṗ = Σ p_m θ^m, m = 0 … 4. Bounded for every z ≥ 0, however fast the relaxation is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Relaxation {
    /// e^{-zθ}.
    pub decay: f64,
    /// ∫_0^θ e^{-z(θ-s)} s^m ds = θ^{m+1} m! φ_{m+1}(-zθ).
    pub driven: [f64; 5],
}

impl Relaxation {
    /// The weights at the fraction `theta` for the ratio `z` of step and relaxation time.
    pub fn new(z: f64, theta: f64) -> Self {
        let x = z * theta;
        let phi = phi_functions(x);
        let mut driven = [0.0; 5];
        let mut factor = theta;
        for (m, weight) in driven.iter_mut().enumerate() {
            *weight = factor * phi[m];
            factor *= theta * (m + 1) as f64;
        }
        Self { decay: (-x).exp(), driven }
    }
}

/// φ_1 … φ_5 at -x, x ≥ 0: φ_0 = exp, φ_{k+1}(y) = (φ_k(y) - 1/k!)/y.
///
/// The recursion upwards loses digits for small x, so there the series of φ_5 is summed and the recursion run
/// downwards, which is stable.
fn phi_functions(x: f64) -> [f64; 5] {
    let mut phi = [0.0; 5];
    if x > 1.0 {
        let mut lower = (-x).exp();
        for (k, value) in phi.iter_mut().enumerate() {
            *value = (INVERSE_FACTORIAL[k] - lower) / x;
            lower = *value;
        }
    } else {
        let mut term = INVERSE_FACTORIAL[5];
        for divisor in INVERSE_DIVISORS {
            let sum = phi[4] + term;
            // Those after a term too small to count are smaller still.
            if sum == phi[4] {
                break;
            }
            phi[4] = sum;
            term *= -x * divisor;
        }
        for k in (1..5).rev() {
            phi[k - 1] = INVERSE_FACTORIAL[k] - x * phi[k];
        }
    }
    phi
}

const INVERSE_FACTORIAL: [f64; 6] = [1.0, 1.0, 1.0 / 2.0, 1.0 / 6.0, 1.0 / 24.0, 1.0 / 120.0];

/// 1/(5 + 14)! is below the last digit of 1/5!.
const TERMS: usize = 14;

/// 1/(5 + n) for n = 1 … [`TERMS`].
const INVERSE_DIVISORS: [f64; TERMS] = {
    let mut inverse = [0.0; TERMS];
    let mut n = 0;
    while n < TERMS {
        inverse[n] = 1.0 / (6 + n) as f64;
        n += 1;
    }
    inverse
};

#[cfg(test)]
mod tests {
    use super::*;

    /// The same integral by Gauss's rule with two points on many intervals.
    fn quadrature(z: f64, theta: f64, m: i32) -> f64 {
        let n = 20_000;
        let h = theta / f64::from(n);
        let half = 0.5 / 3.0_f64.sqrt();
        let f = |s: f64| (-z * (theta - s)).exp() * s.powi(m);
        (0..n).map(|i| f64::from(i) + 0.5).map(|c| 0.5 * h * (f((c - half) * h) + f((c + half) * h))).sum()
    }

    #[test]
    fn agrees_with_quadrature() {
        for z in [0.0, 1e-9, 0.3, 1.0, 1.2, 7.0, 90.0] {
            for theta in [0.1, 1.0] {
                let weights = Relaxation::new(z, theta);
                for m in 0..5 {
                    let expected = quadrature(z, theta, m);
                    // Upwards recursion at x just above 1 loses up to three digits in φ_5.
                    let error = (weights.driven[m as usize] - expected).abs() / expected;
                    assert!(error < 1e-11, "z {z} θ {theta} m {m}: {error:e}");
                }
            }
        }
    }

    #[test]
    fn a_fast_relaxation_follows_its_drive() {
        let weights = Relaxation::new(1e12, 0.5);
        assert_eq!(weights.decay, 0.0);
        // a = ṗ/z at leading order.
        assert!((weights.driven[1] * 1e12 - 0.5).abs() < 1e-9);
    }
}
