//! Warnings of `surface.fine`: where its waves are probably not those that the profile lacks.

use std::f64::consts::TAU;

use super::spectrum::logarithmic_mean;
use super::{FineBand, FineWaves, gradient_square};
use crate::scene::{Scene, Spectrum};

/// Root mean square gradient above which a unit or a convention is probably mistaken.
const STEEP: f64 = 3.0;
/// Part of the bands' h'² that may be missing between profile and bands, or be in both.
const DISAGREEMENT: f64 = 0.1;
/// A profile whose h'² is this part of the bands' has no waves of its own.
const LEVEL: f64 = 1e-6;
/// A law goes on over a wavelength if that is not the line's resolution but for rounded digits.
const ROUNDING: f64 = 1e-5;

impl Scene {
    /// What of the roughness below the profile is probably not meant; nothing without it.
    pub(in crate::scene) fn fine_warnings(&self) -> Vec<String> {
        let bands = self.fine_bands();
        [self.steep_bands(), self.continued_spectrum(), self.gap_or_overlap(&bands)].into_iter().flatten().collect()
    }

    fn steep_bands(&self) -> Option<String> {
        let gradient = self.fine_gradient();
        (gradient > STEEP).then(|| {
            format!(
                "surface.fine has a root mean square gradient of {gradient:.3}, more than {STEEP:?}: is the unit of \
                 its spectrum right, and its convention?"
            )
        })
    }

    fn continued_spectrum(&self) -> Option<String> {
        let FineWaves::Split { spectrum, shortest, .. } = &self.fine.as_ref()?.waves else { return None };
        let (exponent, [_, resolved]) = (spectrum.tail_exponent()?, spectrum.wavelengths());
        (*shortest < resolved * (1.0 - ROUNDING)).then(|| {
            format!(
                "surface.fine: the line resolves waves down to {resolved:.3e} m; from there to {shortest:.3e} m the law \
                 of its last decade goes on, C ~ q^{exponent:.2}"
            )
        })
    }

    /// Between a profile and bands that do not come of one another.
    fn gap_or_overlap(&self, bands: &[FineBand]) -> Option<String> {
        let (FineWaves::SelfAffine { longest, .. } | FineWaves::Table { longest, .. }) = self.fine.as_ref()?.waves
        else {
            return None;
        };
        let whole: f64 = bands.iter().map(|band| band.gradient_square).sum();
        let spectrum = Spectrum::new(&self.surface);
        if whole <= 0.0 || spectrum.slope_square() <= LEVEL * whole {
            return None;
        }
        let shortest = spectrum.shortest_wavelength()?;
        // Bands are even in ln q, and the first begins at the longest wavelength.
        let width = 2.0 * (bands.first()?.wave_number * longest / TAU).ln();
        let square = if shortest > longest {
            missing(bands, width, shortest / longest)
        } else {
            common(bands, width, &spectrum)
        };
        let part = square / whole;
        let percent = 100.0 * part;
        let found = if shortest > longest {
            format!("waves between the profile's shortest, {shortest:.3e} m, and longest are missing")
        } else {
            format!("waves between longest and the profile's shortest, {shortest:.3e} m, are counted twice")
        };
        (part > DISAGREEMENT).then(|| {
            format!("surface.fine.longest = {longest:?} m: {found}, {percent:.0} % of the bands' mean square gradient")
        })
    }
}

/// h'² of the waves up to a `ratio` longer than the longest of the bands, each of a `width` in ln q, if their spectrum
/// went on as it begins.
fn missing(bands: &[FineBand], width: f64, ratio: f64) -> f64 {
    let Some(first) = bands.first() else { return 0.0 };
    // h'² over ln q is a power of q, between that of H = 1 and that of H = 0.
    let power = |second: &FineBand| (second.gradient_square / first.gradient_square).ln() / width;
    let power = bands.get(1).map(power).filter(|power| power.is_finite()).map_or(0.0, |power| power.clamp(0.0, 2.0));
    let at_first = first.gradient_square / width * (-0.5 * power * width).exp();
    logarithmic_mean(at_first * ratio.powf(-power), at_first) * ratio.ln()
}

