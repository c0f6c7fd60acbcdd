//! Runs driven as a master drives the FMU, and errors over its communication steps.

use std::ops::ControlFlow;

use asperity::scene::{Input, Scene};
use asperity::simulation::{Motion, Simulation, SimulationError, SimulationState};
use asperity_fmi::{CommunicationStep, Inputs, ProvisionalStep, layer_motion, layer_scales, layer_start};
use cpu_time::ThreadTime;

use super::reference::{Comparison, Reference};
use super::run::{CompletedRun, RunFigures, TraceRecorder, UNLIMITED, WeighedRuns, follow, weight};
use super::trace::{Errors, Trace};
use crate::decimals::rounded;
use crate::picture::rounded_down;
use crate::progress::Stopped;
use crate::robustness::{Budget, RunFailure, at_tolerance, exact};
use crate::runner::{InputSample, Rows};

/// What a master sets at a communication point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MasterInputs {
    /// Values and rates.
    Rates,
    /// Values alone.
    Values,
    /// Nothing: there is no master, the program follows the excitation itself.
    None,
}

impl MasterInputs {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rates => "values and rates",
            Self::Values => "values alone",
            Self::None => "no master",
        }
    }
}

/// Drives `scene` as a master drives the FMU, from the carrier at `u` (m). `points` are the communication points of
/// each phase that is run, s after it begins.
pub(super) fn drive(
    scene: &Scene,
    given: MasterInputs,
    points: &[Vec<f64>],
    u: f64,
    budget: Budget,
    tick: &dyn Fn(f64) -> ControlFlow<()>,
) -> Result<CompletedRun, RunFailure> {
    let duration = scene.duration();
    let mut master = Master::new(scene, given, u, budget)?;
    let clock = ThreadTime::now();
    for (phase, points) in scene.excitation.iter().zip(points) {
        let (motion, start) = (phase.motion(scene.layer.area()), master.carrier);
        let mut from = 0.0;
        for &to in points {
            master.step(&motion, start, from, to)?;
            master.recorder.check(budget)?;
            from = to;
            if tick(master.carrier.time / duration).is_break() {
                return Err(RunFailure::Stopped(Stopped.to_string()));
            }
        }
        master.recorder.end_phase();
    }
    let durations = scene.excitation.iter().map(|phase| phase.duration).collect();
    Ok(master.recorder.finish(&mut master.simulation, clock.elapsed().as_secs_f64(), durations))
}

/// A master with the unit that it drives; how inputs become a motion is the FMU's own.
#[derive(Debug)]
struct Master<'a> {
    scene: &'a Scene,
    given: MasterInputs,
    budget: Budget,
    inputs: Inputs,
    simulation: Simulation,
    /// The last step, where it may be done again, and the state at its start.
    last: Option<(ProvisionalStep, SimulationState)>,
    recorder: TraceRecorder,
    /// On the excitation, at the communication point.
    carrier: InputSample,
}

impl<'a> Master<'a> {
    fn new(scene: &'a Scene, given: MasterInputs, u: f64, budget: Budget) -> Result<Self, RunFailure> {
        let mut inputs = Inputs::default();
        inputs.set(Input::Temperature as usize, scene.input_start(Input::Temperature));
        inputs.set(Input::U as usize, u);
        inputs.set(Input::Load as usize, scene.first_load());
        inputs.set(Input::Pull as usize, scene.first_pull());
        if let Some(phase) = scene.excitation.first().filter(|_| given == MasterInputs::Rates) {
            set_rates(&mut inputs, &phase.motion(scene.layer.area()), 0.0);
        }
        let simulation = Simulation::new(&budget.limit(scene), &layer_start(scene, &inputs, 0.0));
        let mut simulation = simulation.map_err(|error| budget.failure(scene, &error))?;
        let mut recorder = TraceRecorder::new(scene);
        recorder.row(&simulation.snapshot());
        let carrier = InputSample { u, ..InputSample::default() };
        Ok(Self { scene, given, budget, inputs, simulation, last: None, recorder, carrier })
    }

