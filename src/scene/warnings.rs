//! What is worth telling about a scene though it is valid.

use std::fmt;

use super::{Layer, Material, Path, Phase, Scene, Surface, Wlf};

/// A layer may reach over the end by rounding: by this part of the profile's length.
const ROUNDING: f64 = 1.0e-9;

/// From the lowest to the highest place that something can have, m.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Reach {
    low: f64,
    high: f64,
}

/// A natural profile that ends below the layer on its way.
pub(super) fn short_profile(layer: &Layer, surface: &Surface, excitation: &[Phase]) -> Option<String> {
    let way = layer.reach().plus(carrier_reach(excitation));
    surface
        .too_short_for(way)
        .then(|| format!("the profile reaches {}, but the layer moves {way}: {PROFILE_ENDS}", surface.reach()))
}

/// What a natural profile is beyond its ends.
const PROFILE_ENDS: &str = "beyond its ends the profile goes on straight, along its end tangents";

impl Scene {
    /// What is worth telling where the carrier, moved by `u` (m), has brought the layer over the end of a natural
    /// profile.
    pub fn off_profile(&self, u: f64) -> Option<String> {
        let Reach { low, high } = self.layer.reach().plus(Reach { low: u, high: u });
        let surface = &self.surface;
        surface.too_short_for(Reach { low, high }).then(|| {
            let end = if surface.too_short_for(Reach { low, high: low }) { low } else { high };
            format!("the profile reaches {}, but the layer has come to {end:?} m: {PROFILE_ENDS}", surface.reach())
        })
    }
}

/// A roughness, sampled from a natural profile that ends before the layer does.
pub(super) fn short_roughness(layer: &Layer, roughness: &Surface) -> Option<String> {
    roughness.too_short_for(layer.reach()).then(|| {
        let (profile, end) =
            (roughness.reach(), "beyond its ends the roughness goes on straight, along its end tangents");
        format!("the roughness reaches {profile}, but the layer {}: {end}", layer.reach())
    })
}

/// Temperatures that are meant in °C, most likely.
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
        Reach { low: end(self.x.first()), high: end(self.x.last()) }
    }

    /// A level profile goes on as it is, and ends nowhere.
    fn too_short_for(&self, way: Reach) -> bool {
        let reach = self.reach();
        let rounding = ROUNDING * (reach.high - reach.low);
        let level = || self.z.windows(2).all(|pair| pair[0] == pair[1]);
        !self.periodic && (way.low < reach.low - rounding || reach.high + rounding < way.high) && !level()
    }
}

impl Layer {
    /// The places of the masses at rest.
    fn reach(&self) -> Reach {
        Reach { low: self.place(0), high: self.place(self.masses.saturating_sub(1)) }
    }
}

/// Where u can be in a run without a master.
fn carrier_reach(excitation: &[Phase]) -> Reach {
    let mut start = Reach { low: 0.0, high: 0.0 };
    let mut whole = start;
    for phase in excitation {
        let during = start.plus(phase.u.reach(phase.duration));
        whole = Reach { low: whole.low.min(during.low), high: whole.high.max(during.high) };
        let end = phase.u.at(phase.duration);
        // A phase that a force ends can end anywhere on its way.
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
