//! The parameters of a scene by name: what an FMU or `--set` may change before a run.
//!
//! Units, ranges and descriptions are those of the table of keys.

#[cfg(test)]
mod tests;

use std::fmt;

use serde::{Deserialize, Serialize};

use super::error::{ParameterError, Problem};
use super::keys::{self, Allowed, Key};
use super::values::{Word, words};
use super::{Axis, FineRoughness, FineWaves, Foundation, Link, LinkKind, Scene, Softening, Unit};

/// One settable number or word of a scene. Elements of lists are counted from 0.
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
    /// `layer.vertical.maxwell[1].stiffness` and so on
    MaxwellStiffness(LinkKind, usize),
    /// `layer.vertical.maxwell[1].relaxation_time` and so on
    RelaxationTime(LinkKind, usize),
    /// `layer.thickness`
    Thickness,
    /// `material.density`
    Density,
    /// `material.poisson_ratio`
    PoissonRatio,
    /// `material.equilibrium_modulus`
    EquilibriumModulus,
    /// `material.viscosity`
    Viscosity,
    /// `material.prony[1].modulus` and so on
    PronyModulus(usize),
    /// `material.prony[1].relaxation_time` and so on
    PronyRelaxationTime(usize),
    /// `material.wlf.c1`
    WlfC1,
    /// `material.wlf.c2`
    WlfC2,
    /// `material.wlf.reference_temperature`
    ReferenceTemperature,
    /// `material.wlf.temperature`
    Temperature,
    /// `material.heat.conductivity`
    Conductivity,
    /// `material.heat.capacity`
    HeatCapacity,
    /// `material.heat.share`
    HeatShare,
    /// `surface.fine.hurst`
    FineHurst,
    /// `surface.fine.rms_slope`
    FineSlope,
    /// `surface.fine.longest`
    FineLongest,
    /// `surface.fine.shortest`
    FineShortest,
    /// `surface.fine.modulus`
    FineModulus,
    /// `surface.fine.creep_speed`
    FineCreepSpeed,
    /// `surface.fine.softening`
    FineSoftening,
    /// `carrier.x.mass` and so on
    CarrierMass(Axis),
    /// `carrier.x.stiffness` and so on
    CarrierStiffness(Axis),
    /// `carrier.x.damping` and so on
    CarrierDamping(Axis),
    /// `carrier.z.load`
    Load,
    /// `carrier.x.pull`
    Pull,
    /// `carrier.x.start` and so on
    CarrierStart(Axis),
    /// `carrier.x.start_rate` and so on
    CarrierStartRate(Axis),
    /// `carrier.z.initial`
    CarrierInitial,
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
    /// `table.extrapolation`, of an element from a table and of a patch
    TableExtrapolation,
    /// `solver.refine`, of a patch
    Refine,
    /// `patch.backing.normal`
    BackingNormal,
    /// `patch.backing.shear`
    BackingShear,
    /// `patch.heat.conductivity`
    FaceConductivity,
    /// `patch.heat.capacity`
    FaceCapacity,
    /// `patch.heat.density`
    FaceDensity,
    /// `patch.heat.share`
    FaceShare,
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

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Real(number) => write!(f, "{number:?}"),
            Self::Integer(number) => write!(f, "{number}"),
            Self::Text(word) => write!(f, "{word:?}"),
        }
    }
}

