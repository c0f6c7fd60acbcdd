//! Getting and setting variables.

use std::ffi::CString;
use std::sync::Arc;

use crate::scene::Value;

use super::catalogue::{Catalogue, Entry, Kind};
use super::fault::Fault;
use super::instance::Instance;
use super::parameters::Parameters;
use super::run::Run;

/// The outputs at the last communication point, computed when first asked for.
#[derive(Debug, Default)]
pub(super) struct Outputs {
    values: Option<Vec<f64>>,
    spare: Vec<f64>,
}

impl Outputs {
    /// Something that they follow has changed.
    pub(super) fn outdate(&mut self) {
        if let Some(values) = self.values.take() {
            self.spare = values;
        }
    }

    fn get(&mut self, run: &mut Run, catalogue: &Catalogue) -> Result<&[f64], Fault> {
        if self.values.is_none() {
            let mut values = std::mem::take(&mut self.spare);
            values.resize(catalogue.outputs().len(), 0.0);
            run.plant()?.evaluate(catalogue.outputs(), &mut values);
            self.values = Some(values);
        }
        Ok(self.values.as_deref().unwrap_or_default())
    }
}

impl Instance {
    /// The values of variables of the type `kind`.
    fn get(&mut self, references: &[u32], kind: Kind) -> Result<Vec<Value>, Fault> {
        references.iter().map(|&reference| self.get_one(reference, kind)).collect()
    }

    fn get_one(&mut self, reference: u32, kind: Kind) -> Result<Value, Fault> {
        match self.catalogue.find(reference, kind)? {
            Entry::Input(input) => Ok(Value::Real(self.run.carrier.input(input))),
            Entry::Parameter(parameter, _) => Ok(self.run.parameters.subject().parameter(parameter)),
            Entry::Output(place, variable) => match self.outputs.get(&mut self.run, &self.catalogue)?[place] {
                value if !value.is_finite() => Err(Fault::NoValue { name: variable.name.clone(), value }),
                value if kind == Kind::Real => Ok(Value::Real(value)),
                // Saturates: a count is held at the largest Integer.
                value => Ok(Value::Integer(value as i32)),
            },
        }
    }

    /// fmi2GetReal: all of the values or none; asked for at every communication point, so nothing is allocated.
    pub(super) fn get_reals(&mut self, references: &[u32], values: &mut [f64]) -> Result<(), Fault> {
        self.check(references, Kind::Real)?;
        for (place, &reference) in values.iter_mut().zip(references) {
            if let Value::Real(value) = self.get_one(reference, Kind::Real)? {
                *place = value;
            }
        }
        Ok(())
    }

    /// fmi2GetInteger: as [`get_reals`](Self::get_reals).
    pub(super) fn get_integers(&mut self, references: &[u32], values: &mut [i32]) -> Result<(), Fault> {
        self.check(references, Kind::Integer)?;
        for (place, &reference) in values.iter_mut().zip(references) {
            if let Value::Integer(value) = self.get_one(reference, Kind::Integer)? {
                *place = value;
            }
        }
        Ok(())
    }

    /// Refuses what has no value of the type `kind`.
    fn check(&mut self, references: &[u32], kind: Kind) -> Result<(), Fault> {
        references.iter().try_for_each(|&reference| self.get_one(reference, kind).map(|_| ()))
    }

    /// fmi2GetString: the values stay until the next call of it.
    pub(super) fn get_strings(&mut self, references: &[u32]) -> Result<&[CString], Fault> {
        let found = self.get(references, Kind::Text)?;
        let text = |value| if let Value::Text(text) = value { text } else { String::new() };
        self.texts = found.into_iter().map(|value| CString::new(text(value)).unwrap_or_default()).collect();
        Ok(&self.texts)
    }

    /// fmi2GetBoolean and fmi2SetBoolean: no variable is a Boolean, so that every reference is refused.
    pub(super) fn refuse_booleans(&mut self, references: &[u32]) -> Result<(), Fault> {
        references.iter().try_for_each(|&reference| self.catalogue.find(reference, Kind::Boolean).map(|_| ()))
    }

    /// fmi2SetReal, fmi2SetInteger and fmi2SetString: all of the values or none.
    ///
    /// An input that is no number, or none that a carrier can be at, is taken here and refused by the step: a master
    /// may write it for as long as it does not ask the model to follow it.
    pub(super) fn set(&mut self, references: &[u32], values: impl Iterator<Item = Value>) -> Result<(), Fault> {
        let mut parameters = Arc::clone(&self.run.parameters);
        let mut carrier = self.run.carrier;
        for (&reference, value) in references.iter().zip(values) {
            match (self.catalogue.find(reference, kind_of(&value))?, value) {
                (Entry::Input(input), Value::Real(value)) => carrier.set_input(input, value),
                (entry @ Entry::Parameter(..), value) => self.set_parameter(&mut parameters, entry, value)?,
                (entry, _) => return Err(Fault::OutputSet(entry.name())),
            }
        }
        self.run.parameters = parameters;
        self.run.carrier = carrier;
        self.start_anew();
        Ok(())
    }

    fn set_parameter(&self, parameters: &mut Arc<Parameters>, entry: Entry<'_>, value: Value) -> Result<(), Fault> {
        let Entry::Parameter(parameter, _) = entry else { return Ok(()) };
        if !self.run.state.before_run() {
            return Err(Fault::Late { name: entry.name(), state: self.run.state });
        }
        Ok(Arc::make_mut(parameters).set(parameter, value)?)
    }

    /// fmi2SetRealInputDerivatives: all of them or none.
    pub(super) fn set_rates(&mut self, references: &[u32], orders: &[i32], rates: &[f64]) -> Result<(), Fault> {
        let mut carrier = self.run.carrier;
        for ((&reference, &order), &rate) in references.iter().zip(orders).zip(rates) {
            match (self.catalogue.find(reference, Kind::Real)?, order) {
                (Entry::Input(input), 1) => carrier.set_rate(input, rate),
                (Entry::Input(input), _) => return Err(Fault::DerivativeOrder { name: input.name().into(), order }),
                (entry, _) => return Err(Fault::NoInput(entry.name())),
            }
        }
        self.run.carrier = carrier;
        self.start_anew();
        Ok(())
    }

    /// Inputs and parameters set before the run are those that it starts from; set later, inputs are those of the next
    /// step, and the outputs stay what they were at the last communication point.
    fn start_anew(&mut self) {
        if self.run.state.before_run() {
            self.run.start_anew();
            self.outputs.outdate();
        }
    }
}

fn kind_of(value: &Value) -> Kind {
    match value {
        Value::Real(_) => Kind::Real,
        Value::Integer(_) => Kind::Integer,
        Value::Text(_) => Kind::Text,
    }
}
