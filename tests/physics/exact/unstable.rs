//! Where motion is faster than the steps that its accuracy would allow, and coarse tolerances.

use std::f64::consts::TAU;
use std::path::Path as FilePath;

use asperity::scene::{Path, Scene};
use asperity::simulation::{Motion, Simulation, SimulationError, Start};

use crate::common::near::assert_near;
use crate::common::scenes::SceneText;
use crate::physics::exact::run::{REST, Run, rate};

const MASS: f64 = 1.0e-7;
const STIFFNESS: f64 = 2.0e3;
const ACROSS: f64 = 50.0;
const AMPLITUDE: f64 = 5.0e-6;
const WAVELENGTH: f64 = 2.0e-4;
const DEPTH: f64 = 2.0e-5;
/// How far from the crest the mass starts, m: a hundredth of the absolute tolerance.
const ASIDE: f64 = 1.0e-11;

/// One frictionless mass almost on a crest, pressed down by DEPTH below the mean line.
fn on_a_crest(method: &str) -> Run {
    let scene = SceneText::new(1, 1e-4, MASS)
        .set("layer.origin", WAVELENGTH / 4.0 + ASIDE)
        .vertical(STIFFNESS)
        .horizontal(ACROSS)
        .sinusoid(AMPLITUDE, WAVELENGTH)
        .set("surface.points_per_wavelength", 1024)
        .method(method)
        .relative(1e-4);
    Run::new(&scene, Start { w: -DEPTH, ..Start::default() })
}

/// Near the crest, z = a (1 - ½ q² y²): m ÿ = (a q² F - c_x) y + c_x y_0 with F = c (a + DEPTH), so
/// y = y_0 [(1 + r) cosh λt - r] with K = a q² F - c_x, r = c_x/K and λ² = K/m. A method that damps what its steps do
/// not resolve would keep the mass on the crest for ever.
fn leaves(method: &str) {
    let q = TAU / WAVELENGTH;
    let excess = AMPLITUDE * q * q * STIFFNESS * (AMPLITUDE + DEPTH) - ACROSS;
    let (growth, share) = ((excess / MASS).sqrt(), ACROSS / excess);
    let time = 9.0 / growth;
    let mut run = on_a_crest(method);
    let start = run.get("element[1].x");
    run.drive(time, REST, REST);
    let expected = ASIDE * ((1.0 + share) * (growth * time).cosh() - share);
    // Far below the absolute tolerance the mass goes as the method's R(hλ) says, which is within some percent of
    // exp(hλ) a step.
    assert_near("way", run.get("element[1].x") - start, expected - ASIDE, 0.3 * expected);
}

#[test]
fn a_mass_leaves_a_crest_where_events_are_located() {
    leaves("event");
}

/// Masses that break loose in a slow slide: what follows a break passes in microseconds, the steps take a second. The
/// rows within them are as good as those at their ends.
#[test]
fn rows_are_good_in_a_slow_slide() {
    let rows = |method: &str, tolerance: f64| {
        let scene = SceneText::new(8, 1e-4, 1e-7)
            .vertical((2e3, 8e-3, [(1e3, 1e-4)]))
            .horizontal((1e3, 8e-3))
            .lateral_x((5e2, 2e-3))
            .lateral_z((5e2, 2e-3))
            .sinusoid(5e-6, 2.3e-4)
            .coulomb(0.3)
            .method(method)
            .relative(tolerance);
        let mut run = Run::new(&scene, Start { w_rate: -0.1, ..Start::default() });
        run.drive(2e-4, REST, rate(-0.1));
        let motion = Motion { duration: 10.0, u: rate(1e-6), w: Path::default(), ..Motion::REST };
        let times: Vec<f64> = (0..=24).map(|i| f64::from(i) * 10.0 / 24.0).collect();
        let columns = run.sample(&motion, &times, &["F_x", "F_z", "energy.residual"]);
        (columns, run.get("energy.input"))
    };
    let (tight, energy) = rows("event", 1e-9);
    for (method, tolerance) in [("event", 1e-6), ("step", 1e-4)] {
        let (found, _) = rows(method, tolerance);
        for (found, tight) in found.iter().zip(&tight).take(2) {
            let largest = tight.iter().fold(0.0, |most: f64, force| most.max(force.abs()));
            for (found, tight) in found.iter().zip(tight) {
                // Ten times the tolerance: errors of several steps add up.
                assert_near("force", *found, *tight, 10.0 * tolerance * largest);
            }
        }
        for residual in &found[2] {
            assert_near("residual", *residual, 0.0, 10.0 * tolerance * energy);
        }
    }
}

/// A coarse tolerance stops no run that a finer one can do: here of a tread block.
const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/physics/scenes/block/block.toml");
/// Falls with the speed from 15 µm/s on: the block slides a thousand times as fast.
const LAW: &str = "rate_shear = { strength = 9.194e5, reference_speed = 1.48e-5, sharpness = 1.0 }\n[solver]\n";
/// 4 bar on 100 mm², N.
const PRESSED: f64 = 40.0;
const SLIDE: Motion =
    Motion { duration: 1.0e-2, u: Path { rate: 0.0176, amplitude: 0.0, frequency: 0.0 }, w: STILL, ..Motion::REST };
const STILL: Path = Path { rate: 0.0, amplitude: 0.0, frequency: 0.0 };

/// The tread block in rubber under that law, pressed and slid with as many rows.
fn slide(tolerance: &str, rows: u32) -> Result<usize, SimulationError> {
    let text = std::fs::read_to_string(FILE).unwrap().replace("[solver]\n", LAW);
    let mut scene = Scene::parse(&text, FilePath::new(FILE)).unwrap();
    for (name, value) in [("solver.relative_tolerance", tolerance), ("friction.coulomb", "0.0")] {
        scene.set_by_name(name, value).unwrap();
    }
    let press = Motion { duration: 4.0e-3, u: STILL, w: Path { rate: -0.025, ..STILL }, ..Motion::REST };
    let mut simulation = Simulation::new(&scene, &Start { w_rate: press.w.rate, ..Start::default() })?;
    simulation.advance_observed(&press, Some(PRESSED), &[], |_, _| ())?;
    let times: Vec<f64> = (1..=rows).map(|i| SLIDE.duration * f64::from(i) / f64::from(rows)).collect();
    let mut seen = 0;
    simulation.advance_observed(&SLIDE, None, &times, |_, _| seen += 1)?;
    Ok(seen)
}

/// A row cuts a coarse step, and a shorter one may have stages that cannot be solved though those of the longer could.
#[test]
fn rows_within_coarse_steps_stop_no_run() {
    for tolerance in ["0.1", "0.03"] {
        for rows in [20, 100, 200, 400] {
            assert_eq!(slide(tolerance, rows), Ok(rows as usize), "tolerance {tolerance}");
        }
    }
}
