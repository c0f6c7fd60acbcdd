//! Pictures as SVG, and as PNG where asked for.

mod axis;
mod chart;
mod curves;
mod files;
mod history;
mod labels;
mod ladders;
mod logarithmic;
mod raster;

pub(crate) use curves::{Curve, Curves, CurvesPanel, Stroke};
pub(crate) use files::plot_files;
pub(crate) use history::History;
pub(crate) use ladders::{Ladder, Ladders, Panel, Rung};
pub(crate) use raster::png;
