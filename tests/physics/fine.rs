//! The roughness below the profile: its law and runs with it against an independent program (tests/reference/fine).

use std::path::PathBuf;

use asperity::model::{FineFriction, FlashKernel, FrictionLaw, SlipHistory};
use asperity::scene::{Method, OutputGroup, Scene};
use asperity::simulation::{Simulation, Start};

use crate::common::runs::{straight, value};
use crate::common::{Table, difference, largest, root, scratch, simulate};

fn file(name: &str) -> PathBuf {
    root().join(format!("tests/reference/fine/{name}"))
}

/// μ_h, A_r/A and T at temperatures, pressures and speeds, 0 at rest: within the accuracy of the tables.
#[test]
fn the_law_is_that_of_the_sums() {
    const ACCURACY: f64 = 1e-4;
    let text = std::fs::read_to_string(file("law.csv")).unwrap();
    for line in text.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let [temperature, pressure, speed, friction, share, force] =
            [1, 2, 3, 4, 5, 6].map(|i| cells[i].parse::<f64>().unwrap());
        let mut scene = Scene::load(&file(&format!("{}.toml", cells[0]))).unwrap();
        scene.material.as_mut().unwrap().wlf.as_mut().unwrap().temperature = temperature;
        let (law, fine) = (FrictionLaw::new(&scene), FineFriction::new(&scene).unwrap());
        let normal = pressure * scene.layer.element_area().unwrap();
        let contact = fine.contact(normal, speed);
        let whole = law.slip(normal, speed, &SlipHistory::default()).force();
        let found = [contact.hysteresis.value / normal, contact.share.value, whole];
        for (name, found, expected) in
            [("friction", found[0], friction), ("area", found[1], share), ("T", found[2], force)]
        {
            assert!((found - expected).abs() <= ACCURACY * expected, "{line}: {name} {found}");
        }
    }
}

/// The kernel of heat and its integral, with the rubber's share.
#[test]
fn the_flash_kernel_is_that_of_conduction() {
    let text = std::fs::read_to_string(file("heat.csv")).unwrap();
    for line in text.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let [time, rise, kernel] = [1, 2, 3].map(|i| cells[i].parse::<f64>().unwrap());
        let scene = Scene::load(&file(&format!("{}.toml", cells[0]))).unwrap();
        let found = FlashKernel::new(&scene).unwrap();
        if time < 0.99e-6 {
            continue;
        }
        // What the law of heat allows.
        assert!((found.value(time) / kernel - 1.0).abs() < 0.02, "{line}: {}", found.value(time));
        assert!((1e6 * found.rise(time) / rise - 1.0).abs() < 0.01, "{line}: {}", 1e6 * found.rise(time));
    }
}

/// The columns by what they are measured by: forces by the largest value of their own, energies by the largest energy.
fn compare(name: &str, found: &Table, bound: f64) {
    let wanted = Table::read(&file(&format!("{name}.csv")));
    let energy = largest(&wanted.column("energy.input"));
    for column in wanted.names() {
        let scale = match column.as_str() {
            "time" | "u" | "w" | "P_diss" | "contact.count" | "contact.sticking" => continue,
            column if column.starts_with("energy") || column.contains("E_") => energy,
            column => largest(&wanted.column(column)),
        };
        // A channel that the scene cannot have is no column, and 0 in the reference.
        let wanted = wanted.column(column);
        let error = difference(&found.get(column).unwrap_or_else(|| vec![0.0; wanted.len()]), &wanted);
        assert!(error <= bound * scale, "{name}: {column} differs by {:e} of {scale:e}", error / scale);
    }
}

fn run(name: &str, method: &str, tolerance: &str) -> Table {
    let folder = scratch(&format!("{name}-{method}"));
    let [method, tolerance] = [format!("solver.method={method}"), format!("solver.relative_tolerance={tolerance}")];
    simulate(&file(&format!("{name}.toml")), &folder, &["--set", &method, "--set", &tolerance])
}

#[test]
fn runs_are_those_of_the_reference() {
    for name in ["fine-flat", "fine-rough", "memory-flat", "memory-rough"] {
        for method in ["event", "step", "auto"] {
            // What the tables are off, and the tolerance.
            compare(name, &run(name, method, "1e-6"), 1e-3);
        }
    }
}

/// Contacts that warm: stuck to and slipping by turns, lifting, friction that falls with its heat or rises.
#[test]
fn heated_runs_are_those_of_the_reference() {
    // By time-stepping the hot one takes some 250 000 steps at 1e-6.
    let runs = [
        ("fine-heat", "1e-6"),
        ("fine-rough-heat", "1e-6"),
        ("fine-cool", "1e-6"),
        ("fine-hot", "1e-5"),
        ("memory-heat", "1e-6"),
    ];
    for (name, of_step) in runs {
        for (method, tolerance) in [("event", "1e-6"), ("step", of_step), ("auto", "1e-6")] {
            // The kernel of the reference is off by 2e-3 of the rise; the instants of slips follow it.
            compare(name, &run(name, method, tolerance), 1e-2);
        }
    }
}

