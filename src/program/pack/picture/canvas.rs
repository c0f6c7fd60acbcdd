//! A small picture with smooth edges.

/// Red, green, blue.
pub(super) type Colour = [u8; 3];

/// x to the right, y down, pixels from the upper left corner.
pub(super) type Point = (f64, f64);

/// Samples along each side of a pixel.
const SAMPLES: usize = 4;

/// The picture: opaque, white where nothing is drawn.
pub(super) struct Canvas {
    width: usize,
    height: usize,
    pixels: Vec<Colour>,
}

impl Canvas {
    pub(super) fn new((width, height): (usize, usize)) -> Self {
        Self { width, height, pixels: vec![[255; 3]; width * height] }
    }

    /// Paints what of the rectangle between two corners is `inside`.
    pub(super) fn fill(&mut self, from: Point, to: Point, colour: Colour, inside: impl Fn(Point) -> bool) {
        for row in pixels(from.1, to.1, self.height) {
            for column in pixels(from.0, to.0, self.width) {
                let pixel = &mut self.pixels[row * self.width + column];
                *pixel = mixed(*pixel, colour, covered(column, row, &inside));
            }
        }
    }

    /// Paints a disc.
    pub(super) fn disc(&mut self, centre: Point, radius: f64, colour: Colour) {
        self.capsule(centre, centre, radius, colour);
    }

    /// Paints lines from corner to corner, round at the ends.
    pub(super) fn polyline(&mut self, corners: impl Iterator<Item = Point>, half_width: f64, colour: Colour) {
        let corners: Vec<_> = corners.collect();
        corners.windows(2).for_each(|ends| self.capsule(ends[0], ends[1], half_width, colour));
    }

    /// Paints what lies within `radius` of the line from `a` to `b`.
    fn capsule(&mut self, a: Point, b: Point, radius: f64, colour: Colour) {
        let from = (a.0.min(b.0) - radius, a.1.min(b.1) - radius);
        let to = (a.0.max(b.0) + radius, a.1.max(b.1) + radius);
        self.fill(from, to, colour, |point| squared_distance(point, a, b) <= radius * radius);
    }

    /// The picture as a PNG file, without a date.
    pub(super) fn png(&self) -> Result<Vec<u8>, png::EncodingError> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.write_header()?.write_image_data(self.pixels.as_flattened())?;
        Ok(bytes)
    }
}

/// The pixels between two places along one side.
fn pixels(from: f64, to: f64, size: usize) -> std::ops::Range<usize> {
    from.max(0.0) as usize..(to.ceil().max(0.0) as usize).min(size)
}

/// The share of a pixel that is `inside`.
fn covered(column: usize, row: usize, inside: impl Fn(Point) -> bool) -> f64 {
    let middle = |pixel: usize, sample: usize| pixel as f64 + (sample as f64 + 0.5) / SAMPLES as f64;
    let samples = (0..SAMPLES * SAMPLES).map(|i| (middle(column, i % SAMPLES), middle(row, i / SAMPLES)));
    samples.filter(|&sample| inside(sample)).count() as f64 / (SAMPLES * SAMPLES) as f64
}

fn mixed(below: Colour, above: Colour, share: f64) -> Colour {
    std::array::from_fn(|i| {
        let (below, above) = (f64::from(below[i]), f64::from(above[i]));
        (below + share * (above - below)).round() as u8
    })
}

fn squared_distance(point: Point, a: Point, b: Point) -> f64 {
    let (along, to) = ((b.0 - a.0, b.1 - a.1), (point.0 - a.0, point.1 - a.1));
    let length = along.0 * along.0 + along.1 * along.1;
    let part = if length > 0.0 { ((to.0 * along.0 + to.1 * along.1) / length).clamp(0.0, 1.0) } else { 0.0 };
    let (x, y) = (to.0 - part * along.0, to.1 - part * along.1);
    x * x + y * y
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_half_covered_is_half_painted() {
        let mut canvas = Canvas::new((3, 1));
        canvas.fill((0.0, 0.0), (3.0, 1.0), [0, 0, 0], |(x, _)| x < 1.5);
        assert_eq!(canvas.pixels, [[0; 3], [128; 3], [255; 3]]);
    }

    #[test]
    fn what_lies_outside_is_cut_off() {
        let mut canvas = Canvas::new((2, 2));
        canvas.disc((-5.0, 1.0), 3.0, [0; 3]);
        canvas.disc((9.0, 9.0), 3.0, [0; 3]);
        assert_eq!(canvas.pixels, [[255; 3]; 4]);
        canvas.disc((1.0, 1.0), 30.0, [0; 3]);
        assert_eq!(canvas.pixels, [[0; 3]; 4]);
    }
}
