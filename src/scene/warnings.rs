//! Warnings: what is probably not meant though the scene is valid.

use std::fmt;

use super::{Layer, Material, Path, Phase, Scene, Surface, Wlf};

/// A layer may reach over the end by rounding: by this part of the profile's length.
const ROUNDING: f64 = 1.0e-9;

/// From the lowest to the highest position that something can have, m.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Reach {
    low: f64,
    high: f64,
}

const PROFILE_ENDS: &str = "beyond its ends the profile goes on straight, along its end tangents";
const ROUGHNESS_ENDS: &str = "beyond its ends the roughness goes on straight, along its end tangents";

impl Scene {
    /// The warning where a natural profile ends below the layer on its travel along the excitation.
    pub fn short_profile(&self) -> Option<String> {
        let (surface, travel) = (&self.surface, self.layer.reach().plus(carrier_reach(&self.excitation)));
        surface
            .too_short_for(travel)
            .then(|| format!("the profile reaches {}, but the layer moves {travel}: {PROFILE_ENDS}", surface.reach()))
    }

    /// The warning where the carrier, moved by `u` (m), has brought the layer over the end of a natural profile.
    pub fn off_profile(&self, u: f64) -> Option<String> {
        let Reach { low, high } = self.layer.reach().plus(Reach { low: u, high: u });
        let surface = &self.surface;
        surface.too_short_for(Reach { low, high }).then(|| {
            let end = if surface.too_short_for(Reach { low, high: low }) { low } else { high };
            format!("the profile reaches {}, but the layer has come to {end:?} m: {PROFILE_ENDS}", surface.reach())
        })
    }
}

impl Scene {
    /// A layer at a `temperature` (K) where friction in the contacts does not follow it.
    pub fn cold_contacts(&self, temperature: f64) -> Option<String> {
        let wlf = self.material.as_ref().filter(|material| material.heat.is_some())?.wlf?;
        let coldest = wlf.lowest_temperature() + Wlf::ABOVE_POLE;
        (temperature < coldest).then(|| {
            format!(
                "the layer is at {temperature:?} K: friction in the contacts is that at {coldest:?} K, {:?} K above the pole of \
                 the WLF equation",
                Wlf::ABOVE_POLE
            )
        })
    }
}

/// A roughness, sampled from a natural profile that ends before the layer does.
pub(super) fn short_roughness(layer: &Layer, roughness: &Surface) -> Option<String> {
    roughness.too_short_for(layer.reach()).then(|| {
        let (profile, layer) = (roughness.reach(), layer.reach());
        format!("the roughness reaches {profile}, but the layer {layer}: {ROUGHNESS_ENDS}")
    })
}

/// Numbers that are probably meant in another unit, of a layer of rubber on a road or a machine.
pub(super) fn other_units(scene: &Scene) -> Vec<String> {
    /// Below and above these no rubber is found, and no layer of it.
    const LENGTHS: (f64, f64) = (1e-10, 10.0);
    const DENSITIES: (f64, f64) = (50.0, 3e4);
    const MODULI: (f64, f64) = (1e3, 1e13);
    let Some(material) = &scene.material else { return Vec::new() };
    let glassy = material.equilibrium_modulus + material.prony.iter().map(|term| term.modulus).sum::<f64>();
    let lengths = "lengths are in m, \"25 µm\" being 25e-6";
    let moduli = "moduli are in Pa, \"8 MPa\" being 8e6";
    let checked = [
        ("layer.spacing", Some(scene.layer.spacing), LENGTHS, lengths),
        ("layer.thickness", scene.layer.thickness, LENGTHS, lengths),
        ("layer.width", scene.layer.width, LENGTHS, lengths),
        ("material.density", Some(material.density), DENSITIES, "it is in kg/m³, \"1.1 g/cm³\" being 1100"),
        ("material.equilibrium_modulus", Some(material.equilibrium_modulus), MODULI, moduli),
        ("the glassy modulus", Some(glassy), MODULI, moduli),
    ];
    let unlikely = |(name, value, (least, most), unit): (&str, Option<f64>, (f64, f64), &str)| {
        let value = value.filter(|&value| value > 0.0 && !(least..=most).contains(&value))?;
        let far = if value < least { "small" } else { "large" };
        Some(format!("{name} = {value:?} is very {far}, perhaps in another unit: {unit}"))
    };
    checked.into_iter().filter_map(unlikely).collect()
}

