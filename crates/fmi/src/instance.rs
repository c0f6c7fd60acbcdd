//! An instance of the FMU, in safe Rust: the exports call its methods.

use std::ffi::CString;
use std::path::Path;
use std::sync::Arc;

use asperity::scene::{LOOSEST_TOLERANCE, Parameter, Value};

use super::definition::{Definition, Parameters, Sources, guid};
use super::error::{Error, Status, catch_panic, check_memory};
use super::fmu_states::{self, FmuStates};
use super::lifecycle::{Function, LifecycleState};
use super::log::{Category, Log, Message};
use super::state::{Clock, InstanceState, OutputCache};
use super::variables::VariableTable;

#[derive(Debug)]
pub(super) struct Instance {
    pub(super) variables: VariableTable,
    pub(super) state: InstanceState,
    pub(super) outputs: OutputCache,
    /// The strings that the last fmi2GetString returned.
    pub(super) texts: Vec<CString>,
    /// Whether it has warned of derivatives of inputs that it does not use.
    pub(super) warned_of_orders: bool,
    /// Whether it has warned of an input whose values come more seldom than steps.
    warned_of_interval: bool,
    /// Values looked up by a call that is under way.
    pub(super) found: Vec<Value>,
    fmu_states: FmuStates,
    /// What an FMU state takes, bytes: reckoned once, since parameters change neither masses nor elements.
    state_memory: usize,
    log: Log,
    guid: String,
    /// The parameters before any was set.
    original: Arc<Parameters>,
    logging: bool,
}

impl Instance {
    /// Reads the resources at `location`, or beside the `library`, and checks them against the GUID that the master
    /// passes.
    pub(super) fn new(given_guid: &str, location: &str, library: Option<&Path>, logging: bool) -> Result<Self, Error> {
        let (definition, found) = Definition::find(location, library)?;
        check_memory("an instance", definition.memory())?;
        let variables = definition.variables();
        let own = guid(&Sources::read_from(&found.path, &*definition)?, &variables);
        if bare(given_guid) != bare(&own) {
            return Err(Error::Guid { given: given_guid.into(), own });
        }
        let spelling = (given_guid != own).then(|| format!("the GUID is \"{given_guid}\": took it for \"{own}\""));
        let mut instance = Self::from_definition(definition, variables, own, logging);
        found.warning.into_iter().chain(spelling).for_each(|text| instance.warn(text));
        Ok(instance)
    }

