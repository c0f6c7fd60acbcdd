//! How the surface of rubber warms over the way that it slides.
//!
//! Rubber of one temperature begins to slide. Over the way s = v t its surface warms by
//!
//!   ΔT(t) = ∫_0^t κ(t-t') χ Q(t') dt',   Q = v mean(τ q1)
//!
//! with Q of each place from steady sliding there. The march goes over places even in ln s; Q is linear in t between them, and
//! constant up to the first.

use super::flash::{MOST_STEPS, SurfaceRise, WarmingContact, Warmth};
use super::heat::HeatResponse;

/// The places of a march, and the first of them over the whole way.
const PLACES: usize = 20;
const FIRST: f64 = 1.0e-3;
/// The most steps at a place but the last. At the first, where the surface is still cold, contacts often do not come to rest;
/// what they make there counts little at the end.
const STEPS_ON_THE_WAY: usize = 60;

/// What came before a place: the times (s), and the mean powers there, W/m².
#[derive(Debug, Default)]
struct Past {
    times: Vec<f64>,
    powers: Vec<f64>,
}

impl Past {
    /// How the surface warms up to `time`, after the last of these.
    fn rise(&self, heat: &HeatResponse, time: f64) -> SurfaceRise {
        let (Some(&last), Some(&power)) = (self.times.last(), self.powers.last()) else {
            return SurfaceRise { known: 0.0, gain: heat.rises(time)[0] };
        };
        let twice = |since: f64| heat.rises(time - since)[1];
        let segments = self.times.windows(2).zip(self.powers.windows(2));
        let of_segments = segments.map(|(times, powers)| {
            (powers[1] - powers[0]) / (times[1] - times[0]) * (twice(times[0]) - twice(times[1]))
        });
        let gain = twice(last) / (time - last);
        SurfaceRise { known: self.powers[0] * heat.rises(time)[0] + of_segments.sum::<f64>() - power * gain, gain }
    }
}

/// How warm contacts are after the `way` (m) at the `speed` (m/s), and by how much the whole surface has warmed, K.
pub(super) fn march(warming: &mut WarmingContact<'_>, heat: &HeatResponse, speed: f64, way: f64) -> (Warmth, f64) {
    let (mut past, mut warmth, mut rise) = (Past::default(), warming.cold(), 0.0);
    for place in 0..PLACES {
        let left = 1.0 - place as f64 / (PLACES - 1) as f64;
        let time = way / speed * FIRST.powf(left);
        let surface = past.rise(heat, time);
        let most = if place + 1 == PLACES { MOST_STEPS } else { STEPS_ON_THE_WAY };
        warmth = warming.solve(surface, warmth, most);
        let power = warming.mean_power(&warmth);
        rise = surface.known + surface.gain * power;
        past.times.push(time);
        past.powers.push(power);
    }
    (warmth, rise)
}
