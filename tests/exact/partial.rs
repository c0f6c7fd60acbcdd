//! Partial contact: a layer laid on a cosine.

use std::f64::consts::{FRAC_1_PI, TAU};

use asperity::simulation::Start;

use crate::run::{Law, Run, assert_near, link};

const WAVELENGTH: f64 = 1.0e-3;
const AMPLITUDE: f64 = 1.0e-5;
const STIFFNESS: f64 = 2.0e3;

/// Contact ratio and mean force a mass over cA, for `k` masses even over a period, pressed by δ from the crest.
fn lay(k: usize, depth: f64) -> [f64; 2] {
    let vertical = link("vertical", &Law::with_maxwell(STIFFNESS, 1.0e-3, &[(900.0, 1.0e-4)]));
    // A cosine is a sine a quarter of a wavelength further; between the crests the first mass keeps half a spacing.
    let spacing = WAVELENGTH / k as f64;
    let origin = 0.25 * WAVELENGTH + 0.5 * spacing;
    // μ above the largest slope 2πA/λ = 0.063: every mass sticks where it is put.
    let text = format!(
        "[layer]\nmasses = {k}\nspacing = {spacing:?}\norigin = {origin:?}\nmass = 1e-7\n{vertical}\
         [surface]\nkind = \"sinusoid\"\namplitude = {AMPLITUDE:?}\nwavelength = {WAVELENGTH:?}\n\
         points_per_wavelength = 512\n[friction]\ncoulomb = 0.1\n"
    );
    let w = AMPLITUDE * (1.0 - depth);
    let mut run = Run::new(&text, Start { w, ..Start::default() });
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
fn full_contact() {
    let [ratio, force] = lay(1000, 2.0);
    assert_eq!(ratio, 1.0);
    // The sum of a whole period's even points of a cosine is 0.
    assert_near("mean force", force, 1.0, 1e-9);
}

/// Held above the crests nothing bears.
#[test]
fn no_contact() {
    assert_eq!(lay(1000, -0.01), [0.0, 0.0]);
}
