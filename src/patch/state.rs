//! What a run of a patch is told, what it may refuse, and what it holds.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::block::{ElementBlock, ElementMode};
use super::block_contacts::StepSums;
use super::definition::Patch;
use super::face::BLOCK;
use super::heat::ElementHeat;
use super::motion::PoseMotion;
use crate::math::{Number, not_finite};
use crate::scene::{SMALLEST, is_possible};

/// Most substeps of a step, whatever the number of elements.
pub(super) const MAX_SUBSTEPS: f64 = 1e5;
/// The work that a call of a master may take, in the time that an element takes through a substep on a rigid backing,
/// without heat and tangents: some 0.1 µs, so a second. A master that diverges would wait for minutes otherwise.
pub(super) const MAX_WORK: f64 = 1e7;
/// Substeps that a step may always have where no master waits for it, however many elements a patch has.
const MIN_SUBSTEPS_ALLOWED: f64 = 200.0;
/// What the search for the elements that are on the face costs in a substep for a block of them.
const SEARCH: f64 = 0.2;

impl Patch {
    /// What taking an element through a substep costs, over what it does on a rigid backing without heat and tangents, as it
    /// was measured.
    pub(super) fn cost_of_element(&self) -> f64 {
        let factors = [
            (self.has_tread(), 1.2),
            (self.backing().is_some(), 1.3),
            (self.heat().is_some(), 1.3),
            (self.has_tangents(), 12.0),
        ];
        factors.into_iter().filter(|(is_there, _)| *is_there).map(|(_, factor)| factor).product()
    }

    /// The work of a substep of a step in which so many elements are on the face at some time. Blocks are done as a whole.
    pub(super) fn work_of_substep(&self, elements: usize) -> f64 {
        let blocks = |elements: usize| elements.div_ceil(BLOCK) as f64;
        blocks(self.count()) * BLOCK as f64 * self.cost_of_element() + SEARCH * blocks(elements)
    }

    /// The work of the shortest step, over what a call of a master may take: no FMU does a step of a patch above 1.
    pub fn share_of_call(&self) -> f64 {
        f64::from(self.refine) * self.work_of_substep(self.count()) / MAX_WORK
    }

    /// The most work that a step may take where no master waits for it.
    pub(super) fn work_of_step(&self) -> f64 {
        MAX_WORK.max(MIN_SUBSTEPS_ALLOWED * self.work_of_substep(self.count()))
    }
}

/// Where a body is and how it moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// The position of the pose's point: x, y, z, m.
    pub place: [f64; 3],
    /// The orientation: roll, pitch, yaw, rad.
    pub angles: [f64; 3],
}

impl Pose {
    /// x, y, z (m), roll, pitch, yaw (rad).
    pub fn coordinates(&self) -> [f64; 6] {
        let ([x, y, z], [roll, pitch, yaw]) = (self.place, self.angles);
        [x, y, z, roll, pitch, yaw]
    }

    /// Places of the body's axes (m) from the pose's point in the ground's axes, m.
    pub fn arms(&self, places: impl IntoIterator<Item = [f64; 3]>) -> Vec<[f64; 3]> {
        let now = PoseMotion { start: self.coordinates(), change: [0.0; 6], duration: 1.0 }.at(0.0);
        places.into_iter().map(|place| now.turned(place)).collect()
    }

    /// The pose with these coordinates.
    pub fn from_coordinates([x, y, z, roll, pitch, yaw]: [f64; 6]) -> Self {
        Self { place: [x, y, z], angles: [roll, pitch, yaw] }
    }
}

/// How a patch moves over a step: straight from where it stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatchMotion {
    /// How long the step takes, s.
    pub duration: f64,
    /// The rates of the pose's coordinates, m/s and rad/s.
    pub rates: [f64; 6],
    /// The speed of the tread at the end, m/s; 0 without one.
    pub transport_speed: f64,
    /// The temperature over the step, K; 0 where the table has no temperatures.
    pub temperature: f64,
}

/// Where a run begins.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PatchStart {
    /// The time, s.
    pub time: f64,
    /// The pose.
    pub pose: Pose,
    /// The rates of its coordinates, m/s and rad/s.
    pub rates: [f64; 6],
    /// The speed of the tread, m/s; 0 without one.
    pub transport_speed: f64,
    /// The temperature, K; 0 where the table has no temperatures.
    pub temperature: f64,
}

