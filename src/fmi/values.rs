//! Getting and setting variables; derivatives of outputs by inputs at constant states, and of the forces by time.

use std::ffi::CString;
use std::sync::Arc;

use super::definition::{Entry, Input, Kind, Parameters};
use super::error::Error;
use super::instance::Instance;
use super::patch_inputs::PatchInput;
use crate::outputs::{Output, Variable};
use crate::patch::PatchOutput;
use crate::scene::{Value, is_possible};

impl Instance {
    /// The values of variables of the type `kind`.
    fn get(&mut self, references: &[u32], kind: Kind) -> Result<Vec<Value>, Error> {
        references.iter().map(|&reference| self.get_one(reference, kind)).collect()
    }

    fn get_one(&mut self, reference: u32, kind: Kind) -> Result<Value, Error> {
        match self.catalogue.find(reference, kind)? {
            Entry::Input(input) => Ok(Value::Real(self.state.inputs.input(input))),
            Entry::PatchInput(input) => Ok(Value::Real(self.state.patch_inputs.map_or(0.0, |all| all.get(input)))),
            Entry::Parameter(parameter, _) => Ok(self.state.parameters.definition().parameter(parameter)),
            Entry::Output(index, _) | Entry::PatchOutput(index, _) => {
                match self.outputs.get(&mut self.state, &self.catalogue)?[index] {
                    value if !value.is_finite() => {
                        Err(Error::NoValue { name: self.catalogue.find(reference, kind)?.name(), value })
                    }
                    value if kind == Kind::Real => Ok(Value::Real(value)),
                    // Saturates: a count is held at the largest Integer.
                    value => Ok(Value::Integer(value as i32)),
                }
            }
        }
    }

    /// fmi2GetReal: all of the values or none; asked for at every communication point, so nothing is allocated.
    pub(super) fn get_reals(&mut self, references: &[u32], values: &mut [f64]) -> Result<(), Error> {
        self.check(references, Kind::Real)?;
        for (target, &reference) in values.iter_mut().zip(references) {
            if let Value::Real(value) = self.get_one(reference, Kind::Real)? {
                *target = value;
            }
        }
        Ok(())
    }

    /// fmi2GetInteger: as [`get_reals`](Self::get_reals).
    pub(super) fn get_integers(&mut self, references: &[u32], values: &mut [i32]) -> Result<(), Error> {
        self.check(references, Kind::Integer)?;
        for (target, &reference) in values.iter_mut().zip(references) {
            if let Value::Integer(value) = self.get_one(reference, Kind::Integer)? {
                *target = value;
            }
        }
        Ok(())
    }

    /// Refuses what has no value of the type `kind`.
    fn check(&mut self, references: &[u32], kind: Kind) -> Result<(), Error> {
        references.iter().try_for_each(|&reference| self.get_one(reference, kind).map(|_| ()))
    }

    /// fmi2GetString: the strings remain until its next call.
    pub(super) fn get_strings(&mut self, references: &[u32]) -> Result<&[CString], Error> {
        let found = self.get(references, Kind::Text)?;
        let text = |value| if let Value::Text(text) = value { text } else { String::new() };
        self.texts = found.into_iter().map(|value| CString::new(text(value)).unwrap_or_default()).collect();
        Ok(&self.texts)
    }

    /// fmi2GetBoolean and fmi2SetBoolean: no variable is a Boolean, so every reference is refused.
    pub(super) fn refuse_booleans(&mut self, references: &[u32]) -> Result<(), Error> {
        references.iter().try_for_each(|&reference| self.catalogue.find(reference, Kind::Boolean).map(|_| ()))
    }

    /// fmi2SetReal, fmi2SetInteger and fmi2SetString: all of the values or none.
    ///
    /// An input that is not a number or out of range is accepted here and refused by the step: a master may set it as long
    /// as it does not ask the model to follow it.
    pub(super) fn set(&mut self, references: &[u32], values: impl Iterator<Item = Value>) -> Result<(), Error> {
        let mut parameters = Arc::clone(&self.state.parameters);
        let (mut inputs, mut patch_inputs) = (self.state.inputs, self.state.patch_inputs);
        for (&reference, value) in references.iter().zip(values) {
            match (self.catalogue.find(reference, kind_of(&value))?, value) {
                (Entry::Input(input), Value::Real(value)) => inputs.set_input(input, value),
                (Entry::PatchInput(input), Value::Real(value)) => {
                    patch_inputs.iter_mut().for_each(|inputs| inputs.set(input, value));
                }
                (entry @ Entry::Parameter(..), value) => self.set_parameter(&mut parameters, entry, value)?,
                (entry, _) => return Err(Error::OutputSet(entry.name())),
            }
        }
        self.state.parameters = parameters;
        (self.state.inputs, self.state.patch_inputs) = (inputs, patch_inputs);
        self.update_start();
        Ok(())
    }

