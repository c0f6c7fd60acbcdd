//! The settings of a scene: the integrator's, what a run puts out, what its FMU says of itself.

use serde::Serialize;

use super::values::Word;

/// The integrator's settings. What a scene leaves out is said by the table of keys: the default here is no tolerance.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Solver {
    /// How mode changes are treated.
    pub method: Method,
    /// Relative tolerance of the local error, 1.
    pub relative_tolerance: f64,
    /// Absolute tolerance, m; `None` follows the relative tolerance and the scene's height.
    pub absolute_tolerance: Option<f64>,
    /// The most steps of one communication step or one phase; `None`: [`DEFAULT_MAX_STEPS`](Self::DEFAULT_MAX_STEPS).
    #[serde(serialize_with = "most_steps")]
    pub max_steps: Option<u64>,
    /// Bound on the error of a link's force for leaving Maxwell elements out, as a share of it; 0 leaves none out.
    pub reduce: f64,
}

impl Solver {
    /// The most steps where a scene names no other number.
    pub const DEFAULT_MAX_STEPS: u64 = 10_000_000;

    /// The most steps of one communication step or one phase: as it was set, or the default.
    pub fn max_steps(&self) -> u64 {
        self.max_steps.unwrap_or(Self::DEFAULT_MAX_STEPS)
    }
}

/// Written is the number that counts: fingerprints of sweeps do not depend on whether it is the default.
fn most_steps<S: serde::Serializer>(named: &Option<u64>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_u64(named.unwrap_or(Solver::DEFAULT_MAX_STEPS))
}

/// How mode changes are treated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Every mode change is located.
    #[default]
    Event,
    /// Mode changes are taken at the ends of the steps.
    Step,
    /// Located while there are few in a step; taken at the ends of the steps where there are many.
    Auto,
}

impl Word for Method {
    const WORDS: &'static [(&'static str, Self)] =
        &[("event", Self::Event), ("step", Self::Step), ("auto", Self::Auto)];
}

/// How the carrier moves when a master gives values alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Extrapolation {
    /// At the rate of the communication step before.
    #[default]
    Linear,
    /// To the value given, reached at the end of the communication step.
    Hold,
}

impl Word for Extrapolation {
    const WORDS: &'static [(&'static str, Self)] = &[("linear", Self::Linear), ("hold", Self::Hold)];
}

impl Extrapolation {
    /// The word for it in a scene file.
    pub fn word(self) -> &'static str {
        self.as_word()
    }
}

/// How inputs go on where a master gives values alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct InputRule {
    /// Within a communication step.
    pub extrapolation: Extrapolation,
    /// How far apart a master's new values come, s: each is gone to over that time, a delay of as much. 0: they come with
    /// every step.
    #[serde(rename = "input_interval")]
    pub interval: f64,
}

impl InputRule {
    /// Whether inputs go to values that have not come yet.
    pub fn extrapolates(&self) -> bool {
        self.interval == 0.0 && self.extrapolation == Extrapolation::Linear
    }
}

/// The groups of output variables that a scene may ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum OutputGroup {
    /// F_x, F_z.
    Forces,
    /// Motion of a carrier that is a body, and the force of its drive.
    Carrier,
    /// Dissipated power and energy, whole and by channel.
    Dissipation,
    /// The tangential force split at the surface.
    Friction,
    /// Counts and contact forces.
    Contact,
    /// The energy balance.
    Energy,
    /// Change of the forces with the carrier's targets, for masters that iterate.
    Tangent,
    /// Steps, events, estimated error, processor time.
    Solver,
    /// Position, forces and mode of each mass.
    Elements,
}

impl Word for OutputGroup {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("forces", Self::Forces),
        ("carrier", Self::Carrier),
        ("dissipation", Self::Dissipation),
        ("friction", Self::Friction),
        ("contact", Self::Contact),
        ("energy", Self::Energy),
        ("tangent", Self::Tangent),
        ("solver", Self::Solver),
        ("elements", Self::Elements),
    ];
}

impl OutputGroup {
    /// The group's name in a scene file.
    pub fn word(self) -> &'static str {
        self.as_word()
    }

    /// All groups, in the order of the variables.
    pub const ALL: [Self; 9] = [
        Self::Forces,
        Self::Carrier,
        Self::Dissipation,
        Self::Friction,
        Self::Contact,
        Self::Energy,
        Self::Tangent,
        Self::Solver,
        Self::Elements,
    ];
}

/// `[fmu]` without the groups of outputs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FmuOptions {
    /// The type of outputs that are whole numbers.
    pub integers: IntegerType,
    /// The dependencies of outputs on inputs.
    pub dependencies: DependencyList,
}

/// The type of outputs that are whole numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum IntegerType {
    /// Integer.
    #[default]
    Integer,
    /// Real.
    Real,
}

impl Word for IntegerType {
    const WORDS: &'static [(&'static str, Self)] = &[("integer", Self::Integer), ("real", Self::Real)];
}

/// Which dependencies of outputs on inputs the model description lists.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DependencyList {
    /// Those with all states held, which directional derivatives go with.
    #[default]
    Direct,
    /// None: outputs change with steps alone.
    None,
}

impl Word for DependencyList {
    const WORDS: &'static [(&'static str, Self)] = &[("direct", Self::Direct), ("none", Self::None)];
}
