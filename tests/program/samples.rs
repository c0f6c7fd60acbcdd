//! `asperity sweep --samples` and `pack --quantile`: what is written, in parts and continued, and what is refused.

use std::fs;
use std::path::{Path, PathBuf};

use crate::common::{asperity, assert_names, library, run, scratch};

const SCENE: &str = "name = 'rough'
layer = { foundation = 'half_space', masses = 32, spacing = 1e-4, width = 1e-2 }
friction = { rate_shear = { strength = 6e6, reference_speed = 1.0, sharpness = 0.1 } }
[material]
density = 1e3
poisson_ratio = 0.5
equilibrium_modulus = 2e6
prony = [{ relaxation_time = 1e-6, modulus = 5e7 }, { relaxation_time = 1e-3, modulus = 1e7 }]
[surface]
kind = 'self_affine'
length = 0.02
points = 256
hurst = 0.8
rms = 1e-5
roll_off_wavelength = 5e-3
cut_off_wavelength = 5e-4
seed = 7
fine = { shortest = 1e-5 }
";
const SECTION: &str = "[uncertainty]
'friction.rate_shear.strength' = { relative = 0.1 }
'surface.fine.shortest' = { factor = 2.0 }
surface = 'seed'
";
const POINTS: [&str; 4] = ["--speeds", "0.1,1", "--pressures", "0.5bar,1bar"];
const SAMPLES: [&str; 4] = ["--samples", "16", "--seed", "3"];

fn scene(folder: &Path, section: &str) -> PathBuf {
    let path = folder.join("rough.toml");
    fs::write(&path, format!("{SCENE}{section}")).unwrap();
    path
}

fn sweep(scene: &Path, table: &Path, options: &[&str]) -> String {
    run(asperity().arg("sweep").arg(scene).arg("-o").arg(table).args(POINTS).args(options))
}

fn text(path: &Path) -> String {
    fs::read_to_string(path).unwrap()
}

#[test]
fn samples_are_written_with_what_matters() {
    let folder = scratch("samples-parts");
    let scene = scene(&folder, SECTION);
    let [whole, kept] = ["whole.csv", "kept.csv"].map(|name| folder.join(name));
    let said = sweep(&scene, &whole, &[&SAMPLES[..], &["--keep", kept.to_str().unwrap()]].concat());
    assert!(said.contains("Samples     16 of seed 3") && said.contains("Matters     "), "{said}");
    assert_names(&said, "the surface's seed");
    assert_eq!(text(&kept).lines().count(), 1 + 16 * 4);
    assert_eq!(text(&folder.join("whole.matters.csv")).lines().count(), 1 + 5 * 3);
    assert!(
        text(&folder.join("whole.matters.svg")).contains("<svg") && text(&folder.join("whole.svg")).contains("90 %")
    );

    // Other samples are another sweep.
    let other =
        asperity().arg("sweep").arg(&scene).arg("-o").arg(&whole).args(POINTS).args(["--samples", "8"]).output();
    assert_names(String::from_utf8_lossy(&other.unwrap().stderr), "another sweep");
}

#[test]
fn a_sweep_without_samples_does_not_know_the_section() {
    let folder = scratch("samples-none");
    let [with, without] = ["with.csv", "without.csv"].map(|name| folder.join(name));
    sweep(&scene(&folder, SECTION), &with, &[]);
    let plain = scene(&folder, "");
    sweep(&plain, &without, &[]);
    assert_eq!(text(&with), text(&without));
    let refused =
        asperity().arg("sweep").arg(&plain).args(POINTS).args(["-o", "x.csv"]).args(SAMPLES).output().unwrap();
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_names(&said, "--samples | [uncertainty]");
}

#[test]
fn an_element_of_a_quantile_is_one_sample() {
    let folder = scratch("samples-pack");
    let scene = scene(&folder, SECTION);
    let [table, fmu] = ["t.csv", "low.fmu"].map(|name| folder.join(name));
    sweep(&scene, &table, &SAMPLES);
    let pack = |options: &[&str]| {
        let mut command = asperity();
        command.arg("pack").arg(&scene).arg("--table").arg(&table).arg("-o").arg(&fmu).args(options);
        command.arg("--library").arg(library());
        command
    };
    let said = run(&mut pack(&["--quantile", "0.05"]));
    let ranking = text(&table).lines().find_map(|line| line.strip_prefix("# ranking = ").map(str::to_owned)).unwrap();
    let lowest = ranking.split(',').next().unwrap();
    let wanted = format!("{lowest} of 16, seed 3: quantile 0.05 of the mean friction over the table");
    assert!(said.contains(&wanted), "{said}");
    assert!(fmu.exists());
    let refused = pack(&[]).output().unwrap();
    assert_names(String::from_utf8_lossy(&refused.stderr), "--quantile");
}
