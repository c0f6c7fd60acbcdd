//! A layer on its profile at a row of a run: masses, pressure and flash temperature over x, and the forces over time.

use super::history::{Element, ElementHistory, Instant, Span, Touch};
use crate::decimals::with_prefix;
use crate::picture::{Axis, Colour, Fill, Fit, Mark, Panel, Picture, Point, Row, Shape, Symbol, slides, ys};

const FREE: Colour = Colour([140, 140, 140]);
const ROAD: Colour = Colour([185, 180, 171]);
const RUBBER: Colour = Colour([207, 214, 222]);
/// The number of the colour of flash temperatures.
const FLASH: usize = 3;
/// Width of the panels and height of the one of the layer, pixels.
const WIDTH: f64 = 894.0;
const LAYER: f64 = 240.0;
/// Points of the profile along the picture.
const COLUMNS: u32 = 2000;

/// The layer at a row.
struct LayerAt<'a> {
    history: &'a ElementHistory,
    row: Instant,
    span: Span,
    elements: Vec<Element>,
}

impl ElementHistory {
    /// The picture of a row by itself.
    pub fn picture(&self, row: usize) -> Picture {
        LayerAt::new(self, row, Span::over(self, &[row])).picture(self.slides(row))
    }

    /// That of a row among others: with their `span`, and the forces over the run.
    pub fn frame(&self, row: usize, span: Span) -> Picture {
        let layer = LayerAt::new(self, row, span);
        let mut picture = layer.picture(self.slides(row));
        picture.rows.push(layer.forces());
        picture
    }
}

impl<'a> LayerAt<'a> {
    fn new(history: &'a ElementHistory, row: usize, span: Span) -> Self {
        Self { history, row: history.rows()[row], span, elements: history.elements(row).collect() }
    }

    fn picture(&self, change: f64) -> Picture {
        let last = self.history.rows().last().map_or(0.0, |row| row.time);
        let time = with_prefix(self.row.time, last, "s");
        let layer = self.layer();
        let mut rows = vec![Row { note: layer.exaggeration() + slides(change), ..layer.into() }];
        let of_touch = |touch: Touch| {
            let its = self.elements.iter().filter(move |element| element.touch == touch);
            Mark::boxes("", 0, self.bars(its.map(|element| (element.x, element.load)))).coloured(look(touch).0)
        };
        rows.push(self.panel(self.history.load_unit(), self.span.load, TOUCHES.map(of_touch).into()).into());
        if self.history.has_flash() {
            let flashes = self.bars(self.elements.iter().map(|element| (element.x, element.flash)));
            let marks = vec![Mark::boxes("flash temperature", FLASH, flashes)];
            rows.push(self.panel(("flash", "K"), self.span.flash, marks).into());
        }
        Picture::of(rows).titled(format!("{}, t = {time}", self.history.name()))
    }

    fn x_axis(&self) -> Axis {
        let (left, right) = self.history.ends();
        Axis::linear(("x", "m"), [left + self.row.u, right + self.row.u], Fit::Tight)
    }

    /// The masses on the profile. What is far above or below is outside of the panel.
    fn layer(&self) -> Panel {
        let (low, high) = self.span.heights;
        let (x, z) = (self.x_axis(), Axis::linear(("z", "m"), [low, high], Fit::Tight));
        let spline = self.history.surface().spline();
        let profile: Vec<Point> = (0..=COLUMNS)
            .map(|i| x.value(f64::from(i) / f64::from(COLUMNS)))
            .map(|at| [at, spline.evaluate(at).0.clamp(low, high)])
            .collect();
        let surface = self.elements.iter().map(|element| [element.x, element.z.clamp(low, high)]).collect();
        let mut marks = vec![
            Mark::area("rubber", 0, closed(surface, high), 1.0).coloured(RUBBER),
            Mark::area("profile", 0, closed(profile.clone(), low), 1.0).coloured(ROAD),
            Mark::thin("", 0, profile).coloured(Colour::INK),
        ];
        let (left, right) = self.history.ends();
        // Such that neighbours can be told apart where there is room.
        let radius = (0.4 * WIDTH * self.history.spacing() / (right - left)).clamp(1.5, 4.5);
        marks.extend(TOUCHES.map(|touch| {
            let (colour, symbol, fill) = look(touch);
            let inside = |element: &&Element| element.touch == touch && (low..=high).contains(&element.z);
            let places = self.elements.iter().filter(inside).map(|element| [element.x, element.z]).collect();
            Mark::new(touch.name(), 0, Shape::points(places, symbol, fill, radius)).coloured(colour)
        }));
        Panel::new(x, z, marks).sized(WIDTH, LAYER)
    }

    /// A bar for each place with a value above 0.
    fn bars(&self, values: impl Iterator<Item = (f64, f64)>) -> Vec<[f64; 4]> {
        let half = 0.4 * self.history.spacing();
        values.filter(|(_, value)| *value > 0.0).map(|(x, value)| [x - half, 0.0, x + half, value]).collect()
    }

    fn panel(&self, of: (&str, &str), largest: f64, marks: Vec<Mark>) -> Panel {
        Panel::new(self.x_axis(), Axis::linear(of, [0.0, largest], Fit::Round), marks).sized(WIDTH, 140.0)
    }

    /// The forces over the run, with a line at the row.
    fn forces(&self) -> Row {
        let rows = self.history.rows();
        let curve = |name: &str, look: usize, value: fn(&Instant) -> f64| {
            Mark::line(name, look, rows.iter().map(|row| [row.time, value(row)]).collect())
        };
        let mut marks = vec![curve("F_x", 2, |row| row.force_x), curve("F_z", 4, |row| row.force_z)];
        let y = Axis::linear(("force", "N"), ys(&marks), Fit::Round);
        let x = Axis::linear(("time", "s"), rows.iter().map(|row| row.time), Fit::Tight);
        marks.push(Mark::line("", 6, vec![[self.row.time, y.low], [self.row.time, y.high]]));
        Panel::new(x, y, marks).sized(WIDTH, 140.0).into()
    }
}

const TOUCHES: [Touch; 3] = [Touch::Sticks, Touch::Slips, Touch::Free];

/// A square sticks, a disc slips, a ring is free.
fn look(touch: Touch) -> (Colour, Symbol, Fill) {
    match touch {
        Touch::Sticks => (Colour::nth(0), Symbol::Square, Fill::Full),
        Touch::Slips => (Colour::nth(1), Symbol::Disc, Fill::Full),
        Touch::Free => (FREE, Symbol::Disc, Fill::Ring),
    }
}

/// What lies between a line and a height.
fn closed(mut line: Vec<Point>, height: f64) -> Vec<Point> {
    let ends: Vec<Point> = line.last().into_iter().chain(line.first()).map(|point| [point[0], height]).collect();
    line.extend(ends);
    line
}
