//! The error of a run, estimated by a reference run: a second one of the same layer at a tighter tolerance.
//!
//! Errors of single steps say little about the error of a run: damped motion forgets them, impacts and stick-slip
//! multiply them, and where a touch was missed there is none to add up. A more accurate run sees all of that.
//! Where errors fall with the tolerance, the two differ by 1 - [`TIGHTER`] of the less accurate one's error. Where stick and
//! slip get out of step they do not fall: the two then differ by far more than the tolerance, and in the number of their
//! mode changes ([`Inaccuracy::Divergence`]).

use std::sync::Arc;

use super::controller::{TrialStep, WorkLimit};
use super::motion::{Inaccuracy, Motion, SimulationError, Start};
use super::run::Run;
use super::settings::Settings;
use super::state::RunState;
use crate::contact::EventTolerance;
use crate::integrator::Tolerance;
use crate::model::{BodyStart, ByAxis, Model};
use crate::outputs::{Accounts, Monitored, Snapshot};

/// The reference run's tolerance, as a fraction of the run's.
///
/// Recommended 0.1 to 0.5. Smaller sees more where errors do not fall evenly, but costs more: with 0.2 this run takes
/// 1.4 times the run's steps where events are located, 2.2 times with time-stepping.
const TIGHTER: f64 = 0.2;
/// The fraction of the error that shows in the difference of the two runs, where errors fall with the tolerance.
const VISIBLE_FRACTION: f64 = 1.0 - TIGHTER;
/// Its steps are at most this fraction of the run's. Where steps only grow, both would take the same, with the same error.
const SHORTER: f64 = 0.7;
/// Limit of its work in one motion, as a multiple of the run's, in addition to [`MIN_WORK`]. Beyond it the error is not
/// estimated: the two runs differ in kind then, as where one mass slips along what it flies over in the other.
const MORE_WORK: u64 = 4;
/// The estimated error, in relative tolerances, above which two runs whose modes changed differently often do not converge.
///
/// Recommended 30 to 100. Errors of 30 tolerances are more than a run has that keeps to its tolerance, which in most is
/// within ten. With 10, runs are found too whose error still falls with the tolerance.
const DIVERGED: f64 = 30.0;
/// The estimated error above which a run is inaccurate in any case, over the largest forces.
const LARGE_ERROR: f64 = 0.1;
/// Number of steps that it may try in any motion, however few the run itself takes.
const MIN_WORK: u64 = 10_000;

/// A more accurate run that follows the one whose error is estimated: never behind it when it is compared.
#[derive(Clone, Debug)]
pub(super) struct ReferenceRun {
    pub(super) run: Run,
    /// The duration of the motion under way, s.
    duration: f64,
    work: WorkLimit,
    /// Steps that the run has tried in this motion.
    steps_of_run: u64,
    /// The step tried last, of which only a part may have been asked for, and its end, s after the start of the motion.
    pending: Option<(TrialStep, f64)>,
    /// Whether it could not go on in this motion.
    failed: bool,
}

impl ReferenceRun {
    /// The reference run of one with these `settings`.
    pub(super) fn new(
        model: &Arc<Model>,
        settings: &Settings,
        start: &Start,
        bodies: &ByAxis<Option<BodyStart>>,
    ) -> Self {
        let run = Run::new(Arc::clone(model), settings.tighter(model), start, bodies);
        let work = WorkLimit::new(run.context.settings.max_steps, u64::MAX);
        Self { run, duration: 0.0, work, steps_of_run: 0, pending: None, failed: false }
    }

    /// Forgets the step tried last, of a motion that is rolled back.
    pub(super) fn discard_pending(&mut self) {
        self.pending = None;
    }

    /// Begins `motion`, in which it may take so many steps times masses.
    pub(super) fn begin(&mut self, motion: &Motion, max_mass_steps: u64) {
        (self.duration, self.steps_of_run, self.failed) = (motion.duration, 0, false);
        self.work = WorkLimit::new(self.run.context.settings.max_steps, max_mass_steps);
        self.run.begin(motion);
    }

