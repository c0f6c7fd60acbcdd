//! What of a scene is scaled by powers of ten.

use asperity::scene::{Parameter, ParameterError, Path, Phase, Scene, Value};

/// What is scaled by powers of ten.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ScaledQuantity {
    /// Every spring of every link, those of Maxwell elements too.
    Stiffness,
    /// The point masses.
    Mass,
    /// Every τ_j.
    RelaxationTimes,
    /// The speed at which the carrier follows its path.
    Speed,
    /// The mass of a carrier that is a body.
    CarrierMass,
    /// The springs and dampers from a body to its drives.
    Drive,
    /// The load on a body along z.
    Load,
    /// The communication step of a master.
    CommunicationStep,
}

impl ScaledQuantity {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Stiffness,
        Self::Mass,
        Self::RelaxationTimes,
        Self::Speed,
        Self::CarrierMass,
        Self::Drive,
        Self::Load,
        Self::CommunicationStep,
    ];

    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stiffness => "stiffness",
            Self::Mass => "mass",
            Self::RelaxationTimes => "relaxation times",
            Self::Speed => "speed",
            Self::CarrierMass => "carrier mass",
            Self::Drive => "drive",
            Self::Load => "load",
            Self::CommunicationStep => "communication step",
        }
    }

    /// Those that `scene` has.
    pub fn all_of(scene: &Scene) -> Vec<Self> {
        let parameters = scene.parameters();
        let moves = |path: &Path| path.rate != 0.0 || path.amplitude * path.frequency != 0.0;
        let is_there = |quantity: &Self| match quantity {
            Self::Stiffness | Self::Mass | Self::RelaxationTimes | Self::CarrierMass | Self::Drive => {
                parameters.iter().any(|&parameter| quantity.includes(parameter))
            }
            Self::Load => scene.carrier.z.is_some(),
            Self::Speed => scene.excitation.iter().any(|phase| moves(&phase.u) || moves(&phase.w)),
            Self::CommunicationStep => true,
        };
        Self::ALL.into_iter().filter(is_there).collect()
    }

    /// Whether a parameter of the scene is scaled with it.
    fn includes(self, parameter: Parameter) -> bool {
        let path = parameter.path();
        let is = |table: &str, name: &str| path.starts_with(table) && path.ends_with(name);
        match self {
            Self::Stiffness => {
                is("layer.", ".stiffness")
                    || ["material.equilibrium_modulus", "material.prony[].modulus"].contains(&path)
            }
            Self::Mass => ["layer.mass", "material.density"].contains(&path),
            Self::RelaxationTimes => path.ends_with("[].relaxation_time"),
            Self::CarrierMass => is("carrier.", ".mass"),
            Self::Drive => is("carrier.", ".stiffness") || is("carrier.", ".damping"),
            Self::Load => path == "carrier.z.load",
            Self::Speed | Self::CommunicationStep => false,
        }
    }

    /// Scales it in `scene` by `factor`; the communication step is not part of a scene.
    ///
    /// # Errors
    /// A parameter that is out of range.
    pub fn scale(self, scene: &mut Scene, factor: f64) -> Result<(), ParameterError> {
        if self == Self::Speed {
            scene.excitation.iter_mut().for_each(|phase| hasten(phase, factor));
        }
        if self == Self::Load {
            let loads = scene.excitation.iter_mut().flat_map(|phase| phase.load.iter_mut().chain(&mut phase.pressure));
            loads.for_each(|load| *load = load.times(factor));
        }
        let parameters = scene.parameters().into_iter().filter(|&parameter| self.includes(parameter));
        parameters.into_iter().try_for_each(|parameter| match scene.parameter(parameter) {
            Value::Real(value) => scene.set_parameter(parameter, Value::Real(value * factor)),
            _ => Ok(()),
        })
    }
}

/// Follows the path of a phase so many times as fast.
fn hasten(phase: &mut Phase, factor: f64) {
    phase.duration /= factor;
    let forces = phase.load.iter_mut().chain(&mut phase.pull).chain(&mut phase.pressure);
    for path in [&mut phase.u, &mut phase.w].into_iter().chain(forces.map(|force| &mut force.change)) {
        path.rate *= factor;
        path.frequency *= factor;
    }
}

/// The powers of ten by which quantities are scaled; by default the scene as it is, without a master.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Perturbation {
    /// The powers of the scene's own quantities, in the order of [`ScaledQuantity::ALL`].
    powers: [i32; 7],
    communication: Option<i32>,
}

impl Perturbation {
    /// This perturbation with one more quantity scaled.
    #[must_use]
    pub fn with(mut self, quantity: ScaledQuantity, power: i32) -> Self {
        match quantity {
            ScaledQuantity::CommunicationStep => self.communication = Some(power),
            _ => self.powers[quantity as usize] = power,
        }
        self
    }

    /// The power of ten of a quantity; `None` for the communication step where there is no master.
    pub fn power(&self, quantity: ScaledQuantity) -> Option<i32> {
        match quantity {
            ScaledQuantity::CommunicationStep => self.communication,
            _ => Some(self.powers[quantity as usize]),
        }
    }

