//! What is scaled, and where a cell lies.

use asperity::scene::{Parameter, ParameterError, Path, Phase, Scene, Value};

use super::drive::Course;

/// What is scaled by powers of ten.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::program::report) enum Quantity {
    /// Every spring of every link, those of Maxwell elements too.
    Stiffness,
    /// The point masses.
    Mass,
    /// Every τ_j.
    RelaxationTimes,
    /// How fast the carrier follows its path.
    Speed,
    /// The communication step of a master.
    CommunicationStep,
}

impl Quantity {
    /// All of them, in the order of the page.
    pub(in crate::program::report) const ALL: [Self; 5] =
        [Self::Stiffness, Self::Mass, Self::RelaxationTimes, Self::Speed, Self::CommunicationStep];

    /// In the words of the page.
    pub(in crate::program::report) fn name(self) -> &'static str {
        match self {
            Self::Stiffness => "stiffness",
            Self::Mass => "mass",
            Self::RelaxationTimes => "relaxation times",
            Self::Speed => "speed",
            Self::CommunicationStep => "communication step",
        }
    }

    /// Those that the scene has.
    pub(super) fn of(scene: &Scene) -> Vec<Self> {
        let parameters = scene.parameters();
        let is_there = |quantity: &Self| match quantity {
            Self::Stiffness | Self::Mass | Self::RelaxationTimes => {
                parameters.iter().any(|&parameter| quantity.is_of(parameter))
            }
            Self::Speed => scene.excitation.iter().any(|phase| moves(&phase.u) || moves(&phase.w)),
            Self::CommunicationStep => true,
        };
        Self::ALL.into_iter().filter(is_there).collect()
    }

    /// Whether a parameter of the scene is scaled with it.
    fn is_of(self, parameter: Parameter) -> bool {
        match self {
            Self::Stiffness => matches!(
                parameter,
                Parameter::Stiffness(_)
                    | Parameter::MaxwellStiffness(..)
                    | Parameter::EquilibriumModulus
                    | Parameter::PronyModulus(_)
            ),
            Self::Mass => matches!(parameter, Parameter::Mass | Parameter::Density),
            Self::RelaxationTimes => {
                matches!(parameter, Parameter::RelaxationTime(..) | Parameter::PronyRelaxationTime(_))
            }
            Self::Speed | Self::CommunicationStep => false,
        }
    }

    /// Scales it in the scene; the communication step is none of the scene's.
    fn scale(self, scene: &mut Scene, factor: f64) -> Result<(), ParameterError> {
        if self == Self::Speed {
            scene.excitation.iter_mut().for_each(|phase| hasten(phase, factor));
        }
        let parameters = scene.parameters().into_iter().filter(|&parameter| self.is_of(parameter));
        parameters.into_iter().try_for_each(|parameter| match scene.parameter(parameter) {
            Value::Real(value) => scene.set_parameter(parameter, Value::Real(value * factor)),
            _ => Ok(()),
        })
    }
}

fn moves(path: &Path) -> bool {
    path.rate != 0.0 || path.amplitude * path.frequency != 0.0
}

/// The same path, so many times as fast.
fn hasten(phase: &mut Phase, factor: f64) {
    phase.duration /= factor;
    for path in [&mut phase.u, &mut phase.w] {
        path.rate *= factor;
        path.frequency *= factor;
    }
}

/// Where a cell lies: the powers of ten by which quantities are scaled. The scene itself, without a master, by default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::program::report) struct Place {
    /// Of the scene's own quantities, in their order.
    powers: [i32; 4],
    /// Of the communication step; `None` without a master.
    communication: Option<i32>,
}

impl Place {
    /// This place with one quantity scaled.
    pub(in crate::program::report) fn with(mut self, quantity: Quantity, power: i32) -> Self {
        match quantity {
            Quantity::CommunicationStep => self.communication = Some(power),
            _ => self.powers[quantity as usize] = power,
        }
        self
    }

