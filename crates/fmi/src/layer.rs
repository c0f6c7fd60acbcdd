//! The layer of a scene as an FMU's model. Between communication points û is continuous and runs straight to a target;
//! a force runs straight, too, and may jump at a point; a temperature is held.

use std::path::{Path as FilePath, PathBuf};
use std::sync::Arc;
use std::{io, slice};

use super::error::{Error, InputOutOfRange, RestoreError};
use super::inputs::{CommunicationStep, InputKind, InputScales, Inputs, MAX_INPUTS};
use super::log::{Category, Message};
use super::model::{CarriedFile, Experiment, FmuModel, FmuRun, RunRecord, RunState};
use super::resources::SCENE_FILE;
use super::variables::VariableRef;
use asperity::model::{FlashKernel, Reduction, Replacement};
use asperity::outputs::{self, Output, Variable};
use asperity::scene::{
    FmuOptions, Force, Input, InputRule, LinkKind, OutputGroup, Parameter, ParameterError, Path, Scene, SceneFile,
    Value,
};
use asperity::simulation::{Motion, Simulation, Start};

impl FmuModel for Arc<Scene> {
    fn name(&self) -> String {
        self.name.clone()
    }

    fn description(&self) -> String {
        self.description.clone().unwrap_or_default()
    }

    fn file_name(&self) -> &'static str {
        SCENE_FILE
    }

    fn carried(&self, _folder: &FilePath) -> Result<Vec<CarriedFile>, (PathBuf, io::Error)> {
        let content = |file: &SceneFile| Some((file.carried_name.clone(), file.carried()?));
        Ok(self.files.iter().filter_map(content).collect())
    }

    fn sources(&self, path: &FilePath) -> Vec<PathBuf> {
        Scene::sources(self, path)
    }

    fn warnings(&self) -> &[String] {
        &self.warnings
    }

    fn inputs(&self) -> Vec<VariableRef> {
        let variable = |input: Input| {
            let has_body = input.axis().is_some_and(|axis| self.carrier[axis].is_some());
            let (text, start) = (input_description(input, has_body), self.input_start(input));
            VariableRef::input(input as usize, input.name(), input.unit(), text, start)
        };
        Scene::inputs(self).into_iter().map(variable).collect()
    }

    fn calculated(&self) -> Vec<VariableRef> {
        VariableRef::from_outputs(&outputs::variables(self), |output| outputs::dependencies(self, output))
    }

    fn parameters(&self) -> Vec<Parameter> {
        Scene::parameters(self)
    }

    /// Of `solver.max_steps` where the scene does not name it what a call allows.
    fn parameter(&self, parameter: Parameter) -> Value {
        match Scene::parameter(self, parameter) {
            Value::Integer(_) if parameter == Parameter::MAX_STEPS && self.solver.max_steps.is_none() => {
                Value::Integer(Simulation::steps_within(self, MAX_MASS_STEPS).try_into().unwrap_or(i32::MAX))
            }
            value => value,
        }
    }

    fn set_parameter(&mut self, parameter: Parameter, value: Value) -> Result<(), ParameterError> {
        Arc::make_mut(self).set_parameter(parameter, value)
    }

    fn input_rule(&self) -> InputRule {
        self.input_rule
    }

    fn input_scales(&self) -> InputScales {
        layer_scales(self)
    }

    fn memory(&self) -> usize {
        /// Of a mass's variables, five with their names in two places.
        const VARIABLES: usize = 5 * 512;
        let variables = if self.outputs.contains(&OutputGroup::Elements) { VARIABLES } else { 0 };
        (1 << 20) + self.layer.masses * variables + Simulation::memory(self)
    }

    fn state_memory(&self) -> usize {
        /// Of a mass; of each of its elements.
        const MASS: usize = 192;
        const ELEMENT: usize = 8;
        (1 << 14) + runs(self) * self.layer.masses * (MASS + ELEMENT * elements(self))
    }

    fn options(&self) -> FmuOptions {
        self.fmu
    }

    /// The excitation's duration; a scene without one has no default.
    fn default_experiment(&self) -> Option<Experiment> {
        /// Communication steps that it takes, roughly.
        const STEPS: f64 = 500.0;
        // A sum of decimals without its rounding error: 0.014 for 0.01 + 0.001 + 0.003, which is 0.013999999999999999.
        let stop = format!("{:.14e}", self.duration()).parse().unwrap_or(self.duration());
        let tolerance = Some(self.solver.relative_tolerance);
        (stop > 0.0).then_some(Experiment { stop: Some(stop), tolerance, step: stop / STEPS })
    }

    fn start(&self, inputs: &Inputs, time: f64) -> Result<Box<dyn FmuRun>, Error> {
        let simulation = Simulation::new(self, &layer_start(self, inputs, time))?;
        Ok(Box::new(LayerRun::new(self, simulation, Some(time))))
    }

    fn restore(&self, state: &RunState) -> Result<Box<dyn FmuRun>, RestoreError> {
        let RunState::Layer(state) = state else { return Err(RestoreError::OTHER_MODEL) };
        Ok(Box::new(LayerRun::new(self, Simulation::restore(self, state)?, None)))
    }
}

