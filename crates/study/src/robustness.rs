//! Robustness of the runs of a scene: one catalogue of perturbations, and one judge of the perturbed runs.
//!
//! A run is judged by a tight run: the same perturbed scene at a far lower tolerance. `asperity report` perturbs a
//! user's scene so, `tests/extreme` its base scenes. How a scene is run is up to them.

use asperity::scene::{Axis, Method, Parameter, ParameterError, Path, Phase, Scene, Value};
use asperity::simulation::SimulationError;

/// A tight run's tolerance is so many times lower.
pub const TIGHTER: f64 = 100.0;
/// Errors up to so many tolerances are kept: the tolerance bounds the error of one step, and these add up.
pub const KEPT: f64 = 10.0;
/// Runs with errors of more tolerances are examined for sensitivity.
pub const NOTABLE: f64 = 100.0;
/// Errors of more tolerances are wrong, ...
pub const WRONG: f64 = 1000.0;
/// ... and so are those of more than this share of the largest force.
const WRONG_SHARE: f64 = 0.1;
/// How far the start is moved to find out whether a motion is sensitive, m: far below what any scene resolves.
pub const DISPLACEMENT: f64 = 1e-12;
/// Two runs have diverged where they differ by more than this share of the largest force: a moved start that does not
/// spread changes some 1e-8, and up to 1e-4 where the layer is stiff against the force.
const DIVERGED: f64 = 1e-3;
/// On a profile so fine that the displacement is no small part of its height: so many times that part.
const OF_HEIGHT: f64 = 100.0;
/// A motion is sensitive where a moved start changes at least this part of the error.
const OF_ERROR: f64 = 0.1;

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
        self.power(quantity).map(power_of_ten)
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

/// The number nearest to the power as it is written: 1e-5, not the fifth power of a rounded tenth.
fn power_of_ten(power: i32) -> f64 {
    format!("1e{power}").parse().unwrap_or(1.0)
}

/// The scene at the relative tolerance `tolerance`; an absolute tolerance of its own is scaled with it.
pub fn at_tolerance(scene: &Scene, tolerance: f64) -> Scene {
    let mut scene = scene.clone();
    let ratio = tolerance / scene.solver.relative_tolerance;
    scene.solver.absolute_tolerance = scene.solver.absolute_tolerance.map(|absolute| absolute * ratio);
    scene.solver.relative_tolerance = tolerance;
    scene
}

/// The scene as a reference runs it: every mode change located, no Maxwell element left out.
pub fn exact(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    (scene.solver.method, scene.solver.reduce) = (Method::Event, 0.0);
    scene
}

/// The difference, as a share of the largest force, above which two runs have diverged whose starts differ by
/// [`DISPLACEMENT`].
pub fn divergence(scene: &Scene) -> f64 {
    (OF_HEIGHT * DISPLACEMENT / scene.height()).max(DIVERGED)
}

/// The most steps that a run may try, rejected ones included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget(pub u64);

impl Budget {
    /// The scene with the budget as its limit, unless its own is lower.
    pub fn limit(self, scene: &Scene) -> Scene {
        let mut scene = scene.clone();
        scene.solver.max_steps = Some(scene.solver.max_steps().min(self.0));
        scene
    }

    /// What an error of a run of [`limit`](Self::limit) means for the scene.
    pub fn failure(self, scene: &Scene, error: &SimulationError) -> RunFailure {
        match error {
            SimulationError::TooManySteps { time, .. } if self.0 <= scene.solver.max_steps() => {
                RunFailure::OverBudget { time: *time }
            }
            error => RunFailure::Stopped(error.to_string()),
        }
    }
}

/// Why a run did not come to its end.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RunFailure {
    /// Its budget was used up.
    #[error("over budget at t = {time:.3e} s")]
    OverBudget {
        /// When, s.
        time: f64,
    },
    /// It stopped with this error.
    #[error("{0}")]
    Stopped(String),
}

/// The forces of a run, row by row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ForceHistory {
    /// Times of the rows, s.
    pub times: Vec<f64>,
    /// F_x and F_z, N.
    pub rows: Vec<[f64; 2]>,
}