impl Parameter {
    /// The key's path, elements of lists counted from 1: `layer.vertical.maxwell[1].stiffness`.
    pub fn name(self) -> String {
        let name = match self {
            Self::Clearance => "layer.clearance",
            Self::Mass => "layer.mass",
            Self::Initial => "layer.initial",
            Self::Stiffness(link) => return format!("layer.{}.stiffness", link.name()),
            Self::Damping(link) => return format!("layer.{}.damping", link.name()),
            Self::MaxwellStiffness(link, j) => return format!("layer.{}.maxwell[{}].stiffness", link.name(), j + 1),
            Self::RelaxationTime(link, j) => {
                return format!("layer.{}.maxwell[{}].relaxation_time", link.name(), j + 1);
            }
            Self::Thickness => "layer.thickness",
            Self::Density => "material.density",
            Self::PoissonRatio => "material.poisson_ratio",
            Self::EquilibriumModulus => "material.equilibrium_modulus",
            Self::Viscosity => "material.viscosity",
            Self::PronyModulus(j) => return format!("material.prony[{}].modulus", j + 1),
            Self::PronyRelaxationTime(j) => return format!("material.prony[{}].relaxation_time", j + 1),
            Self::WlfC1 => "material.wlf.c1",
            Self::WlfC2 => "material.wlf.c2",
            Self::ReferenceTemperature => "material.wlf.reference_temperature",
            Self::Temperature => "material.wlf.temperature",
            Self::Conductivity => "material.heat.conductivity",
            Self::HeatCapacity => "material.heat.capacity",
            Self::HeatShare => "material.heat.share",
            Self::FineHurst => "surface.fine.hurst",
            Self::FineSlope => "surface.fine.rms_slope",
            Self::FineLongest => "surface.fine.longest",
            Self::FineShortest => "surface.fine.shortest",
            Self::FineModulus => "surface.fine.modulus",
            Self::FineCreepSpeed => "surface.fine.creep_speed",
            Self::FineSoftening => "surface.fine.softening",
            Self::CarrierMass(axis) => return format!("carrier.{}.mass", axis.name()),
            Self::CarrierStiffness(axis) => return format!("carrier.{}.stiffness", axis.name()),
            Self::CarrierDamping(axis) => return format!("carrier.{}.damping", axis.name()),
            Self::Load => "carrier.z.load",
            Self::Pull => "carrier.x.pull",
            Self::CarrierStart(axis) => return format!("carrier.{}.start", axis.name()),
            Self::CarrierStartRate(axis) => return format!("carrier.{}.start_rate", axis.name()),
            Self::CarrierInitial => "carrier.z.initial",
            Self::Coulomb => "friction.coulomb",
            Self::ShearForce => "friction.shear_force",
            Self::ShearStrength => "friction.shear_strength",
            Self::RateShearForce => "friction.rate_shear.force",
            Self::RateShearStrength => "friction.rate_shear.strength",
            Self::ReferenceSpeed => "friction.rate_shear.reference_speed",
            Self::Sharpness => "friction.rate_shear.sharpness",
            Self::CreepSpeed => "friction.rate_shear.creep_speed",
            Self::Method => "solver.method",
            Self::RelativeTolerance => "solver.relative_tolerance",
            Self::AbsoluteTolerance => "solver.absolute_tolerance",
            Self::MaxSteps => "solver.max_steps",
            Self::Extrapolation => "input.extrapolation",
            Self::TableExtrapolation => "table.extrapolation",
            Self::Refine => "solver.refine",
            Self::BackingNormal => "patch.backing.normal",
            Self::BackingShear => "patch.backing.shear",
            Self::FaceConductivity => "patch.heat.conductivity",
            Self::FaceCapacity => "patch.heat.capacity",
            Self::FaceDensity => "patch.heat.density",
            Self::FaceShare => "patch.heat.share",
        };
        name.to_owned()
    }

