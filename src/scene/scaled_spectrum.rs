//! A surface whose spectrum is denser or thinner than that of the scene: profile, map and bands alike.

use std::f64::consts::TAU;

use nalgebra::Complex;

use crate::math::{FourierDirection, fourier, fourier_2d};
use crate::scene::error::{ParameterError, Problem};
use crate::scene::{FineWaves, HeightMap, Scene, Spectrum, SpectrumFactors, Surface, decade_of};

impl Scene {
    /// The decades of wavelengths that profile and bands have; none of a flat surface.
    pub fn spectrum_decades(&self) -> Vec<i32> {
        let x = self.surface.x();
        let profile = (!self.surface.is_level()).then(|| {
            let length = x[x.len() - 1] - x[0];
            let shortest = Spectrum::new(&self.surface).shortest_wavelength();
            [length, shortest.unwrap_or(2.0 * length / (x.len() - 1) as f64)]
        });
        let bands = self.fine_bands();
        let ends = bands.first().zip(bands.last());
        let bands = ends.map(|(first, last)| [first, last].map(|band| TAU / band.wave_number));
        let all: Vec<f64> = profile.into_iter().chain(bands).flatten().collect();
        let Some(longest) = all.iter().copied().reduce(f64::max) else { return Vec::new() };
        let shortest = all.iter().copied().fold(longest, f64::min);
        (decade_of(shortest)..=decade_of(longest)).collect()
    }

    /// The scene with a spectrum of the surface that is so many times as dense.
    ///
    /// # Errors
    /// Where its slopes are too steep to work with, or contacts that flatten by a given modulus have no wavelengths.
    pub fn with_spectrum(mut self, factors: SpectrumFactors) -> Result<Self, ParameterError> {
        let refused = |expected: String| {
            ParameterError::new("surface.spectrum", Problem::value(format_args!("{factors:?}"), expected))
        };
        if let Some(fine) = &mut self.fine {
            match (&mut fine.waves, &factors) {
                (FineWaves::Modulus { rms_slope, .. }, SpectrumFactors::Whole(factor)) => *rms_slope *= factor.sqrt(),
                (FineWaves::Modulus { .. }, _) => return Err(refused("one factor beside surface.fine.modulus".into())),
                _ => fine.factors = Some(factors.clone()),
            }
        }
        if !self.surface.is_level() {
            self.surface = scaled(&self.surface, &factors);
            self.surface.check_slopes().map_err(|expected| refused(expected.to_string()))?;
        }
        self.refit();
        Ok(self)
    }
}

/// The surface with its waves as high as their densities say.
fn scaled(surface: &Surface, factors: &SpectrumFactors) -> Surface {
    let law = surface.self_affine();
    let with_law = |found: Surface| if let Some(law) = law { found.with_self_affine(law) } else { found };
    let of_map = surface.map().filter(|_| surface.is_periodic()).and_then(|map| {
        let heights = &surface.z()[..map.nx()];
        let line = (0..map.ny()).find(|&line| map.line(line) == heights)?;
        let map = scaled_map(map, factors);
        Some(map.profile(line, true).with_map(Some(Ok(map))))
    });
    with_law(
        of_map.unwrap_or_else(|| {
            Surface::new(surface.x().to_vec(), scaled_heights(surface, factors), surface.is_periodic())
        }),
    )
}

fn scaled_map(map: &HeightMap, factors: &SpectrumFactors) -> HeightMap {
    let (nx, count) = (map.nx(), map.heights().len());
    let mut sums: Vec<Complex<f64>> = map.heights().iter().map(|z| Complex::from(*z)).collect();
    fourier_2d(&mut sums, nx, FourierDirection::Forward);
    for (at, sum) in sums.iter_mut().enumerate() {
        let [along_x, along_y] = map.wave_numbers(at);
        *sum *= if at == 0 { 0.0 } else { factors.of_height(TAU / along_x.hypot(along_y)) / count as f64 };
    }
    fourier_2d(&mut sums, nx, FourierDirection::Backward);
    let heights = map.heights().iter().zip(&sums).map(|(z, change)| z + change.re).collect();
    HeightMap::new(nx, map.spacing(), heights)
}