/// Why a motion of a patch is refused; the patch is then as it was.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MotionError {
    /// A number is not one, or out of range.
    #[error("{what} is {value:?} at t = {time} s, which is out of range; the step was not done")]
    OutOfRange {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The time, s.
        time: f64,
    },
    /// The step would take too many substeps.
    #[error("the step from t = {time} s takes {substeps:.0} substeps or more: more than {most:.0}; take shorter steps")]
    TooManySubsteps {
        /// The time, s.
        time: f64,
        /// How many, at least.
        substeps: f64,
        /// How many the patch may take, by what one of its elements and outputs costs.
        most: f64,
    },
    /// An element is beyond the table.
    #[error("{element} is beyond the table at t = {time} s: {pressure} Pa at {speed} m/s")]
    BeyondTable {
        /// Its name, as its variables have it.
        element: String,
        /// The time, s.
        time: f64,
        /// The pressure on it, Pa.
        pressure: f64,
        /// Its speed along the plane, m/s.
        speed: f64,
        /// Whether a shorter step may end before.
        within: bool,
    },
    /// The elements go through too much.
    #[error(
        "gave up the step at t = {time} s: its elements go through too much, as where a body turns fast; do shorter steps"
    )]
    TooMuchWork {
        /// The time, s.
        time: f64,
    },
    /// The temperature is beyond the table.
    #[error("the temperature {kelvin} K is beyond the table at t = {time} s")]
    TemperatureBeyondTable {
        /// The time, s.
        time: f64,
        /// The temperature, K.
        kelvin: f64,
    },
    /// Slip has warmed an element beyond the table.
    #[error("{element} is warmer than the table at t = {time} s: {kelvin} K")]
    ElementTooWarm {
        /// Its name, as its variables have it.
        element: String,
        /// The time, s.
        time: f64,
        /// Its temperature, K.
        kelvin: f64,
        /// Whether a shorter step may end before.
        within: bool,
    },
}

/// Why a run cannot be continued from a saved state.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PatchRestoreError {
    /// A number that is not valid in any run.
    #[error("invalid state: {what} = {value}")]
    Invalid {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The state is of another number of elements.
    #[error("invalid state: {found} elements, expected {expected}")]
    Count {
        /// In the state.
        found: usize,
        /// In the patch.
        expected: usize,
    },
}

/// The springs of all elements.
#[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Springs {
    /// G along x, the force on the ground, N.
    pub(super) x: Vec<f64>,
    /// G along y, N.
    pub(super) y: Vec<f64>,
    /// K, the stiffness, N/m.
    pub(super) stiffness: Vec<f64>,
    /// By the numbers of [`ElementMode`].
    pub(super) mode: Vec<u8>,
    /// Where slip warms the elements.
    pub(super) heat: Vec<ElementHeat>,
}

impl Clone for Springs {
    fn clone(&self) -> Self {
        let Self { x, y, stiffness, mode, heat } = self;
        Self { x: x.clone(), y: y.clone(), stiffness: stiffness.clone(), mode: mode.clone(), heat: heat.clone() }
    }

    /// Into the arrays that there are; the derived one would replace them.
    fn clone_from(&mut self, other: &Self) {
        self.x.clone_from(&other.x);
        self.y.clone_from(&other.y);
        self.stiffness.clone_from(&other.stiffness);
        self.mode.clone_from(&other.mode);
        self.heat.clone_from(&other.heat);
    }
}

impl Springs {
    pub(super) fn sticks(&self, i: usize) -> bool {
        self.mode[i] == ElementMode::Sticking as u8
    }

    /// Relaxed and cold; of elements that slip warms or not.
    pub(super) fn new(count: usize, warms: bool) -> Self {
        Self {
            x: vec![0.0; count],
            y: vec![0.0; count],
            stiffness: vec![0.0; count],
            mode: vec![0; count],
            heat: vec![ElementHeat::default(); if warms { count } else { 0 }],
        }
    }

    /// By how much the law of element `i` is warmer than the temperature given, K.
    pub(super) fn rise_of_law(&self, i: usize) -> f64 {
        self.heat.get(i).map_or(0.0, |heat| heat.of_law)
    }

    /// By how much element `i` is warmer than the temperature given, K.
    pub(super) fn rise(&self, i: usize) -> f64 {
        self.heat.get(i).map_or(0.0, ElementHeat::rise)
    }

