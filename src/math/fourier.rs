//! The discrete Fourier transform of any number of values, in a fixed order of operations and without the platform's
//! sines: the same bits everywhere.

use std::f64::consts::PI;

use nalgebra::Complex;

/// The direction of a transform.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FourierDirection {
    /// e^(-2πi nm/N)
    Forward,
    /// e^(+2πi nm/N)
    Backward,
}

/// Z_m = Σ_n z_n e^(∓2πi nm/N), n and m from 0 to N-1, without a factor before the sum.
///
/// L. Bluestein's algorithm (1970): with 2nm = n² + m² - (m-n)² the sum is a convolution with the chirp e^(πi n²/N),
/// and a cyclic one of length M ≥ 2N - 1, a power of two, once padded. Takes O(N log N) for every N, prime or not.
///
/// ```
/// use asperity::math::{FourierDirection, fourier};
/// use nalgebra::Complex;
///
/// let sums = fourier(&[1.0, 2.0, 6.0].map(Complex::from), FourierDirection::Forward);
/// assert!((sums[0] - Complex::from(9.0)).norm() < 1e-14);
/// ```
pub fn fourier(values: &[Complex<f64>], direction: FourierDirection) -> Vec<Complex<f64>> {
    Transform::new(values.len(), direction).of(values.iter().copied())
}

/// As [`fourier`] along both axes of values that stand line by line, `nx` in each, in place.
pub fn fourier_2d(values: &mut [Complex<f64>], nx: usize, direction: FourierDirection) {
    let along_x = Transform::new(nx, direction);
    for line in values.chunks_exact_mut(nx) {
        let sums = along_x.of(line.iter().copied());
        line.copy_from_slice(&sums);
    }
    let along_y = Transform::new(values.len() / nx, direction);
    for i in 0..nx {
        let sums = along_y.of(values.iter().skip(i).step_by(nx).copied());
        values.iter_mut().skip(i).step_by(nx).zip(sums).for_each(|(value, sum)| *value = sum);
    }
}

/// What transforms of the same length have in common.
struct Transform {
    chirp: Vec<Complex<f64>>,
    twiddles: Twiddles,
    /// The transform of the chirp's conjugate, cyclic.
    filter: Vec<Complex<f64>>,
}

impl Transform {
    fn new(count: usize, direction: FourierDirection) -> Self {
        let chirp = chirp(count, direction);
        let twiddles = Twiddles::new((2 * count).next_power_of_two());
        let mut filter = twiddles.zeros();
        for (i, w) in chirp.iter().enumerate() {
            filter[i] = w.conj();
            let length = filter.len();
            filter[(length - i) % length] = w.conj();
        }
        twiddles.forward(&mut filter);
        Self { chirp, twiddles, filter }
    }

    fn of(&self, values: impl Iterator<Item = Complex<f64>>) -> Vec<Complex<f64>> {
        let Self { chirp, twiddles, filter } = self;
        let mut signal = twiddles.zeros();
        signal.iter_mut().zip(values.zip(chirp)).for_each(|(padded, (value, w))| *padded = value * w);
        twiddles.forward(&mut signal);
        signal.iter_mut().zip(filter).for_each(|(value, factor)| *value *= factor);
        twiddles.backward(&mut signal);
        let scale = 1.0 / signal.len() as f64;
        signal.iter().zip(chirp).map(|(value, w)| value * w * scale).collect()
    }
}

/// e^(∓πi n²/N); n² is taken modulo 2N, so that no digits of the angle are lost.
fn chirp(count: usize, direction: FourierDirection) -> Vec<Complex<f64>> {
    let sign = if direction == FourierDirection::Forward { -1.0 } else { 1.0 };
    let period = 2 * count as u64;
    (0..count as u64).map(|n| unit(sign * PI * (n * n % period) as f64 / count as f64)).collect()
}

fn unit(angle: f64) -> Complex<f64> {
    let (sine, cosine) = libm::sincos(angle);
    Complex::new(cosine, sine)
}

/// e^(-2πi k/n) for every power of two n from the largest down to 2, k from 0 to n/2 - 1.
struct Twiddles {
    levels: Vec<Vec<Complex<f64>>>,
}

