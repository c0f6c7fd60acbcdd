//! An instance of the FMU, in safe Rust: the exports call its methods.

use std::ffi::CString;
use std::sync::Arc;

use crate::outputs::{self, Output};
use crate::scene::{Parameter, Value};
use crate::simulation::{MethodSwitch, ModeChange};

use super::definition::{Catalogue, Definition, Parameters, Sources, guid};
use super::error::{Error, Status, catch_panic};
use super::fmu_states::{self, FmuStates};
use super::lifecycle::{Function, LifecycleState};
use super::log::{Category, Log, Message, RunWarnings};
use super::model::InstanceModel;
use super::state::{Clock, InstanceState, OutputCache};

#[derive(Debug)]
pub(super) struct Instance {
    pub(super) catalogue: Catalogue,
    pub(super) state: InstanceState,
    pub(super) outputs: OutputCache,
    /// The strings that the last fmi2GetString returned.
    pub(super) texts: Vec<CString>,
    fmu_states: FmuStates,
    log: Log,
    warnings: RunWarnings,
    guid: String,
    /// The parameters before any was set.
    original: Arc<Parameters>,
    logging: bool,
}

impl Instance {
    /// Reads the resources at `location` and checks them against the GUID that the master passes.
    pub(super) fn new(given_guid: &str, location: &str, logging: bool) -> Result<Self, Error> {
        let (definition, path) = Definition::find(location)?;
        let catalogue = Catalogue::of(&definition);
        let own = guid(&Sources::read_from(&path, &definition)?, &catalogue);
        if given_guid != own {
            return Err(Error::Guid { given: given_guid.into(), own });
        }
        Ok(Self::of(definition, catalogue, own, logging))
    }

    fn of(definition: Definition, catalogue: Catalogue, guid: String, logging: bool) -> Self {
        let mut log = Log::new(logging);
        for warning in definition.warnings() {
            log.add(Message::from_status(Status::Warning, warning.clone()));
        }
        let original = Arc::new(Parameters::new(definition));
        Self {
            catalogue,
            state: InstanceState::new(Arc::clone(&original)),
            outputs: OutputCache::default(),
            texts: Vec::new(),
            fmu_states: FmuStates::default(),
            log,
            warnings: RunWarnings::default(),
            guid,
            original,
            logging,
        }
    }

    /// Performs a call: refuses it where the life cycle does not allow it, and catches panics.
    pub(super) fn call(&mut self, function: Function, body: impl FnOnce(&mut Self) -> Result<(), Error>) -> Status {
        let result = catch_panic(|| {
            if !function.is_allowed(self.state.lifecycle) {
                return Err(Error::not_allowed(function, self.state.lifecycle));
            }
            body(self)
        });
        let result = result.unwrap_or_else(|panic| {
            self.state.lifecycle = LifecycleState::Fatal;
            Err(Error::Panic(panic))
        });
        let Err(error) = result else { return Status::Ok };
        self.log.add(Message::from_status(error.status(), format!("{function}: {error}")));
        error.status()
    }

    /// The messages of the last call.
    pub(super) fn take_messages(&mut self) -> Vec<Message> {
        self.log.take()
    }

    /// fmi2SetDebugLogging
    pub(super) fn set_debug_logging(&mut self, on: bool, categories: &[&str]) -> Result<(), Error> {
        self.log.select(on, categories)?;
        self.record_events();
        Ok(())
    }

    /// fmi2SetupExperiment: the tolerance is the parameter `solver.relative_tolerance`, as if set now. An element has
    /// none, and no error in time to keep to it.
    pub(super) fn setup_experiment(
        &mut self,
        tolerance: Option<f64>,
        start: f64,
        stop: Option<f64>,
    ) -> Result<(), Error> {
        let clock = Clock::new(start, stop)?;
        let has_tolerance = self.state.parameters.definition().parameters().contains(&Parameter::RelativeTolerance);
        if let Some(tolerance) = tolerance.filter(|_| has_tolerance) {
            let parameters = Arc::make_mut(&mut self.state.parameters);
            parameters.set(Parameter::RelativeTolerance, Value::Real(tolerance))?;
        }
        self.state.clock = clock;
        self.state.discard_start();
        Ok(())
    }

