//! Reading and changing a parameter of a scene.

use super::{Parameter, ParameterError, Value};
use crate::scene::allowed::{self, Range};
use crate::scene::{Problem, RateShear, Scene};

impl Parameter {
    /// The range of a Real parameter; `None` for the others.
    fn range(self) -> Option<Range> {
        match self {
            Self::Clearance => Some(allowed::HEIGHT),
            Self::Mass => Some(allowed::MASS),
            Self::Stiffness(_) | Self::MaxwellStiffness(..) => Some(allowed::STIFFNESS),
            Self::Damping(_) => Some(allowed::DAMPING),
            Self::RelaxationTime(..) => Some(allowed::RELAXATION_TIME),
            Self::Material(parameter) => Some(parameter.range()),
            Self::Coulomb => Some(allowed::FRICTION_COEFFICIENT),
            Self::ShearForce | Self::RateShearForce => Some(allowed::SHEAR_FORCE),
            Self::ShearStrength | Self::RateShearStrength => Some(allowed::SHEAR_STRENGTH),
            Self::ReferenceSpeed | Self::CreepSpeed => Some(allowed::SPEED),
            Self::Sharpness => Some(allowed::SHARPNESS),
            Self::RelativeTolerance => Some(allowed::RELATIVE_TOLERANCE),
            Self::AbsoluteTolerance => Some(allowed::ABSOLUTE_TOLERANCE),
            Self::Initial | Self::Method | Self::MaxSteps | Self::Extrapolation => None,
            // Of no scene.
            Self::TableExtrapolation => None,
        }
    }

    /// What is allowed, in words.
    fn allowed(self) -> String {
        match self {
            Self::Initial => allowed::INITIAL.to_string(),
            Self::Method => allowed::METHOD.to_string(),
            Self::MaxSteps => allowed::MAX_STEPS.to_string(),
            Self::Extrapolation => allowed::EXTRAPOLATION.to_string(),
            _ => self.range().map_or_else(String::new, |range| range.to_string()),
        }
    }

    pub(super) fn error(self, problem: Problem) -> ParameterError {
        ParameterError { name: self.name(), problem }
    }

    pub(super) fn refuse(self, given: impl ToString) -> ParameterError {
        self.error(Problem::Value { given: given.to_string(), expected: self.allowed() })
    }
}

impl Scene {
    /// The value of `parameter`; a Real one that the scene does not have is 0.
    pub fn parameter(&self, parameter: Parameter) -> Value {
        match parameter {
            Parameter::Initial => Value::Text(allowed::INITIAL.word(self.layer.initial).into()),
            Parameter::Method => Value::Text(allowed::METHOD.word(self.solver.method).into()),
            Parameter::Extrapolation => Value::Text(allowed::EXTRAPOLATION.word(self.extrapolation).into()),
            Parameter::MaxSteps => Value::Integer(i32::try_from(self.solver.max_steps).unwrap_or(i32::MAX)),
            _ => Value::Real(self.real(parameter).unwrap_or(0.0)),
        }
    }

    fn real(&self, parameter: Parameter) -> Option<f64> {
        match parameter {
            Parameter::Clearance => Some(self.layer.clearance),
            Parameter::Mass => self.layer.mass,
            Parameter::Stiffness(kind) => self.layer.link(kind)?.stiffness,
            Parameter::Damping(kind) => self.layer.link(kind)?.damping,
            Parameter::MaxwellStiffness(kind, j) => Some(self.layer.link(kind)?.maxwell.get(j)?.stiffness),
            Parameter::RelaxationTime(kind, j) => Some(self.layer.link(kind)?.maxwell.get(j)?.relaxation_time),
            Parameter::Material(parameter) => parameter.value(self.material.as_ref()?),
            Parameter::Coulomb => self.friction.as_ref()?.coulomb,
            Parameter::ShearForce => self.friction.as_ref()?.shear_force,
            Parameter::ShearStrength => self.friction.as_ref()?.shear_strength,
            Parameter::RateShearForce => self.rate_shear_as_given()?.force,
            Parameter::RateShearStrength => self.rate_shear_as_given()?.strength,
            Parameter::ReferenceSpeed => Some(self.rate_shear_as_given()?.reference_speed),
            Parameter::Sharpness => Some(self.rate_shear_as_given()?.sharpness),
            Parameter::CreepSpeed => Some(self.rate_shear_as_given()?.creep_speed()),
            Parameter::RelativeTolerance => Some(self.solver.relative_tolerance),
            Parameter::AbsoluteTolerance => Some(self.absolute_tolerance()),
            Parameter::Initial | Parameter::Method | Parameter::MaxSteps | Parameter::Extrapolation => None,
            Parameter::TableExtrapolation => None,
        }
    }

