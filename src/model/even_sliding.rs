//! Whether masses slide evenly where friction falls over the speed (docs/foundation.md, section 7).
//!
//! Even sliding at v is stable where m s² + K*(s) + T' r s/(s + r) = 0, r = v/D, has no root with a real part above 0.
//! Within a factor of 0.7 to 1.6 that is D |K*(iv/D)| > v |∂T/∂v|, K* of a link to the carrier: that of the softest wave.

use std::f64::consts::{SQRT_2, TAU};

use libm::erf;

use super::{LinkKind, Model};
use crate::math::bracketed_root;
use crate::scene::{Phase, Scene};

/// Even sliding of the masses of a scene at one speed of its excitation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EvenSliding {
    /// v, m/s.
    pub speed: f64,
    /// The mean normal force of a mass in contact, N.
    pub normal: f64,
    /// The way D over which contacts have to be renewed for it to be stable, m; 0 where it always is.
    pub least_memory: f64,
}

/// Accuracy of the way, as a difference of its logarithm.
const ACCURACY: f64 = 1e-3;
/// The default memory over the way that even sliding takes.
const MARGIN: f64 = 1.2;
/// The ways that are looked at, m.
const WAYS: (f64, f64) = (1e-12, 1e3);

impl Model {
    /// D |K*(iv/D)|, N: what the links of a mass that slides at v = `speed` (m/s) bear of a fall v |∂T/∂v| of its friction
    /// where contacts are renewed over D = `way`, m.
    pub fn bearable_fall(&self, way: f64, speed: f64) -> f64 {
        way * self.dynamic_stiffness(LinkKind::Horizontal, speed / way)
    }

    /// The way over which contacts under F_N (N) have to be renewed so that they slide evenly at `speed` (m/s), m; 0 where
    /// they do without.
    pub fn least_memory(&self, normal: f64, speed: f64) -> f64 {
        let fall = self.friction.fall(normal, speed, 0.0);
        let residual = |log_way: f64| self.bearable_fall(log_way.exp(), speed) - fall;
        let ends = (WAYS.0.ln(), WAYS.1.ln());
        if fall <= 0.0 || residual(ends.0) >= 0.0 {
            return 0.0;
        }
        if residual(ends.1) <= 0.0 { WAYS.1 } else { bracketed_root(residual, ends, ACCURACY).exp() }
    }
}

impl EvenSliding {
    /// At the speeds of the excitation of a scene, ascending, under the mean pressure of its contacts; none where friction
    /// does not depend on the speed.
    pub fn of(scene: &Scene) -> Vec<Self> {
        if !scene.friction_depends_on_speed() {
            return Vec::new();
        }
        let model = Model::new(scene);
        let mut speeds: Vec<f64> = scene.excitation.iter().flat_map(slip_speeds).collect();
        speeds.retain(|&speed| speed > 0.0);
        speeds.sort_by(f64::total_cmp);
        speeds.dedup();
        let mean = mean_force(scene, &model);
        speeds.into_iter().map(|speed| Self::at(scene, &model, speed, mean)).collect()
    }

    /// Of a scene and its `model` at `speed`, m/s, where all masses together have the mean normal force `mean` each, N.
    pub fn at(scene: &Scene, model: &Model, speed: f64, mean: f64) -> Self {
        let normal = contact_force(scene, speed, mean);
        Self { speed, normal, least_memory: model.least_memory(normal, speed) }
    }

    /// Sets the [default memory](Scene::default_memory) of a scene of a material so that its contacts slide evenly at the
    /// speeds of its excitation, and adds the [warning](Self::warning) to those of a scene that says its memory.
    pub fn settle(scene: &mut Scene) {
        if scene.memory_follows() {
            scene.default_memory = Self::default_memory(Self::of(scene));
        } else {
            scene.warnings.extend(Self::warning(scene));
        }
    }

    /// The way D, m, over which contacts of rubber are renewed that a scene says nothing of.
    pub fn default_memory(found: impl IntoIterator<Item = Self>) -> f64 {
        found.into_iter().map(|even| MARGIN * even.least_memory).fold(Scene::DEFAULT_MEMORY, f64::max)
    }

    /// The warning where the contacts of a scene do not slide evenly, at the speed of the excitation at which they do so
    /// least.
    pub fn warning(scene: &Scene) -> Option<String> {
        Self::warning_among(scene, Self::of(scene))
    }

    /// The same among what was found at some speeds.
    pub fn warning_among(scene: &Scene, found: impl IntoIterator<Item = Self>) -> Option<String> {
        let way = scene.memory_way();
        let worst = found.into_iter().max_by(|a, b| a.least_memory.total_cmp(&b.least_memory))?;
        (worst.least_memory > way).then(|| {
            let area = scene.layer.element_area();
            let under = area.map_or_else(String::new, |area| format!(" under {:.2} MPa", 1e-6 * worst.normal / area));
            let ill = if way == 0.0 {
                "friction follows the speed at once, as friction.memory = 0 says: masses stick and slip one by one, and the \
                 mean depends on their spacing"
            } else {
                "the layer sticks and slips there"
            };
            format!(
                "friction falls over the speed: even sliding at {:.3e} m/s{under} is unstable where friction.memory is below \
                 {:.1e} m; {ill}",
                worst.speed, worst.least_memory
            )
        })
    }
}

/// The speeds of a phase along x, m/s.
fn slip_speeds(phase: &Phase) -> [f64; 2] {
    let swing = TAU * phase.u.frequency * phase.u.amplitude;
    [phase.u.rate.abs(), phase.u.rate.abs() + swing.abs()]
}

