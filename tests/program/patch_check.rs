//! `asperity pack --patch --check`: elements of a patch beside the layer that was swept, and the patch beside a finer one.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::common::{Table, asperity, assert_names, largest, library, python, run, scratch};
use crate::program::element::waves;

/// Speeds of the table, m/s.
const SPEEDS: &str = "0.02..0.5/4";
/// The middle one of three of them, as the check drags to and fro at it.
const MIDDLE: f64 = 0.0584804;

const FLAT: &str = "shape = 'flat'\nlength = 4e-4\nwidth = 2e-4\nnx = 8\nny = 5";

/// A folder with the scene, its table and a patch.
fn example(name: &str, face: &str) -> PathBuf {
    let folder = scratch(name);
    fs::write(folder.join("wave.toml"), waves().text()).unwrap();
    let sweep = ["--speeds", SPEEDS, "--forces", "0.01,0.02,0.04", "-o"];
    run(asperity().arg("sweep").arg(folder.join("wave.toml")).args(sweep).arg(folder.join("wave.csv")));
    let patch = format!("name = 'pad'\n[table]\npath = 'wave.csv'\nnominal_area = 1e-8\n[patch]\n{face}\n");
    fs::write(folder.join("pad.toml"), patch).unwrap();
    folder
}

fn check(folder: &Path, options: &[&str]) -> Output {
    let mut command = asperity();
    command.args(["pack", "--patch"]).arg(folder.join("pad.toml")).arg("-o").arg(folder.join("pad.fmu"));
    command.arg("--library").arg(library()).arg("--check").arg(folder.join("wave.toml")).args(options);
    command.output().unwrap()
}

