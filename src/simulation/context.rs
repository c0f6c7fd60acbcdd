//! What the steps of a run work on.

use std::sync::Arc;

use super::controller::LengthBounds;
use super::motion::{ModeChange, Motion, SimulationError, Start};
use super::settings::Settings;
use super::state::RunState;
use crate::contact::{EventTolerance, decide_modes, free_unloaded, impacts_due, place_layer, stop_reversed};
use crate::integrator::{DenseOutput, DenseWorkspace, Integrator, InterpolatedLayer, LayerStep, Overlay};
use crate::model::{
    BodyStart, CarrierPoint, ChannelEnergies, Forces, LinkKind, Mode, Model, State, elastic_energy, kinetic_energy,
};
use crate::scene::{Axis, ByAxis};

/// The longest step, as a fraction of the period of the carrier's sine: a longer one could alias the excitation, all
/// stages seeing the same and the error estimate nothing.
const OF_PERIOD: f64 = 0.25;

/// What the steps of a run work on, of the whole layer or of a local region: the model, the settings, the state, and
/// the workspace that both methods share. Everything but `state` can be made anew from the model and the settings.
#[derive(Clone, Debug)]
pub(super) struct RunContext {
    pub model: Arc<Model>,
    pub settings: Settings,
    pub state: RunState,
    pub integrator: Integrator,
    /// Forces in the state evaluated last.
    pub forces: Forces,
    /// The state within the step tried last.
    pub interpolated: State,
    /// At which step length and fraction that is; `None` where it is not of the step tried last.
    pub interpolated_at: Option<(f64, f64)>,
    pub dense: DenseWorkspace,
    /// The modes before the mode changes under way.
    pub modes_before: Vec<Mode>,
    /// The record of mode changes, where one is kept.
    pub mode_changes: Option<Vec<ModeChange>>,
}

impl RunContext {
    /// The context of a run with the layer placed under the carrier at `start`; on the heap, since threads of hosts may have
    /// small stacks.
    pub(super) fn new(
        model: Arc<Model>,
        settings: Settings,
        start: &Start,
        bodies: &ByAxis<Option<BodyStart>>,
    ) -> Box<Self> {
        let state = RunState::new(&model, &settings, start, bodies);
        let mut context = Box::new(Self {
            integrator: settings.integrator(&model),
            forces: Forces::new(&model),
            interpolated: State::new(&model),
            interpolated_at: None,
            dense: DenseWorkspace::new(&model),
            modes_before: state.layer.state.mode.clone(),
            mode_changes: None,
            model,
            settings,
            state,
        });
        context.place_layer();
        context
    }

    /// Puts the masses at their rest positions, or on the profile, and decides the first modes.
    fn place_layer(&mut self) {
        let at = self.state.carrier_position();
        let carrier = self.state.carrier.at(0.0);
        let (model, layer, forces) = (&*self.model, &mut self.state.layer.state, &mut self.forces);
        place_layer(model, layer, at, &carrier);
        forces.evaluate(model, layer, &carrier);
        free_unloaded(model, layer, at, forces);
        decide_modes(model, layer, forces);
        let of_layer = kinetic_energy(model, layer) + elastic_energy(model, layer);
        self.state.energies.initial = of_layer + self.state.carrier.energy(model, 0.0).total();
    }

    /// Takes over another temperature (K) and the settings for the model there, which is set. The dampers' forces jump,
    /// so the next motion decides all modes anew.
    pub(super) fn set_temperature(&mut self, temperature: f64, settings: Settings) {
        self.settings = settings;
        (self.state.temperature, self.state.rates_valid) = (temperature, false);
        self.integrator = self.settings.integrator(&self.model);
        self.dense = DenseWorkspace::new(&self.model);
    }

    /// Begins a smooth motion. At a kink the damper forces jump, so all modes are decided
    /// anew.
    pub(super) fn begin(&mut self, motion: &Motion) {
        let state = &mut self.state;
        let before = state.carrier.at(state.s).rates();
        let jumps = state.carrier.begin(state.s, motion, &self.model);
        state.s = 0.0;
        self.integrator.begin_tangents(motion.duration);
        if !state.rates_valid || state.carrier.at(0.0).rates() != before {
            self.change_modes(0.0);
            return;
        }
        if jumps {
            self.accelerate_bodies();
        }
        if self.integrator.has_tangents() {
            self.evaluate_forces();
            self.refresh_tangents();
        }
    }