    fn key(self) -> &'static Key {
        match self {
            Self::TableExtrapolation => &keys::TABLE_EXTRAPOLATION,
            Self::Refine => &keys::REFINE,
            Self::BackingNormal => &keys::BACKING_NORMAL,
            Self::BackingShear => &keys::BACKING_SHEAR,
            Self::FaceConductivity => &keys::HEAT_CONDUCTIVITY,
            Self::FaceCapacity => &keys::HEAT_CAPACITY,
            Self::FaceDensity => &keys::HEAT_DENSITY,
            Self::FaceShare => &keys::HEAT_SHARE,
            _ => keys::at(&self.name()).unwrap_or(&keys::NONE),
        }
    }

    /// What it may hold, in words.
    pub fn allowed(self) -> String {
        self.key().allowed.to_string()
    }

    /// The unit of a Real parameter; 1 for the others.
    pub fn unit(self) -> Unit {
        self.key().unit
    }

    /// What it is, in a few words.
    pub fn description(self) -> String {
        let meaning = self.key().meaning;
        match self {
            Self::Stiffness(link) | Self::Damping(link) => format!("{meaning} of the {}", link.description()),
            Self::MaxwellStiffness(link, j) | Self::RelaxationTime(link, j) => {
                format!("{meaning} of Maxwell element {} of the {}", j + 1, link.description())
            }
            Self::PronyModulus(j) => format!("{meaning} of term {} of the Prony series", j + 1),
            Self::PronyRelaxationTime(j) => {
                format!("{meaning} of term {} of the Prony series at the reference temperature", j + 1)
            }
            Self::CarrierMass(axis)
            | Self::CarrierStiffness(axis)
            | Self::CarrierDamping(axis)
            | Self::CarrierStart(axis)
            | Self::CarrierStartRate(axis) => format!("{meaning}, along {}", axis.name()),
            _ => meaning.to_owned(),
        }
    }

    /// `number`, if the parameter may have it.
    pub(crate) fn check_number(self, number: f64) -> Result<f64, ParameterError> {
        let is_allowed = self.key().range().is_some_and(|range| range.holds(number));
        if is_allowed { Ok(number) } else { Err(self.refuse(Value::Real(number))) }
    }

    fn refuse(self, given: impl ToString) -> ParameterError {
        ParameterError::new(self.name(), Problem::value(given, self.key().allowed))
    }

    fn choice<T: Word>(self, word: &str) -> Result<T, ParameterError> {
        let error = || ParameterError::new(self.name(), Problem::value(format_args!("{word:?}"), words::<T>()));
        T::parse(word).ok_or_else(error)
    }
}

