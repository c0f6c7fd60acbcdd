//! A field over two quantities in colours: contour lines with numbers, where it is largest, and what was measured.

use plotters::coord::ranged1d::{Ranged as _, ValueFormatter as _};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::axis::{Axis, Fit};
use super::chart::{Legend, MARGIN, Stroke, Symbol, draw_cross};
use super::contours::{GridField, Line};
use super::grid_frame::{GridAxis, GridFrame, width};
use super::maps::draw_colour_bar;
use super::raster::Raster;
use super::{
    Backend, COLOURS, Canvas, Colours, DrawResult, FINE, Figure, INK, LINE_WIDTH, TEXT_SIZE, TICK_SIZE, text_style,
    text_width,
};

/// Space for the colour bar and its ticks.
const BAR: u32 = 90 * FINE;
/// Colours that are told apart: more would make a file larger, and be seen by nobody.
const SHADES: f64 = 128.0;
/// Subpixels of a pixel of the image.
const PIXEL: u32 = 2 * FINE;
/// About so many cells of the refined grid along each axis.
const CELLS: usize = 96;
/// The radius of a measured point, and of one that was computed.
const MEASURED: i32 = 5 * FINE as i32;
const COMPUTED: i32 = FINE as i32;
/// More computed points than these are not marked.
const MOST_MARKED: usize = 900;
const CONTOUR: u32 = 5 * FINE / 4;
const RIDGE: RGBColor = COLOURS[1];
const NO_RESULT: &str = "no result";

/// Maps of one field with the same colours.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FieldGrid {
    pub(crate) title: String,
    /// Below the title; empty for none.
    pub(crate) remark: String,
    /// What the colours are of, a number without a unit.
    pub(crate) quantity: &'static str,
    pub(crate) x: GridAxis,
    pub(crate) y: GridAxis,
    /// What the ridges are; empty where none is marked.
    pub(crate) ridge: String,
    pub(crate) panels: Vec<FieldPanel>,
}

/// One of the maps.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FieldPanel {
    pub(crate) title: String,
    /// Rows along x, from the lowest y on; `None` where there is no result.
    pub(crate) values: Vec<Option<f64>>,
    /// Lines of x and y along which the field is largest.
    pub(crate) ridges: Vec<Vec<(f64, f64)>>,
    pub(crate) measured: Vec<MeasuredPlace>,
}

/// A measured value of the field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MeasuredPlace {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) value: f64,
}

/// A rectangle that the number of a contour covers, subpixels: left, top, right, bottom.
type Covered = [i32; 4];

impl FieldGrid {
    /// Of all values, computed and measured, of all maps.
    fn scale(&self) -> Axis {
        let computed = self.panels.iter().flat_map(|panel| panel.values.iter().copied().flatten());
        let measured = self.panels.iter().flat_map(|panel| panel.measured.iter().map(|place| place.value));
        Axis::linear(self.quantity, "", computed.chain(measured), Fit::Tight)
    }

    fn field(&self, panel: &FieldPanel) -> GridField {
        GridField::new(self.x.shares(), self.y.shares(), panel.values.clone())
    }

    fn legend(&self) -> Legend {
        let any = |has: fn(&FieldPanel) -> bool| self.panels.iter().any(has);
        let ridge = any(|panel| !panel.ridges.is_empty()).then_some((self.ridge.as_str(), ridge_symbol()));
        let measured = any(|panel| !panel.measured.is_empty()).then_some(("measured", Symbol::Ring(INK)));
        let empty = any(|panel| panel.values.contains(&None)).then_some((NO_RESULT, Symbol::Cross(INK)));
        Legend::new([ridge, measured, empty].into_iter().flatten(), width(self.panels.len()))
    }

    fn frame(&self) -> GridFrame<'_> {
        GridFrame {
            title: &self.title,
            remark: &self.remark,
            axes: [&self.x, &self.y],
            titles: self.panels.iter().map(|panel| panel.title.as_str()).collect(),
            legend: self.legend(),
            beside: BAR,
        }
    }
}

fn ridge_symbol() -> Symbol {
    Symbol::Line(Stroke::Line, RIDGE)
}

/// The colour of a value on a scale.
fn shade(scale: &Axis, value: f64) -> RGBColor {
    let range = scale.range();
    let share = ((value - range.start) / (range.end - range.start)).clamp(0.0, 1.0);
    Colours::Viridis.at((share * SHADES).round() / SHADES)
}

