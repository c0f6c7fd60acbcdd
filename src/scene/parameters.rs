//! The parameters of a scene by name: what an FMU or `--set` may change before a run.

mod access;
mod by_name;
mod material;
#[cfg(test)]
mod tests;

use std::fmt;

use serde::{Deserialize, Serialize};

pub use material::MaterialParameter;

use super::{Layer, Link, LinkKind, Problem, RateShear, Scene, Unit};

/// One settable number or word of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Parameter {
    /// `layer.clearance`
    Clearance,
    /// `layer.mass`
    Mass,
    /// `layer.initial`
    Initial,
    /// `layer.vertical.stiffness` and so on
    Stiffness(LinkKind),
    /// `layer.vertical.damping` and so on
    Damping(LinkKind),
    /// `layer.vertical.maxwell[1].stiffness` and so on; the element counted from 0
    MaxwellStiffness(LinkKind, usize),
    /// `layer.vertical.maxwell[1].relaxation_time` and so on; the element counted from 0
    RelaxationTime(LinkKind, usize),
    /// `material.density` and so on
    Material(MaterialParameter),
    /// `friction.coulomb`
    Coulomb,
    /// `friction.shear_force`
    ShearForce,
    /// `friction.shear_strength`
    ShearStrength,
    /// `friction.rate_shear.force`
    RateShearForce,
    /// `friction.rate_shear.strength`
    RateShearStrength,
    /// `friction.rate_shear.reference_speed`
    ReferenceSpeed,
    /// `friction.rate_shear.sharpness`
    Sharpness,
    /// `friction.rate_shear.creep_speed`; follows the reference speed until it is set itself
    CreepSpeed,
    /// `solver.method`
    Method,
    /// `solver.relative_tolerance`
    RelativeTolerance,
    /// `solver.absolute_tolerance`; follows the relative one until it is set itself
    AbsoluteTolerance,
    /// `solver.max_steps`
    MaxSteps,
    /// `input.extrapolation`
    Extrapolation,
    /// `table.extrapolation`, of an element from a table
    TableExtrapolation,
}

/// A parameter's value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Value {
    /// A Real of FMI.
    Real(f64),
    /// An Integer of FMI.
    Integer(i32),
    /// A String of FMI.
    Text(String),
}

/// Why a parameter's value, or its name, is refused.
///
/// It reads like `layer.mass = -1.0: expected a number from 1e-30 to 1e30`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", problem.about(name))]
pub struct ParameterError {
    name: String,
    problem: Problem,
}

impl ParameterError {
    /// The error of the parameter called `name`.
    pub(crate) fn new(name: impl Into<String>, problem: Problem) -> Self {
        Self { name: name.into(), problem }
    }

    /// The name of the parameter, as it was given.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What was given and what is allowed.
    pub fn problem(&self) -> &Problem {
        &self.problem
    }
}

impl Layer {
    /// The link of a kind as it is given; in the direct form alone, see [`Scene::link`].
    pub fn link(&self, kind: LinkKind) -> Option<&Link> {
        match kind {
            LinkKind::Vertical => self.vertical.as_ref(),
            LinkKind::Horizontal => self.horizontal.as_ref(),
            LinkKind::LateralX => self.lateral_x.as_ref(),
            LinkKind::LateralZ => self.lateral_z.as_ref(),
        }
    }

    fn link_mut(&mut self, kind: LinkKind) -> Option<&mut Link> {
        match kind {
            LinkKind::Vertical => self.vertical.as_mut(),
            LinkKind::Horizontal => self.horizontal.as_mut(),
            LinkKind::LateralX => self.lateral_x.as_mut(),
            LinkKind::LateralZ => self.lateral_z.as_mut(),
        }
    }
}

impl Parameter {
    /// The key's path, elements of lists counted from 1: `layer.vertical.maxwell[1].stiffness`.
    pub fn name(self) -> String {
        match self {
            Self::Clearance => "layer.clearance".into(),
            Self::Mass => "layer.mass".into(),
            Self::Initial => "layer.initial".into(),
            Self::Stiffness(link) => format!("layer.{}.stiffness", link.name()),
            Self::Damping(link) => format!("layer.{}.damping", link.name()),
            Self::MaxwellStiffness(link, j) => format!("layer.{}.maxwell[{}].stiffness", link.name(), j + 1),
            Self::RelaxationTime(link, j) => format!("layer.{}.maxwell[{}].relaxation_time", link.name(), j + 1),
            Self::Material(parameter) => parameter.name(),
            Self::Coulomb => "friction.coulomb".into(),
            Self::ShearForce => "friction.shear_force".into(),
            Self::ShearStrength => "friction.shear_strength".into(),
            Self::RateShearForce => "friction.rate_shear.force".into(),
            Self::RateShearStrength => "friction.rate_shear.strength".into(),
            Self::ReferenceSpeed => "friction.rate_shear.reference_speed".into(),
            Self::Sharpness => "friction.rate_shear.sharpness".into(),
            Self::CreepSpeed => "friction.rate_shear.creep_speed".into(),
            Self::Method => "solver.method".into(),
            Self::RelativeTolerance => "solver.relative_tolerance".into(),
            Self::AbsoluteTolerance => "solver.absolute_tolerance".into(),
            Self::MaxSteps => "solver.max_steps".into(),
            Self::Extrapolation => "input.extrapolation".into(),
            Self::TableExtrapolation => "table.extrapolation".into(),
        }
    }