    /// The factor of a quantity.
    pub fn factor(&self, quantity: ScaledQuantity) -> Option<f64> {
        self.power(quantity).map(factor)
    }

    /// The perturbed scene; the communication step is not part of it.
    ///
    /// # Errors
    /// A parameter that is out of range.
    pub fn apply(&self, scene: &Scene) -> Result<Scene, ParameterError> {
        let mut scene = scene.clone();
        for quantity in ScaledQuantity::ALL.into_iter().filter(|quantity| self.power(*quantity) != Some(0)) {
            quantity.scale(&mut scene, self.factor(quantity).unwrap_or(1.0))?;
        }
        scene.check()?;
        Ok(scene)
    }
}

/// A power of ten: the number nearest to it as it is written: 1e-5, not the fifth power of a rounded tenth.
pub fn factor(power: i32) -> f64 {
    format!("1e{power}").parse().unwrap_or(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "
name = 'pressed'
[layer]
masses = 2
spacing = 1e-4
mass = 1e-7
[layer.vertical]
stiffness = 1e3
damping = 1e-3
maxwell = [{ stiffness = 5e2, relaxation_time = 1e-4 }]
[layer.lateral_x]
stiffness = 2e3
[surface]
kind = 'flat'
[[excitation]]
duration = 1e-3
w_rate = -0.01
u_sine = { amplitude = 1e-5, frequency = 100.0 }
";

    fn scene(text: &str) -> Scene {
        Scene::parse(text, "scene.toml".as_ref()).unwrap()
    }

    #[test]
    fn every_stiffness_is_scaled_and_nothing_else() {
        let stiff = Perturbation::default().with(ScaledQuantity::Stiffness, 3).apply(&scene(TEXT)).unwrap();
        let by_hand = TEXT.replace("stiffness = 1e3", "stiffness = 1e6").replace("stiffness = 5e2", "stiffness = 5e5");
        assert_eq!(stiff, scene(&by_hand.replace("stiffness = 2e3", "stiffness = 2e6")));
    }

    #[test]
    fn of_a_material_moduli_density_and_times_are_scaled() {
        let text = "name = 'rubber'
[layer]
masses = 2
spacing = 1e-4
thickness = 1e-3
width = 1e-2
[material]
density = 1100.0
poisson_ratio = 0.49
equilibrium_modulus = 2e6
prony = [{ modulus = 5e6, relaxation_time = 1e-4 }]
[surface]
kind = 'flat'";
        let rubber = scene(text);
        let scaled = |quantity| Perturbation::default().with(quantity, 1).apply(&rubber).unwrap();
        let stiff = text.replace("= 2e6", "= 2e7").replace("modulus = 5e6", "modulus = 5e7");
        assert_eq!(scaled(ScaledQuantity::Stiffness), scene(&stiff));
        assert_eq!(scaled(ScaledQuantity::Mass), scene(&text.replace("1100.0", "11000.0")));
        assert_eq!(scaled(ScaledQuantity::RelaxationTimes), scene(&text.replace("= 1e-4 }", "= 1e-3 }")));
    }

    #[test]
    fn the_path_is_the_same_at_any_speed() {
        let fast = Perturbation::default().with(ScaledQuantity::Speed, 2).apply(&scene(TEXT)).unwrap();
        let (slow, fast) = (&scene(TEXT).excitation[0], &fast.excitation[0]);
        assert_eq!((fast.duration, fast.w.rate, fast.u.frequency), (1e-5, -1.0, 1e4));
        for share in [0.0, 0.3, 1.0] {
            let far = |phase: &Phase| [phase.u, phase.w].map(|path| path.at(share * phase.duration).position);
            for (a, b) in far(slow).iter().zip(far(fast)) {
                assert!((a - b).abs() <= 1e-12 * a.abs(), "{a:e}, {b:e}");
            }
        }
    }

    #[test]
    fn what_a_scene_does_not_have_is_not_scaled() {
        use ScaledQuantity::{CommunicationStep, Mass, RelaxationTimes, Speed, Stiffness};
        let prescribed = [Stiffness, Mass, RelaxationTimes, Speed, CommunicationStep];
        assert_eq!(ScaledQuantity::all_of(&scene(TEXT)), prescribed);
        let body = format!("{TEXT}\n[carrier.z]\nmass = 1.0\ndamping = 1.0");
        assert_eq!(ScaledQuantity::all_of(&scene(&body)), ScaledQuantity::ALL);
        let springs = TEXT.replace("maxwell = [{ stiffness = 5e2, relaxation_time = 1e-4 }]", "");
        assert_eq!(ScaledQuantity::all_of(&scene(&springs)), [Stiffness, Mass, Speed, CommunicationStep]);
        let at_rest = TEXT.replace("w_rate = -0.01", "").replace("u_sine", "# u_sine");
        assert_eq!(ScaledQuantity::all_of(&scene(&at_rest)), [Stiffness, Mass, RelaxationTimes, CommunicationStep]);
    }

    #[test]
    fn a_parameter_out_of_range_is_an_error() {
        let light = Perturbation::default().with(ScaledQuantity::Mass, -330);
        assert!(light.apply(&scene(TEXT)).unwrap_err().to_string().contains("layer.mass"));
    }
}
