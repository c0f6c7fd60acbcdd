//! One run of a scene for a report, driven as a master drives the FMU.

use std::ops::ControlFlow;

use asperity::scene::{Input, Scene};
use asperity::simulation::{Motion, Simulation, SimulationError, SimulationState};
use asperity_fmi::{
    CommunicationStep, InputOutOfRange, Inputs, ProvisionalStep, layer_motion, layer_scales, layer_start,
};
use cpu_time::ThreadTime;

use super::figures::CompletedRun;
use super::recorder::TraceRecorder;
use crate::progress::Stopped;
use crate::robustness::{Budget, RunFailure};
use crate::runner::InputSample;

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
    let failed = |error: DriveError| match error {
        DriveError::Run(error) => budget.failure(scene, &error),
        DriveError::Input(error) => RunFailure::Stopped(error.to_string()),
    };
    let limited = budget.limit(scene);
    let duration = scene.duration();
    let mut master = Master::new(&limited, given, u).map_err(|error| failed(error.into()))?;
    let clock = ThreadTime::now();
    for (phase, points) in scene.excitation.iter().zip(points) {
        let (motion, start) = (phase.motion(scene.layer.area()), master.carrier);
        let mut from = 0.0;
        for &to in points {
            master.step(&motion, start, from, to).map_err(failed)?;
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

#[derive(Debug, thiserror::Error)]
#[error(transparent)]
enum DriveError {
    Input(#[from] InputOutOfRange),
    Run(#[from] SimulationError),
}

/// A master with the unit that it drives; how inputs become a motion is the FMU's own.
#[derive(Debug)]
struct Master<'a> {
    scene: &'a Scene,
    given: MasterInputs,
    inputs: Inputs,
    simulation: Simulation,
    /// The last step, where it may be done again, and the state at its start.
    last: Option<(ProvisionalStep, SimulationState)>,
    recorder: TraceRecorder,
    /// On the excitation, at the communication point.
    carrier: InputSample,
}

impl<'a> Master<'a> {
    fn new(scene: &'a Scene, given: MasterInputs, u: f64) -> Result<Self, SimulationError> {
        let mut inputs = Inputs::default();
        inputs.set(Input::Temperature as usize, scene.input_start(Input::Temperature));
        inputs.set(Input::U as usize, u);
        inputs.set(Input::Load as usize, scene.first_load());
        inputs.set(Input::Pull as usize, scene.first_pull());
        if let Some(phase) = scene.excitation.first().filter(|_| given == MasterInputs::Rates) {
            set_rates(&mut inputs, &phase.motion(scene.layer.area()), 0.0);
        }
        let mut simulation = Simulation::new(scene, &layer_start(scene, &inputs, 0.0))?;
        let mut recorder = TraceRecorder::new(scene);
        recorder.row(&simulation.snapshot());
        let carrier = InputSample { u, ..InputSample::default() };
        Ok(Self { scene, given, inputs, simulation, last: None, recorder, carrier })
    }

    /// Does the communication step between two times (s) of the `motion` that began at `start`.
    fn step(&mut self, motion: &Motion, start: InputSample, from: f64, to: f64) -> Result<(), DriveError> {
        // A force jumps at the start of a phase.
        let at_start = if from == 0.0 { start.after(motion, 0.0) } else { self.carrier };
        for input in Input::MECHANICAL {
            self.inputs.set(input as usize, at_start.input(input));
        }
        if self.given == MasterInputs::Rates {
            set_rates(&mut self.inputs, motion, from);
        }
        let step = CommunicationStep { time: self.carrier.time, h: to - from, extrapolation: self.scene.extrapolation };
        let scales = layer_scales(self.scene);
        if let Some((last, state)) = self.last.take()
            && let Some(corrected) = last.corrected(&self.inputs, &scales)
        {
            self.simulation.continue_from(&state).map_err(SimulationError::from)?;
            self.follow(&corrected, &last.step())?;
        }
        self.last = ProvisionalStep::new(&self.inputs, &step, &scales).map(|step| (step, self.simulation.state()));
        let inputs = self.inputs;
        self.follow(&inputs, &step)?;
        self.inputs.complete_step(step.h);
        self.recorder.row(&self.simulation.snapshot());
        self.carrier = start.after(motion, to);
        Ok(())
    }

    fn follow(&mut self, inputs: &Inputs, step: &CommunicationStep) -> Result<(), DriveError> {
        let motion = layer_motion(self.scene, inputs, self.simulation.driven(), step)?;
        Ok(self.simulation.advance(&motion)?)
    }
}

fn set_rates(inputs: &mut Inputs, motion: &Motion, s: f64) {
    inputs.set_rate(Input::U as usize, motion.u.at(s).speed);
    inputs.set_rate(Input::W as usize, motion.w.at(s).speed);
    inputs.set_rate(Input::Load as usize, motion.load.change.at(s).speed);
    inputs.set_rate(Input::Pull as usize, motion.pull.change.at(s).speed);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::run::follow;
    use crate::runner::Rows;

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
