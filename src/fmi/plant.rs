//! A run of what an FMU simulates.

use serde::{Deserialize, Serialize};

use super::fault::Fault;
use crate::element::{self, Element};
use crate::outputs::Variable;
use crate::simulation::{self, MethodSwitch, ModeChange, Motion, Simulation};

/// A run of a layer or of an element.
#[derive(Clone, Debug)]
pub(super) enum Plant {
    Layer(Box<Simulation>),
    Element(Box<Element>),
}

/// A run as it is written down.
#[derive(Serialize, Deserialize)]
pub(super) enum Saved {
    Layer(simulation::SimulationState),
    Element(element::ElementState),
}

impl Plant {
    /// Where the carrier stands: u and w, m.
    pub(super) fn carrier(&self) -> (f64, f64) {
        match self {
            Self::Layer(simulation) => simulation.carrier(),
            Self::Element(element) => element.carrier(),
        }
    }

    /// Follows the carrier straight on.
    pub(super) fn advance(&mut self, motion: &Motion) -> Result<(), Fault> {
        match self {
            Self::Layer(simulation) => simulation.advance(motion)?,
            Self::Element(element) => element.advance(motion.duration, motion.u.rate, motion.w.rate)?,
        }
        Ok(())
    }

    /// Writes the values of `variables`, in their order.
    pub(super) fn evaluate(&mut self, variables: &[Variable], values: &mut [f64]) {
        match self {
            Self::Layer(simulation) => simulation.evaluate(variables, values),
            Self::Element(element) => element.evaluate(variables, values),
        }
    }

    /// Writes how `variables` follow the carrier with the states held.
    pub(super) fn directional_derivative(&mut self, variables: &[Variable], direction: (f64, f64), values: &mut [f64]) {
        match self {
            Self::Layer(simulation) => simulation.directional_derivative(variables, direction, values),
            Self::Element(element) => element.directional_derivative(variables, direction, values),
        }
    }

    /// Ḟ_x and Ḟ_z, N/s.
    pub(super) fn force_rates(&mut self) -> (f64, f64) {
        match self {
            Self::Layer(simulation) => simulation.force_rates(),
            Self::Element(element) => element.force_rates(),
        }
    }

    /// Everything that the run has become.
    pub(super) fn save(&self) -> Saved {
        match self {
            Self::Layer(simulation) => Saved::Layer(simulation.state()),
            Self::Element(element) => Saved::Element(element.save()),
        }
    }

    /// Takes over the processor time that `other` has spent; an element counts none.
    pub(super) fn go_on_timing(&mut self, other: &Self) {
        if let (Self::Layer(simulation), Self::Layer(other)) = (self, other) {
            simulation.set_run_time(other.run_time());
        }
    }

    /// Keeps records of mode changes and of handovers, or stops keeping them.
    pub(super) fn record(&mut self, events: bool, handovers: bool) {
        match self {
            Self::Layer(simulation) => {
                simulation.record_mode_changes(events);
                simulation.record_method_switches(handovers);
            }
            Self::Element(element) => element.record_mode_changes(events),
        }
    }

    /// What was recorded since the last call.
    pub(super) fn take_records(&mut self) -> (Vec<ModeChange>, Vec<MethodSwitch>) {
        match self {
            Self::Layer(simulation) => (simulation.take_mode_changes(), simulation.take_method_switches()),
            Self::Element(element) => (element.take_mode_changes(), Vec::new()),
        }
    }

    /// The simulation of a layer, whose work can be told.
    pub(super) fn simulation(&mut self) -> Option<&mut Simulation> {
        match self {
            Self::Layer(simulation) => Some(simulation),
            Self::Element(_) => None,
        }
    }
}
