//! An element as it is packed: its table and its parameters.

use std::sync::Arc;

use super::outputs;
use super::table::Table;
use crate::outputs::Variable;
use crate::scene::{Extrapolation, MaterialParameter, Parameter, ParameterError, Problem, Value};

/// What an element does where its table ends.
const BEYOND: [(&str, bool); 2] = [("refuse", false), ("hold", true)];

/// A table and what a master may set of it: as a [`Scene`](crate::scene::Scene) is to a layer.
#[derive(Clone, Debug, PartialEq)]
pub struct PointContact {
    table: Arc<Table>,
    /// K; 0 where the table has none.
    temperature: f64,
    goes_beyond: bool,
    /// How the carrier moves on when a master gives no rates.
    pub extrapolation: Extrapolation,
}

impl PointContact {
    /// An element of `table`, at the middle one of its temperatures, which refuses what lies beyond it.
    pub fn new(table: Table) -> Self {
        let temperatures = &table.temperatures;
        let temperature = temperatures.get(temperatures.len() / 2).copied().unwrap_or(0.0);
        Self { temperature, table: Arc::new(table), goes_beyond: false, extrapolation: Extrapolation::default() }
    }

    /// The table.
    pub fn table(&self) -> &Table {
        &self.table
    }

    /// The temperature, K; 0 where the table has none.
    pub fn temperature(&self) -> f64 {
        self.temperature
    }

    /// Whether the carrier may go beyond the table.
    pub fn goes_beyond(&self) -> bool {
        self.goes_beyond
    }

    /// The model's name.
    pub fn name(&self) -> String {
        format!("{} element", self.table.scene)
    }

    /// What it is, in a sentence.
    pub fn description(&self) -> String {
        format!("Point-contact element from {} points swept of {}", self.table.points(), self.table.scene)
    }

    /// Its output variables.
    pub fn variables(&self) -> Vec<Variable> {
        outputs::variables(&self.table)
    }

    /// Its parameters.
    pub fn parameters(&self) -> Vec<Parameter> {
        let temperature =
            (self.table.temperatures.len() > 1).then_some(Parameter::Material(MaterialParameter::Temperature));
        temperature.into_iter().chain([Parameter::TableExtrapolation, Parameter::Extrapolation]).collect()
    }

    /// The value of a parameter.
    pub fn parameter(&self, parameter: Parameter) -> Value {
        match parameter {
            Parameter::Material(MaterialParameter::Temperature) => Value::Real(self.temperature),
            Parameter::TableExtrapolation => {
                let word = BEYOND.iter().find(|(_, beyond)| *beyond == self.goes_beyond);
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
            (Parameter::Material(MaterialParameter::Temperature), &Value::Real(temperature)) => {
                let temperatures = &self.table.temperatures;
                let (low, high) = (temperatures.first(), temperatures.last());
                match (low, high) {
                    (Some(low), Some(high)) if (low..=high).contains(&&temperature) => self.temperature = temperature,
                    (Some(low), Some(high)) => {
                        return refuse(format!("a number from {low:?} to {high:?}, the temperatures of the table"));
                    }
                    _ => return refuse("none: the table has no temperatures".into()),
                }
            }
            (Parameter::TableExtrapolation, Value::Text(word)) => match BEYOND.iter().find(|(name, _)| name == word) {
                Some((_, beyond)) => self.goes_beyond = *beyond,
                None => return refuse("one of \"refuse\", \"hold\"".into()),
            },
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
