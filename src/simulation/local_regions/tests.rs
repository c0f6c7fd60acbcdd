//! Runs with local regions, and those of the same scene without.

use std::path::Path as FilePath;

use crate::outputs::{Snapshot, variables};
use crate::scene::{Path, Scene};
use crate::simulation::tests::variables_of;
use crate::simulation::{ModeChange, Motion, Simulation, Start};

const TOLERANCE: f64 = 1e-5;
const MASSES: usize = 160;
/// A force that no scene reaches, N: a run that is to end there opens no regions.
const NEVER: f64 = 1e30;

/// A block of 160 masses over waves: every mass touches and lifts, slips, stops and sticks.
fn scene(groups: &str) -> Scene {
    let text = format!(
        "name = 'block'
        layer = {{ masses = {MASSES}, spacing = 5e-5, mass = 1e-7, clearance = 1e-6, initial = 'undeformed',
            vertical = {{ stiffness = 2e3, damping = 8e-3, maxwell = [{{ stiffness = 3e3, relaxation_time = 1e-6 }},
                                                                   {{ stiffness = 8e2, relaxation_time = 1e-4 }}] }},
            horizontal = {{ stiffness = 1e3, damping = 6e-3, maxwell = [{{ stiffness = 5e2, relaxation_time = 1e-5 }}] }},
            lateral_x = {{ stiffness = 5e2, damping = 4e-3, maxwell = [{{ stiffness = 2e2, relaxation_time = 1e-5 }}] }},
            lateral_z = {{ stiffness = 3e2, damping = 3e-3 }} }}
        surface = {{ kind = 'sinusoid', amplitude = 4e-6, wavelength = 7.3e-4 }}
        friction = {{ coulomb = 0.3, shear_force = 5e-5 }}
        solver = {{ method = 'event', relative_tolerance = {TOLERANCE} }}
        fmu = {{ outputs = [{groups}] }}"
    );
    Scene::parse(&text, FilePath::new("block.toml")).unwrap()
}

/// Pressed down while it swings.
const SWING: Motion = Motion {
    duration: 3e-4,
    u: Path { rate: 0.3, amplitude: 1e-4, frequency: 2500.0 },
    w: Path { rate: -0.01, amplitude: 0.0, frequency: 0.0 },
    ..Motion::REST
};

struct Rows {
    /// F_x and F_z, N.
    forces: Vec<[f64; 2]>,
    /// All variables at the end.
    end: Vec<(String, f64)>,
    changes: Vec<ModeChange>,
    simulation: Simulation,
}

impl Rows {
    fn new(scene: &Scene, rows: u32, until_force: Option<f64>) -> Self {
        let mut simulation = Simulation::new(scene, &Start::default()).unwrap();
        simulation.record_mode_changes(true);
        let times: Vec<f64> = (0..rows).map(|i| f64::from(i) * SWING.duration / f64::from(rows)).collect();
        let mut forces = Vec::new();
        let observe = |_: f64, now: &Snapshot<'_>| forces.push([now.on_carrier.x, now.on_carrier.z]);
        simulation.advance_observed(&SWING, until_force, &times, observe).unwrap();
        let changes = simulation.take_mode_changes();
        Self { forces, end: variables_of(scene, &mut simulation), changes, simulation }
    }

    fn value(&self, name: &str) -> f64 {
        self.end.iter().find(|(variable, _)| variable == name).unwrap().1
    }
}

#[test]
fn a_run_with_regions_is_one_that_is_cut_at_every_change() {
    let scene = scene("'forces', 'dissipation', 'energy', 'solver'");
    let (with, without) = (Rows::new(&scene, 300, None), Rows::new(&scene, 300, Some(NEVER)));
    for axis in [0, 1] {
        let largest = without.forces.iter().map(|row| row[axis].abs()).fold(0.0, f64::max);
        let off = with.forces.iter().zip(&without.forces).map(|(a, b)| (a[axis] - b[axis]).abs()).fold(0.0, f64::max);
        // Each is off by some tolerances.
        assert!(largest > 0.0 && off < 10.0 * TOLERANCE * largest, "{axis}: {off:e} of {largest:e}");
    }
    let (changes, steps) = (with.value("solver.events"), with.value("solver.steps"));
    assert!(changes > 300.0 && 2.0 * steps < without.value("solver.steps"), "{steps} steps, {changes} changes");
    for energy in ["E_diss", "energy.input", "dissipation.E_friction", "dissipation.E_maxwell", "dissipation.E_impact"]
    {
        let (found, wanted) = (with.value(energy), without.value(energy));
        let largest = without.value("energy.input");
        assert!((found - wanted).abs() < 10.0 * TOLERANCE * largest, "{energy}: {found:e} {wanted:e}");
    }
    let residual = with.value("energy.residual");
    assert!(residual.abs() < 10.0 * TOLERANCE * with.value("energy.input"), "{residual:e}");
}

/// The mode after a change is that before the next one of the same mass.
#[test]
fn every_mode_change_in_a_region_is_recorded_once() {
    let scene = scene("'forces', 'solver'");
    let of = |simulation: &Simulation| -> Vec<i8> {
        simulation.run.context.state.layer.state.mode.iter().map(|mode| mode.number()).collect()
    };
    let mut modes = of(&Simulation::new(&scene, &Start::default()).unwrap());
    let run = Rows::new(&scene, 100, None);
    assert_eq!(run.changes.len() as f64, run.value("solver.events"));
    let mut last = 0.0;
    for change in &run.changes {
        assert!(change.time >= last && modes[change.mass] == change.from, "{change:?} after {last} s");
        (modes[change.mass], last) = (change.to, change.time);
    }
    assert_eq!(of(&run.simulation), modes);
}

#[test]
fn rows_do_not_change_a_run_with_regions() {
    let scene = scene("'forces', 'energy', 'elements'");
    let (rare, many) = (Rows::new(&scene, 1, None), Rows::new(&scene, 777, None));
    assert_eq!(rare.end, many.end);
    assert_eq!(rare.changes, many.changes);
}

#[test]
fn a_restored_run_with_regions_goes_on_bit_for_bit() {
    let scene = scene("'forces', 'energy', 'solver', 'elements'");
    let mut run = Rows::new(&scene, 10, None).simulation;
    let mut restored = Simulation::restore(&scene, &run.state()).unwrap();
    for simulation in [&mut run, &mut restored] {
        simulation.advance(&SWING).unwrap();
    }
    assert_eq!(variables_of(&scene, &mut run), variables_of(&scene, &mut restored));
    assert!(variables(&scene).len() > MASSES);
}

/// A motion that fails leaves neither regions nor their mode changes behind.
#[test]
fn a_motion_rolled_back_leaves_no_regions() {
    let mut scene = scene("'forces', 'solver'");
    scene.solver.max_steps = Some(60);
    let mut simulation = Simulation::new(&scene, &Start::default()).unwrap();
    simulation.record_mode_changes(true);
    let before = variables_of(&scene, &mut simulation);
    simulation.advance(&SWING).unwrap_err();
    assert_eq!(variables_of(&scene, &mut simulation), before);
    assert_eq!(simulation.take_mode_changes(), []);
}
