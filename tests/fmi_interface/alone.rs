//! Tests that need a process of their own.

use std::path::Path;
use std::process::Command;

/// Where the process of its own finds what it works on; without it the test is not meant to run.
pub const FOLDER: &str = "ASPERITY_TEST_FOLDER";

/// Runs the ignored test `name` of this program in another process.
pub fn run(name: &str, folder: &Path) {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command.args(["--exact", name, "--ignored", "--test-threads=1"]).env(FOLDER, folder);
    let text = crate::common::run(&mut command);
    assert!(text.contains("1 passed"), "{text}");
}
