//! model.png of an element: the friction coefficient over the logarithm of speed, a line a pressure.

use asperity::element::{Quantity, Table};

use super::canvas::{Canvas, Colour, Point};
use super::{LINE, SIZE};

/// Pixels between the picture's edges and the lines.
const MARGIN: f64 = 14.0;
/// Radius of a point of the table, pixels.
const POINT: f64 = 2.0;
const AXES: Colour = [70, 70, 70];
/// Of the lowest pressure and of the highest.
const ENDS: [Colour; 2] = [[86, 160, 210], [0, 60, 100]];

/// The picture as a PNG file. Where there are temperatures, at the middle one.
pub(in super::super) fn element_png(table: &Table) -> Result<Vec<u8>, png::EncodingError> {
    let mut canvas = Canvas::new(SIZE);
    let (width, height) = (SIZE.0 as f64, SIZE.1 as f64);
    let corners = [(MARGIN, MARGIN), (MARGIN, height - MARGIN), (width - MARGIN, height - MARGIN)];
    canvas.polyline(corners.into_iter(), LINE, AXES);
    for i in 0..table.pressures.len() {
        let (points, colour) = (points(table, i), colour(i, table.pressures.len()));
        canvas.polyline(points.iter().copied(), LINE, colour);
        points.iter().for_each(|&point| canvas.disc(point, POINT, colour));
    }
    canvas.png()
}

/// Where the points of one pressure are drawn.
fn points(table: &Table, pressure: usize) -> Vec<Point> {
    let temperature = table.temperatures.len() / 2;
    let friction = |i, j| table.value(Quantity::Friction, (temperature, i, j));
    let all = (0..table.pressures.len()).flat_map(|i| (0..table.speeds.len()).map(move |j| friction(i, j)));
    let largest = all.fold(f64::MIN_POSITIVE, f64::max);
    let place = |j: usize| {
        let share = if table.speeds.len() > 1 { j as f64 / (table.speeds.len() - 1) as f64 } else { 0.5 };
        let x = MARGIN + POINT + share * (SIZE.0 as f64 - 2.0 * (MARGIN + POINT));
        (x, MARGIN + (1.0 - friction(pressure, j) / largest) * (SIZE.1 as f64 - 2.0 * MARGIN))
    };
    (0..table.speeds.len()).map(place).collect()
}

fn colour(i: usize, count: usize) -> Colour {
    let share = i as f64 / (count.max(2) - 1) as f64;
    std::array::from_fn(|k| {
        let [low, high] = ENDS.map(|end| f64::from(end[k]));
        (low + share * (high - low)).round() as u8
    })
}
