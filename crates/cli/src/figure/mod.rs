//! Figures: charts drawn with plotters, as SVG or PNG by their files' names.

mod axis;
mod bands;
mod bars;
mod caption;
mod chart;
mod choice_grid;
mod contours;
mod difference;
mod field_grid;
mod grid_frame;
mod ladders;
mod layer;
mod maps;
mod moment;
mod panels;
mod patch;
mod plot;
mod raster;
mod row;
mod selection;
mod surface_maps;

use std::convert::Infallible;
use std::error::Error;
use std::path::Path;
use std::sync::Once;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::register_font;
use plotters::style::text_anchor::{HPos, VPos};
use plotters_backend::{BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingErrorKind};

pub(crate) use bands::{BandRow, Bands};
pub(crate) use bars::{Bar, Bars};
pub(crate) use caption::RUBBER_SLIDES;
pub(crate) use chart::{Curve, Stroke};
pub(crate) use choice_grid::{Choice, ChoiceGrid, ChoicePanel};
pub(crate) use field_grid::{FieldGrid, FieldPanel, MeasuredPlace};
pub(crate) use grid_frame::GridAxis;
pub(crate) use ladders::{Ladder, LadderPanel, Ladders, Rung};
pub(crate) use layer::LayerPicture;
pub(crate) use panels::{
    Below, ContactCurves, LinearPanel, LinearStack, Panel, PanelRow, ProfileCurves, ProfilePicture, SideBySide,
    Stacked, TimeHistory,
};
pub(crate) use patch::PatchHistory;
pub(crate) use plot::plot_files;
use raster::Raster;
pub(crate) use row::write_row;
pub(crate) use surface_maps::{Colours, FieldMap, Marks, SurfaceMaps};

use super::files::{self, FileError, ends_in};

/// Okabe and Ito's colours, which colour-blind readers can tell apart.
const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(70, 70, 70),
];
const INK: RGBColor = RGBColor(40, 40, 40);
const GRID: RGBColor = RGBColor(225, 225, 225);

/// Subpixels of a pixel along each axis. plotters rounds all coordinates to integers, so figures are drawn enlarged by
/// this factor; an SVG is then scaled down where it is shown, a PNG is averaged.
pub(crate) const FINE: u32 = 6;
/// Pixels of a PNG for one of the figure's, along each axis: sharp on a high-resolution screen and in print.
const SHARP: u32 = 2;

const TITLE_SIZE: u32 = 22 * FINE;
const TEXT_SIZE: u32 = 17 * FINE;
const TICK_SIZE: u32 = 15 * FINE;
const LINE_WIDTH: u32 = 2 * FINE;

/// DejaVu Sans, reduced to the characters that figures need: PNGs are the same on every machine.
const FONT: &[u8] = include_bytes!("font/DejaVuSans.ttf");
const FONT_FAMILY: &str = "sans-serif";

/// What a figure is drawn on: [`SVGBackend`] or [`Pixels`].
pub(crate) trait Backend: DrawingBackend<ErrorType: 'static> {}

impl<B: DrawingBackend<ErrorType: 'static>> Backend for B {}

/// A part of a figure to draw on.
pub(crate) type Canvas<B> = DrawingArea<B, Shift>;

pub(crate) type DrawResult = Result<(), Box<dyn Error>>;

/// A figure that can be written to a file.
pub(crate) trait Figure {
    /// Width and height, pixels.
    fn size(&self) -> (u32, u32);

    /// The title above the figure; empty for none.
    fn title(&self) -> &str {
        ""
    }

    /// Images below all that is drawn.
    fn images(&self) -> Vec<Raster> {
        Vec::new()
    }

    /// Draws everything but the title and the images.
    fn draw<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult;

    /// Writes the figure to `path`: as PNG where its name ends so, else as SVG.
    fn write(&self, path: &Path) -> Result<(), FileError> {
        let is_png = ends_in(path, "png");
        let bytes = if is_png { self.png(SHARP) } else { self.svg().map(String::into_bytes) };
        files::write(path, bytes.map_err(|error| files::not_drawn(path, error))?)
    }

    /// The text of the SVG file.
    fn svg(&self) -> Result<String, Box<dyn Error>> {
        let (size, drawn) = (self.size(), subpixels(self.size()));
        let mut text = String::new();
        let canvas = SVGBackend::with_string(&mut text, drawn).into_drawing_area();
        canvas.fill(&WHITE)?;
        draw_with_title(self, &canvas)?;
        canvas.present()?;
        drop(canvas);
        let [drawn, shown] = [drawn, size].map(|(width, height)| format!("<svg width=\"{width}\" height=\"{height}\""));
        let mut text = text.replacen(&drawn, &shown, 1);
        // The first element is the white background.
        let background = text.find("/>").map_or(text.len(), |end| end + "/>".len());
        let images: String = self.images().iter().map(Raster::svg).collect::<Result<_, _>>()?;
        text.insert_str(background, &images);
        Ok(text)
    }

