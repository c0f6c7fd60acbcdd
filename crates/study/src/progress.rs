//! How far a long computation is, and whether it is to go on.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};

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