/// Where a Real parameter is in a scene, `None` where the scene does not have it: to be read (`field!(scene, parameter,
/// as_ref, get)`) or changed (`field!(scene, parameter, as_mut, get_mut, mut)`).
macro_rules! field {
    ($scene:expr, $parameter:expr, $as_ref:ident, $get:ident $(, $mut:tt)?) => {{
        use Parameter::*;
        let scene = $scene;
        match $parameter {
            Clearance => Some(&$($mut)? scene.layer.clearance),
            Mass => scene.layer.mass.$as_ref(),
            Stiffness(kind) => scene.layer.links[kind].$as_ref()?.stiffness.$as_ref(),
            Damping(kind) => scene.layer.links[kind].$as_ref()?.damping.$as_ref(),
            MaxwellStiffness(kind, j) => Some(&$($mut)? scene.layer.links[kind].$as_ref()?.maxwell.$get(j)?.stiffness),
            RelaxationTime(kind, j) => Some(&$($mut)? scene.layer.links[kind].$as_ref()?.maxwell.$get(j)?.relaxation_time),
            Thickness => scene.layer.thickness.$as_ref(),
            Density => Some(&$($mut)? scene.material.$as_ref()?.density),
            PoissonRatio => Some(&$($mut)? scene.material.$as_ref()?.poisson_ratio),
            EquilibriumModulus => Some(&$($mut)? scene.material.$as_ref()?.equilibrium_modulus),
            Viscosity => scene.material.$as_ref()?.viscosity.$as_ref(),
            PronyModulus(j) => Some(&$($mut)? scene.material.$as_ref()?.prony.$get(j)?.modulus),
            PronyRelaxationTime(j) => Some(&$($mut)? scene.material.$as_ref()?.prony.$get(j)?.relaxation_time),
            WlfC1 => Some(&$($mut)? scene.material.$as_ref()?.wlf.$as_ref()?.c1),
            WlfC2 => Some(&$($mut)? scene.material.$as_ref()?.wlf.$as_ref()?.c2),
            ReferenceTemperature => Some(&$($mut)? scene.material.$as_ref()?.wlf.$as_ref()?.reference_temperature),
            Temperature => Some(&$($mut)? scene.material.$as_ref()?.wlf.$as_ref()?.temperature),
            Conductivity => Some(&$($mut)? scene.material.$as_ref()?.heat.$as_ref()?.conductivity),
            HeatCapacity => Some(&$($mut)? scene.material.$as_ref()?.heat.$as_ref()?.capacity),
            HeatShare => Some(&$($mut)? scene.material.$as_ref()?.heat.$as_ref()?.share),
            FineHurst => match &$($mut)? scene.fine.$as_ref()?.waves {
                FineWaves::SelfAffine { hurst, .. } => Some(hurst),
                _ => None,
            },
            FineSlope => match &$($mut)? scene.fine.$as_ref()?.waves {
                FineWaves::SelfAffine { rms_slope, .. } | FineWaves::Modulus { rms_slope, .. } => Some(rms_slope),
                _ => None,
            },
            FineLongest => match &$($mut)? scene.fine.$as_ref()?.waves {
                FineWaves::SelfAffine { longest, .. } | FineWaves::Table { longest, .. } => Some(longest),
                _ => None,
            },
            FineShortest => match &$($mut)? scene.fine.$as_ref()?.waves {
                FineWaves::SelfAffine { shortest, .. }
                | FineWaves::Table { shortest, .. }
                | FineWaves::Split { shortest, .. }
                | FineWaves::Continued { shortest } => Some(shortest),
                FineWaves::Modulus { .. } => None,
            },
            FineModulus => match &$($mut)? scene.fine.$as_ref()?.waves {
                FineWaves::Modulus { modulus, .. } => Some(modulus),
                _ => None,
            },
            FineSoftening => match scene.fine.$as_ref()? {
                FineRoughness { waves: FineWaves::Modulus { .. }, .. } => None,
                FineRoughness { softening: Softening::Factor(factor), .. } => Some(factor),
                FineRoughness { softening: Softening::Table(_), .. } => None,
            },
            CarrierMass(axis) => Some(&$($mut)? scene.carrier[axis].$as_ref()?.mass),
            CarrierStiffness(axis) => scene.carrier[axis].$as_ref()?.stiffness.$as_ref(),
            CarrierDamping(axis) => scene.carrier[axis].$as_ref()?.damping.$as_ref(),
            Load => scene.carrier[Axis::Z].$as_ref()?.load.$as_ref(),
            Pull => scene.carrier[Axis::X].$as_ref()?.pull.$as_ref(),
            CarrierStart(axis) => scene.carrier[axis].$as_ref()?.start.$as_ref(),
            CarrierStartRate(axis) => scene.carrier[axis].$as_ref()?.start_rate.$as_ref(),
            Coulomb => scene.friction.$as_ref()?.coulomb.$as_ref(),
            ShearForce => scene.friction.$as_ref()?.shear_force.$as_ref(),
            ShearStrength => scene.friction.$as_ref()?.shear_strength.$as_ref(),
            RateShearForce => scene.friction.$as_ref()?.rate_shear.$as_ref()?.force.$as_ref(),
            RateShearStrength => scene.friction.$as_ref()?.rate_shear.$as_ref()?.strength.$as_ref(),
            ReferenceSpeed => Some(&$($mut)? scene.friction.$as_ref()?.rate_shear.$as_ref()?.reference_speed),
            Sharpness => Some(&$($mut)? scene.friction.$as_ref()?.rate_shear.$as_ref()?.sharpness),
            RelativeTolerance => Some(&$($mut)? scene.solver.relative_tolerance),
            // They follow others until they are set: see `real` and `write_real`.
            CreepSpeed | FineCreepSpeed | AbsoluteTolerance => None,
            Initial | CarrierInitial | Method | MaxSteps | Extrapolation | TableExtrapolation | Refine | BackingNormal
            | BackingShear | FaceConductivity | FaceCapacity | FaceDensity | FaceShare => None,
        }
    }};
}

