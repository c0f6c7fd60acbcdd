//! The FMU: every function of the C interface in every state; real masters; a host in C.

mod coupled;
mod dask;
#[allow(unsafe_code, reason = "calls the functions of the C interface")]
mod fmi_interface;
mod fmpy;
mod grip_mujoco;
mod host;
mod masters;
mod patch_mujoco;
mod references;
mod thermal;
