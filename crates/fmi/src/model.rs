//! What an FMU's model is: everything that the layers above ask of it, whatever it is. [`FmuModel`] is the definition
//! with its parameters, [`FmuRun`] a run of it.

use std::fmt::Debug;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::error::{Error, RestoreError};
use super::inputs::{CommunicationStep, InputScales, Inputs, MAX_INPUTS};
use super::log::Message;
use super::variables::{Kind, VariableRef, VariableTable};
use asperity::element::ElementState;
use asperity::patch::PatchState;
use asperity::scene::{self, FmuOptions, InputRule, IntegerType, Parameter, ParameterError, Value};
use asperity::seal::SealState;
use asperity::simulation::SimulationState;

/// A file that an FMU carries: its path relative to the definition's own, and what is in it.
pub type CarriedFile = (PathBuf, Vec<u8>);

/// Those of a definition in a folder, whose `content` is what it carries of a file.
///
/// # Errors
/// The first file that cannot be read.
pub(super) fn carried<'a>(
    folder: &Path,
    files: impl IntoIterator<Item = &'a PathBuf>,
    content: impl Fn(&Path) -> io::Result<Vec<u8>>,
) -> Result<Vec<CarriedFile>, (PathBuf, io::Error)> {
    let read = |file: &PathBuf| match content(file) {
        Ok(bytes) => Ok((file.clone(), bytes)),
        Err(error) => Err((folder.join(file), error)),
    };
    files.into_iter().map(read).collect()
}

/// What an FMU simulates, with its parameters as they are set.
pub trait FmuModel: Debug {
    /// The model's name.
    fn name(&self) -> String;

    /// The name as a C identifier.
    fn identifier(&self) -> String {
        scene::identifier(&self.name())
    }

    /// A description in a sentence; may be empty.
    fn description(&self) -> String;

    /// The name of its own file in the resources.
    fn file_name(&self) -> &'static str;

    /// The files that it reads besides its own as they are packed into an FMU: their paths relative to that one, and what
    /// is in them; `folder` is that of its own.
    ///
    /// # Errors
    /// Where a file cannot be read, with its path.
    fn carried(&self, _folder: &Path) -> Result<Vec<CarriedFile>, (PathBuf, io::Error)> {
        Ok(Vec::new())
    }

    /// Paths of all files that it was read from; `path` is that of its own.
    fn sources(&self, path: &Path) -> Vec<PathBuf> {
        vec![path.to_owned()]
    }

    /// Warnings about the definition.
    fn warnings(&self) -> &[String] {
        &[]
    }

    /// The inputs.
    fn inputs(&self) -> Vec<VariableRef>;

    /// The calculated variables.
    fn calculated(&self) -> Vec<VariableRef>;

    /// The parameters.
    fn parameters(&self) -> Vec<Parameter>;

    /// The value of a parameter.
    fn parameter(&self, parameter: Parameter) -> Value;

    /// Gives a parameter a value.
    ///
    /// # Errors
    /// [`ParameterError`] where the value is none of those allowed; the model is then as it was.
    fn set_parameter(&mut self, parameter: Parameter, value: Value) -> Result<(), ParameterError>;

    /// All variables by value reference.
    fn variables(&self) -> VariableTable {
        let parameter = |parameter| VariableRef::parameter(parameter, self.parameter(parameter));
        let parameters = self.parameters().into_iter().map(parameter);
        let mut calculated = self.calculated();
        if self.options().integers == IntegerType::Real {
            calculated.iter_mut().for_each(|variable| variable.kind = Kind::Real);
        }
        VariableTable::new(self.inputs().into_iter().chain(calculated).chain(parameters).collect())
    }

    /// How inputs go on where the master gives no derivatives.
    fn input_rule(&self) -> InputRule;

    /// When values that come are those that inputs went to.
    fn input_scales(&self) -> InputScales;

    /// Memory in bytes that an instance takes, its variables and a run. It is an upper bound that tests hold against
    /// what runs allocate.
    fn memory(&self) -> usize;

    /// Memory in bytes that an FMU state takes, likewise.
    fn state_memory(&self) -> usize;

    /// What its description says for simple importers.
    fn options(&self) -> FmuOptions {
        FmuOptions::default()
    }

    /// How it is simulated where nothing else is said; `None` where there is no default.
    fn default_experiment(&self) -> Option<Experiment>;

