//! Touches a thousandth of a step long and a nanometre deep, in whole runs.

use asperity::outputs::Snapshot;
use asperity::scene::{Path, Scene};
use asperity::simulation::{Motion, Simulation, Start};

use crate::common::runs::value;
use crate::physics::kernels::layer::{Layer, at_rate, link, points};

const NANOMETRE: f64 = 1e-9;

/// Follows the carrier's constant rate along x for 2 s; the energy lost in impacts, the longest step, the mode changes.
fn fly(layer: &Layer, u_rate: f64) -> (f64, f64, usize) {
    let scene = layer.scene();
    let start = Start { u_rate, ..Start::default() };
    let mut simulation = Simulation::new(&scene, &start).unwrap();
    simulation.record_mode_changes(true);
    simulation.advance(&Motion { duration: 2.0, u: at_rate(u_rate), w: Path::default(), ..Motion::default() }).unwrap();
    let steps = value(&scene, &simulation.snapshot(), "solver.steps");
    let changes = simulation.take_mode_changes().len();
    (value(&scene, &simulation.snapshot(), "dissipation.E_impact"), 2.0 / steps, changes)
}

/// A free mass without links flies straight at 1 m/s through the crest of `surface` at a height above it, m.
fn over(surface: &str, height: f64) -> Layer {
    let flat =
        Layer { surface: surface.into(), solver: "solver.absolute_tolerance = 1e-12".into(), ..Layer::default() };
    let crest = flat.model().profile.local_bounds(0.0, 2.0).z_max;
    Layer { clearance: crest + height, ..flat }
}

/// A spike half a millisecond long on the way of a mass whose steps last half a second: the mass hits it where it
/// reaches a nanometre into its way, and passes where it does not.
#[test]
fn a_spike_a_thousandth_of_a_step_long_is_found() {
    let x = [-1.0, 0.5, 0.9, 0.99975, 1.0, 1.00025, 1.1, 1.5, 4.0];
    let surface = points(&x, &[0.0, 0.0, 0.0, 0.0, 1e-6, 0.0, 0.0, 0.0, 0.0], false);
    let (lost, ..) = fly(&over(&surface, -NANOMETRE), 1.0);
    // ½ m v_n² with a slope of at least some 1e-5 at the flank.
    assert!(lost > 1e-12, "{lost:e}");
    let (lost, step, changes) = fly(&over(&surface, NANOMETRE), 1.0);
    assert_eq!((lost, changes), (0.0, 0));
    assert!(step > 0.2, "{step}");
}

/// The same over a parabolic crest: below the mass's way by its curvature, for 5e-4 m of 2 m.
#[test]
fn a_dip_into_a_smooth_crest_is_found() {
    let surface = points(&[0.0, 1.0, 2.0], &[0.0, 0.01, 0.0], false);
    let (lost, ..) = fly(&over(&surface, -NANOMETRE), 1.0);
    // The slope where the mass comes in is √(2 · 0.03/m · 1e-9 m) = 7.7e-6.
    assert!((lost - 0.5 * 2.0 * 0.03 * NANOMETRE).abs() < 0.02 * lost, "{lost:e}");
    let (lost, step, changes) = fly(&over(&surface, NANOMETRE), 1.0);
    assert_eq!((lost, changes), (0.0, 0));
    assert!(step > 0.2, "{step}");
}

/// A mass that grazes a crest by a third or a hundredth of the position tolerance hits it at a fine relative tolerance
/// and passes it at a coarse one: touches are looked for to all of that tolerance from 1e-3 on, to a thousandth of it
/// at 1e-6.
#[test]
fn fine_tolerances_see_shallower_dips() {
    let surface = points(&[0.0, 1.0, 2.0], &[0.0, 0.01, 0.0], false);
    let hits = |depth: f64, relative: &str| {
        let solver = format!("solver = {{ absolute_tolerance = 3e-9, relative_tolerance = {relative} }}");
        let (lost, ..) = fly(&Layer { solver, ..over(&surface, -depth) }, 1.0);
        lost > 0.0
    };
    assert_eq!(["1e-2", "1e-3", "1e-4", "1e-6"].map(|relative| hits(NANOMETRE, relative)), [false, false, true, true]);
    assert_eq!(["1e-3", "1e-4", "1e-6"].map(|relative| hits(0.03 * NANOMETRE, relative)), [false, false, true]);
}