    /// Computes the bodies' accelerations anew from the forces, of which one from outside has jumped. No force on a
    /// mass has.
    fn accelerate_bodies(&mut self) {
        self.evaluate_forces();
        self.state.carrier.accelerate(&self.model, self.state.s, &self.forces);
    }

    /// Lets the bodies follow the step of length `h` (s) tried last.
    pub(super) fn trace_bodies(&mut self, h: f64) {
        let Self { state, integrator, .. } = self;
        for axis in Axis::ALL {
            if state.carrier.is_body(axis) {
                state.carrier.set_interpolant(axis, integrator.body_interpolant(axis, h));
            }
        }
    }

    /// The impacts due, stops, then every contact decided anew from the forces, which have jumped; and the rates after
    /// that. Masses within `reach` (m) of the profile count as touching.
    pub(super) fn change_modes(&mut self, reach: f64) {
        let carrier = self.state.carrier.at(self.state.s);
        let at = self.state.carrier_position();
        let Self { model, state: run, forces, modes_before, .. } = self;
        let layer = &mut run.layer.state;
        modes_before.copy_from_slice(&layer.mode);
        run.energies.impact += impacts_due(model, layer, at, reach, &mut run.energies.channels);
        stop_reversed(model, layer, forces, &mut run.energies.channels);
        forces.evaluate(model, layer, &carrier);
        decide_modes(model, layer, forces);
        run.carrier.accelerate(model, run.s, forces);
        self.start_from_forces();
        self.state.rates_valid = true;
        self.refresh_tangents();
        self.record_mode_changes();
    }

    /// Counts and records what has changed since the modes before.
    pub(super) fn record_mode_changes(&mut self) {
        let time = self.state.time();
        let modes = self.modes_before.iter().zip(&self.state.layer.state.mode).enumerate();
        for (mass, (from, to)) in modes.filter(|(_, (from, to))| from != to) {
            self.state.counters.events += 1;
            if let Some(record) = &mut self.mode_changes {
                record.push(ModeChange { time, mass, from: from.number(), to: to.number() });
            }
        }
    }

    /// Computes the rates at the start of the next step from the state alone.
    pub(super) fn evaluate_start(&mut self) {
        self.evaluate_forces();
        self.start_from_forces();
    }

    /// Computes the rates at the start of the next step from the forces evaluated last.
    fn start_from_forces(&mut self) {
        let Self { model, state, integrator, forces, .. } = self;
        let carrier = (&state.carrier, state.s);
        integrator.evaluate_start(model, &mut state.layer, carrier, forces, state.controller.step_size);
    }

    /// Evaluates the link forces in the current state and returns the carrier there.
    pub(super) fn evaluate_forces(&mut self) -> CarrierPoint {
        let carrier = self.state.carrier.at(self.state.s);
        self.forces.evaluate(&self.model, &self.state.layer.state, &carrier);
        carrier
    }

    /// Ḟ_x and Ḟ_z, N/s, from the left; at the start, from the right.
    pub(super) fn force_rates(&mut self) -> ByAxis<f64> {
        if !self.state.rates_valid {
            self.accelerate_bodies();
            self.start_from_forces();
        }
        let (layer, carrier) = (&self.state.layer, self.state.carrier.at(self.state.s));
        layer.rates.on_carrier(&self.model, &layer.state, &carrier)
    }

    /// Energies through the channels up to the fraction `theta` of the step of length `h` (s) tried last, J.
    pub(super) fn channel_energies_within(&mut self, h: f64, theta: f64) -> ChannelEnergies {
        let Self { model, state, integrator, .. } = self;
        integrator.energies((&**model, &state.carrier, &state.layer.state), state.span(h), theta)
    }

    /// F_x and F_z at the fraction `theta` of the step of length `h` (s) tried last, N.
    pub(super) fn on_carrier_within(&mut self, h: f64, theta: f64) -> ByAxis<f64> {
        let Self { model, state, integrator, dense, .. } = self;
        integrator.on_carrier((&**model, &state.carrier, &state.layer.state), state.span(h), theta, dense)
    }

    /// P_diss at the fraction `theta` of the step of length `h` (s) tried last, by the powers at its stages, W.
    pub(super) fn dissipated_power_within(&mut self, h: f64, theta: f64) -> f64 {
        let Self { model, state, integrator, .. } = self;
        integrator.dissipated_power((&**model, &state.carrier, &state.layer.state), state.span(h), theta)
    }

