//! `asperity simulate --patch`: what it says beside the result file.

use std::fs;

use crate::common::{Table, asperity, assert_names, ended, library, root, run, scratch};

/// A motion that starts beyond the table is warned of, also where there is no step after the start.
#[test]
fn a_start_beyond_the_table_is_told() {
    let folder = scratch("patch-simulate-start");
    let [motion, output] = ["motion.csv", "out.csv"].map(|name| folder.join(name));
    // 10 mm below the ground.
    fs::write(&motion, "time,x,y,z,roll,pitch,yaw\n0,0,0,-0.01,0,0,0\n").unwrap();
    let mut simulate = asperity();
    simulate.args(["simulate", "--patch"]).arg(root().join("tests/reference/patch/block.toml"));
    let done = simulate.arg("--motion").arg(&motion).arg("-o").arg(&output).output().unwrap();
    let told = String::from_utf8(done.stderr).unwrap();
    assert!(done.status.success(), "{told}");
    assert_eq!(told.matches("is beyond the table at t = 0 s").count(), 1, "{told}");
    assert_eq!(fs::read_to_string(&output).unwrap().lines().count(), 2);
}

/// The run ends with the forces of its last row.
#[test]
fn a_run_ends_with_its_forces() {
    let folder = scratch("patch-simulate-end");
    fs::write(folder.join("motion.csv"), "time,x,y,z,roll,pitch,yaw\n0,0,0,0.001,0,0,0\n1,0,0,0,0,0,0\n").unwrap();
    let patch = root().join("tests/reference/patch/block.toml");
    let mut simulate = asperity();
    simulate.current_dir(&folder).args(["simulate", "--motion", "motion.csv", "-o", "out.csv", "--patch"]).arg(patch);
    let told = run(&mut simulate);
    let table = Table::read(&folder.join("out.csv"));
    assert!(told.starts_with("At the end  force.x 0 N, force.y 0 N, force.z "), "{told}");
    assert!(told.contains("1 steps to t = 1 s"), "{told}");
    let words: Vec<&str> = told.split(['\n', ' ']).skip_while(|word| *word != "force.z").collect();
    let [value, unit] = [words[1], words[2]];
    let scale = [("N", 1.0), ("kN", 1e3), ("mN", 1e-3)].iter().find(|(name, _)| *name == unit).unwrap().1;
    // Three digits are printed.
    let expected = table.column("force.z")[1];
    assert!((value.parse::<f64>().unwrap() * scale / expected - 1.0).abs() < 5e-3, "{told}, {expected}");
}

/// `--units` names the units of the motion's columns and of the variables; those of plain numbers have none.
#[test]
fn units_stand_behind_the_names_of_the_columns() {
    let folder = scratch("patch-simulate-units");
    fs::write(folder.join("motion.csv"), "time,x,y,z,roll,pitch,yaw\n0,0,0,0.001,0,0,0\n1,0,0,0,0,0,0\n").unwrap();
    let header_with = |options: &[&str]| {
        let patch = root().join("tests/reference/patch/block.toml");
        let mut simulate = asperity();
        simulate
            .current_dir(&folder)
            .args(["simulate", "--motion", "motion.csv", "-o", "out.csv", "--patch"])
            .arg(patch);
        run(simulate.args(options));
        fs::read_to_string(folder.join("out.csv")).unwrap().lines().next().unwrap().to_owned()
    };
    let header = header_with(&["--units"]);
    let start = "time [s],x [m],y [m],z [m],roll [rad],pitch [rad],yaw [rad],force.x [N],";
    assert!(header.starts_with(start) && header.contains(",contact.count,"), "{header}");
    let names: Vec<&str> = header.split(',').map(|name| name.split(" [").next().unwrap()).collect();
    assert_eq!(names.join(","), header_with(&[]));
}

/// Friction from a tester, as a spreadsheet has it: read in its units, packed in SI units, "measured" wherever it is told of.
/// Behind its backing the face bears k_n Δ; alone it is refused, with what helps.
#[test]
fn measured_friction_serves_behind_a_backing() {
    let folder = scratch("patch-simulate-measured");
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
    write("tester.csv", "v2 [mm/s];p [bar];Reibwert\n1,0;0,5;0,8\n1,0;2;0,7\n100;0,5;1,1\n100;2;0,9\n");
    let patch = |backing: &str| {
        format!(
            "name = 'pad'\n[table]\npath = 'tester.csv'\ncolumns = {{ speed = 'v2' }}\n[patch]\nshape = 'flat'\n\
             length = 0.02\nwidth = 0.01\nnx = 2\nny = 1\n{backing}\n"
        )
    };
    write("pad.toml", &patch("backing = { normal = 1e9, shear = 4e8 }"));
    write("bare.toml", &patch(""));
    write("motion.csv", "time,x,y,z,roll,pitch,yaw\n0,0,0,0,0,0,0\n1,0,0,-2e-4,0,0,0\n2,0.1,0,-2e-4,0,0,0\n");
    let asked = |words: &[&str]| run(asperity().current_dir(&folder).args(words));
    assert_names(
        asked(&["describe", "--patch", "pad.toml"]),
        "points measured (tester.csv) | 1e9 Pa/m along the normal",
    );
    asked(&["simulate", "--patch", "pad.toml", "--motion", "motion.csv", "-o", "out.csv"]);
    let table = Table::read(&folder.join("out.csv"));
    let [x, z] = ["force.x", "force.z"].map(|name| table.column(name)[2]);
    // 2e-4 m² under 1e9 Pa/m times 2e-4 m, rubbing at 100 mm/s with 0.9 under 2 bar.
    assert!((z / 40.0 - 1.0).abs() < 1e-9 && (x / -36.0 - 1.0).abs() < 1e-9, "{x} {z}");
    let library = library().to_str().unwrap();
    let told = asked(&["pack", "--patch", "pad.toml", "-o", "pad.fmu", "--library", library]);
    assert_names(&told, "Measured | tester.csv");
    let mut archive = zip::ZipArchive::new(fs::File::open(folder.join("pad.fmu")).unwrap()).unwrap();
    let mut read = |name: &str| std::io::read_to_string(archive.by_name(name).unwrap()).unwrap();
    assert!(read("resources/tester.csv").starts_with("speed [m/s],pressure [Pa],friction [1]\n0.001,50000.0,0.8\n"));
    assert_names(read("documentation/index.html"), "Measured | tester.csv");
    for refused in [&["describe", "--patch", "bare.toml"][..], &["pack", "--patch", "bare.toml", "-o", "bare.fmu"]] {
        let (status, _, told) = ended(asperity().current_dir(&folder).args(refused));
        assert!(status == 1, "{told}");
        assert_names(told, "tester.csv | measured | full contact | [patch] backing");
    }
}
