//! How a run starts: where the masses are put, how they move, which of them stick; and a layer laid on a cosine, in
//! partial contact from the start.

use std::f64::consts::{FRAC_1_PI, TAU};

use asperity::simulation::Start;

use crate::common::near::assert_near;
use crate::common::scenes::{Law, SceneText};
use crate::physics::exact::run::{REST, Run, rate};

const MASS: f64 = 1.0e-7;
const STIFFNESS: f64 = 2.0e3;

/// One mass under a vertical link over the flat.
fn one(vertical: impl Into<Law>) -> SceneText {
    SceneText::new(1, 1e-4, MASS).vertical(vertical).tolerances(1e-9, 1e-15)
}

/// One on a spring over a straight slope.
fn on_slope(slope: f64) -> SceneText {
    one(STIFFNESS).points(&[-1e-2, 1e-2], &[-1e-2 * slope, 1e-2 * slope], false)
}

/// A mass under the profile is lifted vertically onto it and keeps v_t = (U + sW)/q along t; what it had along n counts
/// nowhere: no energy is lost and the balance begins at 0.
#[test]
fn a_lifted_mass_keeps_its_tangential_velocity() {
    for (slope, u_rate, w_rate) in [(0.0, 0.03, -0.05), (0.5, 0.03, -0.05), (0.5, -0.03, -0.05), (-0.8, 0.1, 0.02)] {
        let scene = on_slope(slope).coulomb(0.3);
        let mut run = Run::new(&scene, Start { u: 1e-3, w: 1e-3 * slope - 1e-5, u_rate, w_rate, ..Start::default() });
        let v_t = (u_rate + slope * w_rate) / slope.hypot(1.0);
        let energy = 0.5 * MASS * v_t * v_t;
        assert_near("T", run.get("energy.kinetic"), energy, 1e-14 * energy);
        assert_eq!(run.mode(1), v_t.signum());
        assert_eq!([run.get("E_diss"), run.get("energy.residual")], [0.0, 0.0]);
        assert_eq!(run.get("element[1].x"), 1e-3);
        assert_near("z", run.get("element[1].z"), 1e-3 * slope, 1e-17);
        assert_near("F_z", run.get("F_z"), STIFFNESS * 1e-5, 1e-12 * STIFFNESS * 1e-5);
    }
}

/// At v_t = 0 the rule for a stop decides: on a slope s the spring alone pulls with F s/q against F_N = F/q, so the
/// mass sticks for μ ≥ |s| and slips downhill below.
#[test]
fn at_rest_the_slope_decides_between_stick_and_slip() {
    for slope in [0.5, -0.5_f64] {
        for (friction, mode) in [(0.5 + 1e-9, 2.0), (0.5 - 1e-9, -slope.signum())] {
            // Rates along n: U = -sW leaves v_t = 0.
            let start = Start { w: -1e-5, u_rate: 0.04 * slope, w_rate: -0.04, ..Start::default() };
            let mut run = Run::new(&on_slope(slope).coulomb(friction), start);
            assert_eq!(run.mode(1), mode, "μ = {friction}, s = {slope}");
            assert_eq!(run.get("energy.kinetic"), 0.0);
        }
    }
}

/// A τ_0 adds to μ F_N: F s/q ≤ μ F/q + A τ_0.
#[test]
fn at_rest_adhesion_holds_on_a_steep_slope() {
    let (slope, force) = (0.8_f64, STIFFNESS * 1e-5);
    let needed = (slope - 0.3) * force / slope.hypot(1.0);
    for (share, mode) in [(1.0 + 1e-9, 2.0), (1.0 - 1e-9, -1.0)] {
        let scene = on_slope(slope).coulomb(0.3).set("friction.shear_force", share * needed);
        let mut run = Run::new(&scene, Start { w: -1e-5, ..Start::default() });
        assert_eq!(run.mode(1), mode);
    }
}

/// With no friction in the scene there is no stick: a contact at v_t = 0 just goes on.
#[test]
fn without_friction_nothing_sticks() {
    let mut run = Run::new(&one(STIFFNESS), Start { w: -1e-5, ..Start::default() });
    assert_eq!([run.get("contact.count"), run.get("contact.sticking")], [1.0, 0.0]);
    run.drive(1e-5, REST, REST);
    assert_eq!([run.get("contact.count"), run.get("contact.sticking")], [1.0, 0.0]);
    assert_eq!(run.events(), []);
}

/// A lifted mass with F_N = c w_0 - d W < 0, drawn up by its damper, is free, and keeps its velocity along t.
#[test]
fn a_lifted_mass_that_its_damper_draws_up_is_free() {
    let damping = 2.0e-2;
    let limit = STIFFNESS * 1e-5 / damping;
    for (share, count) in [(1.0 + 1e-9, 0.0), (1.0 - 1e-9, 1.0)] {
        let start = Start { w: -1e-5, u_rate: 0.03, w_rate: share * limit, ..Start::default() };
        let mut run = Run::new(&one((STIFFNESS, damping)), start);
        assert_eq!(run.get("contact.count"), count);
        assert_near("T", run.get("energy.kinetic"), 0.5 * MASS * 0.03 * 0.03, 1e-20);
        assert_eq!(run.get("element[1].z"), 0.0);
    }
}

