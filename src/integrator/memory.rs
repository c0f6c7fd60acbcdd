//! The remembered speeds over one step: one state of each mass, v̇_s = (v_t² - v_s²)/(2D), integrated by the method itself
//! (docs/theory.md, section 15).
//!
//! At a stage v_s = b + γh v̇_s with the contributions b of the earlier stages: a quadratic equation in v_s, which friction
//! solves at any v_t ([`SpeedMemory`]). What sticks ages by the exact solution.

use super::stage_values::StageValues;
use super::tableau::StageWeights;
use crate::math::weighted_sum;
use crate::model::{Mode, Model, SpeedMemory, State, aged, memory_rate};

/// The remembered speeds at a stage, as far as they are known before it is solved.
#[derive(Clone, Debug)]
pub(super) struct StageMemory {
    /// D, m.
    way: f64,
    /// γh/(2D), s/m.
    weight: f64,
    /// b by mass, m/s; empty where friction has no memory.
    base: Vec<f64>,
}

impl StageMemory {
    pub(super) fn new(model: &Model) -> Self {
        Self { way: model.friction.memory.unwrap_or(1.0), weight: 0.0, base: vec![0.0; model.memory_variables()] }
    }

    /// Sets what is known of the speeds at a stage at the fraction `c` of a step of length `h` (s) from `start`, whose
    /// implicit stages have β = `beta` (s), with these rates at the earlier `stages` and their `weights`.
    pub(super) fn prepare(
        &mut self,
        start: &State,
        (c, h, beta): (f64, f64, f64),
        stages: &[StageValues],
        weights: &[f64],
    ) {
        let Self { way, weight, base } = self;
        if base.is_empty() {
            return;
        }
        *weight = beta / (2.0 * *way);
        let earlier = stages.iter().zip(weights).filter(|(_, weight)| **weight != 0.0);
        let rates = earlier.map(|(stage, weight)| (h * weight, &stage.memory_rate[..]));
        weighted_sum(base, std::iter::once((1.0, &start.memory[..])).chain(rates));
        // What has stuck so far: at rest the equation has the exact solution.
        for (i, base) in base.iter_mut().enumerate() {
            if start.mode[i] == Mode::Stick && stages.iter().all(|stage| stage.velocity_x[i] == 0.0) {
                let exact = aged(*way, start.memory[i], c * h);
                *base = exact + *weight * exact * exact;
            }
        }
    }

    /// Of mass `i`; `None` where friction has no memory.
    #[inline]
    pub(super) fn of_mass(&self, i: usize) -> Option<SpeedMemory> {
        self.base.get(i).map(|&base| SpeedMemory { base, weight: self.weight })
    }

    /// Writes the speeds at the solved stage, where the carrier is at `profile_position` (m), and their rates.
    pub(super) fn write(&self, model: &Model, profile_position: f64, state: &mut State, rates: &mut StageValues) {
        for i in 0..self.base.len() {
            let speed = state.tangential_speed(model, i, profile_position);
            let memory = SpeedMemory { base: self.base[i], weight: self.weight };
            state.memory[i] = memory.at(speed).value;
            rates.memory_rate[i] = memory_rate(self.way, speed, state.memory[i]);
        }
    }
}

/// Writes the speeds at the fraction `theta` of a step of length `h` (s) from `start`, with the
/// weights of the stages' rates in the `integral` of one, s.
pub(super) fn within(
    model: &Model,
    (start, h, theta): (&State, f64, f64),
    stages: &[StageValues],
    integral: &StageWeights,
    memory: &mut [f64],
) {
    if model.friction.memory.is_none() {
        return;
    }
    let rates = integral.iter().zip(stages).map(|(weight, stage)| (*weight, &stage.memory_rate[..]));
    weighted_sum(memory, std::iter::once((1.0, &start.memory[..])).chain(rates));
    for (i, memory) in memory.iter_mut().enumerate() {
        *memory = exact_or(model, (start, h, theta), i, stages, *memory);
    }
}

/// v_s of mass `i` alone there, m/s; `None` where friction has no memory.
pub(super) fn of_mass_within(
    model: &Model,
    (start, h, theta): (&State, f64, f64),
    stages: &[StageValues],
    integral: &StageWeights,
    i: usize,
) -> Option<f64> {
    let remembered = start.memory.get(i)?;
    let gained = integral.iter().zip(stages).map(|(weight, stage)| weight * stage.memory_rate[i]);
    Some(exact_or(model, (start, h, theta), i, stages, remembered + gained.sum::<f64>()))
}

/// v_s of mass `i`: the exact one if it sticks throughout, else the `interpolated` one.
fn exact_or(
    model: &Model,
    (start, h, theta): (&State, f64, f64),
    i: usize,
    stages: &[StageValues],
    interpolated: f64,
) -> f64 {
    let sticks = start.mode[i] == Mode::Stick && stages.iter().all(|stage| stage.velocity_x[i] == 0.0);
    match model.friction.memory.filter(|_| sticks) {
        Some(way) => aged(way, start.memory[i], theta * h),
        None => interpolated.max(0.0),
    }
}
