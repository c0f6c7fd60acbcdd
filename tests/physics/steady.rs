//! Steady sliding as the solver finds it: closed forms, solutions of an independent program, and what must not change.

use std::f64::consts::TAU;
use std::fs;
use std::path::PathBuf;

use asperity::scene::Scene;
use asperity_study::steady::{GridSize, SlidingRubber, SteadySlide, SteadySolver, SurfaceGrid};

use crate::common::near::assert_relative;
use crate::common::{Table, root};
use crate::validation::rough;
use crate::validation::row::Claim;

/// Friction, which does not jam.
pub fn friction(slide: &SteadySlide) -> f64 {
    assert_eq!(slide.jammed, 0);
    slide.friction().unwrap()
}

pub fn reference(file: &str) -> PathBuf {
    root().join("tests/reference").join(file)
}

pub fn parse(text: &str, path: PathBuf) -> Scene {
    Scene::parse(text, &path).unwrap_or_else(|error| panic!("{error}"))
}

pub fn scene(case: &str) -> Scene {
    let path = reference(&format!("{case}.toml"));
    parse(&fs::read_to_string(&path).unwrap(), path)
}

/// The rubber of a scene whose surface is a map, which stands in a file of its own.
pub fn scene_of_map(case: &str) -> (Scene, SurfaceGrid) {
    let path = reference(&format!("steady/{case}.toml"));
    let text = fs::read_to_string(&path).unwrap();
    let surface = text.split_once("[surface]").unwrap().1;
    let of_file = surface.lines().filter(|line| ["kind", "path", "spacing"].iter().any(|key| line.starts_with(key)));
    let text = of_file
        .fold(text.clone(), |text, line| text.replace(line, ""))
        .replace("[surface]", "[surface]\nkind = \"sinusoid\"\namplitude = 1e-4\nwavelength = 4e-3");
    let scene = parse(&text.replace("periodic = true", ""), path);
    let map = fs::read_to_string(reference(&format!("steady/{case}.map.csv"))).unwrap();
    let heights: Vec<f64> = map.lines().flat_map(|row| row.split(',').map(|z| z.parse::<f64>().unwrap())).collect();
    let ny = map.lines().count();
    let size = GridSize { nx: heights.len() / ny, ny };
    let [length, width] = [size.nx, size.ny].map(|count| scene.layer.spacing * count as f64);
    (scene, SurfaceGrid::new(size, length, width, heights))
}

/// Area within 0.5 % and a point, friction within 1e-3 of itself, the separation within 1e-3 of the rms height.
fn same_grid(case: &str, scene: &Scene, surface: SurfaceGrid) {
    let rubber = SlidingRubber::new(scene).unwrap();
    let (points, rms) = (surface.size.points() as f64, surface.rms_height());
    let mut solver = SteadySolver::new(surface);
    let expected = Table::read(&reference(&format!("steady/{case}.csv")));
    for row in 0..expected.len() {
        let number = |name| expected.number(row, name);
        let (pressure, speed) = (number("pressure [Pa]"), number("speed [m/s]"));
        let found = solver.slide(&rubber, speed, pressure);
        let what = |quantity: &str| format!("{quantity} of {case} at {pressure:e} Pa, {speed:e} m/s");
        let area = number("area_ratio [1]");
        assert_eq!(found.contact.left_over, 0);
        assert!((found.area - area).abs() <= 5e-3 * area + 1.0 / points, "{}", what("area"));
        assert_relative(&what("friction"), friction(&found), number("friction [1]"), 1e-3);
        let off = found.contact.separation - number("separation [m]");
        assert!(off.abs() <= 1e-3 * rms, "{}: {off:e}", what("separation"));
    }
}

#[test]
fn ridges_slide_as_an_independent_program_says() {
    for case in ["steady-ridges", "steady-layer"] {
        let scene = scene(&format!("steady/{case}"));
        let points = SurfaceGrid::points_of_profile(&scene.surface);
        assert_eq!(points, scene.layer.masses, "the profile is even and fine enough");
        same_grid(case, &scene, SurfaceGrid::of_profile(&scene.surface, points));
    }
}

#[test]
fn a_map_slides_as_an_independent_program_says() {
    let (scene, surface) = scene_of_map("steady-map");
    same_grid("steady-map", &scene, surface);
}

/// Friction within 1 % with heat, within 1e-3 without, and the flash temperature within 2 %. At 3 m/s there are contacts whose
/// heat feeds itself, and several solutions within half a per cent of each other.
#[test]
fn a_road_that_is_rough_below_its_map_rubs_as_an_independent_program_says() {
    let (scene, surface) = scene_of_map("steady-road");
    let mut cold = scene.clone();
    cold.material.as_mut().unwrap().heat = None;
    let [warm, cold] = [&scene, &cold].map(|scene| SlidingRubber::new(scene).unwrap());
    let mut solver = SteadySolver::new(surface);
    let expected = Table::read(&reference("steady/steady-road.csv"));
    for row in 0..expected.len() {
        let number = |name| expected.number(row, name);
        let (pressure, speed) = (number("pressure [Pa]"), number("speed [m/s]"));
        let found = solver.slide(&warm, speed, pressure);
        assert!(found.heat_converged, "{speed}");
        assert_relative("friction", friction(&found), number("friction [1]"), 1e-2);
        assert_relative("flash", found.flash_mean.unwrap(), number("flash_mean [K]"), 2e-2);
        assert_relative("of the profile", found.profile_hysteresis, number("of the profile [1]"), 1e-3);
        assert_relative("area", found.area, number("area_ratio [1]"), 5e-3);
        assert_relative("cold", friction(&solver.slide(&cold, speed, pressure)), number("friction cold [1]"), 1e-3);
    }
}

