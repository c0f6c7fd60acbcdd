//! model.png: of a layer the first masses at rest between the carrier and the profile, of an element its friction
//! coefficients. Both are pictures without text, in pixels from the upper left corner.

use std::error::Error;

use asperity::element::{FrictionTable, Node, Quantity};
use asperity::math::Spline;
use asperity::scene::{LinkKind, Scene};
use plotters::prelude::*;

use crate::figure::{Backend, Canvas, DrawResult, FINE, Figure};

/// Width and height, pixels.
const SIZE: (u32, u32) = (240, 160);
const WIDTH: f64 = SIZE.0 as f64;
const HEIGHT: f64 = SIZE.1 as f64;
/// Width of a line, pixels.
const LINE: f64 = 1.4;

/// Most masses drawn: few enough to be told apart.
const MASSES: usize = 10;
/// The carrier's lower edge, pixels from the top.
const CARRIER: f64 = 22.0;
/// Heights of the highest and of the lowest point of profile and masses, pixels from the top.
const HEIGHTS: (f64, f64) = (92.0, 140.0);
/// Radius of a mass, pixels.
const MASS: f64 = 4.0;
/// Half the width of a spring, pixels.
const WINDING: f64 = 3.5;
const CORNERS: usize = 9;

const STEEL: RGBColor = RGBColor(70, 70, 70);
const SURFACE: RGBColor = RGBColor(196, 188, 176);
const EDGE: RGBColor = RGBColor(110, 100, 88);
const RUBBER: RGBColor = RGBColor(0, 114, 178);
const LINK: RGBColor = RGBColor(86, 160, 210);

/// The PNG file of a layer.
pub(super) fn layer_png(scene: &Scene) -> Result<Vec<u8>, Box<dyn Error>> {
    LayerPicture::new(scene).png(1)
}

/// A layer at rest, in pixels.
struct LayerPicture<'a> {
    scene: &'a Scene,
    /// The profile at each column of pixels, and at the picture's right edge.
    profile: Vec<f64>,
    /// The masses' centres: a mass touches with its lowest point.
    masses: Vec<Pixel>,
}

impl<'a> LayerPicture<'a> {
    fn new(scene: &'a Scene) -> Self {
        let layer = &scene.layer;
        let masses = layer.masses.min(MASSES);
        let pitch = layer.spacing * masses as f64 / WIDTH;
        let left = layer.origin - layer.spacing / 2.0;
        let rest: Vec<f64> = (0..masses).map(|i| layer.clearance + layer.roughness.get(i).unwrap_or(&0.0)).collect();
        let profile = heights(scene.surface.spline(), left, pitch);
        let row = rows(rest.iter().chain(&profile));
        let column = |i: usize| (i as f64 + 0.5) * WIDTH / masses as f64;
        let centre = |(i, z): (usize, &f64)| (column(i), row(*z) - MASS);
        let masses = rest.iter().enumerate().map(centre).collect();
        Self { scene, masses, profile: profile.iter().map(|z| row(*z)).collect() }
    }

    fn draw_profile<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        let edge = || self.profile.iter().enumerate().map(|(i, &y)| (i as f64, y));
        fill(canvas, edge().chain([(WIDTH, HEIGHT), (0.0, HEIGHT)]), SURFACE)?;
        line(canvas, edge(), EDGE)
    }

    fn draw_links<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        let has = |kinds: [LinkKind; 2]| kinds.into_iter().any(|kind| self.scene.link(kind).is_some());
        if has([LinkKind::LateralX, LinkKind::LateralZ]) {
            line(canvas, self.masses.iter().copied(), LINK)?;
        }
        if has([LinkKind::Vertical, LinkKind::Horizontal]) {
            self.masses.iter().try_for_each(|&mass| line(canvas, spring(mass), LINK))?;
        }
        Ok(())
    }
}

impl Figure for LayerPicture<'_> {
    fn size(&self) -> (u32, u32) {
        SIZE
    }

    fn draw<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        self.draw_profile(canvas)?;
        fill(canvas, [(0.0, 0.0), (WIDTH, 0.0), (WIDTH, CARRIER), (0.0, CARRIER)].into_iter(), STEEL)?;
        self.draw_links(canvas)?;
        self.masses.iter().try_for_each(|&centre| disc(canvas, centre, MASS, RUBBER))
    }
}

/// The profile's heights at the columns of pixels, m.
fn heights(profile: &Spline, left: f64, pitch: f64) -> Vec<f64> {
    (0..=SIZE.0).map(|i| profile.evaluate(left + pitch * i as f64).0).collect()
}

/// The map from a height (m) to pixels from the top, so that `heights` fill their space; a flat scene lies in the
/// middle.
fn rows<'a>(heights: impl Iterator<Item = &'a f64> + Clone) -> impl Fn(f64) -> f64 {
    let highest = heights.clone().copied().fold(f64::MIN, f64::max);
    let lowest = heights.copied().fold(f64::MAX, f64::min);
    let (top, bottom) = HEIGHTS;
    move |z| {
        if highest > lowest { top + (highest - z) / (highest - lowest) * (bottom - top) } else { (top + bottom) / 2.0 }
    }
}

/// A spring from the carrier down to a mass.
fn spring((x, end): Pixel) -> impl Iterator<Item = Pixel> {
    (0..=CORNERS).map(move |i| {
        let sideways = if i == 0 || i == CORNERS { 0.0 } else { WINDING * [1.0, -1.0][i % 2] };
        (x + sideways, CARRIER + (end - CARRIER) * i as f64 / CORNERS as f64)
    })
}