    fn set_parameter(&self, parameters: &mut Arc<Parameters>, entry: Entry<'_>, value: Value) -> Result<(), Error> {
        let Entry::Parameter(parameter, _) = entry else { return Ok(()) };
        if !self.state.lifecycle.before_run() {
            return Err(Error::Late { name: entry.name(), state: self.state.lifecycle });
        }
        Ok(Arc::make_mut(parameters).set(parameter, value)?)
    }

    /// fmi2SetRealInputDerivatives: all of them or none.
    pub(super) fn set_rates(&mut self, references: &[u32], orders: &[i32], rates: &[f64]) -> Result<(), Error> {
        let (mut inputs, mut patch_inputs) = (self.state.inputs, self.state.patch_inputs);
        for ((&reference, &order), &rate) in references.iter().zip(orders).zip(rates) {
            match (self.catalogue.find(reference, Kind::Real)?, order) {
                (Entry::Input(input), 1) => inputs.set_rate(input, rate),
                (Entry::PatchInput(input), 1) => {
                    patch_inputs.iter_mut().for_each(|inputs| inputs.set_rate(input, rate));
                }
                (entry @ (Entry::Input(_) | Entry::PatchInput(_)), _) => {
                    return Err(Error::DerivativeOrder { name: entry.name(), order });
                }
                (entry, _) => return Err(Error::NoInput(entry.name())),
            }
        }
        (self.state.inputs, self.state.patch_inputs) = (inputs, patch_inputs);
        self.update_start();
        Ok(())
    }

    /// Inputs and parameters set before the run are those that it starts from. Inputs set later are those of the next step;
    /// the outputs remain those at the last communication point.
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
        direction: &[f64],
        values: &mut [f64],
    ) -> Result<(), Error> {
        if self.state.patch_inputs.is_some() {
            return self.patch_derivatives(unknowns, knowns, direction, values);
        }
        let unknowns = unknowns.iter().map(|&reference| self.unknown(reference)).collect::<Result<Vec<_>, _>>()?;
        let direction = self.direction(knowns, direction)?;
        let found = unknowns.iter().map(|unknown| self.directional_derivative(unknown, direction));
        let found = found.collect::<Result<Vec<_>, _>>()?;
        values.iter_mut().zip(found).for_each(|(target, value)| *target = value);
        Ok(())
    }

    fn unknown(&self, reference: u32) -> Result<Variable, Error> {
        match self.catalogue.find(reference, Kind::Real)? {
            Entry::Output(_, variable) if variable.is_output() => Ok(variable.clone()),
            entry => Err(Error::NoUnknown(entry.name())),
        }
    }

    /// The displacement of the carrier, or of a body's drive, along x and z.
    fn direction(&self, knowns: &[u32], steps: &[f64]) -> Result<(f64, f64), Error> {
        let (mut du, mut dw) = (0.0, 0.0);
        for (&reference, &step) in knowns.iter().zip(steps) {
            match self.catalogue.find(reference, Kind::Real)? {
                _ if !is_possible(step) => {
                    return Err(Error::OutOfRange { what: "a value of dvKnown", value: step });
                }
                Entry::Input(Input::U) => du += step,
                Entry::Input(Input::W) => dw += step,
                // Forces accelerate a body, a temperature acts from the next step on: nothing follows them at once.
                Entry::Input(Input::Load | Input::Pull | Input::Temperature) => (),
                entry => return Err(Error::NoKnown(entry.name())),
            }
        }
        Ok((du, dw))
    }

    fn directional_derivative(&mut self, unknown: &Variable, direction: (f64, f64)) -> Result<f64, Error> {
        // One table says what depends on what, here and in the model description.
        let direction = self.state.parameters.definition().dependencies(unknown.output).part_of(direction);
        let mut value = [0.0];
        self.state.model()?.directional_derivative(std::slice::from_ref(unknown), direction, &mut value);
        finite(&unknown.name, value[0])
    }

    /// fmi2GetRealOutputDerivatives: the first derivatives of F_x, F_z and the carrier's motion at the
    /// current time.
    pub(super) fn output_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
        values: &mut [f64],
    ) -> Result<(), Error> {
        let found = references.iter().zip(orders).map(|(&reference, &order)| self.output_derivative(reference, order));
        let found = found.collect::<Result<Vec<_>, _>>()?;
        values.iter_mut().zip(found).for_each(|(target, value)| *target = value);
        Ok(())
    }

    fn output_derivative(&mut self, reference: u32, order: i32) -> Result<f64, Error> {
        let entry = self.catalogue.find(reference, Kind::Real)?;
        if let Entry::PatchOutput(_, variable) = entry {
            let output = variable.output;
            return self.patch_rate(&entry.name(), output, order);
        }
        let name = entry.name();
        let output = match entry {
            Entry::Output(_, variable) if has_derivative(variable.output) => variable.output,
            _ => return Err(Error::NoOutputDerivative(name)),
        };
        if order != 1 {
            return Err(Error::DerivativeOrder { name, order });
        }
        finite(&name, self.state.model()?.output_rate(output))
    }
}

