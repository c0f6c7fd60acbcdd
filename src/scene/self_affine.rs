//! Random surfaces with a given power spectrum.

use std::f64::consts::{SQRT_2, TAU};

use nalgebra::Complex;

use super::HeightMap;
use crate::math::{FourierDirection, SplitMix64, fourier, fourier_2d};

/// A number of modes that is whole but for rounding is that number.
const WHOLE: f64 = 1.0e-9;

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
///
/// With `size_y` it is the middle line of an isotropic map with even points along y too, whose spectrum is constant up to
/// q_r, falls as |q|^(-2-2H) up to q_c and is 0 beyond:
///
/// h(x, y) = Σ a_mn cos(q·r + φ_mn),   φ_mn = 2π · a number of [`SplitMix64`], the one of the mode's own place in an
/// order in which the longest waves come first,
///
/// scaled to the root mean square height of the map. Waves of two points along x or y are left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SelfAffine {
    /// Period, m; along x.
    pub length: f64,
    /// Even intervals of a period.
    pub points: usize,
    /// Hurst exponent H, 1.
    pub hurst: f64,
    /// Root mean square height over one period, about a mean of 0, m.
    pub rms: f64,
    /// Wavelength above which the spectrum is constant, m.
    pub roll_off: f64,
    /// The shortest wavelength, m.
    pub cut_off: f64,
    /// Seed of the random phases.
    pub seed: u64,
    /// Period of an isotropic map along y, m; `None`: ridges across x.
    pub size_y: Option<f64>,
}

impl SelfAffine {
    /// The heights at the points of one period, m.
    pub(super) fn heights(&self) -> Vec<f64> {
        let sums = fourier(&self.coefficients(), FourierDirection::Backward);
        self.scaled(sums.iter().map(|sum| sum.re).collect())
    }

    /// Even lines of the map, as far apart as its points but for a whole number of them.
    pub(super) fn lines(&self, size_y: f64) -> usize {
        ((size_y / self.length * self.points as f64).round() as usize).max(1)
    }

    pub(super) fn map(&self, size_y: f64) -> HeightMap {
        let (nx, ny) = (self.points, self.lines(size_y));
        let mut sums = vec![Complex::from(0.0); nx * ny];
        for ([m, n], power) in self.modes_of_map(size_y) {
            let (sine, cosine) = libm::sincos(TAU * SplitMix64::at(self.seed, place(m, n)).unit());
            let value = Complex::new(cosine, sine) * power.sqrt();
            let at = |m: i64, n: i64| n.rem_euclid(ny as i64) as usize * nx + m.rem_euclid(nx as i64) as usize;
            sums[at(m, n)] = value;
            sums[at(-m, -n)] = value.conj();
        }
        fourier_2d(&mut sums, nx, FourierDirection::Backward);
        let heights = self.scaled(sums.iter().map(|sum| sum.re).collect());
        HeightMap::new(nx, [self.length / nx as f64, size_y / ny as f64], heights)
    }

    /// The modes m along x and n along y of the map, one of each pair of opposite ones, and their power over that of a mode
    /// below the roll-off.
    fn modes_of_map(&self, size_y: f64) -> impl Iterator<Item = ([i64; 2], f64)> {
        let [most_m, most_n] = [self.points, self.lines(size_y)].map(|count| (count as i64 - 1) / 2);
        let half = (0..=most_m).flat_map(move |m| (-most_n..=most_n).map(move |n| [m, n]));
        half.filter(|&[m, n]| m > 0 || n > 0).filter_map(move |[m, n]| {
            let (along_x, along_y) = (m as f64 / self.length, n as f64 / size_y);
            let ratio = (along_x * along_x + along_y * along_y).sqrt();
            let fallen = ratio * self.roll_off;
            let power = if fallen > 1.0 { libm::pow(fallen, -2.0 - 2.0 * self.hurst) } else { 1.0 };
            (ratio * self.cut_off <= 1.0 + WHOLE).then_some(([m, n], power))
        })
    }

