//! A seal file, its pressures and a motion.
#![no_main]
#![allow(dead_code, reason = "each target is one of those")]

#[path = "../../malformed_inputs/targets/mod.rs"]
mod targets;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| targets::seal::run(bytes));
