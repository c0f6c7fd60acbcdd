//! A chart: curves over axes, and a legend above them.

use std::error::Error;

use plotters::element::DashedPathElement;
use plotters::prelude::*;

use super::axis::Axis;
use super::{
    Backend, Canvas, DrawResult, FINE, GRID, INK, LINE_WIDTH, SHARP, TEXT_SIZE, TICK_SIZE, colour, text_style,
    text_width,
};

/// Between the edges of a chart and its axes; more at the right, where half of a tick's label stands.
pub(super) const MARGIN: u32 = 6 * FINE;
pub(super) const RIGHT_MARGIN: u32 = 28 * FINE;
/// Space for ticks and title of the vertical axis, and of the horizontal one.
const BESIDE: u32 = 72 * FINE;
pub(super) const BELOW: u32 = 46 * FINE;
/// From the left edge to the vertical axis, and to the legend.
pub(super) const LEFT: u32 = MARGIN + BESIDE;
const TICK: u32 = 5 * FINE;
/// Space for a tick's label along a horizontal and along a vertical axis.
const LABEL: (u32, u32) = (42 * FINE, 28 * FINE);
/// Radius of a circle at a point.
const CIRCLE: i32 = 4 * FINE as i32;
const DOT: i32 = 3 * FINE as i32 / 2;
pub(super) const MARKER: i32 = 5 * FINE as i32;

pub(super) const LEGEND_LINE: u32 = 30 * FINE;
const SYMBOL: u32 = 26 * FINE;
/// Between a symbol and its name; three times that before the next symbol.
const GAP: u32 = 7 * FINE;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stroke {
    Line,
    Dashed,
    Dotted,
    /// A circle at every point, and no line.
    Rings,
    /// A dot at every point, and no line.
    Dots,
    /// A line with a marker at every point.
    Marked,
    /// The outline of a marker at every point, and no line.
    Hollow,
    /// A light area, and a less light one, whose outline the points are.
    WideBand,
    NarrowBand,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Curve {
    pub(crate) name: String,
    /// The number of its colour.
    pub(crate) look: usize,
    pub(crate) stroke: Stroke,
    /// In the units of the quantities; points that an axis cannot show are left out.
    pub(crate) points: Vec<(f64, f64)>,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Chart {
    /// Above the chart; empty for none.
    pub(super) title: String,
    pub(super) x: Axis,
    pub(super) y: Axis,
    /// In the order of the legend.
    pub(super) curves: Vec<Curve>,
}

pub(super) type Context<'a, B> = ChartContext<'a, B, Cartesian2d<Axis, Axis>>;

impl Chart {
    /// Draws the legend and, below it, the chart.
    pub(super) fn draw_with_legend<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        let legend = self.legend(canvas);
        let (above, below) = canvas.split_vertically(legend.height());
        legend.draw(&above)?;
        self.draw(&below)
    }

    /// The legend on a canvas.
    pub(super) fn legend<B: Backend>(&self, canvas: &Canvas<B>) -> Legend {
        let names = self.curves.iter().map(|curve| (curve.name.as_str(), Symbol::for_curve(curve)));
        Legend::new(names, canvas.dim_in_pixel().0)
    }

    pub(super) fn draw<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        let mut context = context(canvas, &self.title, &self.x, &self.y)?;
        draw_axes(&mut context, &self.x, &self.y)?;
        self.curves.iter().try_for_each(|curve| {
            let drawn = |point: &(f64, f64)| Some((self.x.coordinate(point.0)?, self.y.coordinate(point.1)?));
            let points: Vec<_> = curve.points.iter().filter_map(drawn).collect();
            match curve.stroke {
                Stroke::Hollow => draw_markers(canvas, &context, &points, curve.look, MarkerFill::Hollow),
                Stroke::WideBand | Stroke::NarrowBand => {
                    let shade = curve.stroke.shade(colour(curve.look));
                    context.draw_series([Polygon::new(points, shade.filled())])?;
                    Ok(())
                }
                Stroke::Marked => {
                    draw_line(&mut context, points.clone(), curve.stroke, curve.look)?;
                    draw_markers(canvas, &context, &points, curve.look, MarkerFill::Full)
                }
                stroke => {
                    let column = |point: &(f64, f64)| context.backend_coord(point).0 / COLUMN;
                    let points = outline(&points, column);
                    draw_line(&mut context, points, stroke, curve.look)
                }
            }
        })
    }
}