    /// Heights about their mean, scaled to the root mean square height.
    fn scaled(&self, mut z: Vec<f64>) -> Vec<f64> {
        let count = z.len() as f64;
        let mean = z.iter().sum::<f64>() / count;
        z.iter_mut().for_each(|z| *z -= mean);
        let scale = self.rms / (z.iter().map(|z| z * z).sum::<f64>() / count).sqrt();
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
                // With two points a wavelength the phase is not resolved: the amplitude has the mean power of all
                // phases.
                coefficients[m] = Complex::from(SQRT_2 * amplitude.copysign(cosine));
            }
        }
        coefficients
    }

    /// The last mode below the cut-off.
    fn modes(&self) -> usize {
        let modes = self.length / self.cut_off * (1.0 + WHOLE);
        (modes as usize).min(self.points / 2)
    }

    /// The spectrum below the roll-off: of a profile C1, m³; of a map C, m⁴.
    pub(super) fn plateau(&self) -> f64 {
        if let Some(size_y) = self.size_y {
            let powers = 2.0 * self.modes_of_map(size_y).map(|(_, power)| power).sum::<f64>();
            return self.rms * self.rms / powers / (TAU / self.length) / (TAU / size_y);
        }
        let powers: f64 = (1..=self.modes()).map(|m| self.power(m)).sum();
        self.rms * self.rms / powers / (TAU / self.length)
    }

    /// The power of mode m over that of a mode below the roll-off.
    fn power(&self, m: usize) -> f64 {
        let ratio = m as f64 * self.roll_off / self.length;
        if ratio > 1.0 { libm::pow(ratio, -1.0 - 2.0 * self.hurst) } else { 1.0 }
    }
}

