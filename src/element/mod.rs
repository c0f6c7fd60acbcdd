//! A point-contact element: the forces of a layer looked up in the table of a sweep instead of simulated.
//!
//! The carrier's height gives the pressure through the table's mean separation, its speed along x the friction
//! coefficient and the tangential stiffness; F_x is the force of a spring of that stiffness, limited by μ F_z: one
//! Jenkins element. So it knows what a layer does in steady sliding and at the start of motion, and nothing between: no
//! relaxation, no inertia, no position on the profile. Along z it is elastic at each speed and dissipates nothing.

mod error;
mod grid;
mod jenkins;
mod law;
mod outputs;
mod run;
mod table;
mod table_format;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use crate::outputs::Variable;
use crate::scene::{Extrapolation, Parameter, ParameterError, Problem, Value};

pub use error::{ElementError, RestoreError, TableError};
pub use grid::{Load, OperatingPoint, SweepGrid};
pub use law::{LeftOut, left_out};
pub use outputs::{dependencies, variables};
pub use run::{Element, ElementState};
pub use table::{Node, Table};
pub use table_format::{FORMAT, Quantity, STEADY, TableHeader, TableRow, TableText};

/// What an element does where its table ends, and whether it then goes on.
const TABLE_EXTRAPOLATIONS: [(&str, bool); 2] = [("refuse", false), ("hold", true)];

/// The definition of an element, as a [`Scene`](crate::scene::Scene) is that of a layer: a table and the parameters that
/// a master may set.
#[derive(Clone, Debug, PartialEq)]
pub struct PointContact {
    table: Arc<Table>,
    /// K; 0 where the table has none.
    temperature: f64,
    extrapolates_table: bool,
    /// How the carrier moves on when a master gives no rates.
    pub extrapolation: Extrapolation,
}

impl PointContact {
    /// An element of `table` at the middle one of its temperatures; motions beyond the table are refused.
    pub fn new(table: Table) -> Self {
        let temperatures = &table.grid.temperatures;
        let temperature = temperatures.get(temperatures.len() / 2).copied().unwrap_or(0.0);
        Self { temperature, table: Arc::new(table), extrapolates_table: false, extrapolation: Extrapolation::default() }
    }

    /// The table.
    pub fn table(&self) -> &Table {
        &self.table
    }

    /// The temperature, K; 0 where the table has none.
    pub fn temperature(&self) -> f64 {
        self.temperature
    }

    /// Whether the table is extrapolated; if not, a motion beyond it is refused.
    pub fn extrapolates_table(&self) -> bool {
        self.extrapolates_table
    }

    /// The model's name.
    pub fn name(&self) -> String {
        format!("{} element", self.table.scene)
    }

    /// What it is, in a sentence.
    pub fn description(&self) -> String {
        format!("Point-contact element from {} points swept of {}", self.table.grid.count(), self.table.scene)
    }

    /// Its output variables.
    pub fn variables(&self) -> Vec<Variable> {
        outputs::variables(&self.table)
    }

    /// Its parameters.
    pub fn parameters(&self) -> Vec<Parameter> {
        let temperature = (self.table.grid.temperatures.len() > 1).then_some(Parameter::Temperature);
        temperature.into_iter().chain([Parameter::TableExtrapolation, Parameter::Extrapolation]).collect()
    }

    /// The value of a parameter.
    pub fn parameter(&self, parameter: Parameter) -> Value {
        match parameter {
            Parameter::Temperature => Value::Real(self.temperature),
            Parameter::TableExtrapolation => {
                let word =
                    TABLE_EXTRAPOLATIONS.iter().find(|(_, extrapolates)| *extrapolates == self.extrapolates_table);
                Value::Text(word.map_or("", |(word, _)| word).into())
            }
            _ => Value::Text(self.extrapolation.word().into()),
        }
    }

    /// Gives a parameter a value.
    ///
    /// # Errors
    /// [`ParameterError`] where the value is none of those allowed; the element is then as it was.
    pub fn set_parameter(&mut self, parameter: Parameter, value: Value) -> Result<(), ParameterError> {
        let refuse = |expected: String| {
            Err(ParameterError::new(parameter.name(), Problem::Value { given: value.to_string(), expected }))
        };
        match (parameter, &value) {
            (Parameter::Temperature, &Value::Real(temperature)) => {
                let temperatures = &self.table.grid.temperatures;
                let (low, high) = (temperatures.first(), temperatures.last());
                match (low, high) {
                    (Some(low), Some(high)) if (low..=high).contains(&&temperature) => self.temperature = temperature,
                    (Some(low), Some(high)) => {
                        return refuse(format!("a number from {low:?} to {high:?}, the temperatures of the table"));
                    }
                    _ => return refuse("none: the table has no temperatures".into()),
                }
            }
            (Parameter::TableExtrapolation, Value::Text(word)) => {
                match TABLE_EXTRAPOLATIONS.iter().find(|(name, _)| name == word) {
                    Some((_, extrapolates)) => self.extrapolates_table = *extrapolates,
                    None => return refuse("one of \"refuse\", \"hold\"".into()),
                }
            }
            (Parameter::Extrapolation, Value::Text(word)) => match Extrapolation::of_word(word) {
                Some(extrapolation) => self.extrapolation = extrapolation,
                None => return refuse("one of \"linear\", \"hold\"".into()),
            },
            _ => return refuse(format!("a parameter of the element: {}", self.names().join(", "))),
        }
        Ok(())
    }

    fn names(&self) -> Vec<String> {
        self.parameters().into_iter().map(Parameter::name).collect()
    }
}
