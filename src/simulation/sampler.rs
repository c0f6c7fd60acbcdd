//! The sampler of a motion's result rows: it shows them where the run stands, and within its steps.

use cpu_time::ThreadTime;

use super::controller::{TrialStep, WorkLimit};
use super::motion::SimulationError;
use super::reference_run::ReferenceRun;
use super::run::Run;
use crate::outputs::{Counters, Snapshot};

/// The rows of a motion that are still to be shown, and the processor time.
pub(super) struct RowSampler<'a, F> {
    times: &'a [f64],
    /// Runs where the processor time is asked for.
    clock: Option<ThreadTime>,
    /// Processor time before the motion, s.
    run_time: f64,
    observe: F,
}

impl<'a, F: FnMut(f64, &Snapshot<'_>)> RowSampler<'a, F> {
    /// The rows at `times`, shown by `observe`; `run_time` is the processor time before, counted on where it is
    /// `measured`.
    pub(super) fn new(times: &'a [f64], (run_time, measured): (f64, bool), observe: F) -> Self {
        Self { times, clock: measured.then(ThreadTime::now), run_time, observe }
    }

    /// Processor time since the start, s.
    pub(super) fn run_time(&self) -> f64 {
        self.run_time + self.clock.as_ref().map_or(0.0, |clock| clock.elapsed().as_secs_f64())
    }

    /// Shows the rows up to the time `end` of the motion, where `run` stands.
    pub(super) fn show(&mut self, run: &mut Run, reference: &mut Option<ReferenceRun>, end: f64) {
        while self.times.first().is_some_and(|&time| time <= end) {
            let s = run.context.state.s;
            run.context.state.counters = self.show_next(run.snapshot(), reference.as_mut(), s);
        }
    }

    /// Shows the rows that lie within `step` of a motion of `duration`, s. Where its dense output is not good enough,
    /// the step is shortened to end at the row; where its local regions cannot go on, it is cut there. Returns the end
    /// of the step, s after the start of the motion, and whether it was shortened.
    pub(super) fn show_within(
        &mut self,
        run: &mut Run,
        reference: &mut Option<ReferenceRun>,
        step: &mut TrialStep,
        duration: f64,
        work: &mut WorkLimit,
    ) -> Result<(f64, bool), SimulationError> {
        let start = run.context.state.s;
        let (mut end, mut shortened) = (step.end(start, duration), false);
        while let Some(time) = self.times.first().copied().filter(|&time| time < end) {
            if run.can_show_within(step, time) {
                end = run.advance_regions(step, (time, end), work)?;
                if time < end {
                    let theta = run.context.state.fraction_at(time, step.h);
                    let s = start + theta * step.h;
                    let shown = self.show_next(run.snapshot_within(step.h, theta), reference.as_mut(), s);
                    run.context.state.counters = shown;
                }
            } else {
                (*step, end) = run.cut_step_at(time, duration, work)?;
                shortened = true;
            }
        }
        end = run.advance_regions(step, (end, end), work)?;
        Ok((end, shortened))
    }

    /// Shows `snapshot`, of the time `s` of the motion, as the next row, compared with the `reference`. Returns the
    /// counters then.
    fn show_next(&mut self, mut snapshot: Snapshot<'_>, reference: Option<&mut ReferenceRun>, s: f64) -> Counters {
        if let Some(reference) = reference {
            reference.compare(s, &mut snapshot);
        }
        snapshot.run_time = self.run_time();
        if let Some((&time, later)) = self.times.split_first() {
            self.times = later;
            (self.observe)(time, &snapshot);
        }
        snapshot.counters
    }
}