/// Subpixels of a column of a PNG's pixels.
const COLUMN: i32 = (FINE / SHARP) as i32;

/// Points that look like all of `points`: of those that follow each other within a column the first, the lowest, the
/// highest and the last. What swings within a column keeps its height, however many rows it takes.
fn outline(points: &[(f64, f64)], column: impl Fn(&(f64, f64)) -> i32) -> Vec<(f64, f64)> {
    let columns: Vec<i32> = points.iter().map(column).collect();
    let mut kept = Vec::new();
    let mut start = 0;
    for part in columns.chunk_by(|a, b| a == b) {
        let part = &points[start..start + part.len()];
        let by_height = |a: &usize, b: &usize| part[*a].1.total_cmp(&part[*b].1);
        let [low, high] =
            [(0..part.len()).min_by(by_height), (0..part.len()).max_by(by_height)].map(Option::unwrap_or_default);
        let mut seen = [0, low, high, part.len() - 1];
        seen.sort_unstable();
        kept.extend(seen.chunk_by(|a, b| a == b).map(|same| part[same[0]]));
        start += part.len();
    }
    kept
}

/// The plotting area of a chart, with nothing drawn but the title.
pub(super) fn context<'a, B: Backend>(
    canvas: &'a Canvas<B>,
    title: &str,
    x: &Axis,
    y: &Axis,
) -> Result<Context<'a, B>, Box<dyn Error>> {
    let mut builder = ChartBuilder::on(canvas);
    builder.margin(MARGIN).margin_right(RIGHT_MARGIN).x_label_area_size(BELOW).y_label_area_size(BESIDE);
    if !title.is_empty() {
        builder.caption(title, text_style(TEXT_SIZE));
    }
    Ok(builder.build_cartesian_2d(x.clone(), y.clone())?)
}

pub(super) fn draw_axes<B: Backend>(context: &mut Context<'_, B>, x: &Axis, y: &Axis) -> DrawResult {
    draw_mesh(context, x, y, true)
}

/// Draws axes alone, around what has colours everywhere.
pub(super) fn draw_axes_without_lines<B: Backend>(context: &mut Context<'_, B>, x: &Axis, y: &Axis) -> DrawResult {
    draw_mesh(context, x, y, false)
}

fn draw_mesh<B: Backend>(context: &mut Context<'_, B>, x: &Axis, y: &Axis, has_lines: bool) -> DrawResult {
    let (width, height) = context.plotting_area().dim_in_pixel();
    let mut mesh = context.configure_mesh();
    if !has_lines {
        mesh.disable_mesh();
    }
    mesh.bold_line_style(GRID.stroke_width(FINE))
        .light_line_style(GRID.mix(0.45).stroke_width(FINE / 2))
        .axis_style(INK.stroke_width(FINE))
        .set_all_tick_mark_size(TICK)
        .x_labels((width / LABEL.0) as usize)
        .y_labels((height / LABEL.1) as usize)
        .label_style(text_style(TICK_SIZE))
        .axis_desc_style(text_style(TEXT_SIZE))
        .x_desc(&x.title)
        .y_desc(&y.title)
        .draw()?;
    Ok(())
}

