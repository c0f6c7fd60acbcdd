//! What each value reference means.

use std::fmt;

use crate::outputs::{self, Variable};
use crate::scene::{Parameter, Scene, Value};

use super::fault::Fault;
use super::subject::Subject;

/// An input: a displacement of the carrier.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Input {
    /// `u`, along x.
    U,
    /// `w`, along z.
    W,
}

impl Input {
    /// Both, in the order of their value references.
    pub const ALL: [Self; 2] = [Self::U, Self::W];

    /// The variable's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::U => "u",
            Self::W => "w",
        }
    }
}

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

/// The variable behind a value reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Entry<'a> {
    /// An input, a Real.
    Input(Input),
    /// An output or, in the group elements, a local variable: the place in [`Catalogue::outputs`] and the variable.
    Output(usize, &'a Variable),
    /// A fixed parameter and its type.
    Parameter(Parameter, Kind),
}

impl Entry<'_> {
    /// The variable's name.
    pub fn name(&self) -> String {
        match self {
            Self::Input(input) => input.name().into(),
            Self::Output(_, variable) => variable.name.clone(),
            Self::Parameter(parameter, _) => parameter.name(),
        }
    }

    /// The variable's type.
    pub fn kind(&self) -> Kind {
        match self {
            Self::Input(_) => Kind::Real,
            Self::Output(_, variable) => match variable.kind {
                outputs::Kind::Real => Kind::Real,
                outputs::Kind::Integer => Kind::Integer,
            },
            Self::Parameter(_, kind) => *kind,
        }
    }
}

/// The variables of an FMU by value reference: the inputs, then the outputs, then the parameters, numbered from 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Catalogue {
    outputs: Vec<Variable>,
    parameters: Vec<(Parameter, Kind)>,
}

impl Catalogue {
    /// The variables of a scene's layer.
    pub fn new(scene: &Scene) -> Self {
        Self::of(&scene.clone().into())
    }

    /// The variables of what an FMU simulates.
    pub fn of(subject: &Subject) -> Self {
        let kind = |parameter| match subject.parameter(parameter) {
            Value::Real(_) => Kind::Real,
            Value::Integer(_) => Kind::Integer,
            Value::Text(_) => Kind::Text,
        };
        let parameters = subject.parameters().into_iter().map(|parameter| (parameter, kind(parameter))).collect();
        Self { outputs: subject.variables(), parameters }
    }

    /// The variable with the value reference `reference`.
    pub fn entry(&self, reference: u32) -> Option<Entry<'_>> {
        let place = usize::try_from(reference).ok()?;
        if let Some(&input) = Input::ALL.get(place) {
            return Some(Entry::Input(input));
        }
        let place = place - Input::ALL.len();
        if let Some(variable) = self.outputs.get(place) {
            return Some(Entry::Output(place, variable));
        }
        let &(parameter, kind) = self.parameters.get(place - self.outputs.len())?;
        Some(Entry::Parameter(parameter, kind))
    }

    /// The variable with the value reference `reference`, of the type `asked` for.
    pub(super) fn find(&self, reference: u32, asked: Kind) -> Result<Entry<'_>, Fault> {
        let entry = self.entry(reference).ok_or(Fault::UnknownReference(reference))?;
        match entry.kind() {
            kind if kind == asked => Ok(entry),
            actual => Err(Fault::WrongType { reference, name: entry.name(), actual, asked }),
        }
    }

    /// All variables with their value references, in rising order.
    pub fn entries(&self) -> impl Iterator<Item = (u32, Entry<'_>)> {
        (0..).map_while(|reference| Some((reference, self.entry(reference)?)))
    }

    /// The outputs in the order of their value references.
    pub fn outputs(&self) -> &[Variable] {
        &self.outputs
    }
}
