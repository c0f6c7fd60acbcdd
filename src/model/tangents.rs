//! Derivatives of what a master reads by what it sets.

use serde::{Deserialize, Serialize};

use crate::scene::{ByAxis, Input};

/// Derivatives of the run's forces and of its bodies' motion by the targets of its inputs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tangents {
    by_input: [TangentsOf; Input::MECHANICAL.len()],
}

/// The derivatives by the target of one input.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TangentsOf {
    /// Of F_x and F_z.
    pub force: ByAxis<f64>,
    /// Of the displacement and the speed of the bodies along x and z; 0 where the displacement is prescribed.
    pub body: ByAxis<[f64; 2]>,
}

impl Tangents {
    /// Those by the target of `input`, which moves the carrier.
    pub fn by(&self, input: Input) -> &TangentsOf {
        &self.by_input[input as usize]
    }

    /// Sets those by the target of `input`.
    pub fn set(&mut self, input: Input, tangents: TangentsOf) {
        self.by_input[input as usize] = tangents;
    }
}
