//! The state of a simulation: saved, serialised, restored bit for bit.

use serde::{Deserialize, Serialize};

use super::run::{Run, RunState};
use crate::integrator::{LayerState, Rates};
use crate::model::{Carrier, LinkKind, Mode, State};
use crate::scene::{Axis, Method, ParameterError};

/// All that changes in a simulation, but for the processor time and the records of mode changes and method switches.
///
/// Two simulations of one scene in the same state go on alike, bit for bit. It is as large as the layer's state and
/// rates, once more where the error is estimated; the workspace of the steps is no part of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SimulationState {
    pub(super) run: RunState,
    /// The error-estimation run.
    pub(super) error_run: Option<RunState>,
}

/// Why a state cannot be restored.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RestoreError {
    /// The scene cannot run at all.
    #[error(transparent)]
    Scene(#[from] ParameterError),
    /// It is the state of another scene.
    #[error("{found} {what}, expected {expected}")]
    Length {
        /// Of what.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many the scene has.
        expected: usize,
    },
    /// A number that no run can have.
    #[error("invalid state: {what} = {value}")]
    Number {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A mode that no mass of the scene can have.
    #[error("mass {} is in the mode {number}, which the scene does not have", mass + 1)]
    Mode {
        /// Which mass, from 0.
        mass: usize,
        /// The mode's number.
        number: i8,
    },
    /// The profile under a mass differs from the scene's.
    #[error("mass {} is in contact with a profile that is not the scene's", mass + 1)]
    Surface {
        /// Which mass, from 0.
        mass: usize,
    },
}

impl Run {
    /// Copies `state`, which was checked.
    pub(super) fn set_state(&mut self, state: &RunState) {
        let time_stepping = self.state.time_stepping;
        self.state.copy_from(state);
        self.state.carrier.find_profile_position(&self.model.profile);
        if self.settings.method != Method::Auto {
            self.state.time_stepping = time_stepping;
        }
    }

    /// Checks that `state` can be that of this run.
    pub(super) fn check_state(&self, state: &RunState) -> Result<(), RestoreError> {
        for axis in Axis::ALL {
            let bodies = |carrier: &Carrier| usize::from(carrier.is_body(axis));
            check_length("bodies", bodies(&state.carrier), bodies(&self.state.carrier))?;
        }
        check_lengths(&state.layer, &self.state.layer)?;
        check_numbers(state)?;
        check_modes(&state.layer.state.mode, self.model.friction.present)?;
        self.check_surface(state)
    }

    /// Checks that the profile under each mass in contact is the scene's, within the tolerance of positions and
    /// roundings.
    ///
    /// It cannot be computed afresh to the last bit: its position was summed in another order.
    fn check_surface(&self, run: &RunState) -> Result<(), RestoreError> {
        let (state, model, mut carrier) = (&run.layer.state, &*self.model, run.carrier);
        carrier.find_profile_position(&model.profile);
        let position = carrier.profile_position + carrier.at(run.s).x.position;
        let fits = |i: usize| {
            let x = model.rest_x[i] + (position + state.elongation_x[i]);
            let summed = x.abs() + state.elongation_x[i].abs() + carrier.start.x.abs();
            let reach = self.settings.tolerance.position + POSITION_ROUNDING * summed;
            let (found, here) = (&state.surface[i], model.surface_at(x));
            let bounds = model.profile.local_bounds(x - reach, x + reach);
            near(found.height, here.height, bounds.slope_max_abs * reach)
                && near(found.slope, here.slope, bounds.curvature_max_abs * reach)
                && found.curvature.abs() <= (1.0 + POSITION_ROUNDING) * bounds.curvature_max_abs
        };
        let in_contact = |&i: &usize| state.mode[i].in_contact();
        match (0..model.masses()).filter(in_contact).find(|&i| !fits(i)) {
            Some(mass) => Err(RestoreError::Surface { mass }),
            None => Ok(()),
        }
    }
}

/// Share of the distances that a position is summed from by which it may be off: more than rounding adds up to in any
/// run.
const POSITION_ROUNDING: f64 = 1e-6;

fn near(a: f64, b: f64, distance: f64) -> bool {
    (a - b).abs() <= distance + POSITION_ROUNDING * b.abs()
}

pub(super) fn check_length(what: &'static str, found: usize, expected: usize) -> Result<(), RestoreError> {
    if found == expected { Ok(()) } else { Err(RestoreError::Length { what, found, expected }) }
}

fn check_lengths(found: &LayerState, expected: &LayerState) -> Result<(), RestoreError> {
    let (state, rates) = (lengths_of_state(&found.state), lengths_of_rates(&found.rates));
    let (expected_state, expected_rates) = (lengths_of_state(&expected.state), lengths_of_rates(&expected.rates));
    for ((what, found), (_, expected)) in state.into_iter().zip(expected_state) {
        check_length(what, found, expected)?;
    }
    for ((what, found), (_, expected)) in rates.into_iter().zip(expected_rates) {
        check_length(what, found, expected)?;
    }
    Ok(())
}

fn lengths_of_state(state: &State) -> [(&'static str, usize); 7] {
    let State { elongation_x, elongation_z, velocity_x, velocity_z, maxwell, mode, surface } = state;
    [
        ("modes", mode.len()),
        ("elongations along x", elongation_x.len()),
        ("elongations along z", elongation_z.len()),
        ("velocities along x", velocity_x.len()),
        ("velocities along z", velocity_z.len()),
        ("Maxwell elongations", maxwell.len()),
        ("surface points", surface.len()),
    ]
}

fn lengths_of_rates(rates: &Rates) -> [(&'static str, usize); 10] {
    let Rates { velocity_x, velocity_z, acceleration_x, acceleration_z, elongation_rate, normal, margin } = rates;
    let [vertical, horizontal, lateral_x, lateral_z] = &elongation_rate.0;
    [
        ("velocities along x", velocity_x.len()),
        ("velocities along z", velocity_z.len()),
        ("accelerations along x", acceleration_x.len()),
        ("accelerations along z", acceleration_z.len()),
        ("elongation rates of vertical links", vertical.len()),
        ("elongation rates of horizontal links", horizontal.len()),
        ("elongation rates of lateral links along x", lateral_x.len()),
        ("elongation rates of lateral links along z", lateral_z.len()),
        ("normal forces", normal.len()),
        ("margins", margin.len()),
    ]
}

/// Checks that all numbers are finite and that those are positive that have to be.
fn check_numbers(run: &RunState) -> Result<(), RestoreError> {
    let RunState {
        carrier,
        s,
        layer: LayerState { state, rates, exchange, largest },
        rates_valid: _,
        energies,
        counters,
        step_size,
        event_spacing,
        since_event,
        step_after_event,
        tangents,
        start,
        temperature,
        time_stepping: _,
        mode_changes_per_step,
    } = run;
    check_finite("the carrier's motion", &carrier.numbers().collect::<Vec<_>>())?;
    check_finite("the energies", &energies.numbers())?;
    check_finite("the largest error or force", &counters.numbers())?;
    if !tangents.are_finite() {
        return Err(RestoreError::Number { what: "the tangents", value: f64::NAN });
    }
    check_finite("the carrier's displacement at the start", &[start.x, start.z])?;
    check_finite("the temperature", &[*temperature])?;
    check_finite("the powers", &[exchange.friction, exchange.shear, exchange.input, exchange.carrier])?;
    check_finite("the largest forces and energies", &[largest.force_x, largest.force_z, largest.energy])?;
    let scalars = [
        ("the time since the carrier's last kink", *s),
        ("the step size", *step_size),
        ("the time between events", *event_spacing),
        ("the time since the last event", *since_event),
        ("the step after the last event", *step_after_event),
        ("the mode changes per time step", *mode_changes_per_step),
    ];
    for (what, value) in scalars {
        check_finite(what, &[value])?;
    }
    check_layer(state, rates)?;
    match (*s, *step_size) {
        (s, _) if s < 0.0 => Err(RestoreError::Number { what: "the time since the carrier's last kink", value: s }),
        (_, step) if step <= 0.0 => Err(RestoreError::Number { what: "the step size", value: step }),
        _ => Ok(()),
    }
}

fn check_layer(state: &State, rates: &Rates) -> Result<(), RestoreError> {
    let State { elongation_x, elongation_z, velocity_x, velocity_z, maxwell, mode: _, surface } = state;
    check_finite("an elongation", elongation_x)?;
    check_finite("an elongation", elongation_z)?;
    check_finite("a velocity", velocity_x)?;
    check_finite("a velocity", velocity_z)?;
    check_finite("a Maxwell elongation", maxwell)?;
    for point in surface {
        check_finite("a surface point", &[point.height, point.slope, point.curvature, point.third])?;
    }
    let Rates { velocity_x, velocity_z, acceleration_x, acceleration_z, elongation_rate, normal, margin } = rates;
    for values in [velocity_x, velocity_z, acceleration_x, acceleration_z, normal, margin] {
        check_finite("a rate", values)?;
    }
    LinkKind::ALL.into_iter().try_for_each(|kind| check_finite("a rate", &elongation_rate[kind]))
}

fn check_finite(what: &'static str, values: &[f64]) -> Result<(), RestoreError> {
    match values.iter().find(|value| !value.is_finite()) {
        Some(&value) => Err(RestoreError::Number { what, value }),
        None => Ok(()),
    }
}

fn check_modes(modes: &[Mode], has_friction: bool) -> Result<(), RestoreError> {
    match modes.iter().position(|&mode| mode == Mode::Stick && !has_friction) {
        Some(mass) => Err(RestoreError::Mode { mass, number: Mode::Stick.number() }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{WAVE, scene, scene_with_rate_shear, scene_with_real_area, variables_of};
    use super::*;
    use crate::scene::ByAxis;
    use crate::scene::Path;
    use crate::scene::Scene;
    use crate::simulation::{Motion, Simulation, Start};

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
        for scene in [scene(), scene_with_rate_shear(), scene_with_real_area()] {
            let mut first = run(&scene);
            let bytes = postcard::to_stdvec(&first.state()).unwrap();
            let mut second = Simulation::restore(&scene, &postcard::from_bytes(&bytes).unwrap()).unwrap();
            assert_eq!(bits(&scene, &mut second), bits(&scene, &mut first));
            assert_eq!(second.force_rates(), first.force_rates());
            for _ in 0..20 {
                let motion = Motion { duration: 3.7e-6, ..WAVE };
                assert_eq!((first.advance(&motion), second.advance(&motion)), (Ok(()), Ok(())));
                assert_eq!(bits(&scene, &mut second), bits(&scene, &mut first));
            }
            assert_eq!(first.state(), second.state());
        }
    }

    #[test]
    fn a_run_not_yet_under_way_is_restored_too() {
        let scene = scene();
        let mut first = Simulation::new(&scene, &Start { u: 3.0, w: -1e-6, w_rate: -0.1, ..Start::default() }).unwrap();
        let mut second = Simulation::restore(&scene, &first.state()).unwrap();
        assert_eq!((first.advance(&WAVE), second.advance(&WAVE)), (Ok(()), Ok(())));
        assert_eq!(bits(&scene, &mut second), bits(&scene, &mut first));
    }

    /// What is saved is of the run alone, not of the workspace that it had: the profile under masses that have lifted is
    /// not.
    #[test]
    fn runs_alike_are_saved_alike() {
        let scene = scene();
        let mut first = run(&scene);
        let lift = Motion {
            duration: 3e-5,
            u: Path::default(),
            w: Path { rate: 0.2, ..Path::default() },
            ..Motion::default()
        };
        for _ in 0..20 {
            let mut second = Simulation::restore(&scene, &first.state()).unwrap();
            assert_eq!((first.advance(&lift), second.advance(&lift)), (Ok(()), Ok(())));
            assert_eq!(first.state(), second.state());
        }
        assert!(first.run.state.layer.state.mode.iter().all(|&mode| mode == Mode::Free));
    }

    #[test]
    fn an_invalid_state_is_refused() {
        let scene = scene();
        let state = run(&scene).state();
        let refused = |change: &dyn Fn(&mut RunState)| {
            let mut state = state.clone();
            change(&mut state.run);
            Simulation::restore(&scene, &state).unwrap_err().to_string()
        };
        assert_eq!(refused(&|run| run.layer.state.mode.push(Mode::Free)), "7 modes, expected 6");
        assert_eq!(refused(&|run| run.layer.rates.normal.truncate(2)), "2 normal forces, expected 6");
        for bad in [f64::NAN, f64::INFINITY] {
            assert!(refused(&|run| run.layer.state.velocity_x[3] = bad).starts_with("invalid state: a velocity = "));
            assert!(refused(&|run| run.layer.rates.margin[0] = bad).starts_with("invalid state: a rate = "));
            assert!(refused(&|run| run.energies.impact = bad).starts_with("invalid state: the energies = "));
            assert!(refused(&|run| run.carrier.time = bad).starts_with("invalid state: the carrier's motion = "));
            assert!(refused(&|run| run.event_spacing = bad).starts_with("invalid state: the time between events = "));
        }
        assert!(refused(&|run| run.s = -1.0).contains("the carrier's last kink = -1"));
        assert!(refused(&|run| run.step_size = 0.0).contains("the step size = 0"));
        let mut frictionless = scene.clone();
        frictionless.friction = None;
        let error = Simulation::restore(&frictionless, &stuck(&state)).unwrap_err();
        assert_eq!(error.to_string(), "mass 3 is in the mode 2, which the scene does not have");
    }

    /// The same with mass 3 sticking, and no other.
    fn stuck(state: &SimulationState) -> SimulationState {
        let mut state = state.clone();
        for run in [Some(&mut state.run), state.error_run.as_mut()].into_iter().flatten() {
            let modes = &mut run.layer.state.mode;
            modes.iter_mut().filter(|mode| **mode == Mode::Stick).for_each(|mode| *mode = Mode::Forward);
            modes[2] = Mode::Stick;
        }
        state
    }

    /// What fails leaves the simulation as it was.
    #[test]
    fn a_refused_state_changes_nothing() {
        let scene = scene();
        let mut simulation = run(&scene);
        let before = simulation.state();
        let mut state = before.clone();
        state.error_run.as_mut().unwrap().s = -1.0;
        state.run.start = ByAxis { x: 1.0, z: 1.0 };
        assert!(simulation.set_state(&state).is_err());
        assert_eq!(simulation.state(), before);
    }

    #[test]
    fn a_mass_in_contact_stands_on_the_scenes_profile() {
        let scene = scene();
        let simulation = run(&scene);
        let mass = (0..6).find(|&i| simulation.run.state.layer.state.mode[i].in_contact()).unwrap();
        let part: [fn(&mut Simulation, usize) -> &mut f64; 3] = [
            |simulation, i| &mut simulation.run.state.layer.state.surface[i].height,
            |simulation, i| &mut simulation.run.state.layer.state.surface[i].slope,
            |simulation, i| &mut simulation.run.state.layer.state.elongation_x[i],
        ];
        for part in part {
            let mut changed = simulation.clone();
            *part(&mut changed, mass) += 1e-5;
            assert_eq!(Simulation::restore(&scene, &changed.state()).unwrap_err(), RestoreError::Surface { mass });
        }
    }
}
