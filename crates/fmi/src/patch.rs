//! A contact patch as an FMU's model. Between communication points the pose is continuous and runs straight to its
//! targets; a temperature is held.

use std::io;
use std::path::{Path, PathBuf};

use super::error::{Error, InputOutOfRange, RestoreError};
use super::inputs::{CommunicationStep, InputKind, InputScales, Inputs, MAX_INPUTS};
use super::model::{CarriedFile, Experiment, FmuModel, FmuRun, RunState, carried};
use super::resources::PATCH_FILE;
use super::variables::VariableRef;
use asperity::patch::{COORDINATES, Patch, PatchMotion, PatchRun, PatchStart, PatchVariable, Pose, ReckonedWork};
use asperity::scene::{FmuOptions, InputRule, Parameter, ParameterError, PatchGroup, Unit, Value, is_possible};

/// The slot of the first angle, after those of the position.
const ANGLES: usize = 3;
/// The slot of the speed of the tread, after those of the pose's coordinates.
const TRANSPORT_SPEED: usize = COORDINATES.len();
const TEMPERATURE: usize = TRANSPORT_SPEED + 1;

/// Name, unit and description of each slot.
const INPUTS: [(&str, Unit, &str); MAX_INPUTS] = [
    (COORDINATES[0], Unit::Meter, "Position of the body ahead"),
    (COORDINATES[1], Unit::Meter, "Position of the body to the left"),
    (COORDINATES[2], Unit::Meter, "Height of the body above the ground"),
    (COORDINATES[3], Unit::Radian, "Roll of the body about its x axis, after pitch and yaw"),
    (COORDINATES[4], Unit::Radian, "Pitch of the body about its y axis, after yaw"),
    (COORDINATES[5], Unit::Radian, "Yaw of the body about the z axis"),
    ("transport.speed", Unit::MeterPerSecond, "Speed at which the tread runs to the rear"),
    ("temperature", Unit::Kelvin, "Temperature, held over each communication step"),
];

impl FmuModel for Patch {
    fn name(&self) -> String {
        self.name().to_owned()
    }

    fn description(&self) -> String {
        self.description()
    }

    fn file_name(&self) -> &'static str {
        PATCH_FILE
    }

    fn carried(&self, folder: &Path) -> Result<Vec<CarriedFile>, (PathBuf, io::Error)> {
        carried(folder, self.files(), |file| self.carried(folder, file))
    }

    fn sources(&self, path: &Path) -> Vec<PathBuf> {
        self.sources(path)
    }

    fn inputs(&self) -> Vec<VariableRef> {
        let exists = |slot: &usize| match *slot {
            TRANSPORT_SPEED => self.has_tread(),
            TEMPERATURE => self.has_temperatures(),
            _ => true,
        };
        let start = |slot| match slot {
            2 => self.clear_height(),
            TEMPERATURE => self.temperature(),
            _ => 0.0,
        };
        let variable = |slot: usize| {
            let (name, unit, text) = INPUTS[slot];
            VariableRef::input(slot, name, unit, text, start(slot))
        };
        (0..INPUTS.len()).filter(exists).map(variable).collect()
    }

    fn calculated(&self) -> Vec<VariableRef> {
        let variable = |(index, variable): (usize, &PatchVariable)| {
            let on = if variable.output.follows_pose() { COORDINATES.len() } else { 0 };
            let dependencies = variable.is_output().then(|| (0..on).collect());
            let texts = (variable.name.as_str(), variable.description.as_str());
            VariableRef::calculated(index, texts, (variable.kind, variable.unit), dependencies)
        };
        Patch::variables(self).iter().enumerate().map(variable).collect()
    }

    fn parameters(&self) -> Vec<Parameter> {
        self.parameters()
    }

    fn parameter(&self, parameter: Parameter) -> Value {
        self.parameter(parameter)
    }

    fn set_parameter(&mut self, parameter: Parameter, value: Value) -> Result<(), ParameterError> {
        self.set_parameter(parameter, value)
    }

    fn input_rule(&self) -> InputRule {
        self.input_rule
    }

    /// A temperature is held.
    fn input_scales(&self) -> InputScales {
        let kind = |slot: usize| if slot < ANGLES { InputKind::Length } else { InputKind::Other };
        let slots = COORDINATES.len() + usize::from(self.has_tread());
        InputScales::new((0..slots).map(|slot| (slot, kind(slot))), 0.0)
    }

    fn memory(&self) -> usize {
        /// Of a variable of an element, with its names in two places; and of all others.
        const VARIABLE: usize = 512;
        const OTHERS: usize = 1 << 16;
        let variables = if self.heat().is_some() { 5 } else { 4 };
        let of_element = if self.groups().contains(&PatchGroup::Elements) { VARIABLE * variables } else { 0 };
        OTHERS + of_element * self.count() + self.run_memory()
    }

    fn state_memory(&self) -> usize {
        /// Of a spring, and of its heat.
        const SPRING: usize = 32;
        const HEAT: usize = 80;
        (1 << 12) + (SPRING + if self.heat().is_some() { HEAT } else { 0 }) * self.count()
    }

    fn options(&self) -> FmuOptions {
        self.fmu_options()
    }

    /// In steps in which a tread runs through a part of its face; one that stays sticks for a step.
    fn default_experiment(&self) -> Option<Experiment> {
        /// Of the face, at the largest speed of the table: 500 steps, to which a default experiment goes, are ten passages.
        const STEP: f64 = 0.02;
        let step = self.passage_time().map(|time| STEP * time).or_else(|| self.stick_time())?;
        Some(Experiment { stop: None, tolerance: None, step })
    }

    /// At the pose given, moving at the derivatives given, else at rest.
    fn start(&self, inputs: &Inputs, time: f64) -> Result<Box<dyn FmuRun>, Error> {
        let start = PatchStart {
            time,
            pose: Pose::from_coordinates(std::array::from_fn(|i| inputs.value(i))),
            rates: std::array::from_fn(|i| inputs.rate(i)),
            transport_speed: inputs.value(TRANSPORT_SPEED),
            temperature: inputs.value(TEMPERATURE),
        };
        Ok(Box::new(FmuPatchRun { run: PatchRun::new(self, &start)?, variables: Patch::variables(self) }))
    }

    fn restore(&self, state: &RunState) -> Result<Box<dyn FmuRun>, RestoreError> {
        let RunState::Patch(state) = state else { return Err(RestoreError::OTHER_MODEL) };
        Ok(Box::new(FmuPatchRun { run: PatchRun::restore(self, state)?, variables: Patch::variables(self) }))
    }
}