    /// The run takes a step of length `h` (s), and has tried `steps` in this motion: the next step here is no longer than a
    /// fraction of it.
    pub(super) fn record_step(&mut self, h: f64, steps: u64) {
        self.steps_of_run = steps;
        self.run.context.state.controller.limit(SHORTER * h);
    }

    /// Includes in the counters of `snapshot`, of the run at the time `s` of the motion, by how much it is off. Where the
    /// reference could not go on, the errors are unknown and count as large as the quantities themselves.
    pub(super) fn compare(&mut self, s: f64, snapshot: &mut Snapshot<'_>) {
        let found = snapshot.monitored(self.run.context.settings.accounts.energy);
        match self.monitored_at(s) {
            Some(reference) => snapshot.counters.record_error(&found, &reference, VISIBLE_FRACTION),
            None => snapshot.counters.record_unknown(&found),
        }
    }

    /// The quantities compared at the time `s` since the start of the motion, which does not fall from call to call;
    /// `None` where the run could not go on.
    fn monitored_at(&mut self, s: f64) -> Option<Monitored> {
        if self.failed {
            return None;
        }
        let monitored = self.follow_to(s, false);
        self.failed = monitored.is_err();
        monitored.ok()
    }

    /// The quantities compared at the time `s`; the run stands there if it `ends` there, or before a step that goes
    /// beyond it.
    fn follow_to(&mut self, s: f64, ends: bool) -> Result<Monitored, SimulationError> {
        let tracked = self.run.context.settings.accounts.energy;
        while self.run.context.state.s < s {
            let steps = self.work.tried;
            if steps > MIN_WORK + MORE_WORK.saturating_mul(self.steps_of_run) {
                return Err(SimulationError::TooManySteps { time: self.run.context.state.time(), steps });
            }
            let (mut step, mut end) = match self.pending.take() {
                Some(pending) => pending,
                None => {
                    let step = self.run.next_step(self.duration, &mut self.work)?;
                    (step, step.end(self.run.context.state.s, self.duration))
                }
            };
            if s < end && (ends || !self.run.can_show_within(&step, s)) {
                (step, end) = self.run.cut_step_at(s, self.duration, &mut self.work)?;
            }
            end = self.run.advance_regions(&mut step, (s.min(end), end), &mut self.work)?;
            if s < end {
                let theta = self.run.context.state.fraction_at(s, step.h);
                self.pending = Some((step, end));
                return Ok(self.run.snapshot_within(step.h, theta).monitored(tracked));
            }
            self.run.take_step(&step, end);
        }
        Ok(self.run.snapshot().monitored(tracked))
    }

    /// What shows that the forces of `run`, which stands at the same time, are inaccurate.
    pub(super) fn inaccuracy(&self, run: &Run) -> Option<Inaccuracy> {
        let (counters, tolerance) = (&run.context.state.counters, run.context.settings.tolerance.relative);
        let (error, mode_changes) = (counters.force_error(), [counters.events, self.run.context.state.counters.events]);
        if error > DIVERGED * tolerance && mode_changes[0] != mode_changes[1] {
            return Some(Inaccuracy::Divergence { error, tolerance, mode_changes });
        }
        (error > LARGE_ERROR).then_some(Inaccuracy::Forces { error })
    }

    /// Ends the motion where the run stands, in `state`. If the reference could not go on, it continues from there.
    pub(super) fn end_motion(&mut self, state: &RunState) {
        self.failed = self.failed || self.follow_to(state.s, true).is_err();
        if self.failed {
            self.pending = None;
            self.run.context.state.copy_from(state);
        }
    }
}

