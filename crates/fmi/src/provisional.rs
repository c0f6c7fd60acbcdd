//! The last step of a run where it went to extrapolated values: once the values at its end are known and are others, it
//! is done again from its start, straight to them. The course of the inputs is then the piecewise linear one through the
//! values given, and the last step alone is a prediction. Where that cannot be done the inputs are held at their values.

use serde::{Deserialize, Serialize};

use super::error::{Error, check_memory};
use super::inputs::{CommunicationStep, InputScales, Inputs, ProvisionalStep};
use super::model::{FmuRun, RunState};
use asperity::scene::{Extrapolation, InputRule};

/// A step that may be done again, and where.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct LastStep {
    pub(super) step: ProvisionalStep,
    /// The run at its start.
    pub(super) run: RunState,
}

/// Does the steps of a run, the last one again where it is to be. Nothing is allocated once it keeps its states.
#[derive(Debug)]
pub(super) struct Stepper {
    /// Memory of a state, bytes.
    state_memory: usize,
    /// The last step, where it is provisional.
    last: Option<LastStep>,
    /// Where the state at the start of the next step is kept.
    start: Option<RunState>,
    /// Where the state before the call is kept while a step is done again, or in parts.
    before: Option<RunState>,
    /// Why inputs were held for the first time, until that is taken.
    held: Held,
}

/// Whether inputs were held because they could not be extrapolated.
#[derive(Debug)]
enum Held {
    Never,
    Untold(String),
    Told,
}

impl LastStep {
    /// Copies `from`, into the arrays that there are.
    pub(super) fn copy(own: &mut Option<Self>, from: Option<&Self>) {
        match (own, from) {
            (Some(own), Some(from)) => {
                own.step = from.step;
                own.run.copy_from(&from.run);
            }
            (own, from) => *own = from.cloned(),
        }
    }
}

impl Stepper {
    /// The states that it keeps at most.
    pub(super) const STATES: usize = 3;

    /// Of a run whose states take this memory, bytes.
    pub(super) fn new(state_memory: usize) -> Self {
        Self { state_memory, last: None, start: None, before: None, held: Held::Never }
    }

    /// The last step, where it is provisional.
    pub(super) fn last(&self) -> Option<&LastStep> {
        self.last.as_ref()
    }

    /// Takes over the last step of the state that a run continues from.
    pub(super) fn set_last(&mut self, last: Option<&LastStep>) {
        LastStep::copy(&mut self.last, last);
    }

    /// Does a step of `run`, and the last one before where other values have come than those that it went to; returns
    /// when that began, s. Where either fails the run is as it was.
    pub(super) fn advance(
        &mut self,
        run: &mut dyn FmuRun,
        inputs: &Inputs,
        step: &CommunicationStep,
        scales: &InputScales,
    ) -> Result<Option<f64>, Error> {
        run.allow_work();
        let corrected = self.last.as_ref().and_then(|last| last.step.corrected(inputs, scales));
        let is_one = step.rule.extrapolates() || inputs.parts(step, scales).is_one();
        if corrected.is_none() && is_one {
            self.follow(run, inputs, step, scales)?;
            return Ok(None);
        }
        let began = self.last.as_ref().filter(|_| corrected.is_some()).map(|last| last.step.step().time);
        self.check_work(run, corrected.as_ref(), inputs, (step, scales))?;
        self.keep_states(run)?;
        save(run, &mut self.before);
        let repeated = corrected.map_or(Ok(()), |corrected| self.repeat(run, &corrected));
        let result = repeated.and_then(|()| self.follow(run, inputs, step, scales));
        if let (Err(_), Some(before)) = (&result, &self.before) {
            run.set_state(before)?;
        }
        result.map(|()| began)
    }

    /// Why inputs were held at their values, the first time.
    pub(super) fn take_held(&mut self) -> Option<String> {
        match std::mem::replace(&mut self.held, Held::Told) {
            Held::Untold(reason) => Some(reason),
            other => {
                self.held = other;
                None
            }
        }
    }

    /// Makes the places of the states that it keeps, the first time that one is needed: a run has asked for their memory, but
    /// there may be less of it by now.
    fn keep_states(&mut self, run: &dyn FmuRun) -> Result<(), Error> {
        if self.before.is_none() {
            check_memory("a step that may be done again", self.state_memory.saturating_mul(Self::STATES))?;
            self.before = Some(run.save());
            self.start.get_or_insert_with(|| run.save());
        }
        Ok(())
    }

    /// Refuses a step that takes too much work with the last one, which is done again, before that is done: inputs that would
    /// be extrapolated may be held.
    fn check_work(
        &self,
        run: &dyn FmuRun,
        corrected: Option<&Inputs>,
        inputs: &Inputs,
        (step, scales): (&CommunicationStep, &InputScales),
    ) -> Result<(), Error> {
        let (Some(last), Some(corrected)) = (&self.last, corrected) else { return Ok(()) };
        let rule = InputRule { extrapolation: Extrapolation::Hold, interval: 0.0 };
        let parts = inputs.parts(step, scales).map(|(inputs, part)| (inputs, CommunicationStep { rule, ..part }));
        run.check_work(&last.run, &mut std::iter::once((*corrected, last.step.step())).chain(parts))
    }

    /// Does the last step again.
    fn repeat(&self, run: &mut dyn FmuRun, corrected: &Inputs) -> Result<(), Error> {
        let Some(last) = &self.last else { return Ok(()) };
        run.set_state(&last.run)?;
        let step = last.step.step();
        run.advance(corrected, &step).map_err(|source| Error::Repetition {
            time: step.time,
            h: step.h,
            source: Box::new(source),
        })?;
        run.count_repetition();
        Ok(())
    }

    /// Does a step, and keeps the state at its start where it is provisional.
    fn follow(
        &mut self,
        run: &mut dyn FmuRun,
        inputs: &Inputs,
        step: &CommunicationStep,
        scales: &InputScales,
    ) -> Result<(), Error> {
        let Some(provisional) = ProvisionalStep::new(inputs, step, scales) else {
            inputs.parts(step, scales).try_for_each(|(inputs, part)| run.advance(&inputs, &part))?;
            self.start = self.last.take().map(|last| last.run).or(self.start.take());
            return Ok(());
        };
        self.keep_states(run)?;
        save(run, &mut self.start);
        let provisional = match (run.advance(inputs, step), provisional.held(scales)) {
            (Ok(()), _) => provisional,
            (Err(error), None) => return Err(error),
            // What was extrapolated cannot be done: that the inputs stay where they are is as good a prediction.
            (Err(error), Some(held)) => {
                run.allow_work();
                run.advance(inputs, &held.step())?;
                if matches!(self.held, Held::Never) {
                    self.held = Held::Untold(error.to_string());
                }
                held
            }
        };
        let spare = self.last.take().map(|last| last.run);
        self.last = self.start.take().map(|run| LastStep { step: provisional, run });
        self.start = Some(spare.unwrap_or_else(|| run.save()));
        Ok(())
    }
}

/// Copies the state of a run into the one kept, or keeps the first.
fn save(run: &dyn FmuRun, kept: &mut Option<RunState>) {
    match kept {
        Some(kept) => run.save_into(kept),
        None => *kept = Some(run.save()),
    }
}
