//! The command line program and what it reads: scenes, measured data, tables.

mod absent_keys;
mod calibrate;
mod command;
mod contact_seen;
mod converge;
mod damper;
mod element;
mod fit;
mod lost;
mod options;
mod patch_check;
mod patch_maps;
mod patch_simulate;
mod peers;
mod pictures;
mod rank;
mod report;
mod scene_errors;
mod seal_ring;
mod spoken;
mod steady;
mod surface;
mod sweep;
mod sweep_maps;
mod told;
mod workbooks;
