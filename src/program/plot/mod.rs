//! Pictures of runs as SVG.

mod axis;
mod chart;
mod files;
mod history;

pub(crate) use files::plot_files;
pub(crate) use history::History;