/// Heights of a profile, m: of a periodic one about its mean, of any other about its mean line and with its mirror image as
/// one period.
fn scaled_heights(surface: &Surface, factors: &SpectrumFactors) -> Vec<f64> {
    let (x, z) = (surface.x(), surface.z());
    let line = surface.line();
    let level = |x: f64, z: f64| if surface.is_periodic() { z } else { z - line.at(x) };
    if let SpectrumFactors::Whole(factor) = factors {
        let middle = |x: f64| if surface.is_periodic() { line.z } else { line.at(x) };
        return x.iter().zip(z).map(|(x, z)| middle(*x) + factor.sqrt() * (z - middle(*x))).collect();
    }
    let (first, length, even) = (x[0], x[x.len() - 1] - x[0], even_steps(x));
    let place = |i: usize| first + length * (i as f64 / even as f64);
    let is_even = even == x.len() - 1;
    let height = |i: usize| if is_even { z[i] } else { surface.spline().evaluate(place(i)).0 };
    let mut heights: Vec<f64> = (0..=even).map(|i| level(place(i), height(i))).collect();
    let period = if surface.is_periodic() {
        heights.pop();
        length
    } else {
        heights.extend((1..even).rev().map(|i| level(place(i), height(i))));
        2.0 * length
    };
    let mut changes = changes(&heights, period, factors);
    changes.push(changes[0]);
    changes.truncate(even + 1);
    if is_even {
        return z.iter().zip(&changes).map(|(z, change)| z + change).collect();
    }
    let change = Surface::new((0..=even).map(place).collect(), changes, surface.is_periodic());
    let mut scaled: Vec<f64> = x.iter().zip(z).map(|(x, z)| z + change.spline().evaluate(*x).0).collect();
    if let (true, [first, .., last]) = (surface.is_periodic(), &mut scaled[..]) {
        *last = *first;
    }
    scaled
}

/// The steps of a profile where they are even; else four times as many even ones.
fn even_steps(x: &[f64]) -> usize {
    /// Steps that differ by this part of them are even.
    const EVEN: f64 = 1e-6;
    let count = x.len() - 1;
    let step = (x[count] - x[0]) / count as f64;
    if x.windows(2).all(|pair| (pair[1] - pair[0] - step).abs() <= EVEN * step) { count } else { 4 * count }
}

