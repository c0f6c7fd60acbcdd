//! The roughness below the profile: its law and runs with it against an independent program (tests/reference/fine).

use std::path::PathBuf;

use asperity::model::{FineFriction, Flash, FlashKernel, FrictionLaw};
use asperity::scene::Scene;

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
        let whole = law.limit(normal) + law.slip(normal, speed, Flash::default()).excess;
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

#[test]
fn runs_are_those_of_the_reference() {
    for name in ["fine-flat", "fine-rough"] {
        for method in ["event", "step", "auto"] {
            let folder = scratch(&format!("fine-{name}-{method}"));
            let method = format!("solver.method={method}");
            let found = simulate(
                &file(&format!("{name}.toml")),
                &folder,
                &["--set", &method, "--set", "solver.relative_tolerance=1e-6"],
            );
            // What the tables are off, and the tolerance.
            compare(name, &found, 1e-3);
        }
    }
}
