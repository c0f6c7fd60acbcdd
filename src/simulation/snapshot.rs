//! The run at an instant: as it stands, or within the step tried last.

use super::driver::TrialStep;
use super::run::{Run, RunState};
use crate::integrator::{LayerWithin, Overlay};
use crate::math::bracketed_root;
use crate::outputs::{Energies, LayerView, Snapshot};

/// The largest residual of the equations of motion that the dense output may have where a step is cut at an event, as a
/// velocity gained over the step, against the tolerance.
///
/// Recommended 1 to 5: the residual oscillates about 0 through the step, so less of it is left in the velocity; with 5
/// the errors of whole runs are those of 1, and fewer steps are repeated.
pub(super) const MAX_DEFECT: f64 = 5.0;
/// The most that mode changes not yet corrected may change F_z where a row is shown within a time step, as a multiple of
/// the relative tolerance. That bounds all of them together at the step's end; a row shows what touches change, so its error
/// is a small part of that.
const MAX_UNCORRECTED: f64 = 3.0;
/// The relative tolerance from which on P_diss within an event-driven step comes from the powers at its stages, of order 3 at
/// most, and not from the layer's state there.
///
/// Recommended 1e-4: down to it P_diss is as accurate by both in the median, and below ten tolerances nearly everywhere.
const POWERS_OF_STAGES_FROM: f64 = 1e-4;

