//! The energy balance: E_in = Δ(T + V) + E_damper + E_maxwell + E_friction + E_impact holds exactly in the model, and
//! every channel is added up on its own, so what a run misses is its numerical error.

use asperity::simulation::{Motion, Start};

use crate::common::largest;
use crate::common::random::Random;
use crate::common::scenes::SceneText;
use crate::physics::exact::run::{Run, rate, sine, steps};

const CHANNELS: [&str; 5] =
    ["energy.residual", "energy.input", "E_diss", "dissipation.E_friction", "dissipation.E_impact"];

/// Six coupled masses over a random periodic profile of 2 µm a point, itself rough.
fn scene(friction: &str, relative: f64) -> SceneText {
    let mut random = Random::new(7);
    let points = 32;
    let x: Vec<f64> = (0..=points).map(|i| f64::from(i) * 2.0e-5).collect();
    let mut z: Vec<f64> = (0..=points).map(|_| random.between(-2.0e-6, 2.0e-6)).collect();
    z[points as usize] = z[0];
    let roughness: Vec<f64> = (0..6).map(|_| random.between(-1.0e-6, 1.0e-6)).collect();
    SceneText::new(6, 7e-5, 1e-7)
        .set("layer.clearance", 1e-6)
        .roughness(&roughness)
        .vertical((2.0e3, 4.0e-3, [(1.0e3, 1.0e-4), (500.0, 5.0e-6)]))
        .horizontal((1.0e3, 4.0e-3, [(600.0, 2.0e-5)]))
        .lateral_x((500.0, 2.0e-3))
        .lateral_z((300.0, 1.0e-3, [(200.0, 3.0e-5)]))
        .points(&x, &z, true)
        .with(friction)
        .tolerances(relative, relative * 6.0e-6)
}

/// Presses, slides and vibrates; what the balance misses at worst over the largest energy, and the last values of the
/// channels.
fn balance(friction: &str, relative: f64) -> (f64, Vec<f64>) {
    let mut run = Run::new(&scene(friction, relative), Start { u_rate: 0.1, w_rate: -0.02, ..Start::default() });
    let names = if friction.is_empty() { vec!["energy.residual", "energy.input", "E_diss"] } else { CHANNELS.to_vec() };
    let duration = 3.0e-4;
    let phases = [(rate(0.1), rate(-0.02)), (rate(0.3), sine(3.0e-6, 8.0e3)), (sine(2.0e-5, 3.0e3), rate(0.005))];
    let (mut worst, mut size, mut last) = (0.0_f64, 0.0_f64, Vec::new());
    for (u, w) in phases {
        let mut times = steps((0.0, duration), 60);
        times.push(duration);
        let columns = run.sample(&Motion { duration, u, w, ..Motion::default() }, &times, &names);
        worst = worst.max(largest(&columns[0]));
        size = size.max(largest(&columns[1])).max(largest(&columns[2]));
        last = columns.iter().map(|column| column[60]).collect();
    }
    assert!(run.get("dissipation.E_impact") > 0.0, "masses strike the profile");
    assert!(run.events().len() > 20, "masses come and go");
    (worst / size, last)
}

/// Steps with an error of the tolerance each, some thousand of them between events that they all pass on.
#[test]
fn the_balance_closes_with_the_tolerance() {
    let both = "friction = { coulomb = 0.2, shear_force = 1e-3 }";
    for friction in ["", "friction.coulomb = 0.4", "friction.shear_force = 2e-3", both] {
        let (coarse, _) = balance(friction, 1e-6);
        let (fine, last) = balance(friction, 1e-9);
        assert!(coarse <= 1e-4, "{friction}: at 1e-6 the balance misses {coarse:e}");
        assert!(fine <= 1e-7, "{friction}: at 1e-9 the balance misses {fine:e}");
        assert!(fine <= 0.02 * coarse, "{friction}: from {coarse:e} only to {fine:e}");
        assert!(friction.is_empty() || last[3] > 0.01 * last[2], "{friction} takes its share: {last:?}");
    }
}

