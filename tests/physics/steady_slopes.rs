//! Contacts that lie on slopes, in steady sliding as it is solved for.

use std::f64::consts::TAU;

use asperity_study::steady::{SlideProblem, SlidingRubber, SteadySolver, SurfaceGrid};

use super::steady::{TERM, friction, parse, plane_modulus, reference, scene, scene_of_map, sine, slide};
use crate::common::Table;
use crate::common::near::assert_relative;
use asperity::scene::Scene;

/// Friction and its parts within 1e-3 of friction, the area within 0.5 % and a point.
fn on_slopes(case: &str, scene: &Scene, surface: SurfaceGrid) {
    let rubber = SlidingRubber::new(scene).unwrap();
    let points = surface.size.points() as f64;
    let mut solver = SteadySolver::new(surface);
    let expected = Table::read(&reference(&format!("steady/{case}.csv")));
    for row in 0..expected.len() {
        let number = |name| expected.number(row, name);
        let (pressure, speed) = (number("pressure [Pa]"), number("speed [m/s]"));
        let found = solver.slide(&rubber, speed, pressure);
        let (whole, area) = (number("friction [1]"), number("area_ratio [1]"));
        let what = |part: &str| format!("{part} of {case} at {pressure:e} Pa, {speed:e} m/s");
        assert_relative(&what("friction"), friction(&found), whole, 1e-3);
        for (part, found, expected) in [
            ("hysteresis of the profile", found.profile_hysteresis, number("of the profile [1]")),
            ("fine hysteresis", found.fine_hysteresis.unwrap_or(0.0), number("friction_fine [1]")),
            ("adhesion", found.adhesion.unwrap(), number("friction_adhesion [1]")),
        ] {
            let allowed = (1e-3 * expected.abs()).max(1e-12);
            assert!((found - expected).abs() <= allowed, "{}: {found} for {expected}", what(part));
        }
        assert!((found.area - area).abs() <= 5e-3 * area + 1.0 / points, "{}", what("area"));
    }
}

#[test]
fn contacts_lie_on_slopes_as_an_independent_program_says() {
    for case in ["steady-slopes", "steady-slopes-shear"] {
        let scene = scene(&format!("steady/{case}"));
        on_slopes(case, &scene, SurfaceGrid::of_profile(&scene.surface, scene.layer.masses));
    }
    let (scene, surface) = scene_of_map("steady-slopes-map");
    on_slopes("steady-slopes-map", &scene, surface);
}

fn with_friction(friction: &str) -> Scene {
    let text = format!(
        "name = 'rubber'\nlayer = {{ foundation = 'half_space', masses = 100, spacing = 1e-5, width = 1e-2 }}\n\
         material = {{ density = 1100.0, poisson_ratio = 0.49, equilibrium_modulus = 5e6, prony = [{TERM}] }}\n\
         surface = {{ kind = 'sinusoid', amplitude = 1e-5, wavelength = 1e-3 }}\nfriction = {{ {friction} }}"
    );
    parse(&text, "rubber.toml".into())
}

/// A sine of b = qa in full contact with Coulomb's friction, r = 1/√(1 - μ²b²): friction is
/// μ r + (r - 1)/μ + (Im M/2P)(1 + 1/μ²)(r - 1), with the hysteresis of the profile as without it.
#[test]
fn coulombs_friction_on_a_sine_in_full_contact_has_a_closed_form() {
    for (mu, b, speed) in [(0.3, 0.5, 1.0), (0.9, 0.8, 0.3), (1.5, 0.5, 10.0), (0.5, 1.9, 0.1)] {
        let (q, p) = (TAU / 1e-3, 4e7);
        let scene = with_friction(&format!("coulomb = {mu}"));
        let found = slide(&scene, sine(4096, b / q), speed, p);
        assert!(found.contact.is_full);
        let loss = plane_modulus(q * speed, 0.49)[1];
        let r = 1.0 / (1.0 - (mu * b).powi(2)).sqrt();
        // The hysteresis of the profile, (qa)² Im M/(4p), is that which the contacts multiply.
        let exact = mu * r + (r - 1.0) / mu + loss / (2.0 * p) * (1.0 + 1.0 / (mu * mu)) * (r - 1.0);
        assert_relative("friction", friction(&found), exact, 1e-6);
    }
}

/// Where μ h_x q2/q1 passes 1 nothing slides: so many points, no friction, and the rest as it is.
#[test]
fn coulombs_friction_jams_on_steep_slopes() {
    let (q, mu, b) = (TAU / 1e-3, 1.2, 1.0);
    let surface = sine(4096, b / q);
    let smooth = slide(&with_friction("coulomb = 0.5"), surface.clone(), 1.0, 4e7);
    let found = slide(&with_friction(&format!("coulomb = {mu}")), surface, 1.0, 4e7);
    // |sin| > 1/(μb) on a half of the period, the rising one.
    let share = 0.5 - (1.0_f64 / (mu * b)).asin() / std::f64::consts::PI;
    assert_relative("points", found.jammed as f64, 4096.0 * share, 2e-3);
    assert_eq!(found.problem(), Some(SlideProblem::Jams { points: found.jammed }));
    assert_eq!((found.friction(), found.adhesion), (None, None));
    assert_eq!((found.area, found.profile_hysteresis), (smooth.area, smooth.profile_hysteresis));
    assert_eq!(found.hysteresis, Some(found.profile_hysteresis), "no waves are missing");
}
