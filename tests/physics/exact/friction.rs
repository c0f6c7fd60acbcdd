//! Friction on the flat: stop, reverse, stick and break of one mass, and a layer in full slip.

use std::f64::consts::{FRAC_PI_2, PI};

use asperity::simulation::{ModeChange, Start};

use crate::common::near::assert_near;
use crate::common::scenes::{Law, SceneText};
use crate::physics::exact::run::{REST, Run, rate, sine, uneven_layer};

const MASS: f64 = 1.0e-7;
const STIFFNESS: f64 = 2.0e3;
const PRESSED: f64 = 1.0e-5;
const COULOMB: f64 = 0.3;
const SHEAR: f64 = 2.0e-3;
/// T = μ F_N + A τ_0 with F_N = c w_0.
const LIMIT: f64 = COULOMB * STIFFNESS * PRESSED + SHEAR;

/// Events lie where a limit is passed by some hundredth of the absolute tolerance, 1e-14 m, and the steps before them
/// err by the tolerances, 1e-9: of times of 1e-5 to 1e-3 s, a millionth of a microsecond.
const TIME: f64 = 1.0e-12;

/// Of energies and positions: ten times the relative tolerance.
const SHARE: f64 = 1.0e-8;

fn one_mass(horizontal: &Law) -> SceneText {
    SceneText::new(1, 1e-4, MASS).vertical(STIFFNESS).horizontal(horizontal).coulomb(COULOMB)
}

/// A mass pressed on the flat, under a link to the carrier along x.
fn pressed(horizontal: &Law, u_rate: f64) -> Run {
    let scene = one_mass(horizontal).set("friction.shear_force", SHEAR).tolerances(1e-9, 1e-14);
    Run::new(&scene, Start { w: -PRESSED, u_rate, ..Start::default() })
}

/// Pulled slowly by a spring, a mass breaks loose at T whatever force the tolerance of its position is: here 2 mN.
#[test]
fn a_coarse_tolerance_of_positions_holds_no_mass() {
    let relative = 1e-3;
    let scene = one_mass(&STIFFNESS.into()).tolerances(relative, 1e-5);
    let mut run = Run::new(&scene, Start { w: -PRESSED, ..Start::default() });
    let (limit, speed) = (COULOMB * STIFFNESS * PRESSED, 1e-3);
    run.drive(2.0 * limit / (STIFFNESS * speed), rate(speed), REST);
    let broke = run.events()[0].time * speed * STIFFNESS;
    // An event lies where the limit is passed by half of its tolerance, a share of F_N.
    assert_near("break", broke, limit, relative * limit / COULOMB);
}

fn sequence(events: &[ModeChange]) -> Vec<(i8, i8)> {
    events.iter().map(|event| (event.from, event.to)).collect()
}

/// Without a link along x a mass thrown with U slides with -T/m to rest: U m/T long, U² m/2T far, and ½ m U² is lost to
/// friction. Nothing pulls, so it sticks.
#[test]
fn a_thrown_mass_slides_to_rest() {
    for speed in [0.2, -0.2_f64] {
        let mut run = pressed(&Law::default(), speed);
        assert_near("F_T", run.get("element[1].F_T"), LIMIT.copysign(speed), 1e-12 * LIMIT);
        run.drive(1.0e-4, REST, REST);
        let events = run.events();
        assert_eq!(sequence(&events), [(speed.signum() as i8, 2)]);
        assert_near("stop", events[0].time, speed.abs() * MASS / LIMIT, TIME);
        let way = speed * speed * MASS / (2.0 * LIMIT);
        assert_near("way", run.get("element[1].x"), way.copysign(speed), SHARE * way);
        let energy = 0.5 * MASS * speed * speed;
        assert_near("friction", run.get("dissipation.E_friction"), energy, SHARE * energy);
        assert_eq!(run.get("energy.kinetic"), 0.0);
        assert_eq!(run.get("element[1].F_T"), 0.0, "a mass that nothing pulls is held by nothing");
    }
}

/// Held by a spring to a carrier that swings by more than T/c_x, a mass that its damper keeps from ringing breaks loose
/// and sticks again twice a period, in the first perhaps once: no swing is leapt over, though nothing but the carrier
/// moves while the mass sticks.
#[test]
fn a_swinging_carrier_breaks_a_mass_loose_twice_a_period() {
    const PERIODS: usize = 200;
    let mut run = pressed(&Law::new(STIFFNESS, 3.0e-2), 0.0);
    run.drive(PERIODS as f64 / 1.0e3, sine(1.5 * LIMIT / STIFFNESS, 1.0e3), REST);
    let broken = run.events().iter().filter(|event| event.from == 2).count();
    assert!((2 * PERIODS - 1..=2 * PERIODS).contains(&broken), "{broken}");
}

/// On a spring c_x with dry friction a thrown mass swings about ∓D, D = T/c_x: first along ẋ > 0 about -D with the
/// radius R = √(D² + (U/ω)²), to R - D, then to and fro, each time π/ω long and 2D less far, until a turning point
/// within D holds it.
fn swings(speed: f64, turns: usize) {
    let stiffness = 1.0e3;
    let omega = (stiffness / MASS).sqrt();
    let shift = LIMIT / stiffness;
    let radius = shift.hypot(speed / omega);
    let first = (FRAC_PI_2 - (shift / radius).asin()) / omega;
    let reach = |turn: usize| radius - shift - 2.0 * shift * turn as f64;
    let last = (0..).find(|&turn| reach(turn) <= shift).unwrap();
    assert_eq!(last, turns, "the case is what it should be");
    let mut run = pressed(&Law::new(stiffness, 0.0), speed);
    run.drive(first + PI / omega * (last as f64 + 1.0), REST, REST);
    let events = run.events();
    let direction = |turn: usize| if turn.is_multiple_of(2) { 1 } else { -1 };
    let mut expected: Vec<(i8, i8)> = (0..last).map(|turn| (direction(turn), direction(turn + 1))).collect();
    expected.push((direction(last), 2));
    assert_eq!(sequence(&events), expected);
    for (turn, event) in events.iter().enumerate() {
        assert_near(&format!("turn {turn}"), event.time, first + PI / omega * turn as f64, 10.0 * TIME);
    }
    let x = reach(last) * f64::from(direction(last));
    assert_near("where it stays", run.get("element[1].x"), x, SHARE * radius);
    // What holds it is what the spring pulls: against +t where it is drawn back.
    assert_near("F_T", run.get("element[1].F_T"), -stiffness * x, SHARE * stiffness * radius);
}

