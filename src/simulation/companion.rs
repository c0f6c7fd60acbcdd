//! The error of a run, judged by a second run of the same layer at a tighter tolerance.
//!
//! Errors of single steps say little about the error of a run: damped motion forgets them, impacts and stick-slip
//! multiply them, and where a run missed a touch there is none to add up. A finer run beside it sees all of that. Where
//! errors fall with the tolerance, the two are apart by 1 - [`FINER`] of the coarser one's error.

use super::stepping::Stride;
use super::{Motion, Settings, Simulation, SimulationError};
use crate::contact::EventTolerance;
use crate::integrator::Tolerance;
use crate::model::Model;
use crate::outputs::Accounts;

/// The finer run's tolerance, as a share of the run's.
///
/// Recommended 0.1 to 0.5. Smaller tells more where errors do not fall evenly, but costs more: with 0.2 the finer run
/// takes 1.4 times the run's steps where events are located, 2.2 times where it is stepped.
const FINER: f64 = 0.2;
/// The share of the error that shows in the difference of the two runs, where errors fall with the tolerance.
const SHOWN: f64 = 1.0 - FINER;
/// The finer run's steps are at most this share of the run's. Where steps only grow, both would take the same, and the
/// same error.
const SHORTER: f64 = 0.7;
/// Limit of the finer run's work in one motion, as a multiple of the run's, in addition to [`LEAST_WORK`]. Beyond it the
/// error is not estimated: the two runs differ in kind then, as where one mass slips along what it flies over in the other.
const MORE_WORK: u64 = 4;
/// Number of steps that the finer run may try in any motion, however few the run itself takes.
const LEAST_WORK: u64 = 10_000;

/// A finer run that follows another one: never behind it when it is asked for F_z.
#[derive(Clone, Debug)]
pub(super) struct Companion {
    finer: Box<Simulation>,
    /// The duration of the motion under way, s.
    duration: f64,
    /// Steps tried in it.
    work: u64,
    /// Steps that the run beside it has tried in it.
    run_work: u64,
    /// The step tried last, of which only a part may have been asked for.
    stride: Option<Stride>,
    /// Whether it could not go on in this motion.
    lost: bool,
}

impl Companion {
    pub(super) fn new(finer: Simulation) -> Self {
        Self { finer: Box::new(finer), duration: 0.0, work: 0, run_work: 0, stride: None, lost: false }
    }

    pub(super) fn finer(&self) -> &Simulation {
        &self.finer
    }

    pub(super) fn finer_mut(&mut self) -> &mut Simulation {
        &mut self.finer
    }

    pub(super) fn keep_checkpoint(&mut self) {
        self.finer.keep_checkpoint();
    }

    pub(super) fn go_back(&mut self) {
        self.stride = None;
        self.finer.go_back();
    }

    /// Begins `motion`.
    pub(super) fn enter(&mut self, motion: &Motion) {
        (self.duration, self.work, self.run_work, self.lost) = (motion.duration, 0, 0, false);
        self.finer.enter(motion);
    }

    /// The run takes a step of length `h` (s); it has tried `work` steps in this motion.
    pub(super) fn note_step(&mut self, h: f64, work: u64) {
        self.run_work = work;
        let run = &mut self.finer.run;
        run.step_size = run.step_size.min(SHORTER * h);
    }

    /// F_z at the time `s` since the start of the motion, which does not fall from call to call, N; `None` where the
    /// finer run did not get there.
    pub(super) fn force_z_at(&mut self, s: f64) -> Option<f64> {
        if self.lost {
            return None;
        }
        let force = self.go_to(s, false);
        self.lost = force.is_err();
        force.ok()
    }

    /// F_z at the time `s`; the finer run stands there if it `ends` there, or within a step that goes beyond it.
    fn go_to(&mut self, s: f64, ends: bool) -> Result<f64, SimulationError> {
        while self.finer.run.s < s {
            if self.work > LEAST_WORK + MORE_WORK.saturating_mul(self.run_work) {
                return Err(SimulationError::TooManySteps { time: self.finer.time(), steps: self.work });
            }
            let stride = match self.stride.take() {
                Some(stride) => stride,
                None => self.finer.next_step(self.duration, &mut self.work)?,
            };
            let end = self.finer.end_of(&stride, self.duration);
            let theta = (s - self.finer.run.s) / stride.h;
            if !ends && s < end && self.finer.can_show_within(stride.h, theta) {
                self.stride = Some(stride);
                return Ok(self.finer.force_z_within(stride.h, theta));
            }
            let (stride, end) =
                if s < end { self.finer.cut_at(s, self.duration, &mut self.work)? } else { (stride, end) };
            self.finer.take_step(&stride, end);
        }
        Ok(self.finer.force_z())
    }