/// What the waves of even `heights` over a `period` (m) change by.
fn changes(heights: &[f64], period: f64, factors: &SpectrumFactors) -> Vec<f64> {
    let count = heights.len();
    let values: Vec<Complex<f64>> = heights.iter().map(|z| Complex::from(*z)).collect();
    let mut sums = fourier(&values, FourierDirection::Forward);
    for (m, sum) in sums.iter_mut().enumerate() {
        let mode = m.min(count - m);
        *sum *= if mode == 0 { 0.0 } else { factors.of_height(period / mode as f64) / count as f64 };
    }
    fourier(&sums, FourierDirection::Backward).iter().map(|sum| sum.re).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::in_tests::{assert_relative, assert_within};

    /// Two waves, of which one decade's is twice as high.
    fn two_waves(periodic: bool, place: impl Fn(usize) -> f64) -> (Surface, Surface) {
        let x: Vec<f64> = (0..=400).map(place).collect();
        let wave = |scale: f64| {
            x.iter().map(|x| (TAU * x / 0.02).cos() + scale * 0.1 * (TAU * x / 0.005).cos()).collect::<Vec<_>>()
        };
        let surface = |z: Vec<f64>| {
            let mut z = z;
            if periodic {
                z[400] = z[0];
            }
            Surface::new(x.clone(), z, periodic)
        };
        (surface(wave(1.0)), surface(wave(2.0)))
    }

    #[test]
    fn the_waves_of_a_decade_are_higher_and_no_others() {
        let factors = SpectrumFactors::Decades(vec![(-3, 4.0), (-2, 1.0), (-1, 9.0)]);
        let even = |i: usize| 0.02 * i as f64 / 400.0;
        let uneven = |i: usize| even(i) + 0.3e-4 * (TAU * even(i) / 0.02).sin();
        for (periodic, is_even, accuracy) in [(true, true, 1e-13), (false, true, 2e-2), (true, false, 1e-4)] {
            let (before, after) = if is_even { two_waves(periodic, even) } else { two_waves(periodic, uneven) };
            let found = scaled(&before, &factors);
            // A line that ends has its own tilt and mirror image: its long wave is that of the period but for these.
            for (found, wanted) in found.z().iter().zip(after.z()) {
                assert_within(*found, *wanted, accuracy);
            }
            assert!(!periodic || found.z()[0] == found.z()[400]);
        }
    }

    #[test]
    fn one_factor_scales_all_heights_and_bands() {
        let text = "name = 'rough'\nlayer = { foundation = 'half_space', masses = 32, spacing = 1e-4, width = 1e-2 }\n\
                    material = { density = 1e3, poisson_ratio = 0.5, equilibrium_modulus = 1e6, prony = [] }\n\
                    friction = { rate_shear = { strength = 1e6, reference_speed = 1.0, sharpness = 0.1 } }\n\
                    [surface]\nkind = 'self_affine'\nlength = 0.1\npoints = 2000\nhurst = 0.8\nrms = 2e-5\n\
                    roll_off_wavelength = 5e-3\ncut_off_wavelength = 1e-4\nseed = 7\nfine = { shortest = 2e-6 }";
        let scene = Scene::parse(text, "rough.toml".as_ref()).unwrap();
        assert_eq!(scene.spectrum_decades(), [-6, -5, -4, -3, -2, -1]);
        let whole = scene.clone().with_spectrum(SpectrumFactors::Whole(4.0)).unwrap();
        let by_decades = (-6..=-1).map(|decade| (decade, 4.0)).collect();
        let decades = scene.clone().with_spectrum(SpectrumFactors::Decades(by_decades)).unwrap();
        for found in [whole, decades] {
            assert_relative(found.fine_gradient(), 2.0 * scene.fine_gradient(), 1e-14);
            assert_relative(found.surface.rms_slope(), 2.0 * scene.surface.rms_slope(), 1e-12);
        }
        // The bands' own decade alone.
        let finest = SpectrumFactors::Decades(vec![(-6, 4.0), (-5, 1.0)]);
        let found = scene.clone().with_spectrum(finest).unwrap();
        assert_relative(found.surface.rms_slope(), scene.surface.rms_slope(), 1e-12);
        for (found, own) in found.fine_bands().iter().zip(scene.fine_bands()) {
            let factor = if TAU / own.wave_number < 1e-5 { 4.0 } else { 1.0 };
            assert_relative(found.gradient_square, factor * own.gradient_square, 1e-14);
        }
    }

    #[test]
    fn a_map_keeps_its_line() {
        let heights = |scale: f64| {
            let at = |at: usize| {
                let (x, y) = ((at % 64) as f64 / 64.0, (at / 64) as f64 / 64.0);
                (TAU * x).cos() + (TAU * y).sin() + scale * 0.1 * (TAU * (8.0 * x + 8.0 * y)).cos()
            };
            HeightMap::new(64, [0.02 / 64.0; 2], (0..64 * 64).map(at).collect())
        };
        let found = scaled(&Surface::of_map(heights(1.0), true), &SpectrumFactors::Decades(vec![(-3, 4.0), (-2, 1.0)]));
        let wanted = Surface::of_map(heights(2.0), true);
        for (found, wanted) in found.map().unwrap().heights().iter().zip(wanted.map().unwrap().heights()) {
            assert_within(*found, *wanted, 1e-12);
        }
        assert_eq!(&found.z()[..64], found.map().unwrap().line(31));
    }
}
