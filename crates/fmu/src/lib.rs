//! The shared library of an FMU: the functions of FMI 2.0 that [`asperity_fmi`] exports, and nothing else.

pub use asperity_fmi::*;
