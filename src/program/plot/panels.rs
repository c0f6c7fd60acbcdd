//! Several charts with the same horizontal axis, which is logarithmic: below each other, or side by side.

use std::path::Path;

use super::axis::Axis;
use super::chart::Chart;
use super::curve::{Curve, Stroke};
use super::legend::{Legend, Swatch};
use super::linear::Fit;
use super::logarithmic::is_drawn;
use super::picture::{FINE, write};
use crate::program::files::FileError;

/// One chart.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Panel {
    /// What is written beside the vertical axis of a stacked one, above one side by side with others.
    pub(crate) title: String,
    /// In the order of the legend.
    pub(crate) curves: Vec<Curve>,
}

/// Charts below each other: each has a legend and a logarithmic vertical axis of its own.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stacked {
    /// What is written above the picture.
    pub(crate) title: String,
    /// What is written below the horizontal axes.
    pub(crate) x_title: String,
    pub(crate) panels: Vec<Panel>,
}

/// Charts side by side: all have one legend and one vertical axis, which is linear. In the legend a whole line stands
/// for its colour, dashes for what is dashed in any colour.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SideBySide {
    /// What is written below the horizontal axes.
    pub(crate) x_title: String,
    /// What is written beside the vertical axes.
    pub(crate) y_title: String,
    pub(crate) panels: Vec<Panel>,
}

fn points(panels: &[Panel]) -> impl Iterator<Item = (f64, f64)> {
    panels.iter().flat_map(|panel| &panel.curves).flat_map(|curve| curve.points.iter().copied())
}

impl Stacked {
    const WIDTH: u32 = 900;
    const PANEL_HEIGHT: u32 = 380;

    /// Draws the picture: as PNG where `path` ends so, else as SVG.
    pub(crate) fn write(&self, path: &Path) -> Result<(), FileError> {
        let size = (Self::WIDTH, Self::PANEL_HEIGHT * self.panels.len() as u32);
        write(path, size, Some(&self.title), |canvas| {
            let canvases = canvas.split_evenly((self.panels.len(), 1));
            self.charts().zip(&canvases).try_for_each(|(chart, canvas)| chart.draw_with_legend(canvas))
        })
    }

    fn charts(&self) -> impl Iterator<Item = Chart> {
        // What has no place on the vertical axis takes none on the horizontal one.
        let drawn = points(&self.panels).filter(|point| is_drawn(point.1));
        let x = Axis::logarithmic(&self.x_title, drawn.map(|point| point.0));
        self.panels.iter().map(move |panel| {
            let drawn = panel.curves.iter().flat_map(|curve| &curve.points).filter(|point| is_drawn(point.0));
            Chart {
                title: String::new(),
                y: Axis::logarithmic(&panel.title, drawn.map(|point| point.1)),
                x: x.clone(),
                curves: panel.curves.clone(),
            }
        })
    }
}

impl SideBySide {
    /// Width and height of a panel that stands alone, and the width of one of several, pixels.
    const ALONE: (u32, u32) = (800, 480);
    const SEVERAL: u32 = 460;

    /// Draws the picture: as PNG where `path` ends so, else as SVG.
    pub(crate) fn write(&self, path: &Path) -> Result<(), FileError> {
        let width = if self.panels.len() == 1 { Self::ALONE.0 } else { Self::SEVERAL * self.panels.len() as u32 };
        let x = Axis::logarithmic(&self.x_title, points(&self.panels).map(|point| point.0));
        let y = Axis::linear(&self.y_title, "", points(&self.panels).map(|point| point.1), Fit::Round);
        let legend = Legend::new(self.names(), width * FINE);
        write(path, (width, Self::ALONE.1 + legend.height() / FINE), None, |canvas| {
            let (above, below) = canvas.split_vertically(legend.height());
            legend.draw(&above)?;
            let canvases = below.split_evenly((1, self.panels.len()));
            self.panels.iter().zip(&canvases).try_for_each(|(panel, canvas)| {
                let Panel { title, curves } = panel.clone();
                Chart { title, x: x.clone(), y: y.clone(), curves }.draw(canvas)
            })
        })
    }

    /// The whole curves first.
    fn names(&self) -> impl Iterator<Item = (&str, Swatch)> {
        let of = |whole: bool| {
            let curves = self.panels.iter().flat_map(|panel| &panel.curves);
            curves.filter(move |curve| (curve.stroke == Stroke::Line) == whole)
        };
        let whole = of(true).map(|curve| (curve.name.as_str(), Swatch::of(curve)));
        whole.chain(of(false).map(|curve| (curve.name.as_str(), Swatch::of_stroke(curve.stroke))))
    }
}