impl Settings {
    /// The settings of the reference run of one with these.
    pub(super) fn tighter(&self, model: &Model) -> Self {
        let tolerance = Tolerance::new(model, TIGHTER * self.tolerance.relative, TIGHTER * self.tolerance.position);
        Self {
            events: EventTolerance::new(model, &tolerance),
            tolerance,
            max_steps: self.max_steps.saturating_mul(MORE_WORK),
            accounts: Accounts { energy: self.accounts.dissipation_error, ..Accounts::default() },
            method: self.method,
            is_local: false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{STICK_SLIP, WAVE, scene};
    use super::*;
    use crate::outputs::{Output, variables};
    use crate::scene::{Method, Path, Scene};
    use crate::simulation::{Simulation, Start};

    fn coarse() -> Scene {
        let mut scene = scene();
        scene.solver.relative_tolerance = 1e-4;
        scene
    }

    fn started(scene: &Scene) -> Simulation {
        Simulation::new(scene, &Start { w: -2e-6, ..Start::default() }).unwrap()
    }

    fn value(scene: &Scene, simulation: &mut Simulation, output: Output) -> f64 {
        let variable = variables(scene).into_iter().find(|variable| variable.output == output).unwrap();
        let mut values = [f64::NAN];
        simulation.evaluate(&[variable], &mut values);
        values[0]
    }

    fn ends_together(simulation: &Simulation) -> bool {
        let reference = &simulation.reference_run.as_ref().unwrap().run.context.state;
        let run = &simulation.run.context.state;
        reference.s == run.s && reference.displacement() == run.displacement()
    }

    /// The differences to a run at a far tighter tolerance, by rows as the estimates go by them.
    #[test]
    fn the_estimates_are_the_errors() {
        let scene = coarse();
        let times: Vec<f64> = (0..=20).map(|i| f64::from(i) * WAVE.duration / 20.0).collect();
        let rows = |simulation: &mut Simulation| {
            let mut rows: Vec<[f64; 3]> = Vec::new();
            let observe = |_, snapshot: &Snapshot<'_>| {
                let Monitored { forces: [x, z], dissipated, .. } = snapshot.monitored(true);
                rows.push([x, z, dissipated.unwrap()]);
            };
            simulation.advance_observed(&WAVE, None, &times, observe).unwrap();
            rows
        };
        let (mut coarse, mut tight) = (started(&scene), started(&super::super::tests::scene()));
        let (found, wanted) = (rows(&mut coarse), rows(&mut tight));
        let error = |i: usize| {
            let differences = found.iter().zip(&wanted).map(|(a, b)| (a[i] - b[i]).abs());
            differences.fold(0.0, f64::max) / wanted.iter().map(|row| row[i].abs()).fold(0.0, f64::max)
        };
        for (output, error) in [(Output::ForceError, error(0).max(error(1))), (Output::DissipationError, error(2))] {
            let ratio = value(&scene, &mut coarse, output) / error;
            assert!(error > 1e-7 && (0.3..3.0).contains(&ratio), "{output:?}: {ratio} times {error:e}");
        }
    }

    #[test]
    fn energies_are_compared_only_where_they_are_asked_for() {
        use crate::scene::OutputGroup::{Dissipation, Energy, Forces, Solver};
        for (outputs, tracked) in [(vec![Forces, Energy, Solver], false), (vec![Dissipation, Solver], true)] {
            let mut scene = coarse();
            scene.outputs = outputs;
            assert_eq!(started(&scene).reference_run.unwrap().run.context.settings.accounts.energy, tracked);
            assert_eq!(variables(&scene).iter().any(|variable| variable.name == "solver.error_E_diss"), tracked);
        }
    }

    #[test]
    fn both_end_together_wherever_that_is() {
        let scene = coarse();
        let mut simulation = started(&scene);
        let press = Motion {
            duration: 1e-3,
            u: Path::default(),
            w: Path { rate: -0.01, ..Path::default() },
            ..Motion::default()
        };
        let force = 2.0 * simulation.snapshot().on_carrier.z;
        let risen = simulation.advance_observed(&press, Some(force), &[1e-5, 2e-5], |_, _| ()).unwrap();
        assert!(risen.is_some_and(|s| s > 0.0 && s < press.duration), "{risen:?}");
        assert!(ends_together(&simulation));
        simulation.advance(&WAVE).unwrap();
        assert!(ends_together(&simulation));
    }

    #[test]
    fn what_is_not_known_counts_as_the_whole_force() {
        let scene = coarse();
        let mut simulation = started(&scene);
        simulation.reference_run.as_mut().unwrap().run.context.settings.max_steps = 3;
        simulation.advance(&WAVE).unwrap();
        assert_eq!(value(&scene, &mut simulation, Output::ForceError), 1.0);
        assert!(ends_together(&simulation));
        let reference = simulation.reference_run.as_mut().unwrap().run.snapshot().monitored(false);
        assert_eq!(reference, simulation.run.snapshot().monitored(false));
    }

    #[test]
    fn a_large_error_and_other_mode_changes_are_a_divergence() {
        let mut simulation = started(&coarse());
        simulation.advance(&WAVE).unwrap();
        assert_eq!(simulation.inaccuracy(), None);
        let reference_run = simulation.reference_run.as_mut().unwrap();
        reference_run.run.context.state.counters.events += 1;
        assert_eq!(simulation.inaccuracy(), None);
        let force = |x| Monitored { forces: [x, 1e9], ways: [0.0; 2], dissipated: None };
        simulation.run.context.state.counters.record_error(&force(0.0), &force(1e9), 1.0);
        let events = simulation.run.context.state.counters.events;
        let mode_changes = [events, events + 1];
        let expected = Inaccuracy::Divergence { error: 1.0, tolerance: 1e-4, mode_changes };
        assert_eq!(simulation.inaccuracy(), Some(expected));
        simulation.reference_run.as_mut().unwrap().run.context.state.counters.events -= 1;
        assert_eq!(simulation.inaccuracy(), Some(Inaccuracy::Forces { error: 1.0 }));
    }

    #[test]
    fn stick_and_slip_out_of_step_do_not_converge() {
        let mut scene = Scene::parse(STICK_SLIP, std::path::Path::new("stick-slip.toml")).unwrap();
        let slide = Motion {
            duration: 1e-3,
            u: Path { rate: 0.02, ..Path::default() },
            w: Path::default(),
            ..Motion::default()
        };
        for method in [Method::Event, Method::Step] {
            for tolerance in [1e-2, 1e-3] {
                (scene.solver.method, scene.solver.relative_tolerance) = (method, tolerance);
                let mut simulation = Simulation::new(&scene, &Start::default()).unwrap();
                // Compared at the end of each; at one of them the numbers of mode changes may be the same by chance.
                let mut diverges_after = |slides: usize| {
                    (0..slides).for_each(|_| simulation.advance(&slide).unwrap());
                    matches!(simulation.inaccuracy(), Some(Inaccuracy::Divergence { .. }))
                };
                assert!(diverges_after(30) || diverges_after(1), "{method:?}, {tolerance}");
            }
        }
    }

    /// A motion that fails leaves both runs as they were.
    #[test]
    fn both_go_back() {
        let scene = coarse();
        let mut simulation = started(&scene);
        let allowed = std::mem::replace(&mut simulation.run.context.settings.max_steps, 3);
        let before = simulation.state();
        assert!(simulation.advance(&WAVE).is_err());
        assert_eq!(simulation.state(), before);
        simulation.run.context.settings.max_steps = allowed;
        simulation.advance(&WAVE).unwrap();
    }

    #[test]
    fn no_reference_run_unless_it_is_asked_for() {
        let mut scene = coarse();
        scene.outputs.retain(|group| *group != crate::scene::OutputGroup::Solver);
        assert!(started(&scene).reference_run.is_none());
    }
}