    /// The PNG file, with `scale` pixels for one of the figure's along each axis; a divisor of [`FINE`].
    fn png(&self, scale: u32) -> Result<Vec<u8>, Box<dyn Error>> {
        let (width, height) = self.size();
        encode(&pixels(self, scale)?, width * scale, height * scale)
    }
}

/// The colours of a figure's pixels, `scale` for one of the figure's along each axis.
fn pixels<F: Figure + ?Sized>(figure: &F, scale: u32) -> Result<Vec<u8>, Box<dyn Error>> {
    let size = subpixels(figure.size());
    let mut rgb = vec![u8::MAX; 3 * size.0 as usize * size.1 as usize];
    figure.images().iter().for_each(|image| image.paint(&mut rgb, size.0 as usize));
    draw_with_title(figure, &Pixels { size, rgb: &mut rgb }.into_drawing_area())?;
    Ok(averaged(&rgb, size.0 as usize, (FINE / scale) as usize))
}

fn subpixels((width, height): (u32, u32)) -> (u32, u32) {
    (FINE * width, FINE * height)
}

fn draw_with_title<F: Figure + ?Sized, B: Backend>(figure: &F, canvas: &Canvas<B>) -> DrawResult {
    if figure.title().is_empty() {
        return figure.draw(canvas);
    }
    figure.draw(&canvas.margin(6 * FINE, 0, 0, 0).titled(figure.title(), text_style(TITLE_SIZE))?)
}

/// Text of `size` subpixels.
fn text_style(size: u32) -> TextStyle<'static> {
    static REGISTERED: Once = Once::new();
    // A font that cannot be read makes every text an error when it is drawn.
    REGISTERED.call_once(|| drop(register_font(FONT_FAMILY, FontStyle::Normal, FONT)));
    (FONT_FAMILY, size).into_font().color(&INK)
}

/// The width of a text of `size`, in subpixels.
fn text_width(text: &str, size: u32) -> u32 {
    text_style(size).font.box_size(text).map_or(0, |(width, _)| width)
}

/// The colour of a curve by its number; they repeat after the last.
fn colour(look: usize) -> RGBColor {
    COLOURS[look % COLOURS.len()]
}

/// An image of subpixels. plotters' own bitmap backend fills one polygon around the whole of a thick line, which has
/// spikes and holes where the line turns sharply; resvg took 29 more packages and a quarter of the time to compile.
#[derive(Debug)]
struct Pixels<'a> {
    size: (u32, u32),
    rgb: &'a mut [u8],
}

type PixelResult = Result<(), DrawingErrorKind<Infallible>>;

impl DrawingBackend for Pixels<'_> {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        self.size
    }

    fn ensure_prepared(&mut self) -> PixelResult {
        Ok(())
    }

    fn present(&mut self) -> PixelResult {
        Ok(())
    }

    fn draw_pixel(&mut self, (x, y): BackendCoord, colour: BackendColor) -> PixelResult {
        let (width, height) = self.size;
        if let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y))
            && x < width
            && y < height
        {
            let at = 3 * (y as usize * width as usize + x as usize);
            let (red, green, blue) = colour.rgb;
            for (old, new) in self.rgb[at..at + 3].iter_mut().zip([red, green, blue]) {
                let blend = f64::from(*old) + colour.alpha * (f64::from(new) - f64::from(*old));
                *old = blend.round() as u8;
            }
        }
        Ok(())
    }

    /// A rectangle for each segment, and discs where they meet.
    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(&mut self, path: I, style: &S) -> PixelResult {
        let points: Vec<_> = path.into_iter().collect();
        let width = style.stroke_width();
        for ends in points.windows(2).filter(|ends| ends[0] != ends[1]) {
            self.fill_polygon(thick_segment(ends[0], ends[1], width), style)?;
        }
        let mut joints = points.iter().skip(1).take(points.len().saturating_sub(2));
        joints.try_for_each(|&point| self.draw_circle(point, width / 2, style, true))
    }

    /// As plotters does it, but with the baseline of the SVG: plotters sets glyphs of ab_glyph too high.
    fn draw_text<S: BackendTextStyle>(&mut self, text: &str, style: &S, (x, y): BackendCoord) -> PixelResult {
        let failed = |error| DrawingErrorKind::FontError(Box::new(error));
        let ((left, top), (right, bottom)) = style.layout_box(text).map_err(failed)?;
        let across = match style.anchor().h_pos {
            HPos::Left => 0,
            HPos::Center => (left - right) / 2,
            HPos::Right => left - right,
        };
        let down = match style.anchor().v_pos {
            VPos::Top => 0,
            VPos::Center => (top - bottom) / 2,
            VPos::Bottom => top - bottom,
        };
        let down = down + (BASELINE * style.size()).round() as i32;
        let drawn = style.draw(text, (0, 0), |dx, dy, colour| {
            let (dx, dy) = style.transform().transform(dx + across - left, dy + down - top);
            self.draw_pixel((x + dx, y + dy), colour)
        });
        drawn.map_err(failed)?
    }
}

