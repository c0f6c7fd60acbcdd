//! Scenes of rubber as the steady solver takes them, and runs of a layer along motions.

use std::f64::consts::TAU;

use asperity::outputs::variables;
use asperity::scene::{Force, Path, Scene};
use asperity::simulation::{Motion, Simulation, Start};
use asperity_study::steady::{GridSize, SlidingRubber, SteadySlide, SteadySolver, SurfaceGrid};

/// A scene, which is right.
pub fn parse(text: &str) -> Scene {
    Scene::parse(text, "scene.toml".as_ref()).unwrap_or_else(|error| panic!("{error}"))
}

/// Rubber on a half-space: its modulus in creep (Pa), Poisson's ratio and terms (Pa and s).
pub fn rubber(equilibrium: f64, poisson: f64, terms: &[[f64; 2]]) -> Scene {
    let term = |[modulus, time]: &[f64; 2]| format!("{{ modulus = {modulus:e}, relaxation_time = {time:e} }}");
    let terms: Vec<String> = terms.iter().map(term).collect();
    parse(&format!(
        "name = 'rubber'\nlayer = {{ foundation = 'half_space', masses = 100, spacing = 1e-5, width = 1e-2 }}\n\
         material = {{ density = 1100.0, poisson_ratio = {poisson}, equilibrium_modulus = {equilibrium:e}, \
         prony = [{}] }}\nsurface = {{ kind = 'sinusoid', amplitude = 1e-5, wavelength = 1e-3 }}",
        terms.join(", ")
    ))
}

/// Ridges: `height` at x (m) over one period of this length around 0, on as many points.
pub fn ridges(points: usize, length: f64, height: impl Fn(f64) -> f64) -> SurfaceGrid {
    let heights = (0..points).map(|i| height(length * (i as f64 / points as f64 - 0.5))).collect();
    SurfaceGrid::new(GridSize { nx: points, ny: 1 }, length, 0.0, heights)
}

/// A cylinder of this radius, cut off where it is four half-widths of a contact from its crest: gaps are closed to 10⁻⁷
/// of the height from peak to valley, which would be that of the flanks else.
pub fn cylinder(points: usize, length: f64, radius: f64, half_width: f64) -> SurfaceGrid {
    ridges(points, length, |x| -x.abs().min(4.0 * half_width).powi(2) / (2.0 * radius))
}

/// A square map: `height` at x and y (m) over one period around 0, on as many points along both.
pub fn map(points: usize, length: f64, height: impl Fn(f64, f64) -> f64) -> SurfaceGrid {
    let place = |i: usize| length * (i as f64 / points as f64 - 0.5);
    let heights = (0..points * points).map(|i| height(place(i % points), place(i / points))).collect();
    SurfaceGrid::new(GridSize { nx: points, ny: points }, length, length, heights)
}

/// a cos 2πx/λ over one wave of 1 mm.
pub fn sine(points: usize, amplitude: f64) -> SurfaceGrid {
    ridges(points, 1e-3, |x| -amplitude * (TAU * x / 1e-3).cos())
}

/// Steady sliding, found.
pub fn slide(scene: &Scene, surface: SurfaceGrid, speed: f64, pressure: f64) -> SteadySlide {
    let found = SteadySolver::new(surface).slide(&SlidingRubber::new(scene).unwrap(), speed, pressure);
    assert_eq!(found.contact.left_over, 0);
    found
}

/// The largest pressure, Pa.
pub fn largest_pressure(slide: &SteadySlide) -> f64 {
    slide.contact.pressures.iter().copied().fold(0.0, f64::max)
}

/// A motion at constant rates, m/s.
pub fn straight(duration: f64, u: f64, w: f64) -> Motion {
    let path = |rate| Path { rate, ..Path::default() };
    Motion { duration, u: path(u), w: path(w), ..Motion::default() }
}

/// The same at rest, under a load (N) along z that jumps to this as it begins.
pub fn loaded(duration: f64, load: f64) -> Motion {
    Motion { load: Force { start: Some(load), ..Force::default() }, ..straight(duration, 0.0, 0.0) }
}

/// Outputs by their names at some times (s) within a motion: a row each.
pub fn sample(
    simulation: &mut Simulation,
    scene: &Scene,
    motion: &Motion,
    times: &[f64],
    names: &[&str],
) -> Vec<Vec<f64>> {
    let all = variables(scene);
    let place = |name: &&str| all.iter().position(|variable| variable.name == *name).expect("an output of the scene");
    let places: Vec<usize> = names.iter().map(place).collect();
    let (mut rows, mut values) = (Vec::new(), vec![0.0; all.len()]);
    let row = |_: f64, now: &asperity::outputs::Snapshot<'_>| {
        now.evaluate(&all, &mut values);
        rows.push(places.iter().map(|&i| values[i]).collect());
    };
    simulation.advance_observed(motion, None, times, row).unwrap();
    rows
}

/// A run that begins at this.
pub fn begin(scene: &Scene, start: &Start) -> Simulation {
    Simulation::new(scene, start).unwrap()
}

/// The ends of so many even parts of a duration.
pub fn even_times(duration: f64, count: usize) -> Vec<f64> {
    (1..=count).map(|i| if i == count { duration } else { duration * i as f64 / count as f64 }).collect()
}