impl Run {
    /// The run as it stands; `run_time` is the processor time since the start, s.
    pub(super) fn snapshot(&mut self, run_time: f64) -> Snapshot<'_> {
        let carrier = self.evaluate_forces();
        let (state, forces) = (&self.state, &self.workspace.forces);
        Snapshot {
            model: &self.model,
            time: state.time(),
            on_carrier: (forces.on_carrier_x(), forces.on_carrier_z()),
            dissipated_power: None,
            layer: LayerView::at(&state.layer.state, forces),
            carrier,
            motion: (&state.carrier, state.s),
            displacement: state.displacement(),
            start: state.start,
            energies: state.energies,
            tangents: state.tangents,
            counters: state.counters,
            run_time,
        }
    }

    /// The run at the fraction `theta` of the step of length `h` tried last.
    pub(super) fn snapshot_within(&mut self, h: f64, theta: f64, run_time: f64) -> Snapshot<'_> {
        let (energies, dissipated_power) = (self.energies_within(h, theta), self.dissipated_power_within(h, theta));
        let on_carrier = self.on_carrier_within(h, theta);
        let s = self.state.s + theta * h;
        let (within, state) = self.within(h, theta);
        Snapshot {
            model: within.model,
            time: state.carrier.time + s,
            on_carrier,
            dissipated_power,
            layer: LayerView::within(within),
            carrier: state.carrier.at(s),
            motion: (&state.carrier, s),
            displacement: state.displacement_at(s),
            start: state.start,
            energies,
            tangents: state.tangents,
            counters: state.counters,
            run_time,
        }
    }

    /// The layer at the fraction `theta` of the step of length `h` tried last, and the run at the step's start.
    fn within(&mut self, h: f64, theta: f64) -> (LayerWithin<'_>, &RunState) {
        let Self { model, state, workspace, .. } = self;
        let within = LayerWithin {
            model,
            carrier: &state.carrier,
            start: &state.layer.state,
            span: state.span(h),
            time_step: state.time_stepping,
            theta,
            integrator: &workspace.integrator,
            workspace: &mut workspace.dense,
            state: &mut workspace.interpolated,
            state_at: &mut workspace.interpolated_at,
            forces: &mut workspace.forces,
            overlay: workspace.windows.as_deref_mut().map(|windows| windows as &mut dyn Overlay),
        };
        (within, state)
    }

    /// Energies since the start at the fraction `theta` of the step of length `h` tried last.
    pub(super) fn energies_within(&mut self, h: f64, theta: f64) -> Energies {
        let mut energies = self.state.energies;
        if self.settings.accounts.energy {
            let Self { model, state, workspace, .. } = self;
            let (integrator, start) = (&mut workspace.integrator, &state.layer.state);
            let gain = if state.time_stepping {
                integrator.two_stage_energies(model, start, h, theta)
            } else {
                integrator.energies(model, start, h, theta)
            };
            energies.channels.add(&gain);
        }
        energies.gain(&self.energies_of_windows(self.state.s + theta * h));
        energies
    }

    /// The share of the step after which F_z is the force `until`, N; `None` where `step` ends below.
    pub(super) fn reaches_within(&mut self, step: &TrialStep, until: Option<f64>) -> Option<f64> {
        let TrialStep { h, share } = *step;
        let force = until.filter(|&force| self.force_z_within(h, share) >= force)?;
        Some(bracketed_root(|theta| self.force_z_within(h, theta) - force, (0.0, share), 1e-14))
    }

    /// F_z at the fraction `theta` of the step of length `h` tried last, N.
    pub(super) fn force_z_within(&mut self, h: f64, theta: f64) -> f64 {
        self.on_carrier_within(h, theta).1
    }

    /// F_x and F_z at the fraction `theta` of the step of length `h` tried last, N.
    pub(super) fn on_carrier_within(&mut self, h: f64, theta: f64) -> (f64, f64) {
        let (windows_x, windows_z) = self.forces_of_windows(self.state.s + theta * h);
        let Self { model, state, workspace, .. } = self;
        let (carrier, start, span) = (&state.carrier, &state.layer.state, state.span(h));
        if state.time_stepping {
            let (x, z) = workspace.integrator.two_stage_on_carrier(model, carrier, start, span, theta);
            let step = workspace.integrator.two_stage_dense(model, carrier, start, span);
            let of_touches = workspace.end_correction.forces_of_touches(&step, theta);
            (x + of_touches.0, z + of_touches.1)
        } else {
            let (x, z) = workspace.integrator.on_carrier(model, carrier, start, span, theta, &mut workspace.dense);
            (x + windows_x, z + windows_z)
        }
    }

    /// P_diss at the fraction `theta` of the step of length `h` tried last, W, where the powers at its stages say it.
    pub(super) fn dissipated_power_within(&mut self, h: f64, theta: f64) -> Option<f64> {
        if !self.settings.accounts.energy || !self.has_powers_within() {
            return None;
        }
        let in_windows = self.dissipated_power_of_windows(self.state.s + theta * h);
        let Self { model, state, workspace, .. } = self;
        let (integrator, start) = (&mut workspace.integrator, &state.layer.state);
        Some(if state.time_stepping {
            integrator.two_stage_dissipated_power(model, start, h, theta)
        } else {
            (integrator.dissipated_power(model, start, h, theta) + in_windows).max(0.0)
        })
    }

    /// Whether the powers at the stages say P_diss within a step.
    fn has_powers_within(&self) -> bool {
        self.state.time_stepping || self.settings.tolerance.relative >= POWERS_OF_STAGES_FROM
    }

    /// Whether the dense output of `step`, tried last, is good enough to be shown at the time `s` after the start of the
    /// carrier's piece. A time step's touches and lifts are corrected at its end, and its dense output is not: it is shown
    /// before them, and where they change F_z little.
    pub(super) fn can_show_within(&self, step: &TrialStep, s: f64) -> bool {
        let Self { model, settings, state, workspace, .. } = self;
        if !state.time_stepping {
            return true;
        }
        let (integrator, correction) = (&workspace.integrator, &workspace.end_correction);
        let allowed = MAX_UNCORRECTED * settings.tolerance.relative * integrator.end_forces().on_carrier_z().abs();
        let dense = || integrator.two_stage_dense(model, &state.carrier, &state.layer.state, state.span(step.h));
        correction.uncorrected_force() < allowed || correction.comes_after(&dense(), (s - state.s) / step.h)
    }

    /// Whether the run can go on from the fraction `share` of the step of length `h` tried last.
    pub(super) fn can_resume_within(&mut self, h: f64, share: f64) -> bool {
        !self.workspace.integrator.has_tangents() && self.defect_within(h, share) <= MAX_DEFECT
    }

    /// The residual of the equations of motion in the dense output of the step of length `h` tried last at its fraction
    /// `share`, in the tolerance's norm.
    fn defect_within(&mut self, h: f64, share: f64) -> f64 {
        self.within(h, share).0.evaluate();
        let Self { model, settings, state, workspace, .. } = self;
        let (interpolated, forces) = (&workspace.interpolated, &workspace.forces);
        let dense = workspace.integrator.dense(model, &state.carrier, &state.layer.state, state.span(h));
        dense.defect(share, interpolated, forces, &mut workspace.dense, &settings.tolerance)
    }

    /// The state at the fraction `theta` of the step of length `h` tried last, into `interpolated`.
    pub(super) fn interpolate(&mut self, h: f64, theta: f64) {
        self.within(h, theta).0.interpolate();
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::super::tests::{WAVE, scene, scene_with_rate_shear, scene_with_real_area};
    use super::*;
    use crate::model::Mode;
    use crate::outputs::{Output, dependencies, variables};
    use crate::scene::{LinkKind, Path, Scene};
    use crate::simulation::{Motion, Simulation, Start};

    /// Runs of `scene` at rest, and with masses free, slipping and sticking, relaxed or not.
    fn runs(scene: &Scene) -> Vec<Simulation> {
        let mut started = Simulation::new(scene, &Start { w: -2e-6, u_rate: 0.1, ..Start::default() }).unwrap();
        let rest = started.clone();
        started.advance(&WAVE).unwrap();
        let wave = started.clone();
        let drag = Motion {
            duration: 1e-4,
            u: Path { rate: -0.3, ..Path::default() },
            w: Path::default(),
            ..Motion::default()
        };
        started.advance(&drag).unwrap();
        let dragged = started.clone();
        let still = Motion {
            duration: 2e-4,
            u: Path::default(),
            w: Path { rate: 1e-4, ..Path::default() },
            ..Motion::default()
        };
        started.advance(&still).unwrap();
        let pressed = Simulation::new(scene, &Start { w: -8e-6, u_rate: 0.1, ..Start::default() }).unwrap();
        let runs = vec![rest, wave, dragged, started, pressed];
        let modes: Vec<Mode> = runs.iter().flat_map(|run| run.run.state.layer.state.mode.clone()).collect();
        for mode in [Mode::Free, Mode::Forward, Mode::Backward, Mode::Stick] {
            assert!(modes.contains(&mode), "{mode:?} in {modes:?}");
        }
        runs
    }

    /// The same run with the carrier moved and every state held.
    fn moved(simulation: &Simulation, (du, dw): (f64, f64)) -> Simulation {
        let mut simulation = simulation.clone();
        let Run { model, state, .. } = &mut *simulation.run;
        (state.carrier.u, state.carrier.w) = (state.carrier.u + du, state.carrier.w + dw);
        let layer = &mut state.layer.state;
        layer.elongation_x.iter_mut().for_each(|e| *e -= du);
        layer.elongation_z.iter_mut().for_each(|e| *e -= dw);
        for row in &model.rows {
            let by = match row.kind {
                LinkKind::Horizontal => du,
                LinkKind::Vertical => dw,
                LinkKind::LateralX | LinkKind::LateralZ => 0.0,
            };
            layer.maxwell[row.range.clone()].iter_mut().for_each(|a| *a -= by);
        }
        simulation
    }

    /// Central: exact for all but the friction coefficient, being squares at most. That one has a kink at F_x = 0.
    #[test]
    fn directional_derivatives_are_those_of_a_difference_quotient() {
        [scene(), scene_with_rate_shear(), scene_with_real_area()]
            .iter()
            .for_each(directional_derivatives_are_quotients);
    }

    fn directional_derivatives_are_quotients(scene: &Scene) {
        let variables = variables(scene);
        let values = |mut simulation: Simulation| {
            let mut values = vec![0.0; variables.len()];
            simulation.evaluate(&variables, &mut values);
            values
        };
        for mut simulation in runs(scene) {
            for direction in [(1.0, 0.0), (0.0, 1.0), (-0.6, 0.8)] {
                let mut found = vec![f64::NAN; variables.len()];
                simulation.directional_derivative(&variables, direction, &mut found);
                let step = 1e-10;
                let by = |sign: f64| moved(&simulation, (sign * step * direction.0, sign * step * direction.1));
                let (up, down) = (values(by(1.0)), values(by(-1.0)));
                for (i, variable) in variables.iter().enumerate() {
                    let quotient = (up[i] - down[i]) / (2.0 * step);
                    if variable.output == Output::FrictionCoefficient && up[0] * down[0] <= 0.0 {
                        continue;
                    }
                    // Roundings of values of the size of these, over the step.
                    let allowed = 1e-6 * quotient.abs() + 1e-15 * (up[i].abs() + 1e-9) / step;
                    let error = (found[i] - quotient).abs();
                    assert!(error <= allowed, "{} {direction:?}: {} {quotient}", variable.name, found[i]);
                }
            }
        }
    }

    /// The table of dependencies says exactly which derivatives there are.
    #[test]
    fn there_is_a_derivative_where_there_is_a_dependency_and_nowhere_else() {
        let scene = scene();
        let variables = variables(&scene);
        for (name, direction) in [("u", (1.0, 0.0)), ("w", (0.0, 1.0))] {
            let mut found = BTreeSet::new();
            for mut simulation in runs(&scene) {
                let mut values = vec![0.0; variables.len()];
                simulation.directional_derivative(&variables, direction, &mut values);
                let with = variables.iter().zip(values).filter(|(_, value)| *value != 0.0);
                found.extend(with.map(|(variable, _)| variable.name.clone()));
            }
            let listed = variables.iter().filter(|variable| {
                let (on_u, on_w) = dependencies(&scene, variable.output).part_of(direction);
                on_u + on_w != 0.0
            });
            assert_eq!(found, listed.map(|variable| variable.name.clone()).collect(), "on {name}");
        }
    }

    /// Against the backward quotient of second order at the end of a motion, straight or not.
    #[test]
    fn force_rates_are_those_of_a_difference_quotient() {
        let scene = scene();
        let straight =
            Motion { duration: 4e-5, u: Path { rate: 0.3, ..Path::default() }, w: WAVE.w, ..Motion::default() };
        for start in runs(&scene) {
            for motion in [WAVE, straight] {
                let after = |by: f64| {
                    let mut simulation = start.clone();
                    simulation.advance(&Motion { duration: motion.duration - by, ..motion }).unwrap();
                    simulation
                };
                let force = |by: f64| {
                    let mut values = [0.0; 2];
                    after(by).evaluate(&variables(&scene)[..2], &mut values);
                    values
                };
                let found = after(0.0).force_rates();
                let h = 2e-9;
                let (now, before, earlier) = (force(0.0), force(h), force(2.0 * h));
                for (i, found) in [found.0, found.1].into_iter().enumerate() {
                    let quotient = (3.0 * now[i] - 4.0 * before[i] + earlier[i]) / (2.0 * h);
                    assert!((found - quotient).abs() < 1e-4 * quotient.abs() + 1e-2, "{i}: {found} {quotient}");
                }
            }
        }
    }

    /// Before the first motion: ė = -ẇ of masses on a flat surface that the carrier comes down on, and a relaxed layer.
    #[test]
    fn force_rates_at_the_start_are_those_of_the_starting_velocity() {
        let text = "name = 'a'\nlayer = { masses = 2, spacing = 1.0, mass = 1.0, vertical = { stiffness = 3.0, \
                    maxwell = [{ stiffness = 2.0, relaxation_time = 1.0 }] } }\nsurface = { kind = 'flat' }";
        let scene = Scene::parse(text, std::path::Path::new("a.toml")).unwrap();
        let mut simulation = Simulation::new(&scene, &Start { w: -0.1, w_rate: -0.5, ..Start::default() }).unwrap();
        assert_eq!(simulation.force_rates(), (0.0, 2.0 * (3.0 + 2.0) * 0.5));
    }
}
