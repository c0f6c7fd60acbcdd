//! What a run records on request: mode changes, and switches between the methods.

use std::fmt;

/// A mode change of one mass.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeChange {
    /// When, s.
    pub time: f64,
    /// Which mass, from 0.
    pub mass: usize,
    /// Mode before: 0 free, 1 or -1 slipping, 2 sticking.
    pub from: i8,
    /// Mode after.
    pub to: i8,
}

/// A switch to the other method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MethodSwitch {
    /// When, s.
    pub time: f64,
    /// To time-stepping, or back to events.
    pub to_time_stepping: bool,
    /// The mean number of mode changes per time step that decided it.
    pub mode_changes_per_step: f64,
}

impl fmt::Display for MethodSwitch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { time, to_time_stepping, mode_changes_per_step } = self;
        let method = if *to_time_stepping { "time-stepping" } else { "event-driven" };
        write!(f, "t = {time} s: {method} from here on; mode changes per time step: {mode_changes_per_step:.2}")
    }
}
