//! A measured line parted in two: the profile, and the spectrum of the waves that are finer.

use std::f64::consts::{LN_2, TAU};

use super::RoughnessSpectrum;
use super::spectrum::PowerTail;
use crate::scene::{Spectrum, Surface};

/// A measured line as a profile and the spectrum of the waves that it then lacks.
#[derive(Clone, Debug, PartialEq)]
pub struct SplitSurface {
    /// The line without the finer waves.
    pub profile: Surface,
    /// C (1 - G²) of the isotropic surface that has such lines, G being the filter's transmission: from where that is 5
    /// % of C down to twice the line's step; the law of the last decade of C beyond.
    pub finer: RoughnessSpectrum,
}

/// Why a line cannot be split at a wavelength: what is expected.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SplitError {
    /// The line is too short; the longest wavelength, m.
    #[error("at most {0:?} m, a quarter of the line")]
    TooLong(f64),
    /// The line is too coarse; the shortest wavelength, m.
    #[error("at least {0:?} m, four steps of the line")]
    TooShort(f64),
    /// It has no spectrum.
    #[error("a line of more points")]
    TooFewPoints,
}

/// The finer waves begin where this part of their power is taken from the profile.
const LEAST_SHARE: f64 = 0.05;
/// A line must be this many times as long as where it is split.
const LENGTHS: f64 = 4.0;
/// A split is at least this many steps long.
const STEPS: f64 = 4.0;
/// Both but for this part: steps are differences of rounded numbers.
const ROUNDING: f64 = 1e-9;

impl Surface {
    /// Splits the line at a wavelength `split` (m) by the filter of [`smoothed`](Self::smoothed).
    ///
    /// # Errors
    /// [`SplitError`] where the line is too short or too coarse for that.
    pub fn split(&self, split: f64) -> Result<SplitSurface, SplitError> {
        let x = self.x();
        let length = x[x.len() - 1] - x[0];
        let step = length / (x.len() - 1) as f64;
        if split > length / LENGTHS * (1.0 + ROUNDING) {
            return Err(SplitError::TooLong(length / LENGTHS));
        }
        if split < STEPS * step * (1.0 - ROUNDING) {
            return Err(SplitError::TooShort(STEPS * step));
        }
        let whole = Spectrum::new(self).isotropic().ok_or(SplitError::TooFewPoints)?;
        Ok(SplitSurface { profile: self.smoothed(split), finer: whole.finer_than(split, 2.0 * step) })
    }
}

impl RoughnessSpectrum {
    /// C (1 - G²) of the filter that halves waves of the length `split` (m), down to the `resolution` (m).
    fn finer_than(&self, split: f64, resolution: f64) -> Self {
        let tail = PowerTail::of_last_decade(self.points());
        let whole = self.clone().with_tail(tail);
        // G = exp(-ln 2 (q split/2π)²).
        let fallen = |q: f64| -(-2.0 * LN_2 * (q * split / TAU).powi(2)).exp_m1();
        let least = TAU / split * (-(1.0 - LEAST_SHARE).ln() / (2.0 * LN_2)).sqrt();
        let (first, last) = (least.max(self.points()[0][0]), TAU / resolution);
        let between = self.points().iter().map(|point| point[0]).filter(|q| first < *q && *q < last);
        let point = |q: f64| [q, whole.density(q) * fallen(q)];
        Self::new([first].into_iter().chain(between).chain([last]).map(point).collect()).with_tail(tail)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SelfAffine;
    use crate::scene::fine_roughness::spectrum::isotropic;

    const ROUGH: SelfAffine = SelfAffine {
        length: 0.1,
        points: 10_000,
        hurst: 0.8,
        rms: 2e-5,
        roll_off: 5e-3,
        cut_off: 2e-5,
        seed: 7,
        size_y: None,
    };

    /// Of a self-affine line, every mode of which has the power of its law: C (1 - G²), within the means over bands of
    /// a twelfth of a decade; beyond the resolution the law goes on.
    #[test]
    fn the_finer_waves_of_a_self_affine_line_have_their_law() {
        let line = ROUGH.surface(None);
        let SplitSurface { profile, finer } = line.split(1e-3).unwrap_or_else(|error| unreachable!("{error}"));
        assert_eq!(profile, line.smoothed(1e-3));
        let law = |q: f64| isotropic(q, ROUGH.plateau() * (q * ROUGH.roll_off / TAU).powf(-2.6), 0.8);
        for (wavelength, share) in
            [(1e-3, 0.75), (5e-4, 1.0 - 0.5_f64.powi(8)), (1e-4, 1.0), (2.5e-5, 1.0), (5e-6, 1.0)]
        {
            let q = TAU / wavelength;
            let ratio = finer.density(q) / (law(q) * share);
            assert!((ratio - 1.0).abs() < 0.03, "{wavelength}: {ratio}");
        }
        let [longest, shortest] = finer.wavelengths();
        // (λ_split/λ)² = -ln 0.95/(2 ln 2).
        assert!(
            (longest / 5.198_73e-3 - 1.0).abs() < 1e-5 && (shortest / 2e-5 - 1.0).abs() < 1e-9,
            "{longest} {shortest}"
        );
    }

    /// Under a window: the gradient of a line that is not repeated, within the chance of its bands.
    #[test]
    fn the_finer_waves_of_a_line_with_ends_have_its_gradient() {
        let whole = ROUGH.surface(None);
        let line = Surface::new(whole.x().to_vec(), whole.z().to_vec(), false);
        let finer = |line: &Surface| line.split(1e-3).map(|split| split.finer.rms_gradient()).unwrap_or_default();
        assert!((finer(&line) / finer(&whole) - 1.0).abs() < 0.02, "{} {}", finer(&line), finer(&whole));
    }

    #[test]
    fn a_split_fits_the_line() {
        let line = ROUGH.surface(None);
        let refused = |at: f64| line.split(at).map_or_else(|error| error.to_string(), |_| String::new());
        assert_eq!(refused(0.0251), "at most 0.025 m, a quarter of the line");
        let coarse = refused(3.9e-5);
        assert!(coarse.starts_with("at least 4") && coarse.ends_with(" m, four steps of the line"), "{coarse}");
        assert!(line.split(0.025).is_ok() && line.split(4e-5).is_ok());
        // A level line has no finer waves.
        let level = Surface::new((0..100).map(f64::from).collect(), vec![0.0; 100], false);
        assert!(level.split(10.0).is_ok_and(|split| split.finer.rms_gradient() < 1e-100));
    }
}
