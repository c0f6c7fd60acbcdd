//! Rubber that warms over the way that it slides, in steady sliding as it is solved for.

use asperity_study::steady::{SlidingRubber, SteadySolver};

use super::steady::{friction, parse, reference, scene_of_map, sine};
use crate::common::Table;
use crate::common::near::assert_relative;

/// Friction within 1 %, without heat within 1e-3; the rise of the surface and the flash above it within 2 %.
#[test]
fn rubber_warms_over_its_way_as_an_independent_program_says() {
    let (scene, surface) = scene_of_map("steady-way");
    let mut cold = scene.clone();
    cold.material.as_mut().unwrap().heat = None;
    let [warm, cold] = [&scene, &cold].map(|scene| SlidingRubber::new(scene).unwrap());
    let mut solver = SteadySolver::new(surface);
    let expected = Table::read(&reference("steady/steady-way.csv"));
    for row in 0..expected.len() {
        let number = |name| expected.number(row, name);
        let (pressure, speed, way) = (number("pressure [Pa]"), number("speed [m/s]"), number("way [m]"));
        let found = solver.slide_over(&warm, speed, pressure, Some(way).filter(|way| *way > 0.0));
        assert!(found.heat_converged, "{speed} m/s, {way} m");
        let (flash, rise) = (found.flash_mean.unwrap(), found.surface_rise.unwrap_or(0.0));
        assert_relative("friction", friction(&found), number("friction [1]"), 1e-2);
        assert_relative("flash", flash, number("flash_mean [K]"), 2e-2);
        let expected = number("rise of the surface [K]");
        assert!((rise - expected).abs() <= 2e-2 * expected, "{rise} for {expected}");
        assert_eq!(found.surface_rise.is_some(), way > 0.0);
        if way == 0.0 {
            let cold = friction(&solver.slide(&cold, speed, pressure));
            assert_relative("cold", cold, number("friction cold [1]"), 1e-3);
        }
    }
}

/// Coulomb's friction in full contact makes the same power everywhere along the way: ΔT = Q ∫κ, by the closed form of heat that
/// is made at the surface, 2χQ√(t/π)/√(λρc), within 1e-3.
#[test]
fn a_constant_power_warms_as_a_half_space() {
    let text = "name = 'h'\nlayer = { foundation = 'half_space', masses = 8, spacing = 1e-4, width = 1e-2 }\n\
                material = { density = 1100.0, poisson_ratio = 0.49, equilibrium_modulus = 5e6, prony = [], \
                wlf = { c1 = 7.0, c2 = 120.0, reference_temperature = 293.0, temperature = 293.0 }, \
                heat = { conductivity = 0.25, capacity = 1700.0, share = 0.5 } }\n\
                friction = { coulomb = 0.5 }\n\
                surface = { kind = 'sinusoid', amplitude = 1e-5, wavelength = 1e-3, \
                fine = { hurst = 0.8, rms_slope = 1e-9, longest = 1e-3, shortest = 1e-4, hysteresis = false } }";
    let rubber = SlidingRubber::new(&parse(text, "h.toml".into())).unwrap();
    let mut solver = SteadySolver::new(sine(64, 1e-5));
    for (way, speed) in [(1e-3, 1.0), (0.2, 1.0), (1.0, 0.01), (0.05, 30.0)] {
        let found = solver.slide_over(&rubber, speed, 1e6, Some(way));
        assert!(found.contact.is_full && found.heat_converged);
        let power = speed * 1e6 * friction(&found);
        let effusivity = (0.25_f64 * 1700.0 * 1100.0).sqrt();
        let exact = 2.0 * 0.5 * power * (way / speed / std::f64::consts::PI).sqrt() / effusivity;
        assert_relative("rise", found.surface_rise.unwrap(), exact, 1e-3);
    }
}
