//! Complex modulus: a sticking layer under a vibrating carrier.

use std::f64::consts::{PI, TAU};

use asperity::simulation::{Motion, Start};
use nalgebra::{Matrix3, Vector3};

use crate::common::near::assert_near;
use crate::common::scenes::{Law, SceneText};
use crate::physics::exact::run::{REST, Run, sine, steps};

const MASSES: usize = 3;
const PRESSED: f64 = 2.0e-5;
const SWING: f64 = 1.5e-6;

/// Relaxation times over four decades: at each of the frequencies tried others of them lose energy.
fn law() -> Law {
    Law::with_maxwell(2.0e3, 2.0e-3, &[(700.0, 1.0e-2), (900.0, 3.0e-4), (1.5e3, 2.0e-5), (800.0, 4.0e-6)])
}

/// μ > 0 without any force along x: every mass sticks for ever.
fn scene(relative: f64) -> SceneText {
    let layer = SceneText::new(MASSES, 1e-4, 1e-7).vertical(law());
    layer.coulomb(0.5).tolerances(relative, relative * PRESSED)
}

/// Least squares of `values` over a + b sin φ + c cos φ.
fn fit(phases: &[f64], values: &[f64]) -> Vector3<f64> {
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (phase, value) in phases.iter().zip(values) {
        let basis = Vector3::new(1.0, phase.sin(), phase.cos());
        normal += basis * basis.transpose();
        right += basis * *value;
    }
    normal.lu().solve(&right).unwrap()
}

/// What a run shows of the vertical links: |K*|, arg K*, the mean of F_z and the energy lost and put in per period.
struct Seen {
    stiffness: f64,
    angle: f64,
    mean: f64,
    lost: f64,
    put_in: f64,
}

/// Swings until nothing of the transient is left (e^-30 = 1e-13 of it), then fits four periods.
fn vibrate(frequency: f64, relative: f64) -> Seen {
    const PERIODS: usize = 4;
    let omega = TAU * frequency;
    let start = Start { w: -PRESSED, w_rate: omega * SWING, ..Start::default() };
    let mut run = Run::new(&scene(relative), start);
    let transient = (30.0 * 1.0e-2 * frequency).ceil() / frequency;
    let window = (transient, transient + PERIODS as f64 / frequency);
    let mut times = steps(window, 40 * PERIODS);
    times.push(window.1);
    let motion = Motion { duration: window.1, u: REST, w: sine(SWING, frequency), ..Motion::default() };
    let columns = run.sample(&motion, &times, &["F_z", "E_diss", "energy.input", "contact.sticking"]);
    assert!(columns[3].iter().all(|&count| count == MASSES as f64), "every mass sticks");
    let last = times.len() - 1;
    let phases: Vec<f64> = times.iter().map(|time| omega * (time - transient)).collect();
    let [mean, b, c] = fit(&phases[..last], &columns[0][..last]).into();
    let per_period = |column: usize| (columns[column][last] - columns[column][0]) / PERIODS as f64;
    let stiffness = b.hypot(c) / (MASSES as f64 * SWING);
    Seen { stiffness, angle: (-c).atan2(-b), mean, lost: per_period(1), put_in: per_period(2) }
}

/// With every mass sticking on a flat profile the vertical links stretch by e = -w. So w = -w_0 + â sin ωt gives, once
/// the transient has died, F_z = k c w_0 - k â |K*| sin(ωt + arg K*), and a period loses π k â² Im K*, which the
/// carrier puts in.
#[test]
fn a_swing_follows_the_complex_stiffness() {
    // The Maxwell elements alone are integrated; an error of 1e-9 a step, some 100 steps a memory long, stays below.
    const ALLOWED: f64 = 1e-7;
    for frequency in [1.0, 100.0, 1.0e3, 1.0e4] {
        let near = |what: &str, found, expected, allowed| {
            assert_near(&format!("{what} at {frequency} Hz"), found, expected, allowed);
        };
        let seen = vibrate(frequency, 1e-9);
        let (storage, loss) = law().complex_stiffness(TAU * frequency);
        let stiffness = storage.hypot(loss);
        let energy = MASSES as f64 * PI * SWING * SWING;
        near("|K*|", seen.stiffness, stiffness, ALLOWED * stiffness);
        near("arg K*", seen.angle, loss.atan2(storage), ALLOWED);
        let mean = MASSES as f64 * law().stiffness * PRESSED;
        near("mean F_z", seen.mean, mean, ALLOWED * mean);
        // The energies are differences of sums over the whole transient: 3000 periods at 10 kHz.
        near("energy lost", seen.lost, energy * loss, ALLOWED * energy * stiffness);
        near("energy put in", seen.put_in, energy * loss, ALLOWED * energy * stiffness);
    }
}

/// Without Maxwell elements nothing is left to integrate but the energies: the steps must see the carrier's sine all
/// the same. F_z = k (c (w_0 - â sin ωt) - d â ω cos ωt) at any time, and a period loses π k â² ωd.
#[test]
fn a_spring_and_a_damper_alone() {
    const FREQUENCY: f64 = 1.0e3;
    let law = Law::new(2.0e3, 2.0e-3);
    let (omega, duration) = (TAU * FREQUENCY, 100.0 / FREQUENCY);
    let mut run =
        Run::new(&scene(1e-9).vertical(&law), Start { w: -PRESSED, w_rate: omega * SWING, ..Start::default() });
    let times = [0.013_37, 0.05, 0.071_23, duration];
    let motion = Motion { duration, u: REST, w: sine(SWING, FREQUENCY), ..Motion::default() };
    let columns = run.sample(&motion, &times, &["F_z", "E_diss"]);
    let masses = MASSES as f64;
    for (time, force) in times.iter().zip(&columns[0]) {
        let (sin, cos) = (omega * time).sin_cos();
        let expected = masses * (law.stiffness * (PRESSED - SWING * sin) - law.damping * SWING * omega * cos);
        assert_near("F_z", *force, expected, 1e-7 * masses * law.stiffness * PRESSED);
    }
    let lost = 100.0 * masses * PI * SWING * SWING * omega * law.damping;
    assert_near("energy lost", columns[1][3], lost, 1e-6 * lost);
}

/// At the default tolerance too: there a step may err by 1e-6 of w_0, 1e-5 of the swing, and some five steps are a
/// memory long.
#[test]
fn at_the_default_tolerance() {
    let seen = vibrate(500.0, 1e-6);
    let (storage, loss) = law().complex_stiffness(TAU * 500.0);
    assert_near("|K*|", seen.stiffness, storage.hypot(loss), 5e-5 * storage.hypot(loss));
    assert_near("arg K*", seen.angle, loss.atan2(storage), 5e-5);
}