fn checked(folder: &Path, options: &[&str]) -> String {
    let output = check(folder, options);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn refused(folder: &Path, options: &[&str]) -> String {
    let output = check(folder, options);
    assert!(!output.status.success() && !folder.join("pad.fmu").exists());
    String::from_utf8(output.stderr).unwrap()
}

/// The rows of points.csv, without the status.
fn points(folder: &Path) -> Vec<Vec<f64>> {
    let text = fs::read_to_string(folder.join("pad-check/points.csv")).unwrap();
    let row = |line: &str| {
        assert_eq!(line.split(',').nth(8), Some("compared"), "{line}");
        line.split(',').enumerate().filter(|(i, _)| *i != 8).map(|(_, field)| field.parse().unwrap()).collect()
    };
    text.lines().skip(1).map(row).collect()
}

fn loops(folder: &Path, name: &str) -> Table {
    Table::read(&folder.join(format!("pad-check/loop-{name}.csv")))
}

/// The largest difference of two series over a table's rows, over the largest value.
fn share(found: &Table, reference: &Table, name: &str) -> f64 {
    let (found, reference) = (found.column(name), reference.column(name));
    let differences: Vec<f64> = found.iter().zip(&reference).map(|(a, b)| a - b).collect();
    largest(&differences) / largest(&reference)
}

#[test]
fn elements_are_near_their_layers_and_the_wrench_is_theirs() {
    let folder = example("patch-check", FLAT);
    let text = checked(&folder, &["--check-points", "7"]);
    assert_names(&text, "21 of 21 elements");
    assert_names(&text, "16 by 10 elements");
    for file in ["points.csv", "elements.svg", "errors.svg", "loop.svg"] {
        assert!(folder.join("pad-check").join(file).is_file(), "{file}");
    }
    let points = points(&folder);
    assert_eq!(points.len(), 21);
    // Pressures of the table, 1 to 4 MPa, are covered at each speed; between them so coarse a table is within some per cent.
    for speed in points.chunks(7) {
        let pressures: Vec<f64> = speed.iter().map(|row| row[7]).collect();
        assert!(pressures.iter().all(|p| (1e6..4e6).contains(p)) && pressures[0] > 3.2e6 && pressures[6] < 1.6e6);
        assert!(pressures.is_sorted_by(|a, b| a > b), "{pressures:?}");
        assert!(speed.iter().all(|row| row[10].abs() < 0.05 && row[13].abs() < 0.05), "{speed:?}");
    }
    // To the end of the last leg the elements slide in the pose of the middle speed.
    let elements = loops(&folder, "elements");
    let middle: Vec<&Vec<f64>> = points.iter().filter(|row| (row[0] / MIDDLE - 1.0).abs() < 1e-4).collect();
    let sum = |of: &dyn Fn(&[f64]) -> f64| middle.iter().map(|row| of(row)).sum::<f64>();
    let last = |name: &str| *elements.column(name).last().unwrap();
    let expected = [
        ("force.x", sum(&|row| row[9])),
        ("force.z", sum(&|row| row[12])),
        ("moment.x", sum(&|row| row[3] * row[12])),
        ("moment.z", sum(&|row| -row[3] * row[9])),
    ];
    for (name, expected) in expected {
        // The face leans by 2 % at most: cosines, and heights of the elements over their places along the face.
        assert!((last(name) / expected - 1.0).abs() < 1e-3, "{name}: {} {expected}", last(name));
    }
    assert!(share(&elements, &loops(&folder, "layers"), "force.z") < 0.02);
}

/// Each cell takes the pressure of its middle: of a pressure that is linear over the face, n cells along an axis lack 1/n²
/// of the moment about it.
#[test]
fn doubling_shows_what_a_coarse_grid_lacks() {
    let folder = example("patch-check-doubled", FLAT);
    let text = checked(&folder, &["--check-points", "1"]);
    let (coarse, fine) = (loops(&folder, "patch"), loops(&folder, "doubled"));
    assert!(share(&coarse, &fine, "force.z") < 1e-3);
    let [across, along] = ["moment.x", "moment.y"].map(|name| share(&coarse, &fine, name));
    // 5 and 10 rows, 8 and 16 columns. The table's pressure is not quite linear; moment.y has friction too, which in
    // contact's height has next to no arm.
    assert!((across / (1.0 / 25.0 - 1.0 / 100.0) - 1.0).abs() < 0.2, "{across}");
    assert!((along / (1.0 / 64.0 - 1.0 / 256.0) - 1.0).abs() < 0.4, "{along}");
    assert!(!text.contains("rolling"), "{text}");
    let index = "import sys, zipfile; print(zipfile.ZipFile(sys.argv[1]).read('documentation/index.html').decode())";
    let page = run(Command::new(python()).args(["-c", index]).arg(folder.join("pad.fmu")));
    assert!(page.contains("3 of 3 elements beside") && page.contains("16 by 10 elements"), "{page}");
}

#[test]
fn a_tread_also_rolls() {
    let tread = "shape = 'cylinder'\nradius = 0.02\nlength = 4e-4\nwidth = 2e-4\nnx = 8\nny = 2\ntransport = true";
    let folder = example("patch-check-tread", tread);
    let text = checked(&folder, &["--check-points", "2"]);
    assert!(text.contains("6 of 6 elements") && text.contains("one of 16 by 4 elements"), "{text}");
    assert_names(&text, "0.584804 m/s | 0.0584804 m/s | force.x");
}

#[test]
fn points_cannot_be_doubled_and_may_be_few() {
    let folder = example("patch-check-points", "shape = 'points'\npath = 'pad.csv'");
    fs::write(folder.join("pad.csv"), "x,y,z,area\n0,0,0,1e-9\n").unwrap();
    let text = checked(&folder, &[]);
    assert_names(&text, "3 of 3 elements");
    assert_names(&text, "nx, ny | not done | points");
    let pressure = points(&folder)[0][7];
    assert!((pressure / 4e6 - 1.0).abs() < 1e-6, "{pressure}: closest, at the largest pressure");
}

#[test]
fn too_many_elements_are_not_doubled() {
    let folder = example("patch-check-large", &FLAT.replace("ny = 5", "ny = 31251"));
    let text = checked(&folder, &["--check-points", "1"]);
    assert_names(&text, "not done | 16 by 62502 | 1000000");
}

#[test]
fn another_scene_is_refused() {
    let folder = example("patch-check-refused", FLAT);
    let scene = |text: String| fs::write(folder.join("wave.toml"), text).unwrap();
    scene(waves().set("name", "other").text());
    let text = refused(&folder, &[]);
    assert_names(&text, "\"wave\" | \"other\"");
    scene(waves().set("layer.clearance", 1e-6).text());
    let text = refused(&folder, &[]);
    assert!(text.contains("the separation at w = 0 is") && text.contains("in the table"), "{text}");
    let text = refused(&folder, &["--check-points", "0"]);
    assert_names(&text, "--check-points | 1 or more");
}
