//! The FMU: every function of the C interface in every state; real masters; a host in C.
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

#[path = "../common/mod.rs"]
#[allow(dead_code, unreachable_pub, reason = "shared by several tests")]
mod common;
mod coupled;
mod dask;
#[allow(unsafe_code, reason = "calls the functions of the C interface")]
mod fmi_interface;
mod fmpy;
mod grip_mujoco;
mod host;
mod masters;
mod patch_mujoco;
#[path = "../common/sweeps.rs"]
#[allow(dead_code, reason = "shared by several tests")]
mod sweeps;
mod thermal;
