//! Many instances, one after another and in parallel; tests that need a process of their own.

use std::path::Path;
use std::process::Command;
use std::thread;

use crate::fmu::fmi_interface::master::{EVERYTHING, Fmu, OK};

/// Variable with the folder of a test in a process of its own; without it such a test does nothing.
pub const FOLDER: &str = "ASPERITY_TEST_FOLDER";

/// Runs the ignored test `name` of this program in another process.
pub fn run_alone(name: &str, folder: &Path) {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command.args(["--exact", name, "--ignored", "--test-threads=1"]).env(FOLDER, folder);
    let text = crate::common::run(&mut command);
    assert!(text.contains("1 passed"), "{text}");
}

/// Steps into contact and along it with rates and states; all outputs.
fn drive(number: u32) -> Vec<u64> {
    let (fmu, h) = (Fmu::running_with(EVERYTHING), 1e-6);
    let speed = 0.05 * f64::from(number + 1);
    let mut seen = Vec::new();
    for i in 0..100 {
        let time = f64::from(i) * h;
        assert_eq!((fmu.set_real("u", speed * time), fmu.set_real("w", -0.02 * time)), (OK, OK));
        assert_eq!((fmu.set_rate("u", speed), fmu.step(time, h)), (OK, OK));
        fmu.thaw(&fmu.frozen());
        seen.extend(fmu.bits());
    }
    seen
}

#[test]
fn eight_threads_agree_with_one_bit_for_bit() {
    let alone: Vec<_> = (0..8).map(drive).collect();
    let threads: Vec<_> = (0..8).map(|number| thread::spawn(move || drive(number))).collect();
    let together: Vec<_> = threads.into_iter().map(|thread| thread.join().unwrap()).collect();
    assert_eq!(together, alone);
}
