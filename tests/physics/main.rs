//! The layer: exact results, kernels of the integrators, laws of nature on random scenes, references, both methods.
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

mod calibration;
#[path = "../common/mod.rs"]
#[allow(dead_code, unreachable_pub, reason = "shared by several tests")]
mod common;
mod exact;
mod figure_7;
mod fine;
mod foundation;
mod invariants;
mod kernels;
mod leaving_out;
mod load;
mod patch;
mod reduce;
mod reference;
mod rows;
mod steady;
mod step;
mod tangent;