/// The largest difference of a force between two runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Over the largest force.
    pub share: f64,
    /// Which of F_x and F_z differs so much.
    pub of: Axis,
    /// When, s.
    pub time: f64,
}

impl ForceHistory {
    /// The largest difference of any of `forces` from a reference that has the same rows, over the largest of these
    /// forces in it.
    pub fn difference(&self, reference: &Self, forces: &[Axis]) -> Difference {
        let all = reference.rows.iter().flat_map(|row| forces.iter().map(|&force| row[force as usize]));
        let largest = all.fold(0.0, |most, force| larger(most, force.abs()));
        let mut found = Difference { share: 0.0, of: Axis::Z, time: reference.times.first().copied().unwrap_or(0.0) };
        for ((row, wanted), &time) in self.rows.iter().zip(&reference.rows).zip(&reference.times) {
            for &of in forces {
                let difference = (row[of as usize] - wanted[of as usize]).abs();
                // NaN is infinitely wrong; two runs without forces are alike.
                let share = if difference == 0.0 { 0.0 } else { larger(0.0, difference / largest) };
                if share > found.share {
                    found = Difference { share, of, time };
                }
            }
        }
        found
    }
}

/// The larger; NaN counts as infinite.
pub fn larger(a: f64, b: f64) -> f64 {
    if b.is_nan() { f64::INFINITY } else { a.max(b) }
}

/// How accurate a run is.
#[derive(Clone, Debug, PartialEq)]
pub enum Accuracy {
    /// It differs so much from the tight run.
    Error(Difference),
    /// It does, but a tight run from a start moved by [`DISPLACEMENT`] differs about as much.
    Sensitive {
        /// The difference from the tight run.
        error: Difference,
        /// What the moved start changes, over the largest force.
        moved: f64,
    },
    /// The tight run did not come to its end, for this reason.
    Unknown(String),
}

impl Accuracy {
    /// Judges a run of `scene` by a tight run. `moved` repeats the tight run from a start moved by [`DISPLACEMENT`]; it
    /// is called only where the error is notable.
    pub fn judge(
        scene: &Scene,
        run: &ForceHistory,
        tight: &ForceHistory,
        moved: impl FnOnce() -> Option<ForceHistory>,
    ) -> Self {
        let error = run.difference(tight, &Axis::ALL);
        if error.share <= NOTABLE * scene.solver.relative_tolerance {
            return Self::Error(error);
        }
        let moved = moved().map_or(0.0, |moved| moved.difference(tight, &Axis::ALL).share);
        let sensitive = moved > divergence(scene).max(OF_ERROR * error.share);
        if sensitive { Self::Sensitive { error, moved } } else { Self::Error(error) }
    }

    /// The difference from the tight run, if there is one.
    pub fn error(&self) -> Option<Difference> {
        match self {
            Self::Error(error) | Self::Sensitive { error, .. } => Some(*error),
            Self::Unknown(_) => None,
        }
    }

    /// What a moved start changes where the motion is sensitive.
    pub fn moved(&self) -> Option<f64> {
        match self {
            Self::Sensitive { moved, .. } => Some(*moved),
            _ => None,
        }
    }

    /// The verdict on a run at this relative tolerance.
    pub fn verdict(&self, tolerance: f64) -> Verdict {
        match self {
            Self::Error(error) => Verdict::from_error(error.share, tolerance),
            Self::Sensitive { .. } => Verdict::Sensitive,
            Self::Unknown(_) => Verdict::Unknown,
        }
    }
}

/// A run at a glance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// An error of at most [`KEPT`] tolerances.
    Kept,
    /// At most [`NOTABLE`].
    Above,
    /// At most [`WRONG`].
    FarAbove,
    /// More.
    Wrong,
    /// Not comparable: a moved start changes about as much.
    Sensitive,
    /// Not comparable: there is no tight run.
    Unknown,
    /// It stopped with an error.
    Stopped,
    /// It needs more than its budget.
    OverBudget,
    /// It was not tried.
    NotTried,
}

