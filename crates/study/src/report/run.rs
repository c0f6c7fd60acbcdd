//! One run of a scene for a report, along the excitation and within a budget.

use std::ops::ControlFlow;

use asperity::outputs::Snapshot;
use asperity::scene::Scene;
use asperity::simulation::SimulationError;
use cpu_time::ThreadTime;

use super::figures::CompletedRun;
use super::recorder::TraceRecorder;
use crate::robustness::{Budget, RunFailure};
use crate::runner::{InputSample, Rows, Runner};

/// No limit but the scene's own.
pub(super) const UNLIMITED: Budget = Budget(u64::MAX);

/// Runs `scene` along its excitation from the carrier at `u` (m); `tick` gets the fraction of the excitation that is
/// done.
pub(super) fn follow(
    scene: &Scene,
    rows: Rows,
    u: f64,
    budget: Budget,
    tick: &dyn Fn(f64) -> ControlFlow<()>,
) -> Result<CompletedRun, RunFailure> {
    let failed = |error: SimulationError| budget.failure(scene, &error);
    let duration = scene.duration();
    let mut recorder = TraceRecorder::new(scene);
    let mut runner = Runner::new(&budget.limit(scene), rows, u).map_err(failed)?;
    let clock = ThreadTime::now();
    runner.observe_now(|_, snapshot| recorder.row(snapshot));
    let mut durations = Vec::new();
    for phase in &scene.excitation {
        let observe = |carrier: InputSample, snapshot: &Snapshot<'_>| {
            recorder.row(snapshot);
            tick(carrier.time / duration)
        };
        durations.push(runner.run_phase(phase, observe).map_err(failed)?);
        recorder.end_phase();
        recorder.check(budget)?;
    }
    let warnings = runner.take_warnings();
    Ok(CompletedRun { warnings, ..recorder.finish(runner.simulation(), clock.elapsed().as_secs_f64(), durations) })
}
