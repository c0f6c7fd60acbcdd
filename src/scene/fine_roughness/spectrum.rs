//! The power spectrum C(q) of an isotropic rough surface, ⟨h²⟩ = 2π ∫ q C dq; and a measured line parted in two: the
//! profile, and the spectrum of the waves that are finer.

use std::f64::consts::{LN_2, LN_10, PI, TAU};

use serde::Serialize;

use crate::scene::{HeightMap, Spectrum, SpectrumBand, Surface};

/// C at some wave numbers; ln C is linear in ln q between them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RoughnessSpectrum {
    /// q (rad/m), strictly rising, and C (m⁴), positive; at least two.
    points: Vec<[f64; 2]>,
    /// How it goes on above the last wave number; `None`: along the last two points.
    tail: Option<PowerTail>,
}

/// A power law above a wave number.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct PowerTail {
    /// ln q and ln C of a point of the law.
    pub(super) point: [f64; 2],
    /// d ln C/d ln q.
    pub(super) exponent: f64,
}

/// Half of the range in ln q from which the local Hurst exponent is taken: half a decade.
const HALF_RANGE: f64 = 0.5 * LN_10;
/// A distance in ln q that is that range but for rounding belongs to it.
const ROUNDING: f64 = 1e-9;
/// Between these the Hurst exponent of a self-affine surface lies.
const HURST: (f64, f64) = (0.05, 1.0);
/// A spectrum covers a wave number but for this part of it: wavelengths are given with some digits.
const COVERED: f64 = 1e-5;

impl RoughnessSpectrum {
    /// The spectrum through points of q (rad/m), strictly rising, and C (m⁴), positive: at least two.
    pub(in crate::scene) fn new(points: Vec<[f64; 2]>) -> Self {
        Self { points, tail: None }
    }

    /// Of the isotropic surface whose lines have the one-sided spectrum C1 (m³), ⟨h²⟩ = ∫ C1 dq, at these q (rad/m).
    ///
    /// C = (C1/q) Γ(1+H)/(2√π Γ(½+H)), exact where C1 ∝ q^-(1+2H). H is that of the least squares line of ln C1 over
    /// half a decade to either side.
    pub fn of_lines(lines: &[[f64; 2]]) -> Self {
        let logarithms = logarithms(lines);
        let point = |i: usize| {
            let [q, of_lines] = lines[i];
            let (low, high) = (logarithms[i][0] - HALF_RANGE - ROUNDING, logarithms[i][0] + HALF_RANGE + ROUNDING);
            let first = logarithms.partition_point(|point| point[0] < low).min(i.saturating_sub(1));
            let end = logarithms.partition_point(|point| point[0] <= high).max((i + 2).min(lines.len()));
            let exponent = line(&logarithms[first..end]).exponent;
            let hurst = (-0.5 * (1.0 + exponent)).clamp(HURST.0, HURST.1);
            [q, isotropic(q, of_lines, hurst)]
        };
        Self::new((0..lines.len()).map(point).collect())
    }

    /// This spectrum, which goes on above its last wave number.
    pub(super) fn with_tail(self, tail: PowerTail) -> Self {
        Self { tail: Some(tail), ..self }
    }

    /// q (rad/m), rising, and C (m⁴).
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// The longest and the shortest wavelength that the points cover, m.
    pub fn wavelengths(&self) -> [f64; 2] {
        [self.points[0][0], self.points[self.points.len() - 1][0]].map(|q| TAU / q)
    }

    /// Whether it covers the wavelengths between these two (m), but for rounded digits.
    pub(super) fn covers(&self, longest: f64, shortest: f64) -> bool {
        let [own_longest, own_shortest] = self.wavelengths();
        longest <= own_longest * (1.0 + COVERED) && shortest >= own_shortest * (1.0 - COVERED)
    }

    /// d ln C/d ln q of the law by which it goes on above its last wave number, if it does.
    pub(super) fn tail_exponent(&self) -> Option<f64> {
        self.tail.map(|tail| tail.exponent)
    }

    /// C at q (rad/m), m⁴.
    pub fn density(&self, q: f64) -> f64 {
        let (x, last) = (q.ln(), self.points.len() - 1);
        if let Some(tail) = self.tail.filter(|_| q > self.points[last][0]) {
            return tail.at(x).exp();
        }
        let i = self.points.partition_point(|point| point[0] <= q).clamp(1, last);
        let [[x0, y0], [x1, y1]] = [self.points[i - 1], self.points[i]].map(|point| point.map(f64::ln));
        (y0 + (y1 - y0) * (x - x0) / (x1 - x0)).exp()
    }

    /// The root mean square height of the waves between its first and last wave number, m.
    pub fn rms_height(&self) -> f64 {
        self.integral(2).sqrt()
    }

