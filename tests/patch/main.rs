//! Patches of any kind on any motion: what must hold of random ones, and extreme ones.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    unreachable_pub,
    reason = "tests may fail"
)]

#[path = "../physics/invariants/check.rs"]
mod check;
#[path = "../common/mod.rs"]
#[allow(dead_code, reason = "shared by several tests")]
mod common;
mod extreme;
mod invariants;
