//! Getting and setting variables; derivatives of outputs by inputs at constant states, and by time.

use std::ffi::CString;
use std::sync::Arc;

use super::error::Error;
use super::inputs::MAX_INPUTS;
use super::instance::Instance;
use super::variables::{Kind, Role};
use asperity::scene::{Value, is_possible};

impl Instance {
    /// Looks up the values of variables of the type `kind`, into `found`: all of them or none, and without an
    /// allocation once it has been long enough, since masters ask at every communication point.
    fn find(&mut self, references: &[u32], kind: Kind) -> Result<(), Error> {
        self.found.clear();
        for &reference in references {
            let value = self.value(reference, kind)?;
            self.found.push(value);
        }
        Ok(())
    }

    fn value(&mut self, reference: u32, kind: Kind) -> Result<Value, Error> {
        let variable = self.variables.find(reference, kind)?;
        match variable.role {
            Role::Input(slot) => Ok(Value::Real(self.state.inputs.value(slot))),
            Role::Parameter(parameter) => Ok(self.state.parameters.definition().parameter(parameter)),
            Role::Output { index, .. } | Role::Local(index) => {
                match self.outputs.get(&mut self.state, self.variables.calculated())?[index] {
                    value if !value.is_finite() => Err(Error::NoValue { name: variable.name.clone(), value }),
                    value if kind == Kind::Real => Ok(Value::Real(value)),
                    // Saturates: a count is held at the largest Integer.
                    value => Ok(Value::Integer(value as i32)),
                }
            }
        }
    }

    /// fmi2GetReal: all of the values or none.
    pub(super) fn get_reals(&mut self, references: &[u32], values: &mut [f64]) -> Result<(), Error> {
        self.find(references, Kind::Real)?;
        for (target, value) in values.iter_mut().zip(&self.found) {
            if let Value::Real(value) = value {
                *target = *value;
            }
        }
        Ok(())
    }

    /// fmi2GetInteger: as [`get_reals`](Self::get_reals).
    pub(super) fn get_integers(&mut self, references: &[u32], values: &mut [i32]) -> Result<(), Error> {
        self.find(references, Kind::Integer)?;
        for (target, value) in values.iter_mut().zip(&self.found) {
            if let Value::Integer(value) = value {
                *target = *value;
            }
        }
        Ok(())
    }

    /// fmi2GetString: the strings remain until its next call.
    pub(super) fn get_strings(&mut self, references: &[u32]) -> Result<&[CString], Error> {
        self.find(references, Kind::Text)?;
        let text = |value| if let Value::Text(text) = value { text } else { String::new() };
        self.texts = self.found.drain(..).map(|value| CString::new(text(value)).unwrap_or_default()).collect();
        Ok(&self.texts)
    }

    /// fmi2GetBoolean and fmi2SetBoolean: no variable is a Boolean, so every reference is refused.
    pub(super) fn refuse_booleans(&mut self, references: &[u32]) -> Result<(), Error> {
        references.iter().try_for_each(|&reference| self.variables.find(reference, Kind::Boolean).map(|_| ()))
    }

    /// fmi2SetReal, fmi2SetInteger and fmi2SetString: all of the values or none.
    ///
    /// An input that is not a number or out of range is accepted here and refused by the step: a master may set it as
    /// long as it does not ask the model to follow it.
    pub(super) fn set(&mut self, references: &[u32], values: impl Iterator<Item = Value>) -> Result<(), Error> {
        let (mut parameters, mut inputs) = (Arc::clone(&self.state.parameters), self.state.inputs);
        for (&reference, value) in references.iter().zip(values) {
            let variable = self.variables.find(reference, Kind::new(&value))?;
            match (&variable.role, value) {
                (&Role::Input(slot), Value::Real(value)) => inputs.set(slot, value),
                (&Role::Parameter(parameter), value) if self.state.lifecycle.before_run() => {
                    Arc::make_mut(&mut parameters).set(parameter, value)?;
                }
                (Role::Parameter(_), _) => {
                    return Err(Error::Late { name: variable.name.clone(), state: self.state.lifecycle });
                }
                _ => return Err(Error::OutputSet(variable.name.clone())),
            }
        }
        self.state.parameters = parameters;
        self.state.inputs = inputs;
        self.update_start();
        Ok(())
    }