/// The derivatives of a patch.
impl Instance {
    fn patch_derivatives(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        steps: &[f64],
        values: &mut [f64],
    ) -> Result<(), Error> {
        let unknown = |&reference: &u32| match self.catalogue.find(reference, Kind::Real)? {
            Entry::PatchOutput(_, variable) if variable.is_output() => Ok(variable.clone()),
            entry => Err(Error::NoUnknown(entry.name())),
        };
        let unknowns = unknowns.iter().map(unknown).collect::<Result<Vec<_>, _>>()?;
        let direction = self.pose_direction(knowns, steps)?;
        let mut found = vec![0.0; unknowns.len()];
        let run = self.state.model()?.patch().ok_or(Error::NoRun)?;
        run.directional_derivative(&unknowns, direction, &mut found);
        for (unknown, value) in unknowns.iter().zip(&found) {
            finite(&unknown.name, *value)?;
        }
        values.iter_mut().zip(found).for_each(|(target, value)| *target = value);
        Ok(())
    }

    /// The change of the pose's coordinates. The speed of a tread and the temperature act from the next step on.
    fn pose_direction(&self, knowns: &[u32], steps: &[f64]) -> Result<[f64; 6], Error> {
        let mut direction = [0.0; 6];
        for (&reference, &step) in knowns.iter().zip(steps) {
            match self.catalogue.find(reference, Kind::Real)? {
                _ if !is_possible(step) => {
                    return Err(Error::OutOfRange { what: "a value of dvKnown", value: step });
                }
                Entry::PatchInput(PatchInput::Coordinate(i)) => direction[i] += step,
                Entry::PatchInput(_) => (),
                entry => return Err(Error::NoKnown(entry.name())),
            }
        }
        Ok(direction)
    }

    fn patch_rate(&mut self, name: &str, output: PatchOutput, order: i32) -> Result<f64, Error> {
        let run = self.state.model()?.patch().ok_or(Error::NoRun)?;
        let rate = run.rate(output).ok_or_else(|| Error::NoOutputDerivative(name.into()))?;
        if order == 1 { finite(name, rate) } else { Err(Error::DerivativeOrder { name: name.into(), order }) }
    }
}

/// Whether fmi2GetRealOutputDerivatives has the first derivative of an output.
fn has_derivative(output: Output) -> bool {
    use Output::{CarrierU, CarrierURate, CarrierW, CarrierWRate, DriveX, DriveZ, ForceX, ForceZ};
    matches!(output, ForceX | ForceZ | CarrierU | CarrierW | CarrierURate | CarrierWRate | DriveX | DriveZ)
}

fn kind_of(value: &Value) -> Kind {
    match value {
        Value::Real(_) => Kind::Real,
        Value::Integer(_) => Kind::Integer,
        Value::Text(_) => Kind::Text,
    }
}

fn finite(name: &str, value: f64) -> Result<f64, Error> {
    if value.is_finite() { Ok(value) } else { Err(Error::NoValue { name: format!("the derivative of {name}"), value }) }
}
