//! `asperity converge`: studies that end within the error and outside it, continued, and what is refused.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use crate::common::{asperity, scratch};

/// Two waves of a sine under 32 masses.
const SINE: &str = r#"
name = "sine"
[layer]
masses = 32
spacing = 6.25e-5
foundation = "half_space"
width = 1e-2
[material]
density = 1100.0
poisson_ratio = 0.5
equilibrium_modulus = 1e6
prony = [ { modulus = 1e6, relaxation_time = 1.6e-3 } ]
[surface]
kind = "sinusoid"
amplitude = 2e-5
wavelength = 1e-3
[solver]
method = "step"
relative_tolerance = 1e-3
"#;

/// Above Westergaard's pressure of full contact, M q a/2 = 84 kPa at rest and twice that of the glass.
const FULL: [&str; 4] = ["--pressure", "2e5", "--speed", "0.1"];

fn rough() -> String {
    let surface = "[surface]\nkind = \"self_affine\"\nlength = 2e-3\npoints = 128\nhurst = 0.8\nrms = 5e-6\n\
                   roll_off_wavelength = 1e-3\ncut_off_wavelength = 2e-4\nseed = 5\n";
    let (start, end) = SINE.split_once("[surface]").unwrap();
    let end = end.split_once("[solver]").unwrap().1;
    format!("{start}{surface}[solver]{end}")
}

fn write(folder: &Path, text: &str) -> (PathBuf, PathBuf) {
    let path = folder.join("scene.toml");
    fs::write(&path, text).unwrap();
    (path, folder.join("table.csv"))
}

fn converge(scene: &Path, table: &Path, options: &[&str]) -> Output {
    asperity().arg("converge").arg(scene).arg("-o").arg(table).args(options).output().unwrap()
}

/// Standard output of a study that ends with this exit status.
#[track_caller]
fn study(scene: &Path, table: &Path, options: &[&str], status: i32) -> String {
    let output = converge(scene, table, options);
    let [text, message] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned());
    assert_eq!(output.status.code(), Some(status), "{text}{message}");
    text
}

