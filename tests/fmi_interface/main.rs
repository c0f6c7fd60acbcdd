//! The FMU driven through its C functions, as a master drives it.
#![allow(unsafe_code, unreachable_pub, clippy::unwrap_used, clippy::panic)]

#[allow(dead_code, reason = "shared by several tests")]
#[path = "../common/mod.rs"]
mod common;
#[allow(dead_code, reason = "shared by several tests")]
#[path = "../common/sweeps.rs"]
mod sweeps;

mod derivatives;
mod element;
mod failures;
mod instantiation;
mod lifecycle;
mod logging;
mod many;
mod master;
mod material;
mod states;
mod stepping;
mod values;
