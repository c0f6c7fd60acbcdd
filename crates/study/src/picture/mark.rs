//! Marks of a panel: lines, areas, points and the like, each with its name in the legend and its colour.

use serde::{Deserialize, Serialize};

/// A place, in the units of the axes.
pub type Point = [f64; 2];

/// Red, green and blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Colour(pub [u8; 3]);

/// One of a panel's marks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mark {
    /// In the legend, where marks of the same name stand once, and in ink where they have several colours; empty for none.
    pub name: String,
    /// Of all of it, but of what has values.
    pub colour: Colour,
    /// What is drawn.
    pub shape: Shape,
}

/// What is drawn. Points that an axis cannot show are left out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Shape {
    /// Straight from point to point.
    Line {
        /// In their order.
        points: Vec<Point>,
        /// Whether it is broken.
        stroke: Stroke,
        /// Pixels.
        width: f64,
    },
    /// What is within an outline.
    Area {
        /// In their order.
        outline: Vec<Point>,
        /// From 0 to 1.
        opacity: f64,
    },
    /// Symbols.
    Points {
        /// Their middles.
        points: Vec<Point>,
        /// What is drawn at each.
        symbol: Symbol,
        /// How.
        fill: Fill,
        /// Pixels.
        radius: f64,
        /// What is written beside each where there is room; empty for nothing.
        labels: Vec<String>,
        /// By which the panel's scale colours each; empty where none does.
        values: Vec<f64>,
    },
    /// Rectangles.
    Boxes {
        /// Two opposite corners of each: x, y, x, y.
        boxes: Vec<[f64; 4]>,
        /// By which the panel's scale colours each; empty where none does.
        values: Vec<f64>,
    },
    /// Cells that fill the panel, coloured by its scale; without a value they have the mark's colour.
    Heat {
        /// How many stand side by side.
        columns: usize,
        /// From the lowest row on.
        values: Vec<Option<f64>>,
    },
    /// Lines of equal values, with their numbers.
    Contours(Vec<ContourLine>),
    /// From a place to another: x, y, x, y.
    Arrows {
        /// One each.
        arrows: Vec<[f64; 4]>,
        /// The length of the one in the legend, pixels.
        key: f64,
    },
}

/// A line of equal values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContourLine {
    /// Which value.
    pub value: f64,
    /// As it is written.
    pub label: String,
    /// In their order.
    pub points: Vec<Point>,
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Stroke {
    /// Without gaps.
    Solid,
    /// In dashes.
    Dashed,
    /// In dots.
    Dotted,
}

/// What is drawn at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "they are what their names say")]
pub enum Symbol {
    Disc,
    Square,
    Triangle,
    Diamond,
    Cross,
}

/// How a symbol is filled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Fill {
    /// With its colour.
    Full,
    /// With white: what cannot be relied on.
    Hollow,
    /// Not at all: lines through it are seen.
    Ring,
}

impl Colour {
    /// That of axes and text.
    pub const INK: Self = Self([40, 40, 40]);
    /// That of lines behind all others, and of what has nothing.
    pub const GRID: Self = Self([225, 225, 225]);
    /// That of paper.
    pub const WHITE: Self = Self([255, 255, 255]);

    /// A colour by its number, one of Okabe and Ito's, which colour-blind readers can tell apart; they repeat after the
    /// last.
    pub fn nth(number: usize) -> Self {
        const COLOURS: [[u8; 3]; 7] =
            [[0, 114, 178], [213, 94, 0], [0, 158, 115], [204, 121, 167], [230, 159, 0], [86, 180, 233], [70, 70, 70]];
        Self(COLOURS[number % COLOURS.len()])
    }

    /// The colour a share of the way to another one.
    pub fn towards(self, other: Self, share: f64) -> Self {
        let part = |i: usize| f64::from(self.0[i]) + share * (f64::from(other.0[i]) - f64::from(self.0[i]));
        Self([0, 1, 2].map(|i| part(i).round() as u8))
    }
}