    /// Sets the springs of a block; its first element is the one at `start` here. Those that are not here are relaxed.
    pub(super) fn load<T: Number>(&self, block: &mut ElementBlock<T>, start: isize, count: usize) {
        for (lane, i) in indices(0..self.x.len(), start, count) {
            block.springs.force[0][lane] = T::constant(self.x[i]);
            block.springs.force[1][lane] = T::constant(self.y[i]);
            block.springs.stiffness[lane] = T::constant(self.stiffness[i]);
            if let Some(heat) = self.heat.get(i) {
                block.heat.load(lane, heat);
            }
        }
    }

    /// All of them, to be set.
    pub(super) fn all(&mut self) -> SpringsMut<'_> {
        let Self { x, y, stiffness, mode, heat } = self;
        SpringsMut { first: 0, x, y, stiffness, mode, heat }
    }
}

/// Springs that follow each other, to be set.
#[derive(Debug)]
pub(super) struct SpringsMut<'a> {
    /// The index of the first.
    first: usize,
    x: &'a mut [f64],
    y: &'a mut [f64],
    stiffness: &'a mut [f64],
    mode: &'a mut [u8],
    heat: &'a mut [ElementHeat],
}

impl<'a> SpringsMut<'a> {
    /// Takes those before the index `end` off.
    pub(super) fn split_off_to(&mut self, end: usize) -> SpringsMut<'a> {
        let count = end.saturating_sub(self.first).min(self.x.len());
        let first = self.first;
        self.first += count;
        SpringsMut {
            first,
            x: take(&mut self.x, count),
            y: take(&mut self.y, count),
            stiffness: take(&mut self.stiffness, count),
            mode: take(&mut self.mode, count),
            heat: take(&mut self.heat, count),
        }
    }

    /// Takes the springs of a block over; its first element has the index `start`. Those that are not here are lost.
    pub(super) fn store<T: Number>(&mut self, block: &ElementBlock<T>, start: isize, count: usize) {
        for (lane, i) in indices(self.first..self.first + self.x.len(), start, count) {
            self.x[i] = block.springs.force[0][lane].value();
            self.y[i] = block.springs.force[1][lane].value();
            self.stiffness[i] = block.springs.stiffness[lane].value();
            self.mode[i] = block.mode[lane];
            if let Some(heat) = self.heat.get_mut(i) {
                *heat = block.heat.element(lane);
            }
        }
    }
}

/// The first `count` of a slice, which goes on after them; all of a shorter one.
fn take<'a, T>(slice: &mut &'a mut [T], count: usize) -> &'a mut [T] {
    let whole = std::mem::take(slice);
    let (front, back) = whole.split_at_mut(count.min(whole.len()));
    *slice = back;
    front
}

/// The lanes of a block of `count` elements from the index `start` on, as far as they are among the `springs`, and
/// their places there.
fn indices(springs: Range<usize>, start: isize, count: usize) -> impl Iterator<Item = (usize, usize)> {
    let start = start - springs.start as isize;
    let skipped = start.min(0).unsigned_abs().min(count);
    let place = start.max(0).unsigned_abs();
    let shared = (count - skipped).min(springs.len().saturating_sub(place));
    (0..shared).map(move |i| (skipped + i, place + i))
}

/// All of a run that changes, but for the springs. SI units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Totals {
    pub(super) time: f64,
    pub(super) pose: Pose,
    /// The rates of the pose in the last step, or at the start.
    pub(super) rates: [f64; 6],
    /// The speed of the tread at the end of the last step.
    pub(super) transport_speed: f64,
    /// The speed that the contact law saw there, the same but for rounding.
    pub(super) tread_speed: f64,
    /// The part of a cell of the tread that has entered: from 0 to below 1.
    pub(super) place: f64,
    pub(super) temperature: f64,
    /// Force and moment on the body.
    pub(super) wrench: [f64; 6],
    /// The force on the tread.
    pub(super) transport_force: f64,
    /// Energy lost by slip since the start, J.
    pub(super) slip_energy: f64,
    /// Energy lost with contacts that were released since the start, J.
    pub(super) release_energy: f64,
    /// Energy lost by dampers since the start, J.
    pub(super) damper_energy: f64,
    /// The dissipated power, mean over the last step.
    pub(super) power: f64,
}

/// All that changes in a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PatchState {
    pub(super) totals: Totals,
    pub(super) springs: Springs,
    /// Changes of the wrench with the targets of a step; `None` where they are not asked for.
    pub(super) tangents: Option<Box<[[f64; 6]; 6]>>,
}

impl PatchStart {
    pub(super) fn check(&self) -> Result<(), MotionError> {
        check(self.time, "the time", &[self.time])?;
        check(self.time, "a coordinate of the pose", &self.pose.coordinates())?;
        check(self.time, "a rate of the pose", &self.rates)?;
        check(self.time, "the speed of the tread", &[self.transport_speed])?;
        check(self.time, "the temperature", &[self.temperature])
    }
}