/// On the profile and moving away from it, a mass is free; so it is where it only rests there, F_N = 0.
#[test]
fn a_mass_on_the_profile_that_nothing_presses_is_free() {
    for w_rate in [0.05, 0.0] {
        let mut run = Run::new(&one(STIFFNESS), Start { w_rate, u_rate: 0.02, ..Start::default() });
        assert_eq!(run.get("contact.count"), 0.0, "ẇ = {w_rate}");
        run.drive(1e-5, rate(0.02), rate(w_rate));
        assert_eq!([run.get("contact.count"), run.get("dissipation.E_impact")], [0.0, 0.0]);
    }
}

/// Gliding along the profile with κ > 0, a mass is pressed by F_N = m κ U², and so in contact; with κ < 0 it takes off.
/// The natural spline through (-h, b), (0, 0), (h, b) has s = 0 and κ = 3b/h² at 0, and so it has in floating point
/// where b and h are powers of two: g = 0 and v_n = 0 to the last digit.
#[test]
fn a_mass_gliding_through_a_trough_is_in_contact() {
    let (h, b, speed) = (2.0_f64.powi(-10), 2.0_f64.powi(-20), 0.5);
    for (sign, count) in [(1.0, 1.0), (-1.0, 0.0)] {
        let scene = one(STIFFNESS).points(&[-h, 0.0, h], &[sign * b, 0.0, sign * b], false);
        let mut run = Run::new(&scene, Start { u_rate: speed, ..Start::default() });
        assert_eq!(run.get("contact.count"), count);
        let force = count * MASS * 3.0 * b / (h * h) * speed * speed;
        assert_near("F_N", run.get("element[1].F_N"), force, 1e-14 * force);
    }
}

/// On the profile and moving into it, a mass has its impact just after the start: the outputs at the start show it
/// before, free and moving with the carrier.
#[test]
fn the_impact_of_a_mass_on_the_profile_comes_just_after_the_start() {
    let (u_rate, w_rate) = (0.03, -0.05);
    let scene = one(STIFFNESS).coulomb(0.3);
    let mut run = Run::new(&scene, Start { time: 2.0, u_rate, w_rate, ..Start::default() });
    let before = 0.5 * MASS * (u_rate * u_rate + w_rate * w_rate);
    let after = 0.5 * MASS * (0.03_f64 - 0.3 * 0.05).powi(2);
    assert_eq!([run.mode(1), run.get("E_diss"), run.get("F_z")], [0.0, 0.0, 0.0]);
    assert_near("T before", run.get("energy.kinetic"), before, 1e-14 * before);
    run.drive(1e-12, rate(u_rate), rate(w_rate));
    let events = run.events();
    assert_eq!((events.len(), events[0].time, events[0].from, events[0].to), (1, 2.0, 0, 1));
    // In 1e-12 s friction μ c V t takes nothing.
    assert_near("T after", run.get("energy.kinetic"), after, 1e-12 * after);
    assert_near("lost", run.get("dissipation.E_impact"), before - after, 1e-14 * before);
}

/// A mass that rests on the profile and is then pressed down comes into contact without an impact: F_z = c V t.
#[test]
fn a_resting_mass_is_pressed_down_without_an_impact() {
    let mut run = Run::new(&one(STIFFNESS).coulomb(0.3), Start::default());
    run.drive(1e-5, REST, REST);
    run.drive(1e-5, REST, rate(-0.05));
    assert_near("F_z", run.get("F_z"), STIFFNESS * 0.05 * 1e-5, 1e-9 * STIFFNESS * 0.05 * 1e-5);
    assert_eq!(run.mode(1), 2.0);
    // It falls some 1e-15 m until the touch is seen, over some 2e-8 s: at 1e-7 m/s and less, not at 5e-2.
    assert!(run.get("dissipation.E_impact") < 1e-11 * 0.5 * MASS * 0.05 * 0.05);
}

/// Relaxed dashpots, y_j = e_j, leave the springs c alone; undeformed ones, y_j = 0, add Σ c_j; and these forces then
/// relax to the same, each as e^{-t/τ_j}.
#[test]
fn dashpots_start_relaxed_or_undeformed() {
    let (pressed, elements, time) = (1.0e-5, [(800.0, 1.0e-4), (500.0, 1.0e-5)], 2.0e-5);
    let vertical = Law::with_maxwell(STIFFNESS, 0.0, &elements);
    for (initial, share) in [("relaxed", 0.0), ("undeformed", 1.0)] {
        let mut run =
            Run::new(&one(&vertical).set("layer.initial", initial), Start { w: -pressed, ..Start::default() });
        let force = |t: f64| {
            let held: f64 = elements.iter().map(|(c, tau)| share * c * (-t / tau).exp()).sum();
            (STIFFNESS + held) * pressed
        };
        assert_near(&format!("F_z, {initial}"), run.get("F_z"), force(0.0), 1e-12 * force(0.0));
        assert_near("V", run.get("energy.elastic"), 0.5 * pressed * force(0.0), 1e-12 * pressed * force(0.0));
        run.drive(time, REST, REST);
        // A few steps with an error of 1e-9 each.
        assert_near(&format!("F_z, {initial}"), run.get("F_z"), force(time), 1e-8 * force(time));
    }
}