/// Standard error of a study that is refused.
#[track_caller]
fn refused(scene: &Path, table: &Path, options: &[&str], status: i32) -> String {
    let output = converge(scene, table, options);
    assert_eq!(output.status.code(), Some(status), "{options:?}");
    assert!(output.stdout.is_empty());
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The values of a column, by its name without the unit.
fn column(table: &str, name: &str) -> Vec<String> {
    let mut lines = table.lines().filter(|line| !line.starts_with('#'));
    let mut names = lines.next().unwrap().split(',').map(|name| name.split(" [").next().unwrap());
    let index = names.position(|other| other == name).unwrap_or_else(|| panic!("no column {name}"));
    lines.map(|line| line.split(',').nth(index).unwrap().to_owned()).collect()
}

fn numbers(table: &str, name: &str) -> Vec<f64> {
    column(table, name).iter().map(|value| value.parse().unwrap()).collect()
}

/// In full contact all is exact: the area is 1, μ = (qa)² Im M(qv)/(4p), and one halving is enough.
#[test]
fn full_contact_of_a_sine_converges_at_once() {
    let folder = scratch("converge-sine");
    let (scene, path) = write(&folder, SINE);
    let text = study(&scene, &path, &FULL, 0);
    assert!(text.contains("\nVerdict     converged: "), "{text}");
    let table = fs::read_to_string(&path).unwrap();
    assert!(table.contains("\n# verdict = converged: "));
    assert_eq!(column(&table, "masses"), ["32", "64", "128"]);
    assert_eq!(numbers(&table, "spacing"), [6.25e-5, 3.125e-5, 3.125e-5]);
    assert_eq!(numbers(&table, "length"), [2e-3, 2e-3, 4e-3]);
    assert_eq!(numbers(&table, "area"), [1.0; 3]);
    assert_eq!((column(&table, "seed")[0].as_str(), column(&table, "friction_change")[0].as_str()), ("", ""));
    // Im M = x/(1 + x²) E_1/(1 - ν²), x = q v τ = 1.005; q a = 0.1257.
    let exact = 0.1257_f64.powi(2) * 0.5 * 1e6 / 0.75 / (4.0 * 2e5);
    let friction = numbers(&table, "friction");
    // What the fit misses at one wave, (1 + (2p/M)²) of tilted pressures and the open ends of the chain.
    assert!(friction.iter().all(|friction| (friction / exact - 1.0).abs() < 0.15), "{friction:?}, exact {exact}");
    let change: f64 = column(&table, "friction_change")[1].parse().unwrap();
    assert!((change - (friction[1] - friction[0]) / friction[1]).abs() < 1e-12);
    assert!(table.lines().count() == 11 && path.with_extension("svg").exists());
}

/// A tenth of M, 0.133 MPa, is passed by the pressure of the study alone: the scene has no phases.
#[test]
fn a_pressure_beyond_the_links_is_warned_of_once() {
    let folder = scratch("converge-hard");
    let (scene, path) = write(&folder, SINE);
    let warnings = |output: &Output| String::from_utf8_lossy(&output.stderr).matches("pressed too hard").count();
    let study = converge(&scene, &path, &["--pressure", "2e5", "--speed", "0.1", "--error", "0.5"]);
    assert_eq!(warnings(&study), 1, "{study:?}");
    let sweep = |loads: &[&str]| {
        let mut command = asperity();
        command.arg("sweep").arg(&scene).args(["--speeds", "0.1,1", "--force", "-o"]).arg(folder.join("sweep.csv"));
        warnings(&command.args(loads).output().unwrap())
    };
    assert_eq!(sweep(&["--pressures", "1e5,2e5"]), 1);
    assert_eq!(sweep(&["--forces", "4"]), 1, "4 N on 2e-5 m² are 2e5 Pa");
    assert_eq!(sweep(&["--pressures", "1e5"]), 0);
}

/// With a small error and few masses the spacing stays open; chance and length are judged nevertheless.
#[test]
fn a_rough_surface_stays_open_with_few_masses() {
    let folder = scratch("converge-rough");
    let (scene, path) = write(&folder, &rough());
    let picture = folder.join("picture.png");
    let options = ["--pressure", "2e4", "--speed", "0.1", "--error", "0.004", "--most-masses", "100", "--seeds", "3"];
    let text = study(&scene, &path, &[&options[..], &["--plot", picture.to_str().unwrap()]].concat(), 3);
    assert!(text.contains("\nVerdict     not converged: "), "{text}");
    assert!(text.contains("standard deviation over 3 seeds") && text.contains("Persson     area 0."), "{text}");
    let table = fs::read_to_string(&path).unwrap();
    assert_eq!(column(&table, "masses"), ["32", "64", "128", "64", "64"]);
    assert_eq!(column(&table, "seed"), ["5", "5", "5", "6", "7"]);
    assert!(column(&table, "status").iter().all(|status| status == "steady"));
    // Another seed is another surface, and so is one of twice the length.
    let friction = numbers(&table, "friction");
    assert!((0..5).all(|i| (0..i).all(|j| friction[i] != friction[j])), "{friction:?}");
    assert!(numbers(&table, "persson_area_2d").iter().all(|area| (0.0..1.0).contains(area)));
    assert!(picture.exists());
}

/// A table cut off after a row or within it is completed; runs done are kept.
#[test]
fn a_table_cut_off_is_completed() {
    let folder = scratch("converge-resume");
    let (scene, path) = write(&folder, &SINE.replace("masses = 32", "masses = 16"));
    let text = study(&scene, &path, &FULL, 0);
    let whole = fs::read_to_string(&path).unwrap();
    let without_times = |table: &str| {
        let lines = table.lines().map(|line| line.rsplit_once(',').map_or(line, |(start, _)| start).to_owned());
        lines.collect::<Vec<_>>()
    };
    let row = whole.find("\n0,1,0,16").unwrap() + 1;
    let end = row + whole[row..].find('\n').unwrap() + 1;
    // Within the header, within the first row, within the second.
    for cut in [40, row + 30, end + 30] {
        fs::write(&path, &whole[..cut]).unwrap();
        study(&scene, &path, &FULL, 0);
        assert_eq!(without_times(&fs::read_to_string(&path).unwrap()), without_times(&whole), "cut off after {cut}");
    }
    // Nothing is left to do: the times stay as they were written.
    fs::write(&path, &whole).unwrap();
    assert_eq!(study(&scene, &path, &FULL, 0), text);
    assert_eq!(fs::read_to_string(&path).unwrap(), whole);
    // Another pressure is another study.
    let other = ["--pressure", "3e5", "--speed", "0.1"];
    assert!(refused(&scene, &path, &other, 1).contains("is the table of another study"));
    study(&scene, &path, &[&FULL[..], &["--force"]].concat(), 0);
    assert_eq!(without_times(&fs::read_to_string(&path).unwrap()), without_times(&whole));
}

/// A run that does not become steady is a row with its reason, and what it was to tell is not known.
#[test]
fn runs_that_are_not_steady_are_rows() {
    let folder = scratch("converge-unsteady");
    let (scene, path) = write(&folder, SINE);
    let text = study(&scene, &path, &[&FULL[..], &["--set", "solver.max_steps=3"]].concat(), 3);
    assert!(text.contains("gave up at t = "), "{text}");
    assert!(text.contains("Verdict     not converged: what "), "{text}");
    assert_eq!(column(&fs::read_to_string(&path).unwrap(), "masses"), ["32", "64"]);
}

#[test]
fn invalid_studies_are_refused() {
    let folder = scratch("converge-refused");
    let (scene, path) = write(&folder, SINE);
    let direct = "name = 'd'\nlayer = { masses = 4, spacing = 1e-4, mass = 1e-7, vertical = { stiffness = 1e3 } }\n\
                  surface = { kind = 'flat' }";
    fs::write(folder.join("direct.toml"), direct).unwrap();
    assert!(refused(&folder.join("direct.toml"), &path, &FULL, 1).contains("direct form"));
    let heights = SINE.replace("masses = 32", "masses = 2\nroughness = { kind = \"points\", z = [0.0, 1e-6] }");
    fs::write(folder.join("heights.toml"), heights).unwrap();
    assert!(refused(&folder.join("heights.toml"), &path, &FULL, 1).contains("one height for each mass"));
    let asked = |options: &[&str], status: i32| refused(&scene, &path, &[&FULL[..], options].concat(), status);
    assert!(asked(&["--most-masses", "63"], 1).contains("expected at least 64"));
    assert!(asked(&["--seeds", "1"], 2).contains("from 2 to 1000"));
    assert!(asked(&["--error", "0"], 2).contains("a share above 0"));
    assert!(refused(&scene, &path, &["--speed", "1", "--pressure", "-1"], 2).contains("a number above 0"));
    assert!(refused(&scene, &path, &["--speed", "1"], 2).contains("--pressure"));
    assert!(refused(&scene, &scene, &FULL, 1).contains("will not write"));
    assert!(!path.exists());
    fs::write(&path, "time,u,w\n0,0,0\n").unwrap();
    assert!(asked(&[], 1).contains("not the table of a study"));
}
