//! How a contact warms by its own friction.

use asperity::model::{FlashKernel, FrictionLaw, SlipHistory};
use asperity::scene::Scene;

/// What friction has done to a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct WarmedContact {
    /// The rise of its temperature, K.
    pub(super) rise: f64,
    /// T/F_N at its start.
    pub(super) cold: f64,
    /// T/F_N at its end.
    pub(super) warm: f64,
}

/// A contact that its own friction warms.
pub(super) struct Heating {
    law: FrictionLaw,
    kernel: FlashKernel,
    /// A, m².
    area: f64,
}

impl Heating {
    /// `None` where friction heats nothing.
    pub(super) fn new(scene: &Scene, area: f64) -> Option<Self> {
        Some(Self { law: FrictionLaw::new(scene), kernel: FlashKernel::new(scene)?, area })
    }

    /// T/F_N under a pressure (Pa) at a speed (m/s), `rise` (K) above the layer's temperature.
    fn friction(&self, pressure: f64, speed: f64, rise: f64) -> f64 {
        let normal = pressure * self.area;
        self.law.slip(normal, speed, &SlipHistory::even(rise)).force() / normal
    }

    /// After a contact of a length (m).
    ///
    /// The terms of the kernel are integrated exactly for the mean of the power at both ends of a step, which follows
    /// the temperature.
    pub(super) fn after(&self, length: f64, pressure: f64, speed: f64) -> WarmedContact {
        const STEPS: usize = 1000;
        const ITERATIONS: usize = 3;
        let step = length / speed / STEPS as f64;
        let decays: Vec<f64> = self.kernel.terms.iter().map(|term| (-step / term.time).exp()).collect();
        let step_rise = self.kernel.rise(step);
        let cold = self.friction(pressure, speed, 0.0);
        let (mut parts, mut rise, mut friction) = (vec![0.0; decays.len()], 0.0, cold);
        for _ in 0..STEPS {
            let decayed: f64 = parts.iter().zip(&decays).map(|(part, decay)| part * decay).sum();
            let (mut power, mut after) = (friction * pressure * speed, friction);
            for _ in 0..ITERATIONS {
                rise = decayed + power * step_rise;
                after = self.friction(pressure, speed, rise);
                power = 0.5 * (friction + after) * pressure * speed;
            }
            for ((part, decay), term) in parts.iter_mut().zip(&decays).zip(&self.kernel.terms) {
                *part = *part * decay + power * term.weight * term.time * (1.0 - decay);
            }
            rise = parts.iter().sum();
            friction = after;
        }
        WarmedContact { rise, cold, warm: self.friction(pressure, speed, rise) }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
pub(super) mod tests {
    use super::*;

    const SCENE: &str = "name = 'w'\n\
        layer = { masses = 8, spacing = 1e-4, width = 0.01, foundation = 'half_space' }\n\
        surface = { kind = 'flat', fine = { hurst = 0.8, rms_slope = 0.9, longest = 4e-4, shortest = 4e-6 } }\n\
        friction = { shear_strength = 1e6 }\n\
        [material]\ndensity = 1100.0\npoisson_ratio = 0.5\nequilibrium_modulus = 3e6\n\
        prony = [{ modulus = 8e6, relaxation_time = 1e-3 }, { modulus = 1e8, relaxation_time = 1e-6 }]\n\
        wlf = { c1 = 7.5, c2 = 120.0, reference_temperature = 293.15, temperature = 303.15 }\n\
        heat = { conductivity = 0.25, capacity = 1700.0 }\n";

    pub(in crate::summary) fn scene(edit: impl Fn(String) -> String) -> Scene {
        Scene::parse(&edit(SCENE.into()), "w.toml".as_ref()).unwrap()
    }

    fn heating(scene: &Scene) -> Heating {
        Heating::new(scene, scene.layer.element_area().unwrap()).unwrap()
    }

    /// Friction that does not depend on the temperature warms as the kernel's rise says.
    #[test]
    fn constant_friction_warms_by_the_rise_of_the_kernel() {
        let heating = heating(&scene(|text| {
            text.replace("shortest = 4e-6", "shortest = 4e-6, hysteresis = false")
                .replace("shear_strength = 1e6", "coulomb = 0.5")
        }));
        let WarmedContact { rise, cold, warm } = heating.after(1e-3, 1e6, 2.0);
        let exact = 0.5 * 1e6 * 2.0 * heating.kernel.rise(1e-3 / 2.0);
        assert!((rise / exact - 1.0).abs() < 1e-9 && cold == 0.5 && warm == 0.5, "{rise} {exact} {cold} {warm}");
    }

    /// Friction and temperature are those of a step that is ten times as long within the order of the rule.
    #[test]
    fn friction_follows_the_temperature() {
        let heating = heating(&scene(|text| text));
        let WarmedContact { rise, cold, warm } = heating.after(1e-3, 1e6, 1.0);
        let bounds = [cold, warm].map(|friction| friction * 1e6 * heating.kernel.rise(1e-3));
        assert!(warm < cold && bounds[1] < rise && rise < bounds[0], "{rise} in {bounds:?}, {cold} to {warm}");
    }
}