    /// Finds the tangents of the motion that ends here.
    pub(super) fn find_tangents(&mut self) {
        if self.integrator.has_tangents() {
            self.state.tangents = self.integrator.tangents(&self.model, self.state.s);
        }
    }

    /// The tangents' rates from the forces evaluated last.
    fn refresh_tangents(&mut self) {
        let carrier = (&self.state.carrier, self.state.s);
        self.integrator.refresh_tangents(&self.model, &self.state.layer, carrier, Some(&self.forces));
    }

    /// Includes the energies in the largest so far, by which errors are measured.
    pub(super) fn record_largest_energy(&mut self) {
        let largest = &mut self.state.layer.largest;
        largest.energy = largest.energy.max(self.state.energies.largest());
    }

    pub(super) fn event_tolerance(&self) -> EventTolerance {
        let Settings { tolerance, events, .. } = &self.settings;
        events.within(self.state.layer.largest.allowed_of_mass(&self.model, tolerance))
    }

    /// Whether a step shorter than a good one needs no error test. Where friction falls with the speed the stages may
    /// have several solutions, and the two need not find the same.
    pub(super) fn shorter_is_no_worse(&self) -> bool {
        !self.model.friction.depends_on_speed()
    }

    /// The bounds of the next step of a motion of `duration`, s.
    pub(super) fn length_bounds(&self, duration: f64) -> Result<LengthBounds, SimulationError> {
        let RunState { s, carrier, .. } = &self.state;
        let (shortest, remaining) = (4.0 * f64::EPSILON * (s + 1e-3 * duration), duration - s);
        let longest = OF_PERIOD * carrier.shortest_period();
        if longest <= shortest {
            return Err(self.step_too_small(longest));
        }
        Ok(LengthBounds { shortest, longest, remaining })
    }

    pub(super) fn step_too_small(&self, step: f64) -> SimulationError {
        let time = self.state.time();
        match self.model.folded(&self.state.layer.state) {
            Some(mass) => SimulationError::Folded { time, mass: mass + 1 },
            None => SimulationError::StepTooSmall { time, step },
        }
    }

    /// The dense output of the event-driven step of length `h` (s) tried last.
    pub(super) fn dense_output(&self, h: f64) -> DenseOutput<'_> {
        let state = &self.state;
        self.integrator.dense(&self.model, &state.carrier, &state.layer.state, state.span(h))
    }

    /// The layer at the fraction `theta` of the step of length `h` (s) tried last, with some masses replaced, and the
    /// run at the step's start.
    pub(super) fn within<'a>(
        &'a mut self,
        (h, theta): (f64, f64),
        overlay: Option<&'a mut dyn Overlay>,
    ) -> (InterpolatedLayer<'a>, &'a RunState) {
        let dense =
            self.integrator.dense(&self.model, &self.state.carrier, &self.state.layer.state, self.state.span(h));
        let within = InterpolatedLayer {
            step: LayerStep { dense, workspace: &mut self.dense },
            theta,
            state: &mut self.interpolated,
            state_at: &mut self.interpolated_at,
            forces: &mut self.forces,
            overlay,
        };
        (within, &self.state)
    }

    /// See [`Simulation::relax_dashpots`](super::Simulation::relax_dashpots).
    pub(super) fn relax_dashpots(&mut self, means: &[f64], time: f64) -> f64 {
        let mut borne = 0.0;
        for row in self.model.rows.iter().filter(|row| !row.kind.is_along_x()) {
            let x = time / row.relaxation_time;
            let left = if x > 0.0 { x / x.exp_m1() } else { 1.0 };
            let elements = &mut self.state.layer.state.maxwell[row.range.clone()];
            for (a, mean) in elements.iter_mut().zip(&means[row.range.clone()]) {
                *a -= left * mean;
            }
            if row.kind == LinkKind::Vertical {
                borne += row.stiffness * means[row.range.clone()].iter().sum::<f64>();
            }
        }
        // The forces have jumped: the next motion decides all contacts anew.
        self.state.rates_valid = false;
        borne
    }

    /// See [`Simulation::lower_carrier`](super::Simulation::lower_carrier).
    pub(super) fn lower_carrier(&mut self, way: f64) {
        self.state.carrier.start.z -= way;
        let elongations = &mut self.state.layer.state.elongation_z;
        elongations.iter_mut().for_each(|elongation| *elongation += way);
        self.state.rates_valid = false;
    }
}
