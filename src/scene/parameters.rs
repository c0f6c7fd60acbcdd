//! The parameters of a scene by name: what an FMU or `--set` may change before a run.

use super::{Scene, Unit};

/// One settable number or word of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// `layer.mass`
    Mass,
}

/// A parameter's value.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A Real of FMI.
    Real(f64),
    /// An Integer of FMI.
    Integer(i32),
    /// A String of FMI.
    Text(String),
}

/// Why a parameter's value is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("not yet")]
pub struct ParameterError;

impl Parameter {
    /// The key's path, elements of lists counted from 1: `layer.vertical.maxwell[1].stiffness`.
    pub fn name(self) -> String {
        String::new()
    }

    /// The unit of a Real parameter.
    pub fn unit(self) -> Unit {
        Unit::One
    }

    /// What it is, in a few words.
    pub fn description(self) -> String {
        String::new()
    }
}

impl Scene {
    /// The parameters that this scene has, in the order of the scene's keys.
    pub fn parameters(&self) -> Vec<Parameter> {
        Vec::new()
    }

    /// The value of `parameter`.
    pub fn parameter(&self, _parameter: Parameter) -> Value {
        Value::Real(0.0)
    }

    /// Gives `parameter` a value.
    ///
    /// # Errors
    /// [`ParameterError`] where the value is of the wrong type or out of range; the scene is then as it was.
    pub fn set_parameter(&mut self, _parameter: Parameter, _value: Value) -> Result<(), ParameterError> {
        Ok(())
    }
}