/// Maxwell elements of a mass, and the parts of its flash temperature, which relax as these do.
fn elements(scene: &Scene) -> usize {
    let maxwell: usize =
        LinkKind::ALL.into_iter().filter_map(|kind| scene.link(kind)).map(|link| link.maxwell.len()).sum();
    maxwell + if scene.has_heat() { FlashKernel::TERMS } else { 0 }
}

/// With the more accurate one beside it.
fn runs(scene: &Scene) -> usize {
    if scene.outputs.contains(&OutputGroup::Solver) { 2 } else { 1 }
}

fn input_description(input: Input, has_body: bool) -> &'static str {
    match (input, has_body) {
        (Input::U, false) => "Displacement of the carrier along x",
        (Input::W, false) => "Displacement of the carrier along z, negative presses",
        (Input::U, true) => "Displacement along x of the drive of the carrier",
        (Input::W, true) => "Displacement along z of the drive of the carrier",
        (Input::Load, _) => "Normal load on the carrier, without its constant part; positive presses",
        (Input::Temperature, _) => "Bulk temperature of the layer, held over each communication step",
        (Input::Pull, _) => "Tangential force on the carrier along x, without its constant part",
    }
}

/// When values that come are those that the inputs went to: a temperature is held.
pub fn layer_scales(scene: &Scene) -> InputScales {
    let kind = |input: Input| match input {
        Input::U | Input::W => InputKind::Length,
        Input::Load | Input::Pull => InputKind::Other,
        Input::Temperature => InputKind::Held,
    };
    InputScales::new(scene.inputs().into_iter().map(|input| (input as usize, kind(input))), scene.layer.spacing)
}

/// The carrier at the start: at the displacements given, with the derivatives given as its velocity, else at rest. The
/// derivatives remain those of the first step unless the master sets others.
pub fn layer_start(scene: &Scene, inputs: &Inputs, time: f64) -> Start {
    let value = |input: Input| inputs.value(input as usize);
    let rate = |input: Input| inputs.rate(input as usize);
    Start {
        time,
        u: value(Input::U),
        w: value(Input::W),
        u_rate: rate(Input::U),
        w_rate: rate(Input::W),
        load: value(Input::Load),
        pull: value(Input::Pull),
        temperature: scene.temperature_input.then(|| value(Input::Temperature)),
    }
}

/// The motion over a communication step: straight from û and ŵ (m), where they are, to their targets. Forces start from
/// the values given.
///
/// # Errors
/// [`InputOutOfRange`].
pub fn layer_motion(
    scene: &Scene,
    inputs: &Inputs,
    (u, w): (f64, f64),
    step: &CommunicationStep,
) -> Result<Motion, InputOutOfRange> {
    let path = |rate| Path { rate, ..Path::default() };
    let displacement = |input: Input, from| inputs.rate_from(from, input as usize, input.name(), step).map(path);
    let force = |input: Input| {
        let change = inputs.rate_from_value(input as usize, input.name(), step).map(path)?;
        Ok(Force { start: Some(inputs.value(input as usize)), change })
    };
    Ok(Motion {
        duration: step.h,
        u: displacement(Input::U, u)?,
        w: displacement(Input::W, w)?,
        load: force(Input::Load)?,
        pull: force(Input::Pull)?,
        temperature: scene.temperature_input.then(|| inputs.value(Input::Temperature as usize)),
    })
}

