//! `asperity converge`: studies that end within the error and outside it, continued, and what is refused.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use crate::common::scenes::SceneText;
use crate::common::{Table, asperity, assert_names, scratch};

/// Two waves of a sine under 32 masses.
fn sine() -> SceneText {
    SceneText::rubber(32, 6.25e-5, 0.0, 1e-2)
        .without("layer.thickness")
        .with("layer.foundation = 'half_space'\nmaterial.poisson_ratio = 0.5\nmaterial.equilibrium_modulus = 1e6")
        .prony(&[(1e6, 1.6e-3)])
        .sinusoid(2e-5, 1e-3)
        .method("step")
        .relative(1e-3)
}

/// Above Westergaard's pressure of full contact, M q a/2 = 84 kPa at rest and twice that of the glass.
const FULL: [&str; 4] = ["--pressure", "2e5", "--speed", "0.1"];

fn rough() -> SceneText {
    sine().without("surface").with(
        "surface = { kind = 'self_affine', length = 2e-3, points = 128, hurst = 0.8, rms = 5e-6, \
         roll_off_wavelength = 1e-3, cut_off_wavelength = 2e-4, seed = 5 }",
    )
}

fn write(folder: &Path, scene: &SceneText) -> (PathBuf, PathBuf) {
    (scene.write(folder), folder.join("table.csv"))
}

