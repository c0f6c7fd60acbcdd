//! An image within a figure: what has a colour at every point of a grid.

use std::error::Error;

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use plotters::style::RGBColor;

use super::encode;

/// An image and where it stands in a figure.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Raster {
    /// The corner at the upper left and the size, subpixels.
    corner: (u32, u32),
    size: (u32, u32),
    /// Pixels of a row.
    width: usize,
    /// From the upper left, row by row.
    rgb: Vec<u8>,
}

/// More pixels than these along an edge would not be seen.
const MOST: usize = 720;

impl Raster {
    /// The image of a grid's colours, rows of `nx` from the lowest one; neighbours of large grids are averaged.
    pub(super) fn new(corner: (u32, u32), size: (u32, u32), nx: usize, colours: &[RGBColor]) -> Self {
        let ny = colours.len() / nx;
        let by = nx.max(ny).div_ceil(MOST);
        let rows = (0..ny).step_by(by).rev();
        let rgb = rows.flat_map(|j| (0..nx).step_by(by).flat_map(move |i| mean(colours, nx, (i, j), by))).collect();
        Self { corner, size, width: nx.div_ceil(by), rgb }
    }

    /// The image so many subpixels lower.
    pub(super) fn below(self, by: u32) -> Self {
        Self { corner: (self.corner.0, self.corner.1 + by), ..self }
    }

    fn height(&self) -> usize {
        self.rgb.len() / 3 / self.width
    }

    /// The element of an SVG.
    pub(super) fn svg(&self) -> Result<String, Box<dyn Error>> {
        let png = encode(&self.rgb, self.width as u32, self.height() as u32)?;
        let ((x, y), (width, height), data) = (self.corner, self.size, BASE64_STANDARD.encode(png));
        Ok(format!(
            "\n<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\" \
             image-rendering=\"pixelated\" href=\"data:image/png;base64,{data}\"/>"
        ))
    }

    /// Draws it to an image with rows of `width` subpixels.
    pub(super) fn paint(&self, rgb: &mut [u8], width: usize) {
        let (x, y) = (self.corner.0 as usize, self.corner.1 as usize);
        let (across, down) = (self.size.0 as usize, self.size.1 as usize);
        for j in 0..down {
            let row = &self.rgb[j * self.height() / down * 3 * self.width..][..3 * self.width];
            let drawn = &mut rgb[3 * ((y + j) * width + x)..][..3 * across];
            for (i, drawn) in drawn.chunks_exact_mut(3).enumerate() {
                drawn.copy_from_slice(&row[3 * (i * self.width / across)..][..3]);
            }
        }
    }
}

/// The mean colour of so many columns and rows from a point on, as far as there are.
fn mean(colours: &[RGBColor], nx: usize, (i, j): (usize, usize), by: usize) -> [u8; 3] {
    let rows = colours.chunks_exact(nx).skip(j).take(by);
    let (mut sums, mut count) = ([0_u32; 3], 0);
    for &RGBColor(red, green, blue) in rows.flat_map(|row| &row[i..(i + by).min(nx)]) {
        sums.iter_mut().zip([red, green, blue]).for_each(|(sum, part)| *sum += u32::from(part));
        count += 1;
    }
    sums.map(|sum| (sum / count) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first row is the lowest, and a subpixel has the colour of the point that it lies in.
    #[test]
    fn an_image_is_painted_with_its_first_row_at_the_bottom() {
        let colours = [1, 2, 3, 4, 5, 6].map(|part| RGBColor(part, 0, 10 * part));
        let image = Raster::new((1, 1), (6, 4), 3, &colours);
        let mut rgb = vec![0; 3 * 8 * 6];
        image.paint(&mut rgb, 8);
        let red = |x: usize, y: usize| rgb[3 * (8 * y + x)];
        assert_eq!((1..7).map(|x| red(x, 1)).collect::<Vec<_>>(), [4, 4, 5, 5, 6, 6]);
        assert_eq!([red(1, 3), red(6, 4), red(0, 1), red(7, 1), red(1, 5)], [1, 3, 0, 0, 0]);
        assert!(image.svg().is_ok_and(|svg| svg.contains("width=\"6\" height=\"4\"") && svg.contains("base64,iVBOR")));
    }

    #[test]
    fn neighbours_of_a_large_grid_are_averaged() {
        let nx = 2 * MOST - 1;
        let colours: Vec<_> = (0..3 * nx).map(|at| RGBColor((at % nx % 2 * 100) as u8, 0, (at / nx) as u8)).collect();
        let image = Raster::new((0, 0), (1, 1), nx, &colours);
        assert_eq!((image.width, image.height()), (MOST, 2));
        // Above the last row alone, below the mean of 0 and 1; on the right a column alone.
        assert_eq!((&image.rgb[..3], &image.rgb[3 * (2 * MOST - 1)..]), (&[50, 0, 2][..], &[0, 0, 0][..]));
    }
}