/// A mass that rattles over waves at a tolerance of 1e-12, with a dip of which no touch may be looked for below the
/// roundings of its gap: it would touch and lift by these without end. Steps shorten with the fifth root of the
/// tolerance, by 2.5.
#[test]
fn no_dip_is_so_shallow_that_roundings_make_it() {
    let steps = |relative: &str| {
        let vertical = link(1e3, 2e-3, &[(5e2, 1e-4)]);
        let layer = Layer {
            mass: 2e-7,
            spacing: 1e-4,
            clearance: 1e-6,
            links: [vertical, link(2e3, 8e-3, &[]), None, None],
            surface: "surface = { kind = 'sinusoid', amplitude = 1e-5, wavelength = 5e-4 }".into(),
            friction: Some((0.2, 0.0)),
            solver: format!("solver = {{ relative_tolerance = {relative}, max_steps = 100000 }}"),
            ..Layer::default()
        };
        let scene = layer.scene();
        let mut simulation = Simulation::new(&scene, &Start { w_rate: -0.04, ..Start::default() }).unwrap();
        for (duration, u, w) in [(2e-4, 0.0, -0.04), (2e-3, 4.0, 0.0)] {
            simulation.advance(&Motion { duration, u: at_rate(u), w: at_rate(w), ..Motion::default() }).unwrap();
        }
        value(&scene, &simulation.snapshot(), "solver.steps")
    };
    let (coarse, fine) = (steps("1e-10"), steps("1e-12"));
    assert!(coarse > 1000.0 && fine < 4.0 * coarse, "{coarse} and {fine}");
}

/// A mass on a weak spring, thrown down with the carrier and brought back by the spring: a sine whose lowest part dips
/// below a flat surface.
fn thrown(clearance: f64) -> Layer {
    let links = [link(1.0, 0.0, &[]), None, None, None];
    let solver = "solver = { relative_tolerance = 2e-6, absolute_tolerance = 1e-10 }".into();
    Layer { clearance, links, solver, ..Layer::default() }
}

/// Throws the mass at 0.1 m/s down and follows it for 3 s, near its lowest position, π/2 s, in steps of 2e-5 s: the
/// energy lost in impacts, the lowest height seen, the number of steps, the mode changes.
fn throw(scene: &Scene) -> (f64, f64, f64, usize) {
    let start = Start { w_rate: -0.1, ..Start::default() };
    let mut simulation = Simulation::new(scene, &start).unwrap();
    simulation.record_mode_changes(true);
    let motion = Motion { duration: 3.0, u: Path::default(), w: Path::default(), ..Motion::default() };
    let times: Vec<f64> = (0..5000).map(|i| 1.52 + 2e-5 * f64::from(i)).collect();
    let mut lowest = f64::INFINITY;
    let observe = |_: f64, snapshot: &Snapshot<'_>| {
        lowest = lowest.min(value(scene, snapshot, "element[1].z"));
    };
    simulation.advance_observed(&motion, None, &times, observe).unwrap();
    let steps = value(scene, &simulation.snapshot(), "solver.steps");
    let changes = simulation.take_mode_changes().len();
    (value(scene, &simulation.snapshot(), "dissipation.E_impact"), lowest, steps, changes)
}

/// A throw that ends a nanometre below a flat surface, for 3e-4 s: the touch is found in steps of a third of a second.
/// One that ends a nanometre above it does not touch.
#[test]
fn the_lowest_point_of_a_throw_is_found() {
    // What the run makes of the depth, 0.1 m.
    let (_, lowest, steps, _) = throw(&thrown(1.0).scene());
    let depth = 1.0 - lowest;
    assert!((depth - 0.1).abs() < 1e-5 && steps < 15.0, "{depth} m, {steps} steps");
    let (lost, ..) = throw(&thrown(depth - NANOMETRE).scene());
    // ½ c ((0.1 m)² - (0.1 m - 1e-9 m)²) = 1e-10 J; the absolute tolerance is a tenth of the depth.
    assert!((lost - 0.1 * NANOMETRE).abs() < 0.4 * lost, "{lost:e}");
    let (lost, _, _, changes) = throw(&thrown(depth + NANOMETRE).scene());
    assert_eq!((lost, changes), (0.0, 0));
}

/// A mass flies out of a valley into its flank: the touch is a mode change that is recorded, at its position.
#[test]
fn a_touch_is_recorded_where_it_happens() {
    let surface = points(&[-1.0, 0.0, 1.0], &[0.01, 0.0, 0.01], false);
    let layer = Layer { clearance: 0.005, surface, friction: Some((0.1, 0.0)), ..Layer::default() };
    let mut simulation = Simulation::new(&layer.scene(), &Start { u_rate: 1.0, ..Start::default() }).unwrap();
    simulation.record_mode_changes(true);
    simulation.advance(&Motion { duration: 0.9, u: at_rate(1.0), w: Path::default(), ..Motion::default() }).unwrap();
    let changes = simulation.take_mode_changes();
    let first = changes.first().unwrap();
    assert_eq!((first.from, first.to, first.mass, changes.len()), (0, 1, 0, 1), "{changes:?}");
    // A distance d before the end the spline is 0.015 d - 0.005 d³ below it: 0.005 m at d = 2 cos 80°. The touch is
    // located within 1e-8 m.
    let expected = 1.0 - 2.0 * 80.0_f64.to_radians().cos();
    assert!((first.time - expected).abs() < 1e-6, "{first:?}");
}