/// Between the edges of an element's picture and its axes, pixels.
const MARGIN: f64 = 14.0;
/// Radius of a point of the table, pixels.
const POINT: f64 = 2.0;
/// Colours of the lowest and the highest pressure.
const PRESSURES: [[u8; 3]; 2] = [[86, 160, 210], [0, 60, 100]];

/// The PNG file of an element.
pub(super) fn element_png(table: &FrictionTable) -> Result<Vec<u8>, Box<dyn Error>> {
    ElementPicture(table).png(1)
}

/// Friction coefficients over the logarithm of speed, a line for each pressure; of several temperatures, at the middle
/// one.
struct ElementPicture<'a>(&'a FrictionTable);

impl Figure for ElementPicture<'_> {
    fn size(&self) -> (u32, u32) {
        SIZE
    }

    fn draw<B: Backend>(&self, canvas: &Canvas<B>) -> DrawResult {
        let corners = [(MARGIN, MARGIN), (MARGIN, HEIGHT - MARGIN), (WIDTH - MARGIN, HEIGHT - MARGIN)];
        line(canvas, corners.into_iter(), STEEL)?;
        let count = self.0.grid.loads.len();
        (0..count).try_for_each(|i| {
            let (points, colour) = (self.points(i), pressure_colour(i, count));
            line(canvas, points.iter().copied(), colour)?;
            points.iter().try_for_each(|&point| disc(canvas, point, POINT, colour))
        })
    }
}

impl ElementPicture<'_> {
    /// The points of a pressure, in pixels.
    fn points(&self, pressure: usize) -> Vec<Pixel> {
        let table = self.0;
        let temperature = table.grid.temperatures.len() / 2;
        let friction = |load, speed| table.value(Quantity::Friction, Node { temperature, load, speed });
        let all = (0..table.grid.loads.len()).flat_map(|i| (0..table.grid.speeds.len()).map(move |j| friction(i, j)));
        let largest = all.fold(f64::MIN_POSITIVE, f64::max);
        let point = |j: usize| {
            let share = if table.grid.speeds.len() > 1 { j as f64 / (table.grid.speeds.len() - 1) as f64 } else { 0.5 };
            let x = MARGIN + POINT + share * (WIDTH - 2.0 * (MARGIN + POINT));
            (x, MARGIN + (1.0 - friction(pressure, j) / largest) * (HEIGHT - 2.0 * MARGIN))
        };
        (0..table.grid.speeds.len()).map(point).collect()
    }
}

fn pressure_colour(i: usize, count: usize) -> RGBColor {
    let share = i as f64 / (count.max(2) - 1) as f64;
    let [red, green, blue] = std::array::from_fn(|k| {
        let [low, high] = PRESSURES.map(|end| f64::from(end[k]));
        (low + share * (high - low)).round() as u8
    });
    RGBColor(red, green, blue)
}

/// x to the right, y down.
type Pixel = (f64, f64);

fn fill<B: Backend>(canvas: &Canvas<B>, corners: impl Iterator<Item = Pixel>, colour: RGBColor) -> DrawResult {
    Ok(canvas.draw(&Polygon::new(corners.map(subpixel).collect::<Vec<_>>(), colour.filled()))?)
}

fn line<B: Backend>(canvas: &Canvas<B>, points: impl Iterator<Item = Pixel>, colour: RGBColor) -> DrawResult {
    let width = (LINE * f64::from(FINE)).round() as u32;
    Ok(canvas.draw(&PathElement::new(points.map(subpixel).collect::<Vec<_>>(), colour.stroke_width(width)))?)
}

fn disc<B: Backend>(canvas: &Canvas<B>, centre: Pixel, radius: f64, colour: RGBColor) -> DrawResult {
    Ok(canvas.draw(&Circle::new(subpixel(centre), radius * f64::from(FINE), colour.filled()))?)
}

fn subpixel((x, y): Pixel) -> (i32, i32) {
    let subpixel = |length: f64| (length * f64::from(FINE)).round() as i32;
    (subpixel(x), subpixel(y))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn scene(layer: &str, surface: &str) -> Scene {
        let text = format!("name = 'a'\n[layer]\n{layer}\n[surface]\n{surface}");
        Scene::parse(&text, Path::new("scene.toml")).unwrap()
    }

    #[test]
    fn masses_on_a_flat_profile_rest_on_it() {
        let scene = scene("masses = 3\nspacing = 1e-4\nmass = 1e-6", "kind = 'flat'");
        let picture = LayerPicture::new(&scene);
        assert_eq!(picture.masses, [(40.0, 112.0), (120.0, 112.0), (200.0, 112.0)]);
        assert_eq!(picture.profile, [116.0; SIZE.0 as usize + 1]);
    }

    #[test]
    fn heights_fill_their_space() {
        let layer = "masses = 1\nspacing = 1e-3\nclearance = 2e-6\nmass = 1e-6";
        let scene = scene(layer, "kind = 'sinusoid'\namplitude = 1e-6\nwavelength = 1e-3");
        let picture = LayerPicture::new(&scene);
        assert_eq!(picture.masses, [(120.0, HEIGHTS.0 - MASS)]);
        let lowest = picture.profile.iter().copied().fold(f64::MIN, f64::max);
        assert!((lowest - HEIGHTS.1).abs() < 1e-3, "{lowest}");
    }

    #[test]
    fn the_picture_is_a_png_and_always_the_same() {
        let scene = scene("masses = 200\nspacing = 1e-4\nmass = 1e-6", "kind = 'flat'");
        let bytes = layer_png(&scene).unwrap();
        assert_eq!(&bytes[..8], b"\x89PNG\r\n\x1a\n");
        assert_eq!(bytes, layer_png(&scene).unwrap());
    }
}