/// The lateral links' dashpots too: neighbours lifted by different heights, e = Δh, pull with (c + c_1) Δh if
/// undeformed.
#[test]
fn lateral_dashpots_start_relaxed_or_undeformed() {
    let layer = SceneText::new(2, 1e-4, MASS).roughness(&[0.0, -2e-6]).vertical(STIFFNESS);
    let layer = layer.lateral_z((300.0, 0.0, [(200.0, 1.0e-4)]));
    for (initial, stiffness) in [("relaxed", 300.0), ("undeformed", 500.0)] {
        let scene = layer.clone().set("layer.initial", initial);
        let mut run = Run::new(&scene, Start { w: -1e-5, ..Start::default() });
        // Lifted by 10 µm and 12 µm: the second is pulled down by the first, which is pulled up.
        let (first, second) = (STIFFNESS * 1e-5 - stiffness * 2e-6, STIFFNESS * 1.2e-5 + stiffness * 2e-6);
        assert_near("F_N of the first", run.get("element[1].F_N"), first, 1e-12 * first);
        assert_near("F_N of the second", run.get("element[2].F_N"), second, 1e-12 * second);
    }
}

const WAVELENGTH: f64 = 1.0e-3;
const AMPLITUDE: f64 = 1.0e-5;

/// Contact ratio and mean force a mass over cA, for `k` masses even over a period, pressed by δ from the crest.
fn lay(k: usize, depth: f64) -> [f64; 2] {
    // A cosine is a sine a quarter of a wavelength further; between the crests the first mass keeps half a spacing.
    let spacing = WAVELENGTH / k as f64;
    let origin = 0.25 * WAVELENGTH + 0.5 * spacing;
    // μ above the largest slope 2πA/λ = 0.063: every mass sticks where it is put.
    let scene = SceneText::new(k, spacing, 1e-7)
        .set("layer.origin", origin)
        .vertical((STIFFNESS, 1.0e-3, [(900.0, 1.0e-4)]))
        .sinusoid(AMPLITUDE, WAVELENGTH)
        .set("surface.points_per_wavelength", 512)
        .coulomb(0.1);
    let w = AMPLITUDE * (1.0 - depth);
    let mut run = Run::new(&scene, Start { w, ..Start::default() });
    assert_eq!(run.get("contact.sticking"), run.get("contact.count"), "all masses in contact stick");
    assert_near("contact.F_z", run.get("contact.F_z"), run.get("F_z"), 1e-12 * run.get("F_z"));
    [run.get("contact.ratio"), run.get("F_z") / (k as f64 * STIFFNESS * AMPLITUDE)]
}

/// With cos θ = 1 - δ/A the crest of A cos qx stands out of the layer at A - δ where |qx| < θ: a share θ/π of it,
/// pressed back there by c (A cos qx - A + δ), on the mean (c/π) [(δ - A) θ + A sin θ].
fn expected(depth: f64) -> [f64; 2] {
    let theta = (1.0 - depth).acos();
    [2.0 * theta / TAU, 2.0 * ((depth - 1.0) * theta + theta.sin()) / TAU]
}

#[test]
fn expected_forces_are_the_known_ones() {
    for (depth, force) in [(0.25, 0.03800), (0.5, 0.10900), (1.0, FRAC_1_PI)] {
        assert_near("mean force", expected(depth)[1], force, 5e-6);
    }
}

/// The midpoint rule with k points: the ratio is off by at most one mass, the force, continuous with kinks at ±θ, by at
/// most twice (qA h²/8) of cA, h = 2π/k, at δ ≤ 2A.
#[test]
fn ratio_and_force_of_a_layer_on_a_cosine() {
    for k in [101, 1000, 4001] {
        for depth in [0.1, 0.25, 0.5, 1.0, 1.5] {
            let ([ratio, force], [ratio_expected, force_expected]) = (lay(k, depth), expected(depth));
            let h = TAU / k as f64;
            assert_near(&format!("ratio of {k} at δ/A = {depth}"), ratio, ratio_expected, 1.0 / k as f64);
            // The spline through 512 points: (2π/512)⁴/384 = 6e-11.
            assert_near(&format!("force of {k} at δ/A = {depth}"), force, force_expected, h * h / TAU + 1e-10);
        }
    }
}

/// Pressed in whole, δ = 2A: all masses bear, and by symmetry the mean force is c A.
#[test]
fn full_contact_on_a_cosine() {
    let [ratio, force] = lay(1000, 2.0);
    assert_eq!(ratio, 1.0);
    // The sum of a whole period's even points of a cosine is 0.
    assert_near("mean force", force, 1.0, 1e-9);
}

/// Held above the crests nothing bears.
#[test]
fn no_contact_with_a_cosine() {
    assert_eq!(lay(1000, -0.01), [0.0, 0.0]);
}
