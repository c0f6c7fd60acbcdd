//! What the blocks of a step add up to.

use crate::math::Number;

/// What the blocks add up to.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepSums<T> {
    /// Force (N) and moment (N m) on the body at the end, in the ground's axes about the pose's point.
    pub(super) wrench: [T; 6],
    /// Force on the tread, N.
    pub(super) transport: T,
    /// Energy lost in the step by slip, J.
    pub(super) slip: f64,
    /// Energy lost in the step with contacts that were released, J.
    pub(super) release: f64,
    /// The first element found beyond the table.
    pub(super) beyond: Option<BeyondTable>,
    /// The first element found warmer than the table.
    pub(super) too_warm: Option<TooWarm>,
}

/// An element that is warmer than the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TooWarm {
    /// Its index, as elements are counted at that instant.
    pub(super) element: usize,
    /// When: the fraction of the step.
    pub(super) fraction: f64,
    /// By how much it is warmer than the temperature given, K.
    pub(super) rise: f64,
}

/// An element beyond the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BeyondTable {
    /// Its index, as elements are counted at that instant.
    pub(super) element: usize,
    /// When: the fraction of the step.
    pub(super) fraction: f64,
    /// The pressure on it, Pa.
    pub(super) pressure: f64,
    /// Its speed along the plane, m/s.
    pub(super) speed: f64,
}

impl<T: Number> StepSums<T> {
    pub(super) fn zero() -> Self {
        let zero = T::constant(0.0);
        Self { wrench: [zero; 6], transport: zero, slip: 0.0, release: 0.0, beyond: None, too_warm: None }
    }

    /// Adds those of elements that follow.
    pub(super) fn add(&mut self, further: &Self) {
        for (sum, load) in self.wrench.iter_mut().zip(&further.wrench) {
            *sum = *sum + *load;
        }
        self.transport = self.transport + further.transport;
        self.slip += further.slip;
        self.release += further.release;
        if further.beyond.is_some_and(|theirs| self.beyond.is_none_or(|own| theirs.fraction < own.fraction)) {
            self.beyond = further.beyond;
        }
        if further.too_warm.is_some_and(|theirs| self.too_warm.is_none_or(|own| theirs.fraction < own.fraction)) {
            self.too_warm = further.too_warm;
        }
    }

    /// The sums without their derivatives.
    pub(super) fn values(&self) -> StepSums<f64> {
        let Self { wrench, transport, slip, release, beyond, too_warm } = *self;
        StepSums { wrench: wrench.map(T::value), transport: transport.value(), slip, release, beyond, too_warm }
    }
}
