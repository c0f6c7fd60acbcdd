//! Commands that take a seal: what they write and say.

use std::fs;
use std::path::{Path, PathBuf};

use crate::common::{Table, asperity, assert_names, root, run, scratch};

fn seal() -> PathBuf {
    root().join("tests/reference/film/film-strokes.toml")
}

fn said(command: &mut std::process::Command) -> String {
    let done = command.output().unwrap();
    assert!(!done.status.success());
    String::from_utf8(done.stderr).unwrap()
}

/// The case of strokes by the program: as its independent solution; a picture of four panels; forces at the end.
#[test]
fn a_run_is_written_and_drawn() {
    let folder = scratch("seal-simulate");
    let motion = root().join("tests/reference/film/film-strokes.motion.csv");
    let mut simulate = asperity();
    simulate.current_dir(&folder).args(["simulate", "-o", "out.csv", "--plot", "out.svg", "--seal"]).arg(seal());
    let told = run(simulate.arg("--motion").arg(&motion));
    assert!(told.starts_with("At the end  F_x ") && told.contains("160 steps to t = 1 s"), "{told}");
    let [found, expected] =
        [folder.join("out.csv"), root().join("tests/reference/film/film-strokes.csv")].map(|path| Table::read(&path));
    let (found, expected) = (found.column("E_diss"), expected.column("E_diss"));
    // As tests/physics/seal.rs has it.
    assert!((found[160] / expected[160] - 1.0).abs() < 3e-3, "{} {}", found[160], expected[160]);
    let picture = fs::read_to_string(folder.join("out.svg")).unwrap();
    assert_names(&picture, "force on the rod | net leak to the air | x from the sealed side | of contacts");
}

#[test]
fn it_is_described() {
    let told = run(asperity().args(["describe", "--seal"]).arg(seal()));
    assert_names(
        &told,
        "Lip with a film, of 96 cells | 2e6 N/m along the motion | the rod | the film that left comes back",
    );
}

fn curve(folder: &Path, options: &[&str]) -> Table {
    let mut sweep = asperity();
    sweep.current_dir(folder).args(["sweep", "-o", "curve.csv", "--force", "--seal"]).arg(seal());
    run(sweep.args(options));
    Table::read(&folder.join("curve.csv"))
}

/// The case of speeds is a curve, too: its outstroke at the end of each of three steps.
#[test]
fn a_stribeck_curve_is_that_of_steady_runs() {
    let folder = scratch("seal-stribeck");
    let table = curve(&folder, &["--speeds", "2e-3,2e-2,0.2", "--sealed", "0,2MPa", "--plot", "curve.svg"]);
    assert_eq!(table.column("friction").len(), 12);
    assert!(table.column("sealed_pressure [Pa]").iter().filter(|pressure| **pressure == 0.0).count() == 6);
    // Where the film is thicker, contacts bear less.
    let (film, share) = (table.column("thickness [m]"), table.column("contact_share"));
    assert!(film[4] > film[0] && share[4] < share[0], "{film:?} {share:?}");
    // The force is against the motion, out and in.
    let force = table.column("F_x [N]");
    assert!(force.chunks(2).all(|pair| pair[0] < 0.0 && pair[1] > 0.0), "{force:?}");
    assert!(fs::read_to_string(folder.join("curve.svg")).unwrap().contains("viscosity times speed"));
    // As a run over a long way has it.
    let speed = 2e-2;
    fs::write(folder.join("motion.csv"), format!("time,u,sealed_pressure\n0,0,2e6\n1,{speed},2e6\n")).unwrap();
    let mut simulate = asperity();
    simulate.current_dir(&folder).args(["simulate", "--motion", "motion.csv", "-o", "run.csv", "--seal"]).arg(seal());
    run(&mut simulate);
    let long = Table::read(&folder.join("run.csv")).column("F_x")[1];
    // Steady within 1e-4 a width of the lip, and the tolerance of both.
    assert!((force[8] / long - 1.0).abs() < 3e-3, "{} {long}", force[8]);
}

#[test]
fn what_does_not_go_with_a_seal_is_refused() {
    let folder = scratch("seal-refused");
    let mut sweep = asperity();
    let told = said(sweep.current_dir(&folder).args(["sweep", "--temperatures", "300", "--seal"]).arg(seal()));
    assert_names(&told, "--temperatures: expected none");
    let refuse = ["--set", "table.extrapolation=refuse", "--sealed", "9MPa", "--speeds", "1e-3"];
    let told = said(asperity().current_dir(&folder).arg("sweep").args(refuse).arg("--seal").arg(seal()));
    assert_names(&told, "points have no result | the sealed pressure in Pa 9000000 is beyond 0 to 4000000");
    fs::write(folder.join("motion.csv"), "time,u,w\n0,0,0\n1,0,0\n").unwrap();
    let mut simulate = asperity();
    simulate.current_dir(&folder).args(["simulate", "--motion", "motion.csv", "--seal"]).arg(seal());
    assert_names(said(&mut simulate), "columns | no such column of a seal without an approach_stiffness");
    // A table without gaps says what to do.
    let text = fs::read_to_string(seal()).unwrap().replace("film-strokes.table", "block.table");
    for (from, to) in
        [("film/film-strokes.lip.csv", "film-strokes.lip.csv"), ("patch/block.table.csv", "block.table.csv")]
    {
        fs::copy(root().join("tests/reference").join(from), folder.join(to)).unwrap();
    }
    fs::write(folder.join("dry.toml"), text).unwrap();
    let told = said(asperity().args(["describe", "--seal"]).arg(folder.join("dry.toml")));
    assert_names(&told, "block.table.csv | leak_gap and drag_gap | --gaps");
}
