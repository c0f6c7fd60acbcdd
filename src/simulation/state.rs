//! The state of a run, which is all that changes in it: saved, serialised, restored bit for bit.

use serde::{Deserialize, Serialize};

use super::controller::Controller;
use super::motion::{OutOfRange, Start};
use super::settings::Settings;
use crate::integrator::{LayerState, StageValues, TimeSpan};
use crate::math::not_finite;
use crate::model::{BodyStart, Carrier, CarrierPosition, Mode, Model, State, Tangents};
use crate::outputs::{Counters, Energies};
use crate::scene::{Axis, ByAxis, Method, ParameterError, Path, is_possible};

/// The first step to try, as a fraction of the stiffest period over 2π; the error test corrects it at once.
const FIRST_STEP: f64 = 0.1;
/// The fraction of the distances that a position is summed from by which it may be off: more than rounding adds up to
/// in any run.
const POSITION_ROUNDING: f64 = 1e-6;

/// All that changes in a simulation, but for the processor time and the records of mode changes and method switches.
///
/// Two simulations of one scene in the same state go on alike, bit for bit. It is as large as the layer's state and
/// rates, once more where the error is estimated; the workspace of the steps is no part of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SimulationState {
    pub(super) run: RunState,
    /// Of the reference run.
    pub(super) reference_run: Option<RunState>,
}

impl SimulationState {
    /// Copies `other`; of the same scene without allocating.
    pub fn copy_from(&mut self, other: &Self) {
        self.copy_runs(other.states());
    }

    /// Copies the states of a run and of its reference run, where there is one.
    pub(super) fn copy_runs<'a>(&mut self, mut states: impl Iterator<Item = &'a RunState>) {
        if let Some(run) = states.next() {
            self.run.copy_from(run);
        }
        match (&mut self.reference_run, states.next()) {
            (Some(mine), Some(theirs)) => mine.copy_from(theirs),
            (mine, theirs) => *mine = theirs.cloned(),
        }
    }

    /// Of the run, and of the reference run where there is one.
    pub(super) fn states(&self) -> impl Iterator<Item = &RunState> {
        std::iter::once(&self.run).chain(&self.reference_run)
    }
}

/// All that changes in a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct RunState {
    /// The smooth segment of motion that the carrier is on.
    pub carrier: Carrier,
    /// Time since the start of that segment, s.
    pub s: f64,
    /// The layer, with the rates at the start of the next step.
    pub layer: LayerState,
    /// Whether these rates are valid: not before the first motion, nor where the forces were changed from outside.
    pub rates_valid: bool,
    /// Energies since the start.
    pub energies: Energies,
    /// What the solver counts.
    pub counters: Counters,
    /// The lengths of the steps.
    pub controller: Controller,
    /// The derivatives with respect to the targets of the last motion; 0 before the first.
    pub tangents: Tangents,
    /// u and w at the start of the run, m.
    pub start: ByAxis<f64>,
    /// The layer's temperature, K; 0 where it is no input.
    pub temperature: f64,
    /// Whether time-stepping is active, or the event-driven method.
    pub time_stepping: bool,
    /// The running mean of the mode changes per time step; of the method *auto* alone.
    pub mode_changes_per_step: f64,
}

impl RunState {
    /// A run of `model` that starts at `start`, before the masses are placed.
    pub(super) fn new(model: &Model, settings: &Settings, start: &Start, bodies: &ByAxis<Option<BodyStart>>) -> Self {
        let path = |rate| Path { rate, ..Path::default() };
        let paths = ByAxis { x: path(start.u_rate), z: path(start.w_rate) };
        let mut carrier = Carrier::new(start.time, ByAxis { x: start.u, z: start.w }, paths, &model.profile);
        for axis in Axis::ALL {
            bodies[axis].iter().for_each(|body| carrier.start_body(axis, body, &model.profile));
        }
        Self {
            start: carrier.start,
            temperature: start.temperature.unwrap_or(0.0),
            carrier,
            s: 0.0,
            layer: LayerState::new(model),
            rates_valid: false,
            energies: Energies::default(),
            counters: Counters::default(),
            controller: Controller::new(FIRST_STEP / model.stiffest_frequency()),
            tangents: Tangents::default(),
            time_stepping: settings.method == Method::Step,
            mode_changes_per_step: 0.0,
        }
    }

    /// Copies `other`; of the same scene without allocating.
    pub(super) fn copy_from(&mut self, other: &Self) {
        let Self { carrier, s, layer, rates_valid, energies, counters, controller, .. } = other;
        let Self { tangents, start, temperature, time_stepping, mode_changes_per_step, .. } = other;
        self.layer.copy_from(layer);
        (self.carrier, self.s, self.rates_valid) = (*carrier, *s, *rates_valid);
        (self.energies, self.counters, self.controller) = (*energies, *counters, *controller);
        (self.tangents, self.start, self.temperature) = (*tangents, *start, *temperature);
        (self.time_stepping, self.mode_changes_per_step) = (*time_stepping, *mode_changes_per_step);
    }

