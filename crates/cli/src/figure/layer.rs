//! A layer on its profile at a row of a run: masses, pressure and flash temperature over x, and the forces over time.

use plotters::prelude::*;

use super::axis::{Axis, Fit};
use super::caption::{Way, draw_caption, exaggeration};
use super::chart::{self, Chart, Context, Curve, LEGEND_LINE, Legend, Stroke, Symbol, draw_axes};
use super::{Backend, COLOURS, Canvas, DrawResult, FINE, Figure, INK};
use asperity_study::decimals::with_prefix;
use asperity_study::elements::{Element, ElementHistory, Instant, Span, Touch};

const STICKS: RGBColor = COLOURS[0];
const SLIPS: RGBColor = COLOURS[1];
const FREE: RGBColor = RGBColor(140, 140, 140);
const FLASH: RGBColor = COLOURS[3];
const ROAD: RGBColor = RGBColor(185, 180, 171);
const RUBBER: RGBColor = RGBColor(207, 214, 222);

/// Heights of the panels, pixels.
const LAYER: u32 = 300;
const BARS: u32 = 200;
const FORCES: u32 = 220;
/// Points of the profile along the figure.
const COLUMNS: u32 = 2000;

/// The layer at a row.
#[derive(Debug)]
pub(crate) struct LayerPicture<'a> {
    history: &'a ElementHistory,
    row: usize,
    span: Span,
    /// Whether the forces over time are below, with a mark at the row.
    has_forces: bool,
    title: String,
}

impl<'a> LayerPicture<'a> {
    /// A row by itself, its time in the title.
    pub(crate) fn alone(history: &'a ElementHistory, row: usize) -> Self {
        Self::new(history, row, Span::over(history, &[row]), false)
    }

    /// A row among others: their `span`, and the forces over the run.
    pub(crate) fn in_film(history: &'a ElementHistory, row: usize, span: Span) -> Self {
        Self::new(history, row, span, true)
    }

    fn new(history: &'a ElementHistory, row: usize, span: Span, has_forces: bool) -> Self {
        let time = with_prefix(history.rows()[row].time, last_time(history), "s");
        Self { history, row, span, has_forces, title: format!("{}, t = {time}", history.name()) }
    }

    fn bar_panels(&self) -> u32 {
        1 + u32::from(self.history.has_flash())
    }

    fn x_axis(&self, title: &str) -> Axis {
        let ((left, right), u) = (self.history.ends(), self.history.rows()[self.row].u);
        Axis::linear(title, "m", [left + u, right + u].into_iter(), Fit::Tight)
    }

    fn legend(&self, width: u32) -> Legend {
        let touches = [Touch::Sticks, Touch::Slips, Touch::Free].map(|touch| (touch.name(), symbol(touch)));
        let flash = self.history.has_flash().then_some(("flash temperature", FLASH));
        let areas = flash.into_iter().chain([("rubber", RUBBER), ("profile", ROAD)]);
        Legend::new(touches.into_iter().chain(areas.map(|(name, colour)| (name, Symbol::Area(colour)))), width)
    }

    fn z_axis(&self) -> Axis {
        let (low, high) = self.span.heights;
        Axis::linear("z", "m", [low, high].into_iter(), Fit::Tight)
    }

    fn draw_layer<B: Backend>(&self, canvas: &Canvas<B>, elements: &[Element]) -> DrawResult {
        let ((low, high), x, z) = (self.span.heights, self.x_axis("x"), self.z_axis());
        let mut context = chart::context(canvas, "", &x, &z)?;
        let place = |x_m: f64, z_m: f64| {
            // What is far above or below is outside of the panel.
            Some((x.coordinate(x_m)?, z.coordinate(z_m.clamp(low, high))?))
        };
        let surface: Vec<_> = elements.iter().filter_map(|element| place(element.x, element.z)).collect();
        let (left, right) = (self.history.ends().0, self.history.ends().1);
        let u = self.history.rows()[self.row].u;
        let at = |i: u32| left + u + (right - left) * f64::from(i) / f64::from(COLUMNS);
        let spline = self.history.surface().spline();
        let profile: Vec<_> = (0..=COLUMNS).filter_map(|i| place(at(i), spline.evaluate(at(i)).0)).collect();
        let [top, bottom] = [high, low].map(|end| z.coordinate(end).unwrap_or_default());
        context.draw_series([area(&surface, top, RUBBER), area(&profile, bottom, ROAD)])?;
        draw_axes(&mut context, &x, &z)?;
        context.draw_series([PathElement::new(profile, INK.stroke_width(FINE))])?;
        let inside = |element: &&Element| (low..=high).contains(&element.z);
        for element in elements.iter().filter(inside) {
            if let Some(place) = place(element.x, element.z) {
                draw_mass(&mut context, place, element.touch, self.radius(canvas))?;
            }
        }
        Ok(())
    }

    /// Of a mass, subpixels: such that neighbours can be told apart where there is room.
    fn radius<B: Backend>(&self, canvas: &Canvas<B>) -> i32 {
        let (left, right) = self.history.ends();
        let apart = f64::from(canvas.dim_in_pixel().0) * self.history.spacing() / (right - left);
        (0.4 * apart).clamp(1.5 * f64::from(FINE), 4.5 * f64::from(FINE)) as i32
    }