/// Draws a curve through drawn values.
pub(super) fn draw_line<B: Backend>(
    context: &mut Context<'_, B>,
    points: Vec<(f64, f64)>,
    stroke: Stroke,
    look: usize,
) -> DrawResult {
    let line = colour(look).stroke_width(LINE_WIDTH);
    if stroke == Stroke::Rings {
        context.draw_series(points.into_iter().map(|point| Circle::new(point, CIRCLE, translucent(colour(look)))))?;
    } else if stroke == Stroke::Dots {
        context.draw_series(points.into_iter().map(|point| Circle::new(point, DOT, colour(look).filled())))?;
    } else if let Some((dash, gap)) = stroke.dashes() {
        context.draw_series([DashedPathElement::new(points, dash, gap, line)])?;
    } else {
        context.draw_series([PathElement::new(points, line)])?;
    }
    Ok(())
}

/// Draws the marker of a curve at each of its drawn values.
fn draw_markers<B: Backend>(
    canvas: &Canvas<B>,
    context: &Context<'_, B>,
    points: &[(f64, f64)],
    look: usize,
    fill: MarkerFill,
) -> DrawResult {
    let (left, top) = canvas.get_base_pixel();
    let places = points.iter().map(|point| context.backend_coord(point));
    places.into_iter().try_for_each(|(x, y)| draw_marker(canvas, (x - left, y - top), look, fill))
}

/// A line through many circles is seen behind them.
fn translucent(colour: RGBColor) -> ShapeStyle {
    colour.mix(0.5).stroke_width(LINE_WIDTH)
}

impl Stroke {
    /// A dash and the gap after it, subpixels; a symbol of the legend ends with a whole dash.
    fn dashes(self) -> Option<(u32, u32)> {
        match self {
            Self::Dashed => Some((6 * FINE, 4 * FINE)),
            Self::Dotted => Some((2 * FINE, 4 * FINE)),
            Self::Line | Self::Rings | Self::Dots | Self::Marked | Self::Hollow => None,
            Self::WideBand | Self::NarrowBand => None,
        }
    }

    /// The shade of an area, which what is below it shows through.
    fn shade(self, colour: RGBColor) -> RGBAColor {
        colour.mix(if self == Self::WideBand { 0.13 } else { 0.22 })
    }
}

/// How a marker is filled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum MarkerFill {
    Full,
    Hollow,
}

/// Draws a disc, a square, a triangle or a diamond, or its outline: lines are told apart without their colours.
pub(super) fn draw_marker<B: Backend>(
    canvas: &Canvas<B>,
    (x, y): (i32, i32),
    look: usize,
    fill: MarkerFill,
) -> DrawResult {
    let (r, edge) = (MARKER, colour(look).stroke_width(LINE_WIDTH));
    let inside = match fill {
        MarkerFill::Full => colour(look),
        MarkerFill::Hollow => WHITE,
    };
    let corners: &[(i32, i32)] = match look % 4 {
        0 => {
            canvas.draw(&Circle::new((x, y), r, inside.filled()))?;
            canvas.draw(&Circle::new((x, y), r, edge))?;
            return Ok(());
        }
        1 => &[(-r, -r), (r, -r), (r, r), (-r, r)],
        2 => &[(0, -r * 5 / 4), (r * 5 / 4, r), (-r * 5 / 4, r)],
        _ => &[(0, -r * 4 / 3), (r * 4 / 3, 0), (0, r * 4 / 3), (-r * 4 / 3, 0)],
    };
    let mut corners: Vec<(i32, i32)> = corners.iter().map(|(dx, dy)| (x + dx, y + dy)).collect();
    canvas.draw(&Polygon::new(corners.clone(), inside.filled()))?;
    corners.extend([corners[0], corners[1]]);
    canvas.draw(&PathElement::new(corners, edge))?;
    Ok(())
}

/// Draws a cross: a point without a value.
pub(super) fn draw_cross<B: Backend>(canvas: &Canvas<B>, (x, y): (i32, i32), shade: RGBColor) -> DrawResult {
    let r = MARKER * 3 / 4;
    for ends in [[(x - r, y - r), (x + r, y + r)], [(x - r, y + r), (x + r, y - r)]] {
        canvas.draw(&PathElement::new(ends, shade.stroke_width(LINE_WIDTH)))?;
    }
    Ok(())
}