/// The largest displacement, m, whose rounding is below a thousandth of the profile's finest step and of the spacing of
/// the masses. Farther away slopes and contacts are those of rounding, and steps have no end.
fn farthest(scene: &Scene) -> f64 {
    const SHARE: f64 = 1e-3;
    let steps = scene.surface.x().windows(2).map(|pair| pair[1] - pair[0]);
    SHARE * steps.fold(scene.layer.spacing, f64::min) / f64::EPSILON
}

/// The work of a call where no `solver.max_steps` is given, that of a step which is done again in it: steps times masses,
/// of the run and of the reference run each. It takes some seconds at most; a master that diverges would wait for minutes
/// otherwise.
const MAX_MASS_STEPS: u64 = 500_000;

/// A run of the layer.
#[derive(Debug)]
struct LayerRun {
    scene: Arc<Scene>,
    variables: Vec<Variable>,
    simulation: Simulation,
    history: RunRecord,
    /// The largest displacement, m, that rounding leaves accurate.
    farthest: f64,
    /// Whether the solver's work is recorded.
    records_work: bool,
}

impl FmuRun for LayerRun {
    fn allow_work(&mut self) {
        if self.scene.solver.max_steps.is_none() {
            self.simulation.limit_work(MAX_MASS_STEPS);
        }
    }

    fn advance(&mut self, inputs: &Inputs, step: &CommunicationStep) -> Result<(), Error> {
        for input in [Input::U, Input::W] {
            let target = inputs.target(input as usize, input.name(), step)?;
            if target.abs() > self.farthest {
                let (name, farthest) = (input.name(), self.farthest);
                return Err(Error::TooFar { name, value: target, farthest });
            }
        }
        let motion = layer_motion(&self.scene, inputs, self.simulation.driven(), step)?;
        Ok(self.simulation.advance(&motion)?)
    }

    fn evaluate(&mut self, values: &mut [f64]) {
        self.simulation.evaluate(&self.variables, values);
    }

    /// Forces accelerate a body, a temperature acts from the next step on: nothing follows them at once.
    fn directional_derivatives(&mut self, outputs: &[usize], direction: &[f64; MAX_INPUTS], values: &mut [f64]) {
        let direction = (direction[Input::U as usize], direction[Input::W as usize]);
        for (&output, value) in outputs.iter().zip(values) {
            let variable = &self.variables[output];
            // One table says what depends on what, here and in the model description.
            let direction = outputs::dependencies(&self.scene, variable.output).part_of(direction);
            self.simulation.directional_derivative(slice::from_ref(variable), direction, slice::from_mut(value));
        }
    }

    fn output_rate(&mut self, output: usize) -> Option<f64> {
        use Output::{CarrierU, CarrierURate, CarrierW, CarrierWRate, DriveX, DriveZ, ForceX, ForceZ};
        let output = self.variables[output].output;
        let has_rate =
            matches!(output, ForceX | ForceZ | CarrierU | CarrierW | CarrierURate | CarrierWRate | DriveX | DriveZ);
        has_rate.then(|| self.simulation.output_rate(output))
    }

    fn save(&self) -> RunState {
        RunState::Layer(Box::new(self.simulation.state()))
    }

    fn save_into(&self, saved: &mut RunState) {
        match saved {
            RunState::Layer(saved) => self.simulation.save_into(saved),
            _ => *saved = self.save(),
        }
    }

    fn set_state(&mut self, state: &RunState) -> Result<(), RestoreError> {
        let RunState::Layer(state) = state else { return Err(RestoreError::OTHER_MODEL) };
        Ok(self.simulation.continue_from(state)?)
    }

    fn count_repetition(&mut self) {
        self.simulation.count_repetition();
    }

    fn history(&self) -> RunRecord {
        RunRecord { run_time: self.simulation.run_time(), ..self.history }
    }