/// h'² of the waves that are in the bands, each of a `width` in ln q, and in the profile: the smaller of both.
fn common(bands: &[FineBand], width: f64, profile: &Spectrum) -> f64 {
    let Some(profile) = profile.isotropic() else { return 0.0 };
    let [longest, shortest] = profile.wavelengths();
    let of_band = |band: &FineBand| {
        let (q, wavelength) = (band.wave_number, TAU / band.wave_number);
        let is_in_both = shortest <= wavelength && wavelength <= longest;
        if is_in_both { gradient_square(q, profile.density(q), width).min(band.gradient_square) } else { 0.0 }
    };
    bands.iter().map(of_band).sum()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    /// The warnings of a self-affine surface from 10 mm to the cut-off, and bands of the same law from `longest` (m) to
    /// 10 µm.
    fn warnings(cut_off: f64, longest: f64, rms_slope: f64) -> Vec<String> {
        let text = format!(
            "name = 'w'\nlayer = {{ masses = 4, spacing = 1e-4, thickness = 1e-3, width = 1e-2 }}\n\
             [material]\ndensity = 1100\npoisson_ratio = 0.49\nequilibrium_modulus = 1e6\nprony = []\n\
             [surface]\nkind = 'self_affine'\nlength = 0.05\npoints = 20000\nhurst = 0.8\nrms = 5e-5\n\
             roll_off_wavelength = 1e-2\ncut_off_wavelength = {cut_off:e}\nseed = 3\n\
             fine = {{ hurst = 0.8, rms_slope = {rms_slope}, longest = {longest:e}, shortest = 1e-5 }}"
        );
        let scene = Scene::parse(&text, Path::new("w.toml")).unwrap_or_else(|error| unreachable!("{error}"));
        scene.warnings.into_iter().filter(|warning| warning.starts_with("surface.fine")).collect()
    }

    /// Of the law h'² ∝ q^0.4 between wavelengths a and b: a^-0.4 - b^-0.4. The bands from 1 mm to 10 µm have 84.2 of
    /// it, a gap to 2 mm 3.8 (5 %), to 8 mm 8.9 (11 %).
    #[test]
    fn waves_that_are_missing_are_a_warning() {
        assert!(warnings(1e-3, 1e-3, 0.5).is_empty() && warnings(2e-3, 1e-3, 0.5).is_empty());
        let found = warnings(8.3e-3, 1e-3, 0.5);
        let expected = "surface.fine.longest = 0.001 m: waves between the profile's shortest, 8.333e-3 m, and longest \
                        are missing, 11 % of the bands' mean square gradient";
        assert_eq!(found, [expected]);
    }

    /// From 1 mm to its cut-off of 0.1 mm the profile has h'² of 0.012: of the bands with a gradient of 0.3 that is 13
    /// %, of those with 0.5 it is 5 %.
    #[test]
    fn waves_that_are_in_both_are_a_warning() {
        let found = warnings(1e-4, 1e-3, 0.3);
        let start = "surface.fine.longest = 0.001 m: waves between longest and the profile's shortest, 1.0";
        assert!(found.len() == 1 && found[0].starts_with(start), "{found:?}");
        assert!(found[0].contains("are counted twice, 13 % of"), "{found:?}");
        assert!(warnings(1e-4, 1e-3, 0.5).is_empty() && warnings(9e-4, 1e-3, 0.3).is_empty());
    }

    #[test]
    fn a_gradient_above_three_is_a_warning() {
        let found = warnings(1e-3, 1e-3, 3.1);
        assert!(
            found.len() == 1 && found[0].starts_with("surface.fine has a root mean square gradient of 3.100"),
            "{found:?}"
        );
    }
}