/// Friction within 2e-3 and area within 1 % at 8192 points of the profiles' splines, a rms slope of 0.6 among them.
#[test]
fn profiles_on_a_half_plane_slide_as_two_independent_programs_say() {
    for case in ["sine", "rough", "layer", "steep"] {
        let scene = scene(&format!("half-plane/{case}"));
        let rubber = SlidingRubber::new(&scene).unwrap();
        let mut solver = SteadySolver::new(SurfaceGrid::of_profile(&scene.surface, 8192));
        let expected = Table::read(&reference(&format!("half-plane/{case}.slide.csv")));
        for row in 0..expected.len() {
            let number = |name| expected.number(row, name);
            let (pressure, speed) = (number("pressure [Pa]"), number("speed [m/s]"));
            let found = solver.slide(&rubber, speed, pressure);
            let what = |quantity: &str| format!("{quantity} of {case} at {pressure:e} Pa, {speed:e} m/s");
            assert_relative(&what("friction"), friction(&found), number("friction [1]"), 2e-3);
            assert_relative(&what("area"), found.area, number("area_ratio [1]"), 1e-2);
        }
    }
}

/// Rubber with this Prony series over a sine of one of its waves, on a half-space.
pub fn rubber(prony: &str, nu: f64) -> Scene {
    let text = format!(
        "name = 'rubber'\nlayer = {{ foundation = 'half_space', masses = 100, spacing = 1e-5, width = 1e-2 }}\n\
         material = {{ density = 1100.0, poisson_ratio = {nu}, equilibrium_modulus = 5e6, prony = [{prony}] }}\n\
         surface = {{ kind = 'sinusoid', amplitude = 1e-5, wavelength = 1e-3 }}"
    );
    parse(&text, "rubber.toml".into())
}

pub const TERM: &str = "{ modulus = 2e7, relaxation_time = 1e-4 }";

/// M of that rubber with [`TERM`] at ω, real and imaginary part.
pub fn plane_modulus(omega: f64, nu: f64) -> [f64; 2] {
    let x = omega * 1e-4;
    let scale = 1.0 / (1.0 - nu * nu) / (1.0 + x * x);
    [5e6 / (1.0 - nu * nu) + scale * 2e7 * x * x, scale * 2e7 * x]
}

pub fn sine(points: usize, amplitude: f64) -> SurfaceGrid {
    let heights = (0..points).map(|i| amplitude * (TAU * i as f64 / points as f64).cos()).collect();
    SurfaceGrid::new(GridSize { nx: points, ny: 1 }, 1e-3, 0.0, heights)
}

pub fn slide(scene: &Scene, surface: SurfaceGrid, speed: f64, pressure: f64) -> SteadySlide {
    let found = SteadySolver::new(surface).slide(&SlidingRubber::new(scene).unwrap(), speed, pressure);
    assert_eq!(found.contact.left_over, 0);
    found
}

/// Full contact on any surface: μ P = Σ q_x |h_q|² K Im M(q_x v) over the waves of both signs. Roundings alone are left.
#[test]
fn full_contact_on_a_map_has_a_closed_form() {
    let (q, p) = (TAU / 1e-3, 2e6);
    // Some waves of a map, q = 2π (m, n)/L, with a difference between q_x and |q|.
    let waves = [(1.0, 0.0, 2e-6, 0.3), (2.0, 3.0, 1e-6, 1.1), (5.0, -2.0, 4e-7, 2.0), (0.0, 4.0, 5e-7, 0.1)];
    let (size, length) = (GridSize { nx: 24, ny: 30 }, 1e-3);
    let height = |i: usize, j: usize| {
        let wave = |(m, n, a, phase): &(f64, f64, f64, f64)| {
            a * (TAU * (m * i as f64 / 24.0 + n * j as f64 / 30.0) + phase).cos()
        };
        waves.iter().map(wave).sum::<f64>()
    };
    let heights = (0..30).flat_map(|j| (0..24).map(move |i| (i, j))).map(|(i, j)| height(i, j)).collect();
    // Nearly incompressible: the traction of more compressible rubber lifts it.
    let found = slide(&rubber(TERM, 0.48), SurfaceGrid::new(size, length, length, heights), 2.0, p);
    let loss = |(m, n, a, _): &(f64, f64, f64, f64)| {
        let (along, whole) = (q * m, q * f64::hypot(*m, *n));
        // Both signs: twice |h_q|² = a²/4.
        along * 0.5 * a * a * 0.5 * whole * plane_modulus(along * 2.0, 0.48)[1]
    };
    assert!(found.contact.is_full && found.tangential_stiffness.is_none());
    assert_eq!((found.area, found.contact.separation), (1.0, 0.0));
    assert_relative("map", friction(&found), waves.iter().map(loss).sum::<f64>() / p, 1e-9);
}

