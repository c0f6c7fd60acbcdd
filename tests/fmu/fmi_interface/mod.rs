//! The FMU driven through its C functions, as a master drives it.

mod carrier;
mod derivatives;
mod element;
mod failures;
mod hosts;
mod instantiation;
mod lifecycle;
mod logging;
mod many;
#[path = "../../common/master.rs"]
#[allow(dead_code, reason = "shared by several tests")]
mod master;
mod material;
mod patch;
mod provisional;
mod provisional_states;
mod seal;
mod states;
mod stepping;
mod values;
