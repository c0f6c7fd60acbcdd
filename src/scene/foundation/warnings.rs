//! Warnings of a fitted foundation: where area and friction would not be those of rubber on this surface.

use super::{Foundation, FoundationKind};
use crate::scene::{Force, LinkKind, Phase, PowerLaw, Scene, Spectrum, Surface};

/// Root mean square of r - 1 above which area and friction are off.
const WIDE: f64 = 0.5;
/// Masses that the shortest wavelength of weight needs.
const MASSES_PER_WAVE: f64 = 8.0;
/// Part of the weight that may lie below the spacing.
const ALIASED: f64 = 0.01;
/// Springs that are further than this factor from the stiffness of a layer are none of rubber.
const FAR: f64 = 2.0;
/// Root mean square slope above which friction is too large.
const STEEP: f64 = 0.3;
/// Part of the plane modulus above which pressures move masses along.
const HARD: f64 = 0.1;
/// Roll-off wavelengths that a layer should be long.
const ROLL_OFFS: f64 = 2.0;
/// A layer is as long as the period if it is but for rounding.
const ROUNDING: f64 = 1.0e-9;

impl Scene {
    /// What of this scene is outside the range in which the links stand for the rubber's surface.
    pub(in crate::scene) fn foundation_warnings(&self) -> Vec<String> {
        let mut found = self.link_warnings();
        found.extend(self.far_springs());
        found.extend(self.foundation.as_ref().and_then(|foundation| foundation.no_support(self.layer.masses)));
        found
    }

    /// Springs that are far from the stiffness of a layer of their thickness.
    fn far_springs(&self) -> Option<String> {
        if self.layer.foundation != Some(FoundationKind::Springs) || self.surface.is_level() {
            return None;
        }
        let along = |kind| self.quality(kind).map(|quality| [quality.least, quality.largest]);
        let [vertical, horizontal] = [along(LinkKind::Vertical)?, along(LinkKind::Horizontal)?];
        let is_far = |[least, largest]: [f64; 2]| least < 1.0 / FAR || largest > FAR;
        let times = |[least, largest]: [f64; 2]| match (format!("{least:.3}"), format!("{largest:.3}")) {
            (least, largest) if least == largest => least,
            (least, largest) => format!("{least} to {largest}"),
        };
        (is_far(vertical) || is_far(horizontal)).then(|| {
            format!(
                "foundation = \"springs\": against the waves of the profile the links are {} times as stiff along z, and {} \
                 times along x, as a layer of rubber of layer.thickness: forces, friction and area are not those of rubber; \
                 layer.foundation = \"layer\" or \"half_space\" fits the links",
                times(vertical),
                times(horizontal)
            )
        })
    }

    /// Warnings about the masses and links that stand for the rubber; a solution for steady sliding uses neither.
    pub fn link_warnings(&self) -> Vec<String> {
        let Some(foundation) = &self.foundation else { return Vec::new() };
        let found = [
            self.wide_band(),
            self.coarse_spacing(foundation),
            self.waves_below_the_spacing(foundation),
            self.hard_pressure("until_pressure", self.largest_pressure(), true),
            self.hard_pressure("the largest load over the layer's area", self.largest_load().unwrap_or(0.0), true),
            self.short_layer(),
            steep_slopes(foundation),
        ];
        found.into_iter().flatten().collect()
    }

    fn wide_band(&self) -> Option<String> {
        let rms = self.quality(LinkKind::Vertical)?.rms;
        (rms > WIDE).then(|| {
            format!(
                "band too wide: the links miss the stiffness of the surface by {rms:.2} (root mean square over the waves), \
                 more than {WIDE}: areas come out 10 to 35 % too large, friction 10 to 20 % off"
            )
        })
    }

    /// Whether the spacing is too coarse for the waves of the profile: one of the scene's warnings.
    pub fn has_coarse_spacing(&self) -> bool {
        self.foundation.as_ref().is_some_and(|foundation| self.coarse_spacing(foundation).is_some())
    }

    fn coarse_spacing(&self, foundation: &Foundation) -> Option<String> {
        let (spacing, shortest) = (self.layer.spacing, foundation.waves.shortest);
        (shortest > 0.0 && spacing > shortest / MASSES_PER_WAVE).then(|| {
            format!(
                "spacing too coarse: layer.spacing = {spacing:?} m is more than an eighth of {shortest:.3e} m, the \
                 wavelength beyond which 1 % of the slopes' power lies: areas come out some {:.0} % too large, and \
                 friction with them",
                50.0 * spacing / shortest
            )
        })
    }

    fn waves_below_the_spacing(&self, foundation: &Foundation) -> Option<String> {
        let beyond = foundation.waves.beyond;
        (beyond > ALIASED).then(|| {
            format!(
                "waves below the spacing: {:.1} % of the slopes' power is in wavelengths below twice layer.spacing = {:?} m, \
                 which the masses see as longer ones: smooth the profile, and give the waves to surface.fine",
                100.0 * beyond,
                self.layer.spacing
            )
        })
    }

