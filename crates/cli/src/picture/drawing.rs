//! A picture as it is drawn: lines, areas and text at their places.

use asperity_study::picture::{Colour, Point};

/// Text of titles, of axes and legends, of ticks, and beside points, pixels.
pub(super) const TITLE_SIZE: f64 = 22.0;
pub(super) const TEXT_SIZE: f64 = 17.0;
pub(super) const TICK_SIZE: f64 = 15.0;
pub(super) const LABEL_SIZE: f64 = 13.0;

/// From half-way up capitals down to the base line, as a share of a text's size.
pub(super) const TO_BASE_LINE: f64 = 0.36;

/// Something of a picture as it is drawn, in pixels from the corner at the upper left.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Item {
    /// Straight from point to point.
    Path {
        points: Vec<Point>,
        is_closed: bool,
        fill: Option<Paint>,
        pen: Option<Pen>,
    },
    Circle {
        at: Point,
        radius: f64,
        fill: Option<Paint>,
        pen: Option<Pen>,
    },
    /// `at` is half-way up its capitals.
    Text {
        text: String,
        at: Point,
        side: Side,
        size: f64,
        colour: Colour,
        is_upright: bool,
    },
    /// Colours in rows from the upper left corner on.
    Image {
        corner: Point,
        size: Point,
        columns: usize,
        colours: Vec<Colour>,
    },
}

/// A colour that what is below may show through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Paint {
    pub(super) colour: Colour,
    pub(super) opacity: f64,
}

/// A line's paint, its width, and lengths of dashes and gaps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pen {
    pub(super) paint: Paint,
    pub(super) width: f64,
    pub(super) dashes: Option<[f64; 2]>,
}

/// Which of its ends a text has at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Start,
    Middle,
    End,
}

/// A picture as it is drawn.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Drawing {
    pub(super) size: Point,
    pub(super) items: Vec<Item>,
}

impl Paint {
    pub(super) fn full(colour: Colour) -> Self {
        Self { colour, opacity: 1.0 }
    }
}

impl Pen {
    pub(super) fn new(colour: Colour, width: f64) -> Self {
        Self { paint: Paint::full(colour), width, dashes: None }
    }
}

impl Item {
    pub(super) fn line(points: Vec<Point>, pen: Pen) -> Self {
        Self::Path { points, is_closed: false, fill: None, pen: Some(pen) }
    }

    pub(super) fn area(points: Vec<Point>, fill: Paint) -> Self {
        Self::Path { points, is_closed: true, fill: Some(fill), pen: None }
    }

    /// A rectangle by two opposite corners.
    pub(super) fn rectangle([x, y]: Point, [to_x, to_y]: Point, fill: Paint) -> Self {
        Self::area(vec![[x, y], [to_x, y], [to_x, to_y], [x, to_y]], fill)
    }

    pub(super) fn text(text: impl Into<String>, at: Point, side: Side, size: f64) -> Self {
        Self::Text { text: text.into(), at, side, size, colour: Colour::INK, is_upright: false }
    }
}