    /// Does the communication step between two times (s) of the `motion` that began at `start`.
    fn step(&mut self, motion: &Motion, start: InputSample, from: f64, to: f64) -> Result<(), RunFailure> {
        // A force jumps at the start of a phase.
        let at_start = if from == 0.0 { start.after(motion, 0.0) } else { self.carrier };
        for input in Input::MECHANICAL {
            self.inputs.set(input as usize, at_start.input(input));
        }
        if self.given == MasterInputs::Rates {
            set_rates(&mut self.inputs, motion, from);
        }
        let step = CommunicationStep { time: self.carrier.time, h: to - from, rule: self.scene.input_rule };
        let scales = layer_scales(self.scene);
        if let Some((last, state)) = self.last.take()
            && let Some(corrected) = last.corrected(&self.inputs, &scales)
        {
            let continued = self.simulation.continue_from(&state).map_err(SimulationError::from);
            continued.map_err(|error| self.budget.failure(self.scene, &error))?;
            self.follow(&corrected, &last.step())?;
        }
        self.last = ProvisionalStep::new(&self.inputs, &step, &scales).map(|step| (step, self.simulation.state()));
        for (inputs, part) in self.inputs.parts(&step, &scales) {
            self.follow(&inputs, &part)?;
        }
        self.inputs.complete_step(&step);
        self.recorder.row(&self.simulation.snapshot());
        self.carrier = start.after(motion, to);
        Ok(())
    }

    fn follow(&mut self, inputs: &Inputs, step: &CommunicationStep) -> Result<(), RunFailure> {
        let motion = layer_motion(self.scene, inputs, self.simulation.driven(), step);
        let motion = motion.map_err(|error| RunFailure::Stopped(error.to_string()))?;
        self.simulation.advance(&motion).map_err(|error| self.budget.failure(self.scene, &error))
    }
}

fn set_rates(inputs: &mut Inputs, motion: &Motion, s: f64) {
    inputs.set_rate(Input::U as usize, motion.u.at(s).speed);
    inputs.set_rate(Input::W as usize, motion.w.at(s).speed);
    inputs.set_rate(Input::Load as usize, motion.load.change.at(s).speed);
    inputs.set_rate(Input::Pull as usize, motion.pull.change.at(s).speed);
}

/// A row of the table of errors and communication steps.
#[derive(Clone, Debug, PartialEq)]
pub struct CommunicationRow {
    /// What the master gives.
    pub given: MasterInputs,
    /// The communication step, s; `None` without a master.
    pub step: Option<f64>,
    /// Where runs are compared row by row, with the root mean squares of the errors; or why there are no figures.
    pub result: Result<(RunFigures, Option<Errors>), RunFailure>,
}

/// The communication steps of a master, at the scene's own tolerance and method. What a user of the FMU meets: its
/// carrier follows the excitation by values, with or without rates.
pub(super) struct CommunicationLadder<'a> {
    reference: &'a Reference,
    /// The longest step, s.
    longest: f64,
    progress: &'a WeighedRuns<'a>,
}

impl<'a> CommunicationLadder<'a> {
    /// The longest communication step is about this part of the excitation.
    const LONGEST: f64 = 1.0 / 64.0;
    /// Each step is half of the one before.
    const STEPS: u32 = 7;
    /// Parts of the longest step that make the shortest.
    const FINEST: u32 = 1 << (Self::STEPS - 1);

    /// What all runs are likely to take, by [`weight`], for a reference and a scene at these tolerances.
    pub(super) fn weight(reference: f64, scene: f64) -> f64 {
        weight(reference) + f64::from(2 * Self::STEPS + 1) * weight(scene)
    }

    pub(super) fn new(reference: &'a Reference, progress: &'a WeighedRuns<'a>) -> Self {
        let longest = rounded(rounded_down(Self::LONGEST * reference.scene.duration()), 1);
        Self { reference, longest, progress }
    }