/// An element that starts undeformed has the energy ½ c_j e² and loses it in some τ_j, of which a step sees nothing if
/// τ_j is far shorter.
#[test]
fn what_a_fast_element_loses_within_a_step_is_counted() {
    let (c, e, relative) = (1.0e3, 1.0e-5, 1.0e-4);
    for tau in [1.0e-10, 1.0e-8, 3.0e-8, 1.0e-7, 1.0e-6] {
        let scene = SceneText::new(1, 1e-4, 1e-7)
            .set("layer.initial", "undeformed")
            .vertical((2.0e4, 1.0e-3, [(c, tau)]))
            .tolerances(relative, 1.0e-6 * relative);
        let mut run = Run::new(&scene, Start { w: -e, ..Start::default() });
        run.drive(1.0e-4, rate(0.0), rate(0.0));
        let (lost, stored) = (run.get("dissipation.E_maxwell"), 0.5 * c * e * e);
        // The force is good to the tolerance of the whole spring's, twenty-one times the element's: so is what it lost.
        assert!((lost - stored).abs() <= 21.0 * relative * stored, "τ = {tau:e}: {lost:e} J of {stored:e} J");
    }
}

/// Eight masses are pressed fast onto `surface` and slid over it at `speed` (m/s), with dampers `horizontal` and
/// `lateral_z` (N s/m): the residual is at most ten times the relative tolerance of the largest energy, and no energy
/// lost comes back.
fn check_extreme(method: &str, friction: &str, horizontal: f64, lateral_z: f64, surface: &str, speed: f64) {
    let scene = SceneText::new(8, 1e-4, 1e-7)
        .vertical((2.0e3, 8.0e-3, [(1.0e3, 1.0e-4)]))
        .horizontal((1.0e3, horizontal))
        .lateral_x((500.0, 2.0e-3))
        .lateral_z((500.0, lateral_z))
        .with(surface)
        .with(friction)
        .method(method)
        .relative(1e-6);
    let mut run = Run::new(&scene, Start { w_rate: -0.1, ..Start::default() });
    let (mut worst, mut size, mut falls) = (0.0_f64, 0.0_f64, 0.0_f64);
    for (duration, u, w) in [(2.0e-4, rate(0.0), rate(-0.1)), (6.0e-5 / speed, rate(speed), rate(0.0))] {
        let columns =
            run.sample(&Motion { duration, u, w, ..Motion::default() }, &steps((0.0, duration), 40), &CHANNELS);
        worst = worst.max(largest(&columns[0])).max(run.get("energy.residual").abs());
        size = size.max(largest(&columns[1])).max(largest(&columns[2]));
        let lost = columns[2..].iter().flat_map(|channel| channel.windows(2));
        falls = lost.map(|pair| pair[0] - pair[1]).fold(falls, f64::max);
    }
    let case = format!("{method}, {friction}, {horizontal:e}, {lateral_z:e}, {surface}, {speed} m/s");
    assert!(worst <= 1e-5 * size, "{case}: the balance misses {worst:e} J of {size:e} J");
    assert!(falls <= 1e-6 * size, "{case}: {falls:e} J of {size:e} J come back");
}

const WAVES: &str = "surface = { kind = 'sinusoid', amplitude = 5e-6, wavelength = 2.3e-4 }";

/// The friction stops a mass within a ten-millionth of a step.
#[test]
fn with_a_friction_beyond_all_other_forces() {
    for method in ["step", "event"] {
        for friction in ["shear_force = 1e3", "shear_force = 1e9", "coulomb = 10.0, shear_force = 1e3"] {
            check_extreme(method, &format!("friction = {{ {friction} }}"), 8.0e-3, 2.0e-3, WAVES, 0.2);
        }
    }
}

/// Dampers a million times critical bring masses together within a hundred-thousandth of a step.
#[test]
fn with_dampers_far_beyond_critical() {
    check_extreme("step", "friction.coulomb = 0.3", 3.0e4, 2.0e-3, WAVES, 0.2);
    check_extreme("step", "friction.coulomb = 0.3", 8.0e-3, 3.0e4, WAVES, 0.2);
}

/// The profile bends far between a touch and the end of its step.
#[test]
fn where_a_mass_strikes_a_bend() {
    let spike = "surface = { kind = 'points', x = [0.0, 1e-4, 1.9e-4, 2e-4, 2.1e-4, 3e-4, 5e-4, 1e-3], \
                 z = [0.0, 0.0, 0.0, 2e-5, 0.0, 0.0, 0.0, 0.0] }";
    check_extreme("step", "friction.coulomb = 0.3", 8.0e-3, 2.0e-3, spike, 0.2);
    check_extreme("step", "friction.coulomb = 0.3", 8.0e-3, 2.0e-3, WAVES, 100.0);
}
