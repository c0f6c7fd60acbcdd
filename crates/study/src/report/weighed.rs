//! How far the runs of a report are, weighed by what they are likely to take.

use std::cell::Cell;
use std::ops::ControlFlow;

use crate::progress::{Progress, Stop, Stopped, Watch};
use crate::robustness::RunFailure;

/// Runs of which each is a share of all.
pub(super) struct WeighedRuns<'a> {
    watch: &'a Watch<'a>,
    part: &'a str,
    total: f64,
    done: Cell<f64>,
    stop: Stop,
}

impl<'a> WeighedRuns<'a> {
    /// For runs that weigh `total`.
    pub(super) fn new(watch: &'a Watch<'a>, part: &'a str, total: f64) -> Self {
        Self { watch, part, total, done: Cell::new(0.0), stop: Stop::default() }
    }

    /// Does a run of this weight; it gets what to call with the fraction that is done. Once stopped no run is begun.
    pub(super) fn during<T>(
        &self,
        doing: &str,
        weight: f64,
        run: impl FnOnce(&dyn Fn(f64) -> ControlFlow<()>) -> Result<T, RunFailure>,
    ) -> Result<T, RunFailure> {
        if self.stop.go_on().is_break() {
            return Err(RunFailure::Stopped(Stopped.to_string()));
        }
        let done = self.done.get();
        let show = |fraction: f64| {
            let share = (done + weight * fraction) / self.total;
            self.stop.heed((self.watch)(Progress { part: self.part, doing, share }))
        };
        let _ = show(0.0);
        let result = run(&show);
        let _ = show(1.0);
        self.done.set(done + weight);
        result
    }

    /// Refuses what was stopped.
    pub(super) fn finish(&self) -> Result<(), Stopped> {
        if self.stop.go_on().is_break() { Err(Stopped) } else { Ok(()) }
    }
}

/// What a run at this tolerance is likely to take, over one at 1: the step of a method of order 5 follows the fifth
/// root.
pub(super) fn weight(tolerance: f64) -> f64 {
    tolerance.powf(-0.2)
}
