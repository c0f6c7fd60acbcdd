//! The carrier's motion, why a run may not be able to follow it or not converge, and what it records on the way.

use std::fmt;
use std::sync::Arc;

use crate::math::NotEnoughMemory;
use crate::scene::{Force, LARGEST, ParameterError, Path, Phase, Scene, is_possible};

pub use crate::scene::Motion;

/// The carrier at the start of a run. Along the axis of a body the displacements and speeds are those of its drive; where the
/// body starts, and how fast, is the scene's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Start {
    /// Time t_0, s.
    pub time: f64,
    /// Displacement along x, m.
    pub u: f64,
    /// Displacement along z, m; negative presses.
    pub w: f64,
    /// u̇ just after the start, m/s: the velocity that the layer starts with.
    pub u_rate: f64,
    /// ẇ just after the start, m/s.
    pub w_rate: f64,
    /// Load on a body along z without its constant part, N.
    pub load: f64,
    /// Tangential force on a body along x without its constant part, N.
    pub pull: f64,
    /// The layer's temperature, K, where it is an input; `None`: the material's.
    pub temperature: Option<f64>,
}

/// The carrier's motion is not a number, or larger than [`LARGEST`].
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the carrier's motion is out of range: {what} = {value:?}, expected a number up to ±{LARGEST:?}")]
pub struct OutOfRange {
    /// Which quantity.
    pub what: &'static str,
    /// Its value.
    pub value: f64,
}

/// Why a run could not go on; the simulation is as it was before the call.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SimulationError {
    /// The steps allowed were used up.
    #[error("gave up at t = {time} s after {steps} steps, the limit solver.max_steps")]
    TooManySteps {
        /// The time reached, s.
        time: f64,
        /// The limit.
        steps: u64,
    },
    /// The steps times masses allowed were used up.
    #[error(
        "gave up at t = {time} s after {steps} steps, as much work as solver.max_steps allows unless it is set: do shorter \
         communication steps or set it"
    )]
    TooMuchWork {
        /// The time reached, s.
        time: f64,
        /// How many steps were tried.
        steps: u64,
    },
    /// The step size fell to the resolution of time.
    #[error("the step size fell to {step} s at t = {time} s")]
    StepTooSmall {
        /// The time reached, s.
        time: f64,
        /// The step size, s.
        step: f64,
    },
    /// The layer's surface folded.
    #[error(
        "masses {mass} and {} came within a fifth of their distance at rest at t = {time} s: the layer is pressed so hard, or \
         its profile is so steep, that its surface folds; layer.kinematics = \"material\" does not see it", mass + 1
    )]
    Folded {
        /// The time reached, s.
        time: f64,
        /// The first of the two masses, from 1.
        mass: usize,
    },
    /// It was stopped from outside.
    #[error("interrupted at t = {time} s")]
    Interrupted {
        /// The time reached, s.
        time: f64,
    },
    /// The carrier's motion is out of range.
    #[error(transparent)]
    OutOfRange(#[from] OutOfRange),
    /// Parameters that do not go together, as [`Scene::check`](Scene::check) finds.
    #[error(transparent)]
    Scene(#[from] ParameterError),
    /// The machine does not have the memory for it.
    #[error(transparent)]
    Memory(#[from] NotEnoughMemory),
}

/// A mode change of one mass.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeChange {
    /// When, s.
    pub time: f64,
    /// Which mass, from 0.
    pub mass: usize,
    /// Mode before: 0 free, 1 or -1 slipping, 2 sticking.
    pub from: i8,
    /// Mode after.
    pub to: i8,
}

/// A switch to the other method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MethodSwitch {
    /// When, s.
    pub time: f64,
    /// To time-stepping, or back to events.
    pub to_time_stepping: bool,
    /// The mean number of mode changes per time step that decided it.
    pub mode_changes_per_step: f64,
}

impl fmt::Display for MethodSwitch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { time, to_time_stepping, mode_changes_per_step } = self;
        let method = if *to_time_stepping { "time-stepping" } else { "event-driven" };
        write!(f, "t = {time} s: {method} from here on; mode changes per time step: {mode_changes_per_step:.2}")
    }
}

