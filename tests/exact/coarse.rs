//! A coarse tolerance stops no run that a finer one can do.

use std::path::Path as FilePath;

use asperity::scene::{Path, Scene};
use asperity::simulation::{Motion, Simulation, SimulationError, Start};

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/tread-block-rubber/tread-block-rubber.toml");
/// Falls with the speed from 15 µm/s on: the block slides a thousand times as fast.
const LAW: &str = "rate_shear = { strength = 9.194e5, reference_speed = 1.48e-5, sharpness = 1.0 }\n[solver]\n";
/// 4 bar on 100 mm², N.
const PRESSED: f64 = 40.0;
const SLIDE: Motion = Motion { duration: 1.0e-2, u: Path { rate: 0.0176, amplitude: 0.0, frequency: 0.0 }, w: STILL };
const STILL: Path = Path { rate: 0.0, amplitude: 0.0, frequency: 0.0 };

/// The tread block in rubber under that law, pressed and slid with as many rows.
fn slide(tolerance: &str, rows: u32) -> Result<usize, SimulationError> {
    let text = std::fs::read_to_string(FILE).unwrap().replace("[solver]\n", LAW);
    let mut scene = Scene::parse(&text, FilePath::new(FILE)).unwrap();
    for (name, value) in [("solver.relative_tolerance", tolerance), ("friction.coulomb", "0.0")] {
        scene.set_by_name(name, value).unwrap();
    }
    let press = Motion { duration: 4.0e-3, u: STILL, w: Path { rate: -0.025, ..STILL } };
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