impl Symbol {
    /// A symbol by its number: lines are told apart without their colours.
    pub fn nth(number: usize) -> Self {
        [Self::Disc, Self::Square, Self::Triangle, Self::Diamond][number % 4]
    }
}

/// The width of a line, and the radius of a symbol, pixels.
const WIDTH: f64 = 2.0;
const RADIUS: f64 = 5.0;

impl Mark {
    /// A mark with the colour of this number.
    pub fn new(name: impl Into<String>, look: usize, shape: Shape) -> Self {
        Self { name: name.into(), colour: Colour::nth(look), shape }
    }

    /// A line with the colour of this number.
    pub fn line(name: impl Into<String>, look: usize, points: Vec<Point>) -> Self {
        Self::broken(name, look, points, Stroke::Solid)
    }

    /// A thin line with the colour of this number.
    pub fn thin(name: impl Into<String>, look: usize, points: Vec<Point>) -> Self {
        Self::new(name, look, Shape::Line { points, stroke: Stroke::Solid, width: 1.0 })
    }

    /// A line with the colour of this number, and perhaps gaps.
    pub fn broken(name: impl Into<String>, look: usize, points: Vec<Point>, stroke: Stroke) -> Self {
        Self::new(name, look, Shape::Line { points, stroke, width: WIDTH })
    }

    /// Symbols with the colour and the shape of this number.
    pub fn symbols(name: impl Into<String>, look: usize, points: Vec<Point>, fill: Fill) -> Self {
        Self::new(name, look, Shape::points(points, Symbol::nth(look), fill, RADIUS))
    }

    /// A line, and a symbol at every point.
    pub fn marked(name: &str, look: usize, points: Vec<Point>) -> [Self; 2] {
        [Self::line(name, look, points.clone()), Self::symbols(name, look, points, Fill::Full)]
    }

    /// Rings at every point.
    pub fn rings(name: impl Into<String>, look: usize, points: Vec<Point>) -> Self {
        Self::new(name, look, Shape::points(points, Symbol::Disc, Fill::Ring, RADIUS - 1.0))
    }

    /// A light area within an outline.
    pub fn area(name: impl Into<String>, look: usize, outline: Vec<Point>, opacity: f64) -> Self {
        Self::new(name, look, Shape::Area { outline, opacity })
    }

    /// Rectangles with the colour of this number.
    pub fn boxes(name: impl Into<String>, look: usize, boxes: Vec<[f64; 4]>) -> Self {
        Self::new(name, look, Shape::Boxes { boxes, values: Vec::new() })
    }

    /// The same of another colour.
    #[must_use]
    pub fn coloured(self, colour: Colour) -> Self {
        Self { colour, ..self }
    }

    /// The points that it has: of what has corners, these.
    pub fn points(&self) -> impl Iterator<Item = Point> {
        let (points, corners) = match &self.shape {
            Shape::Line { points, .. } | Shape::Points { points, .. } | Shape::Area { outline: points, .. } => {
                (&points[..], &[][..])
            }
            Shape::Boxes { boxes: corners, .. } | Shape::Arrows { arrows: corners, .. } => (&[][..], &corners[..]),
            Shape::Heat { .. } | Shape::Contours(_) => (&[][..], &[][..]),
        };
        points.iter().copied().chain(corners.iter().flat_map(|&[x, y, to_x, to_y]| [[x, y], [to_x, to_y]]))
    }
}

impl Shape {
    /// Symbols of one kind.
    pub fn points(points: Vec<Point>, symbol: Symbol, fill: Fill, radius: f64) -> Self {
        Self::Points { points, symbol, fill, radius, labels: Vec::new(), values: Vec::new() }
    }
}

/// The first coordinates of the points of marks.
pub fn xs(marks: &[Mark]) -> impl Iterator<Item = f64> {
    marks.iter().flat_map(Mark::points).map(|point| point[0])
}

/// The second ones.
pub fn ys(marks: &[Mark]) -> impl Iterator<Item = f64> {
    marks.iter().flat_map(Mark::points).map(|point| point[1])
}
