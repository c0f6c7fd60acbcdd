//! What a comparison is: values beside each other, and pictures of curves over one pair of axes.

use asperity_study::picture::{Axis, Fill, Fit, Mark, Panel, Picture as Drawn, xs, ys};

/// A comparison of the page, to be made.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    pub title: &'static str,
    /// With whom, and the year.
    pub reference: &'static str,
    /// Where that is published.
    pub source: &'static str,
    /// The file that computes it, in the repository.
    pub file: &'static str,
    /// Whether it is checked whenever something changes.
    pub quick: bool,
    pub compare: fn() -> Comparison,
}

/// What came out of it.
#[derive(Clone, Debug, Default)]
pub struct Comparison {
    /// What was computed, and how.
    pub about: String,
    pub rows: Vec<Row>,
    pub pictures: Vec<Picture>,
    /// What an engineer should know of it.
    pub remark: String,
}

/// One value beside another.
#[derive(Clone, Debug)]
pub struct Row {
    pub quantity: String,
    pub expected: f64,
    pub found: f64,
    pub unit: &'static str,
    pub claim: Claim,
}

/// How near a value is to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Claim {
    /// Within this part of what is expected.
    Share(f64),
    /// Within this part of some whole.
    Of(f64, f64),
    /// Between these.
    Between(f64, f64),
}

impl Row {
    pub fn new(quantity: impl Into<String>, [expected, found]: [f64; 2], unit: &'static str, claim: Claim) -> Self {
        Self { quantity: quantity.into(), expected, found, unit, claim }
    }

    /// A value that is to lie between two.
    pub fn between(quantity: impl Into<String>, bounds: [f64; 2], found: f64, unit: &'static str) -> Self {
        let claim = Claim::Between(bounds[0], bounds[1]);
        Self { quantity: quantity.into(), expected: 0.5 * (bounds[0] + bounds[1]), found, unit, claim }
    }

    /// The difference over what the claim is of.
    pub fn error(&self) -> f64 {
        let off = (self.found - self.expected).abs();
        match self.claim {
            Claim::Share(_) => off / self.expected.abs(),
            Claim::Of(whole, _) => off / whole,
            Claim::Between(low, high) => (low - self.found).max(self.found - high).max(0.0),
        }
    }

    /// Not where the value is no number.
    pub fn agrees(&self) -> bool {
        self.error() <= self.allowed()
    }

    pub fn allowed(&self) -> f64 {
        match self.claim {
            Claim::Share(part) | Claim::Of(_, part) => part,
            Claim::Between(..) => 0.0,
        }
    }
}

impl Comparison {
    pub fn agrees(&self) -> bool {
        !self.rows.is_empty() && self.rows.iter().all(Row::agrees)
    }

    /// Of the rows with an error the one that uses most of its claim.
    pub fn worst(&self) -> Option<&Row> {
        let used = |row: &Row| row.error() / row.allowed();
        let rows = self.rows.iter().filter(|row| !matches!(row.claim, Claim::Between(..)));
        rows.max_by(|a, b| used(a).total_cmp(&used(b)))
    }
}

/// Curves over axes.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Within docs/validation.
    pub file: &'static str,
    /// What is seen.
    pub caption: &'static str,
    pub x: &'static str,
    pub y: &'static str,
    /// Whether x is logarithmic.
    pub is_logarithmic: bool,
    pub curves: Vec<Curve>,
}

/// A curve, or marks.
#[derive(Clone, Debug)]
pub struct Curve {
    pub name: String,
    pub points: Vec<(f64, f64)>,
    /// Marks alone: what was found. Lines are what is expected.
    pub is_marks: bool,
}

impl Curve {
    pub fn line(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.into(), points, is_marks: false }
    }

    pub fn marks(name: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.into(), points, is_marks: true }
    }
}

impl Picture {
    /// The file's text.
    pub fn svg(&self) -> String {
        let mark = |(look, curve): (usize, &Curve)| {
            let points = curve.points.iter().map(|&(x, y)| [x, y]).collect();
            match curve.is_marks {
                true => Mark::symbols(&curve.name, look, points, Fill::Full),
                false => Mark::line(&curve.name, look, points),
            }
        };
        let marks: Vec<Mark> = self.curves.iter().enumerate().map(mark).collect();
        let x = match self.is_logarithmic {
            true => Axis::logarithmic_tight((self.x, ""), xs(&marks)),
            false => Axis::linear((self.x, ""), xs(&marks), Fit::Tight),
        };
        let y = Axis::linear((self.y, ""), ys(&marks), Fit::Round);
        asperity_cli::picture::svg(&Drawn::of(vec![Panel::new(x, y, marks).sized(534.0, 260.0).into()])).unwrap()
    }
}
