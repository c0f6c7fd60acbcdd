//! Pictures of the page: curves over one pair of axes, as SVG.

use plotters::coord::combinators::IntoLogRange;
use plotters::coord::ranged1d::ValueFormatter;
use plotters::prelude::*;
use plotters::style::register_font;

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
    pub legend: Legend,
    pub curves: Vec<Curve>,
}

/// Where no curve is.
#[derive(Clone, Copy, Debug)]
pub enum Legend {
    UpperLeft,
    UpperRight,
    MiddleRight,
    LowerRight,
    /// The axis goes on above the curves for it.
    Above,
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

/// Okabe and Ito's colours.
const COLOURS: [RGBColor; 5] =
    [RGBColor(0, 114, 178), RGBColor(213, 94, 0), RGBColor(0, 158, 115), RGBColor(204, 121, 167), RGBColor(70, 70, 70)];
const INK: RGBColor = RGBColor(40, 40, 40);
/// What text is measured by; viewers draw it with a font of their own.
const FONT: &[u8] = include_bytes!("../../../crates/cli/src/figure/font/DejaVuSans.ttf");
const SIZE: (u32, u32) = (640, 360);
/// Parts of a pixel: plotters rounds coordinates to whole ones.
const FINE: i32 = 6;
const LINE: u32 = 2 * FINE as u32;

impl Picture {
    /// The file's text.
    pub fn svg(&self) -> String {
        assert!(register_font("sans-serif", FontStyle::Normal, FONT).is_ok());
        let points = || self.curves.iter().flat_map(|curve| &curve.points);
        let ends = |of: fn(&(f64, f64)) -> f64| {
            points().map(of).fold((f64::MAX, f64::MIN), |(low, high), value| (low.min(value), high.max(value)))
        };
        let (x, y) = (ends(|point| point.0), ends(|point| point.1));
        let above = if matches!(self.legend, Legend::Above) { 0.1 * self.curves.len() as f64 } else { 0.06 };
        let y = (y.0.min(0.0), y.1 + above * (y.1 - y.0.min(0.0)));
        let drawn = (FINE as u32 * SIZE.0, FINE as u32 * SIZE.1);
        let mut text = String::new();
        let canvas = SVGBackend::with_string(&mut text, drawn).into_drawing_area();
        canvas.fill(&WHITE).unwrap();
        let mut builder = ChartBuilder::on(&canvas);
        builder.margin(14 * FINE).x_label_area_size(44 * FINE).y_label_area_size(64 * FINE);
        if self.is_logarithmic {
            self.draw(builder.build_cartesian_2d((x.0..x.1).log_scale(), y.0..y.1).unwrap());
        } else {
            self.draw(builder.build_cartesian_2d(x.0..x.1, y.0..y.1).unwrap());
        }
        canvas.present().unwrap();
        drop(canvas);
        let [drawn, shown] = [drawn, SIZE].map(|(width, height)| format!("<svg width=\"{width}\" height=\"{height}\""));
        text.replacen(&drawn, &shown, 1)
    }

    fn draw<'a, X>(&self, mut chart: ChartContext<'a, SVGBackend<'a>, Cartesian2d<X, RangedF64>>)
    where
        X: Ranged<ValueType = f64> + ValueFormatter<f64>,
    {
        let text = |size: i32| ("sans-serif", size * FINE).into_font().color(&INK);
        let mut mesh = chart.configure_mesh();
        mesh.x_desc(self.x).y_desc(self.y).label_style(text(13)).axis_desc_style(text(15));
        let label = |value: &f64| asperity_study::decimals::short(*value, 3);
        mesh.x_label_formatter(&label).y_label_formatter(&label);
        mesh.light_line_style(TRANSPARENT)
            .bold_line_style(RGBColor(225, 225, 225).stroke_width(FINE as u32))
            .axis_style(INK.stroke_width(FINE as u32))
            .draw()
            .unwrap();
        for (number, curve) in self.curves.iter().enumerate() {
            let colour = COLOURS[number % COLOURS.len()];
            if curve.is_marks {
                let mark = |point: &(f64, f64)| Circle::new(*point, 4 * FINE, colour.filled());
                let drawn = chart.draw_series(curve.points.iter().map(mark)).unwrap();
                drawn
                    .label(&curve.name)
                    .legend(move |(x, y)| Circle::new((x + 10 * FINE, y), 4 * FINE, colour.filled()));
            } else {
                let line = PathElement::new(curve.points.clone(), colour.stroke_width(LINE));
                let drawn = chart.draw_series([line]).unwrap();
                let legend = move |(x, y)| PathElement::new([(x, y), (x + 20 * FINE, y)], colour.stroke_width(LINE));
                drawn.label(&curve.name).legend(legend);
            }
        }
        let corner = match self.legend {
            Legend::UpperLeft => SeriesLabelPosition::UpperLeft,
            Legend::UpperRight | Legend::Above => SeriesLabelPosition::UpperRight,
            Legend::MiddleRight => SeriesLabelPosition::MiddleRight,
            Legend::LowerRight => SeriesLabelPosition::LowerRight,
        };
        let mut labels = chart.configure_series_labels();
        labels
            .background_style(WHITE.mix(0.8))
            .label_font(text(13))
            .position(corner)
            .legend_area_size(26 * FINE)
            .margin(6 * FINE);
        labels.draw().unwrap();
    }
}

type RangedF64 = plotters::coord::types::RangedCoordf64;