impl Scene {
    /// The parameters that this scene has, in the order of the scene's keys.
    pub fn parameters(&self) -> Vec<Parameter> {
        use Parameter::*;
        let link = |kind: LinkKind| {
            let elements = self.layer.links[kind].as_ref().map_or(0, |link: &Link| link.maxwell.len());
            let of_element = move |j| [MaxwellStiffness(kind, j), RelaxationTime(kind, j)];
            [Stiffness(kind), Damping(kind)].into_iter().chain((0..elements).flat_map(of_element))
        };
        let terms = self.material.as_ref().map_or(0, |material| material.prony.len());
        let mut parameters = vec![Clearance, Mass, Initial];
        parameters.extend(LinkKind::ALL.into_iter().flat_map(link));
        parameters.extend([Thickness, Density, PoissonRatio, EquilibriumModulus, Viscosity]);
        parameters.extend((0..terms).flat_map(|j| [PronyModulus(j), PronyRelaxationTime(j)]));
        parameters.extend([WlfC1, WlfC2, ReferenceTemperature, Temperature]);
        parameters.extend([Conductivity, HeatCapacity, HeatShare]);
        parameters.extend([
            FineHurst,
            FineSlope,
            FineLongest,
            FineShortest,
            FineModulus,
            FineCreepSpeed,
            FineSoftening,
        ]);
        let body = |axis, force| {
            [
                CarrierMass(axis),
                CarrierStiffness(axis),
                CarrierDamping(axis),
                force,
                CarrierStart(axis),
                CarrierStartRate(axis),
            ]
        };
        parameters.extend(body(Axis::X, Pull));
        parameters.extend(body(Axis::Z, Load));
        parameters.extend(self.carrier.z.map(|_| CarrierInitial));
        parameters.extend([Coulomb, ShearForce, ShearStrength, RateShearForce, RateShearStrength]);
        parameters.extend([ReferenceSpeed, Sharpness, CreepSpeed]);
        parameters.extend([Method, RelativeTolerance, AbsoluteTolerance, MaxSteps, Extrapolation]);
        let is_real = |parameter: Parameter| matches!(parameter.key().allowed, Allowed::Number(_));
        parameters.retain(|&parameter| !is_real(parameter) || self.real(parameter).is_some());
        // As an input it is none.
        parameters.retain(|&parameter| parameter != Temperature || !self.temperature_input);
        parameters
    }

    /// The parameter called `name`.
    pub fn parameter_named(&self, name: &str) -> Option<Parameter> {
        self.parameters().into_iter().find(|parameter| parameter.name() == name)
    }

    /// The value of `parameter`; a Real one that the scene does not have is 0.
    pub fn parameter(&self, parameter: Parameter) -> Value {
        match parameter {
            Parameter::Initial => Value::Text(self.layer.initial.as_word().into()),
            Parameter::CarrierInitial => Value::Text(self.carrier.z.map_or("", |body| body.initial.as_word()).into()),
            Parameter::Method => Value::Text(self.solver.method.as_word().into()),
            Parameter::Extrapolation => Value::Text(self.extrapolation.as_word().into()),
            Parameter::MaxSteps => Value::Integer(i32::try_from(self.solver.max_steps()).unwrap_or(i32::MAX)),
            _ => Value::Real(self.real(parameter).unwrap_or(0.0)),
        }
    }

    fn real(&self, parameter: Parameter) -> Option<f64> {
        match parameter {
            Parameter::CreepSpeed => Some(self.friction.as_ref()?.rate_shear?.creep_speed()),
            Parameter::FineCreepSpeed => self.has_own_creep_speed().then(|| self.fine_creep_speed()),
            Parameter::AbsoluteTolerance => Some(self.absolute_tolerance()),
            _ => field!(self, parameter, as_ref, get).copied(),
        }
    }

    /// Whether roughness below the profile has a creep speed of its own: not where that of the shear strength counts.
    fn has_own_creep_speed(&self) -> bool {
        let of_shear = self.friction.as_ref().is_some_and(|friction| friction.rate_shear.is_some());
        self.fine.as_ref().is_some_and(|fine| fine.waves.has_bands()) && !of_shear
    }