/// The place of a mode in a fixed order, whatever the other modes are: by the larger of both numbers.
fn place(m: i64, n: i64) -> u64 {
    let shell = m.max(n.abs());
    // As many modes lie within; on the shell n rises at m = shell, then m falls at n = shell and rises at n = -shell.
    let within = 2 * shell * (shell - 1);
    let on_shell = if m == shell {
        n + shell
    } else if n > 0 {
        2 * shell + 1 + m
    } else {
        3 * shell + m
    };
    (within + on_shell).unsigned_abs()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    const ROUGH: SelfAffine = SelfAffine {
        length: 0.1,
        points: 4000,
        hurst: 0.8,
        rms: 2e-5,
        roll_off: 5e-3,
        cut_off: 1e-4,
        seed: 7,
        size_y: None,
    };

    /// The mean square heights of the modes, from the heights at the points.
    fn powers(profile: &SelfAffine) -> Vec<f64> {
        let heights: Vec<_> = profile.heights().into_iter().map(Complex::from).collect();
        let n = profile.points as f64;
        let sums = fourier(&heights, FourierDirection::Forward);
        let power = |m: usize| if 2 * m == profile.points { 1.0 } else { 2.0 } * (sums[m] / n).norm_sqr();
        (0..=profile.points / 2).map(power).collect()
    }

    fn rms(heights: &[f64]) -> f64 {
        (heights.iter().map(|z| z * z).sum::<f64>() / heights.len() as f64).sqrt()
    }

    /// Every mode has the power that the spectrum says: 20 modes on the plateau, then as q^(-2.6) to mode 1000, none
    /// beyond.
    #[test]
    fn the_spectrum_is_what_was_asked() {
        let powers = powers(&ROUGH);
        let formula = |m: usize| match m {
            0 => 0.0,
            1..=20 => 1.0,
            21..=1000 => (m as f64 / 20.0).powf(-2.6),
            _ => 0.0,
        };
        let whole: f64 = (0..=2000).map(formula).sum();
        for (m, power) in powers.iter().enumerate() {
            let asked = 2e-5_f64.powi(2) * formula(m) / whole;
            // Roundings of a transform of 4000 heights, whose power is 4e-10.
            assert!((power - asked).abs() < 1e-12 * asked + 1e-34, "{m}: {power:e} for {asked:e}");
        }
    }

    /// The periodogram in bands, as an instrument's software would take it: within the 2 % that were asked for.
    #[test]
    fn bands_of_the_spectrum_have_their_power() {
        let powers = powers(&SelfAffine { points: 1 << 14, ..ROUGH });
        let band = |from: usize, to: usize| powers[from..to].iter().sum::<f64>() / (to - from) as f64;
        let plateau = band(1, 21);
        for (from, to) in [(40, 44), (100, 110), (400, 440), (900, 990)] {
            let middle = ((from * (to - 1)) as f64).sqrt();
            let asked = plateau * (middle / 20.0).powf(-2.6);
            assert!((band(from, to) / asked - 1.0).abs() < 0.02, "{from} to {to}");
        }
    }

    #[test]
    fn the_heights_have_their_root_mean_square_about_0_and_the_ends_meet() {
        for points in [2000, 2001, 4096, 7919] {
            let surface = SelfAffine { points, ..ROUGH }.surface(None);
            assert_eq!((surface.x().len(), surface.x()[0], surface.x()[points]), (points + 1, 0.0, 0.1));
            assert!(surface.is_periodic() && surface.z()[0] == surface.z()[points]);
            let heights = &surface.z()[..points];
            // Roundings of sums of some thousand heights.
            assert!((rms(heights) / 2e-5 - 1.0).abs() < 1e-13, "{points}");
            assert!((heights.iter().sum::<f64>() / points as f64).abs() < 1e-18, "{points}");
        }
    }

    /// The slope of the spline through 10 points a shortest wavelength is that of the sum of cosines.
    #[test]
    fn the_slope_is_that_of_the_spectrum() {
        let profile = SelfAffine { points: 10_000, ..ROUGH };
        let (powers, q) = (powers(&profile), |m: usize| TAU * m as f64 / 0.1);
        let formula = powers.iter().enumerate().map(|(m, power)| power * q(m) * q(m)).sum::<f64>().sqrt();
        let surface = profile.surface(None);
        let spline = surface.spline();
        let slopes: Vec<f64> = (0..40_000).map(|i| spline.evaluate(0.1 * i as f64 / 40_000.0).1).collect();
        // A cubic spline is wrong by (q h)⁴/120, that is 1e-3, at the shortest wavelength.
        assert!((rms(&slopes) / formula - 1.0).abs() < 1e-3, "{} {formula}", rms(&slopes));
    }

    /// More points are the same profile; a seed is a profile.
    #[test]
    fn a_seed_is_one_profile() {
        let coarse = ROUGH.heights();
        let fine = SelfAffine { points: 12_000, ..ROUGH }.heights();
        let largest = coarse.iter().zip(fine.iter().step_by(3)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        // Roundings of sums of 1000 cosines.
        assert!(largest < 1e-17, "{largest}");
        let other = SelfAffine { seed: 8, ..ROUGH }.heights();
        let alike: f64 = coarse.iter().zip(&other).map(|(a, b)| a * b).sum::<f64>() / (4000.0 * 4e-10);
        // Of two profiles with independent phases; with 20 modes of most power 0.2 would be usual.
        assert!(alike.abs() < 0.7, "{alike}");
    }

    /// Two points a wavelength are enough.
    #[test]
    fn the_cut_off_may_lie_where_two_points_see_it() {
        for points in [2000, 2001] {
            let profile = SelfAffine { points, ..ROUGH };
            assert_eq!(profile.modes(), 1000);
            let powers = powers(&profile);
            let asked = powers[500] * 2_f64.powf(-2.6);
            assert!((powers[1000] / asked - 1.0).abs() < 1e-10, "{points}");
        }
    }

    /// The bits of a few heights and of their sum, as they come out on every platform.
    ///
    /// The values are those of a program of its own in Python, which sums the cosines one by one with 40 digits: this
    /// one is right to its last digits, and the bits say that the next platform, compiler or change gives the same.
    #[test]
    fn a_seed_gives_the_same_bits_everywhere() {
        let profile = SelfAffine { points: 300, length: 0.03, roll_off: 1e-2, cut_off: 3e-4, ..ROUGH };
        let heights = profile.heights();
        for (i, value) in PYTHON {
            // Roundings of a transform of 300 values of size 2e-5.
            assert!((heights[i] - value).abs() < 3e-20, "{i}: {:e} for {value:e}", heights[i]);
        }
        let digest = heights.iter().fold(0_u64, |digest, z| digest.rotate_left(5) ^ z.to_bits());
        assert_eq!(digest, DIGEST, "{digest:#x}");
    }

    const PYTHON: [(usize, f64); 4] = [
        (0, -5.518007025855965e-07),
        (1, -1.9030598303507189e-06),
        (150, 6.461100995468687e-06),
        (299, 1.2072049374252627e-06),
    ];
    const DIGEST: u64 = 0x4ab4_bc22_f39d_1d48;

    const MAP: SelfAffine = SelfAffine {
        length: 4e-3,
        points: 96,
        hurst: 0.8,
        rms: 1e-5,
        roll_off: 1e-3,
        cut_off: 1.6e-4,
        seed: 3,
        size_y: Some(3e-3),
    };

    /// C (m⁴) of all modes: constant to the roll-off, then falling by |q|^-3.6, none beyond the cut-off; and the height.
    #[test]
    fn the_spectrum_of_a_map_is_isotropic() {
        let surface = MAP.surface(None);
        let map = surface.map().unwrap();
        assert_eq!((map.nx(), map.ny(), surface.x().len()), (96, 72, 97));
        assert!((map.rms_height() / 1e-5 - 1.0).abs() < 1e-12 && map.mean().abs() < 1e-18);
        for (at, density) in map.power_density(true).into_iter().enumerate().skip(1) {
            let [q_x, q_y] = map.wave_numbers(at);
            let waves = q_x.hypot(q_y) / TAU;
            let law = if waves > 1.0 / 1e-3 { (waves * 1e-3).powf(-3.6) } else { 1.0 };
            let asked = if waves * 1.6e-4 <= 1.0 + 1e-9 { MAP.plateau() * law } else { 0.0 };
            // Roundings of a transform of 7000 heights.
            assert!((density - asked).abs() < 1e-10 * asked + 1e-16 * MAP.plateau(), "{at}: {density:e} {asked:e}");
        }
    }

    /// More points are the same map, a shorter cut-off leaves the phases of the others, and a line is one of the map's.
    #[test]
    fn a_seed_is_one_map() {
        let (coarse, fine) = (MAP.map(3e-3), SelfAffine { points: 192, ..MAP }.map(3e-3));
        let finer_line = fine.line(2 * 5).iter().step_by(2);
        let largest = coarse.line(5).iter().zip(finer_line).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(largest < 1e-17, "{largest:e}");
        let rougher = SelfAffine { points: 192, cut_off: 8e-5, ..MAP }.map(3e-3);
        let alike: f64 = fine.heights().iter().zip(rougher.heights()).map(|(a, b)| a * b).sum();
        assert!(alike / (192.0 * 144.0 * 1e-10) > 0.98);
        let line = MAP.surface(Some(7));
        assert_eq!(line.z()[..96], *line.map().unwrap().line(6));
        assert!(line.is_periodic() && line.z()[96] == line.z()[0]);
    }

    #[test]
    fn places_of_modes_are_counted_one_by_one() {
        let mut places: Vec<_> = (0..=9)
            .flat_map(|m| (-9..=9).map(move |n| (m, n)))
            .filter(|&(m, n)| m > 0 || n > 0)
            .map(|(m, n)| place(m, n))
            .collect();
        places.sort_unstable();
        assert!(places.iter().enumerate().all(|(i, place)| *place == i as u64), "{places:?}");
    }

    /// The bits of a map, as they come out on every platform; some heights are those of a program of its own in Python,
    /// which sums the cosines one by one.
    #[test]
    fn a_seed_of_a_map_gives_the_same_bits_everywhere() {
        let map = MAP.map(3e-3);
        for (i, value) in PYTHON_MAP {
            // Roundings of a transform of 7000 values of size 1e-5.
            assert!((map.heights()[i] - value).abs() < 1e-19, "{i}: {:e} for {value:e}", map.heights()[i]);
        }
        let digest = map.heights().iter().fold(0_u64, |digest, z| digest.rotate_left(5) ^ z.to_bits());
        assert_eq!(digest, MAP_DIGEST, "{digest:#x}");
    }

    const PYTHON_MAP: [(usize, f64); 5] = [
        (0, -2.4090344718280403e-06),
        (1, -4.590303346049518e-06),
        (96, -2.0888491532401924e-06),
        (3218, -1.2263526304216354e-05),
        (6911, -2.255960381547141e-06),
    ];
    const MAP_DIGEST: u64 = 0x7e2d_2449_cc21_883f;
}