/// What is added to a text's position, as a share of its size.
const BASELINE: f64 = 0.11;

/// The corners of a segment of some width, which must have a length.
fn thick_segment(from: BackendCoord, to: BackendCoord, width: u32) -> [BackendCoord; 4] {
    let (dx, dy) = (f64::from(to.0 - from.0), f64::from(to.1 - from.1));
    let half = f64::from(width) / 2.0 / dx.hypot(dy);
    let (x, y) = ((-dy * half).round() as i32, (dx * half).round() as i32);
    [(from.0 + x, from.1 + y), (to.0 + x, to.1 + y), (to.0 - x, to.1 - y), (from.0 - x, from.1 - y)]
}

/// The means over squares of `by` × `by` subpixels, of an image of `width` subpixels.
fn averaged(rgb: &[u8], width: usize, by: usize) -> Vec<u8> {
    let mut means = Vec::with_capacity(rgb.len() / (by * by));
    for rows in rgb.chunks_exact(3 * width * by) {
        let mut sums = vec![0_usize; 3 * width / by];
        for row in rows.chunks_exact(3 * width) {
            for (i, value) in row.iter().enumerate() {
                sums[3 * (i / (3 * by)) + i % 3] += usize::from(*value);
            }
        }
        means.extend(sums.iter().map(|sum| (sum / (by * by)) as u8));
    }
    means
}

fn encode(rgb: &[u8], width: u32, height: u32) -> Result<Vec<u8>, Box<dyn Error>> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header()?.write_image_data(rgb)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The subpixels of a blank image after `draw`.
    fn drawn(size: (u32, u32), draw: impl FnOnce(&Canvas<Pixels<'_>>) -> DrawResult) -> Vec<u8> {
        let mut rgb = vec![u8::MAX; 3 * size.0 as usize * size.1 as usize];
        draw(&Pixels { size, rgb: &mut rgb }.into_drawing_area()).unwrap();
        rgb
    }

    /// Each character of a tick and of a legend has its own outline, not the box of a missing one.
    #[test]
    fn letters_are_drawn() {
        let picture = |text: &str| {
            drawn((160, 40), |canvas| Ok(canvas.draw(&Text::new(text.to_owned(), (4, 4), text_style(24)))?))
        };
        assert!(picture("").iter().all(|&value| value == u8::MAX));
        let missing = picture("\u{4e00}");
        for letter in ["1", "⁻", "⁰", "¹", "⁹", "F", "µ", "τ"] {
            let letter_drawn = picture(letter);
            assert!(letter_drawn.iter().any(|&value| value < 128) && letter_drawn != missing, "{letter}");
        }
    }

    #[test]
    fn a_thick_line_has_no_holes_and_no_spikes() {
        let points = vec![(50, 10), (52, 90), (54, 10), (50, 50), (50, 52)];
        let rgb =
            drawn((100, 100), |canvas| Ok(canvas.draw(&PathElement::new(points, BLACK.filled().stroke_width(10)))?));
        let is_black = |x: usize, y: usize| rgb[3 * (100 * y + x)] == 0;
        assert!((15..85).all(|y| (49..54).all(|x| is_black(x, y))));
        assert!(
            (0..100).all(|y| (0..100).all(|x| !is_black(x, y) || ((44..=60).contains(&x) && (4..=96).contains(&y))))
        );
    }

    #[test]
    fn a_pixel_is_the_mean_of_its_subpixels() {
        let rgb: Vec<u8> = (0..2 * 4).flat_map(|i| [i, 10 * i, 100]).collect();
        assert_eq!(averaged(&rgb, 4, 2), [2, 25, 100, 4, 45, 100]);
    }
}
