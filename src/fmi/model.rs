//! The model of an instance: a run of a layer, of an element or of a patch.

use serde::{Deserialize, Serialize};

use super::definition::{Catalogue, Definition};
use super::error::{Error, RestoreError};
use crate::element::{self, Element};
use crate::outputs::{Output, Variable};
use crate::patch::{PatchRun, PatchStart, PatchState};
use crate::simulation::{self, Divergence, MethodSwitch, ModeChange, Motion, Simulation, Start};

/// A run of a layer, of an element or of a patch.
#[derive(Clone, Debug)]
pub(super) enum InstanceModel {
    Layer(Box<Simulation>),
    Element(Box<Element>),
    Patch(Box<PatchRun>),
}

/// The state of an [`InstanceModel`], as an FMU state keeps it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) enum ModelState {
    Layer(Box<simulation::SimulationState>),
    Element(element::ElementState),
    Patch(Box<PatchState>),
}

impl InstanceModel {
    pub(super) fn start(definition: &Definition, start: &Start) -> Result<Self, Error> {
        Ok(match definition {
            Definition::Layer(scene) => Self::Layer(Box::new(Simulation::new(scene, start)?)),
            Definition::Element(contact) => Self::Element(Box::new(Element::new(contact, start)?)),
            // It has a start of its own.
            Definition::Patch(_) => return Err(Error::NoRun),
        })
    }

    pub(super) fn start_patch(definition: &Definition, start: &PatchStart) -> Result<Self, Error> {
        match definition {
            Definition::Patch(patch) => Ok(Self::Patch(Box::new(PatchRun::new(patch, start)?))),
            _ => Err(Error::NoRun),
        }
    }

    /// A run that continues from `state`.
    pub(super) fn restore(definition: &Definition, state: &ModelState) -> Result<Self, RestoreError> {
        Ok(match (definition, state) {
            (Definition::Layer(scene), ModelState::Layer(state)) => {
                Self::Layer(Box::new(Simulation::restore(scene, state)?))
            }
            (Definition::Element(contact), ModelState::Element(state)) => {
                Self::Element(Box::new(Element::restore(contact, state)?))
            }
            (Definition::Patch(patch), ModelState::Patch(state)) => {
                Self::Patch(Box::new(PatchRun::restore(patch, state)?))
            }
            _ => return Err(RestoreError::Invalid("its run is of something else")),
        })
    }

    /// Puts the model in `state`, of the same definition; that of a patch was checked where it was read. The processor
    /// time spent remains.
    pub(super) fn set_state(&mut self, definition: &Definition, state: &ModelState) -> Result<(), RestoreError> {
        match (&mut *self, state) {
            (Self::Layer(simulation), ModelState::Layer(state)) => simulation.set_state(state)?,
            (Self::Patch(run), ModelState::Patch(state)) => run.continue_from(state),
            _ => *self = Self::restore(definition, state)?,
        }
        Ok(())
    }

    /// The displacements u and w of the carrier, m.
    pub(super) fn carrier(&self) -> (f64, f64) {
        match self {
            Self::Layer(simulation) => simulation.carrier(),
            Self::Element(element) => element.carrier(),
            Self::Patch(_) => (0.0, 0.0),
        }
    }

    /// The displacements û and ŵ that follow the inputs: of the carrier, or of a body's drive, m.
    pub(super) fn driven(&self) -> (f64, f64) {
        match self {
            Self::Layer(simulation) => simulation.driven(),
            Self::Element(element) => element.carrier(),
            Self::Patch(_) => (0.0, 0.0),
        }
    }

    /// Advances to the end of `motion`, which is straight.
    pub(super) fn advance(&mut self, motion: &Motion) -> Result<(), Error> {
        match self {
            Self::Layer(simulation) => simulation.advance(motion)?,
            Self::Element(element) => element.advance(motion.duration, motion.u.rate, motion.w.rate)?,
            // It has a motion of its own.
            Self::Patch(_) => return Err(Error::NoRun),
        }
        Ok(())
    }

