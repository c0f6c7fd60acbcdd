//! A point-contact element as an FMU's model.

use std::slice;

use super::error::{Error, RestoreError};
use super::inputs::{CommunicationStep, InputKind, InputScales, Inputs, MAX_INPUTS};
use super::log::Message;
use super::model::{Experiment, FmuModel, FmuRun, RunState};
use super::resources::TABLE_FILE;
use super::variables::VariableRef;
use asperity::element::{self, Element, PointContact};
use asperity::outputs::{Output, Variable};
use asperity::scene::{Input, InputRule, Parameter, ParameterError, Value};
use asperity::simulation::Start;

impl FmuModel for PointContact {
    fn name(&self) -> String {
        self.name()
    }

    fn description(&self) -> String {
        self.description()
    }

    fn file_name(&self) -> &'static str {
        TABLE_FILE
    }

    fn inputs(&self) -> Vec<VariableRef> {
        let input = |input: Input, text: &str, start: f64| {
            VariableRef::input(input as usize, input.name(), input.unit(), text, start)
        };
        let w = "Displacement of the carrier along z, negative presses; starts just above the touch";
        vec![input(Input::U, "Displacement of the carrier along x", 0.0), input(Input::W, w, self.clear_displacement())]
    }

    fn calculated(&self) -> Vec<VariableRef> {
        VariableRef::from_outputs(&PointContact::variables(self), element::dependencies)
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
        InputScales::new([Input::U, Input::W].map(|input| (input as usize, InputKind::Length)), 0.0)
    }

    fn memory(&self) -> usize {
        /// Of a point of the table, in the law that a run makes of it; and of all else.
        const POINT: usize = 512;
        const REST: usize = 1 << 16;
        REST + POINT * self.table().grid.count()
    }

    fn state_memory(&self) -> usize {
        1 << 12
    }

    fn default_experiment(&self) -> Option<Experiment> {
        self.table().stick_time(None).map(|step| Experiment { stop: None, tolerance: None, step })
    }

    fn start(&self, inputs: &Inputs, time: f64) -> Result<Box<dyn FmuRun>, Error> {
        let [u, w] = [Input::U, Input::W].map(|input| (inputs.value(input as usize), inputs.rate(input as usize)));
        let start = Start { time, u: u.0, w: w.0, u_rate: u.1, w_rate: w.1, ..Start::default() };
        Ok(Box::new(ElementRun::new(self, Element::new(self, &start)?)))
    }

    fn restore(&self, state: &RunState) -> Result<Box<dyn FmuRun>, RestoreError> {
        let RunState::Element(state) = state else { return Err(RestoreError::OTHER_MODEL) };
        Ok(Box::new(ElementRun::new(self, Element::restore(self, state)?)))
    }
}

/// A run of the element.
#[derive(Debug)]
struct ElementRun {
    variables: Vec<Variable>,
    element: Element,
}

impl ElementRun {
    fn new(contact: &PointContact, element: Element) -> Self {
        Self { variables: contact.variables(), element }
    }
}

impl FmuRun for ElementRun {
    fn advance(&mut self, inputs: &Inputs, step: &CommunicationStep) -> Result<(), Error> {
        let rate = |input: Input, from| inputs.rate_from(from, input as usize, input.name(), step);
        let (u, w) = self.element.carrier();
        Ok(self.element.advance(step.h, rate(Input::U, u)?, rate(Input::W, w)?)?)
    }

    fn evaluate(&mut self, values: &mut [f64]) {
        self.element.evaluate(&self.variables, values);
    }

    fn directional_derivatives(&mut self, outputs: &[usize], direction: &[f64; MAX_INPUTS], values: &mut [f64]) {
        let direction = (direction[Input::U as usize], direction[Input::W as usize]);
        for (&output, value) in outputs.iter().zip(values) {
            let variable = &self.variables[output];
            let direction = element::dependencies(variable.output).part_of(direction);
            self.element.directional_derivative(slice::from_ref(variable), direction, slice::from_mut(value));
        }
    }

    fn output_rate(&mut self, output: usize) -> Option<f64> {
        match self.variables[output].output {
            Output::ForceX => Some(self.element.force_rates().0),
            Output::ForceZ => Some(self.element.force_rates().1),
            _ => None,
        }
    }

    fn save(&self) -> RunState {
        RunState::Element(self.element.save())
    }

    fn set_state(&mut self, state: &RunState) -> Result<(), RestoreError> {
        let RunState::Element(state) = state else { return Err(RestoreError::OTHER_MODEL) };
        self.element.continue_from(state);
        Ok(())
    }

    fn record(&mut self, events: bool, _solver: bool) {
        self.element.record_mode_changes(events);
    }

    fn take_records(&mut self, _time: f64) -> Vec<Message> {
        // It has no masses: its contact is one.
        self.element.take_mode_changes().iter().map(|change| Message::from_mode_change(change, "the contact")).collect()
    }
}
