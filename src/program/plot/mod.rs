//! Pictures as SVG, and as PNG where asked for.

mod axis;
mod chart;
mod curves;
mod files;
mod history;
mod labels;
mod ladders;
mod logarithmic;
mod panels;
mod profile;
mod raster;

pub(crate) use curves::{Curve, CurvePanel, Curves, Stroke};
pub(crate) use files::plot_files;
pub(crate) use history::History;
pub(crate) use ladders::{Ladder, Ladders, Panel, Rung};
pub(crate) use panels::{Dash, FrictionCurve, SidePanel, SidePanels};
pub(crate) use profile::ProfilePicture;
pub(crate) use raster::png;