    /// Gives `parameter` a value. Call [`check`](Self::check) once all are set: some values must agree with others.
    ///
    /// # Errors
    /// [`ParameterError`] where the value is of the wrong type or out of range, or where the scene has no such
    /// parameter; the scene is then unchanged.
    pub fn set_parameter(&mut self, parameter: Parameter, value: Value) -> Result<(), ParameterError> {
        match (parameter, &value) {
            (_, Value::Real(number)) => return self.set_real(parameter, *number),
            (Parameter::MaxSteps, Value::Integer(number)) => return self.set_max_steps(*number),
            (Parameter::Initial, Value::Text(word)) => self.layer.initial = parameter.choice(word)?,
            (Parameter::CarrierInitial, Value::Text(word)) => {
                let initial = parameter.choice(word)?;
                let Some(body) = &mut self.carrier.z else { return Err(self.unknown(&parameter.name())) };
                body.initial = initial;
            }
            (Parameter::Method, Value::Text(word)) => self.solver.method = parameter.choice(word)?,
            (Parameter::Extrapolation, Value::Text(word)) => self.extrapolation = parameter.choice(word)?,
            _ => return Err(parameter.refuse(value)),
        }
        Ok(())
    }

    fn set_real(&mut self, parameter: Parameter, number: f64) -> Result<(), ParameterError> {
        parameter.check_number(number)?;
        if self.real(parameter).is_none() {
            return Err(self.unknown(&parameter.name()));
        }
        self.write_real(parameter, number);
        Ok(())
    }

    /// Sets a Real parameter that the scene has; `None` where it has not.
    fn write_real(&mut self, parameter: Parameter, number: f64) -> Option<()> {
        match parameter {
            // These follow others until they are set themselves.
            Parameter::CreepSpeed => self.friction.as_mut()?.rate_shear.as_mut()?.creep_speed = Some(number),
            Parameter::FineCreepSpeed => self.fine.as_mut()?.creep_speed = Some(number),
            Parameter::AbsoluteTolerance => self.solver.absolute_tolerance = Some(number),
            _ => *field!(&mut *self, parameter, as_mut, get_mut, mut)? = number,
        }
        if matches!(parameter, Parameter::Thickness | Parameter::PoissonRatio) {
            self.refit();
        }
        Some(())
    }

    /// Fits the links to the body anew, for it has changed.
    fn refit(&mut self) {
        let refitted = |foundation: &Foundation| foundation.refitted(&self.layer, self.material.as_ref()?);
        self.foundation = self.foundation.as_ref().and_then(refitted);
    }

    fn set_max_steps(&mut self, number: i32) -> Result<(), ParameterError> {
        let Allowed::Whole(range) = Parameter::MaxSteps.key().allowed else { return Ok(()) };
        if !range.holds(number.into()) {
            return Err(Parameter::MaxSteps.refuse(number));
        }
        self.solver.max_steps = Some(number.unsigned_abs().into());
        Ok(())
    }

    /// Gives the parameter called `name` the value that `text` writes.
    ///
    /// # Errors
    /// [`ParameterError`] as for [`set_parameter`](Self::set_parameter), and for an unknown name, with the parameters
    /// whose names are similar or, failing these, all that the scene has.
    pub fn set_by_name(&mut self, name: &str, text: &str) -> Result<(), ParameterError> {
        let parameter = self.parameter_named(name).ok_or_else(|| self.unknown(name))?;
        let value = match self.parameter(parameter) {
            Value::Real(_) => text.trim().parse().map(Value::Real).map_err(|_| parameter.refuse(text))?,
            Value::Integer(_) => text.trim().parse().map(Value::Integer).map_err(|_| parameter.refuse(text))?,
            Value::Text(_) => Value::Text(text.trim().to_owned()),
        };
        self.set_parameter(parameter, value)
    }

    fn unknown(&self, name: &str) -> ParameterError {
        let names: Vec<String> = self.parameters().into_iter().map(Parameter::name).collect();
        let similar: Vec<String> = names.iter().filter(|other| keys::is_similar(name, other)).cloned().collect();
        let allowed = if similar.is_empty() { names } else { similar };
        ParameterError::new(name, Problem::Unknown { allowed })
    }
}
