//! The picture of a profile: its heights above, its power spectrum below.

use std::path::Path;

use super::axis::Axis;
use super::chart::Chart;
use super::curve::{Curve, Stroke};
use super::linear::Fit;
use super::picture::{FINE, write};
use crate::program::files::FileError;

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
    pub(crate) fn write(&self, path: &Path) -> Result<(), FileError> {
        write(path, SIZE, Some(&self.title), |canvas| {
            let (above, below) = canvas.split_vertically(SPLIT);
            self.profile().draw_with_legend(&above)?;
            self.power_spectrum().draw_with_legend(&below)
        })
    }

    fn profile(&self) -> Chart {
        let points = outline(&self.heights);
        Chart {
            title: String::new(),
            x: Axis::linear("x", "m", points.iter().map(|point| point.0), Fit::Tight),
            y: Axis::linear("z", "m", points.iter().map(|point| point.1), Fit::Round),
            curves: vec![Curve { name: "profile".into(), look: 0, stroke: Stroke::Line, points }],
        }
    }

    fn power_spectrum(&self) -> Chart {
        // What rounding leaves beyond a cut-off is not drawn.
        let largest = self.spectrum.iter().map(|point| point.1).fold(0.0, f64::max);
        let spectrum = self.spectrum.iter().copied().filter(|point| point.1 > 1e-16 * largest).collect::<Vec<_>>();
        let all = || spectrum.iter().chain(&self.law);
        Chart {
            title: String::new(),
            x: Axis::logarithmic("wave number in rad/m", all().map(|point| point.0)),
            y: Axis::logarithmic("power spectrum in m³", all().map(|point| point.1)),
            curves: vec![
                Curve { name: "spectrum".into(), look: 0, stroke: Stroke::Line, points: spectrum },
                Curve { name: "power law".into(), look: 1, stroke: Stroke::Dashed, points: self.law.clone() },
            ],
        }
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
