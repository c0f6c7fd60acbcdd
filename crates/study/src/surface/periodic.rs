//! A profile that ends made periodic.

use std::f64::consts::PI;

use asperity::scene::Surface;

/// Share of the length over which the end of a tapered profile goes over into its beginning.
const TAPER: f64 = 0.1;

/// The profile followed by its mirror image, without the point that both have: its heights are those of before, and
/// where it turns, its slope changes its sign.
pub(super) fn mirrored(surface: &Surface) -> Surface {
    let (x, z) = (surface.x(), surface.z());
    let end = x[x.len() - 1];
    let back = || (0..x.len() - 1).rev();
    let mirrored_x = x.iter().copied().chain(back().map(|i| 2.0 * end - x[i])).collect();
    let mirrored_z = z.iter().copied().chain(back().map(|i| z[i])).collect();
    Surface::new(mirrored_x, mirrored_z, true)
}

/// The profile without the last tenth of its length, which goes over into the first tenth by a cosine: at x = 0 it goes
/// on from where the period ends, with the same slope.
pub(super) fn tapered(surface: &Surface) -> Surface {
    let (x, z, spline) = (surface.x(), surface.z(), surface.spline());
    let length = x[x.len() - 1] - x[0];
    // A point of the profile, so that no height between points is needed where they are even.
    let last = x.partition_point(|x_i| *x_i < x[0] + (1.0 - TAPER) * length * (1.0 - ROUNDING));
    let period = x[last] - x[0];
    let blended = |i: usize| {
        let share = ((x[i] - x[0]) / (length - period)).min(1.0);
        let weight = 0.5 * (1.0 - (PI * share).cos());
        if weight < 1.0 { weight * z[i] + (1.0 - weight) * spline.evaluate(x[i] + period).0 } else { z[i] }
    };
    let mut heights: Vec<f64> = (0..last).map(blended).collect();
    heights.push(heights[0]);
    Surface::new(x[..=last].to_vec(), heights, true)
}

/// A position that differs by this share of the length is the same but for rounding.
const ROUNDING: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp_and_waves() -> Surface {
        let x: Vec<f64> = (0..=1000).map(|i| 1e-6 * f64::from(i)).collect();
        let z = x.iter().map(|x| 1e-6 * (9e4 * x).sin() + 5e-3 * x).collect();
        Surface::new(x, z, false)
    }

    #[test]
    fn a_mirrored_profile_has_the_heights_of_before_twice() {
        let profile = Surface::new(vec![1.0, 2.0, 4.0], vec![0.0, 3.0, 5.0], false);
        let periodic = mirrored(&profile);
        assert_eq!(periodic.x(), [1.0, 2.0, 4.0, 6.0, 7.0]);
        assert_eq!(periodic.z(), [0.0, 3.0, 5.0, 3.0, 0.0]);
        assert!(periodic.is_periodic());
    }

    /// A ramp of 5 µm, which a window would cut off, or a mirror turn round.
    #[test]
    fn a_tapered_profile_goes_on_smoothly_and_is_the_one_of_before_elsewhere() {
        let profile = ramp_and_waves();
        let periodic = tapered(&profile);
        let (x, z) = (periodic.x(), periodic.z());
        assert!((x[x.len() - 1] / 0.9e-3 - 1.0).abs() < 1e-9 && z[0] == z[z.len() - 1]);
        assert!((z[0] - profile.z()[900]).abs() < 1e-15);
        assert!((101..900).all(|i| z[i] == profile.z()[i]));
        // Of the waves 0.09, of the ramp 0.005; a ramp of 4.5 µm back over 0.1 mm by a cosine adds at most π/2 of
        // 0.045.
        let steepest = periodic.spline().bounds().slope_max_abs;
        assert!(steepest < 0.095 + 0.5 * PI * 0.045 * 1.5, "{steepest}");
        // The second difference over the seam is like that of the waves, 1 µm (0.09)².
        let seam = z[1] - 2.0 * z[0] + z[z.len() - 2];
        assert!(seam.abs() < 2.0 * 1e-6 * 0.09 * 0.09, "{seam}");
    }
}