/// What is seen on a colour.
fn on(RGBColor(red, green, blue): RGBColor) -> RGBColor {
    /// Luminance below which white is seen better.
    const DARK: f64 = 110.0;
    let luminance = 0.299 * f64::from(red) + 0.587 * f64::from(green) + 0.114 * f64::from(blue);
    if luminance < DARK { WHITE } else { INK }
}

impl Figure for FieldGrid {
    fn size(&self) -> (u32, u32) {
        self.frame().size()
    }

    fn images(&self) -> Vec<Raster> {
        let (frame, scale) = (self.frame(), self.scale());
        let size = frame.map();
        let (columns, rows) = ((size.0 / PIXEL) as usize, (size.1 / PIXEL) as usize);
        let image = |(index, panel): (usize, &FieldPanel)| {
            let field = self.field(panel);
            let colour = |(x, y)| field.at(x, y).map_or(WHITE, |value| shade(&scale, value));
            let colours: Vec<RGBColor> = GridFrame::places((columns, rows)).map(colour).collect();
            Raster::new(frame.corner(index), size, columns, &colours)
        };
        self.panels.iter().enumerate().map(image).collect()
    }

    fn draw<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        let (frame, scale) = (self.frame(), self.scale());
        frame.draw(canvas)?;
        for (index, panel) in self.panels.iter().enumerate() {
            Drawn { grid: self, panel, frame: &frame, scale: &scale, index }.draw(canvas)?;
        }
        let ((left, _), (_, top)) = (frame.corner(self.panels.len().min(3) - 1), frame.corner(0));
        let corner = ((left + frame.map().0 + 5 * MARGIN) as i32, top as i32);
        let title = (corner.0 - 2 * MARGIN as i32, corner.1 - (TEXT_SIZE + 2 * MARGIN) as i32);
        canvas.draw(&Text::new(self.quantity, title, text_style(TEXT_SIZE)))?;
        draw_colour_bar(canvas, corner, frame.map().1, &scale, |share| Colours::Viridis.at(share))
    }
}

/// One of the maps as it is drawn.
struct Drawn<'a> {
    grid: &'a FieldGrid,
    panel: &'a FieldPanel,
    frame: &'a GridFrame<'a>,
    scale: &'a Axis,
    index: usize,
}

