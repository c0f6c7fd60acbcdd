use super::*;

const ROUGH: SelfAffine =
    SelfAffine { length: 0.1, points: 4000, hurst: 0.8, rms: 2e-5, roll_off: 5e-3, cut_off: 1e-4, seed: 7 };

/// The mean square heights of the modes, from the heights at the points.
fn powers(profile: &SelfAffine) -> Vec<f64> {
    let heights: Vec<_> = profile.heights().into_iter().map(Complex::from).collect();
    let n = profile.points as f64;
    let sums = fourier(&heights, Direction::Forward);
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
        let surface = SelfAffine { points, ..ROUGH }.surface();
        assert_eq!((surface.x.len(), surface.x[0], surface.x[points]), (points + 1, 0.0, 0.1));
        assert!(surface.periodic && surface.z[0] == surface.z[points]);
        let heights = &surface.z[..points];
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
    let spline = profile.surface().spline();
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
/// The values are those of a program of its own in Python, which sums the cosines one by one with 40 digits: this one
/// is right to its last digits, and the bits say that the next platform, compiler or change gives the same.
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
