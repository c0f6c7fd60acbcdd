//! model.png: the first masses of the layer at rest between the carrier and the profile, drawn from the scene.

mod curves;
mod sketch;

use std::error::Error;

use asperity::math::Spline;
use asperity::scene::{LinkKind, Scene};
use plotters::style::RGBColor;

use crate::program::plot::Drawn;
pub(super) use curves::element_png;
use sketch::{Point, SIZE, Sketch};

/// Pixels: width, height.
const WIDTH: f64 = SIZE.0 as f64;
const HEIGHT: f64 = SIZE.1 as f64;
/// Masses drawn at most: so few that each is seen.
const MASSES: usize = 10;
/// The carrier's lower edge, pixels from the top.
const CARRIER: f64 = 22.0;
/// Where heights are drawn, pixels from the top: of the highest point and of the lowest.
const HEIGHTS: (f64, f64) = (92.0, 140.0);
/// Radius of a mass, pixels.
const MASS: f64 = 4.0;
/// Half the width of a spring's windings, pixels.
const WINDING: f64 = 3.5;
/// Corners of a spring.
const CORNERS: usize = 9;

const STEEL: RGBColor = RGBColor(70, 70, 70);
const GROUND: RGBColor = RGBColor(196, 188, 176);
const EDGE: RGBColor = RGBColor(110, 100, 88);
const RUBBER: RGBColor = RGBColor(0, 114, 178);
const LINK: RGBColor = RGBColor(86, 160, 210);

/// The picture as a PNG file.
pub(super) fn png(scene: &Scene) -> Result<Vec<u8>, Box<dyn Error>> {
    let view = View::new(scene);
    Sketch::png(|sketch| {
        view.draw_ground(sketch)?;
        sketch.fill([(0.0, 0.0), (WIDTH, 0.0), (WIDTH, CARRIER), (0.0, CARRIER)].into_iter(), STEEL)?;
        view.draw_links(sketch)?;
        view.masses.iter().try_for_each(|&centre| sketch.disc(centre, MASS, RUBBER))
    })
}

/// What is drawn, in pixels.
struct View<'a> {
    scene: &'a Scene,
    /// The profile's height at each column of pixels, and at the picture's right edge.
    ground: Vec<f64>,
    /// The masses' centres: a mass touches with its lowest point.
    masses: Vec<Point>,
}

impl<'a> View<'a> {
    fn new(scene: &'a Scene) -> Self {
        let layer = &scene.layer;
        let masses = layer.masses.min(MASSES);
        let pitch = layer.spacing * masses as f64 / WIDTH;
        let left = layer.origin - layer.spacing / 2.0;
        let rest: Vec<f64> = (0..masses).map(|i| layer.clearance + layer.roughness.get(i).unwrap_or(&0.0)).collect();
        let ground = heights(&scene.surface.spline(), left, pitch);
        let row = rows(rest.iter().chain(&ground));
        let column = |i: usize| (i as f64 + 0.5) * WIDTH / masses as f64;
        let centre = |(i, z): (usize, &f64)| (column(i), row(*z) - MASS);
        let masses = rest.iter().enumerate().map(centre).collect();
        Self { scene, masses, ground: ground.iter().map(|z| row(*z)).collect() }
    }

    fn draw_ground(&self, sketch: &Sketch<'_, '_>) -> Drawn {
        let edge = || self.ground.iter().enumerate().map(|(i, &y)| (i as f64, y));
        sketch.fill(edge().chain([(WIDTH, HEIGHT), (0.0, HEIGHT)]), GROUND)?;
        sketch.line(edge(), EDGE)
    }

    fn draw_links(&self, sketch: &Sketch<'_, '_>) -> Drawn {
        let has = |kinds: [LinkKind; 2]| kinds.into_iter().any(|kind| self.scene.link(kind).is_some());
        if has([LinkKind::LateralX, LinkKind::LateralZ]) {
            sketch.line(self.masses.iter().copied(), LINK)?;
        }
        if has([LinkKind::Vertical, LinkKind::Horizontal]) {
            self.masses.iter().try_for_each(|&mass| sketch.line(spring(mass), LINK))?;
        }
        Ok(())
    }
}

/// The profile's heights at the columns of pixels, m.
fn heights(profile: &Spline, left: f64, pitch: f64) -> Vec<f64> {
    (0..=SIZE.0).map(|i| profile.evaluate(left + pitch * i as f64).0).collect()
}

/// Where a height is drawn, so that all of `heights` (m) fit in; a flat scene lies in the middle.
fn rows<'a>(heights: impl Iterator<Item = &'a f64> + Clone) -> impl Fn(f64) -> f64 {
    let highest = heights.clone().copied().fold(f64::MIN, f64::max);
    let lowest = heights.copied().fold(f64::MAX, f64::min);
    let (top, bottom) = HEIGHTS;
    move |z| {
        if highest > lowest { top + (highest - z) / (highest - lowest) * (bottom - top) } else { (top + bottom) / 2.0 }
    }
}

/// A spring from the carrier down to a mass.
fn spring((x, end): Point) -> impl Iterator<Item = Point> {
    (0..=CORNERS).map(move |i| {
        let sideways = if i == 0 || i == CORNERS { 0.0 } else { WINDING * [1.0, -1.0][i % 2] };
        (x + sideways, CARRIER + (end - CARRIER) * i as f64 / CORNERS as f64)
    })
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
        let view = View::new(&scene);
        assert_eq!(view.masses, [(40.0, 112.0), (120.0, 112.0), (200.0, 112.0)]);
        assert_eq!(view.ground, [116.0; SIZE.0 as usize + 1]);
    }

    #[test]
    fn heights_fill_the_room_there_is() {
        let layer = "masses = 1\nspacing = 1e-3\nclearance = 2e-6\nmass = 1e-6";
        let scene = scene(layer, "kind = 'sinusoid'\namplitude = 1e-6\nwavelength = 1e-3");
        let view = View::new(&scene);
        assert_eq!(view.masses, [(120.0, HEIGHTS.0 - MASS)]);
        let lowest = view.ground.iter().copied().fold(f64::MIN, f64::max);
        assert!((lowest - HEIGHTS.1).abs() < 1e-3, "{lowest}");
    }

    #[test]
    fn the_picture_is_a_png_and_always_the_same() {
        let scene = scene("masses = 200\nspacing = 1e-4\nmass = 1e-6", "kind = 'flat'");
        let bytes = png(&scene).unwrap();
        assert_eq!(&bytes[..8], b"\x89PNG\r\n\x1a\n");
        assert_eq!(bytes, png(&scene).unwrap());
    }
}
