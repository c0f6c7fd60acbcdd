//! Scenes as a report runs them.

use asperity::scene::{OutputGroup, Phase, Scene};

/// The scene with the output groups that a report needs and no others, so that all runs cost the same: none estimates
/// its error.
pub(super) fn watched(scene: &Scene) -> Scene {
    use OutputGroup::{Dissipation, Energy, Forces};
    Scene { outputs: vec![Forces, Dissipation, Energy], ..scene.clone() }
}

/// The scene with the estimate of the errors of F_x and F_z: a more accurate run beside each run.
pub(super) fn estimated(scene: &Scene) -> Scene {
    let mut scene = watched(scene);
    scene.outputs.push(OutputGroup::Solver);
    scene
}

/// The scene with phases of these durations (s), whatever F_z does: the same motion for all runs.
pub(super) fn with_durations(scene: &Scene, durations: &[f64]) -> Scene {
    let phases = scene.excitation.iter().zip(durations);
    let fixed =
        phases.map(|(phase, &duration)| Phase { duration, until_force: None, until_pressure: None, ..phase.clone() });
    Scene { excitation: fixed.collect(), ..scene.clone() }
}