    /// Why no run begins at the start values of the inputs; `None` where one does.
    fn start_problem(&self) -> Option<String> {
        self.start(&self.variables().start_inputs(), 0.0).err().map(|error| error.to_string())
    }

    /// A run that starts from `inputs` at `time` (s).
    #[doc(hidden)]
    fn start(&self, inputs: &Inputs, time: f64) -> Result<Box<dyn FmuRun>, Error>;

    /// A run that continues from `state`.
    #[doc(hidden)]
    fn restore(&self, state: &RunState) -> Result<Box<dyn FmuRun>, RestoreError>;
}

/// A default experiment, which starts at 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Experiment {
    /// Its end, s; `None` where that is the master's to say.
    pub stop: Option<f64>,
    /// The relative tolerance; `None` where there is none.
    pub tolerance: Option<f64>,
    /// The communication step, s, not rounded yet.
    pub step: f64,
}

/// A run of a model.
pub trait FmuRun: Debug {
    /// Allows the steps that follow, together, the work of a call.
    fn allow_work(&mut self) {}

    /// Refuses steps that follow each other from `start` on where they are known to take more than is allowed.
    fn check_work(
        &self,
        _start: &RunState,
        _steps: &mut dyn Iterator<Item = (Inputs, CommunicationStep)>,
    ) -> Result<(), Error> {
        Ok(())
    }

    /// Follows the inputs over a communication step; the run is as it was where that fails.
    fn advance(&mut self, inputs: &Inputs, step: &CommunicationStep) -> Result<(), Error>;

    /// Writes the values of the calculated variables into `values`, in their order.
    fn evaluate(&mut self, values: &mut [f64]);

    /// Writes the derivatives of the calculated variables `outputs` as the inputs change by `direction`, all states
    /// held.
    fn directional_derivatives(&mut self, outputs: &[usize], direction: &[f64; MAX_INPUTS], values: &mut [f64]);

    /// The first derivative of a calculated variable, in its unit over s; `None` where it has none.
    fn output_rate(&mut self, output: usize) -> Option<f64>;

    /// A copy of its state.
    fn save(&self) -> RunState;

    /// As [`save`](Self::save), into one that there is.
    fn save_into(&self, saved: &mut RunState) {
        *saved = self.save();
    }

    /// Continues from `state`, which was checked where it was read, of a run of the same model.
    fn set_state(&mut self, state: &RunState) -> Result<(), RestoreError>;

    /// Counts a communication step that was done again from its start.
    fn count_repetition(&mut self) {}

    /// What it has done that is no part of its state.
    fn history(&self) -> RunRecord {
        RunRecord::default()
    }

    /// Takes over the history of the run that it continues.
    fn set_history(&mut self, _history: RunRecord) {}

    /// Starts or stops recording events and the solver's work.
    fn record(&mut self, _events: bool, _solver: bool) {}

    /// The records since the last call, at the time (s) reached.
    fn take_records(&mut self, _time: f64) -> Vec<Message> {
        Vec::new()
    }

    /// The warnings that have become due at the time (s) reached.
    fn take_warnings(&mut self, _time: f64) -> Vec<String> {
        Vec::new()
    }

    /// A warning that is given at the end of a run.
    fn final_warning(&mut self) -> Option<String> {
        None
    }
}

/// The state of a run, as an FMU state keeps it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub enum RunState {
    Layer(Box<SimulationState>),
    Element(ElementState),
    Patch(Box<PatchState>),
    Seal(Box<SealState>),
}

impl RunState {
    /// Copies `other`, into the arrays that there are where it is of the same model.
    pub(super) fn copy_from(&mut self, other: &Self) {
        match (self, other) {
            (Self::Layer(own), Self::Layer(other)) => own.copy_from(other),
            (Self::Patch(own), Self::Patch(other)) => own.copy_from(other),
            (Self::Seal(own), Self::Seal(other)) => own.clone_from(other),
            (own, other) => *own = other.clone(),
        }
    }
}

/// What a run has done that is no part of its state: a step that is repeated spends its time again but does not warn
/// again.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RunRecord {
    /// Processor time spent, s.
    pub run_time: f64,
    /// The time at which the run began, s; `None` where it is not known.
    pub start: Option<f64>,
    /// Whether it has warned that the layer left its profile.
    pub left_profile: bool,
    /// Whether it has warned that it is longer than the reduction of links assumes.
    pub exceeded_reduction: bool,
    /// Whether it has warned that friction does not follow so low a temperature.
    pub cold_contacts: bool,
}
