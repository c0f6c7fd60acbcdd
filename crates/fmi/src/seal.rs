//! A seal as an FMU's model. Between communication points u, w and the sealed pressure run straight to their targets; a
//! temperature is held.

use std::io;
use std::path::{Path, PathBuf};

use super::error::{Error, InputOutOfRange, RestoreError};
use super::inputs::{CommunicationStep, InputKind, InputScales, Inputs, MAX_INPUTS};
use super::model::{CarriedFile, Experiment, FmuModel, FmuRun, RunState, carried};
use super::resources::SEAL_FILE;
use super::variables::VariableRef;
use asperity::outputs::OutputType;
use asperity::scene::{FmuOptions, InputRule, Parameter, ParameterError, SealGroup, Unit, Value, is_possible};
use asperity::seal::{Seal, SealMotion, SealOutput, SealRun, SealStart, SealVariable};

const U: usize = 0;
const W: usize = 1;
const SEALED: usize = 2;
const TEMPERATURE: usize = 3;

/// Name, unit and description of each slot.
const INPUTS: [(&str, Unit, &str); 4] = [
    ("u", Unit::Meter, "Displacement of the rod to the air"),
    ("w", Unit::Meter, "How far the lip is lifted"),
    ("sealed_pressure", Unit::Pascal, "Pressure of the fluid before the lip"),
    ("temperature", Unit::Kelvin, "Temperature, held over each communication step"),
];

impl FmuModel for Seal {
    fn name(&self) -> String {
        self.name().to_owned()
    }

    fn description(&self) -> String {
        self.description()
    }

    fn file_name(&self) -> &'static str {
        SEAL_FILE
    }

    fn carried(&self, folder: &Path) -> Result<Vec<CarriedFile>, (PathBuf, io::Error)> {
        carried(folder, self.files(), |file| self.carried(folder, file))
    }

    fn sources(&self, path: &Path) -> Vec<PathBuf> {
        self.sources(path)
    }

    fn inputs(&self) -> Vec<VariableRef> {
        let exists = |slot: &usize| match *slot {
            W => self.can_be_lifted(),
            TEMPERATURE => self.has_temperatures(),
            _ => true,
        };
        let start = |slot| match slot {
            SEALED => self.sealed_pressure(),
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
        let variable = |(index, variable): (usize, &SealVariable)| {
            // All follow the pressure on the lip at once, but what has been leaked and lost.
            let on: Vec<usize> = match variable.output {
                SealOutput::Power | SealOutput::Energy | SealOutput::Leak | SealOutput::OnRod => Vec::new(),
                _ if self.can_be_lifted() => vec![U, W, SEALED],
                _ => vec![U, SEALED],
            };
            let dependencies = variable.is_output().then_some(on);
            let texts = (variable.name.as_str(), variable.description.as_str());
            VariableRef::calculated(index, texts, (OutputType::Real, variable.unit), dependencies)
        };
        Seal::variables(self).iter().enumerate().map(variable).collect()
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

    fn input_scales(&self) -> InputScales {
        let kinds = [(U, InputKind::Length), (W, InputKind::Length), (SEALED, InputKind::Other)];
        InputScales::new(kinds.into_iter().filter(|(slot, _)| *slot != W || self.can_be_lifted()), 0.0)
    }

    fn memory(&self) -> usize {
        /// Of a point of the table, in the law that a run makes of it; of a cell with its variables; and of all else.
        const POINT: usize = 1024;
        const CELL: usize = 1024;
        const VARIABLES: usize = 2048;
        const REST: usize = 1 << 17;
        let of_cell = if self.groups().contains(&SealGroup::Cells) { CELL + VARIABLES } else { CELL };
        REST + POINT * self.table().grid.count() + of_cell * self.cells()
    }

    fn state_memory(&self) -> usize {
        /// Of the film on the rod, and all else.
        const REST: usize = 1 << 13;
        REST + 8 * self.cells()
    }

    fn options(&self) -> FmuOptions {
        self.fmu_options()
    }

    /// In steps in which the rod goes on by a part of the lip's width.
    fn default_experiment(&self) -> Option<Experiment> {
        /// Of the width, at the middle speed of the table.
        const STEP: f64 = 0.02;
        let step = STEP * self.width() / self.middle_speed();
        Some(Experiment { stop: None, tolerance: Some(self.relative_tolerance), step })
    }

    fn start(&self, inputs: &Inputs, time: f64) -> Result<Box<dyn FmuRun>, Error> {
        let start = SealStart {
            time,
            u: inputs.value(U),
            w: inputs.value(W),
            sealed_pressure: inputs.value(SEALED),
            temperature: inputs.value(TEMPERATURE),
            u_rate: inputs.rate(U),
        };
        Ok(Box::new(FmuSealRun { run: SealRun::new(self, &start)?, variables: Seal::variables(self) }))
    }

    fn restore(&self, state: &RunState) -> Result<Box<dyn FmuRun>, RestoreError> {
        let RunState::Seal(state) = state else { return Err(RestoreError::OTHER_MODEL) };
        Ok(Box::new(FmuSealRun { run: SealRun::restore(self, state)?, variables: Seal::variables(self) }))
    }
}

/// A run of the seal.
#[derive(Debug)]
struct FmuSealRun {
    run: SealRun,
    variables: Vec<SealVariable>,
}

impl FmuRun for FmuSealRun {
    fn allow_work(&mut self) {
        self.run.limit_work();
    }

    fn advance(&mut self, inputs: &Inputs, step: &CommunicationStep) -> Result<(), Error> {
        let current = self.run.inputs();
        let rate = |slot: usize| inputs.rate_from(current[slot], slot, INPUTS[slot].0, step);
        let temperature = inputs.value(TEMPERATURE);
        if !is_possible(temperature) {
            return Err(InputOutOfRange { name: INPUTS[TEMPERATURE].0, value: temperature, time: step.time }.into());
        }
        let (u_rate, w_rate, pressure_rate) = (rate(U)?, rate(W)?, rate(SEALED)?);
        Ok(self.run.advance(&SealMotion { duration: step.h, u_rate, w_rate, pressure_rate, temperature })?)
    }

    fn evaluate(&mut self, values: &mut [f64]) {
        self.run.evaluate(&self.variables, values);
    }

    fn directional_derivatives(&mut self, outputs: &[usize], direction: &[f64; MAX_INPUTS], values: &mut [f64]) {
        let variables: Vec<_> = outputs.iter().map(|&output| self.variables[output].clone()).collect();
        self.run.directional_derivative(&variables, [direction[U], direction[W], direction[SEALED]], values);
    }

    fn output_rate(&mut self, output: usize) -> Option<f64> {
        match self.variables[output].output {
            SealOutput::ForceX => self.run.force_rates().0,
            SealOutput::ForceZ => Some(self.run.force_rates().1),
            _ => None,
        }
    }

    fn save(&self) -> RunState {
        RunState::Seal(Box::new(self.run.save()))
    }

    fn save_into(&self, saved: &mut RunState) {
        match saved {
            RunState::Seal(saved) => self.run.save_into(saved),
            _ => *saved = self.save(),
        }
    }

    fn set_state(&mut self, state: &RunState) -> Result<(), RestoreError> {
        let RunState::Seal(state) = state else { return Err(RestoreError::OTHER_MODEL) };
        self.run.continue_from(state);
        Ok(())
    }

    fn take_warnings(&mut self, _time: f64) -> Vec<String> {
        self.run.take_warnings()
    }
}
