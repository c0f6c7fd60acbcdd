//! Masses in contact stay where the contact holds them, however many steps are taken.

use asperity::scene::{Path, Scene};
use asperity::simulation::{Motion, Simulation, Start};

use crate::common::runs::value;
use crate::physics::kernels::layer::{Layer, at_rate, link};

const SINE: &str = "surface = { kind = 'sinusoid', amplitude = 0.02, wavelength = 0.5 }";

fn rubber(surface: &str, friction: (f64, f64)) -> Layer {
    let links = [
        link(100.0, 1.0, &[(50.0, 0.1)]),
        link(50.0, 1.0, &[(20.0, 0.05)]),
        link(10.0, 0.1, &[]),
        link(10.0, 0.1, &[]),
    ];
    Layer {
        masses: 3,
        mass: 0.01,
        spacing: 0.2,
        clearance: 0.0,
        links,
        surface: surface.into(),
        friction: Some(friction),
        ..Layer::default()
    }
}

/// Pressed by 0.1 m.
fn pressed(scene: &Scene, u_rate: f64) -> Simulation {
    Simulation::new(scene, &Start { w: -0.1, u_rate, ..Start::default() }).unwrap()
}

/// 100 000 steps along a sinusoid, far away at their end: the height of every mass is the profile's at its position.
#[test]
fn slipping_masses_stay_on_the_profile() {
    let layer = rubber(SINE, (0.3, 0.0));
    let (scene, profile) = (layer.scene(), layer.model().profile);
    let mut simulation = pressed(&scene, 0.5);
    let motion = Motion { duration: 1e-3, u: at_rate(0.5), w: Path::default(), ..Motion::default() };
    let mut worst = 0.0_f64;
    for i in 0..100_000 {
        simulation.advance(&motion).unwrap();
        if i % 1000 == 999 {
            for mass in 1..=3 {
                let of = |field: &str| format!("element[{mass}].{field}");
                let x = value(&scene, &simulation.snapshot(), &of("x"));
                let z = value(&scene, &simulation.snapshot(), &of("z"));
                assert_eq!(value(&scene, &simulation.snapshot(), &of("mode")), 1.0);
                worst = worst.max((z - profile.evaluate(x).0).abs() / (0.25 * x * f64::EPSILON + 1e-17));
            }
        }
    }
    let steps = value(&scene, &simulation.snapshot(), "solver.steps");
    assert!(steps >= 1e5, "{steps}");
    // x near 50 m is rounded to ε x/2, and the profile is as steep as 0.25; z is put together from parts of 0.1 m.
    assert!(worst < 1.0, "{worst}");
}

/// Sticking masses stand still while the carrier swings along both axes through 20 000 communication steps and drags
/// on in between.
#[test]
fn sticking_masses_do_not_move() {
    let layer = rubber(SINE, (50.0, 0.0));
    let scene = layer.scene();
    let mut simulation = pressed(&scene, 0.0);
    let positions = |simulation: &mut Simulation| -> Vec<f64> {
        let names = (1..=3).flat_map(|mass| ["x", "z"].map(|field| format!("element[{mass}].{field}")));
        names.map(|name| value(&scene, &simulation.snapshot(), &name)).collect()
    };
    let first = positions(&mut simulation);
    let mut worst = 0.0_f64;
    for i in 0..20_000 {
        // One and a quarter periods, so that each motion ends elsewhere.
        let amplitude = if i % 2 == 0 { 1e-3 } else { -1e-3 };
        let rate = if i % 200 < 100 { 1e-2 } else { -1e-2 };
        let swing = Path { rate, amplitude, frequency: 1250.0 };
        simulation
            .advance(&Motion { duration: 1e-3, u: swing, w: Path { rate: 0.0, ..swing }, ..Motion::default() })
            .unwrap();
        if i % 100 == 99 {
            let now = positions(&mut simulation);
            worst = now.iter().zip(&first).map(|(a, b)| (a - b).abs()).fold(worst, f64::max);
        }
    }
    assert_eq!(value(&scene, &simulation.snapshot(), "contact.sticking"), 3.0);
    assert_eq!(value(&scene, &simulation.snapshot(), "solver.events"), 0.0);
    // x_i = X_i + (u + e): roundings of numbers of size 0.1 m.
    assert!(worst < 1e-15, "{worst:e}");
}

/// A carrier without horizontal links that leaves sticking masses behind, 2.8 m in 20 000 communication steps.
#[test]
fn sticking_masses_stay_behind() {
    let rubber = rubber(SINE, (50.0, 0.0));
    let layer = Layer { links: [rubber.links[0].clone(), None, None, None], ..rubber };
    let scene = layer.scene();
    let mut simulation = pressed(&scene, 0.0);
    let rate = std::f64::consts::SQRT_2;
    for _ in 0..20_000 {
        simulation
            .advance(&Motion { duration: 1e-4, u: at_rate(rate), w: Path::default(), ..Motion::default() })
            .unwrap();
    }
    let moved = value(&scene, &simulation.snapshot(), "element[1].x").abs();
    // x_i = X_i + (u + e): u and -e, 2.8 m each, are added up from the same parts and rounded alike, or nearly so.
    assert!(moved < 1e-13, "{moved:e}");
}