#[test]
fn a_swinging_mass_reverses_until_it_stops_within_reach() {
    for (speed, turns) in [(0.5, 0), (2.0, 1), (7.0, 4)] {
        swings(speed, turns);
    }
}

/// A sticking mass is pulled by f·t = c_x U t + d_x U; it breaks loose where that passes T, in its direction.
#[test]
fn a_pulled_mass_breaks_loose() {
    let horizontal = Law::new(1.0e3, 2.0e-2);
    for speed in [0.1, -0.1_f64] {
        let mut run = pressed(&horizontal, 0.0);
        assert_eq!(run.mode(1), 2.0);
        run.drive(1.0e-5, rate(speed), REST);
        let pull = horizontal.stiffness * speed * 1.0e-5 + horizontal.damping * speed;
        assert_near("F_T", run.get("element[1].F_T"), pull, 1e-12 * LIMIT);
        assert_near("F_x", run.get("F_x"), -pull, 1e-12 * LIMIT);
        run.drive(8.0e-5, rate(speed), REST);
        let events = run.events();
        assert_eq!(sequence(&events)[0], (2, speed.signum() as i8));
        let broken = (LIMIT - horizontal.damping * speed.abs()) / (horizontal.stiffness * speed.abs());
        assert_near("break", events[0].time, broken, TIME);
        assert_near("F_T", run.get("element[1].F_T"), LIMIT.copysign(speed), 1e-12 * LIMIT);
    }
}

/// At a kink the damper's force jumps: d_x U > T breaks the mass loose at the kink itself, and d_x U < T does not.
#[test]
fn a_kink_breaks_a_sticking_mass_loose() {
    let damping = 2.0e-2;
    let kink = 1.0e-5;
    for (share, moves) in [(1.01, true), (0.99, false)] {
        for sign in [1.0, -1.0] {
            let mut run = pressed(&Law::new(0.0, damping), 0.0);
            run.drive(kink, REST, REST);
            let u = rate(sign * share * LIMIT / damping);
            // At the kink, before any time passes.
            run.drive(0.0, u, REST);
            assert_eq!(run.mode(1), if moves { sign } else { 2.0 });
            run.drive(1.0e-6, u, REST);
            let events = run.events();
            assert_eq!(events.len(), usize::from(moves), "{events:?}");
            if moves {
                assert_eq!((events[0].time, events[0].to), (kink, sign as i8));
            }
        }
    }
}

/// A sticking mass breaks loose too when the carrier's lifting takes the force that holds it: f·t = c_x u_0 passes
/// T = μ c (w_0 - V t) + A τ_0.
#[test]
fn a_relieved_mass_breaks_loose() {
    let (stiffness, drawn, speed) = (1.0e3, 4.0e-6, 0.05);
    let mut run = pressed(&Law::new(stiffness, 0.0), 0.0);
    run.drive(1.0e-5, rate(drawn / 1.0e-5), REST);
    run.drive(1.5e-4, REST, rate(speed));
    let events = run.events();
    let broken = 1.0e-5 + (LIMIT - stiffness * drawn) / (COULOMB * STIFFNESS * speed);
    assert_eq!(sequence(&events)[0], (2, 1));
    assert_near("break", events[0].time, broken, TIME);
}

/// Number of masses of the layer.
const MASSES: f64 = 5.0;
/// A τ_0 of its masses.
const LAYER_SHEAR: f64 = 1.0e-3;

fn layer() -> SceneText {
    uneven_layer().coulomb(COULOMB).set("friction.shear_force", LAYER_SHEAR).tolerances(1e-9, 1e-14)
}

/// At a steady speed all masses slip at it, no damper moves and no dashpot yields: each mass is dragged by μ F_N + A
/// τ_0 alone, so F_x = ∓(μ F_z + k A τ_0), all of it adhesion, and the carrier's power |F_x| v goes into friction.
fn slides(v: f64) {
    // 3 ms are 30 of the longest relaxation time, 1e-4 s, and the chain's swings die in 2 m/d = 25 µs.
    let mut run = Run::new(&layer(), Start { w: -2.0e-5, u_rate: v, ..Start::default() });
    run.drive(3.0e-3, rate(v), REST);
    let force = run.get("F_z");
    let drag = COULOMB * force + MASSES * LAYER_SHEAR;
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
fn a_layer_slides_forwards() {
    slides(0.1);
}

#[test]
fn a_layer_slides_backwards() {
    slides(-0.02);
}

/// F_z of k masses held down by springs alone: k c w_0 less what the roughness takes, c Σ -h_i; lateral links cancel.
#[test]
fn normal_force_of_a_rough_layer() {
    let mut run = Run::new(&layer(), Start { w: -2.0e-5, ..Start::default() });
    let expected = 2.0e3 * (5.0 * 2.0e-5 - (0.0 - 2e-6 + 1e-6 + 3e-6 - 4e-6));
    assert_near("F_z", run.get("F_z"), expected, 1e-12 * expected);
}