    pub(super) fn run(&self) -> Vec<CommunicationRow> {
        let scene = &self.reference.scene;
        let finest = self.rows(Self::FINEST);
        let tight = exact(&at_tolerance(scene, self.reference.tolerance));
        let follow = |message: &str, scene: &Scene| {
            let weight = weight(scene.solver.relative_tolerance);
            self.progress.during(message, weight, |tick| follow(scene, finest, 0.0, UNLIMITED, tick))
        };
        let Ok(tight) = follow("reference at the communication points", &tight) else { return Vec::new() };
        let alone = follow(MasterInputs::None.name(), scene);
        let mut table = Vec::new();
        for given in [MasterInputs::Rates, MasterInputs::Values] {
            for parts in (0..Self::STEPS).map(|step| 1 << step) {
                let result = self.drive(given, parts).map(|run| self.compare(&run, &self.every(&tight, parts)));
                let step = Some(self.longest / f64::from(parts));
                table.push(CommunicationRow { given, step, result });
            }
        }
        let result = alone.map(|run| {
            let (figures, mean_squares) = self.compare(&run, &tight.trace);
            // Its time was spent on the rows: there are as many as communication points at the shortest step.
            (RunFigures { times: Vec::new(), ..figures }, mean_squares)
        });
        table.push(CommunicationRow { given: MasterInputs::None, step: None, result });
        table
    }

    fn rows(&self, parts: u32) -> Rows {
        Rows::Within { longest: self.longest, parts }
    }

    /// The rows of the finest run at the communication points of a coarser one.
    fn every(&self, finest: &CompletedRun, parts: u32) -> Trace {
        finest.trace.every((Self::FINEST / parts) as usize)
    }

    fn drive(&self, given: MasterInputs, parts: u32) -> Result<CompletedRun, RunFailure> {
        let scene = &self.reference.scene;
        let times = |duration: f64| self.rows(parts).times(duration).collect();
        let points: Vec<Vec<f64>> = scene.excitation.iter().map(|phase| times(phase.duration)).collect();
        let step = self.longest / f64::from(parts);
        let message = format!("{}, communication step {step:.3e} s", given.name());
        let weight = weight(scene.solver.relative_tolerance);
        self.progress.during(&message, weight, |tick| drive(scene, given, &points, 0.0, UNLIMITED, tick))
    }

    fn compare(&self, run: &CompletedRun, tight: &Trace) -> (RunFigures, Option<Errors>) {
        let (errors, mean_squares) = match self.reference.comparison {
            Comparison::Pointwise(_) => (run.trace.largest(tight), Some(run.trace.mean_square(tight))),
            Comparison::Means(_) => (run.trace.means(tight), None),
        };
        (RunFigures::new(run, errors), mean_squares)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "
name = 'pressed'
[layer]
masses = 2
spacing = 1e-4
mass = 1e-7
[layer.vertical]
stiffness = 1e3
[surface]
kind = 'flat'
[fmu]
outputs = ['forces', 'dissipation', 'energy', 'solver']
[[excitation]]
duration = 1e-3
w_rate = -0.01
[[excitation]]
duration = 1e-3
u_rate = 0.01
";

    #[test]
    fn a_run_ends_at_its_budget_or_stops_at_the_scenes_own_limit() {
        let mut scene = Scene::parse(TEXT, "scene.toml".as_ref()).unwrap();
        let along = |scene: &Scene, budget| {
            follow(scene, Rows::PerPhase(4), 0.0, Budget(budget), &|_| ControlFlow::Continue(()))
        };
        let points = vec![(1..=10).map(|i| 1e-4 * f64::from(i)).collect::<Vec<_>>(); 2];
        let driven = |scene: &Scene, budget| {
            drive(scene, MasterInputs::Rates, &points, 0.0, Budget(budget), &|_| ControlFlow::Continue(()))
        };
        for (run, rows) in [(&along as &dyn Fn(&Scene, u64) -> _, 9), (&driven, 21)] {
            let measured = run(&scene, 10_000).unwrap();
            assert_eq!(measured.trace.forces().rows.len(), rows);
            assert!((measured.trace.end() - 2e-3).abs() < 1e-15, "{:e}", measured.trace.end());
            let failure = run(&scene, measured.counts.work() - 1).unwrap_err();
            assert!(matches!(failure, RunFailure::OverBudget { time } if time > 1e-3), "{failure:?}");
        }
        scene.solver.max_steps = Some(2);
        let failure = along(&scene, 10_000).unwrap_err();
        assert!(matches!(&failure, RunFailure::Stopped(reason) if reason.contains("solver.max_steps")), "{failure:?}");
    }
}