/// A run of the patch.
#[derive(Debug)]
struct FmuPatchRun {
    run: PatchRun,
    variables: Vec<PatchVariable>,
}

/// The motion over a communication step: straight from the pose's coordinates, where they are, to their targets.
fn motion(
    current: &[f64; COORDINATES.len()],
    inputs: &Inputs,
    step: &CommunicationStep,
) -> Result<PatchMotion, InputOutOfRange> {
    let mut rates = [0.0; COORDINATES.len()];
    for (i, rate) in rates.iter_mut().enumerate() {
        *rate = inputs.rate_from(current[i], i, COORDINATES[i], step)?;
    }
    let temperature = inputs.value(TEMPERATURE);
    if !is_possible(temperature) {
        return Err(InputOutOfRange { name: INPUTS[TEMPERATURE].0, value: temperature, time: step.time });
    }
    let transport_speed = inputs.target(TRANSPORT_SPEED, INPUTS[TRANSPORT_SPEED].0, step)?;
    Ok(PatchMotion { duration: step.h, rates, transport_speed, temperature })
}

impl FmuRun for FmuPatchRun {
    fn allow_work(&mut self) {
        self.run.limit_work();
    }

    fn check_work(
        &self,
        start: &RunState,
        steps: &mut dyn Iterator<Item = (Inputs, CommunicationStep)>,
    ) -> Result<(), Error> {
        let RunState::Patch(start) = start else { return Ok(()) };
        let (mut pose, mut speed) = (start.pose().coordinates(), start.transport_speed());
        let mut reckoned = ReckonedWork::default();
        for (inputs, step) in steps {
            let motion = motion(&pose, &inputs, &step)?;
            reckoned = reckoned.with(self.run.reckon(pose, speed, &motion));
            pose = std::array::from_fn(|i| pose[i] + motion.rates[i] * motion.duration);
            speed = motion.transport_speed;
        }
        Ok(self.run.check_work(reckoned)?)
    }

    fn advance(&mut self, inputs: &Inputs, step: &CommunicationStep) -> Result<(), Error> {
        let motion = motion(&self.run.pose().coordinates(), inputs, step)?;
        Ok(self.run.advance(&motion)?)
    }

    fn evaluate(&mut self, values: &mut [f64]) {
        self.run.evaluate(&self.variables, values);
    }

    /// The speed of a tread and the temperature act from the next step on: nothing follows them at once.
    fn directional_derivatives(&mut self, outputs: &[usize], direction: &[f64; MAX_INPUTS], values: &mut [f64]) {
        let variables: Vec<_> = outputs.iter().map(|&output| self.variables[output].clone()).collect();
        self.run.directional_derivative(&variables, std::array::from_fn(|i| direction[i]), values);
    }

    fn output_rate(&mut self, output: usize) -> Option<f64> {
        self.run.rate(self.variables[output].output)
    }

    fn save(&self) -> RunState {
        RunState::Patch(Box::new(self.run.save()))
    }

    fn save_into(&self, saved: &mut RunState) {
        match saved {
            RunState::Patch(saved) => self.run.save_into(saved),
            _ => *saved = self.save(),
        }
    }

    fn set_state(&mut self, state: &RunState) -> Result<(), RestoreError> {
        let RunState::Patch(state) = state else { return Err(RestoreError::OTHER_MODEL) };
        self.run.continue_from(state);
        Ok(())
    }

    /// An element beyond the table is told of once a run.
    fn take_warnings(&mut self, _time: f64) -> Vec<String> {
        self.run.take_warnings()
    }
}
