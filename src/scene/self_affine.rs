//! Self-affine profiles: random ones with a given power spectrum.

use std::f64::consts::{SQRT_2, TAU};

use nalgebra::Complex;

use super::allowed;
use super::surface::KIND;
use super::table::TableReader;
use super::{SceneError, Surface};
use crate::math::{Direction, SplitMix64, fourier};

/// A number of points or modes that is whole but for rounding is that number.
const ROUNDING: f64 = 1.0e-9;

/// A periodic profile whose one-sided power spectrum is constant up to q_r = 2π/roll-off, falls as q^(-1-2H) up to
/// q_c = 2π/cut-off and is 0 beyond.
///
/// It is a sum over the modes m = 1, 2, … of the wave numbers q = 2πm/length,
///
/// z(x) = Σ a_m cos(q x + φ_m),   a_m² ∝ the spectrum at q,   φ_m = 2π · the m-th number of [`SplitMix64`] from the
/// seed,
///
/// at even points, scaled to the root mean square height. So every mode has exactly its share of the power, the same
/// seed gives the same bits everywhere, and more points the same profile with more points; a shorter cut-off adds modes
/// and leaves the phases of the others.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SelfAffine {
    /// Period, m.
    length: f64,
    /// Even intervals of a period.
    points: usize,
    /// Hurst exponent H, 1.
    hurst: f64,
    /// Root mean square height over one period, about a mean of 0, m.
    rms: f64,
    /// Wavelength above which the spectrum is constant, m.
    roll_off: f64,
    /// The shortest wavelength, m.
    cut_off: f64,
    seed: u64,
}

/// Reads the keys of such a profile and makes it.
pub(super) fn read(table: &mut TableReader<'_>) -> Result<Surface, SceneError> {
    const KEYS: [&str; 8] =
        [KIND, "length", "points", "hurst", "rms", "roll_off_wavelength", "cut_off_wavelength", "seed"];
    table.allow(&KEYS)?;
    let length = table.number("length", &allowed::LENGTH)?;
    let points = table.required("points", allowed::PROFILE_POINTS)?;
    let count = points.whole(&allowed::PROFILE_POINTS)?;
    let hurst = table.number("hurst", &allowed::HURST)?;
    let rms = table.number("rms", &allowed::RMS)?;
    let roll_off_entry = table.required("roll_off_wavelength", allowed::WAVELENGTH)?;
    let roll_off = roll_off_entry.number(&allowed::WAVELENGTH)?;
    let cut_off_entry = table.required("cut_off_wavelength", allowed::WAVELENGTH)?;
    let cut_off = cut_off_entry.number(&allowed::WAVELENGTH)?;
    let seed = table.required("seed", allowed::SEED)?.whole(&allowed::SEED)?;
    if roll_off > length {
        return Err(roll_off_entry.refuse(format_args!("a number up to {length:?}, the length")));
    }
    if cut_off >= roll_off {
        return Err(cut_off_entry.refuse(format_args!("a number < {roll_off:?}, the roll_off_wavelength")));
    }
    let least = (2.0 * length / cut_off * (1.0 - ROUNDING)).ceil();
    if (count as f64) < least {
        return Err(points.refuse(format_args!("at least {least}: two points a cut_off_wavelength")));
    }
    let points = usize::try_from(count).unwrap_or(usize::MAX);
    Ok(SelfAffine { length, points, hurst, rms, roll_off, cut_off, seed: seed.unsigned_abs() }.surface())
}

impl SelfAffine {
    fn surface(&self) -> Surface {
        let share = |i| i as f64 / self.points as f64;
        let x = (0..=self.points).map(|i| self.length * share(i)).collect();
        let mut z = self.heights();
        z.push(z[0]);
        Surface { x, z, periodic: true }
    }

    /// The heights at the points of one period, m.
    fn heights(&self) -> Vec<f64> {
        let sums = fourier(&self.coefficients(), Direction::Backward);
        let mean = sums.iter().map(|sum| sum.re).sum::<f64>() / self.points as f64;
        let mut z: Vec<f64> = sums.iter().map(|sum| sum.re - mean).collect();
        let scale = self.rms / (z.iter().map(|z| z * z).sum::<f64>() / self.points as f64).sqrt();
        z.iter_mut().for_each(|z| *z *= scale);
        z
    }

    /// The coefficients of e^(2πi nm/points), but for a common factor.
    fn coefficients(&self) -> Vec<Complex<f64>> {
        let mut coefficients = vec![Complex::from(0.0); self.points];
        let mut random = SplitMix64::new(self.seed);
        for m in 1..=self.modes() {
            let (sine, cosine) = libm::sincos(TAU * random.unit());
            let amplitude = self.power(m).sqrt();
            if 2 * m < self.points {
                coefficients[m] = Complex::new(amplitude * cosine, amplitude * sine);
                coefficients[self.points - m] = coefficients[m].conj();
            } else {
                // Two points a wavelength see no phase: the amplitude is set to the mean power of all phases.
                coefficients[m] = Complex::from(SQRT_2 * amplitude.copysign(cosine));
            }
        }
        coefficients
    }

    /// The last mode below the cut-off.
    fn modes(&self) -> usize {
        let modes = self.length / self.cut_off * (1.0 + ROUNDING);
        (modes as usize).min(self.points / 2)
    }

    /// The power of mode m over that of a mode below the roll-off.
    fn power(&self, m: usize) -> f64 {
        let ratio = m as f64 * self.roll_off / self.length;
        if ratio > 1.0 { libm::pow(ratio, -1.0 - 2.0 * self.hurst) } else { 1.0 }
    }
}

#[cfg(test)]
#[path = "self_affine_tests.rs"]
mod tests;
