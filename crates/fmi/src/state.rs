//! The state of an instance, its copy in an FMU state, and its clock.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::definition::{Definition, Parameters};
use super::error::{Error, Status, check_memory};
use super::inputs::{CommunicationStep, InputScales, Inputs};
use super::lifecycle::LifecycleState;
use super::model::{FmuRun, RunState};
use super::provisional::{LastStep, Stepper};
use super::variables::VariableTable;
use asperity::scene::{SMALLEST, is_possible};

#[derive(Debug)]
pub(super) struct InstanceState {
    /// The state of the life cycle.
    pub(super) lifecycle: LifecycleState,
    /// What is simulated, with the parameters set.
    pub(super) parameters: Arc<Parameters>,
    pub(super) inputs: Inputs,
    pub(super) clock: Clock,
    /// What the last step returned.
    pub(super) last_step: Status,
    /// The run. Before it begins, one that would start from the parameters and inputs set, once outputs were asked for.
    pub(super) run: Option<Box<dyn FmuRun>>,
    stepper: Stepper,
    /// Of the parameters set, from the first step on.
    scales: Option<InputScales>,
    /// When the last step began that was done again, s, until it is taken.
    pub(super) repeated_from: Option<f64>,
}

/// An FMU state: a copy of an instance's state without the workspace of its run.
#[derive(Clone, Debug)]
pub(super) struct FmuState {
    pub(super) lifecycle: LifecycleState,
    pub(super) parameters: Arc<Parameters>,
    pub(super) inputs: Inputs,
    pub(super) clock: Clock,
    pub(super) last_step: Status,
    /// `None` before the run: it follows from the rest then.
    pub(super) run: Option<RunState>,
    /// The last step, where it may be done again.
    pub(super) last: Option<LastStep>,
}

impl InstanceState {
    /// The state after fmi2Instantiate of a model with these variables.
    pub(super) fn new(parameters: Arc<Parameters>, variables: &VariableTable) -> Self {
        let stepper = Stepper::new(parameters.definition().state_memory());
        Self {
            lifecycle: LifecycleState::Instantiated,
            parameters,
            inputs: variables.start_inputs(),
            clock: Clock::default(),
            last_step: Status::Ok,
            run: None,
            stepper,
            scales: None,
            repeated_from: None,
        }
    }

    /// Drops the run that would have started, since something that it starts from has changed.
    pub(super) fn discard_start(&mut self) {
        if self.lifecycle.before_run() {
            self.run = None;
        }
    }

    /// The run. Before it begins, outputs are those of a run that starts from the parameters and inputs set.
    pub(super) fn run(&mut self) -> Result<&mut dyn FmuRun, Error> {
        if self.run.is_none() && self.lifecycle.before_run() {
            let definition = self.parameters.definition();
            check_memory("a run", memory_of_run(definition))?;
            self.run = Some(definition.start(&self.inputs, self.clock.time)?);
        }
        Ok(self.run.as_mut().ok_or(Error::NoRun)?.as_mut())
    }

    pub(super) fn start(&mut self) -> Result<(), Error> {
        let result = self.run().map(|_| ());
        self.lifecycle = if result.is_ok() { LifecycleState::StepComplete } else { LifecycleState::Error };
        result
    }

    /// A step of `h` (s) from `point` (s). A call with an invalid point or size changes nothing, not even the life
    /// cycle; a step that fails changes only the life cycle.
    pub(super) fn step(&mut self, point: f64, h: f64) -> Result<(), Error> {
        let result = match self.clock.step(point, h)? {
            Some(clock) => self.advance(clock, h),
            None => Ok(()),
        };
        self.last_step = result.as_ref().map_or_else(Error::status, |()| Status::Ok);
        self.lifecycle = match self.last_step {
            Status::Ok | Status::Warning => LifecycleState::StepComplete,
            Status::Discard => LifecycleState::StepFailed,
            Status::Error | Status::Fatal => LifecycleState::Error,
        };
        result
    }

    /// Why inputs were held at their values, the first time.
    pub(super) fn take_held(&mut self) -> Option<String> {
        self.stepper.take_held()
    }

    /// The slot of an input whose new values come more seldom than steps, and how far apart, s.
    pub(super) fn slow_input(&self) -> Option<(usize, f64)> {
        self.inputs.slow_input(self.scales.as_ref()?)
    }

    fn advance(&mut self, clock: Clock, h: f64) -> Result<(), Error> {
        let definition = self.parameters.definition();
        let scales = *self.scales.get_or_insert_with(|| definition.input_scales());
        let step = CommunicationStep { time: self.clock.time, h, rule: definition.input_rule() };
        let run = self.run.as_mut().ok_or(Error::NoRun)?.as_mut();
        self.repeated_from = self.stepper.advance(run, &self.inputs, &step, &scales)?;
        self.inputs.complete_step(&step);
        self.clock = clock;
        Ok(())
    }

