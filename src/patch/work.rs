//! The work of a step, counted by all threads together: an element that diverges, or that turns through the plane again
//! and again, would keep a master waiting otherwise.

use std::sync::atomic::{AtomicU64, Ordering};

/// What the elements of a step have been through: parts of it and, where their pressures change much, segments.
///
/// A step within the limit always counts the same; one beyond it is given up, whoever of its threads finds that first.
#[derive(Debug)]
pub(super) struct WorkCounter {
    done: AtomicU64,
    most: u64,
}

impl WorkCounter {
    /// A counter of so much work at most.
    pub(super) fn new(most: f64) -> Self {
        Self { done: AtomicU64::new(0), most: most as u64 }
    }

    /// Adds work; returns whether there is too much.
    pub(super) fn add(&self, work: u64) -> bool {
        self.done.fetch_add(work, Ordering::Relaxed).saturating_add(work) > self.most
    }

    /// Whether there was too much.
    pub(super) fn is_exceeded(&self) -> bool {
        self.done.load(Ordering::Relaxed) > self.most
    }

    /// The work done.
    #[cfg(test)]
    pub(super) fn done(&self) -> u64 {
        self.done.load(Ordering::Relaxed)
    }
}
