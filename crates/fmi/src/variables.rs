//! The variables of an FMU by value reference.

use std::collections::BTreeMap;
use std::fmt;

use super::error::Error;
use super::inputs::Inputs;
use asperity::outputs::{self, Dependencies, Output, Variable};
use asperity::scene::{Input, Parameter, Unit, Value};

/// The type of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// fmi2Real
    Real,
    /// fmi2Integer
    Integer,
    /// fmi2Boolean; no variable is one
    Boolean,
    /// fmi2String
    Text,
}

impl Kind {
    /// The type of a value.
    pub(super) fn new(value: &Value) -> Self {
        match value {
            Value::Real(_) => Self::Real,
            Value::Integer(_) => Self::Integer,
            Value::Text(_) => Self::Text,
        }
    }
}

impl From<outputs::OutputType> for Kind {
    fn from(kind: outputs::OutputType) -> Self {
        match kind {
            outputs::OutputType::Real => Self::Real,
            outputs::OutputType::Integer => Self::Integer,
        }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Real => "Real",
            Self::Integer => "Integer",
            Self::Boolean => "Boolean",
            Self::Text => "String",
        })
    }
}

/// What a variable is to a master.
#[derive(Clone, Debug, PartialEq)]
pub enum Role {
    /// An input: its slot in [`Inputs`](super::Inputs).
    Input(usize),
    /// An output: its index among the calculated variables, and the slots of the inputs that it depends on directly.
    Output {
        /// Its index among the calculated variables.
        index: usize,
        /// The slots of the inputs that it depends on directly.
        dependencies: Vec<usize>,
    },
    /// A calculated variable that is no output: its index among all that are calculated.
    Local(usize),
    /// A fixed parameter.
    Parameter(Parameter),
}

/// The variable behind a value reference.
#[derive(Clone, Debug, PartialEq)]
pub struct VariableRef {
    /// Its name.
    pub name: String,
    /// Its type.
    pub kind: Kind,
    /// The unit of a Real; 1 for everything else.
    pub unit: Unit,
    /// What it is, in a few words.
    pub description: String,
    /// The value before anything is set; calculated variables have none.
    pub start: Option<Value>,
    /// What it is to a master.
    pub role: Role,
}

impl VariableRef {
    /// An input, a Real, in a slot of [`Inputs`](super::Inputs).
    pub(super) fn input(slot: usize, name: &str, unit: Unit, description: &str, start: f64) -> Self {
        Self {
            name: name.into(),
            kind: Kind::Real,
            unit,
            description: description.into(),
            start: Some(Value::Real(start)),
            role: Role::Input(slot),
        }
    }

    /// The calculated variable with this index; the slots of the inputs that it depends on directly if it is an output.
    pub(super) fn calculated(
        index: usize,
        (name, description): (&str, &str),
        (kind, unit): (outputs::OutputType, Unit),
        dependencies: Option<Vec<usize>>,
    ) -> Self {
        let role = dependencies.map_or(Role::Local(index), |dependencies| Role::Output { index, dependencies });
        Self { name: name.into(), kind: kind.into(), unit, description: description.into(), start: None, role }
    }

    /// The output variables of a layer or an element.
    pub(super) fn from_outputs(variables: &[Variable], depends: impl Fn(Output) -> Dependencies) -> Vec<Self> {
        let variable = |(index, variable): (usize, &Variable)| {
            let Dependencies { on_u, on_w } = depends(variable.output);
            let slots = [on_u.then_some(Input::U as usize), on_w.then_some(Input::W as usize)];
            let dependencies = variable.is_output().then(|| slots.into_iter().flatten().collect());
            let texts = (variable.name.as_str(), variable.description.as_str());
            Self::calculated(index, texts, (variable.kind, variable.unit), dependencies)
        };
        variables.iter().enumerate().map(variable).collect()
    }

    /// A fixed parameter with its value.
    pub(super) fn parameter(parameter: Parameter, value: Value) -> Self {
        Self {
            name: parameter.name(),
            kind: Kind::new(&value),
            unit: parameter.unit(),
            description: parameter.description(),
            start: Some(value),
            role: Role::Parameter(parameter),
        }
    }

    /// Whether its value is calculated: an output or a local variable.
    pub fn is_calculated(&self) -> bool {
        matches!(self.role, Role::Output { .. } | Role::Local(_))
    }
}

/// The variables of an FMU by value reference: the inputs, then the calculated variables, then the parameters, numbered
/// from 0.
#[derive(Clone, Debug, PartialEq)]
pub struct VariableTable {
    variables: Vec<VariableRef>,
    calculated: usize,
}

impl VariableTable {
    /// The table of these variables.
    pub(super) fn new(variables: Vec<VariableRef>) -> Self {
        Self { calculated: variables.iter().filter(|variable| variable.is_calculated()).count(), variables }
    }

    /// The inputs at their start values.
    pub(super) fn start_inputs(&self) -> Inputs {
        let mut inputs = Inputs::default();
        for variable in &self.variables {
            if let (&Role::Input(slot), Some(&Value::Real(start))) = (&variable.role, variable.start.as_ref()) {
                inputs.set(slot, start);
            }
        }
        inputs
    }

    /// The name of the input in a slot.
    pub(super) fn input_name(&self, slot: usize) -> Option<&str> {
        let input = self.variables.iter().find(|variable| variable.role == Role::Input(slot))?;
        Some(&input.name)
    }

    /// The variable with the value reference `reference`.
    pub fn entry(&self, reference: u32) -> Option<&VariableRef> {
        self.variables.get(usize::try_from(reference).ok()?)
    }

    /// The variable with the value reference `reference`, of the type `asked` for.
    pub(super) fn find(&self, reference: u32, asked: Kind) -> Result<&VariableRef, Error> {
        let variable = self.entry(reference).ok_or(Error::UnknownReference(reference))?;
        if variable.kind == asked {
            return Ok(variable);
        }
        let (name, actual, asked) = (variable.name.clone(), variable.kind.to_string(), asked.to_string());
        Err(Error::WrongType { reference, name, actual, asked })
    }

    /// All variables with their value references, in rising order.
    pub fn entries(&self) -> impl Iterator<Item = (u32, &VariableRef)> {
        (0..).zip(&self.variables)
    }

    /// The same variables with names that have no structure: each point, bracket and comma is an underscore.
    ///
    /// # Errors
    /// Two names that would become one.
    pub fn flat(&self) -> Result<Self, [String; 2]> {
        let mut names: BTreeMap<String, &str> = BTreeMap::new();
        let mut table = self.clone();
        for (variable, own) in table.variables.iter_mut().zip(&self.variables) {
            variable.name = own.name.replace("].", "_").replace(']', "").replace(['.', '[', ','], "_");
            if let Some(other) = names.insert(variable.name.clone(), &own.name) {
                return Err([other.to_owned(), own.name.clone()]);
            }
        }
        Ok(table)
    }

    /// The number of calculated variables.
    pub(super) fn calculated(&self) -> usize {
        self.calculated
    }
}
