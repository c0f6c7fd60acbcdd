//! The scene that a sweep is of, and that of each of its points.

use asperity::element::OperatingPoint;
use asperity::scene::{Initial, LARGEST, OutputGroup, Path as Displacement, Phase, Scene};

/// The scene without what a sweep does not depend on, and with the outputs that it reads.
pub fn relevant(scene: Scene) -> Scene {
    use OutputGroup::{Contact, Dissipation, Energy, Forces, Friction};
    let outputs = vec![Forces, Dissipation, Friction, Contact, Energy];
    let mut scene = Scene { outputs, excitation: Vec::new(), description: None, ..scene };
    scene.layer.initial = Initial::Relaxed;
    scene
}

/// The scene of one point. `solver.reduce` depends on the speed and on the duration of its excitation: as steady motion
/// has no end, no Maxwell element becomes a spring.
pub(super) fn scene_at(scene: &Scene, point: &OperatingPoint) -> Scene {
    let mut scene = scene.with_temperature(point.temperature);
    let u = Displacement { rate: point.speed, ..Displacement::default() };
    scene.excitation = vec![Phase {
        duration: LARGEST,
        u,
        w: Displacement::default(),
        until_force: None,
        until_pressure: None,
        ..Phase::default()
    }];
    scene
}
