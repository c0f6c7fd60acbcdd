//! The subject with the parameters as set.

use std::collections::BTreeMap;

use super::subject::Subject;
use crate::scene::{Parameter, ParameterError, Value};

/// What is simulated and what the master set of it.
#[derive(Clone, Debug)]
pub(super) struct Parameters {
    subject: Subject,
    /// What was set, by the parameters' names: with the subject as it came, it gives the subject as it is. A parameter
    /// that follows another until it is set itself is not known by its value alone.
    set: BTreeMap<String, Value>,
}

impl Parameters {
    /// A subject as it came.
    pub(super) fn new(subject: Subject) -> Self {
        Self { subject, set: BTreeMap::new() }
    }

    /// The subject with the parameters as set.
    pub(super) fn subject(&self) -> &Subject {
        &self.subject
    }

    /// What was set.
    pub(super) fn values_set(&self) -> &BTreeMap<String, Value> {
        &self.set
    }

    /// Gives a parameter a value.
    pub(super) fn set(&mut self, parameter: Parameter, value: Value) -> Result<(), ParameterError> {
        self.subject.set_parameter(parameter, value.clone())?;
        self.set.insert(parameter.name(), value);
        Ok(())
    }
}
