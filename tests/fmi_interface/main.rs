//! The FMU driven through its C functions, as a master drives it.
#![allow(unsafe_code, unreachable_pub, clippy::unwrap_used)]

mod instantiation;
mod lifecycle;
mod logging;
mod master;
mod states;
mod stepping;
mod values;