fn check(time: f64, what: &'static str, values: &[f64]) -> Result<(), MotionError> {
    match values.iter().find(|value| !is_possible(**value)) {
        Some(&value) => Err(MotionError::OutOfRange { what, value, time }),
        None => Ok(()),
    }
}

/// Refuses a duration by which nothing can be divided.
pub(super) fn check_duration(duration: f64, time: f64) -> Result<(), MotionError> {
    if duration >= SMALLEST {
        return Ok(());
    }
    Err(MotionError::OutOfRange { what: "the duration", value: duration, time })
}

impl Totals {
    /// Takes the loads at the end of a step and its losses over.
    pub(super) fn add<T: Number>(&mut self, sums: &StepSums<T>, duration: f64) {
        self.wrench = sums.wrench.map(T::value);
        self.transport_force = sums.transport.value();
        self.slip_energy += sums.slip;
        self.release_energy += sums.release;
        self.damper_energy += sums.damper;
        self.power = if duration > 0.0 { (sums.slip + sums.release + sums.damper) / duration } else { 0.0 };
    }

    /// Refuses what no run goes on from: loads, losses or tangents that are no numbers or too large.
    pub(super) fn check(&self, tangents: Option<&[[f64; 6]; 6]>) -> Result<(), MotionError> {
        let loads = self.numbers().find(|(_, value)| !is_possible(*value));
        let tangents = tangents.and_then(|rows| rows.as_flattened().iter().find(|value| !value.is_finite()));
        match loads.or(tangents.map(|value| ("a tangent", *value))) {
            Some((what, value)) => Err(MotionError::OutOfRange { what, value, time: self.time }),
            None => Ok(()),
        }
    }

    fn numbers(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let poses = self.pose.coordinates().into_iter().chain([self.time]).map(|value| ("a coordinate", value));
        let rates = self.rates.into_iter().chain([self.transport_speed, self.tread_speed, self.temperature]);
        let losses = [self.power, self.slip_energy, self.release_energy, self.damper_energy];
        let loads = self.wrench.into_iter().chain([self.transport_force]).chain(losses);
        poses.chain(rates.map(|value| ("a rate", value))).chain(loads.map(|value| ("a load or a loss", value)))
    }
}

impl PatchState {
    /// The pose.
    pub fn pose(&self) -> Pose {
        self.totals.pose
    }

    /// The speed of the tread, m/s.
    pub fn transport_speed(&self) -> f64 {
        self.totals.transport_speed
    }

    /// Copies `other`; of the same patch without allocating.
    pub fn copy_from(&mut self, other: &Self) {
        self.totals = other.totals;
        self.springs.clone_from(&other.springs);
        self.tangents.clone_from(&other.tangents);
    }

    /// Refuses numbers that no run can have reached.
    pub(super) fn check(&self, patch: &Patch) -> Result<(), PatchRestoreError> {
        let Springs { x, y, stiffness, mode, heat } = &self.springs;
        let count = patch.count();
        let warm = if patch.heat().is_some() { count } else { 0 };
        if heat.len() != warm {
            return Err(PatchRestoreError::Count { found: heat.len(), expected: warm });
        }
        for found in [x.len(), y.len(), stiffness.len(), mode.len()] {
            if found != count {
                return Err(PatchRestoreError::Count { found, expected: count });
            }
        }
        let invalid = |what, value| Err(PatchRestoreError::Invalid { what, value });
        if let Some((what, value)) = self.totals.numbers().find(|(_, value)| !is_possible(*value)) {
            return invalid(what, value);
        }
        if let Some((what, value)) = not_finite(self) {
            return invalid(what, value);
        }
        if let Some(value) = stiffness.iter().find(|value| **value < 0.0) {
            return invalid("the stiffness of a spring", *value);
        }
        if let Some(value) = mode.iter().find(|value| **value > ElementMode::Sticking as u8) {
            return invalid("a mode", f64::from(*value));
        }
        if let Some(value) = heat.iter().find_map(ElementHeat::invalid) {
            return invalid("a rise of the temperature", value);
        }
        let place = self.totals.place;
        if !(0.0..1.0).contains(&place) {
            return invalid("the place of the tread", place);
        }
        if self.tangents.is_some() != patch.has_tangents() {
            return invalid("the number of tangents", 0.0);
        }
        Ok(())
    }
}