    fn set_history(&mut self, history: RunRecord) {
        self.simulation.set_run_time(history.run_time);
        self.history = history;
    }

    fn record(&mut self, events: bool, solver: bool) {
        self.records_work = solver;
        self.simulation.record_mode_changes(events);
        self.simulation.record_method_switches(solver);
    }

    fn take_records(&mut self, time: f64) -> Vec<Message> {
        let events = self.simulation.take_mode_changes();
        let events =
            events.iter().map(|change| Message::from_mode_change(change, &format!("mass {}", change.mass + 1)));
        let switches = self.simulation.take_method_switches();
        let switches = switches.iter().map(|switch| Message::record(Category::Solver, switch.to_string()));
        let mut messages: Vec<_> = events.chain(switches).collect();
        if self.records_work {
            messages.push(Message::record(Category::Solver, self.work(time)));
        }
        messages
    }

    fn take_warnings(&mut self, time: f64) -> Vec<String> {
        let texts = [self.profile_warning(), self.reduction_warning(time), self.temperature_warning()];
        texts.into_iter().flatten().map(|text| format!("t = {time} s: {text}")).collect()
    }

    fn final_warning(&mut self) -> Option<String> {
        self.simulation.inaccuracy().map(|inaccuracy| inaccuracy.to_string())
    }
}

impl LayerRun {
    fn new(scene: &Arc<Scene>, simulation: Simulation, start: Option<f64>) -> Self {
        Self {
            scene: Arc::clone(scene),
            variables: outputs::variables(scene),
            simulation,
            history: RunRecord { start, ..RunRecord::default() },
            farthest: farthest(scene),
            records_work: false,
        }
    }

    fn work(&mut self, time: f64) -> String {
        let counts = [Output::Steps, Output::Rejected, Output::Events].into_iter().filter_map(outputs::variable);
        let mut values = [0.0; 3];
        self.simulation.evaluate(&counts.collect::<Vec<_>>(), &mut values);
        let [steps, rejected, events] = values;
        format!("t = {time} s: {steps} steps, {rejected} rejected, {events} mode changes since the start")
    }

    fn profile_warning(&mut self) -> Option<String> {
        if self.history.left_profile {
            return None;
        }
        let text = self.scene.off_profile(self.simulation.carrier().0);
        self.history.left_profile = text.is_some();
        text
    }

    /// Of a temperature that is an input; that of the scene is among its own warnings.
    fn temperature_warning(&mut self) -> Option<String> {
        let temperature = self.simulation.temperature().filter(|_| !self.history.cold_contacts)?;
        let text = self.scene.cold_contacts(temperature);
        self.history.cold_contacts = text.is_some();
        text
    }