    /// The run, unless it has not begun.
    fn begun(&self) -> Option<&dyn FmuRun> {
        self.run.as_deref().filter(|_| !self.lifecycle.before_run())
    }

    /// A copy for an FMU state.
    pub(super) fn save(&self) -> FmuState {
        let last = self.stepper.last().cloned();
        FmuState { run: self.begun().map(|run| run.save()), last, ..self.without_run() }
    }

    /// As [`save`](Self::save), into an FMU state that there is: the arrays of a large patch stay where they are.
    pub(super) fn save_into(&self, saved: &mut FmuState) {
        let mut kept = saved.run.take();
        let mut last = saved.last.take();
        match (self.begun(), &mut kept) {
            (Some(run), Some(kept)) => run.save_into(kept),
            (run, kept) => *kept = run.map(|run| run.save()),
        }
        LastStep::copy(&mut last, self.stepper.last());
        *saved = FmuState { run: kept, last, ..self.without_run() };
    }

    fn without_run(&self) -> FmuState {
        FmuState {
            lifecycle: self.lifecycle,
            parameters: Arc::clone(&self.parameters),
            inputs: self.inputs,
            clock: self.clock,
            last_step: self.last_step,
            run: None,
            last: None,
        }
    }

    /// Continues from `state`. What a run has done that is no part of it, such as the processor time, continues from
    /// its current value.
    pub(super) fn restore(&mut self, state: &FmuState) -> Result<(), Error> {
        let same = Arc::ptr_eq(&self.parameters, &state.parameters);
        match (&state.run, &mut self.run) {
            (Some(state), Some(run)) if same => run.set_state(state)?,
            (Some(saved), run) => {
                let definition = state.parameters.definition();
                check_memory("a run", memory_of_run(definition))?;
                let mut restored = definition.restore(saved)?;
                if let Some(before) = run {
                    restored.set_history(before.history());
                }
                *run = Some(restored);
            }
            (None, run) => *run = None,
        }
        self.stepper.set_last(state.last.as_ref());
        self.scales = None;
        self.lifecycle = state.lifecycle;
        self.parameters = Arc::clone(&state.parameters);
        self.inputs = state.inputs;
        (self.clock, self.last_step) = (state.clock, state.last_step);
        Ok(())
    }
}

/// Memory in bytes of a run and of the states that its [`Stepper`] keeps.
fn memory_of_run(definition: &Definition) -> usize {
    definition.memory().saturating_add(definition.state_memory().saturating_mul(Stepper::STATES))
}

/// The outputs at the last communication point, computed when first asked for.
#[derive(Debug, Default)]
pub(super) struct OutputCache {
    values: Option<Vec<f64>>,
    spare: Vec<f64>,
}

impl OutputCache {
    /// Marks them as outdated: something that they depend on has changed.
    pub(super) fn invalidate(&mut self) {
        if let Some(values) = self.values.take() {
            self.spare = values;
        }
    }

    /// The values of all `count` calculated variables, in their order.
    pub(super) fn get(&mut self, state: &mut InstanceState, count: usize) -> Result<&[f64], Error> {
        if self.values.is_none() {
            let mut values = std::mem::take(&mut self.spare);
            values.resize(count, 0.0);
            state.run()?.evaluate(&mut values);
            self.values = Some(values);
        }
        Ok(self.values.as_deref().unwrap_or_default())
    }
}

/// Differences of times below this share of the larger of time and step size are rounding.
const ROUNDING: f64 = 1e-10;

/// So are those below this share of the step size, and those by which a clock in single precision is off, up to a
/// larger one.
const PART_OF_STEP: f64 = 1e-6;
const MAX_PART_OF_STEP: f64 = 1e-3;

/// The time of the FMU and the stop time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Clock {
    /// The time reached, s: the last communication point.
    pub(super) time: f64,
    /// The stop time, s, if the master defined one.
    stop: Option<f64>,
    /// How far beyond the stop time a step may end, s: a clock in single precision adds up its rounding.
    beyond: f64,
}

/// That, as a part of the time from start to stop.
const BEYOND: f64 = 1e-6;

impl Clock {
    /// A clock at the time `start` (s), with the stop time `stop` (s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] where a time is not a number or larger than [`LARGEST`](asperity::scene::LARGEST),
    /// [`Error::StopBeforeStart`].
    pub(super) fn new(start: f64, stop: Option<f64>) -> Result<Self, Error> {
        let check = |what, value| if is_possible(value) { Ok(()) } else { Err(Error::OutOfRange { what, value }) };
        check("the start time", start)?;
        if let Some(stop) = stop {
            check("the stop time", stop)?;
            if stop < start {
                return Err(Error::StopBeforeStart { start, stop });
            }
        }
        Ok(Self { time: start, stop, beyond: stop.map_or(0.0, |stop| BEYOND * (stop - start)) })
    }

