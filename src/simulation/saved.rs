//! A run as it stands, to be kept outside of the program and gone on with bit for bit.

use serde::{Deserialize, Serialize};

use super::run::Checkpoint;
use super::{Simulation, Start};
use crate::math::Numbers;
use crate::model::{Mode, Model};
use crate::scene::Scene;

/// Everything of a run that changes, but for the processor time and the mode changes recorded.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Saved {
    /// All numbers, SI units, in the order in which [`Numbers`] visits them.
    numbers: Vec<f64>,
    /// The modes as [`Mode::number`] gives them.
    modes: Vec<i8>,
    /// Accepted steps, rejected steps, mode changes.
    counts: [u64; 3],
    rates_hold: bool,
}

/// Why a run cannot go on from what was saved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RestoreError {
    /// It was saved from a run of another scene.
    #[error("{found} {what}, expected {expected}")]
    Length {
        /// Of what.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many the scene has.
        expected: usize,
    },
    /// No run gets to such a number.
    #[error("{what} = {value}, which no run gets to")]
    Number {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// No mass of the scene can be in such a mode.
    #[error("mass {} is in the mode {number}, which the scene does not have", mass + 1)]
    Mode {
        /// Which mass, from 0.
        mass: usize,
        /// The mode's number.
        number: i8,
    },
    /// The profile is not like this where the mass is.
    #[error("mass {} is in contact with a profile that is not the scene's", mass + 1)]
    Surface {
        /// Which mass, from 0.
        mass: usize,
    },
}

impl Simulation {
    /// Everything that the run has become.
    pub fn save(&self) -> Saved {
        let mut now = Checkpoint {
            run: self.run.clone(),
            rates: self.integrator.start_rates().clone(),
            power: self.integrator.start_power(),
        };
        let mut numbers = Vec::new();
        now.visit(&mut |number| numbers.push(*number));
        let counters = &now.run.counters;
        Saved {
            numbers,
            modes: now.run.state.mode.iter().map(|mode| mode.number()).collect(),
            counts: [counters.steps, counters.rejected, counters.events],
            rates_hold: now.run.rates_hold,
        }
    }

    /// A run of `scene` that goes on from `saved`, bit for bit as the run that was saved.
    ///
    /// # Errors
    /// [`RestoreError`] where `saved` is not of a run of this scene.
    pub fn restore(scene: &Scene, saved: &Saved) -> Result<Self, RestoreError> {
        let mut simulation = Self::started(scene, &Start::default());
        let slack = simulation.settings.tolerance.position;
        saved.write_into(&mut simulation.before, &simulation.model)?;
        check_ground(&simulation.before, &simulation.model, slack)?;
        simulation.go_back();
        Ok(simulation)
    }
}

impl Saved {
    fn write_into(&self, to: &mut Checkpoint, model: &Model) -> Result<(), RestoreError> {
        self.write_numbers(to)?;
        self.write_modes(&mut to.run.state.mode, model.has_friction)?;
        let counters = &mut to.run.counters;
        [counters.steps, counters.rejected, counters.events] = self.counts;
        to.run.rates_hold = self.rates_hold;
        to.run.carrier.find_place(&model.profile);
        let number = |what, value| Err(RestoreError::Number { what, value });
        match (to.run.s, to.run.step_size) {
            (s, _) if s < 0.0 => number("the time since the carrier's last kink", s),
            (_, step) if step <= 0.0 => number("the step size", step),
            _ => Ok(()),
        }
    }

    fn write_numbers(&self, to: &mut Checkpoint) -> Result<(), RestoreError> {
        let mut expected = 0;
        to.visit(&mut |_| expected += 1);
        check_length("numbers", self.numbers.len(), expected)?;
        if let Some(&value) = self.numbers.iter().find(|number| !number.is_finite()) {
            return Err(RestoreError::Number { what: "a number", value });
        }
        let mut numbers = self.numbers.iter();
        to.visit(&mut |place| *place = numbers.next().copied().unwrap_or_default());
        Ok(())
    }

    fn write_modes(&self, modes: &mut [Mode], has_friction: bool) -> Result<(), RestoreError> {
        check_length("modes", self.modes.len(), modes.len())?;
        for (mass, (mode, &number)) in modes.iter_mut().zip(&self.modes).enumerate() {
            let possible = Mode::of_number(number).filter(|&mode| has_friction || mode != Mode::Stick);
            *mode = possible.ok_or(RestoreError::Mode { mass, number })?;
        }
        Ok(())
    }
}

fn check_length(what: &'static str, found: usize, expected: usize) -> Result<(), RestoreError> {
    if found == expected { Ok(()) } else { Err(RestoreError::Length { what, found, expected }) }
}

/// Share of the distances that a place is summed from by which it may be off: more than rounding adds up to in any run.
const PLACE_ROUNDING: f64 = 1e-6;

/// Checks that the profile under each mass in contact is the scene's, within `slack` (m) and roundings.
///
/// It cannot be computed afresh to the last bit: its place was summed in another order.
fn check_ground(at: &Checkpoint, model: &Model, slack: f64) -> Result<(), RestoreError> {
    let (state, carrier, place) = (&at.run.state, &at.run.carrier, at.run.place().place);
    let fits = |i: usize| {
        let x = model.rest_x[i] + (place + state.elongation_x[i]);
        let summed = x.abs() + state.elongation_x[i].abs() + carrier.u.abs();
        let reach = slack + PLACE_ROUNDING * summed;
        let (found, here) = (&state.ground[i], model.ground(x));
        let bounds = model.profile.local_bounds(x - reach, x + reach);
        near(found.height, here.height, bounds.slope_max_abs * reach)
            && near(found.slope, here.slope, bounds.curvature_max_abs * reach)
            && found.curvature.abs() <= (1.0 + PLACE_ROUNDING) * bounds.curvature_max_abs
    };
    let in_contact = |&i: &usize| state.mode[i].in_contact();
    match (0..model.masses()).filter(in_contact).find(|&i| !fits(i)) {
        Some(mass) => Err(RestoreError::Surface { mass }),
        None => Ok(()),
    }
}

fn near(a: f64, b: f64, distance: f64) -> bool {
    (a - b).abs() <= distance + PLACE_ROUNDING * b.abs()
}
