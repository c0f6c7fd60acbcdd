//! Rubber that warms over the way that it slides, in steady sliding as it is solved for.

use asperity_study::steady::{SlidingRubber, SteadySolver};

use super::steady::{friction, reference, scene_of_map};
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