    /// Copies `saved`, which was checked, into the state of a run of `model` by `method`.
    pub(super) fn restore(&mut self, saved: &Self, model: &Model, method: Method) {
        let time_stepping = self.time_stepping;
        self.copy_from(saved);
        self.carrier.find_profile_position(&model.profile);
        if method != Method::Auto {
            self.time_stepping = time_stepping;
        }
    }

    /// The time reached, s.
    pub(super) fn time(&self) -> f64 {
        self.carrier.time + self.s
    }

    /// u and w, m.
    pub(super) fn displacement(&self) -> ByAxis<f64> {
        self.displacement_at(self.s)
    }

    /// u and w `s` seconds after the start of the carrier's segment, m.
    pub(super) fn displacement_at(&self, s: f64) -> ByAxis<f64> {
        self.carrier.displacement(s)
    }

    /// A step of length `h` (s) from here.
    pub(super) fn span(&self, h: f64) -> TimeSpan {
        TimeSpan { start: self.s, length: h }
    }

    /// The fraction of a step of length `h` (s) from here at the time `s` after the start of the carrier's segment.
    pub(super) fn fraction_at(&self, s: f64, h: f64) -> f64 {
        (s - self.s) / h
    }

    /// The carrier's position over the profile.
    pub(super) fn carrier_position(&self) -> CarrierPosition {
        self.carrier.position(self.s)
    }

    /// Refuses bodies that have left the range of possible numbers.
    pub(super) fn check_bodies(&self) -> Result<(), OutOfRange> {
        if !self.carrier.has_bodies() {
            return Ok(());
        }
        let ByAxis { x: u, z: w } = self.displacement();
        let point = self.carrier.at(self.s);
        let numbers = [("u", u), ("w", w), ("rate of u", point.x.speed), ("rate of w", point.z.speed)];
        match numbers.into_iter().find(|(_, value)| !is_possible(*value)) {
            Some((what, value)) => Err(OutOfRange { what, value }),
            None => Ok(()),
        }
    }
}

/// Why a state cannot be restored.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SimulationRestoreError {
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
        /// The field that holds it.
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

impl RunState {
    /// Checks that this can be the state of a run of `model` that is in `present` now.
    pub(super) fn check(
        &self,
        present: &Self,
        model: &Model,
        settings: &Settings,
    ) -> Result<(), SimulationRestoreError> {
        for axis in Axis::ALL {
            let bodies = |state: &Self| usize::from(state.carrier.is_body(axis));
            check_length("bodies", bodies(self), bodies(present))?;
        }
        check_layer(&self.layer, &present.layer)?;
        check_numbers(self)?;
        check_modes(&self.layer.state.mode, model.friction.present)?;
        self.check_surface(model, settings.tolerance.position)
    }

    /// Checks that the profile under each mass in contact is the one of `model`, within the `tolerance` of positions
    /// (m) and roundings.
    ///
    /// It cannot be computed afresh to the last bit: its position was summed in another order.
    fn check_surface(&self, model: &Model, tolerance: f64) -> Result<(), SimulationRestoreError> {
        let (state, mut carrier) = (&self.layer.state, self.carrier);
        carrier.find_profile_position(&model.profile);
        let position = carrier.profile_position + carrier.at(self.s).x.position;
        let fits = |i: usize| {
            let x = model.rest_x[i] + (position + state.elongation_x[i]);
            let summed = x.abs() + state.elongation_x[i].abs() + carrier.start.x.abs();
            let reach = tolerance + POSITION_ROUNDING * summed;
            let (found, here) = (&state.surface[i], model.surface_at(x));
            let bounds = model.profile.local_bounds(x - reach, x + reach);
            near(found.height, here.height, bounds.slope_max_abs * reach)
                && near(found.slope, here.slope, bounds.curvature_max_abs * reach)
                && found.curvature.abs() <= (1.0 + POSITION_ROUNDING) * bounds.curvature_max_abs
        };
        let in_contact = |&i: &usize| state.mode[i].in_contact();
        match (0..model.masses()).filter(in_contact).find(|&i| !fits(i)) {
            Some(mass) => Err(SimulationRestoreError::Surface { mass }),
            None => Ok(()),
        }
    }
}

fn near(a: f64, b: f64, distance: f64) -> bool {
    (a - b).abs() <= distance + POSITION_ROUNDING * b.abs()
}

pub(super) fn check_length(what: &'static str, found: usize, expected: usize) -> Result<(), SimulationRestoreError> {
    if found == expected { Ok(()) } else { Err(SimulationRestoreError::Length { what, found, expected }) }
}

/// Checks that the arrays of `found` are as long as those `expected`.
fn check_layer(found: &LayerState, expected: &LayerState) -> Result<(), SimulationRestoreError> {
    check_length("modes", found.state.mode.len(), expected.state.mode.len())?;
    check_length("surface points", found.state.surface.len(), expected.state.surface.len())?;
    for ((what, found), (_, expected)) in arrays(found).into_iter().zip(arrays(expected)) {
        check_length(what, found.len(), expected.len())?;
    }
    Ok(())
}