    /// The unit of a Real parameter; 1 for the others.
    pub fn unit(self) -> Unit {
        match self {
            Self::Clearance | Self::AbsoluteTolerance => Unit::Meter,
            Self::Mass => Unit::Kilogram,
            Self::Stiffness(_) | Self::MaxwellStiffness(..) => Unit::NewtonPerMeter,
            Self::Damping(_) => Unit::NewtonSecondPerMeter,
            Self::RelaxationTime(..) => Unit::Second,
            Self::Material(parameter) => parameter.unit(),
            Self::ShearForce | Self::RateShearForce => Unit::Newton,
            Self::ShearStrength | Self::RateShearStrength => Unit::Pascal,
            Self::ReferenceSpeed | Self::CreepSpeed => Unit::MeterPerSecond,
            Self::Coulomb | Self::Sharpness | Self::RelativeTolerance => Unit::One,
            Self::Initial | Self::Method | Self::MaxSteps | Self::Extrapolation => Unit::One,
            Self::TableExtrapolation => Unit::One,
        }
    }

    /// What it is, in a few words.
    pub fn description(self) -> String {
        match self {
            Self::Clearance => "Rest height of the layer above the profile's datum at w = 0".into(),
            Self::Mass => "Mass of one point mass".into(),
            Self::Initial => "How the dashpots start: relaxed or undeformed".into(),
            Self::Stiffness(link) => format!("Stiffness of the {}", link.description()),
            Self::Damping(link) => format!("Damping of the {}", link.description()),
            Self::MaxwellStiffness(link, j) => {
                format!("Stiffness of Maxwell element {} of the {}", j + 1, link.description())
            }
            Self::RelaxationTime(link, j) => {
                format!("Relaxation time of Maxwell element {} of the {}", j + 1, link.description())
            }
            Self::Material(parameter) => parameter.description(),
            Self::Coulomb => "Coulomb's friction coefficient".into(),
            Self::ShearForce => "Adhesive shear force of one mass in contact".into(),
            Self::ShearStrength => "Adhesive shear strength of the contact".into(),
            Self::RateShearForce => "Largest rate-dependent shear force of one mass in contact".into(),
            Self::RateShearStrength => "Largest rate-dependent shear strength of the contact".into(),
            Self::ReferenceSpeed => "Speed at which the rate-dependent shear force is largest".into(),
            Self::Sharpness => "How sharply the rate-dependent shear force falls about its largest, with the squared decades of \
                 the speed"
                .into(),
            Self::CreepSpeed => "Speed below which the rate-dependent shear force is held; follows the reference speed until it \
                 is set itself"
                .into(),
            Self::Method => "How mode changes are treated: event locates every one, step puts them at the ends of its steps, auto takes step \
                 where they crowd"
                .into(),
            Self::RelativeTolerance => "Relative tolerance of the local error".into(),
            Self::AbsoluteTolerance => {
                "Absolute tolerance of places; follows the relative one until it is set itself".into()
            }
            Self::MaxSteps => "Steps that one communication step or one phase may take".into(),
            Self::Extrapolation => "How the carrier moves when no rates are given: linear or hold".into(),
            Self::TableExtrapolation => "What happens beyond the table's pressures and speeds: refuse, or hold its ends' \
                 friction coefficients and stiffnesses"
                .into(),
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Real(number) => write!(f, "{number:?}"),
            Self::Integer(number) => write!(f, "{number}"),
            Self::Text(word) => write!(f, "{word:?}"),
        }
    }
}

impl Scene {
    /// The parameters that this scene has, in the order of the scene's keys.
    pub fn parameters(&self) -> Vec<Parameter> {
        use Parameter::{AbsoluteTolerance, Extrapolation, MaxSteps, Method, RelativeTolerance};
        let mut parameters = vec![Parameter::Clearance];
        parameters.extend(self.layer.mass.map(|_| Parameter::Mass));
        parameters.push(Parameter::Initial);
        for kind in LinkKind::ALL {
            parameters.extend(self.layer.link(kind).into_iter().flat_map(|link| link_parameters(kind, link)));
        }
        let of_material = self.material.as_ref().map_or_else(Vec::new, MaterialParameter::of);
        parameters.extend(of_material.into_iter().map(Parameter::Material));
        let friction = self.friction.clone().unwrap_or_default();
        parameters.extend(friction.coulomb.map(|_| Parameter::Coulomb));
        parameters.extend(friction.shear_force.map(|_| Parameter::ShearForce));
        parameters.extend(friction.shear_strength.map(|_| Parameter::ShearStrength));
        parameters.extend(friction.rate_shear.iter().flat_map(rate_shear_parameters));
        parameters.extend([Method, RelativeTolerance, AbsoluteTolerance, MaxSteps, Extrapolation]);
        parameters
    }
}

fn rate_shear_parameters(law: &RateShear) -> Vec<Parameter> {
    let force = law.force.map(|_| Parameter::RateShearForce);
    let strength = law.strength.map(|_| Parameter::RateShearStrength);
    let others = [Parameter::ReferenceSpeed, Parameter::Sharpness, Parameter::CreepSpeed];
    force.into_iter().chain(strength).chain(others).collect()
}

fn link_parameters(kind: LinkKind, link: &Link) -> Vec<Parameter> {
    let mut parameters = Vec::new();
    parameters.extend(link.stiffness.map(|_| Parameter::Stiffness(kind)));
    parameters.extend(link.damping.map(|_| Parameter::Damping(kind)));
    for j in 0..link.maxwell.len() {
        parameters.extend([Parameter::MaxwellStiffness(kind, j), Parameter::RelaxationTime(kind, j)]);
    }
    parameters
}