/// What shows that a run is far less accurate than its tolerance asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Inaccuracy {
    /// It and a more accurate one do not converge: they differ by far more than the tolerance, and their modes changed
    /// differently often, as where stick and slip get out of step.
    Divergence {
        /// The estimated error of the forces, over their largest values.
        error: f64,
        /// The relative tolerance.
        tolerance: f64,
        /// Number of mode changes of the run and of the more accurate one.
        mode_changes: [u64; 2],
    },
    /// The estimated error of the forces is a large part of them.
    Forces {
        /// It, over the largest values of the forces.
        error: f64,
    },
    /// The energy balance does not close.
    Energy {
        /// Its residual over the largest of the energies.
        residual: f64,
        /// The relative tolerance.
        tolerance: f64,
    },
}

impl fmt::Display for Inaccuracy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Divergence { error, tolerance, mode_changes: [run, finer] } => write!(
                f,
                "solver.error = {error:.1e} is {:.0} relative tolerances, and a more accurate run has {finer} mode changes, \
                 not {run}: the two do not converge, a lower tolerance need not give a smaller error",
                error / tolerance
            ),
            Self::Forces { error } => {
                write!(f, "solver.error = {error:.1e}: a more accurate run has other forces; try a lower tolerance")
            }
            Self::Energy { residual, tolerance } => write!(
                f,
                "the energy balance is off by {residual:.1e} of the largest energy, {:.0} relative tolerances; try a lower \
                 tolerance or another method",
                residual / tolerance
            ),
        }
    }
}

impl Start {
    /// The start of a run along the excitation of `scene`, moving as its first phase begins.
    pub fn of(scene: &Scene) -> Self {
        let first = scene.excitation.first();
        let speed = |path: fn(&Phase) -> Path| first.map_or(0.0, |phase| path(phase).at(0.0).speed);
        Self {
            u_rate: speed(|phase| phase.u),
            w_rate: speed(|phase| phase.w),
            load: scene.first_load(),
            pull: scene.first_pull(),
            temperature: first.and_then(|phase| phase.temperature),
            ..Self::default()
        }
    }

    /// Refuses a start that is not finite, or too large.
    pub(crate) fn check(&self) -> Result<(), OutOfRange> {
        check_size(&[
            ("time", self.time),
            ("u", self.u),
            ("w", self.w),
            ("rate of u", self.u_rate),
            ("rate of w", self.w_rate),
            ("load", self.load),
            ("pull", self.pull),
        ])
    }
}

impl Motion {
    /// A carrier at rest, for no time; loads stay what they have reached.
    pub const REST: Self = {
        let still = Path { rate: 0.0, amplitude: 0.0, frequency: 0.0 };
        let held = Force { start: None, change: still };
        Self { duration: 0.0, u: still, w: still, load: held, pull: held, temperature: None }
    };

    pub(super) fn check(&self) -> Result<(), OutOfRange> {
        check_size(&[
            ("duration", self.duration),
            ("rate of u", self.u.rate),
            ("amplitude of u", self.u.amplitude),
            ("frequency of u", self.u.frequency),
            ("rate of w", self.w.rate),
            ("amplitude of w", self.w.amplitude),
            ("frequency of w", self.w.frequency),
            ("load", self.load.start.unwrap_or(0.0)),
            ("rate of the load", self.load.change.rate),
            ("amplitude of the load", self.load.change.amplitude),
            ("frequency of the load", self.load.change.frequency),
            ("pull", self.pull.start.unwrap_or(0.0)),
            ("rate of the pull", self.pull.change.rate),
            ("amplitude of the pull", self.pull.change.amplitude),
            ("frequency of the pull", self.pull.change.frequency),
        ])
    }
}

fn check_size(quantities: &[(&'static str, f64)]) -> Result<(), OutOfRange> {
    match quantities.iter().find(|(_, value)| !is_possible(*value)) {
        Some(&(what, value)) => Err(OutOfRange { what, value }),
        None => Ok(()),
    }
}

/// Asked before each step of a run whether it is to stop. Copies ask the same.
#[derive(Clone)]
pub struct Interrupt(Arc<dyn Fn() -> bool + Send + Sync>);

impl Interrupt {
    /// Stops where `is_wanted` says so, which is called often: it has to be quick.
    pub fn new(is_wanted: impl Fn() -> bool + Send + Sync + 'static) -> Self {
        Self(Arc::new(is_wanted))
    }

    /// Whether to stop now.
    pub fn is_wanted(&self) -> bool {
        (self.0)()
    }
}

impl fmt::Debug for Interrupt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Interrupt")
    }
}