    /// Where a Real parameter is kept, if the scene has it.
    fn real_mut(&mut self, parameter: Parameter) -> Option<&mut f64> {
        match parameter {
            Parameter::Clearance => Some(&mut self.layer.clearance),
            Parameter::Mass => self.layer.mass.as_mut(),
            Parameter::Stiffness(kind) => self.layer.link_mut(kind)?.stiffness.as_mut(),
            Parameter::Damping(kind) => self.layer.link_mut(kind)?.damping.as_mut(),
            Parameter::MaxwellStiffness(kind, j) => Some(&mut self.layer.link_mut(kind)?.maxwell.get_mut(j)?.stiffness),
            Parameter::RelaxationTime(kind, j) => {
                Some(&mut self.layer.link_mut(kind)?.maxwell.get_mut(j)?.relaxation_time)
            }
            Parameter::Material(parameter) => parameter.place(self.material.as_mut()?),
            Parameter::Coulomb => self.friction.as_mut()?.coulomb.as_mut(),
            Parameter::ShearForce => self.friction.as_mut()?.shear_force.as_mut(),
            Parameter::ShearStrength => self.friction.as_mut()?.shear_strength.as_mut(),
            Parameter::RateShearForce => self.rate_shear_mut()?.force.as_mut(),
            Parameter::RateShearStrength => self.rate_shear_mut()?.strength.as_mut(),
            Parameter::ReferenceSpeed => Some(&mut self.rate_shear_mut()?.reference_speed),
            Parameter::Sharpness => Some(&mut self.rate_shear_mut()?.sharpness),
            Parameter::CreepSpeed => Some(self.rate_shear_mut()?.creep_speed.get_or_insert(0.0)),
            Parameter::RelativeTolerance => Some(&mut self.solver.relative_tolerance),
            Parameter::AbsoluteTolerance => Some(self.solver.absolute_tolerance.get_or_insert(0.0)),
            Parameter::Initial | Parameter::Method | Parameter::MaxSteps | Parameter::Extrapolation => None,
            Parameter::TableExtrapolation => None,
        }
    }

    fn rate_shear_as_given(&self) -> Option<&RateShear> {
        self.friction.as_ref()?.rate_shear.as_ref()
    }

    fn rate_shear_mut(&mut self) -> Option<&mut RateShear> {
        self.friction.as_mut()?.rate_shear.as_mut()
    }

    /// Gives `parameter` a value. Whether several go together, [`check`](Self::check) says once all are set.
    ///
    /// # Errors
    /// [`ParameterError`] where the value is of the wrong type or out of range, or where the scene has no such
    /// parameter; the scene is then as it was.
    pub fn set_parameter(&mut self, parameter: Parameter, value: Value) -> Result<(), ParameterError> {
        match &value {
            Value::Real(number) => self.set_real(parameter, *number),
            Value::Integer(number) => self.set_integer(parameter, *number),
            Value::Text(word) => self.set_text(parameter, word),
        }
    }

    fn set_real(&mut self, parameter: Parameter, number: f64) -> Result<(), ParameterError> {
        let in_range = parameter.range().is_some_and(|range| range.holds(number));
        if !in_range {
            return Err(parameter.refuse(Value::Real(number)));
        }
        match self.real_mut(parameter) {
            Some(place) => *place = number,
            None => return Err(self.unknown(&parameter.name())),
        }
        Ok(())
    }

    fn set_integer(&mut self, parameter: Parameter, number: i32) -> Result<(), ParameterError> {
        if parameter != Parameter::MaxSteps || !allowed::MAX_STEPS.holds(number.into()) {
            return Err(parameter.refuse(number));
        }
        self.solver.max_steps = number.unsigned_abs().into();
        Ok(())
    }

    fn set_text(&mut self, parameter: Parameter, word: &str) -> Result<(), ParameterError> {
        let given = format!("{word:?}");
        let refuse = |problem| parameter.error(problem);
        match parameter {
            Parameter::Initial => self.layer.initial = allowed::INITIAL.find(word, &given).map_err(refuse)?,
            Parameter::Method => self.solver.method = allowed::METHOD.find(word, &given).map_err(refuse)?,
            Parameter::Extrapolation => {
                self.extrapolation = allowed::EXTRAPOLATION.find(word, &given).map_err(refuse)?;
            }
            _ => return Err(parameter.refuse(given)),
        }
        Ok(())
    }
}
