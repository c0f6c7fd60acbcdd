//! How long work tells what it finds and how far it is, and how it is ended before it is done.
//!
//! Who waits for it gets what is found by a callback, from any of the work's threads, and answers by a [`ControlFlow`]
//! whether it is to go on. What takes long between two answers, such as a layer that slides, asks a [`Stop`] at each step.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use asperity::simulation::Interrupt;

/// Says at each step of some work whether to go on; copies say the same.
#[derive(Clone, Debug, Default)]
pub struct Stop {
    stopped: Arc<AtomicBool>,
    wanted: Option<Interrupt>,
}

impl Stop {
    /// Stops the work where `go_on` breaks off, which is asked often and from all threads: it has to be quick.
    pub fn new(go_on: impl Fn() -> ControlFlow<()> + Send + Sync + 'static) -> Self {
        Self { wanted: Some(Interrupt::new(move || go_on().is_break())), ..Self::default() }
    }

    /// Whether to go on.
    pub fn go_on(&self) -> ControlFlow<()> {
        let is_stopped = self.stopped.load(Ordering::Relaxed) || self.wanted.as_ref().is_some_and(Interrupt::is_wanted);
        if is_stopped { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Heeds the answer of a callback, which it returns: where that breaks off, all of the work stops.
    pub fn heed<B>(&self, answer: ControlFlow<B>) -> ControlFlow<B> {
        if answer.is_break() {
            self.stopped.store(true, Ordering::Relaxed);
        }
        answer
    }

    /// The same for a simulation.
    pub fn interrupt(&self) -> Interrupt {
        let stop = self.clone();
        Interrupt::new(move || stop.go_on().is_break())
    }
}

/// How far a part of a computation is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress<'a> {
    /// The part; each is counted anew.
    pub part: &'a str,
    /// What is being done, in words; empty where there is nothing to tell it from.
    pub doing: &'a str,
    /// The share of the part that is done.
    pub share: f64,
}

/// What a computation calls as it goes on, from any thread; with `Break` it stops.
pub type Watch<'a> = dyn Fn(Progress<'_>) -> ControlFlow<()> + Sync + 'a;

/// Nobody wants the result any more.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("stopped")]
pub struct Stopped;

/// A part of a computation, of which steps are counted.
pub(crate) struct Counter<'a> {
    watch: &'a Watch<'a>,
    of: &'a str,
    steps: u64,
    done: AtomicU64,
}

impl<'a> Counter<'a> {
    pub(crate) fn new(watch: &'a Watch<'a>, of: &'a str, steps: usize) -> Self {
        Self { watch, of, steps: steps as u64, done: AtomicU64::new(0) }
    }

    /// One more step is done.
    pub(crate) fn step(&self) -> Result<(), Stopped> {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        match (self.watch)(Progress { part: self.of, doing: self.of, share: done as f64 / self.steps as f64 }) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(Stopped),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_answer_stops_all_that_asks() {
        let stop = Stop::default();
        let interrupt = stop.interrupt();
        assert!(stop.heed(ControlFlow::<()>::Continue(())).is_continue() && !interrupt.is_wanted());
        assert_eq!(stop.clone().heed(ControlFlow::Break("full")), ControlFlow::Break("full"));
        assert!(stop.go_on().is_break() && interrupt.is_wanted());
        assert!(Stop::new(|| ControlFlow::Break(())).interrupt().is_wanted());
    }
}
