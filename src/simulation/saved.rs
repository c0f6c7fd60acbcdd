//! A run as it stands, to be kept outside of the program and gone on with bit for bit.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::run::Checkpoint;
use super::{Simulation, Start};
use crate::math::Numbers;
use crate::model::{Mode, Model, SurfacePoint};
use crate::scene::{Method, ParameterError, Scene};

/// Everything of a run that changes, but for the processor time and the mode changes recorded.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Saved {
    run: SavedRun,
    /// The finer run beside it.
    companion: Option<SavedRun>,
}

/// What changes in one run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct SavedRun {
    /// All numbers, SI units, in the order in which [`Numbers`] visits them.
    numbers: Vec<f64>,
    /// The modes as [`Mode::number`] gives them.
    modes: Vec<i8>,
    /// Accepted steps, rejected steps, mode changes.
    counts: [u64; 3],
    rates_hold: bool,
    /// Whether the run is stepped, or driven by events.
    stepping: bool,
}

/// Why a run cannot go on from what was saved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RestoreError {
    /// The scene cannot run at all.
    #[error(transparent)]
    Scene(#[from] ParameterError),
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
        Saved { run: self.save_run(), companion: self.companion.as_ref().map(|companion| companion.finer().save_run()) }
    }

    fn save_run(&self) -> SavedRun {
        let mut now = Checkpoint {
            run: self.run.clone(),
            rates: self.integrator.start_rates().clone(),
            exchange: self.integrator.start_exchange(),
        };
        let state = &mut now.run.state;
        // What is left of the profile under masses that are free by now says nothing.
        for (surface, _) in state.surface.iter_mut().zip(&state.mode).filter(|(_, mode)| !mode.in_contact()) {
            *surface = SurfacePoint::default();
        }
        let mut numbers = Vec::new();
        now.visit(&mut |number| numbers.push(*number));
        let counters = &now.run.counters;
        SavedRun {
            numbers,
            modes: now.run.state.mode.iter().map(|mode| mode.number()).collect(),
            counts: [counters.steps, counters.rejected, counters.events],
            rates_hold: now.run.rates_hold,
            stepping: now.run.stepping,
        }
    }

    /// A run of `scene` that goes on from `saved`, bit for bit as the run that was saved.
    ///
    /// # Errors
    /// [`RestoreError`] where `saved` is not of a run of this scene.
    pub fn restore(scene: &Scene, saved: &Saved) -> Result<Self, RestoreError> {
        scene.check()?;
        let mut simulation = Self::started(scene, &Start::default());
        simulation.read(&saved.run)?;
        match (&mut simulation.companion, &saved.companion) {
            (Some(companion), Some(saved)) => companion.finer_mut().read(saved)?,
            (companion, saved) => {
                check_length("finer runs", usize::from(saved.is_some()), usize::from(companion.is_some()))?;
            }
        }
        simulation.go_back();
        let [u, w] = simulation.run.start;
        let model = Arc::make_mut(&mut simulation.model);
        model.freeze_dashpots(model.profile.reduce(u), w);
        if let Some(companion) = &mut simulation.companion {
            companion.finer_mut().model = Arc::clone(&simulation.model);
        }
        Ok(simulation)
    }

    /// Reads `saved` as the run to go back to.
    fn read(&mut self, saved: &SavedRun) -> Result<(), RestoreError> {
        saved.write_into(&mut self.before, &self.model)?;
        if self.settings.method == Method::Auto {
            self.before.run.stepping = saved.stepping;
        }
        check_surface(&self.before, &self.model, self.settings.tolerance.position)
    }
}

