//! One run of the FMU: all that an FMU state holds.

use std::sync::Arc;

use super::carrier::Carrier;
use super::clock::Clock;
use super::fault::{Fault, Status};
use super::lifecycle::State;
use super::parameters::Parameters;
use super::plant::Plant;

/// A run, from its parameters to where it stands.
#[derive(Clone, Debug)]
pub(super) struct Run {
    /// The state of the lifecycle.
    pub(super) state: State,
    /// What is simulated, with the parameters as set.
    pub(super) parameters: Arc<Parameters>,
    /// The carrier with the inputs as set.
    pub(super) carrier: Carrier,
    /// The time and the stop time.
    pub(super) clock: Clock,
    /// What the last step returned.
    pub(super) last_step: Status,
    /// The run of it; before the run, one that would start as things stand.
    pub(super) plant: Option<Plant>,
}

impl Run {
    /// A run that has not begun.
    pub(super) fn new(parameters: Arc<Parameters>) -> Self {
        Self {
            state: State::Instantiated,
            parameters,
            carrier: Carrier::default(),
            clock: Clock::default(),
            last_step: Status::Ok,
            plant: None,
        }
    }

    /// Forgets the run that would have started: something it starts from has changed.
    pub(super) fn start_anew(&mut self) {
        if self.state.before_run() {
            self.plant = None;
        }
    }

    /// What runs. Before the run, outputs are those of a run that starts as things stand.
    pub(super) fn plant(&mut self) -> Result<&mut Plant, Fault> {
        if self.plant.is_none() && self.state.before_run() {
            let start = self.carrier.start(self.clock.time);
            self.plant = Some(self.parameters.subject().start(&start)?);
        }
        self.plant.as_mut().ok_or(Fault::NoRun)
    }

    /// Takes over the processor time that `other` has spent: it is no part of the FMU state.
    pub(super) fn go_on_timing(&mut self, other: &Self) {
        if let (Some(plant), Some(other)) = (&mut self.plant, &other.plant) {
            plant.go_on_timing(other);
        }
    }

    /// Ends the initialisation.
    pub(super) fn start(&mut self) -> Result<(), Fault> {
        let result = self.plant().map(|_| ());
        self.state = if result.is_ok() { State::StepComplete } else { State::Error };
        result
    }

    /// Does a step of `h` from `point`. A call with a bad point or size is refused and changes nothing, the lifecycle
    /// included; a step that fails leaves all but the lifecycle as it was.
    pub(super) fn step(&mut self, point: f64, h: f64) -> Result<(), Fault> {
        let result = match self.clock.step(point, h)? {
            Some(clock) => self.advance(clock, h),
            None => Ok(()),
        };
        self.last_step = result.as_ref().map_or_else(Fault::status, |()| Status::Ok);
        self.state = match self.last_step {
            Status::Ok | Status::Warning => State::StepComplete,
            Status::Discard => State::StepFailed,
            Status::Error | Status::Fatal => State::Error,
        };
        result
    }

    fn advance(&mut self, clock: Clock, h: f64) -> Result<(), Fault> {
        let (carrier, time, rule) = (self.carrier, self.clock.time, self.parameters.subject().extrapolation());
        let plant = self.plant()?;
        plant.advance(&carrier.motion(plant.carrier(), time, h, rule)?)?;
        self.carrier.count_step(h);
        self.clock = clock;
        Ok(())
    }
}