    /// The warning where `pressure` (Pa), called `name` where it was asked for, is outside the range in which the links
    /// stand for the rubber's surface, none for springs; or where no layer slides but steady sliding is solved for, outside
    /// that of linear rubber.
    pub fn hard_pressure(&self, name: &str, pressure: f64, layer_slides: bool) -> Option<String> {
        if layer_slides {
            self.foundation.as_ref()?;
        }
        let modulus = self.material.as_ref()?.plane_modulus(self.material.as_ref()?.equilibrium_modulus);
        if pressure > modulus {
            return Some(format!(
                "pressed too hard: {name} = {pressure:?} Pa is more than the plane modulus at rest, {modulus:.3e} Pa: is one of \
                 them in another unit than Pa?"
            ));
        }
        let then = match layer_slides {
            true => {
                let excess = 100.0 * (2.0 * pressure / modulus).powi(2);
                format!("in full contact friction comes out {excess:.0} % too large")
            }
            false => "steady sliding is that of linear rubber, which is strained too far".to_owned(),
        };
        (pressure > HARD * modulus).then(|| {
            format!(
                "pressed too hard: {name} = {pressure:?} Pa is more than a tenth of the plane modulus at rest, \
                 {modulus:.3e} Pa: {then}"
            )
        })
    }

    /// The largest mean pressure that a phase ends at, Pa; 0 without one.
    fn largest_pressure(&self) -> f64 {
        let pressures = self.excitation.iter().filter_map(|phase: &Phase| phase.until_pressure);
        pressures.fold(0.0, f64::max)
    }

    /// The largest load on a body along z, over the layer's area, Pa; `None` without a body.
    fn largest_load(&self) -> Option<f64> {
        let (body, area) = (self.carrier.z?, self.layer.area()?);
        let most = |phase: &Phase| {
            let Force { start, change } = phase.load(Some(area));
            start.unwrap_or(0.0) + (change.rate * phase.duration).max(0.0) + change.amplitude.abs()
        };
        Some((body.load.unwrap_or(0.0) + self.excitation.iter().map(most).fold(0.0, f64::max)) / area)
    }

    fn short_layer(&self) -> Option<String> {
        let length = self.layer.spacing * self.layer.masses as f64;
        let end = "open ends and chance count";
        if let Some(period) = self.surface.period().filter(|period| length < period * (1.0 - ROUNDING)) {
            return Some(format!("short layer: {length:.3e} m are less than the period of {period:.3e} m: {end}"));
        }
        let roll_off = self.surface.roll_off_wavelength()?;
        (length < ROLL_OFFS * roll_off).then(|| {
            format!("short layer: {length:.3e} m are less than two roll-off wavelengths of {roll_off:.3e} m: {end}")
        })
    }
}

impl Foundation {
    /// Over waves of a narrow band the fit may leave nothing between the carrier and the masses.
    fn no_support(&self, masses: usize) -> Option<String> {
        (self.normal.alpha == 0.0).then(|| {
            format!(
                "no vertical links: fitted over the waves that {masses} masses resolve, α is 0, so that nothing bears the \
                 carrier: more masses, or foundation = \"springs\""
            )
        })
    }
}

fn steep_slopes(foundation: &Foundation) -> Option<String> {
    let slope = foundation.waves.slope;
    (slope > STEEP).then(|| {
        format!(
            "small slopes only: the root mean square slope of {slope:.2} is above {STEEP}: friction comes out too large, by \
             10 % at 0.3, by 30 % at 0.6 and by a factor at 1, as the links have the strain along the slopes and not what finite \
             strain adds to it"
        )
    })
}

impl Surface {
    /// The period of a profile that is not level, m.
    fn period(&self) -> Option<f64> {
        (self.is_periodic() && !self.is_level()).then(|| self.x()[self.x().len() - 1] - self.x()[0])
    }

    /// The wavelength above which the spectrum is constant, m: as given, or of the law that the spectrum follows.
    fn roll_off_wavelength(&self) -> Option<f64> {
        let given = self.self_affine().map(|law| law.roll_off);
        given.or_else(|| PowerLaw::fit(&Spectrum::new(self).bands(), None)?.roll_off_wavelength)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// A tenth of M = 1e6/0.75 Pa is 0.133 MPa.
    #[test]
    fn pressures_above_a_tenth_of_the_modulus_are_a_warning_whatever_slides() {
        let scene = |foundation: &str, more: &str| {
            let text = format!(
                "name = 's'\nlayer = {{ foundation = '{foundation}', masses = 16, spacing = 1e-4, {more} width = 1e-2 }}\n\
                 material = {{ density = 1e3, poisson_ratio = 0.5, equilibrium_modulus = 1e6, prony = [] }}\n\
                 surface = {{ kind = 'flat' }}\ncarrier = {{ z = {{ mass = 1, load = 1 }} }}\n\
                 excitation = [{{ duration = 1, pressure = 2e5 }}]"
            );
            Scene::parse(&text, "s.toml".as_ref()).unwrap()
        };
        let of_links = scene("half_space", "");
        assert_eq!(of_links.warnings.iter().filter(|text| text.contains("the largest load over")).count(), 1);
        for layer_slides in [false, true] {
            assert!(
                of_links.hard_pressure("p", 2e5, layer_slides).unwrap().starts_with("pressed too hard: p = 200000.0")
            );
            assert_eq!(of_links.hard_pressure("p", 1.3e5, layer_slides), None);
        }
        let springs = scene("springs", "thickness = 1e-2,");
        assert_eq!(springs.hard_pressure("p", 2e5, true), None);
        assert!(springs.hard_pressure("p", 2e5, false).is_some());
    }
}
