//! How wide fitted links make the contacts of a profile, beside those of an elastic half-plane.

use std::f64::consts::{PI, TAU};

use super::{ElasticBody, FoundationKind, Stiffness};
use crate::scene::{Scene, Surface};

/// Contacts of a profile's crests with a layer whose links are fitted to a half-space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactFit {
    /// Their mean length, m.
    pub length: f64,
    /// Their length over that which a half-plane has under the same loads, 1.
    pub widening: f64,
    /// r of the links against a wave of twice their mean length, 1.
    pub stiffness: f64,
}

/// Contacts of fewer masses are not resolved, whatever the links are.
const FEWEST: f64 = 4.0;
/// Where a larger share of the masses touches contacts are no longer alone.
const CLOSE: f64 = 0.5;
/// Points that a profile is looked at in.
const MOST_POINTS: f64 = 1e6;

impl Scene {
    /// How the links fit contacts that are a `share` of the masses: those of the highest parts of the profile. `None` of
    /// links that are not a half-space's, of a layer that is rough itself, and of contacts that are too short or too close
    /// to be judged one by one.
    pub fn contact_fit(&self, share: f64) -> Option<ContactFit> {
        let (foundation, spacing) = (self.foundation.as_ref()?, self.layer.spacing);
        let is_of_profile = self.layer.foundation == Some(FoundationKind::HalfSpace) && self.layer.roughness.is_empty();
        if !is_of_profile || foundation.normal.alpha == 0.0 || share > CLOSE {
            return None;
        }
        let lengths = self.surface.highest(share, spacing);
        let whole: f64 = lengths.iter().sum();
        let length = whole / lengths.len() as f64;
        let of_half_plane: f64 = lengths.iter().map(|length| foundation.normal.length_on_half_plane(*length)).sum();
        let wave_number = TAU / (2.0 * length);
        (length >= FEWEST * spacing).then(|| ContactFit {
            length,
            widening: whole / of_half_plane,
            stiffness: foundation.normal.at_wave_number(&foundation.waves, wave_number)
                / ElasticBody::HalfPlane.normal(wave_number),
        })
    }
}

impl Stiffness {
    /// The length that a contact of the length 2a on these links has on a half-plane under the same load, m.
    ///
    /// On a crest of the radius R the links, which fall off over l = √(β/α) beside it, bear (Mα/R)(⅔a³ + 2a²l + 2al²) a
    /// width, a half-plane πMa²/(4R) (H. Hertz, J. reine angew. Math. 92, 1882, 156).
    fn length_on_half_plane(self, length: f64) -> f64 {
        let (a, l) = (0.5 * length, (self.beta / self.alpha).sqrt());
        let borne = 2.0 / 3.0 * a.powi(3) + 2.0 * a * l * (a + l);
        2.0 * (4.0 * self.alpha / PI * borne).sqrt()
    }
}

impl Surface {
    /// The lengths of the parts of the profile that lie highest, together this `share` of it, at points that are `spacing`
    /// (m) apart; none of a level one.
    fn highest(&self, share: f64, spacing: f64) -> Vec<f64> {
        let x = self.x();
        let length = x[x.len() - 1] - x[0];
        let [points, count] = [length, share * length].map(|part| (part / spacing).round());
        if self.is_level() || count < 1.0 || points > MOST_POINTS {
            return Vec::new();
        }
        let mut heights: Vec<f64> =
            (0..points as usize).map(|i| self.spline().evaluate(x[0] + i as f64 * spacing).0).collect();
        let mut sorted = heights.clone();
        sorted.sort_unstable_by(|a, b| b.total_cmp(a));
        let level = sorted[count as usize - 1];
        // Of a periodic profile what is at its ends is one part.
        let valley = heights.iter().position(|&z| z < level).unwrap_or(0);
        heights.rotate_left(valley);
        let parts = heights.split(|&z| z < level).filter(|part| !part.is_empty());
        parts.map(|part| part.len() as f64 * spacing).collect()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::in_tests::assert_relative;

    /// A cylinder on an elastic half-plane, 512 masses in a period of 64 times 40 µm: slid by `sweep`, contacts were 0.0467,
    /// 0.1063, 0.1941 and 0.3346 of the period, by Hertz 0.0315, 0.0705, 0.1410 and 0.2821.
    #[test]
    fn a_single_contact_is_as_much_too_wide_as_it_was_found() {
        let (period, points) = (2.56e-3, 1024);
        let x: Vec<f64> = (0..=points).map(|i| period * f64::from(i) / f64::from(points)).collect();
        let z: Vec<f64> = x.iter().map(|x| -(x - 0.5 * period).abs().min(1.2e-3).powi(2) / 1e-2).collect();
        let scene = Scene::parse(
            &format!(
                "name = 'c'\nlayer = {{ foundation = 'half_space', masses = 512, spacing = 5e-6, width = 1e-2 }}\n\
                 material = {{ density = 1e3, poisson_ratio = 0.5, equilibrium_modulus = 1e6, prony = [] }}\n\
                 surface = {{ kind = 'points', x = {x:?}, z = {z:?}, periodic = true }}"
            ),
            "c.toml".as_ref(),
        )
        .unwrap();
        for (found, exact) in [(0.0467, 0.031539), (0.1063, 0.070524), (0.1941, 0.141047), (0.3346, 0.282095)] {
            let fit = scene.contact_fit(found).unwrap();
            // A mass more or less in contact: one of 24 at least.
            assert!((fit.length - found * period).abs() < 1.1 * 5e-6, "{fit:?}");
            assert_relative(fit.widening, found / exact, 0.04);
            assert!(fit.stiffness < 0.8, "{fit:?}");
        }
        assert_eq!((scene.contact_fit(0.6), scene.contact_fit(0.005)), (None, None));
    }
}