/// A layer that is no layer on this profile: its masses lie farther apart than that is long, or it covers periods without
/// number.
pub(super) fn other_spacing(scene: &Scene) -> Option<String> {
    /// Some tens of periods are a mean over them; a unit that is mistaken makes a thousand.
    const MOST_PERIODS: f64 = 100.0;
    let (layer, surface) = (&scene.layer, &scene.surface);
    if layer.masses < 2 || surface.is_level() {
        return None;
    }
    let (spacing, length) = (layer.spacing, surface.reach().length());
    let unit = "lengths are in m, \"25 µm\" being 25e-6";
    if spacing > length {
        return Some(format!("layer.spacing = {spacing:?} m is more than the whole profile of {length:.4e} m: {unit}"));
    }
    let periods = spacing * layer.masses as f64 / length;
    (surface.is_periodic() && periods > MOST_PERIODS).then(|| {
        format!(
            "the layer is {periods:.0} times as long as the profile's period of {length:.4e} m, by layer.spacing = {spacing:?} m: \
             {unit}"
        )
    })
}

/// Temperatures that are probably meant in °C.
pub(super) fn cold_temperatures(material: &Material) -> Option<String> {
    let wlf = material.wlf?;
    let named = [("reference_temperature", wlf.reference_temperature), ("temperature", wlf.temperature)];
    let (name, cold) = named.into_iter().find(|(_, temperature)| *temperature < Wlf::COLDEST)?;
    Some(format!(
        "material.wlf.{name} = {cold:?} K is too cold for rubber: temperatures are in K, 20 °C being 293.15 K"
    ))
}

impl Surface {
    fn reach(&self) -> Reach {
        let end = |x: Option<&f64>| x.copied().unwrap_or(0.0);
        Reach { low: end(self.x().first()), high: end(self.x().last()) }
    }

    /// A level profile is continued as it is, and is never too short.
    fn too_short_for(&self, travel: Reach) -> bool {
        let reach = self.reach();
        let rounding = ROUNDING * (reach.high - reach.low);
        let is_short = travel.low < reach.low - rounding || reach.high + rounding < travel.high;
        !self.is_periodic() && is_short && !self.is_level()
    }
}

impl Layer {
    /// The positions of the masses at rest.
    fn reach(&self) -> Reach {
        Reach { low: self.rest_position(0), high: self.rest_position(self.masses.saturating_sub(1)) }
    }
}

/// Where u can be in a run without a master.
fn carrier_reach(excitation: &[Phase]) -> Reach {
    let mut start = Reach { low: 0.0, high: 0.0 };
    let mut whole = start;
    for phase in excitation {
        let during = start.plus(phase.u.reach(phase.duration));
        whole = Reach { low: whole.low.min(during.low), high: whole.high.max(during.high) };
        let end = phase.u.at(phase.duration).position;
        // A phase that a force ends can end anywhere on its travel.
        start = if phase.until_force.or(phase.until_pressure).is_some() {
            during
        } else {
            start.plus(Reach { low: end, high: end })
        };
    }
    whole
}

impl fmt::Display for Reach {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "from {:?} m to {:?} m", self.low, self.high)
    }
}

impl Reach {
    fn length(self) -> f64 {
        self.high - self.low
    }

    fn plus(self, other: Self) -> Self {
        Self { low: self.low + other.low, high: self.high + other.high }
    }
}