/// What stands before a name of the legend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Symbol {
    Line(Stroke, RGBColor),
    /// A marker on a line that may be dashed.
    Marker {
        look: usize,
        dashed: bool,
    },
    /// A shaded area.
    Area(RGBColor),
    /// A full square, a full disc and a ring.
    Square(RGBColor),
    Disc(RGBColor),
    Ring(RGBColor),
    Cross(RGBColor),
}

/// Names, each once, in as many lines as they need. plotters' own legend covers a part of the curves.
#[derive(Debug)]
pub(super) struct Legend {
    items: Vec<Item>,
    lines: u32,
}

#[derive(Debug)]
struct Item {
    name: String,
    symbol: Symbol,
    left: u32,
    line: u32,
}

impl Legend {
    /// The legend of `names` on a canvas of some width, subpixels.
    pub(super) fn new<'a>(names: impl Iterator<Item = (&'a str, Symbol)>, width: u32) -> Self {
        let mut legend = Self { items: Vec::new(), lines: 1 };
        let mut left = LEFT;
        for (name, symbol) in names.filter(|(name, _)| !name.is_empty()) {
            if legend.items.iter().any(|item| item.name == name) {
                continue;
            }
            let item_width = SYMBOL + GAP + text_width(name, TEXT_SIZE);
            if left + item_width > width && left > LEFT {
                (left, legend.lines) = (LEFT, legend.lines + 1);
            }
            legend.items.push(Item { name: name.to_owned(), symbol, left, line: legend.lines - 1 });
            left += item_width + 3 * GAP;
        }
        legend
    }

    pub(super) fn height(&self) -> u32 {
        self.lines * LEGEND_LINE
    }

    pub(super) fn draw<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        self.items.iter().try_for_each(|item| item.draw(canvas))
    }
}

impl Item {
    fn draw<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        let (left, right) = (self.left as i32, (self.left + SYMBOL) as i32);
        let top = self.line * LEGEND_LINE;
        self.symbol.draw(canvas, (left, right), (top + LEGEND_LINE / 2 + FINE) as i32)?;
        let corner = (right + GAP as i32, (top + (LEGEND_LINE - TEXT_SIZE) / 2 + 2 * FINE) as i32);
        canvas.draw(&Text::new(self.name.as_str(), corner, text_style(TEXT_SIZE)))?;
        Ok(())
    }
}

impl Symbol {
    pub(super) fn for_curve(curve: &Curve) -> Self {
        match curve.stroke {
            Stroke::Marked => Self::Marker { look: curve.look, dashed: false },
            stroke => Self::Line(stroke, colour(curve.look)),
        }
    }

    /// That of a stroke in any colour.
    pub(super) fn for_stroke(stroke: Stroke) -> Self {
        Self::Line(stroke, INK)
    }

