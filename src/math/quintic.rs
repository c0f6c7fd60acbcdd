//! Polynomials of degree 5 over a step.

use std::ops::Sub;

use serde::{Deserialize, Serialize};

/// A polynomial of degree 5 on [0, 1] in Bernstein form: its values lie between the least and the largest coefficient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quintic {
    coefficients: [f64; 6],
}

/// Position, speed and acceleration at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Jet {
    /// Position.
    pub position: f64,
    /// Its first derivative.
    pub speed: f64,
    /// Its second derivative.
    pub acceleration: f64,
}

impl Sub for Jet {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self {
            position: self.position - other.position,
            speed: self.speed - other.speed,
            acceleration: self.acceleration - other.acceleration,
        }
    }
}

impl Quintic {
    /// The same position through the whole step.
    pub fn constant(position: f64) -> Self {
        Self { coefficients: [position; 6] }
    }

    /// The Hermite interpolant over a step of length `h`: error O(h⁶) of the position.
    pub fn hermite(start: Jet, end: Jet, h: f64) -> Self {
        let (v0, v1) = (h / 5.0 * start.speed, h / 5.0 * end.speed);
        let (a0, a1) = (h * h / 20.0 * start.acceleration, h * h / 20.0 * end.acceleration);
        let (p0, p1) = (start.position, end.position);
        Self { coefficients: [p0, p0 + v0, p0 + 2.0 * v0 + a0, p1 - 2.0 * v1 + a1, p1 - v1, p1] }
    }

    /// This and `shift` and the weighted sum of polynomials with these Bernstein coefficients.
    #[inline]
    pub fn plus<'a>(&self, shift: f64, terms: impl Iterator<Item = (f64, &'a [f64; 6])>) -> Self {
        let mut coefficients = self.coefficients.map(|coefficient| coefficient + shift);
        for (weight, term) in terms {
            for (coefficient, of_term) in coefficients.iter_mut().zip(term) {
                *coefficient += weight * of_term;
            }
        }
        Self { coefficients }
    }

    /// Position, and its derivatives with respect to the fraction, at the fraction `theta` of the step.
    pub fn evaluate(&self, theta: f64) -> Jet {
        let mut b = self.coefficients;
        let complement = 1.0 - theta;
        for degree in (3..=5).rev() {
            for i in 0..degree {
                b[i] = complement * b[i] + theta * b[i + 1];
            }
        }
        let (d0, d1) = (b[1] - b[0], b[2] - b[1]);
        Jet {
            position: complement * (complement * b[0] + theta * b[1]) + theta * (complement * b[1] + theta * b[2]),
            speed: 5.0 * (complement * d0 + theta * d1),
            acceleration: 20.0 * (d1 - d0),
        }
    }

    /// The positions at the start and at the end.
    pub fn ends(&self) -> (f64, f64) {
        (self.coefficients[0], self.coefficients[5])
    }

    /// The least and the largest value that the polynomial can take.
    pub fn range(&self) -> (f64, f64) {
        range(&self.coefficients)
    }

    /// Bounds of the absolute first and second derivative with respect to the fraction.
    pub fn derivative_bounds(&self) -> (f64, f64) {
        let c = &self.coefficients;
        let mut first = 0.0_f64;
        let mut second = 0.0_f64;
        for i in 0..5 {
            first = first.max((c[i + 1] - c[i]).abs());
        }
        for i in 0..4 {
            second = second.max((c[i + 2] - 2.0 * c[i + 1] + c[i]).abs());
        }
        (5.0 * first, 20.0 * second)
    }

    /// The two polynomials that together are this one, over the first and the second half.
    pub fn halves(&self) -> (Self, Self) {
        let mut work = self.coefficients;
        let (mut left, mut right) = (work, work);
        for degree in (1..=5).rev() {
            left[5 - degree] = work[0];
            right[degree] = work[degree];
            for i in 0..degree {
                work[i] = 0.5 * (work[i] + work[i + 1]);
            }
        }
        left[5] = work[0];
        right[0] = work[0];
        (Self { coefficients: left }, Self { coefficients: right })
    }
}

fn range(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn jet(f: impl Fn(f64) -> f64, f1: impl Fn(f64) -> f64, f2: impl Fn(f64) -> f64, t: f64) -> Jet {
        Jet { position: f(t), speed: f1(t), acceleration: f2(t) }
    }

    fn sine(h: f64) -> Quintic {
        let at = |t| jet(f64::sin, f64::cos, |t: f64| -t.sin(), t);
        Quintic::hermite(at(0.3), at(0.3 + h), h)
    }

    #[test]
    fn reproduces_a_quintic_with_its_derivatives() {
        let at = |t: f64| jet(|t| t.powi(5) - t, |t| 5.0 * t.powi(4) - 1.0, |t| 20.0 * t.powi(3), t);
        let (t0, h) = (0.4, 0.7);
        let q = Quintic::hermite(at(t0), at(t0 + h), h);
        let exact = at(t0 + 0.3 * h);
        let found = q.evaluate(0.3);
        // Exact but for roundings of numbers of size 1 to 20.
        assert!((found.position - exact.position).abs() < 1e-14);
        assert!((found.speed / h - exact.speed).abs() < 1e-13);
        assert!((found.acceleration / (h * h) - exact.acceleration).abs() < 1e-12);
    }

    #[test]
    fn converges_with_order_six() {
        let error = |h: f64| (sine(h).evaluate(0.5).position - (0.3 + 0.5 * h).sin()).abs();
        let order = (error(0.4) / error(0.2)).log2();
        assert!((5.7..6.3).contains(&order), "{order}");
    }

    /// θ/2 + 3 + 2 θ³.
    #[test]
    fn polynomials_add_up() {
        let half = Quintic::hermite(
            Jet { speed: 0.5, ..Jet::default() },
            Jet { position: 0.5, speed: 0.5, ..Jet::default() },
            1.0,
        );
        let cube = [0.0, 0.0, 0.0, 0.1, 0.4, 1.0];
        let found = half.plus(3.0, [(2.0, &cube)].into_iter()).evaluate(0.5);
        // A few roundings of tenths.
        assert!((found.position - 3.5).abs() < 1e-14 && (found.speed - 2.0).abs() < 1e-14, "{found:?}");
    }

    #[test]
    fn halves_are_the_whole() {
        let q = sine(1.3);
        let (left, right) = q.halves();
        for theta in [0.0, 0.2, 0.9, 1.0] {
            assert!((left.evaluate(theta).position - q.evaluate(theta / 2.0).position).abs() < 1e-15);
            assert!((right.evaluate(theta).position - q.evaluate(0.5 + theta / 2.0).position).abs() < 1e-15);
        }
    }

    #[test]
    fn bounds_hold() {
        let q = sine(2.0);
        let (low, high) = q.range();
        let (first, second) = q.derivative_bounds();
        for i in 0..=50 {
            let theta = f64::from(i) / 50.0;
            let p = q.evaluate(theta);
            assert!(low <= p.position && p.position <= high);
            assert!(p.speed.abs() <= first && p.acceleration.abs() <= second);
        }
    }
}
