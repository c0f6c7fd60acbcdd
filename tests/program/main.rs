//! The command line program and what it reads: scenes, measured data, tables.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::print_stderr,
    unreachable_pub,
    reason = "tests may fail"
)]

mod absent_keys;
mod calibrate;
#[path = "../common/mod.rs"]
#[allow(dead_code, unreachable_pub, reason = "shared by several tests")]
mod common;
mod contact_seen;
mod converge;
mod damper;
mod element;
mod fit;
mod lost;
mod options;
mod patch_check;
mod patch_maps;
mod patch_simulate;
mod peers;
mod pictures;
mod program;
mod report;
mod scene_errors;
mod seal_ring;
mod spoken;
mod steady;
mod surface;
mod sweep;
#[path = "../common/sweeps.rs"]
#[allow(dead_code, reason = "shared by several tests")]
mod sweeps;
mod told;