    /// Their root mean square gradient, 1.
    pub fn rms_gradient(&self) -> f64 {
        self.integral(4).sqrt()
    }

    /// 2π ∫ q^`power` C d ln q, each interval a power law.
    fn integral(&self, power: i32) -> f64 {
        let of_interval = |ends: &[[f64; 2]]| {
            let [before, after] = [ends[0], ends[1]].map(|[q, density]| TAU * q.powi(power) * density);
            logarithmic_mean(before, after) * (ends[1][0] / ends[0][0]).ln()
        };
        self.points.windows(2).map(of_interval).sum()
    }
}

impl Spectrum {
    /// The spectrum of the isotropic surface that has such lines, from means over bands; `None` of a line of fewer than
    /// two.
    pub(super) fn isotropic(&self) -> Option<RoughnessSpectrum> {
        // Where there are no waves the spectrum is that of rounding, or 0, which has no logarithm.
        let point = |band: &SpectrumBand| [band.wave_number, band.density.max(f64::MIN_POSITIVE)];
        let lines: Vec<[f64; 2]> = self.bands().iter().map(point).collect();
        (lines.len() > 1).then(|| RoughnessSpectrum::of_lines(&lines))
    }
}

impl PowerTail {
    fn at(&self, log_q: f64) -> f64 {
        self.point[1] + self.exponent * (log_q - self.point[0])
    }

    /// The least squares line through the points of q and C of the last decade of `points`.
    pub(super) fn of_last_decade(points: &[[f64; 2]]) -> Self {
        let logarithms = logarithms(points);
        let last = logarithms[logarithms.len() - 1][0];
        let first = logarithms.partition_point(|point| point[0] < last - LN_10 - ROUNDING);
        line(&logarithms[first.min(logarithms.len() - 2)..])
    }
}

/// C (m⁴) of the isotropic surface whose lines have the spectrum C1 (m³) ∝ q^-(1+2H): (C1/q) Γ(1+H)/(2√π Γ(½+H)).
pub(super) fn isotropic(q: f64, of_lines: f64, hurst: f64) -> f64 {
    let ratio = (libm::lgamma(1.0 + hurst) - libm::lgamma(0.5 + hurst)).exp();
    of_lines / q * ratio / (2.0 * PI.sqrt())
}

fn logarithms(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    points.iter().map(|point| point.map(f64::ln)).collect()
}

/// The least squares line through at least two points.
fn line(points: &[[f64; 2]]) -> PowerTail {
    let mean = |k: usize| points.iter().map(|point| point[k]).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(0), mean(1));
    let variance: f64 = points.iter().map(|point| (point[0] - x).powi(2)).sum();
    let covariance: f64 = points.iter().map(|point| (point[0] - x) * (point[1] - y)).sum();
    PowerTail { point: [x, y], exponent: covariance / variance }
}

/// The mean over ln x of a power law with these values at its ends.
pub(super) fn logarithmic_mean(a: f64, b: f64) -> f64 {
    /// Below, the mean of both is as exact.
    const EQUAL: f64 = 1e-6;
    let ratio = (b / a).ln();
    if ratio.abs() < EQUAL { 0.5 * (a + b) } else { (b - a) / ratio }
}

impl HeightMap {
    /// The isotropic power spectrum: the mean of C over rings of wave numbers that are even in the logarithm; `None` where
    /// fewer than two have any power.
    pub fn spectrum(&self, periodic: bool) -> Option<RoughnessSpectrum> {
        /// Rings of a decade.
        const RINGS: f64 = 12.0;
        let extent = self.spacing()[0] * self.nx() as f64;
        let longest = extent.min(self.spacing()[1] * self.ny() as f64);
        let nyquist = PI / self.spacing()[0].max(self.spacing()[1]);
        // Under a window the longest waves are not reliable.
        let first = TAU / longest * if periodic { 1.0 } else { 2.0 } * (1.0 - 1e-9);
        let count = ((nyquist / first).log10() * RINGS).ceil().max(0.0) as usize;
        // By ring: how many, Σ ln q, Σ C.
        let mut rings = vec![(0_usize, 0.0, 0.0); count + 1];
        for (at, density) in self.power_density(periodic).into_iter().enumerate() {
            let [q_x, q_y] = self.wave_numbers(at);
            let q = q_x.hypot(q_y);
            if (first..nyquist).contains(&q) {
                let (number, logarithms, sum) = &mut rings[((q / first).log10() * RINGS) as usize];
                (*number, *logarithms, *sum) = (*number + 1, *logarithms + q.ln(), *sum + density);
            }
        }
        let mean = |(number, logarithms, sum): (usize, f64, f64)| {
            let number = number as f64;
            [(logarithms / number).exp(), sum / number]
        };
        let largest = rings.iter().map(|ring| mean(*ring)[1]).fold(0.0, f64::max);
        // Beyond a cut-off there are rounding errors alone.
        let seen: Vec<_> = rings.into_iter().map(mean).filter(|[_, density]| *density > 1e-16 * largest).collect();
        (seen.len() > 1).then(|| RoughnessSpectrum::new(seen))
    }
}

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
const STEP_ROUNDING: f64 = 1e-9;