    /// Ends the motion where `run` does. If the finer run got lost, it goes on from there.
    pub(super) fn stop_beside(&mut self, run: &Simulation) {
        self.lost = self.lost || self.go_to(run.run.s, true).is_err();
        if self.lost {
            self.stride = None;
            self.finer.take_over(run);
        }
    }
}

impl Simulation {
    /// Compares F_z as the run stands with that of the finer run at the same time.
    pub(super) fn note_error(&mut self) {
        let Some(mut companion) = self.companion.take() else { return };
        let force = self.force_z();
        match companion.force_z_at(self.run.s) {
            Some(finer) => self.run.counters.note_error(force, finer, SHOWN),
            None => self.run.counters.note_unknown(force),
        }
        self.companion = Some(companion);
    }

    /// Ends the motion of the finer run where this one stands.
    pub(super) fn end_beside(&mut self) {
        self.note_error();
        if let Some(mut companion) = self.companion.take() {
            companion.stop_beside(self);
            self.companion = Some(companion);
        }
    }
}

impl Settings {
    /// The settings of the finer run beside one with these.
    pub(super) fn finer(&self, model: &Model) -> Self {
        let tolerance = Tolerance::new(model, FINER * self.tolerance.relative, FINER * self.tolerance.position);
        Self {
            events: EventTolerance::new(model, &tolerance),
            tolerance,
            max_steps: self.max_steps.saturating_mul(MORE_WORK),
            accounts: Accounts::default(),
            method: self.method,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{WAVE, scene};
    use super::*;
    use crate::outputs::{Output, variables};
    use crate::scene::{Path, Scene};
    use crate::simulation::Start;

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

    fn stands_beside(simulation: &Simulation) -> bool {
        let finer = simulation.companion.as_ref().unwrap().finer();
        finer.run.s == simulation.run.s && finer.carrier() == simulation.carrier()
    }

    /// The difference to a run at a far tighter tolerance, by rows as the estimate goes by them.
    #[test]
    fn the_estimate_is_the_error() {
        let scene = coarse();
        let times: Vec<f64> = (0..=20).map(|i| f64::from(i) * WAVE.duration / 20.0).collect();
        let forces = |simulation: &mut Simulation| {
            let mut forces = Vec::new();
            simulation.advance_observed(&WAVE, &times, |_, simulation| forces.push(simulation.force_z())).unwrap();
            forces
        };
        let (mut coarse, mut tight) = (started(&scene), started(&super::super::tests::scene()));
        let (found, wanted) = (forces(&mut coarse), forces(&mut tight));
        let error = found.iter().zip(&wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let error = error / wanted.iter().map(|force| force.abs()).fold(0.0, f64::max);
        let ratio = value(&scene, &mut coarse, Output::EstimatedError) / error;
        assert!(error > 1e-7 && (0.3..3.0).contains(&ratio), "{ratio} times {error:e}");
    }

    #[test]
    fn both_end_together_wherever_that_is() {
        let scene = coarse();
        let mut simulation = started(&scene);
        let press = Motion { duration: 1e-3, u: Path::default(), w: Path { rate: -0.01, ..Path::default() } };
        let force = 2.0 * simulation.force_z();
        let risen = simulation.advance_until_force(&press, force, &[1e-5, 2e-5], |_, _| ()).unwrap();
        assert!(risen.is_some_and(|s| s > 0.0 && s < press.duration), "{risen:?}");
        assert!(stands_beside(&simulation));
        simulation.advance(&WAVE).unwrap();
        assert!(stands_beside(&simulation));
    }

    #[test]
    fn what_is_not_known_counts_as_the_whole_force() {
        let scene = coarse();
        let mut simulation = started(&scene);
        simulation.companion.as_mut().unwrap().finer.settings.max_steps = 3;
        simulation.advance(&WAVE).unwrap();
        assert_eq!(value(&scene, &mut simulation, Output::EstimatedError), 1.0);
        assert!(stands_beside(&simulation));
        assert_eq!(simulation.companion.as_mut().unwrap().finer.force_z(), simulation.force_z());
    }

    /// A motion that fails leaves both runs as they were.
    #[test]
    fn both_go_back() {
        let scene = coarse();
        let mut simulation = started(&scene);
        let allowed = std::mem::replace(&mut simulation.settings.max_steps, 3);
        let before = simulation.save();
        assert!(simulation.advance(&WAVE).is_err());
        assert_eq!(simulation.save(), before);
        simulation.settings.max_steps = allowed;
        simulation.advance(&WAVE).unwrap();
    }

    #[test]
    fn nothing_runs_beside_where_nobody_asks() {
        let mut scene = coarse();
        scene.outputs.retain(|group| *group != crate::scene::OutputGroup::Solver);
        assert!(started(&scene).companion.is_none());
    }
}