    /// fmi2SetRealInputDerivatives: all of them or none. Those of other orders than the first are left out, of which a
    /// warning tells once.
    pub(super) fn set_rates(&mut self, references: &[u32], orders: &[i32], rates: &[f64]) -> Result<(), Error> {
        let (mut inputs, mut left_out) = (self.state.inputs, None);
        for ((&reference, &order), &rate) in references.iter().zip(orders).zip(rates) {
            let variable = self.variables.find(reference, Kind::Real)?;
            match (&variable.role, order) {
                (&Role::Input(slot), 1) => inputs.set_rate(slot, rate),
                (Role::Input(_), 0..) => left_out = Some(order),
                (Role::Input(_), _) => return Err(Error::DerivativeOrder { name: variable.name.clone(), order }),
                _ => return Err(Error::NoInput(variable.name.clone())),
            }
        }
        self.state.inputs = inputs;
        self.update_start();
        if let (Some(order), false) = (left_out, self.warned_of_orders) {
            self.warned_of_orders = true;
            self.warn(format!("derivatives of inputs of order {order} are left out; order 1 is used"));
        }
        Ok(())
    }

    /// Inputs and parameters set before the run are those that it starts from. Inputs set later are those of the next
    /// step; the outputs remain those at the last communication point.
    fn update_start(&mut self) {
        if self.state.lifecycle.before_run() {
            self.state.discard_start();
            self.outputs.invalidate();
        }
    }

    /// fmi2GetDirectionalDerivative: the unknowns are the Real outputs of the model structure, the knowns the inputs.
    pub(super) fn directional_derivatives(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        steps: &[f64],
        values: &mut [f64],
    ) -> Result<(), Error> {
        let outputs = unknowns.iter().map(|&unknown| self.unknown(unknown)).collect::<Result<Vec<_>, _>>()?;
        let direction = self.direction(knowns, steps)?;
        let mut found = vec![0.0; outputs.len()];
        self.state.run()?.directional_derivatives(&outputs, &direction, &mut found);
        for (&unknown, &value) in unknowns.iter().zip(&found) {
            self.check_derivative(unknown, value)?;
        }
        values.copy_from_slice(&found);
        Ok(())
    }

    fn unknown(&self, reference: u32) -> Result<usize, Error> {
        let variable = self.variables.find(reference, Kind::Real)?;
        match variable.role {
            Role::Output { index, .. } => Ok(index),
            _ => Err(Error::NoUnknown(variable.name.clone())),
        }
    }

    /// The change of the inputs, by slot.
    fn direction(&self, knowns: &[u32], steps: &[f64]) -> Result<[f64; MAX_INPUTS], Error> {
        let mut direction = [0.0; MAX_INPUTS];
        for (&reference, &step) in knowns.iter().zip(steps) {
            let variable = self.variables.find(reference, Kind::Real)?;
            match variable.role {
                _ if !is_possible(step) => {
                    return Err(Error::OutOfRange { what: "a value of dvKnown", value: step });
                }
                Role::Input(slot) => direction[slot] += step,
                _ => return Err(Error::NoKnown(variable.name.clone())),
            }
        }
        Ok(direction)
    }

    /// fmi2GetRealOutputDerivatives: the first derivatives of forces, moments and the carrier's motion at the current
    /// time.
    pub(super) fn output_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
        values: &mut [f64],
    ) -> Result<(), Error> {
        let found = references.iter().zip(orders).map(|(&reference, &order)| self.output_derivative(reference, order));
        let found = found.collect::<Result<Vec<_>, _>>()?;
        values.copy_from_slice(&found);
        Ok(())
    }

    fn output_derivative(&mut self, reference: u32, order: i32) -> Result<f64, Error> {
        let variable = self.variables.find(reference, Kind::Real)?;
        let rate = match variable.role {
            Role::Output { index, .. } => self.state.run()?.output_rate(index),
            _ => None,
        };
        match (rate, order) {
            (Some(rate), 1) => self.check_derivative(reference, rate),
            (Some(_), _) => Err(Error::DerivativeOrder { name: variable.name.clone(), order }),
            (None, _) => Err(Error::NoOutputDerivative(variable.name.clone())),
        }
    }

    fn check_derivative(&self, reference: u32, value: f64) -> Result<f64, Error> {
        if value.is_finite() {
            return Ok(value);
        }
        let name = self.variables.find(reference, Kind::Real)?.name.clone();
        Err(Error::NoValue { name: format!("the derivative of {name}"), value })
    }
}