    /// `solver.reduce` replaces slow elements by springs by the duration of the excitation.
    fn reduction_warning(&mut self, time: f64) -> Option<String> {
        /// Relative rounding of times.
        const ROUNDING: f64 = 1e-9;
        let (bound, duration) = (self.scene.solver.reduce, self.scene.duration());
        if self.history.exceeded_reduction || bound == 0.0 {
            return None;
        }
        if time - self.history.start? <= duration * (1.0 + ROUNDING) {
            return None;
        }
        self.history.exceeded_reduction = true;
        let springs = Reduction::new(&self.scene)?.replaced.into_iter().any(|one| one.by == Replacement::Spring);
        springs.then(|| {
            format!(
                "longer than the scene's excitation of {duration} s: solver.reduce = {bound} takes elements for springs that \
                 relax in longer runs, and its bound grows with time"
            )
        })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::super::instance::Instance;
    use super::super::instance::tests::instance_of;
    use super::*;
    use asperity::simulation::SimulationError;

    /// One mass, moved at 1 m/s in steps of 0.25 s: the warnings.
    fn warnings(surface: &str, rest: &str) -> Vec<String> {
        let text = format!(
            "name = 'a'\nlayer = {{ masses = 1, spacing = 1.0, mass = 1.0, clearance = 9.0, vertical = {{ stiffness = 1.0, \
             maxwell = [{{ stiffness = 1.0, relaxation_time = 1e6 }}] }} }}\nsurface = {{ {surface} }}\n{rest}"
        );
        let mut instance = instance_of(&text);
        instance.take_messages();
        instance.enter_initialization_mode().unwrap();
        instance.exit_initialization_mode().unwrap();
        (0..8).for_each(|i| step(&mut instance, 0.25 * f64::from(i)));
        instance.take_messages().into_iter().map(|message| message.text).collect()
    }

    fn step(instance: &mut Instance, time: f64) {
        instance.state.inputs.set(Input::U as usize, time);
        instance.do_step(time, 0.25).unwrap();
    }

    #[test]
    fn a_layer_that_leaves_its_profile_is_warned_of_once() {
        // Values without rates run on as they came, from the second step on: at 1.25 s the carrier has come beyond 1 m.
        let text = "t = 1.25 s: the profile reaches from -1.0 m to 1.0 m, but the layer has come to 1.25 m: \
                    beyond its ends the profile goes on straight, along its end tangents";
        assert_eq!(warnings("kind = 'points', x = [-1, 1], z = [0, 1]", ""), [text]);
        assert!(warnings("kind = 'flat'", "").is_empty());
    }

    #[test]
    fn a_run_longer_than_its_reduction_is_warned_of_once() {
        let solver = |reduce: f64, duration: f64| {
            format!("solver = {{ reduce = {reduce} }}\nexcitation = [{{ duration = {duration} }}]")
        };
        let warned = |reduce, duration| warnings("kind = 'flat'", &solver(reduce, duration));
        let text = warned(1e-3, 1.0);
        assert!(
            text.len() == 1 && text[0].starts_with("t = 1.25 s: longer than the scene's excitation of 1 s"),
            "{text:?}"
        );
        assert!(warned(1e-3, 2.0).is_empty());
        assert!(warned(0.0, 1.0).is_empty());
        // Nothing is replaced: the bound is too tight.
        assert!(warned(1e-9, 1.0).is_empty());
    }

    /// A step of 500 masses that takes some 1400 steps of the solver: more than 500 000 steps times masses.
    #[test]
    fn the_work_of_a_step_is_limited_unless_the_scene_names_its_steps() {
        let text = |solver: &str| {
            format!(
                "name = 'a'\nlayer = {{ masses = 500, spacing = 1.0, mass = 1.0, clearance = 9.0, vertical = {{ stiffness = \
                 1.0 }} }}\nsurface = {{ kind = 'flat' }}\nsolver = {{ relative_tolerance = 1e-9{solver} }}"
            )
        };
        let result = |solver: &str| {
            let mut instance = instance_of(&text(solver));
            instance.enter_initialization_mode().unwrap();
            instance.exit_initialization_mode().unwrap();
            instance.do_step(0.0, 1.0).unwrap();
            instance.state.inputs.set_rate(Input::W as usize, 1.0);
            instance.do_step(1.0, 100.0)
        };
        let refused = result("");
        // 500 000 over the masses and ten, as the parameter says.
        assert!(
            matches!(refused, Err(Error::Simulation(SimulationError::TooMuchWork { steps: 980, .. }))),
            "{refused:?}"
        );
        let scene = Arc::new(Scene::parse(&text(""), "scene.toml".as_ref()).unwrap());
        assert_eq!(FmuModel::parameter(&scene, Parameter::MAX_STEPS), Value::Integer(980));
        // The default, named.
        assert!(result(", max_steps = 10000000").is_ok());
    }

    #[test]
    fn a_run_that_does_not_converge_is_warned_of_at_its_end() {
        let mut instance = instance_of(include_str!("../../../tests/common/stick-slip.toml"));
        instance.enter_initialization_mode().unwrap();
        instance.exit_initialization_mode().unwrap();
        let h = 1e-3;
        for i in 0..30 {
            instance.state.inputs.set(Input::U as usize, 0.02 * h * f64::from(i));
            instance.do_step(h * f64::from(i), h).unwrap();
        }
        assert!(instance.take_messages().is_empty());
        instance.terminate().unwrap();
        let messages = instance.take_messages();
        assert!(messages.len() == 1 && messages[0].text.contains("do not converge"), "{messages:?}");
    }
}
