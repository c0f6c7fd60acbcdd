//! One chart: curves over axes, with or without a legend above them.

use std::error::Error;

use plotters::prelude::*;

use super::axis::Axis;
use super::curve::Curve;
use super::legend::{Legend, Swatch};
use super::picture::{Canvas, Drawn, FINE, GRID, INK, TEXT_SIZE, TICK_SIZE, style};

/// Between the edges of a chart and what is drawn; more at the right, where half of a tick's label is.
const MARGIN: u32 = 6 * FINE;
const RIGHT_MARGIN: u32 = 28 * FINE;
/// Room for ticks and title of the vertical axis, and of the horizontal one.
const BESIDE: u32 = 72 * FINE;
const BELOW: u32 = 46 * FINE;
/// Where the vertical axis stands, and a legend begins.
pub(super) const LEFT: u32 = MARGIN + BESIDE;
const TICK: u32 = 5 * FINE;
/// Room for a label of a tick, so that they do not touch: along a horizontal axis, along a vertical one.
const LABEL: (u32, u32) = (42 * FINE, 28 * FINE);

/// Curves over axes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Chart {
    /// What is written above it; empty for nothing.
    pub(super) title: String,
    /// The horizontal axis.
    pub(super) x: Axis,
    /// The vertical axis.
    pub(super) y: Axis,
    /// The curves, in the order of the legend.
    pub(super) curves: Vec<Curve>,
}

pub(super) type Context<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Axis, Axis>>;

impl Chart {
    /// Draws the names of the curves above, axes and curves below.
    pub(super) fn draw_with_legend(&self, canvas: &Canvas<'_>) -> Drawn {
        let names = self.curves.iter().map(|curve| (curve.name.as_str(), Swatch::of(curve)));
        let legend = Legend::new(names, canvas.dim_in_pixel().0);
        let (above, below) = canvas.split_vertically(legend.height());
        legend.draw(&above)?;
        self.draw(&below)
    }

    /// Draws axes and curves.
    pub(super) fn draw(&self, canvas: &Canvas<'_>) -> Drawn {
        let mut context = context(canvas, &self.title, &self.x, &self.y)?;
        draw_axes(&mut context, &self.x, &self.y)?;
        self.curves.iter().try_for_each(|curve| curve.draw(&mut context, &self.x, &self.y))
    }
}

/// The room for a chart's curves, with nothing drawn but the title.
pub(super) fn context<'a, 'b>(
    canvas: &'a Canvas<'b>,
    title: &str,
    x: &Axis,
    y: &Axis,
) -> Result<Context<'a, 'b>, Box<dyn Error>> {
    let mut builder = ChartBuilder::on(canvas);
    builder.margin(MARGIN).margin_right(RIGHT_MARGIN).x_label_area_size(BELOW).y_label_area_size(BESIDE);
    if !title.is_empty() {
        builder.caption(title, style(TEXT_SIZE));
    }
    Ok(builder.build_cartesian_2d(x.clone(), y.clone())?)
}

/// Draws grid, ticks and titles.
pub(super) fn draw_axes(context: &mut Context<'_, '_>, x: &Axis, y: &Axis) -> Drawn {
    let (width, height) = context.plotting_area().dim_in_pixel();
    context
        .configure_mesh()
        .bold_line_style(GRID.stroke_width(FINE))
        .light_line_style(GRID.mix(0.45).stroke_width(FINE / 2))
        .axis_style(INK.stroke_width(FINE))
        .set_all_tick_mark_size(TICK)
        .x_labels(x.ticks(width, LABEL.0))
        .y_labels(y.ticks(height, LABEL.1))
        .label_style(style(TICK_SIZE))
        .axis_desc_style(style(TEXT_SIZE))
        .x_desc(&x.title)
        .y_desc(&y.title)
        .draw()?;
    Ok(())
}
