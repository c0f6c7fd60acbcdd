//! Derivatives: of outputs by inputs with the states held, and of the forces by time.

use crate::outputs::{Output, Variable};
use crate::scene::is_possible;

use super::catalogue::{Entry, Input, Kind};
use super::fault::Fault;
use super::instance::Instance;

impl Instance {
    /// fmi2GetDirectionalDerivative: the unknowns are the Real outputs of the model structure, the knowns the inputs.
    pub(super) fn directional_derivatives(
        &mut self,
        unknowns: &[u32],
        (knowns, direction): (&[u32], &[f64]),
        values: &mut [f64],
    ) -> Result<(), Fault> {
        let unknowns = unknowns.iter().map(|&reference| self.unknown(reference)).collect::<Result<Vec<_>, _>>()?;
        let direction = self.direction(knowns, direction)?;
        let found = unknowns.iter().map(|unknown| self.directional_derivative(unknown, direction));
        let found = found.collect::<Result<Vec<_>, _>>()?;
        values.iter_mut().zip(found).for_each(|(place, value)| *place = value);
        Ok(())
    }

    fn unknown(&self, reference: u32) -> Result<Variable, Fault> {
        match self.catalogue.find(reference, Kind::Real)? {
            Entry::Output(_, variable) if variable.is_output() => Ok(variable.clone()),
            entry => Err(Fault::NoUnknown(entry.name())),
        }
    }

    /// How far the carrier moves along x and z.
    fn direction(&self, knowns: &[u32], steps: &[f64]) -> Result<(f64, f64), Fault> {
        let (mut du, mut dw) = (0.0, 0.0);
        for (&reference, &step) in knowns.iter().zip(steps) {
            match self.catalogue.find(reference, Kind::Real)? {
                _ if !is_possible(step) => {
                    return Err(Fault::OutOfRange { what: "a value of dvKnown", value: step });
                }
                Entry::Input(Input::U) => du += step,
                Entry::Input(Input::W) => dw += step,
                entry => return Err(Fault::NoKnown(entry.name())),
            }
        }
        Ok((du, dw))
    }

    fn directional_derivative(&mut self, unknown: &Variable, direction: (f64, f64)) -> Result<f64, Fault> {
        // One table says what depends on what, here and in the model description.
        let direction = self.run.parameters.subject().dependencies(unknown.output).part_of(direction);
        let mut value = [0.0];
        self.run.plant()?.directional_derivative(std::slice::from_ref(unknown), direction, &mut value);
        finite(&unknown.name, value[0])
    }

    /// fmi2GetRealOutputDerivatives: the first derivatives of F_x and F_z where the run stands.
    pub(super) fn output_derivatives(
        &mut self,
        references: &[u32],
        orders: &[i32],
        values: &mut [f64],
    ) -> Result<(), Fault> {
        let found = references.iter().zip(orders).map(|(&reference, &order)| self.output_derivative(reference, order));
        let found = found.collect::<Result<Vec<_>, _>>()?;
        values.iter_mut().zip(found).for_each(|(place, value)| *place = value);
        Ok(())
    }

    fn output_derivative(&mut self, reference: u32, order: i32) -> Result<f64, Fault> {
        let entry = self.catalogue.find(reference, Kind::Real)?;
        let name = entry.name();
        let of_x = match entry {
            Entry::Output(_, Variable { output: Output::ForceX, .. }) => true,
            Entry::Output(_, Variable { output: Output::ForceZ, .. }) => false,
            _ => return Err(Fault::NoOutputDerivative(name)),
        };
        if order != 1 {
            return Err(Fault::DerivativeOrder { name, order });
        }
        let (x, z) = self.run.plant()?.force_rates();
        finite(&name, if of_x { x } else { z })
    }
}

fn finite(name: &str, value: f64) -> Result<f64, Fault> {
    if value.is_finite() { Ok(value) } else { Err(Fault::NoValue { name: format!("the derivative of {name}"), value }) }
}
