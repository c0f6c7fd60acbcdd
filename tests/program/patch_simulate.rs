//! `asperity simulate --patch`: what it says beside the result file.

use std::fs;

use crate::common::{asperity, root, scratch};

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