impl Verdict {
    /// All of them, in the order of a legend.
    pub const ALL: [Self; 9] = [
        Self::Kept,
        Self::Above,
        Self::FarAbove,
        Self::Wrong,
        Self::Sensitive,
        Self::Unknown,
        Self::Stopped,
        Self::OverBudget,
        Self::NotTried,
    ];

    fn from_error(error: f64, tolerance: f64) -> Self {
        match error {
            error if error <= KEPT * tolerance => Self::Kept,
            error if error > WRONG * tolerance || error > WRONG_SHARE || error.is_nan() => Self::Wrong,
            error if error <= NOTABLE * tolerance => Self::Above,
            _ => Self::FarAbove,
        }
    }

    /// The word for it in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Kept => "kept",
            Self::Above => "above",
            Self::FarAbove => "far above",
            Self::Wrong => "wrong",
            Self::Sensitive => "sensitive",
            Self::Unknown => "unknown",
            Self::Stopped => "stopped",
            Self::OverBudget => "too expensive",
            Self::NotTried => "left out",
        }
    }
}

impl From<&RunFailure> for Verdict {
    fn from(failure: &RunFailure) -> Self {
        match failure {
            RunFailure::OverBudget { .. } => Self::OverBudget,
            RunFailure::Stopped(_) => Self::Stopped,
        }
    }
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

    fn history(rows: &[[f64; 2]]) -> ForceHistory {
        ForceHistory { times: (0..rows.len()).map(|i| i as f64).collect(), rows: rows.to_vec() }
    }

    #[test]
    fn a_difference_is_a_share_of_the_largest_force() {
        let wanted = [[0.0, 1.0], [-4.0, 2.0]];
        let between = |rows: &[[f64; 2]], tight: &[[f64; 2]]| history(rows).difference(&history(tight), &Axis::ALL);
        let found = between(&[[0.0, 1.0], [-4.0, 3.0]], &wanted);
        assert_eq!(found, Difference { share: 0.25, of: Axis::Z, time: 1.0 });
        assert_eq!(history(&[[0.0, 1.0], [-4.0, 3.0]]).difference(&history(&wanted), &[Axis::Z]).share, 0.5);
        assert_eq!(between(&wanted, &wanted).share, 0.0);
        assert_eq!(between(&[[0.0; 2]; 2], &[[0.0; 2]; 2]).share, 0.0);
        assert_eq!(between(&[[1.0, 0.0]], &[[0.0; 2]]).share, f64::INFINITY);
        let nowhere = between(&[[f64::NAN, 1.0], wanted[1]], &wanted);
        assert_eq!(nowhere, Difference { share: f64::INFINITY, of: Axis::X, time: 0.0 });
    }

    #[test]
    fn verdicts_follow_the_tolerance() {
        use Verdict::{Above, FarAbove, Kept, Wrong};
        let verdicts = [9e-6, 9e-5, 9e-4, 1e-2, f64::INFINITY, f64::NAN].map(|error| Verdict::from_error(error, 1e-6));
        assert_eq!(verdicts, [Kept, Above, FarAbove, Wrong, Wrong, Wrong]);
        // A loose tolerance asks for little, but not for nothing.
        assert_eq!([0.05, 0.2].map(|error| Verdict::from_error(error, 1e-2)), [Kept, Wrong]);
        assert_eq!([0.05, 0.2].map(|error| Verdict::from_error(error, 3e-3)), [Above, Wrong]);
    }

    #[test]
    fn an_error_is_sensitive_where_a_moved_start_changes_as_much() {
        let scene = scene(TEXT);
        let judge = |run: f64, moved: f64| {
            let moved = || Some(history(&[[moved, 1.0]]));
            Accuracy::judge(&scene, &history(&[[run, 1.0]]), &history(&[[0.0, 1.0]]), moved)
        };
        let tolerance = scene.solver.relative_tolerance;
        assert_eq!(judge(50.0 * tolerance, 1.0).verdict(tolerance), Verdict::Above);
        assert_eq!(judge(0.5, 0.2).verdict(tolerance), Verdict::Sensitive);
        assert_eq!(judge(0.5, 0.01).verdict(tolerance), Verdict::Wrong);
    }
}
