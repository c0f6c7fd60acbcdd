//! A point-contact element from a sweep's table: packed, validated and driven in fmpy, compared with the layer that was
//! swept.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::common::scenes::SceneText;
use crate::common::sweeps::{Grid, REST, WARM, separation};
use crate::common::{Table, asperity, assert_names, drive, fmpy, largest, library, python, run, scratch};
use asperity::element::{Element, FrictionTable as Sweep, PointContact};
use asperity::simulation::Start;

/// Packs a table beside it and returns the FMU and what was printed.
fn pack(table: &Path, options: &[&str]) -> (PathBuf, String) {
    let fmu = table.with_extension("fmu");
    let mut command = asperity();
    command.args(["pack", "--table"]).arg(table).arg("-o").arg(&fmu).arg("--library").arg(library()).args(options);
    let text = run(&mut command);
    (fmu, text)
}

fn table(folder: &Path, grid: &Grid) -> PathBuf {
    let path = folder.join("known.csv");
    fs::write(&path, grid.text()).unwrap();
    path
}

#[test]
fn a_packed_element_is_valid() {
    let folder = scratch("element-validate");
    let warm = Grid { temperatures: vec![290.0, 300.0, 310.0], ..Grid::plain() };
    for grid in [Grid::plain(), warm] {
        let (fmu, text) = pack(&table(&folder, &grid), &[]);
        assert_eq!(fmpy(&["validate", fmu.to_str().unwrap()]).trim(), "No problems found.");
        for part in ["11 from 0.0001 to 10 m/s", "one speed and looked up over the gap", "one pressure"] {
            assert!(text.contains(part), "{text}");
        }
        assert_eq!(text.contains("one temperature"), !grid.temperatures.is_empty(), "{text}");
        let names = "import sys, zipfile; print(*sorted(zipfile.ZipFile(sys.argv[1]).namelist()))";
        let names = run(Command::new(python()).args(["-c", names]).arg(&fmu));
        for part in
            ["resources/table.csv", "documentation/index.html", "model.png", "binaries/linux64/known_law_element.so"]
        {
            assert!(names.contains(part), "{names}");
        }
        assert!(!names.contains("scene.toml"), "{names}");
    }
}

/// A motion that presses, slips, lifts a little and turns, with rates given: fmpy and the library give the same.
#[test]
fn driven_in_fmpy_it_gives_what_the_library_gives() {
    let folder = scratch("element-fmpy");
    let path = table(&folder, &Grid::plain());
    let (fmu, _) = pack(&path, &[]);
    let start = separation(1e-4, 2e5, WARM) - REST;
    let corners = [(0.0, 0.0, 0.0), (0.01, 1e-3, -2e-6), (0.03, -1e-3, 0.0), (0.04, -1e-3, 2e-5), (0.06, 2e-3, -1e-6)];
    let mut rows = Vec::new();
    for pair in corners.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let at = |a: f64, b: f64, i: u32| a + (b - a) * f64::from(i) / 40.0;
        rows.extend((0..40).map(|i| vec![at(a.0, b.0, i), at(a.1, b.1, i), start + at(a.2, b.2, i)]));
    }
    let motion = Table::new(["time", "u", "w"], rows);
    motion.write(&folder.join("motion.csv"));
    let driven = drive(&fmu, &folder.join("motion.csv"), &[]);
    let contact = PointContact::new(Sweep::load(&path).unwrap());
    let variables = contact.variables();
    let [time, u, w] = ["time", "u", "w"].map(|name| motion.column(name));
    let rate = |values: &[f64], i: usize| (values[i + 1] - values[i]) / (time[i + 1] - time[i]);
    let start = Start { u: u[0], w: w[0], u_rate: rate(&u, 0), w_rate: rate(&w, 0), ..Start::default() };
    let mut element = Element::new(&contact, &start).unwrap();
    let mut own = vec![vec![0.0; variables.len()]];
    element.evaluate(&variables, &mut own[0]);
    for i in 0..time.len() - 1 {
        element.advance(time[i + 1] - time[i], rate(&u, i), rate(&w, i)).unwrap();
        let mut row = vec![0.0; variables.len()];
        element.evaluate(&variables, &mut row);
        own.push(row);
    }
    for (column, variable) in variables.iter().enumerate() {
        let (found, own) = (driven.column(&variable.name), own.iter().map(|row| row[column]).collect::<Vec<_>>());
        // The rates come from differences of positions, so their rounding changes the last digits.
        let error = found.iter().zip(&own).fold(0.0_f64, |error, (a, b)| error.max((a - b).abs()));
        assert!(error <= 1e-8 * largest(&own), "{}: {error:e} of {:e}", variable.name, largest(&own));
    }
    assert!(largest(&driven.column("F_x")) > 1.0);
}

#[test]
fn an_incomplete_table_is_refused() {
    let folder = scratch("element-refused");
    let path = folder.join("known.csv");
    fs::write(&path, Grid::plain().text().replacen("steady", "not steady after 0.1 m", 1)).unwrap();
    let output = asperity().args(["pack", "--table"]).arg(&path).arg("-o").arg(folder.join("x.fmu")).output().unwrap();
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert_names(&text, "0.0001 m/s, 100000 Pa | 0.1 m");
    assert!(!folder.join("x.fmu").exists());
}

/// Three masses on a wave that stick and slip.
pub fn waves() -> SceneText {
    SceneText::new(3, 3.0e-5, 1.0e-7)
        .set("name", "wave")
        .vertical((2.0e3, 2.0e-2, [(1.0e3, 1.0e-4)]))
        .horizontal((4.0e3, 2.0e-2))
        .sinusoid(1.0e-6, 9.0e-5)
        .coulomb(0.4)
        .relative(1.0e-4)
}

/// Sweep, pack, check. In the middle of the cells of so coarse a table the element is within some per cent.
#[test]
fn swept_packed_and_checked_it_is_near_the_layer() {
    let folder = scratch("element-check");
    let (scene, path) = (folder.join("wave.toml"), folder.join("wave.csv"));
    fs::write(&scene, waves().text()).unwrap();
    let sweep = ["--speeds", "0.02..0.5/4", "--forces", "0.01,0.02,0.04", "-o"];
    run(asperity().arg("sweep").arg(&scene).args(sweep).arg(&path));
    let (fmu, text) = pack(&path, &["--check", scene.to_str().unwrap(), "--check-points", "6"]);
    assert_names(&text, "6 of 6 points");
    let checked = folder.join("wave-check");
    for file in ["points.csv", "errors.svg", "loop-layer.csv", "loop-element.csv", "loop.svg"] {
        assert!(checked.join(file).is_file(), "{file}");
    }
    let points = Table::read(&checked.join("points.csv"));
    for name in ["F_x error", "F_z error", "P_diss error"] {
        assert!(largest(&points.column(name)) < 0.05, "{name}: {points:?}");
    }
    let index = "import sys, zipfile; print(zipfile.ZipFile(sys.argv[1]).read('documentation/index.html').decode())";
    let page = run(Command::new(python()).args(["-c", index]).arg(&fmu));
    assert!(page.contains("6 of 6 points between") && page.contains("to and fro by"), "{page}");
}
