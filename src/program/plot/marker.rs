//! Markers, which tell lines apart without their colours.

use plotters::prelude::*;

use super::picture::{Canvas, Drawn, FINE, LINE_WIDTH, colour};

pub(super) const RADIUS: i32 = 5 * FINE as i32;
const MARKERS: usize = 4;

/// A disc, a square, a triangle or a diamond; or its outline.
pub(super) fn draw_marker(canvas: &Canvas<'_>, (x, y): (i32, i32), look: usize, hollow: bool) -> Drawn {
    let (r, edge) = (RADIUS, colour(look).stroke_width(LINE_WIDTH));
    let inside = if hollow { WHITE } else { colour(look) };
    let corners: &[(i32, i32)] = match look % MARKERS {
        0 => {
            canvas.draw(&Circle::new((x, y), r, inside.filled()))?;
            canvas.draw(&Circle::new((x, y), r, edge))?;
            return Ok(());
        }
        1 => &[(-r, -r), (r, -r), (r, r), (-r, r)],
        2 => &[(0, -r * 5 / 4), (r * 5 / 4, r), (-r * 5 / 4, r)],
        _ => &[(0, -r * 4 / 3), (r * 4 / 3, 0), (0, r * 4 / 3), (-r * 4 / 3, 0)],
    };
    let mut corners: Vec<(i32, i32)> = corners.iter().map(|(dx, dy)| (x + dx, y + dy)).collect();
    canvas.draw(&Polygon::new(corners.clone(), inside.filled()))?;
    corners.extend([corners[0], corners[1]]);
    canvas.draw(&PathElement::new(corners, edge))?;
    Ok(())
}