impl Path {
    /// Bounds of the displacement up to `duration`, s.
    fn reach(&self, duration: f64) -> Reach {
        let drift = self.rate * duration;
        let swing = if self.frequency == 0.0 { 0.0 } else { self.amplitude.abs() };
        Reach { low: drift.min(0.0) - swing, high: drift.max(0.0) + swing }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path as FilePath;

    use super::*;

    fn warnings_of(text: &str) -> Vec<String> {
        Scene::parse(text, FilePath::new("scene.toml")).unwrap_or_else(|error| unreachable!("{error}")).warnings
    }

    fn warnings(layer: &str, phases: &str) -> Vec<String> {
        let layer = format!("[layer]\nmasses = 4\nspacing = 0.25\nmass = 1\n{layer}");
        warnings_of(&format!("name = 'w'\n{phases}\n{layer}\n[surface]\nkind = 'points'\nx = [0, 1]\nz = [0, 1]"))
    }

    #[test]
    fn a_profile_shorter_than_the_travel_is_a_warning() {
        assert_eq!(warnings("", "").len(), 0);
        assert_eq!(warnings("origin = 0.25000000001", "").len(), 0);
        assert_eq!(warnings("", "excitation = [{ duration = 1, u_rate = 0.25 }]").len(), 0);
        let found = [
            warnings("origin = -0.5", ""),
            warnings("origin = 0.5", ""),
            warnings("", "excitation = [{ duration = 2, u_rate = -0.125 }]"),
            warnings("", "excitation = [{ duration = 1, u_sine = { amplitude = -0.3, frequency = 1 } }]"),
            warnings("", "excitation = [{ duration = 2, u_rate = 0.125 }, { duration = 1, u_rate = 0.125 }]"),
            warnings(
                "",
                "excitation = [{ duration = 2, u_rate = -0.1, until_force = 1 }, { duration = 1, u_rate = 0.3 }]",
            ),
        ];
        assert!(found.iter().all(|warnings| warnings.len() == 1), "{found:?}");
        let text = "the profile reaches from 0.0 m to 1.0 m, but the layer moves from -0.5 m to 0.25 m: \
                    beyond its ends the profile goes on straight, along its end tangents";
        assert_eq!(found[0], [text]);
    }

    #[test]
    fn a_roughness_shorter_than_the_layer_is_a_warning() {
        let roughness = |x: &str| {
            let layer =
                format!("masses = 4\nspacing = 0.25\nmass = 1\nroughness = {{ kind = 'points', x = {x}, z = [0, 1] }}");
            warnings_of(&format!("name = 'r'\n[layer]\n{layer}\n[surface]\nkind = 'flat'"))
        };
        assert!(roughness("[0, 0.75]").is_empty());
        let text = "the roughness reaches from 0.0 m to 0.5 m, but the layer from 0.0 m to 0.75 m: \
                    beyond its ends the roughness goes on straight, along its end tangents";
        assert_eq!(roughness("[0, 0.5]"), [text]);
    }

    /// Of a sine of 1 mm: 0.25 mm as 0.25 m, and as 250 µm a layer of 40 periods.
    #[test]
    fn a_layer_that_is_no_layer_on_its_profile_is_a_warning() {
        let found = |masses: u32, spacing: f64| {
            let layer = format!("layer = {{ masses = {masses}, spacing = {spacing}, mass = 1 }}");
            warnings_of(&format!(
                "name = 'l'\n{layer}\nsurface = {{ kind = 'sinusoid', amplitude = 1e-6, wavelength = 1e-3 }}"
            ))
        };
        assert_eq!((found(160, 2.5e-4), found(1, 0.25)), (Vec::<String>::new(), Vec::new()));
        let text = "layer.spacing = 0.25 m is more than the whole profile of 1.0000e-3 m: lengths are in m, \"25 µm\" being 25e-6";
        assert_eq!(found(160, 0.25), [text]);
        assert!(found(1000, 9e-4)[0].starts_with("the layer is 900 times as long as the profile's period"));
    }

    #[test]
    fn moduli_of_a_few_pascals_are_a_warning() {
        let found = warnings_of(
            "name = 'm'\nlayer = { masses = 4, spacing = 1e-4, thickness = 1e-3, width = 1e-2 }\nsurface = { kind = 'flat' }
            material = { density = 1100, poisson_ratio = 0.49, equilibrium_modulus = 4.4, prony = [{ modulus = 1e7, relaxation_time = 1 }] }",
        );
        assert!(
            found.len() == 1 && found[0].starts_with("material.equilibrium_modulus = 4.4 is very small"),
            "{found:?}"
        );
    }

    #[test]
    fn temperatures_in_degrees_celsius_are_a_warning() {
        let warnings = |reference: f64, temperature: f64| {
            warnings_of(&format!(
                "name = 't'\nlayer = {{ masses = 4, spacing = 1e-4, thickness = 1e-3, width = 1e-2 }}\nsurface = {{ kind = 'flat' }}
                [material]\ndensity = 1100\npoisson_ratio = 0.49\nequilibrium_modulus = 1e6\nprony = []
                wlf = {{ c1 = 7.52, c2 = 119.75, reference_temperature = {reference}, temperature = {temperature} }}"
            ))
        };
        let meant = |name: &str| {
            [format!("material.wlf.{name} K is too cold for rubber: temperatures are in K, 20 °C being 293.15 K")]
        };
        assert!(warnings(293.15, 313.15).is_empty());
        assert_eq!(warnings(20.0, 40.0), meant("reference_temperature = 20.0"));
        assert_eq!(warnings(200.0, 99.0), meant("temperature = 99.0"));
    }

    #[test]
    fn a_periodic_or_a_level_profile_is_never_too_short() {
        let far = "excitation = [{ duration = 1, u_rate = 1e3 }]";
        let periodic = "surface = { kind = 'sinusoid', amplitude = 1, wavelength = 1 }";
        for surface in
            ["surface = { kind = 'flat' }", "surface = { kind = 'points', x = [0, 1], z = [2, 2] }", periodic]
        {
            let text = format!("name = 'n'\nlayer = {{ masses = 9, spacing = 1, mass = 1 }}\n{surface}\n{far}");
            assert!(warnings_of(&text).is_empty());
        }
    }
}
