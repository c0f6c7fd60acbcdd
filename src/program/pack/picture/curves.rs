//! model.png of an element: the friction coefficient over the logarithm of speed, a line a pressure.

use std::error::Error;

use asperity::element::{Quantity, Table};

use plotters::style::RGBColor;

use super::sketch::{Point, Sketch};
use super::{HEIGHT, WIDTH};

/// Pixels between the picture's edges and the lines.
const MARGIN: f64 = 14.0;
/// Radius of a point of the table, pixels.
const POINT: f64 = 2.0;
const AXES: RGBColor = RGBColor(70, 70, 70);
/// Of the lowest pressure and of the highest.
const ENDS: [[u8; 3]; 2] = [[86, 160, 210], [0, 60, 100]];

/// The picture as a PNG file. Where there are temperatures, at the middle one.
pub(in super::super) fn element_png(table: &Table) -> Result<Vec<u8>, Box<dyn Error>> {
    Sketch::png(|sketch| {
        let corners = [(MARGIN, MARGIN), (MARGIN, HEIGHT - MARGIN), (WIDTH - MARGIN, HEIGHT - MARGIN)];
        sketch.line(corners.into_iter(), AXES)?;
        (0..table.pressures.len()).try_for_each(|i| {
            let (points, colour) = (points(table, i), colour(i, table.pressures.len()));
            sketch.line(points.iter().copied(), colour)?;
            points.iter().try_for_each(|&point| sketch.disc(point, POINT, colour))
        })
    })
}

/// Where the points of one pressure are drawn.
fn points(table: &Table, pressure: usize) -> Vec<Point> {
    let temperature = table.temperatures.len() / 2;
    let friction = |i, j| table.value(Quantity::Friction, (temperature, i, j));
    let all = (0..table.pressures.len()).flat_map(|i| (0..table.speeds.len()).map(move |j| friction(i, j)));
    let largest = all.fold(f64::MIN_POSITIVE, f64::max);
    let place = |j: usize| {
        let share = if table.speeds.len() > 1 { j as f64 / (table.speeds.len() - 1) as f64 } else { 0.5 };
        let x = MARGIN + POINT + share * (WIDTH - 2.0 * (MARGIN + POINT));
        (x, MARGIN + (1.0 - friction(pressure, j) / largest) * (HEIGHT - 2.0 * MARGIN))
    };
    (0..table.speeds.len()).map(place).collect()
}

fn colour(i: usize, count: usize) -> RGBColor {
    let share = i as f64 / (count.max(2) - 1) as f64;
    let [red, green, blue] = std::array::from_fn(|k| {
        let [low, high] = ENDS.map(|end| f64::from(end[k]));
        (low + share * (high - low)).round() as u8
    });
    RGBColor(red, green, blue)
}
