//! The progress bar over all the runs of a report.

use std::cell::Cell;

use indicatif::ProgressBar;

use crate::program::progress;

/// Positions of the bar.
const LENGTH: f64 = 1000.0;

/// How far a report is: its runs weighed by what they are likely to take.
#[derive(Debug)]
pub(super) struct Progress {
    bar: ProgressBar,
    total: f64,
    done: Cell<f64>,
}

impl Progress {
    /// A report whose runs weigh `total`.
    pub(super) fn new(total: f64) -> Self {
        Self { bar: progress::bar(LENGTH as u64), total, done: Cell::new(0.0) }
    }

    /// Does a run of some weight; it gets what to call with the share of it that is done.
    pub(super) fn during<T>(&self, message: &str, weight: f64, run: impl FnOnce(&dyn Fn(f64)) -> T) -> T {
        self.bar.set_message(message.to_owned());
        let done = self.done.get();
        let show = |share: f64| self.bar.set_position((LENGTH * (done + weight * share) / self.total) as u64);
        let result = run(&show);
        show(1.0);
        self.done.set(done + weight);
        result
    }

    /// Takes the bar off the terminal.
    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// What a run at this tolerance is likely to take, over one at 1: the step of a method of order 5 follows the fifth
/// root.
pub(super) fn weight(tolerance: f64) -> f64 {
    tolerance.powf(-0.2)
}
