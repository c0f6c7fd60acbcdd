//! Pictures of the page: curves over one pair of axes, as SVG.

use asperity_study::picture::{Axis, Fill, Fit, Mark, Panel, Picture as Drawn, xs, ys};

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
