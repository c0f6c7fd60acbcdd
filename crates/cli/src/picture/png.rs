//! A drawing as an image of pixels.

use ab_glyph::OutlineCurve;
use asperity_study::picture::{Colour, Point};
use png::{ColorType, EncodingError};
use tiny_skia::{
    Color, FillRule, LineJoin, Paint as SkiaPaint, Path, PathBuilder, Pixmap, Rect, Stroke, StrokeDash, Transform,
};

use super::drawing::{Drawing, Item, Paint, Pen, Side, TO_BASE_LINE};
use super::font;

/// The file, with `scale` pixels for one of the drawing's along each axis.
pub(super) fn png(drawing: &Drawing, scale: f64) -> Result<Vec<u8>, EncodingError> {
    let [width, height] = drawing.size.map(|side| (scale * side).ceil().max(1.0) as u32);
    // There are none of sizes beyond the memory.
    let Some(image) = Pixmap::new(width, height) else { return encode(&[], 0) };
    let mut canvas = Canvas { image, scale: Transform::from_scale(scale as f32, scale as f32) };
    canvas.image.fill(Color::WHITE);
    drawing.items.iter().for_each(|item| canvas.draw(item));
    // On white nothing is left to see through.
    let rgb: Vec<u8> = canvas.image.data().chunks_exact(4).flat_map(|pixel| &pixel[..3]).copied().collect();
    encode(&rgb, width as usize)
}

/// The PNG file of pixels, red, green and blue each, in rows of `width`.
pub(super) fn encode(rgb: &[u8], width: usize) -> Result<Vec<u8>, EncodingError> {
    let mut bytes = Vec::new();
    let height = rgb.len() / 3 / width.max(1);
    let mut encoder = png::Encoder::new(&mut bytes, width as u32, height as u32);
    encoder.set_color(ColorType::Rgb);
    encoder.write_header()?.write_image_data(rgb)?;
    Ok(bytes)
}

struct Canvas {
    image: Pixmap,
    scale: Transform,
}

impl Canvas {
    fn draw(&mut self, item: &Item) {
        match item {
            Item::Path { points, is_closed, fill, pen } => self.path(path(points, *is_closed), *fill, *pen),
            Item::Circle { at: [x, y], radius, fill, pen } => {
                self.path(PathBuilder::from_circle(*x as f32, *y as f32, *radius as f32), *fill, *pen);
            }
            Item::Text { text, at: [x, y], side, size, colour, is_upright } => {
                let width = font::width(text, *size);
                let along = match side {
                    Side::Start => 0.0,
                    Side::Middle => -width / 2.0,
                    Side::End => -width,
                };
                let start = Transform::from_translate(along as f32, (TO_BASE_LINE * size) as f32);
                let turned = Transform::from_rotate(if *is_upright { -90.0 } else { 0.0 });
                let placed = start.post_concat(turned).post_translate(*x as f32, *y as f32);
                let outline = letters(&font::outlines(text, *size)).and_then(|path| path.transform(placed));
                self.path(outline, Some(Paint::full(*colour)), None);
            }
            Item::Image { corner, size, columns, colours } => self.cells((*corner, *size), *columns, colours),
        }
    }

    fn path(&mut self, path: Option<Path>, fill: Option<Paint>, pen: Option<Pen>) {
        // There is no path through nothing.
        let Some(path) = path else { return };
        if let Some(fill) = fill {
            self.image.fill_path(&path, &paint(fill), FillRule::Winding, self.scale, None);
        }
        if let Some(Pen { paint: of_line, width, dashes }) = pen {
            let dash = dashes.and_then(|dashes| StrokeDash::new(dashes.map(|length| length as f32).to_vec(), 0.0));
            let stroke = Stroke { width: width as f32, dash, line_join: LineJoin::Round, ..Stroke::default() };
            self.image.stroke_path(&path, &paint(of_line), &stroke, self.scale, None);
        }
    }

    /// Rectangles whose edges are not blurred, so that nothing shows between them.
    fn cells(&mut self, ([left, top], [width, height]): (Point, Point), columns: usize, colours: &[Colour]) {
        let rows = colours.len() / columns;
        let along = |start: f64, length: f64, i: usize, count: usize| (start + length * i as f64 / count as f64) as f32;
        for (i, colour) in colours.iter().enumerate() {
            let (column, row) = (i % columns, i / columns);
            let [x, to_x] = [column, column + 1].map(|i| along(left, width, i, columns));
            let [y, to_y] = [row, row + 1].map(|i| along(top, height, i, rows));
            let cell = Rect::from_ltrb(x, y, to_x, to_y);
            let unblurred = SkiaPaint { anti_alias: false, ..paint(Paint::full(*colour)) };
            cell.into_iter().for_each(|cell| self.image.fill_rect(cell, &unblurred, self.scale, None));
        }
    }
}

fn paint(Paint { colour: Colour([red, green, blue]), opacity }: Paint) -> SkiaPaint<'static> {
    let mut paint = SkiaPaint { anti_alias: true, ..SkiaPaint::default() };
    paint.set_color_rgba8(red, green, blue, (255.0 * opacity).round() as u8);
    paint
}

fn path(points: &[Point], is_closed: bool) -> Option<Path> {
    let mut path = PathBuilder::new();
    let mut places = points.iter().map(|point| point.map(|part| part as f32));
    places.next().iter().for_each(|[x, y]| path.move_to(*x, *y));
    places.for_each(|[x, y]| path.line_to(x, y));
    if is_closed {
        path.close();
    }
    path.finish()
}

/// The outlines of letters: where a curve begins elsewhere than the last ended, another outline does.
fn letters(curves: &[OutlineCurve]) -> Option<Path> {
    let mut path = PathBuilder::new();
    let mut last = None;
    for curve in curves {
        let (start, end) = match curve {
            OutlineCurve::Line(a, b) | OutlineCurve::Quad(a, _, b) | OutlineCurve::Cubic(a, _, _, b) => (a, b),
        };
        if last != Some(*start) {
            path.move_to(start.x, start.y);
        }
        match curve {
            OutlineCurve::Line(..) => path.line_to(end.x, end.y),
            OutlineCurve::Quad(_, b, _) => path.quad_to(b.x, b.y, end.x, end.y),
            OutlineCurve::Cubic(_, b, c, _) => path.cubic_to(b.x, b.y, c.x, c.y, end.x, end.y),
        }
        last = Some(*end);
    }
    path.finish()
}