impl Drawn<'_> {
    fn place(&self, (x, y): (f64, f64)) -> (i32, i32) {
        self.frame.place(self.index, (self.grid.x.share(x), self.grid.y.share(y)))
    }

    fn draw<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        self.draw_points(canvas)?;
        let mut covered = self.covered();
        let field = self.grid.field(self.panel);
        let field = field.refined(CELLS.div_ceil(self.grid.x.values.len().min(self.grid.y.values.len())).max(1));
        for level in self.scale.ticks(0) {
            let shade = on(shade(self.scale, level));
            for line in field.contours(level) {
                self.draw_contour(canvas, &line, (&self.scale.format_ext(&level), shade), &mut covered)?;
            }
        }
        self.draw_ridges(canvas)?;
        for measured in &self.panel.measured {
            let (place, shade) = (self.place((measured.x, measured.y)), shade(self.scale, measured.value));
            canvas.draw(&Circle::new(place, MEASURED, shade.filled()))?;
            canvas.draw(&Circle::new(place, MEASURED + FINE as i32, WHITE.stroke_width(FINE)))?;
            canvas.draw(&Circle::new(place, MEASURED, INK.stroke_width(3 * FINE / 2)))?;
        }
        Ok(())
    }

    /// Marks the points that were computed, and those of them without a result.
    fn draw_points<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        let FieldGrid { x, y, .. } = self.grid;
        let places = y.values.iter().flat_map(|y| x.values.iter().map(move |x| (*x, *y)));
        let is_marked = self.panel.values.len() <= MOST_MARKED;
        for (place, value) in places.zip(&self.panel.values) {
            match value {
                Some(value) if is_marked => {
                    let shade = on(shade(self.scale, *value)).mix(0.5);
                    canvas.draw(&Circle::new(self.place(place), COMPUTED, shade.filled()))?;
                }
                Some(_) => {}
                None => draw_cross(canvas, self.place(place), INK)?,
            }
        }
        Ok(())
    }

    /// What numbers keep away from.
    fn covered(&self) -> Vec<Covered> {
        let around = |(x, y): (i32, i32)| [x - MEASURED, y - MEASURED, x + MEASURED, y + MEASURED];
        let measured = self.panel.measured.iter().map(|measured| around(self.place((measured.x, measured.y))));
        let ridges = self.panel.ridges.iter().flat_map(|ridge| ridge.windows(2)).flat_map(|ends| {
            let [from, to] = [self.place(ends[0]), self.place(ends[1])];
            (0..=8).map(move |part| around((from.0 + (to.0 - from.0) * part / 8, from.1 + (to.1 - from.1) * part / 8)))
        });
        measured.chain(ridges).collect()
    }

    /// Draws a contour, with its number in a gap where there is room.
    fn draw_contour<B: Backend>(
        &self,
        canvas: &Canvas<B>,
        line: &Line,
        (text, shade): (&str, RGBColor),
        covered: &mut Vec<Covered>,
    ) -> DrawResult {
        let places: Vec<(i32, i32)> = line.iter().map(|&place| self.frame.place(self.index, place)).collect();
        let gap = self.gap(&places, text, covered);
        let is_in_gap =
            |(x, y): &(i32, i32)| gap.is_some_and(|[l, t, r, b]| (l..=r).contains(x) && (t..=b).contains(y));
        for part in places.split(is_in_gap) {
            canvas.draw(&PathElement::new(part.to_vec(), shade.stroke_width(CONTOUR)))?;
        }
        let Some(gap) = gap else { return Ok(()) };
        let middle = (i32::midpoint(gap[0], gap[2]), i32::midpoint(gap[1], gap[3]));
        let style = text_style(TICK_SIZE).color(&shade).pos(Pos::new(HPos::Center, VPos::Center));
        canvas.draw(&Text::new(text.to_owned(), middle, style))?;
        covered.push(gap);
        Ok(())
    }

    /// Where the number of a contour may stand: nearest to the middle of the line.
    fn gap(&self, places: &[(i32, i32)], text: &str, covered: &[Covered]) -> Option<Covered> {
        const SHARES: [f64; 9] = [0.5, 0.42, 0.58, 0.34, 0.66, 0.26, 0.74, 0.18, 0.82];
        let (half, tall) = ((text_width(text, TICK_SIZE) / 2 + 3 * FINE) as i32, (TICK_SIZE / 2 + FINE) as i32);
        let lengths: Vec<f64> = std::iter::once(0.0)
            .chain(places.windows(2).scan(0.0, |sum, ends| {
                *sum += f64::from(ends[1].0 - ends[0].0).hypot(f64::from(ends[1].1 - ends[0].1));
                Some(*sum)
            }))
            .collect();
        let length = *lengths.last()?;
        if length < 5.0 * f64::from(half) {
            return None;
        }
        let ((left, top), (width, height)) = (self.frame.corner(self.index), self.frame.map());
        let inside = [left, top, left + width, top + height].map(|edge| edge as i32);
        let at = |share: f64| {
            let (x, y) = places[lengths.partition_point(|&along| along < share * length).min(places.len() - 1)];
            [x - half, y - tall, x + half, y + tall]
        };
        let is_free = |own: &Covered| {
            let fits = own[0] > inside[0] && own[1] > inside[1] && own[2] < inside[2] && own[3] < inside[3];
            let meets =
                |other: &Covered| own[0] < other[2] && other[0] < own[2] && own[1] < other[3] && other[1] < own[3];
            fits && !covered.iter().any(meets)
        };
        SHARES.into_iter().map(at).find(is_free)
    }

    fn draw_ridges<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        for ridge in &self.panel.ridges {
            let places: Vec<(i32, i32)> = ridge.iter().map(|&place| self.place(place)).collect();
            for (width, radius, shade) in [(2 * LINE_WIDTH, 4, WHITE), (LINE_WIDTH, 3, RIDGE)] {
                canvas.draw(&PathElement::new(places.clone(), shade.stroke_width(width)))?;
                let mut dots = places.iter();
                dots.try_for_each(|&place| canvas.draw(&Circle::new(place, radius * FINE as i32, shade.filled())))?;
            }
        }
        Ok(())
    }
}