/// The mean normal force of the masses in contact, N, while a scene slides at `speed` (m/s), of all masses being `mean` (N).
///
/// Under the mean pressure P the contacts of a rough profile bear P/erf(P/(√2 p_rms)), p_rms = |M*| h'/2 being the rms
/// pressure in full contact (B. N. J. Persson, J. Chem. Phys. 115, 2001, 3840, to second order of its distribution), M* at
/// the profile's own wavelength.
fn contact_force(scene: &Scene, speed: f64, mean: f64) -> f64 {
    let (Some(material), Some(area)) = (&scene.material, scene.layer.element_area()) else { return mean };
    let slope = scene.surface.rms_slope();
    if slope <= 0.0 {
        return mean;
    }
    // The wave of this slope from the lowest to the highest point: rms height over rms slope is 1/q.
    let ends = scene.surface.z().iter().fold([f64::MAX, f64::MIN], |[low, high], &z| [low.min(z), high.max(z)]);
    let height = (ends[1] - ends[0]) / (2.0 * SQRT_2);
    let (storage, loss) = material.complex_plane_modulus(speed * slope / height);
    let rms_pressure = 0.5 * storage.hypot(loss) * slope;
    let share = erf(mean / area / (SQRT_2 * rms_pressure));
    if share > 0.0 { mean / share } else { rms_pressure * area }
}

/// The mean normal force of all masses, N: the largest that the excitation says, or that its springs have where the
/// carrier is lowest.
fn mean_force(scene: &Scene, model: &Model) -> f64 {
    let (area, masses) = (scene.layer.area(), model.masses() as f64);
    let of_body = scene.carrier.z.map_or(0.0, |body| body.load.unwrap_or(0.0));
    let (mut said, mut lowest, mut w, mut load) = (0.0_f64, 0.0_f64, 0.0, 0.0);
    for phase in &scene.excitation {
        let force = phase.load(area);
        load = force.start.unwrap_or(load);
        let at_end = load + force.change.change(0.0, phase.duration);
        said = said.max(of_body + load.max(at_end)).max(phase.end_force(area).unwrap_or(0.0));
        load = at_end;
        let reached = w + phase.w.change(0.0, phase.duration);
        lowest = lowest.min(reached - phase.w.amplitude.abs());
        w = reached;
    }
    if said > 0.0 {
        return said / masses;
    }
    let lift = |i: usize| (model.surface_at(model.rest_x[i]).height - model.rest_z[i] - lowest).max(0.0);
    scene.bearing_stiffness() * (0..model.masses()).map(lift).sum::<f64>() / masses
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A fall of friction against a spring and a damper: D |c + iωd| with ω = v/D is √((cD)² + (vd)²).
    #[test]
    fn the_bound_is_that_of_the_link() {
        let text = "name = 'a'
            layer = { masses = 1, spacing = 1.0, mass = 1e-6, horizontal = { stiffness = 1e4, damping = 0.05 },
                      vertical = { stiffness = 1e4 } }
            surface = { kind = 'flat' }
            friction.rate_shear = { force = 1.0, reference_speed = 1e-3, sharpness = 0.1 }";
        let model = Model::from_text(text);
        let speed: f64 = 1.0;
        // T = exp(-c log10²(v/v_0)), so -dT/dln v = 2c log10(v/v_0)/ln 10 T.
        let decades = 3.0;
        let fall = 0.2 * decades / std::f64::consts::LN_10 * (-0.1 * decades * decades).exp();
        let expected = (fall * fall - (0.05 * speed).powi(2)).sqrt() / 1e4;
        let found = model.least_memory(0.0, speed);
        assert!((found / expected - 1.0).abs() < 2.0 * ACCURACY, "{found:e} {expected:e}");
        // Where it rises it needs none.
        assert_eq!(model.least_memory(0.0, 1e-4), 0.0);
    }

    /// A memory that a scene says is used as it is, and warned of where it is too short.
    #[test]
    fn a_memory_that_is_not_said_is_enough_for_even_sliding() {
        let settled = |memory: &str, strength: f64| {
            let text = format!(
                "name = 'a'
                layer = {{ foundation = 'half_space', masses = 16, spacing = 6.25e-5, width = 1e-2 }}
                material = {{ density = 1e3, poisson_ratio = 0.5, equilibrium_modulus = 1e6, prony = [] }}
                surface = {{ kind = 'flat' }}
                friction = {{ {memory} rate_shear = {{ strength = {strength}, reference_speed = 1e-3, sharpness = 0.1 }} }}
                excitation = [{{ duration = 1.0, u_rate = 0.1 }}]"
            );
            let mut scene = Scene::parse(&text, "a.toml".as_ref()).unwrap_or_else(|error| unreachable!("{error}"));
            EvenSliding::settle(&mut scene);
            (EvenSliding::of(&scene)[0].least_memory, scene)
        };
        let (least, scene) = settled("", 5e6);
        assert!(least > Scene::DEFAULT_MEMORY, "{least:e}");
        assert_eq!((scene.memory_way(), scene.warnings.len()), (MARGIN * least, 0));
        let (_, scene) = settled("memory = 6e-5,", 5e6);
        assert_eq!((scene.memory_way(), scene.warnings.len()), (6e-5, 1));
        let (least, scene) = settled("", 5e4);
        assert!(least < Scene::DEFAULT_MEMORY && scene.memory_way() == Scene::DEFAULT_MEMORY, "{least:e}");
    }
}