/// A study of the layer.
fn converge(scene: &Path, table: &Path, options: &[&str]) -> Output {
    asperity().args(["converge", "--method", "layer"]).arg(scene).arg("-o").arg(table).args(options).output().unwrap()
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

/// In full contact all is exact: the area is 1, μ = (qa)² Im M(qv)/(4p), and one halving is enough.
#[test]
fn full_contact_of_a_sine_converges_at_once() {
    let folder = scratch("converge-sine");
    let (scene, path) = write(&folder, &sine());
    let text = study(&scene, &path, &FULL, 0);
    assert!(text.contains("\nVerdict     converged: "), "{text}");
    let file = fs::read_to_string(&path).unwrap();
    assert!(file.contains("\n# verdict = converged: "));
    let table = Table::parse(&file);
    assert_eq!(table.texts("masses"), ["32", "64", "128"]);
    assert_eq!(table.column("spacing"), [6.25e-5, 3.125e-5, 3.125e-5]);
    assert_eq!(table.column("length"), [2e-3, 2e-3, 4e-3]);
    // The masses at the open ends lift for an instant.
    assert!(table.column("area").iter().all(|area| *area > 0.999), "{file}");
    assert_eq!((table.text(0, "seed"), table.text(0, "friction_change")), ("", ""));
    // Im M = x/(1 + x²) E_1/(1 - ν²), x = q v τ = 1.005; q a = 0.1257.
    let exact = 0.1257_f64.powi(2) * 0.5 * 1e6 / 0.75 / (4.0 * 2e5);
    let friction = table.column("friction");
    // What the fit misses at one wave and the open ends of the chain.
    assert!(friction.iter().all(|friction| (friction / exact - 1.0).abs() < 0.15), "{friction:?}, exact {exact}");
    let change = table.number(1, "friction_change");
    assert!((change - (friction[1] - friction[0]) / friction[1]).abs() < 1e-12);
    assert!(file.lines().count() == 12 && path.with_extension("svg").exists());
}

/// A tenth of M, 0.133 MPa, is passed by the pressure of the study alone: the scene has no phases.
#[test]
fn a_pressure_beyond_the_links_is_warned_of_once() {
    let folder = scratch("converge-hard");
    let (scene, path) = write(&folder, &sine());
    let warnings = |output: &Output| String::from_utf8_lossy(&output.stderr).matches("pressed too hard").count();
    let study = converge(&scene, &path, &["--pressure", "2e5", "--speed", "0.1", "--error", "0.5"]);
    assert_eq!(warnings(&study), 1, "{study:?}");
    for method in ["layer", "steady"] {
        let sweep = |loads: &[&str]| {
            let mut command = asperity();
            let output = folder.join("sweep.csv");
            command
                .arg("sweep")
                .arg(&scene)
                .args(["--method", method, "--speeds", "0.1,1", "--force", "-o"])
                .arg(output);
            warnings(&command.args(loads).output().unwrap())
        };
        assert_eq!(sweep(&["--pressures", "1e5,2e5"]), 1);
        assert_eq!(sweep(&["--forces", "4"]), 1, "4 N on 2e-5 m² are 2e5 Pa");
        assert_eq!(sweep(&["--pressures", "1e5"]), 0);
    }
    let mut contact = asperity();
    contact.arg("contact").arg(&scene).args(["--pressure", "2e5", "--speed", "0.1", "-o"]).arg(folder.join("c.svg"));
    assert_eq!(warnings(&contact.output().unwrap()), 1);
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
    let table = Table::read(&path);
    assert_eq!(table.texts("masses"), ["32", "64", "128", "64", "64"]);
    assert_eq!(table.texts("seed"), ["5", "5", "5", "6", "7"]);
    assert!(table.texts("status").iter().all(|status| *status == "steady"));
    // Another seed is another surface, and so is one of twice the length.
    let friction = table.column("friction");
    assert!((0..5).all(|i| (0..i).all(|j| friction[i] != friction[j])), "{friction:?}");
    assert!(table.column("persson_area_2d").iter().all(|area| (0.0..1.0).contains(area)));
    assert!(picture.exists());
}

/// A table cut off after a row or within it is completed; runs done are kept.
#[test]
fn a_table_cut_off_is_completed() {
    let folder = scratch("converge-resume");
    let (scene, path) = write(&folder, &sine().set("layer.masses", 16));
    let text = study(&scene, &path, &FULL, 0);
    let whole = fs::read_to_string(&path).unwrap();
    let without_times = |table: &str| {
        let lines = table.lines().map(|line| line.rsplit_once(',').map_or(line, |(start, _)| start).to_owned());
        lines.collect::<Vec<_>>()
    };
    let row = whole.find("\n0,1,0,1,16").unwrap() + 1;
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
    assert!(refused(&scene, &path, &other, 1).contains("is the table of another converge: its fingerprint is"));
    study(&scene, &path, &[&FULL[..], &["--force"]].concat(), 0);
    assert_eq!(without_times(&fs::read_to_string(&path).unwrap()), without_times(&whole));
}

/// A run that does not become steady is a row with its reason, and what it was to tell is not known.
#[test]
fn runs_that_are_not_steady_are_rows() {
    let folder = scratch("converge-unsteady");
    let (scene, path) = write(&folder, &sine());
    let text = study(&scene, &path, &[&FULL[..], &["--set", "solver.max_steps=3"]].concat(), 3);
    assert!(text.contains("gave up at t = "), "{text}");
    assert!(text.contains("Verdict     not converged: what "), "{text}");
    assert_eq!(Table::read(&path).texts("masses"), ["32", "64"]);
}

#[test]
fn invalid_studies_are_refused() {
    let folder = scratch("converge-refused");
    let (scene, path) = write(&folder, &sine());
    fs::write(folder.join("direct.toml"), SceneText::new(4, 1e-4, 1e-7).vertical(1e3).text()).unwrap();
    assert!(refused(&folder.join("direct.toml"), &path, &FULL, 1).contains("direct form"));
    let heights = sine().set("layer.masses", 2).roughness(&[0.0, 1e-6]);
    fs::write(folder.join("heights.toml"), heights.text()).unwrap();
    assert!(refused(&folder.join("heights.toml"), &path, &FULL, 1).contains("one height for each mass"));
    let asked = |options: &[&str], status: i32| refused(&scene, &path, &[&FULL[..], options].concat(), status);
    assert!(asked(&["--most-masses", "63"], 1).contains("expected at least 64"));
    assert!(asked(&["--points", "64"], 1).contains("--points: expected none with --method layer"));
    assert!(asked(&["--seeds", "1"], 2).contains("from 2 to 1000"));
    assert!(asked(&["--error", "0"], 2).contains("a share above 0"));
    assert!(refused(&scene, &path, &["--speed", "1", "--pressure", "-1"], 2).contains("a number from 1e-30 to 1e30"));
    assert!(refused(&scene, &path, &["--speed", "1"], 2).contains("--pressure"));
    assert!(refused(&scene, &scene, &FULL, 1).contains("will not write"));
    assert!(!path.exists());
    fs::write(&path, "time,u,w\n0,0,0\n").unwrap();
    assert_names(asked(&[], 1), "table.csv | # asperity converge = | --force");
}
