//! Pictures as plain data: rows of panels, each with two axes and marks. What draws them knows nothing of what they show,
//! and what makes them nothing of how they are drawn.

mod axis;
mod field;
mod mark;

use serde::{Deserialize, Serialize};

use crate::decimals::rounded;

pub use axis::{Axis, Fit, Tick, is_loggable, power_of_ten, rounded_down};
pub(crate) use field::GridField;
pub use mark::{Colour, ContourLine, Fill, Mark, Point, Shape, Stroke, Symbol, xs, ys};

/// A picture.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Picture {
    /// Above all; empty for none.
    pub title: String,
    /// From top to bottom.
    pub rows: Vec<Row>,
}

/// Panels side by side, below the names of their marks that are not named above.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Above the row; empty for none.
    pub title: String,
    /// A line below the title; empty for none.
    pub note: String,
    /// From left to right.
    pub panels: Vec<Panel>,
}

/// Marks over two axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Panel {
    /// Above the panel; empty for none.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// What is drawn around the marks.
    pub frame: Frame,
    /// Width and height of what the axes enclose, pixels.
    pub size: [f64; 2],
    /// Those that come later are drawn over others.
    pub marks: Vec<Mark>,
    /// What the colours of values stand for.
    pub scale: Option<ColourScale>,
    /// What is written on the right.
    pub beside: Vec<Tick>,
}

/// What is drawn around the marks of a panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Frame {
    /// Both axes, with ticks and titles.
    Axes,
    /// A line around them.
    Line,
    /// Nothing.
    None,
}

/// The colours of values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ColourScale {
    /// What has colours, from the first to the last.
    pub axis: Axis,
    /// Which.
    pub colours: Colours,
}

/// Colours of a scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Colours {
    /// From dark violet to yellow.
    Viridis,
    /// From white to blue.
    Blues,
    /// From dark grey to white.
    Greys,
}

/// A panel's quantity with its unit, of one of its axes.
pub type Of<'a> = (&'a str, &'a str);

/// The title of a panel, and what it shows.
type TitledMarks = (String, Vec<Mark>);

impl Picture {
    /// Rows below each other, without a title.
    pub fn of(rows: Vec<Row>) -> Self {
        Self { title: String::new(), rows }
    }

    /// The same with a title.
    #[must_use]
    pub fn titled(self, title: impl Into<String>) -> Self {
        Self { title: title.into(), ..self }
    }

    /// Panels below each other over the same axis, all axes logarithmic.
    pub fn stacked(x: Of<'_>, panels: Vec<(Of<'_>, Vec<Mark>)>) -> Self {
        // A point that one axis cannot show does not widen the other one.
        let seen = |marks: &[Mark], axis: usize| {
            let points = marks.iter().flat_map(Mark::points).filter(move |point| is_loggable(point[1 - axis]));
            points.map(|point| point[axis]).collect::<Vec<_>>()
        };
        let x = Axis::logarithmic(x, panels.iter().flat_map(|(_, marks)| seen(marks, 0)));
        let panel = |(y, marks): (Of<'_>, Vec<Mark>)| {
            Row::from(Panel::new(x.clone(), Axis::logarithmic(y, seen(&marks, 1)), marks).sized(794.0, 292.0))
        };
        Self::of(panels.into_iter().map(panel).collect())
    }

    /// Panels below each other over the same axis, all axes linear; each vertical one has 0.
    pub fn over(x: Of<'_>, panels: Vec<(Of<'_>, Vec<Mark>)>) -> Self {
        let height = if panels.len() == 1 { 500.0 } else { 260.0 };
        let x = Axis::linear(x, panels.iter().flat_map(|(_, marks)| xs(marks)).collect::<Vec<_>>(), Fit::Tight);
        let panel = |(y, marks): (Of<'_>, Vec<Mark>)| {
            Row::from(Panel::new(x.clone(), Axis::linear(y, ys(&marks), Fit::Round), marks).sized(894.0, height))
        };
        Self::of(panels.into_iter().map(panel).collect())
    }

    /// Rows of panels side by side: the horizontal axes are the same logarithmic one, the vertical ones the same linear one
    /// along each row. The titles of the first row's panels stand for those below them too.
    pub fn side_by_side(x: Of<'_>, rows: Vec<(Of<'_>, Vec<TitledMarks>)>) -> Self {
        let all = rows.iter().flat_map(|(_, panels)| panels).flat_map(|(_, marks)| xs(marks));
        let x = Axis::logarithmic(x, all.collect::<Vec<_>>());
        let row = |(number, (of, panels)): (usize, (Of<'_>, Vec<TitledMarks>))| {
            let y = panels.iter().flat_map(|(_, marks)| ys(marks)).collect::<Vec<_>>();
            let y = Axis::linear(of, y, Fit::Round);
            let width = if panels.len() == 1 { 694.0 } else { 354.0 };
            let panel = |(title, marks): (String, Vec<Mark>)| {
                let title = if number == 0 { title } else { String::new() };
                Panel { title, ..Panel::new(x.clone(), y.clone(), marks) }
                    .sized(width, if number == 0 { 360.0 } else { 220.0 })
            };
            Row { panels: panels.into_iter().map(panel).collect(), ..Row::default() }
        };
        Self::of(rows.into_iter().enumerate().map(row).collect())
    }

    /// Panels side by side with the same logarithmic axes.
    pub fn ladders(of: Of<'_>, panels: &[Ladders]) -> Row {
        /// Space beside and above the outermost points for their labels, as factors.
        const ROOM: [f64; 2] = [1.1, 1.6];
        let points = || panels.iter().flat_map(|panel| &panel.marks).flat_map(Mark::points);
        let across = || panels.iter().flat_map(|panel| panel.across.iter().copied().chain(panel.floor));
        let x = points().flat_map(|[x, _]| [x / ROOM[0], x * ROOM[0]]);
        let y = points().flat_map(|[_, y]| [y, y * ROOM[1]]).chain(across());
        let (x, y) = (Axis::logarithmic(of, x), Axis::logarithmic(("", ""), y));
        Row { panels: panels.iter().map(|panel| panel.over(&x, &y)).collect(), ..Row::default() }
    }
}

