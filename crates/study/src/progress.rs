//! How long work tells what it finds, and how it is ended before it is done.
//!
//! Who waits for it gets what is found by a callback, from any of the work's threads, and answers by a [`ControlFlow`]
//! whether it is to go on. What takes long between two answers, such as a layer that slides, asks a [`Stop`] at each step.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

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
