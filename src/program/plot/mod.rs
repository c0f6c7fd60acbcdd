//! Pictures as SVG or PNG, by their files' names.

mod axis;
mod chart;
mod curve;
mod files;
mod history;
mod labels;
mod ladders;
mod legend;
mod linear;
mod logarithmic;
mod marker;
mod panels;
mod picture;
mod profile;
mod raster;

pub(crate) use curve::{Curve, Stroke};
pub(crate) use files::plot_files;
pub(crate) use history::History;
pub(crate) use ladders::{Ladder, LadderPanel, Ladders, Rung};
pub(crate) use panels::{Panel, SideBySide, Stacked};
pub(crate) use picture::{Canvas, Drawn, FINE, svg};
pub(crate) use profile::ProfilePicture;
pub(crate) use raster::{SHARP, png};
