//! An instance of the FMU, in safe Rust: the exports call its methods.

use std::ffi::CString;
use std::sync::Arc;

use crate::outputs::{self, Output};
use crate::scene::{Parameter, Value};
use crate::simulation::{MethodSwitch, ModeChange};

use super::beyond::Beyond;
use super::catalogue::Catalogue;
use super::clock::Clock;
use super::fault::{Fault, Status};
use super::guid::{Sources, guid};
use super::lifecycle::{Function, State};
use super::log::{Category, Log, Message};
use super::memory::Memory;
use super::panics;
use super::parameters::Parameters;
use super::plant::Plant;
use super::run::Run;
use super::serial;
use super::subject::Subject;
use super::values::Outputs;

/// An instance of the FMU.
#[derive(Debug)]
pub(super) struct Instance {
    pub(super) catalogue: Catalogue,
    pub(super) run: Run,
    pub(super) outputs: Outputs,
    /// What the last fmi2GetString returned.
    pub(super) texts: Vec<CString>,
    memory: Memory,
    log: Log,
    beyond: Beyond,
    guid: String,
    /// What fmi2Reset goes back to.
    original: Arc<Parameters>,
    logging: bool,
}

impl Instance {
    /// Reads the resources at `location` and checks that they are those that the master thinks they are.
    pub(super) fn new(given_guid: &str, location: &str, logging: bool) -> Result<Self, Fault> {
        let (subject, path) = Subject::find(location)?;
        let catalogue = Catalogue::of(&subject);
        let own = guid(&Sources::read_from(&path, &subject)?, &catalogue);
        if given_guid != own {
            return Err(Fault::Guid { given: given_guid.into(), own });
        }
        Ok(Self::of(subject, catalogue, own, logging))
    }

    fn of(subject: Subject, catalogue: Catalogue, guid: String, logging: bool) -> Self {
        let mut log = Log::new(logging);
        for warning in subject.warnings() {
            log.add(Message::of_status(Status::Warning, warning.clone()));
        }
        let original = Arc::new(Parameters::new(subject));
        Self {
            catalogue,
            run: Run::new(Arc::clone(&original)),
            outputs: Outputs::default(),
            texts: Vec::new(),
            memory: Memory::default(),
            log,
            beyond: Beyond::default(),
            guid,
            original,
            logging,
        }
    }

    /// What every call goes through: refused where it is out of place, and no panic leaves it.
    pub(super) fn call(&mut self, function: Function, body: impl FnOnce(&mut Self) -> Result<(), Fault>) -> Status {
        let result = panics::guard(|| {
            function.check(self.run.state)?;
            body(self)
        });
        let result = result.unwrap_or_else(|panic| {
            self.run.state = State::Fatal;
            Err(Fault::Panic(panic))
        });
        let Err(fault) = result else { return Status::Ok };
        self.log.add(Message::of_status(fault.status(), format!("{function}: {fault}")));
        fault.status()
    }

    /// The messages of the last call.
    pub(super) fn take_messages(&mut self) -> Vec<Message> {
        self.log.take()
    }

    /// fmi2SetDebugLogging
    pub(super) fn set_debug_logging(&mut self, on: bool, categories: &[&str]) -> Result<(), Fault> {
        self.log.ask_for(on, categories)?;
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
    ) -> Result<(), Fault> {
        let clock = Clock::new(start, stop)?;
        let has_tolerance = self.run.parameters.subject().parameters().contains(&Parameter::RelativeTolerance);
        if let Some(tolerance) = tolerance.filter(|_| has_tolerance) {
            let parameters = Arc::make_mut(&mut self.run.parameters);
            parameters.set(Parameter::RelativeTolerance, Value::Real(tolerance))?;
        }
        self.run.clock = clock;
        self.run.start_anew();
        Ok(())
    }

    /// fmi2EnterInitializationMode
    pub(super) fn enter_initialization_mode(&mut self) -> Result<(), Fault> {
        self.run.state = State::InitializationMode;
        Ok(())
    }

    /// fmi2ExitInitializationMode: the layer, or the element, is put under the carrier.
    pub(super) fn exit_initialization_mode(&mut self) -> Result<(), Fault> {
        self.run.start()?;
        self.beyond.start = Some(self.run.clock.time);
        self.record_events();
        Ok(())
    }

    /// fmi2DoStep
    pub(super) fn do_step(&mut self, point: f64, h: f64) -> Result<(), Fault> {
        let result = self.run.step(point, h);
        let (events, handovers) = self.take_records();
        // What a discarded step went through has not happened.
        result?;
        self.outputs.outdate();
        self.tell_events(&events);
        self.tell_work(&handovers);
        self.tell_beyond();
        Ok(())
    }

    /// fmi2Terminate
    pub(super) fn terminate(&mut self) -> Result<(), Fault> {
        self.run.state = State::Terminated;
        Ok(())
    }