    /// fmi2EnterInitializationMode
    pub(super) fn enter_initialization_mode(&mut self) -> Result<(), Error> {
        self.state.lifecycle = LifecycleState::InitializationMode;
        Ok(())
    }

    /// fmi2ExitInitializationMode: the layer or the element is placed under the carrier.
    pub(super) fn exit_initialization_mode(&mut self) -> Result<(), Error> {
        self.state.start()?;
        self.log_patch_warning();
        self.warnings.start = Some(self.state.clock.time);
        self.record_events();
        Ok(())
    }

    /// fmi2DoStep
    pub(super) fn do_step(&mut self, point: f64, h: f64) -> Result<(), Error> {
        let result = self.state.step(point, h);
        let (events, switches) = self.take_records();
        // Events of a discarded step are dropped.
        result?;
        self.outputs.invalidate();
        self.log_events(&events);
        self.log_work(&switches);
        self.log_warnings();
        self.log_patch_warning();
        Ok(())
    }

    /// fmi2Terminate
    pub(super) fn terminate(&mut self) -> Result<(), Error> {
        self.state.lifecycle = LifecycleState::Terminated;
        if let Some(divergence) = self.state.model.as_ref().and_then(InstanceModel::divergence) {
            self.log.add(Message::from_status(Status::Warning, divergence.to_string()));
        }
        Ok(())
    }

    /// fmi2Reset: back to the state after fmi2Instantiate. The FMU states handed out remain until the master frees them.
    pub(super) fn reset(&mut self) -> Result<(), Error> {
        self.state = InstanceState::new(Arc::clone(&self.original));
        self.outputs.invalidate();
        self.texts.clear();
        self.log = Log::new(self.logging);
        self.warnings = RunWarnings::default();
        Ok(())
    }

    /// fmi2GetFMUstate: takes and returns the state's handle, 0 for a new one.
    pub(super) fn get_state(&mut self, handle: usize) -> Result<usize, Error> {
        if handle == 0 {
            return Ok(self.fmu_states.keep_new(self.state.save()));
        }
        self.state.save_into(self.fmu_states.recall_mut(handle)?);
        Ok(handle)
    }

    /// fmi2SetFMUstate
    pub(super) fn set_state(&mut self, handle: usize) -> Result<(), Error> {
        self.state.restore(self.fmu_states.recall(handle)?)?;
        self.outputs.invalidate();
        self.record_events();
        Ok(())
    }

    /// fmi2FreeFMUstate
    pub(super) fn free_state(&mut self, handle: usize) -> Result<(), Error> {
        self.fmu_states.forget(handle)
    }

    /// fmi2SerializedFMUstateSize
    pub(super) fn serialised_size(&self, handle: usize) -> Result<usize, Error> {
        Ok(fmu_states::size(self.fmu_states.recall(handle)?, &self.guid)?)
    }

    /// fmi2SerializeFMUstate: the state `handle` as a byte string.
    pub(super) fn serialise_state(&self, handle: usize) -> Result<Vec<u8>, Error> {
        Ok(fmu_states::write(self.fmu_states.recall(handle)?, &self.guid)?)
    }

    /// fmi2DeSerializeFMUstate: keeps the state in `bytes` and returns its handle.
    pub(super) fn deserialise_state(&mut self, bytes: &[u8]) -> Result<usize, Error> {
        let state = fmu_states::read(bytes, &self.guid, &self.original, &self.catalogue)?;
        Ok(self.fmu_states.keep_new(state))
    }

    /// The status of the last step.
    pub(super) fn last_step(&self) -> Status {
        self.state.last_step
    }

    /// The end of the last step that succeeded, s.
    pub(super) fn last_successful_time(&self) -> f64 {
        self.state.clock.time
    }

    /// Mode changes and switches are recorded only while they are logged.
    fn record_events(&mut self) {
        let (events, solver) = (self.log.includes(Category::Events), self.log.includes(Category::Solver));
        if let (false, Ok(model)) = (self.state.lifecycle.before_run(), self.state.model()) {
            model.record(events, solver);
        }
    }