    /// Writes the values of all outputs into `values`, in their order.
    pub(super) fn evaluate(&mut self, catalogue: &Catalogue, values: &mut [f64]) {
        match self {
            Self::Layer(simulation) => simulation.evaluate(catalogue.outputs(), values),
            Self::Element(element) => element.evaluate(catalogue.outputs(), values),
            Self::Patch(run) => run.evaluate(catalogue.patch_outputs(), values),
        }
    }

    /// Writes the derivatives of `variables` along a displacement `direction` of the carrier (m), at constant states.
    pub(super) fn directional_derivative(&mut self, variables: &[Variable], direction: (f64, f64), values: &mut [f64]) {
        match self {
            Self::Layer(simulation) => simulation.directional_derivative(variables, direction, values),
            Self::Element(element) => element.directional_derivative(variables, direction, values),
            Self::Patch(_) => values.fill(0.0),
        }
    }

    /// The first derivative of F_x, F_z or a variable of the carrier's motion, in its unit over s; 0 for other outputs.
    pub(super) fn output_rate(&mut self, output: Output) -> f64 {
        match (self, output) {
            (Self::Layer(simulation), _) => simulation.output_rate(output),
            (Self::Element(element), Output::ForceX) => element.force_rates().0,
            (Self::Element(element), Output::ForceZ) => element.force_rates().1,
            (Self::Element(_) | Self::Patch(_), _) => 0.0,
        }
    }

    pub(super) fn state(&self) -> ModelState {
        match self {
            Self::Layer(simulation) => ModelState::Layer(Box::new(simulation.state())),
            Self::Element(element) => ModelState::Element(element.save()),
            Self::Patch(run) => ModelState::Patch(Box::new(run.save())),
        }
    }

    /// As [`state`](Self::state), into one that there is.
    pub(super) fn save_into(&self, saved: &mut ModelState) {
        match (self, &mut *saved) {
            (Self::Patch(run), ModelState::Patch(saved)) => run.save_into(saved),
            _ => *saved = self.state(),
        }
    }

    /// Takes over the processor time that `other` has spent, which is not part of the state; an element counts none.
    pub(super) fn take_over_run_time(&mut self, other: &Self) {
        if let (Self::Layer(simulation), Self::Layer(other)) = (self, other) {
            simulation.set_run_time(other.run_time());
        }
    }

    /// Why the run does not converge, if it shows; elements have no steps.
    pub(super) fn divergence(&self) -> Option<Divergence> {
        match self {
            Self::Layer(simulation) => simulation.divergence(),
            Self::Element(_) | Self::Patch(_) => None,
        }
    }

    /// Starts or stops recording mode changes and switches.
    pub(super) fn record(&mut self, events: bool, switches: bool) {
        match self {
            Self::Layer(simulation) => {
                simulation.record_mode_changes(events);
                simulation.record_method_switches(switches);
            }
            Self::Element(element) => element.record_mode_changes(events),
            Self::Patch(_) => (),
        }
    }

    /// The records since the last call.
    pub(super) fn take_records(&mut self) -> (Vec<ModeChange>, Vec<MethodSwitch>) {
        match self {
            Self::Layer(simulation) => (simulation.take_mode_changes(), simulation.take_method_switches()),
            Self::Element(element) => (element.take_mode_changes(), Vec::new()),
            Self::Patch(_) => (Vec::new(), Vec::new()),
        }
    }

    /// The run of a patch.
    pub(super) fn patch(&mut self) -> Option<&mut PatchRun> {
        if let Self::Patch(run) = self { Some(run) } else { None }
    }

    /// The simulation of a layer, which counts its work.
    pub(super) fn simulation(&mut self) -> Option<&mut Simulation> {
        match self {
            Self::Layer(simulation) => Some(simulation),
            Self::Element(_) | Self::Patch(_) => None,
        }
    }
}
