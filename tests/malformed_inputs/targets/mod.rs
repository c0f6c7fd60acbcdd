//! The fuzz targets: functions of arbitrary bytes that panic where the library violates its specification.

pub mod fmi_calls;
pub mod patch;
pub mod patch_motion;
pub mod profile;
pub mod scene;
pub mod seal;
pub mod state;
pub mod table;

mod fmu;
#[path = "../../common/master.rs"]
#[allow(dead_code, reason = "shared by several tests")]
mod master;
mod number;
mod patches;
