//! Full slip on a flat profile.

use asperity::simulation::Start;

use crate::run::{Law, REST, Run, assert_near, link, rate, solver};

const MASSES: f64 = 5.0;
const FRICTION: f64 = 0.3;
const SHEAR: f64 = 1.0e-3;

/// Five masses of different heights, so pressed with different forces, all links with damping.
fn scene() -> String {
    let links = link("vertical", &Law::with_maxwell(2.0e3, 4.0e-3, &[(1.0e3, 1.0e-4)]))
        + &link("horizontal", &Law::with_maxwell(1.0e3, 8.0e-3, &[(600.0, 2.0e-5)]))
        + &link("lateral_x", &Law::with_maxwell(500.0, 2.0e-3, &[(400.0, 3.0e-5)]))
        + &link("lateral_z", &Law::new(300.0, 1.0e-3));
    let solver = solver(1e-9, 1e-14);
    format!(
        "[layer]\nmasses = 5\nspacing = 1e-4\nmass = 1e-7\n\
         roughness = {{ kind = \"points\", z = [0.0, -2e-6, 1e-6, 3e-6, -4e-6] }}\n{links}\
         [surface]\nkind = \"flat\"\n[friction]\ncoulomb = {FRICTION:?}\nshear_force = {SHEAR:?}\n{solver}"
    )
}

/// At a steady speed all masses slip at it, no damper moves and no dashpot yields: each mass is dragged by μ F_N + A
/// τ_0 alone, so F_x = ∓(μ F_z + k A τ_0), all of it adhesion, and the carrier's power |F_x| v goes into friction.
fn slides(v: f64) {
    // 3 ms are 30 of the longest relaxation time, 1e-4 s, and the chain's swings die in 2 m/d = 25 µs.
    let mut run = Run::new(&scene(), Start { w: -2.0e-5, u_rate: v, ..Start::default() });
    run.drive(3.0e-3, rate(v), REST);
    let force = run.get("F_z");
    let drag = FRICTION * force + MASSES * SHEAR;
    // At rest against the carrier nothing is left to integrate: rounding alone.
    let allowed = 1e-12 * drag;
    assert_near("F_x", run.get("F_x"), -drag.copysign(v), allowed);
    assert_near("contact.F_x", run.get("contact.F_x"), -drag.copysign(v), allowed);
    assert_near("F_adhesion", run.get("friction.F_adhesion"), -drag.copysign(v), allowed);
    assert_eq!(run.get("friction.F_hysteresis"), 0.0, "no slope, no hysteresis");
    assert_near("coefficient", run.get("friction.coefficient"), drag / force, 1e-12);
    // Dampers and dashpots lose with the square of what is left of the swings.
    assert_near("P_diss", run.get("P_diss"), drag * v.abs(), 1e-11 * drag * v.abs());
    assert_near("contact.F_z", run.get("contact.F_z"), force, 1e-12 * force);
    assert_eq!(run.get("contact.sticking"), 0.0);
    assert!((1..=5).all(|i| run.mode(i) == v.signum()), "all slip with the carrier");
}

#[test]
fn forwards() {
    slides(0.1);
}

#[test]
fn backwards() {
    slides(-0.02);
}

/// F_z of k masses held down by springs alone: k c w_0 less what the roughness takes, c Σ -h_i; lateral links cancel.
#[test]
fn normal_force_of_a_rough_layer() {
    let mut run = Run::new(&scene(), Start { w: -2.0e-5, ..Start::default() });
    let expected = 2.0e3 * (5.0 * 2.0e-5 - (0.0 - 2e-6 + 1e-6 + 3e-6 - 4e-6));
    assert_near("F_z", run.get("F_z"), expected, 1e-12 * expected);
}
