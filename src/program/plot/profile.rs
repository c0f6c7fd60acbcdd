//! The picture of a profile: its heights above, its power spectrum below.

use std::error::Error;
use std::fs;
use std::path::Path;

use plotters::prelude::*;

use super::axis::{Axis, Fit};
use super::chart::{Canvas, Chart, Drawn, FINE, LINE_WIDTH, Line, colour, svg};
use super::ladders::{LEFT, draw_axes};
use super::logarithmic::{Logarithmic, is_drawn};
use super::raster::png;
use crate::program::error::ProgramError;

const SIZE: (u32, u32) = (1000, 860);
/// Where the spectrum begins, from the top.
const SPLIT: u32 = 330 * FINE;
/// Intervals along the picture in which a profile's highest and lowest points are drawn, and no others.
const COLUMNS: usize = 1500;

/// What is drawn.
#[derive(Clone, Debug)]
pub(crate) struct ProfilePicture {
    /// What is written above the picture.
    pub(crate) title: String,
    /// Places and heights, m.
    pub(crate) heights: Vec<(f64, f64)>,
    /// Wave numbers (rad/m) and densities (m³).
    pub(crate) spectrum: Vec<(f64, f64)>,
    /// The power law's places of the same, if there is one.
    pub(crate) law: Vec<(f64, f64)>,
}

impl ProfilePicture {
    /// Draws the picture: as PNG where `path` ends so, else as SVG.
    pub(crate) fn write(&self, path: &Path) -> Result<(), ProgramError> {
        let bytes = self.bytes(path).map_err(|error| ProgramError::picture(path, &*error))?;
        fs::write(path, bytes).map_err(ProgramError::file("write", path))
    }

    fn bytes(&self, path: &Path) -> Result<Vec<u8>, Box<dyn Error>> {
        let text = svg(SIZE, Some(&self.title), |canvas| self.draw(canvas))?;
        let raster = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"));
        if raster { png(&text) } else { Ok(text.into_bytes()) }
    }

    fn draw(&self, canvas: &Canvas<'_>) -> Drawn {
        let (above, below) = canvas.split_vertically(SPLIT);
        self.profile().draw(&above)?;
        self.draw_spectrum(&below)
    }

    fn profile(&self) -> Chart {
        let points = outline(&self.heights);
        Chart {
            x: Axis::new("x", "m", points.iter().map(|point| point.0), Fit::Tight),
            y: Axis::new("z", "m", points.iter().map(|point| point.1), Fit::Round),
            lines: vec![Line { name: "profile".into(), points }],
        }
    }

    fn draw_spectrum(&self, canvas: &Canvas<'_>) -> Drawn {
        let drawn = |points: &[(f64, f64)]| -> Vec<(f64, f64)> {
            points.iter().copied().filter(|&(q, density)| is_drawn(q) && is_drawn(density)).collect()
        };
        let (spectrum, law) = (drawn(&self.spectrum), drawn(&self.law));
        // What rounding leaves beyond a cut-off is not drawn.
        let largest = spectrum.iter().map(|point| point.1).fold(0.0, f64::max);
        let spectrum: Vec<_> = spectrum.into_iter().filter(|point| point.1 > 1e-16 * largest).collect();
        let all = || spectrum.iter().chain(&law);
        let mut context = ChartBuilder::on(canvas)
            .margin(6 * FINE)
            .margin_right(28 * FINE)
            .x_label_area_size(46 * FINE)
            .y_label_area_size(LEFT)
            .build_cartesian_2d(Logarithmic::around(all().map(|p| p.0)), Logarithmic::around(all().map(|p| p.1)))?;
        draw_axes(&mut context, "wave number in rad/m", "power spectrum in m³")?;
        context.draw_series(LineSeries::new(spectrum, colour(0).stroke_width(LINE_WIDTH)))?;
        let line = colour(1).stroke_width(LINE_WIDTH);
        context.draw_series(DashedLineSeries::new(law, 8 * FINE, 5 * FINE, line))?;
        Ok(())
    }
}

/// Points that look like all of `points`: of many, the highest and the lowest of each interval.
fn outline(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    if points.len() <= 2 * COLUMNS {
        return points.to_vec();
    }
    let ends = |part: &[(f64, f64)]| -> [(f64, f64); 2] {
        let first = part[0];
        let low = part.iter().copied().fold(first, |low, point| if point.1 < low.1 { point } else { low });
        let high = part.iter().copied().fold(first, |high, point| if point.1 > high.1 { point } else { high });
        if low.0 < high.0 { [low, high] } else { [high, low] }
    };
    points.chunks(points.len().div_ceil(COLUMNS)).flat_map(ends).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_outline_keeps_the_extremes_and_the_order() {
        let points: Vec<(f64, f64)> = (0..100_000).map(|i| (f64::from(i), f64::from(i * 7919 % 1009))).collect();
        let drawn = outline(&points);
        assert!(drawn.len() <= 2 * COLUMNS && drawn.windows(2).all(|pair| pair[0].0 <= pair[1].0));
        let heights = || drawn.iter().map(|point| point.1);
        assert_eq!((heights().fold(f64::MAX, f64::min), heights().fold(f64::MIN, f64::max)), (0.0, 1008.0));
    }
}
