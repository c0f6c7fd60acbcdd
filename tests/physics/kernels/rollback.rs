//! Failed calls leave the same bits.

use asperity::scene::{Path, Scene};
use asperity::simulation::{Motion, Simulation, SimulationError, Start};

use crate::common::runs::bits;
use crate::physics::kernels::layer::{Layer, at_rate, link};

/// Two masses that rattle over a sinusoid: impacts, lifts, stops and breaks in milliseconds.
fn rattling(max_steps: u32) -> Scene {
    let links = [
        link(1000.0, 0.002, &[(500.0, 1e-4)]),
        link(2000.0, 0.008, &[(300.0, 1e-3), (200.0, 1e-5)]),
        link(300.0, 0.001, &[]),
        link(200.0, 0.001, &[(50.0, 1e-4)]),
    ];
    let layer = Layer {
        masses: 2,
        mass: 2e-7,
        spacing: 1.7e-4,
        clearance: 1e-6,
        links,
        surface: "surface = { kind = 'sinusoid', amplitude = 1e-5, wavelength = 5e-4 }".into(),
        friction: Some((0.2, 1e-4)),
        rate_shear: None,
        solver: format!("solver.max_steps = {max_steps}"),
    };
    layer.scene()
}

fn start(scene: &Scene) -> Simulation {
    let mut simulation = Simulation::new(scene, &Start { w_rate: -0.04, ..Start::default() }).unwrap();
    simulation.record_mode_changes(true);
    simulation
}

const PRESS: Motion = Motion {
    duration: 2e-4,
    u: Path { rate: 0.0, amplitude: 0.0, frequency: 0.0 },
    w: Path { rate: -0.04, amplitude: 0.0, frequency: 0.0 },
    ..Motion::REST
};
const DRAG: Motion = Motion {
    duration: 1e-4,
    u: Path { rate: 4.0, amplitude: 1e-4, frequency: 3000.0 },
    w: Path { rate: 0.0, amplitude: 0.0, frequency: 0.0 },
    ..Motion::REST
};

/// Whether a failed call leaves `simulation` as `before` was, now and from then on.
fn check_untouched(scene: &Scene, mut simulation: Simulation, mut before: Simulation, motion: &Motion) {
    assert_eq!(simulation.time().to_bits(), before.time().to_bits());
    assert_eq!(simulation.carrier(), before.carrier());
    assert_eq!(bits(scene, &simulation.snapshot()), bits(scene, &before.snapshot()));
    for _ in 0..50 {
        assert_eq!(simulation.advance(motion), before.advance(motion));
        assert_eq!(bits(scene, &simulation.snapshot()), bits(scene, &before.snapshot()));
    }
    assert_eq!(simulation.take_mode_changes(), before.take_mode_changes());
}

/// A run whose steps are used up halfway through a motion stands where it stood before, and goes on from there as if it
/// had not been asked.
#[test]
fn a_motion_that_takes_too_many_steps_leaves_no_trace() {
    for limit in [1, 2, 7, 30] {
        let scene = rattling(limit);
        let mut simulation = start(&scene);
        let short = Motion { duration: 1e-8, ..PRESS };
        (0..3).for_each(|_| simulation.advance(&short).unwrap());
        let before = simulation.clone();
        let error = simulation.advance(&Motion { duration: 1e-2, ..DRAG }).unwrap_err();
        assert!(matches!(error, SimulationError::TooManySteps { steps, .. } if steps == u64::from(limit)), "{error}");
        check_untouched(&scene, simulation, before, &short);
    }
}

/// The same from amid the rattle, where the failed motion has changed modes, energies and counters.
#[test]
fn a_failure_amid_the_rattle_leaves_no_trace() {
    let scene = rattling(60);
    let mut simulation = start(&scene);
    let short = |motion: Motion| Motion { duration: 2e-6, ..motion };
    (0..100).for_each(|_| simulation.advance(&short(PRESS)).unwrap());
    (0..100).for_each(|_| simulation.advance(&short(DRAG)).unwrap());
    let before = simulation.clone();
    assert!(simulation.advance(&Motion { duration: 1e-2, ..DRAG }).is_err());
    check_untouched(&scene, simulation, before, &short(DRAG));
}

/// A motion that is not finite is refused before anything is done.
#[test]
fn a_motion_that_is_not_finite_leaves_no_trace() {
    let scene = rattling(1_000_000);
    let mut simulation = start(&scene);
    simulation.advance(&PRESS).unwrap();
    let before = simulation.clone();
    let motions = [
        Motion { duration: f64::NAN, ..DRAG },
        Motion { u: at_rate(f64::INFINITY), ..DRAG },
        Motion { w: Path { amplitude: f64::NAN, ..DRAG.u }, ..DRAG },
        Motion { w: Path { frequency: f64::NEG_INFINITY, ..DRAG.u }, ..DRAG },
    ];
    for motion in motions {
        let error = simulation.advance(&motion).unwrap_err();
        assert!(matches!(error, SimulationError::OutOfRange { .. }), "{error}");
    }
    check_untouched(&scene, simulation, before, &Motion { duration: 1e-5, ..DRAG });
}