    fn draw_bars<B: Backend>(
        &self,
        canvas: &Canvas<B>,
        bars: impl Iterator<Item = (f64, f64, RGBColor)>,
        (quantity, unit, largest): (&str, &str, f64),
    ) -> DrawResult {
        let (x, y) = (self.x_axis("x"), Axis::linear(quantity, unit, [0.0, largest].into_iter(), Fit::Round));
        let mut context = chart::context(canvas, "", &x, &y)?;
        draw_axes(&mut context, &x, &y)?;
        let half = 0.4 * self.history.spacing();
        let corners = |place: f64, value: f64| {
            let end = |x_m: f64, y_value: f64| Some((x.coordinate(x_m)?, y.coordinate(y_value)?));
            Some([end(place - half, 0.0)?, end(place + half, value)?])
        };
        let bars = bars.filter(|(_, value, _)| *value > 0.0);
        let bars =
            bars.filter_map(|(place, value, shade)| Some(Rectangle::new(corners(place, value)?, shade.filled())));
        context.draw_series(bars)?;
        Ok(())
    }

    fn draw_forces<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        let rows = self.history.rows();
        let curve = |name: &str, look: usize, value: fn(&Instant) -> f64| Curve {
            name: name.to_owned(),
            look,
            stroke: Stroke::Line,
            points: rows.iter().map(|row| (row.time, value(row))).collect(),
        };
        let mut curves = vec![curve("F_x", 2, |row| row.force_x), curve("F_z", 4, |row| row.force_z)];
        let values = || curves.iter().flat_map(|curve| &curve.points).map(|point| point.1);
        let y = Axis::linear("force", "N", values(), Fit::Round);
        let x = Axis::linear("time", "s", rows.iter().map(|row| row.time), Fit::Tight);
        let (low, high) = values().fold((0.0_f64, 0.0_f64), |(low, high), force| (low.min(force), high.max(force)));
        let now = rows[self.row].time;
        curves.push(Curve {
            name: String::new(),
            look: 6,
            stroke: Stroke::Line,
            points: vec![(now, low), (now, high)],
        });
        Chart { title: String::new(), x, y, curves }.draw_with_legend(canvas)
    }
}

fn last_time(history: &ElementHistory) -> f64 {
    history.rows().last().map_or(0.0, |row| row.time)
}

fn colour(touch: Touch) -> RGBColor {
    match touch {
        Touch::Free => FREE,
        Touch::Slips => SLIPS,
        Touch::Sticks => STICKS,
    }
}

/// As [`draw_mass`] draws it.
fn symbol(touch: Touch) -> Symbol {
    match touch {
        Touch::Free => Symbol::Ring(FREE),
        Touch::Slips => Symbol::Disc(SLIPS),
        Touch::Sticks => Symbol::Square(STICKS),
    }
}

/// What lies between a line and a height.
fn area(line: &[(f64, f64)], to: f64, shade: RGBColor) -> Polygon<(f64, f64)> {
    let ends = line.first().into_iter().chain(line.last()).map(|point| (point.0, to));
    let mut corners: Vec<_> = line.to_vec();
    corners.extend(ends.rev());
    Polygon::new(corners, shade.filled())
}

/// A square sticks, a disc slips, a circle is free.
fn draw_mass<B: Backend>(context: &mut Context<'_, B>, place: (f64, f64), touch: Touch, radius: i32) -> DrawResult {
    let shade = colour(touch);
    match touch {
        Touch::Sticks => {
            let square =
                EmptyElement::at(place) + Rectangle::new([(-radius, -radius), (radius, radius)], shade.filled());
            context.draw_series([square])?;
        }
        Touch::Slips => {
            context.draw_series([Circle::new(place, radius, shade.filled())])?;
        }
        Touch::Free => {
            context.draw_series([Circle::new(place, radius, shade.stroke_width(FINE))])?;
        }
    }
    Ok(())
}

impl Figure for LayerPicture<'_> {
    fn size(&self) -> (u32, u32) {
        let forces = if self.has_forces { FORCES } else { 0 };
        (1000, 2 * LEGEND_LINE / FINE + LAYER + BARS * self.bar_panels() + forces)
    }

    fn title(&self) -> &str {
        &self.title
    }

    fn draw<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        let legend = self.legend(canvas.dim_in_pixel().0);
        let (above, below) = canvas.split_vertically(legend.height());
        legend.draw(&above)?;
        let (caption, below) = below.split_vertically(LEGEND_LINE);
        let forces = if self.has_forces { FORCES * FINE } else { 0 };
        let (below, lowest) = below.split_vertically(below.dim_in_pixel().1 - forces);
        let bars = BARS * self.bar_panels() * FINE;
        let (layer, bars) = below.split_vertically(below.dim_in_pixel().1 - bars);
        let elements: Vec<Element> = self.history.elements(self.row).collect();
        let stretched = exaggeration(&layer, &self.x_axis("x"), &self.z_axis());
        draw_caption(&caption, stretched, Way::of(self.history.slides(self.row)))?;
        self.draw_layer(&layer, &elements)?;
        let panels = bars.split_evenly((self.bar_panels() as usize, 1));
        let (quantity, unit) = self.history.load_unit();
        let loads = elements.iter().map(|element| (element.x, element.load, colour(element.touch)));
        self.draw_bars(&panels[0], loads, (quantity, unit, self.span.load))?;
        if let Some(panel) = panels.get(1) {
            let flashes = elements.iter().map(|element| (element.x, element.flash, FLASH));
            self.draw_bars(panel, flashes, ("flash", "K", self.span.flash))?;
        }
        if self.has_forces { self.draw_forces(&lowest) } else { Ok(()) }
    }
}