/// What friction does on the masses heats them, but for the part that the hard side takes.
#[test]
fn heat_is_the_work_of_friction() {
    let set = ["--set", "fmu.outputs=['energy', 'dissipation', 'elements']", "--set", "solver.relative_tolerance=1e-6"];
    let found = simulate(&file("fine-heat.toml"), &scratch("heat-energy"), &[&set[..], &["--rows", "20001"]].concat());
    let [time, force, x] = ["time", "element[1].F_T", "element[1].x"].map(|name| found.column(name));
    let mut work = 0.0;
    for i in 1..time.len() {
        work += 0.5 * (force[i] + force[i - 1]) * (x[i] - x[i - 1]);
    }
    let heat = *found.column("energy.heat").last().unwrap();
    // The trapezoidal rule between rows, of which friction jumps in a few.
    assert!((heat / (0.8 * work) - 1.0).abs() < 2e-3, "{heat:e} J of {work:e} J");
    assert!((heat / (0.8 * found.column("dissipation.E_friction").last().unwrap()) - 1.0).abs() < 1e-12);
}

/// The scene of one heated mass with this friction and this roughness.
fn heated(friction: &str, fine: &str) -> Scene {
    let text = std::fs::read_to_string(file("fine-heat.toml")).unwrap();
    let (before, rest) = text.split_once("fine = {").unwrap();
    let (_, rest) = rest.split_once("[friction]\nmemory = 0.0\nshear_strength = 1000000.0").unwrap();
    let text = format!("{before}fine = {{ {fine} }}\n{friction}\n{rest}");
    Scene::parse(&text, &file("heated.toml")).unwrap()
}

/// Heat made at the depth of one band: ρcϑ = χQ q t before it flows.
#[test]
fn a_constant_flux_heats_at_its_depth_first() {
    const CAPACITY: f64 = 1100.0 * 1700.0;
    let rise = |scene: &Scene, time: f64| FlashKernel::new(scene).unwrap().rise(time);
    let band = heated("", "hurst = 0.8, longest = 1.05e-3, shortest = 0.95e-3, rms_slope = 0.5");
    let q = std::f64::consts::TAU / (1.05e-3 * 0.95e-3_f64).sqrt();
    for time in [1e-5, 1e-4] {
        let expected = 0.8 * q * time / CAPACITY;
        // D q² t is 5e-4 at most; heat flows away by its root.
        assert!((rise(&band, time) / expected - 1.0).abs() < 3e-2, "{time:e}: {:e}", rise(&band, time) / expected);
    }
}

/// A master's steps a hundred times as short lead to the same friction: no step takes another of several solutions.
#[test]
fn short_steps_stay_on_the_branch() {
    let scene = Scene::load(&file("fine-hot.toml")).unwrap();
    let at_end = |pieces: u32| {
        let mut simulation = Simulation::new(&scene, &Start::default()).unwrap();
        for phase in &scene.excitation[..2] {
            let duration = phase.duration / f64::from(pieces);
            for _ in 0..pieces {
                simulation.advance(&straight(duration, phase.u.rate, phase.w.rate)).unwrap();
            }
        }
        ["F_x", "contact.flash_mean"].map(|name| value(&scene, &simulation.snapshot(), name))
    };
    let ([force, flash], [force_of_pieces, flash_of_pieces]) = (at_end(1), at_end(2000));
    assert!(flash > 10.0, "{flash}");
    assert!((force_of_pieces / force - 1.0).abs() < 1e-2, "{force} {force_of_pieces}");
    assert!((flash_of_pieces / flash - 1.0).abs() < 1e-2, "{flash} {flash_of_pieces}");
}

/// ∂F_x/∂u at the end of a motion against a difference quotient, of a mass that slips and warms: it carries what the
/// temperature changes of friction.
#[test]
fn tangents_carry_the_heat() {
    for (name, method) in [("fine-heat", Method::Event), ("fine-heat", Method::Step), ("fine-cool", Method::Event)] {
        let mut scene = Scene::load(&file(&format!("{name}.toml"))).unwrap();
        scene.outputs = vec![OutputGroup::Forces, OutputGroup::Tangent, OutputGroup::Contact, OutputGroup::Solver];
        scene.solver.method = method;
        (scene.solver.relative_tolerance, scene.solver.absolute_tolerance) = (1e-6, Some(1e-13));
        let mut start = Simulation::new(&scene, &Start::default()).unwrap();
        start.advance(&straight(scene.excitation[0].duration, 0.0, scene.excitation[0].w.rate)).unwrap();
        start.advance(&straight(2e-3, 1.0, 0.0)).unwrap();
        let duration = 2e-5;
        let after = |u: f64| {
            let mut simulation = start.clone();
            simulation.advance(&straight(duration, 1.0 + u / duration, 0.0)).unwrap();
            ["F_x", "tangent.dF_x_du", "solver.events", "contact.flash_mean"]
                .map(|name| value(&scene, &simulation.snapshot(), name))
        };
        let moved = 1e-9;
        let ([_, tangent, events, flash], up, down) = (after(0.0), after(moved), after(-moved));
        assert!(up[2] == events && down[2] == events && flash > 1.0, "{name}: {flash} K");
        let quotient = (up[0] - down[0]) / (2.0 * moved);
        // Steps are chosen anew for every run, and with them the error, which the quotient magnifies.
        assert!((tangent / quotient - 1.0).abs() < 2e-3, "{name} {method:?}: {tangent} {quotient}");
    }
}