    fn from_definition(definition: Definition, variables: VariableTable, guid: String, logging: bool) -> Self {
        let mut log = Log::new(logging);
        log.extend(definition.warnings().iter().map(|text| Message::from_status(Status::Warning, text.clone())));
        // With that at the start of the last step.
        let state_memory = definition.state_memory().saturating_mul(2);
        let original = Arc::new(Parameters::new(definition));
        Self {
            state: InstanceState::new(Arc::clone(&original), &variables),
            variables,
            outputs: OutputCache::default(),
            texts: Vec::new(),
            warned_of_orders: false,
            warned_of_interval: false,
            found: Vec::new(),
            fmu_states: FmuStates::default(),
            state_memory,
            log,
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

    /// Keeps a warning for the end of the call.
    pub(super) fn warn(&mut self, text: String) {
        self.log.add(Message::from_status(Status::Warning, text));
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

    /// fmi2SetupExperiment: the tolerance is the parameter `solver.relative_tolerance`, as if set now. Elements and
    /// patches have none, and no error in time to keep to it.
    pub(super) fn setup_experiment(
        &mut self,
        tolerance: Option<f64>,
        start: f64,
        stop: Option<f64>,
    ) -> Result<(), Error> {
        let clock = Clock::new(start, stop)?;
        let has_tolerance = self.state.parameters.definition().parameters().contains(&Parameter::RELATIVE_TOLERANCE);
        if let Some(tolerance) = tolerance.filter(|_| has_tolerance).and_then(|given| self.usable_tolerance(given)) {
            let parameters = Arc::make_mut(&mut self.state.parameters);
            parameters.set(Parameter::RELATIVE_TOLERANCE, Value::Real(tolerance))?;
        }
        self.state.clock = clock;
        self.state.discard_start();
        Ok(())
    }

    /// Masters pass 0 where they have no tolerance, and looser ones than a run can take.
    fn usable_tolerance(&mut self, given: f64) -> Option<f64> {
        if given == 0.0 {
            self.warn("the tolerance is 0: took it as not defined".into());
            None
        } else if given.is_finite() && given > LOOSEST_TOLERANCE {
            self.warn(format!("the tolerance is {given:?}: took {LOOSEST_TOLERANCE:?}, the loosest"));
            Some(LOOSEST_TOLERANCE)
        } else {
            Some(given)
        }
    }

    /// fmi2EnterInitializationMode
    pub(super) fn enter_initialization_mode(&mut self) -> Result<(), Error> {
        self.state.lifecycle = LifecycleState::InitializationMode;
        Ok(())
    }

    /// fmi2ExitInitializationMode: the run begins.
    pub(super) fn exit_initialization_mode(&mut self) -> Result<(), Error> {
        self.state.start()?;
        self.log_warnings();
        self.record_events();
        Ok(())
    }

    /// fmi2DoStep
    pub(super) fn do_step(&mut self, point: f64, h: f64) -> Result<(), Error> {
        let result = self.state.step(point, h);
        let time = self.state.clock.time;
        let repeated = self.state.repeated_from.take();
        let records = self.state.run().map(|run| run.take_records(time)).unwrap_or_default();
        // Records of a discarded step are dropped.
        result?;
        self.outputs.invalidate();
        self.log_repetition(repeated);
        self.log.extend(records);
        self.log_input_warnings();
        self.log_warnings();
        Ok(())
    }

    /// fmi2Terminate
    pub(super) fn terminate(&mut self) -> Result<(), Error> {
        self.state.lifecycle = LifecycleState::Terminated;
        let warning = self.state.run.as_mut().and_then(|run| run.final_warning());
        warning.into_iter().for_each(|text| self.warn(text));
        Ok(())
    }

    /// fmi2Reset: back to the state after fmi2Instantiate. The FMU states handed out remain until the master frees
    /// them.
    pub(super) fn reset(&mut self) -> Result<(), Error> {
        self.state = InstanceState::new(Arc::clone(&self.original), &self.variables);
        self.outputs.invalidate();
        self.texts.clear();
        self.warned_of_orders = false;
        self.warned_of_interval = false;
        self.log = Log::new(self.logging);
        Ok(())
    }

    /// fmi2GetFMUstate: takes and returns the state's handle, 0 for a new one.
    pub(super) fn get_state(&mut self, handle: usize) -> Result<usize, Error> {
        check_memory("an FMU state", self.state_memory)?;
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
        self.fmu_states.remove(handle)
    }

    /// fmi2SerializedFMUstateSize
    pub(super) fn serialised_size(&self, handle: usize) -> Result<usize, Error> {
        Ok(fmu_states::size(self.fmu_states.recall(handle)?, &self.guid)?)
    }

    /// fmi2SerializeFMUstate: the state `handle` as a byte string.
    pub(super) fn serialise_state(&self, handle: usize) -> Result<Vec<u8>, Error> {
        check_memory("an FMU state", self.serialised_size(handle)?)?;
        Ok(fmu_states::write(self.fmu_states.recall(handle)?, &self.guid)?)
    }

    /// fmi2DeSerializeFMUstate: keeps the state in `bytes` and returns its handle.
    pub(super) fn deserialise_state(&mut self, bytes: &[u8]) -> Result<usize, Error> {
        let definition = self.state.parameters.definition();
        // A run tells whether the state is one.
        check_memory("an FMU state", definition.memory().saturating_add(self.state_memory))?;
        let state = fmu_states::read(bytes, &self.guid, &self.original, &self.variables)?;
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

    /// Events and the solver's work are recorded only while they are logged.
    fn record_events(&mut self) {
        let (events, solver) = (self.log.includes(Category::Events), self.log.includes(Category::Solver));
        if let (false, Ok(run)) = (self.state.lifecycle.before_run(), self.state.run()) {
            run.record(events, solver);
        }
    }

    /// Mode changes that were logged of a step that has been done again since, from `start` (s) on, do not count.
    fn log_repetition(&mut self, start: Option<f64>) {
        let Some(start) = start else { return };
        for category in [Category::Events, Category::Solver] {
            if self.log.includes(category) {
                let text = format!("t = {start} s: the step from here is done again, to the values that came");
                self.log.add(Message::record(category, text));
            }
        }
    }

    /// Of inputs that a master sets in another way than it could, each once.
    fn log_input_warnings(&mut self) {
        let time = self.state.clock.time;
        if let Some(reason) = self.state.take_held() {
            self.warn(format!(
                "t = {time} s: the inputs were held over the step, for they could not be extrapolated: {reason}; this is \
                 said once a run"
            ));
        }
        let rule = self.state.parameters.definition().input_rule();
        let slow = self.state.slow_input().filter(|_| rule.interval == 0.0 && !self.warned_of_interval);
        if let Some((slot, seconds)) = slow {
            self.warned_of_interval = true;
            // Steps add up to it with their rounding.
            let seconds = format!("{seconds:.9e}").parse().unwrap_or(seconds);
            let name = self.variables.input_name(slot).unwrap_or_default();
            self.warn(format!(
                "t = {time} s: new values of {name} come every {seconds} s alone, and each is taken for a jump within one \
                 step; input.interval = {seconds} has it gone to over that time"
            ));
        }
    }

    fn log_warnings(&mut self) {
        let time = self.state.clock.time;
        let warnings = self.state.run.as_mut().map(|run| run.take_warnings(time)).unwrap_or_default();
        warnings.into_iter().for_each(|text| self.warn(text));
    }
}

/// A GUID without the braces, which some masters leave out, in small letters.
fn bare(guid: &str) -> String {
    guid.trim().trim_start_matches('{').trim_end_matches('}').to_ascii_lowercase()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::panic)]
pub(super) mod tests {
    use std::path::Path;

    use super::*;
    use asperity::scene::Scene;

    /// An instance of a scene with one mass.
    pub(in super::super) fn instance() -> Instance {
        instance_of("name = \"a\"\nlayer = { masses = 1, spacing = 1.0, mass = 1.0 }\nsurface = { kind = \"flat\" }")
    }

    /// An instance of a scene that reads no files.
    pub(in super::super) fn instance_of(text: &str) -> Instance {
        let scene = Scene::parse(text, Path::new("scene.toml")).unwrap();
        let definition = Definition::from(scene);
        let variables = definition.variables();
        Instance::from_definition(definition, variables, "{}".into(), false)
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
}