impl SavedRun {
    fn write_into(&self, to: &mut Checkpoint, model: &Model) -> Result<(), RestoreError> {
        self.write_numbers(to)?;
        self.write_modes(&mut to.run.state.mode, model.has_friction)?;
        let counters = &mut to.run.counters;
        [counters.steps, counters.rejected, counters.events] = self.counts;
        to.run.rates_hold = self.rates_hold;
        to.run.carrier.find_profile_position(&model.profile);
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
fn check_surface(at: &Checkpoint, model: &Model, slack: f64) -> Result<(), RestoreError> {
    let (state, carrier, place) = (&at.run.state, &at.run.carrier, at.run.carrier_position().profile_position);
    let fits = |i: usize| {
        let x = model.rest_x[i] + (place + state.elongation_x[i]);
        let summed = x.abs() + state.elongation_x[i].abs() + carrier.u.abs();
        let reach = slack + PLACE_ROUNDING * summed;
        let (found, here) = (&state.surface[i], model.surface_at(x));
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

#[cfg(test)]
mod tests {
    use super::super::tests::{WAVE, scene, scene_with_rate_shear, variables_of};
    use super::*;
    use crate::scene::Path;
    use crate::simulation::Motion;

    /// A run with masses free, slipping and sticking.
    fn run(scene: &Scene) -> Simulation {
        let mut simulation = Simulation::new(scene, &Start { w: -2e-6, ..Start::default() }).unwrap();
        simulation.advance(&WAVE).unwrap();
        simulation
    }

    fn bits(scene: &Scene, simulation: &mut Simulation) -> Vec<u64> {
        variables_of(scene, simulation).into_iter().map(|(_, value)| value.to_bits()).collect()
    }

    #[test]
    fn a_saved_run_goes_on_bit_for_bit() {
        for scene in [scene(), scene_with_rate_shear()] {
            let mut first = run(&scene);
            let bytes = postcard::to_stdvec(&first.save()).unwrap();
            let mut second = Simulation::restore(&scene, &postcard::from_bytes(&bytes).unwrap()).unwrap();
            assert_eq!(bits(&scene, &mut second), bits(&scene, &mut first));
            assert_eq!(second.force_rates(), first.force_rates());
            for _ in 0..20 {
                let motion = Motion { duration: 3.7e-6, ..WAVE };
                assert_eq!((first.advance(&motion), second.advance(&motion)), (Ok(()), Ok(())));
                assert_eq!(bits(&scene, &mut second), bits(&scene, &mut first));
            }
            assert_eq!(first.save(), second.save());
        }
    }

    #[test]
    fn a_run_not_yet_under_way_is_restored_too() {
        let scene = scene();
        let mut first = Simulation::new(&scene, &Start { u: 3.0, w: -1e-6, w_rate: -0.1, ..Start::default() }).unwrap();
        let mut second = Simulation::restore(&scene, &first.save()).unwrap();
        assert_eq!((first.advance(&WAVE), second.advance(&WAVE)), (Ok(()), Ok(())));
        assert_eq!(bits(&scene, &mut second), bits(&scene, &mut first));
    }

    /// What is saved is of the run alone, not of the workspace that it had: the profile under masses that have lifted is
    /// not.
    #[test]
    fn runs_alike_are_saved_alike() {
        let scene = scene();
        let mut first = run(&scene);
        let lift = Motion { duration: 3e-5, u: Path::default(), w: Path { rate: 0.2, ..Path::default() } };
        for _ in 0..20 {
            let mut second = Simulation::restore(&scene, &first.save()).unwrap();
            assert_eq!((first.advance(&lift), second.advance(&lift)), (Ok(()), Ok(())));
            assert_eq!(first.save(), second.save());
        }
        assert!(first.run.state.mode.iter().all(|&mode| mode == Mode::Free));
    }

    #[test]
    fn what_no_run_gets_to_is_refused() {
        let scene = scene();
        let saved = run(&scene).save();
        let refused = |change: &dyn Fn(&mut Saved)| {
            let mut saved = saved.clone();
            change(&mut saved);
            Simulation::restore(&scene, &saved).unwrap_err().to_string()
        };
        assert!(refused(&|saved| saved.run.numbers.truncate(7)).starts_with("7 numbers, expected "));
        assert!(refused(&|saved| saved.run.modes.push(0)).starts_with("7 modes, expected 6"));
        for bad in [f64::NAN, f64::INFINITY] {
            assert!(refused(&|saved| saved.run.numbers[20] = bad).contains("which no run gets to"));
        }
        assert_eq!(refused(&|saved| saved.run.modes[2] = 7), "mass 3 is in the mode 7, which the scene does not have");
        // time, u, w, two paths of three numbers, then s.
        assert!(refused(&|saved| saved.run.numbers[9] = -1.0).contains("the carrier's last kink"));
    }

    #[test]
    fn a_mass_in_contact_stands_on_the_scenes_profile() {
        let scene = scene();
        let simulation = run(&scene);
        let mass = (0..6).find(|&i| simulation.run.state.mode[i].in_contact()).unwrap();
        let part: [fn(&mut Simulation, usize) -> &mut f64; 3] = [
            |simulation, i| &mut simulation.run.state.surface[i].height,
            |simulation, i| &mut simulation.run.state.surface[i].slope,
            |simulation, i| &mut simulation.run.state.elongation_x[i],
        ];
        for part in part {
            let mut changed = simulation.clone();
            *part(&mut changed, mass) += 1e-5;
            assert_eq!(Simulation::restore(&scene, &changed.save()).unwrap_err(), RestoreError::Surface { mass });
        }
    }
}