/// κ of the area, and friction by the middle one of three sums; that these are bounds is no law, as the validation page says.
#[test]
fn rough_maps_touch_and_rub_as_the_validation_page_says() {
    let area = (rough::AREA.compare)().rows;
    let sums = (rough::SPECTRUM.compare)().rows.into_iter().filter(|row| matches!(row.claim, Claim::Share(_)));
    for row in area.into_iter().chain(sums) {
        assert!(row.agrees(), "{}: {} for {}", row.quantity, row.found, row.expected);
    }
}

/// Sliding backwards over the mirrored surface is the same: the sign of the phase.
#[test]
fn the_mirrored_surface_slid_over_backwards_is_the_same() {
    let scene = scene("steady/steady-ridges");
    let surface = SurfaceGrid::of_profile(&scene.surface, 512);
    let rubber = SlidingRubber::new(&scene).unwrap();
    let mut mirrored = surface.clone();
    mirrored.heights[1..].reverse();
    let one = SteadySolver::new(surface).slide(&rubber, 0.1, 3e5);
    let other = SteadySolver::new(mirrored).slide(&rubber, -0.1, 3e5);
    assert_relative("friction", friction(&other), -friction(&one), 1e-6);
    assert_eq!(other.area, one.area);
}

/// Elastic rubber loses nothing: in full contact to rounding, in partial contact but for the points at the edges, which are
/// fewer of all the finer the grid is.
#[test]
fn elastic_rubber_does_not_rub() {
    let elastic = rubber("", 0.49);
    let full = slide(&elastic, sine(64, 1e-5), 1.0, 2e6);
    assert!(full.contact.is_full && friction(&full).abs() < 1e-9, "{:e}", friction(&full));
    let profile = scene("half-plane/rough").surface;
    let at = |points| friction(&slide(&elastic, SurfaceGrid::of_profile(&profile, points), 1.0, 2e5)).abs();
    let shortest = asperity::scene::Spectrum::new(&profile).shortest_wavelength().unwrap();
    let period = profile.x()[profile.x().len() - 1];
    let coarse = (20.0 * period / shortest).ceil() as usize;
    let (coarse, fine) = (at(coarse), at(4 * coarse));
    assert!(coarse < 5e-4 && fine < 0.5 * coarse, "{coarse:e} {fine:e}");
}

/// What a solver found before leaves no trace: the same bits in another order.
#[test]
fn a_point_depends_on_no_other() {
    let scene = scene("steady/steady-layer");
    let rubber = SlidingRubber::new(&scene).unwrap();
    let solver = || SteadySolver::new(SurfaceGrid::of_profile(&scene.surface, 1024));
    let bits = |slide: SteadySlide| {
        let pressures: Vec<u64> = slide.contact.pressures.iter().map(|p| p.to_bits()).collect();
        (friction(&slide).to_bits(), slide.tangential_stiffness.unwrap().to_bits(), pressures)
    };
    let alone = bits(solver().slide(&rubber, 0.1, 2e5));
    let mut used = solver();
    let _ = used.slide(&rubber, 3.0, 2e6);
    let _ = used.slide(&rubber, 0.001, 2e5);
    assert_eq!(bits(used.slide(&rubber, 0.1, 2e5)), alone);
}

/// Rubber that its viscosity governs at the waves of a fine grid, where sets of points alone swing; hysteresis is that of an
/// independent program.
#[test]
fn loss_far_above_storage_has_its_contact() {
    let path = root().join("scenes/two-maxima/two-maxima.toml");
    let scene = parse(&fs::read_to_string(&path).unwrap(), path);
    let rubber = SlidingRubber::new(&scene).unwrap();
    for (points, speed, expected) in [(512, 3.0, 0.140344), (1024, 3.0, 0.140382), (1024, 10.0, 0.117835)] {
        let mut solver = SteadySolver::new(SurfaceGrid::of_profile(&scene.surface, points));
        let found = solver.slide(&rubber, speed, 4e5);
        assert_eq!(found.problem(), None, "{points} {speed}");
        // Pressures that alternate are known to what is left of the residual.
        assert_relative("hysteresis", found.profile_hysteresis, expected, 3e-4);
    }
    // As good as none anywhere: from hardly any contact to nearly full.
    let mut solver = SteadySolver::new(SurfaceGrid::of_profile(&scene.surface, 256));
    for speed in [0.1, 1.0, 4.0, 30.0] {
        for pressure in [1e3, 1e5, 1e7] {
            assert!(solver.slide(&rubber, speed, pressure).is_found(), "{speed} {pressure}");
        }
    }
}
