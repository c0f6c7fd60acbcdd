//! FMU states of patches as byte strings.
#![no_main]
#![allow(dead_code, reason = "each target is one of those")]

#[path = "../../malformed_inputs/targets/mod.rs"]
mod targets;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| targets::state::run_on_patches(bytes));