    fn draw<B: Backend>(self, canvas: &Canvas<B>, (left, right): (i32, i32), middle: i32) -> DrawResult {
        let centre = i32::midpoint(left, right);
        let line = |from: i32, to: i32, colour: RGBColor| {
            canvas.draw(&PathElement::new([(from, middle), (to, middle)], colour.stroke_width(LINE_WIDTH)))
        };
        match self {
            Self::Line(Stroke::Rings, colour) => {
                canvas.draw(&Circle::new((centre, middle), CIRCLE, translucent(colour)))?;
            }
            Self::Line(Stroke::Dots, colour) => {
                let places = [left, i32::midpoint(left, centre), centre, i32::midpoint(centre, right), right];
                let dot = |x: i32| canvas.draw(&Circle::new((x, middle), DOT, colour.filled()));
                places.into_iter().try_for_each(dot)?;
            }
            Self::Line(Stroke::Hollow, colour) => {
                canvas.draw(&Circle::new((centre, middle), MARKER, WHITE.filled()))?;
                canvas.draw(&Circle::new((centre, middle), MARKER, colour.stroke_width(LINE_WIDTH)))?;
            }
            Self::Line(stroke @ (Stroke::WideBand | Stroke::NarrowBand), colour) => {
                let half = (TEXT_SIZE / 2) as i32;
                let corners = [(left, middle - half), (right, middle + half)];
                canvas.draw(&Rectangle::new(corners, stroke.shade(colour).filled()))?;
                if stroke == Stroke::NarrowBand {
                    // It lies within the wide one.
                    canvas.draw(&Rectangle::new(corners, Stroke::WideBand.shade(colour).filled()))?;
                }
            }
            Self::Line(stroke, colour) => {
                let (dash, gap) = stroke.dashes().unwrap_or((SYMBOL, 1));
                let starts = (left..right).step_by((dash + gap) as usize);
                starts.into_iter().try_for_each(|start| line(start, (start + dash as i32).min(right), colour))?;
            }
            Self::Marker { look, dashed } => {
                let gap = if dashed { 2 * MARKER } else { 0 };
                line(left, centre - gap, colour(look))?;
                line(centre + gap, right, colour(look))?;
                draw_marker(canvas, (centre, middle), look, MarkerFill::Full)?;
            }
            Self::Square(shade) => {
                let corners = [(centre - MARKER, middle - MARKER), (centre + MARKER, middle + MARKER)];
                canvas.draw(&Rectangle::new(corners, shade.filled()))?;
            }
            Self::Disc(shade) => canvas.draw(&Circle::new((centre, middle), MARKER, shade.filled()))?,
            Self::Cross(shade) => draw_cross(canvas, (centre, middle), shade)?,
            Self::Ring(shade) => canvas.draw(&Circle::new((centre, middle), MARKER, shade.stroke_width(FINE)))?,
            Self::Area(shade) => {
                let half = (TEXT_SIZE / 2) as i32;
                let corners = [(left, middle - half), (right, middle + half)];
                canvas.draw(&Rectangle::new(corners, shade.filled()))?;
                canvas.draw(&Rectangle::new(corners, GRID.stroke_width(FINE)))?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A thousand points a column: those of each that show, and no others, in their order.
    #[test]
    fn an_outline_keeps_the_extremes_and_the_order() {
        let points: Vec<(f64, f64)> = (0..100_000).map(|i| (f64::from(i), f64::from(i * 7919 % 100_003))).collect();
        let drawn = outline(&points, |point| point.0 as i32 / 1000);
        assert!(drawn.len() <= 400 && drawn.windows(2).all(|pair| pair[0].0 < pair[1].0), "{}", drawn.len());
        for (part, column) in points.chunks(1000).zip(0..) {
            let ends = |points: &mut dyn Iterator<Item = &(f64, f64)>| {
                points.fold((f64::MAX, f64::MIN), |(low, high), point| (low.min(point.1), high.max(point.1)))
            };
            let mut kept = drawn.iter().filter(|point| point.0 as i32 / 1000 == column);
            assert_eq!(ends(&mut kept), ends(&mut part.iter()));
        }
        assert_eq!(outline(&points[..3], |point| point.0 as i32), points[..3]);
    }

    #[test]
    fn a_legend_has_each_name_once_and_no_line_too_long() {
        let names: Vec<String> = (0..12).map(|i| format!("ladder number {}", i % 6)).collect();
        let width = 400 * FINE;
        let legend = Legend::new(names.iter().map(|name| (name.as_str(), Symbol::Area(GRID))), width);
        assert_eq!(legend.items.len(), 6);
        assert!(legend.lines > 1);
        let ends = legend.items.iter().map(|item| item.left + SYMBOL + GAP + text_width(&item.name, TEXT_SIZE));
        assert!(ends.clone().all(|end| end <= width), "{:?}", ends.collect::<Vec<_>>());
    }
}
