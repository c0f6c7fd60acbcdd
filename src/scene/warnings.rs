//! What is worth telling about a scene though it is valid.

use super::{Layer, Path, Phase, Surface};

/// From the lowest to the highest place that something can have, m.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Reach {
    low: f64,
    high: f64,
}

pub(super) fn warnings(layer: &Layer, surface: &Surface, excitation: &[Phase]) -> Vec<String> {
    short_profile(layer, surface, excitation).into_iter().collect()
}

/// A natural profile that ends below the layer. A level one goes on as it is, and ends nowhere.
fn short_profile(layer: &Layer, surface: &Surface, excitation: &[Phase]) -> Option<String> {
    let level = surface.z.iter().all(|&z| z == surface.z[0]);
    let (&from, &to) = (surface.x.first()?, surface.x.last()?);
    let carrier = carrier_reach(excitation);
    let low = layer.place(0) + carrier.low;
    let high = layer.place(layer.masses.saturating_sub(1)) + carrier.high;
    let inside = from <= low && high <= to;
    let told = !(surface.periodic || level || inside);
    told.then(|| {
        format!(
            "the profile reaches from {from:?} m to {to:?} m, but the layer moves from {low:?} m to {high:?} m: \
             beyond its ends the profile goes on straight, along its end tangents"
        )
    })
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
        start = if phase.until_force.is_some() { during } else { start.plus(Reach { low: end, high: end }) };
    }
    whole
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
