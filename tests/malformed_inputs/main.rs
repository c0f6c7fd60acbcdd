//! The fuzz targets of tests/fuzz for some seconds: on the seeds, on the seeds with changes, on random bytes.
#![allow(
    unsafe_code,
    unreachable_pub,
    missing_docs,
    missing_debug_implementations,
    reason = "tests of the C interface"
)]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stderr, reason = "tests may fail")]

#[path = "../common/random.rs"]
#[allow(dead_code, reason = "shared by several tests")]
mod random;
mod targets;

use std::fs;
use std::path::Path;

use random::Random;

/// The files in `seeds` for a target, in the order of their names.
fn seeds(target: &str) -> Vec<Vec<u8>> {
    let folder =
        Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("tests/malformed_inputs/seeds").join(target);
    let mut files: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    assert!(!files.is_empty());
    files.into_iter().map(|file| fs::read(file).unwrap()).collect()
}

/// Runs a target on its seeds and on `count` changes of each: other bytes in a few places.
fn run(target: &str, body: fn(&[u8]), count: usize) {
    let mut random = Random::new(20_260_101);
    for seed in seeds(target) {
        body(&seed);
        for _ in 0..count {
            let mut bytes = seed.clone();
            for _ in 0..=random.below(4) {
                let place = random.below(bytes.len());
                bytes[place] =
                    if random.below(2) == 0 { b"0123456789.e-[]'= \n"[random.below(19)] } else { random.next() as u8 };
            }
            body(&bytes);
        }
    }
}

#[test]
fn scenes() {
    run("scene", targets::scene::run, 300);
}

#[test]
fn profiles() {
    run("profile", targets::profile::run, 300);
}

#[test]
fn tables() {
    run("table", targets::table::run, 300);
}

#[test]
fn states() {
    run("state", targets::state::run, 100);
    let mut random = Random::new(7);
    (0..3_000).for_each(|length| targets::state::run(&random.bytes(length % 200)));
}

#[test]
fn calls() {
    run("fmi_calls", targets::fmi_calls::run, 100);
    let mut random = Random::new(8);
    (0..3_000).for_each(|length| targets::fmi_calls::run(&random.bytes(length % 300)));
}

#[test]
fn patches() {
    run("patch", targets::patch::run, 300);
}

#[test]
fn seals() {
    run("seal", targets::seal::run, 100);
}

#[test]
fn motions_of_patches() {
    run("patch_motion", targets::patch_motion::run, 100);
    let mut random = Random::new(9);
    (0..3_000).for_each(|length| targets::patch_motion::run(&random.bytes(length % 400)));
}

#[test]
fn states_of_patches() {
    run("patch_state", targets::state::run_on_patches, 100);
    let mut random = Random::new(10);
    (0..3_000).for_each(|length| targets::state::run_on_patches(&random.bytes(length % 200)));
}

#[test]
fn calls_of_patches() {
    run("patch_calls", targets::fmi_calls::run_on_patches, 100);
    let mut random = Random::new(11);
    (0..3_000).for_each(|length| targets::fmi_calls::run_on_patches(&random.bytes(length % 300)));
}
