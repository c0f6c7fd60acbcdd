//! `asperity simulate --patch`: what it says beside the result file.

use std::fs;

use crate::common::{Table, asperity, root, run, scratch};

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