    /// fmi2Reset: back to what fmi2Instantiate gave. The FMU states handed out stay the master's to free.
    pub(super) fn reset(&mut self) -> Result<(), Fault> {
        self.run = Run::new(Arc::clone(&self.original));
        self.outputs.outdate();
        self.texts.clear();
        self.log = Log::new(self.logging);
        self.beyond = Beyond::default();
        Ok(())
    }

    /// fmi2GetFMUstate: takes and gives the state's handle, 0 for a new one.
    pub(super) fn get_state(&mut self, handle: usize) -> Result<usize, Fault> {
        self.memory.keep(handle, &self.run)
    }

    /// fmi2SetFMUstate
    pub(super) fn set_state(&mut self, handle: usize) -> Result<(), Fault> {
        let mut run = self.memory.recall(handle)?.clone();
        run.go_on_timing(&self.run);
        self.run = run;
        self.outputs.outdate();
        self.record_events();
        Ok(())
    }

    /// fmi2FreeFMUstate
    pub(super) fn free_state(&mut self, handle: usize) -> Result<(), Fault> {
        self.memory.forget(handle)
    }

    /// fmi2SerializedFMUstateSize and fmi2SerializeFMUstate: the state `handle` as a byte string.
    pub(super) fn serialise_state(&self, handle: usize) -> Result<Vec<u8>, Fault> {
        Ok(serial::write(self.memory.recall(handle)?, &self.guid)?)
    }

    /// fmi2DeSerializeFMUstate: keeps the state in `bytes` and gives its handle.
    pub(super) fn deserialise_state(&mut self, bytes: &[u8]) -> Result<usize, Fault> {
        let mut run = serial::read(bytes, &self.guid, &self.original)?;
        serial::check_outputs(&mut run, self.catalogue.outputs())?;
        Ok(self.memory.keep_new(run))
    }

    /// The status of the last step.
    pub(super) fn last_step(&self) -> Status {
        self.run.last_step
    }

    /// The end of the last step that succeeded, s.
    pub(super) fn last_successful_time(&self) -> f64 {
        self.run.clock.time
    }

    /// Mode changes and handovers are recorded only while someone listens.
    fn record_events(&mut self) {
        let (events, solver) = (self.log.tells(Category::Events), self.log.tells(Category::Solver));
        if let (false, Ok(plant)) = (self.run.state.before_run(), self.run.plant()) {
            plant.record(events, solver);
        }
    }

    fn take_records(&mut self) -> (Vec<ModeChange>, Vec<MethodSwitch>) {
        self.run.plant().map(Plant::take_records).unwrap_or_default()
    }

    fn tell_events(&mut self, events: &[ModeChange]) {
        let is_layer = matches!(self.run.parameters.subject(), Subject::Layer(_));
        for change in events {
            let text = event(change, is_layer);
            self.log.add(Message { status: Status::Ok, category: Category::Events, text });
        }
    }

    fn tell_beyond(&mut self) {
        let Some(plant) = &self.run.plant else { return };
        for text in self.beyond.news(self.run.parameters.subject(), plant, self.run.clock.time) {
            self.log.add(Message::of_status(Status::Warning, text));
        }
    }

    fn tell_work(&mut self, handovers: &[MethodSwitch]) {
        for text in handovers.iter().map(ToString::to_string) {
            self.log.add(Message { status: Status::Ok, category: Category::Solver, text });
        }
        let (true, Ok(plant)) = (self.log.tells(Category::Solver), self.run.plant()) else { return };
        let Some(simulation) = plant.simulation() else { return };
        let mut values = [0.0; 3];
        let counts = [Output::Steps, Output::Rejected, Output::Events].into_iter().filter_map(outputs::variable);
        simulation.evaluate(&counts.collect::<Vec<_>>(), &mut values);
        let [steps, rejected, events] = values;
        let time = self.run.clock.time;
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
    fn a_panic_poisons_the_instance_and_is_told() {
        let mut instance = instance();
        assert_eq!(instance.call(Function::Reset, |_| panic!("lost a mass")), Status::Fatal);
        let told = Message {
            status: Status::Fatal,
            category: Category::Error,
            text: "fmi2Reset: internal error, the instance is lost: lost a mass".into(),
        };
        assert_eq!(instance.take_messages(), [told]);
        assert_eq!(instance.call(Function::Reset, Instance::reset), Status::Error);
        assert_eq!(instance.take_messages()[0].text, "fmi2Reset: not allowed in the state fatal");
    }

    #[test]
    fn mode_changes_are_told_in_words() {
        let change = ModeChange { time: 0.5, mass: 2, from: 0, to: -1 };
        assert_eq!(event(&change, true), "t = 0.5 s: mass 3 from free to slipping backwards");
        assert_eq!(event(&change, false), "t = 0.5 s: the contact from free to slipping backwards");
    }
}
