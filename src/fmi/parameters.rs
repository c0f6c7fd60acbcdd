//! The scene with the parameters as set.

use std::collections::BTreeMap;

use crate::scene::{Parameter, ParameterError, Scene, Value};

/// A scene and what the master set of it.
#[derive(Clone, Debug)]
pub(super) struct Parameters {
    scene: Scene,
    /// What was set, by the parameters' names: with the scene as it came, it gives the scene as it is. A parameter that
    /// follows another until it is set itself is not known by its value alone.
    set: BTreeMap<String, Value>,
}

impl Parameters {
    /// A scene as it came.
    pub(super) fn new(scene: Scene) -> Self {
        Self { scene, set: BTreeMap::new() }
    }

    /// The scene with the parameters as set.
    pub(super) fn scene(&self) -> &Scene {
        &self.scene
    }

    /// What was set.
    pub(super) fn values_set(&self) -> &BTreeMap<String, Value> {
        &self.set
    }

    /// Gives a parameter a value.
    pub(super) fn set(&mut self, parameter: Parameter, value: Value) -> Result<(), ParameterError> {
        self.scene.set_parameter(parameter, value.clone())?;
        self.set.insert(parameter.name(), value);
        Ok(())
    }
}