    fn take_records(&mut self) -> (Vec<ModeChange>, Vec<MethodSwitch>) {
        self.state.model().map(InstanceModel::take_records).unwrap_or_default()
    }

    fn log_events(&mut self, events: &[ModeChange]) {
        let is_layer = matches!(self.state.parameters.definition(), Definition::Layer(_));
        for change in events {
            let text = event(change, is_layer);
            self.log.add(Message { status: Status::Ok, category: Category::Events, text });
        }
    }

    fn log_warnings(&mut self) {
        let Some(model) = &self.state.model else { return };
        for text in self.warnings.new_ones(self.state.parameters.definition(), model, self.state.clock.time) {
            self.log.add(Message::from_status(Status::Warning, text));
        }
    }

    /// An element beyond the table is told of once a run.
    fn log_patch_warning(&mut self) {
        let warning = self.state.model.as_mut().and_then(InstanceModel::patch).and_then(|run| run.take_warning());
        self.log.extend(warning.map(|text| Message::from_status(Status::Warning, text)));
    }

    fn log_work(&mut self, switches: &[MethodSwitch]) {
        for text in switches.iter().map(ToString::to_string) {
            self.log.add(Message { status: Status::Ok, category: Category::Solver, text });
        }
        let (true, Ok(model)) = (self.log.includes(Category::Solver), self.state.model()) else { return };
        let Some(simulation) = model.simulation() else { return };
        let mut values = [0.0; 3];
        let counts = [Output::Steps, Output::Rejected, Output::Events].into_iter().filter_map(outputs::variable);
        simulation.evaluate(&counts.collect::<Vec<_>>(), &mut values);
        let [steps, rejected, events] = values;
        let time = self.state.clock.time;
        let text = format!("t = {time} s: {steps} steps, {rejected} rejected, {events} mode changes since the start");
        self.log.add(Message { status: Status::Ok, category: Category::Solver, text });
    }
}

/// An element has no masses: its contact is one.
fn event(change: &ModeChange, is_layer: bool) -> String {
    let ModeChange { time, mass, from, to } = change;
    let what = if is_layer { format!("mass {}", mass + 1) } else { "the contact".into() };
    format!("t = {time} s: {what} from {} to {}", mode(*from), mode(*to))
}

fn mode(number: i8) -> &'static str {
    match number {
        0 => "free",
        1 => "slipping forwards",
        -1 => "slipping backwards",
        _ => "sticking",
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::panic)]
pub(super) mod tests {
    use std::path::Path;

    use super::*;
    use crate::scene::Scene;

    /// An instance of a scene with one mass.
    pub(in super::super) fn instance() -> Instance {
        instance_of("name = \"a\"\nlayer = { masses = 1, spacing = 1.0, mass = 1.0 }\nsurface = { kind = \"flat\" }")
    }

    /// An instance of a scene that reads no files.
    pub(in super::super) fn instance_of(text: &str) -> Instance {
        let scene = Scene::parse(text, Path::new("scene.toml")).unwrap();
        let catalogue = Catalogue::new(&scene);
        Instance::of(scene.into(), catalogue, "{}".into(), false)
    }

    #[test]
    fn a_panic_is_fatal_and_logged() {
        let mut instance = instance();
        assert_eq!(instance.call(Function::Reset, |_| panic!("lost a mass")), Status::Fatal);
        let logged = Message {
            status: Status::Fatal,
            category: Category::Error,
            text: "fmi2Reset: internal error, the instance is lost: lost a mass".into(),
        };
        assert_eq!(instance.take_messages(), [logged]);
        assert_eq!(instance.call(Function::Reset, Instance::reset), Status::Error);
        assert_eq!(instance.take_messages()[0].text, "fmi2Reset: not allowed in the state fatal");
    }

    #[test]
    fn mode_changes_are_logged_in_words() {
        let change = ModeChange { time: 0.5, mass: 2, from: 0, to: -1 };
        assert_eq!(event(&change, true), "t = 0.5 s: mass 3 from free to slipping backwards");
        assert_eq!(event(&change, false), "t = 0.5 s: the contact from free to slipping backwards");
    }
}
