//! The suites that share the kit in `common`: the layer and the patch, the program, the FMU.
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

#[allow(dead_code, reason = "shared with other tests and the benchmarks")]
mod common;
mod fmu;
mod physics;
mod program;
#[allow(dead_code, reason = "shared with the example")]
#[path = "../examples/validation/suite/mod.rs"]
mod validation;