    /// The power of ten of a quantity; `None` for the communication step where there is no master.
    pub(in crate::program::report) fn power(&self, quantity: Quantity) -> Option<i32> {
        match quantity {
            Quantity::CommunicationStep => self.communication,
            _ => Some(self.powers[quantity as usize]),
        }
    }

    /// The factor of a quantity.
    pub(in crate::program::report) fn factor(&self, quantity: Quantity) -> Option<f64> {
        self.power(quantity).map(power_of_ten)
    }

    /// The scene here, and how it is run.
    pub(super) fn stress(&self, scene: &Scene, points: u32) -> Result<(Scene, Course), ParameterError> {
        let mut scene = scene.clone();
        for quantity in Quantity::ALL.into_iter().filter(|quantity| self.power(*quantity) != Some(0)) {
            quantity.scale(&mut scene, self.factor(quantity).unwrap_or(1.0))?;
        }
        scene.check()?;
        let course = match self.communication {
            None => Course::Motion { points },
            Some(power) => Course::Steps(power_of_ten(power)),
        };
        Ok((scene, course))
    }
}

/// The number nearest to the power as it is written: 1e-5, not the fifth power of a rounded tenth.
fn power_of_ten(power: i32) -> f64 {
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
        let place = Place::default().with(Quantity::Stiffness, 3);
        let (stiff, course) = place.stress(&scene(TEXT), 7).unwrap();
        let by_hand = TEXT.replace("stiffness = 1e3", "stiffness = 1e6").replace("stiffness = 5e2", "stiffness = 5e5");
        assert_eq!(stiff, scene(&by_hand.replace("stiffness = 2e3", "stiffness = 2e6")));
        assert_eq!(course, Course::Motion { points: 7 });
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
        let at = |quantity| Place::default().with(quantity, 1).stress(&rubber, 1).unwrap().0;
        let stiff = text.replace("= 2e6", "= 2e7").replace("modulus = 5e6", "modulus = 5e7");
        assert_eq!(at(Quantity::Stiffness), scene(&stiff));
        assert_eq!(at(Quantity::Mass), scene(&text.replace("1100.0", "11000.0")));
        assert_eq!(at(Quantity::RelaxationTimes), scene(&text.replace("= 1e-4 }", "= 1e-3 }")));
    }

    #[test]
    fn the_path_stays_the_same_whatever_the_speed() {
        let (fast, _) = Place::default().with(Quantity::Speed, 2).stress(&scene(TEXT), 1).unwrap();
        let (slow, fast) = (&scene(TEXT).excitation[0], &fast.excitation[0]);
        assert_eq!((fast.duration, fast.w.rate, fast.u.frequency), (1e-5, -1.0, 1e4));
        for share in [0.0, 0.3, 1.0] {
            let far = |phase: &Phase| [phase.u, phase.w].map(|path| path.at(share * phase.duration));
            for (a, b) in far(slow).iter().zip(far(fast)) {
                assert!((a - b).abs() <= 1e-12 * a.abs(), "{a:e}, {b:e}");
            }
        }
    }

    #[test]
    fn what_a_scene_does_not_have_is_not_stressed() {
        use Quantity::{CommunicationStep, Mass, RelaxationTimes, Speed, Stiffness};
        assert_eq!(Quantity::of(&scene(TEXT)), Quantity::ALL);
        let springs = TEXT.replace("maxwell = [{ stiffness = 5e2, relaxation_time = 1e-4 }]", "");
        assert_eq!(Quantity::of(&scene(&springs)), [Stiffness, Mass, Speed, CommunicationStep]);
        let at_rest = TEXT.replace("w_rate = -0.01", "").replace("u_sine", "# u_sine");
        assert_eq!(Quantity::of(&scene(&at_rest)), [Stiffness, Mass, RelaxationTimes, CommunicationStep]);
    }

    #[test]
    fn what_is_refused_says_why() {
        let light = Place::default().with(Quantity::Mass, -330);
        assert!(light.stress(&scene(TEXT), 1).unwrap_err().to_string().contains("layer.mass"));
    }
}