    /// Whether its times are finite and in range.
    pub(super) fn is_valid(&self) -> bool {
        is_possible(self.time) && self.stop.is_none_or(is_possible) && is_possible(self.beyond)
    }

    /// The clock after a step of `h` (s) from the communication point `point` (s); `None` where the step is too short
    /// to change the time.
    ///
    /// # Errors
    /// [`Error::StepSize`], [`Error::OtherPoint`] or [`Error::BeyondStop`], beyond differences by rounding;
    /// [`Error::OutOfRange`].
    pub(super) fn step(&self, point: f64, h: f64) -> Result<Option<Self>, Error> {
        if !(is_possible(h) && h >= 0.0) {
            return Err(Error::StepSize(h));
        }
        let single = (f64::from(f32::EPSILON) * self.time.abs()).min(MAX_PART_OF_STEP * h);
        let slack = (ROUNDING * self.time.abs().max(h)).max(PART_OF_STEP * h).max(single);
        let difference = (point - self.time).abs();
        let changes = self.time + h != self.time;
        // The stiffness of a damper over so short a step would overflow.
        if changes && h < SMALLEST {
            return Err(Error::StepSize(h));
        }
        // In this form a point that is not a number is refused.
        if !(difference <= slack && (difference < h / 2.0 || !changes)) {
            return Err(Error::OtherPoint { given: point, own: self.time });
        }
        let end = point + h;
        match self.stop {
            Some(stop) if end > stop + slack.max(self.beyond) => Err(Error::BeyondStop { end, stop }),
            _ if !is_possible(end) => Err(Error::OutOfRange { what: "the end of the step", value: end }),
            _ => Ok(changes.then_some(Self { time: end, ..*self })),
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use asperity::scene::LARGEST;

    fn clock(time: f64) -> Clock {
        Clock::new(time, Some(10.0)).unwrap()
    }

    #[test]
    fn the_time_after_a_step_is_the_masters() {
        let point = 0.3 + f64::EPSILON;
        assert_eq!(clock(0.3).step(point, 0.1).unwrap().unwrap().time, point + 0.1);
    }

    #[test]
    fn a_step_that_does_not_change_the_time_is_skipped() {
        assert_eq!(clock(1.0).step(1.0, 0.0).unwrap(), None);
        assert_eq!(clock(1.0).step(1.0, 1e-30).unwrap(), None);
        assert!(clock(0.0).step(0.0, 1e-30).unwrap().is_some());
    }

    #[test]
    fn another_point_is_refused_and_named() {
        let error = clock(1.0).step(1.1, 0.1).unwrap_err().to_string();
        assert!(error.contains("1.1 s") && error.contains("1 s"), "{error}");
        assert!(clock(1.0).step(f64::NAN, 0.1).is_err());
        // Within 1e-10 of the time, but more than half of the step.
        assert!(clock(1.0).step(1.0 + 5e-11, 6e-11).is_err());
        assert!(clock(1.0).step(2.0, 0.0).is_err());
    }

    #[test]
    fn invalid_step_sizes_are_refused() {
        for h in [-1.0, f64::NAN, f64::INFINITY, 1e300, f64::MIN_POSITIVE] {
            assert!(matches!(clock(0.0).step(0.0, h), Err(Error::StepSize(_))));
        }
    }

    #[test]
    fn the_stop_time_may_be_overshot_by_rounding_alone() {
        // 100 steps of 1 ms in single precision.
        let (mut time, mut single) = (0.0_f32, Clock::new(0.0, Some(0.1)).unwrap());
        for _ in 0..100 {
            single = single.step(f64::from(time), f64::from(1e-3_f32)).unwrap().unwrap();
            time += 1e-3;
        }
        assert!(single.time > 0.1);
        assert!(clock(9.9).step(9.9, 0.1 + 1e-12).is_ok());
        assert!(matches!(clock(9.9).step(9.9, 0.2), Err(Error::BeyondStop { .. })));
        assert!(Clock::new(0.0, None).unwrap().step(0.0, 1e9).is_ok());
    }

    #[test]
    fn times_are_in_range_and_in_order() {
        assert!(Clock::new(f64::NAN, None).is_err());
        assert!(Clock::new(0.0, Some(f64::INFINITY)).is_err());
        assert!(Clock::new(1e300, None).is_err());
        let clock = Clock::new(LARGEST, None).unwrap();
        assert!(matches!(clock.step(LARGEST, LARGEST), Err(Error::OutOfRange { .. })));
        assert!(Clock::new(1.0, Some(0.0)).is_err());
        assert!(Clock::new(-5.0, Some(-5.0)).is_ok());
    }
}
