//! The parts of the tests' kit that the comparisons use.
#![allow(dead_code, reason = "shared with tests")]

#[path = "../../tests/common/runs.rs"]
pub mod runs;
#[path = "../../tests/common/table.rs"]
mod table;

pub use table::Table;