impl Twiddles {
    fn new(length: usize) -> Self {
        let mut level: Vec<_> = (0..length / 2).map(|k| unit(-2.0 * PI * k as f64 / length as f64)).collect();
        let mut levels = Vec::new();
        while !level.is_empty() {
            let next = if level.len() == 1 { Vec::new() } else { level.iter().copied().step_by(2).collect() };
            levels.push(std::mem::replace(&mut level, next));
        }
        Self { levels }
    }

    fn zeros(&self) -> Vec<Complex<f64>> {
        vec![Complex::from(0.0); self.levels.first().map_or(1, |level| 2 * level.len())]
    }

    /// The transform, its values in the order of their reversed bits.
    fn forward(&self, values: &mut [Complex<f64>]) {
        split(values, &self.levels);
    }

    /// The transform back, from values in the order of their reversed bits, times their number.
    fn backward(&self, values: &mut [Complex<f64>]) {
        join(values, &self.levels);
    }
}

/// Decimation in frequency, one half after the other: a half that fits into the cache stays there.
fn split(values: &mut [Complex<f64>], levels: &[Vec<Complex<f64>>]) {
    let Some((twiddles, levels)) = levels.split_first() else { return };
    let (low, high) = values.split_at_mut(twiddles.len());
    for ((a, b), w) in low.iter_mut().zip(high.iter_mut()).zip(twiddles) {
        (*a, *b) = (*a + *b, (*a - *b) * w);
    }
    split(low, levels);
    split(high, levels);
}

/// Undoes [`split`], but for a factor of two at every level.
fn join(values: &mut [Complex<f64>], levels: &[Vec<Complex<f64>>]) {
    let Some((twiddles, levels)) = levels.split_first() else { return };
    let (low, high) = values.split_at_mut(twiddles.len());
    join(low, levels);
    join(high, levels);
    for ((a, b), w) in low.iter_mut().zip(high.iter_mut()).zip(twiddles) {
        let turned = *b * w.conj();
        (*a, *b) = (*a + turned, *a - turned);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::SplitMix64;

    fn random(count: usize) -> Vec<Complex<f64>> {
        let mut random = SplitMix64::new(count as u64);
        (0..count).map(|_| Complex::new(random.unit() - 0.5, random.unit() - 0.5)).collect()
    }

    fn difference(a: &[Complex<f64>], b: &[Complex<f64>]) -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
    }

    #[test]
    fn any_number_of_values_is_transformed_as_the_sum_says() {
        for n in [1, 2, 3, 4, 5, 8, 12, 17, 30, 64, 97, 100] {
            let values = random(n);
            for (direction, sign) in [(FourierDirection::Forward, -1.0), (FourierDirection::Backward, 1.0)] {
                let term = |i: usize, m: usize| values[i] * unit(sign * 2.0 * PI * (i * m % n) as f64 / n as f64);
                let sums: Vec<_> = (0..n).map(|m| (0..n).map(|i| term(i, m)).sum()).collect();
                // Roundings of sums of up to 100 terms of size 1.
                assert!(difference(&fourier(&values, direction), &sums) < 3e-14, "{n}");
            }
        }
    }

    /// A wave along both axes has one coefficient.
    #[test]
    fn in_two_dimensions_each_wave_has_its_place() {
        let (nx, ny) = (6, 5);
        let wave =
            |at: usize| unit(2.0 * PI * (2.0 * (at % nx) as f64 / nx as f64 + 3.0 * (at / nx) as f64 / ny as f64));
        let mut values: Vec<_> = (0..nx * ny).map(wave).collect();
        fourier_2d(&mut values, nx, FourierDirection::Forward);
        for (at, value) in values.iter().enumerate() {
            let expected = if at == 3 * nx + 2 { 30.0 } else { 0.0 };
            assert!((value - Complex::from(expected)).norm() < 1e-12, "{at}: {value}");
        }
    }

    #[test]
    fn there_and_back_is_the_same() {
        for n in [1000, 4096, 7919] {
            let values = random(n);
            let back = fourier(&fourier(&values, FourierDirection::Forward), FourierDirection::Backward);
            let scaled: Vec<_> = back.iter().map(|value| value / n as f64).collect();
            assert!(difference(&scaled, &values) < 1e-14, "{n}");
        }
    }
}