/// The arrays of numbers of a layer and its rates.
fn arrays(layer: &LayerState) -> [(&'static str, &[f64]); 19] {
    let State { elongation_x, elongation_z, velocity_x, velocity_z, maxwell, flash, memory, mode: _, surface: _ } =
        &layer.state;
    let rates = &layer.rates;
    let StageValues { velocity_x: rate_x, velocity_z: rate_z, acceleration_x, acceleration_z, .. } = rates;
    let StageValues { elongation_rate, normal, heat_flux, memory_rate, margin, .. } = rates;
    let [vertical, horizontal, lateral_x, lateral_z] = &elongation_rate.0;
    [
        ("elongations along x", elongation_x),
        ("elongations along z", elongation_z),
        ("velocities along x", velocity_x),
        ("velocities along z", velocity_z),
        ("Maxwell elongations", maxwell),
        ("flash temperatures", flash),
        ("remembered speeds", memory),
        ("rates of positions along x", rate_x),
        ("rates of positions along z", rate_z),
        ("accelerations along x", acceleration_x),
        ("accelerations along z", acceleration_z),
        ("elongation rates of vertical links", vertical),
        ("elongation rates of horizontal links", horizontal),
        ("elongation rates of lateral links along x", lateral_x),
        ("elongation rates of lateral links along z", lateral_z),
        ("normal forces", normal),
        ("heat fluxes", heat_flux),
        ("rates of remembered speeds", memory_rate),
        ("margins", margin),
    ]
}

/// Checks that all numbers are finite and that those are positive that have to be.
fn check_numbers(run: &RunState) -> Result<(), SimulationRestoreError> {
    let step_size = run.controller.step_size;
    let negative = (run.s < 0.0).then_some(("s", run.s));
    let step_size = (step_size <= 0.0).then_some(("step_size", step_size));
    match not_finite(run).or(negative).or(step_size) {
        Some((what, value)) => Err(SimulationRestoreError::Number { what, value }),
        None => Ok(()),
    }
}

fn check_modes(modes: &[Mode], has_friction: bool) -> Result<(), SimulationRestoreError> {
    match modes.iter().position(|&mode| mode == Mode::Stick && !has_friction) {
        Some(mass) => Err(SimulationRestoreError::Mode { mass, number: Mode::Stick.number() }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{
        WAVE, scene, scene_with_heat, scene_with_rate_shear, scene_with_real_area, variables_of,
    };
    use super::*;
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
        for scene in [scene(), scene_with_rate_shear(), scene_with_real_area(), scene_with_heat()] {
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
            assert!(refused(&|run| run.layer.state.velocity_x[3] = bad).starts_with("invalid state: velocity_x = "));
            assert!(refused(&|run| run.layer.rates.margin[0] = bad).starts_with("invalid state: margin = "));
            assert!(refused(&|run| run.energies.impact = bad).starts_with("invalid state: impact = "));
            assert!(refused(&|run| run.carrier.time = bad).starts_with("invalid state: time = "));
            assert!(refused(&|run| run.controller.event_spacing = bad).starts_with("invalid state: event_spacing = "));
        }
        assert!(refused(&|run| run.s = -1.0).contains("s = -1"));
        assert!(refused(&|run| run.controller.step_size = 0.0).contains("step_size = 0"));
        let mut frictionless = scene.clone();
        frictionless.friction = None;
        let error = Simulation::restore(&frictionless, &stuck(&state)).unwrap_err();
        assert_eq!(error.to_string(), "mass 3 is in the mode 2, which the scene does not have");
    }

    /// The same with mass 3 sticking, and no other.
    fn stuck(state: &SimulationState) -> SimulationState {
        let mut state = state.clone();
        for run in [Some(&mut state.run), state.reference_run.as_mut()].into_iter().flatten() {
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
        state.reference_run.as_mut().unwrap().s = -1.0;
        state.run.start = ByAxis { x: 1.0, z: 1.0 };
        assert!(simulation.set_state(&state).is_err());
        assert_eq!(simulation.state(), before);
    }

    #[test]
    fn a_mass_in_contact_stands_on_the_scenes_profile() {
        let scene = scene();
        let simulation = run(&scene);
        let mass = (0..6).find(|&i| simulation.run.context.state.layer.state.mode[i].in_contact()).unwrap();
        let part: [fn(&mut Simulation, usize) -> &mut f64; 3] = [
            |simulation, i| &mut simulation.run.context.state.layer.state.surface[i].height,
            |simulation, i| &mut simulation.run.context.state.layer.state.surface[i].slope,
            |simulation, i| &mut simulation.run.context.state.layer.state.elongation_x[i],
        ];
        for part in part {
            let mut changed = simulation.clone();
            *part(&mut changed, mass) += 1e-5;
            assert_eq!(
                Simulation::restore(&scene, &changed.state()).unwrap_err(),
                SimulationRestoreError::Surface { mass }
            );
        }
    }
}