impl Surface {
    /// Splits the line at a wavelength `split` (m) by the filter of [`smoothed`](Self::smoothed).
    ///
    /// # Errors
    /// [`SplitError`] where the line is too short or too coarse for that.
    pub fn split(&self, split: f64) -> Result<SplitSurface, SplitError> {
        let x = self.x();
        let length = x[x.len() - 1] - x[0];
        let step = length / (x.len() - 1) as f64;
        if split > length / LENGTHS * (1.0 + STEP_ROUNDING) {
            return Err(SplitError::TooLong(length / LENGTHS));
        }
        if split < STEPS * step * (1.0 - STEP_ROUNDING) {
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

    /// C ∝ q^-2(1+H) and C1 ∝ q^-(1+2H) of the same surface.
    fn law(hurst: f64) -> (RoughnessSpectrum, Vec<[f64; 2]>) {
        let q = |i: u32| 1e3 * 10_f64.powf(f64::from(i) / 7.0);
        let of_lines: Vec<[f64; 2]> = (0..=21).map(|i| [q(i), 1e-3 * q(i).powf(-1.0 - 2.0 * hurst)]).collect();
        let points = of_lines.iter().map(|&[q, of_lines]| [q, isotropic(q, of_lines, hurst)]).collect();
        (RoughnessSpectrum::new(points), of_lines)
    }

    /// A power law is exact everywhere, but for rounding.
    #[test]
    fn lines_of_a_self_affine_surface_give_its_spectrum() {
        for hurst in [0.05, 0.5, 0.8, 1.0] {
            let (surface, lines) = law(hurst);
            let found = RoughnessSpectrum::of_lines(&lines);
            for q in [1e3, 1.234e3, 4.4e4, 9.9e5, 1e6] {
                assert!((found.density(q) / surface.density(q) - 1.0).abs() < 1e-9, "{hurst} {q}");
                let exact = isotropic(q, 1e-3 * q.powf(-1.0 - 2.0 * hurst), hurst);
                assert!((surface.density(q) / exact - 1.0).abs() < 1e-9, "{hurst} {q}");
            }
        }
    }

    /// A line along x has what all waves of the surface with the same q_x have: C1(q) = 4 ∫_q^∞ k C dk/√(k² - q²).
    #[test]
    fn the_ratio_is_that_of_abels_transform() {
        let hurst = 0.7_f64;
        let (q, density) = (2.0_f64, |k: f64| k.powf(-2.0 - 2.0 * hurst));
        // k = q cosh t takes the singularity away; by the rule of middles, in steps of 1e-4 up to t = 20.
        let of_lines: f64 = (0..200_000)
            .map(|i| {
                let t = 1e-4 * (f64::from(i) + 0.5);
                4e-4 * q * t.cosh() * density(q * t.cosh())
            })
            .sum();
        assert!((isotropic(q, of_lines, hurst) / density(q) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn the_limits_of_the_exponent_hold() {
        let steep = [[1.0, 1.0], [10.0, 1e-9]];
        let flat = [[1.0, 1.0], [10.0, 1.0]];
        for (lines, hurst) in [(steep, 1.0), (flat, 0.05)] {
            let found = RoughnessSpectrum::of_lines(&lines);
            assert_eq!(found.points()[0][1], isotropic(1.0, 1.0, hurst));
        }
    }

    /// ⟨h²⟩ = 2π ∫ q C dq and the square of the gradient, of C = a q^-3.6 in closed form.
    #[test]
    fn height_and_gradient_are_integrals() {
        let (spectrum, _) = law(0.8);
        let a = spectrum.density(1.0);
        let moment = |power: f64| TAU * a * (1e6_f64.powf(power) - 1e3_f64.powf(power)) / power;
        assert!((spectrum.rms_height().powi(2) / moment(-1.6) - 1.0).abs() < 1e-9);
        assert!((spectrum.rms_gradient().powi(2) / moment(0.4) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn the_tail_is_the_law_of_the_last_decade() {
        let (spectrum, _) = law(0.6);
        let tail = PowerTail::of_last_decade(spectrum.points());
        let whole = spectrum.clone().with_tail(tail);
        assert!((whole.density(1e8) / spectrum.density(1e8) - 1.0).abs() < 1e-9);
        assert!((tail.exponent + 3.2).abs() < 1e-9);
    }

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