/// Errors over what they cost, or over what was asked for: lines that go down step by step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ladders {
    /// Of the vertical axis.
    pub title: String,
    /// Errors below it say nothing; points there are to be hollow.
    pub floor: Option<f64>,
    /// Values of the vertical axis with a line across and their numbers.
    pub across: Vec<f64>,
    /// The lines and their points.
    pub marks: Vec<Mark>,
}

impl Ladders {
    fn over(&self, x: &Axis, y: &Axis) -> Panel {
        const FLOOR: Colour = Colour([238, 238, 238]);
        let floor = self.floor.filter(|floor| is_loggable(*floor)).map(|floor| {
            let boxes = vec![[x.low, y.low, x.high, floor.min(y.high)]];
            Mark::boxes("below the reference's own error", 0, boxes).coloured(FLOOR)
        });
        let line = |&at: &f64| Mark::thin("", 0, vec![[x.low, at], [x.high, at]]).coloured(Colour([126, 126, 126]));
        let marks = floor.into_iter().chain(self.across.iter().map(line)).chain(self.marks.iter().cloned());
        let panel = Panel::new(x.clone(), y.titled(&self.title), marks.collect()).sized(294.0, 336.0);
        let beside = self.across.iter().map(|&at| Tick { at, name: at.to_string() }).collect();
        Panel { beside, ..panel }
    }
}

impl From<Panel> for Row {
    fn from(panel: Panel) -> Self {
        Self { panels: vec![panel], ..Self::default() }
    }
}

impl Panel {
    /// Marks over axes.
    pub fn new(x: Axis, y: Axis, marks: Vec<Mark>) -> Self {
        let (title, beside) = (String::new(), Vec::new());
        Self { title, x, y, frame: Frame::Axes, size: [694.0, 360.0], marks, scale: None, beside }
    }

    /// The same panel of another size, pixels.
    #[must_use]
    pub fn sized(self, width: f64, height: f64) -> Self {
        Self { size: [width, height], ..self }
    }

    /// How many times as high as long it draws things, both axes being linear ones of lengths, in words.
    pub fn exaggeration(&self) -> String {
        let [x, y] = [&self.x, &self.y].map(|axis| axis.high - axis.low);
        let times = (self.size[1] / y) / (self.size[0] / x);
        if (times - 1.0).abs() < TO_SCALE {
            return "heights to scale".into();
        }
        format!("heights drawn {} times as large as lengths", rounded(times, 2))
    }
}

/// Above which a ratio of scales is 1 but for rounding.
const TO_SCALE: f64 = 0.02;
/// What is longer than this many times its width is drawn wider than it is.
const SLENDER: f64 = 5.0;

/// The size (pixels) of something of a length and a width within some pixels, to scale unless it is slender.
pub fn fitted([length, width]: [f64; 2], within: [f64; 2]) -> [f64; 2] {
    let (length, width) = (length.max(width / SLENDER), width.max(length / SLENDER));
    let scale = (within[0] / length).min(within[1] / width);
    [(scale * length).round(), (scale * width).round()]
}

/// Which way the rubber slides, in words; nothing where it does not.
pub fn slides(change: f64) -> &'static str {
    if change > 0.0 {
        ", the rubber slides →"
    } else if change < 0.0 {
        ", the rubber slides ←"
    } else {
        ""
    }
}
