//! model.png: of a layer the first masses at rest between the carrier and the profile, of an element its friction
//! coefficients. Both are pictures without text, their axes in pixels from the lower left corner.

use asperity::element::{FrictionTable, Node, Quantity};
use asperity::math::Spline;
use asperity::scene::{LinkKind, Scene};

use crate::picture::{Axis, Colour, Fill, Fit, Frame, Mark, Panel, Picture, Point, Shape, Stroke, Symbol};

/// Width and height, pixels.
pub(super) const WIDTH: f64 = 240.0;
pub(super) const HEIGHT: f64 = 160.0;
/// Width of a line, pixels.
const LINE: f64 = 1.4;

/// Most masses drawn: few enough to be told apart.
const MASSES: usize = 10;
/// The carrier's lower edge.
const CARRIER: f64 = 138.0;
/// Heights of the lowest and of the highest point of profile and masses.
const HEIGHTS: [f64; 2] = [20.0, 68.0];
/// Radius of a mass, pixels.
const MASS: f64 = 4.0;
/// Half the width of a spring, pixels.
const WINDING: f64 = 3.5;
const CORNERS: usize = 9;

const STEEL: Colour = Colour([70, 70, 70]);
const SURFACE: Colour = Colour([196, 188, 176]);
const EDGE: Colour = Colour([110, 100, 88]);
const RUBBER: Colour = Colour([0, 114, 178]);
const LINK: Colour = Colour([86, 160, 210]);

fn icon(marks: Vec<Mark>) -> Picture {
    let [x, y] = [WIDTH, HEIGHT].map(|side| Axis::linear(("", ""), [0.0, side], Fit::Tight));
    let panel = Panel { frame: Frame::None, ..Panel::new(x, y, marks) }.sized(WIDTH, HEIGHT);
    Picture::of(vec![panel.into()])
}

fn line(points: Vec<Point>, colour: Colour) -> Mark {
    Mark::new("", 0, Shape::Line { points, stroke: Stroke::Solid, width: LINE }).coloured(colour)
}

fn area(outline: Vec<Point>, colour: Colour) -> Mark {
    Mark::area("", 0, outline, 1.0).coloured(colour)
}

fn discs(points: Vec<Point>, radius: f64, colour: Colour) -> Mark {
    Mark::new("", 0, Shape::points(points, Symbol::Disc, Fill::Full, radius)).coloured(colour)
}

/// That of a layer.
pub fn layer_icon(scene: &Scene) -> Picture {
    let Layer { profile, masses } = Layer::new(scene);
    let has = |kinds: [LinkKind; 2]| kinds.into_iter().any(|kind| scene.link(kind).is_some());
    let mut marks = vec![
        area(profile.iter().copied().chain([[WIDTH, 0.0], [0.0, 0.0]]).collect(), SURFACE),
        line(profile, EDGE),
        area(vec![[0.0, HEIGHT], [WIDTH, HEIGHT], [WIDTH, CARRIER], [0.0, CARRIER]], STEEL),
    ];
    if has([LinkKind::LateralX, LinkKind::LateralZ]) {
        marks.push(line(masses.clone(), LINK));
    }
    if has([LinkKind::Vertical, LinkKind::Horizontal]) {
        marks.extend(masses.iter().map(|&mass| line(spring(mass), LINK)));
    }
    marks.push(discs(masses, MASS, RUBBER));
    icon(marks)
}

/// A layer at rest, in pixels.
struct Layer {
    /// At each column of pixels, and at the right edge.
    profile: Vec<Point>,
    /// The masses' centres: a mass touches with its lowest point.
    masses: Vec<Point>,
}

impl Layer {
    fn new(scene: &Scene) -> Self {
        let layer = &scene.layer;
        let masses = layer.masses.min(MASSES);
        let pitch = layer.spacing * masses as f64 / WIDTH;
        let left = layer.origin - layer.spacing / 2.0;
        let rest: Vec<f64> = (0..masses).map(|i| layer.clearance + layer.roughness.get(i).unwrap_or(&0.0)).collect();
        let profile = heights(scene.surface.spline(), left, pitch);
        let up = upwards(rest.iter().chain(&profile));
        let column = |i: usize| (i as f64 + 0.5) * WIDTH / masses as f64;
        let masses = rest.iter().enumerate().map(|(i, z)| [column(i), up(*z) + MASS]).collect();
        Self { masses, profile: profile.iter().enumerate().map(|(i, z)| [i as f64, up(*z)]).collect() }
    }
}

/// The profile's heights at the columns of pixels, m.
fn heights(profile: &Spline, left: f64, pitch: f64) -> Vec<f64> {
    (0..=WIDTH as usize).map(|i| profile.evaluate(left + pitch * i as f64).0).collect()
}

/// The map from a height (m) to pixels, so that `heights` fill their space; a flat scene lies in the middle.
fn upwards<'a>(heights: impl Iterator<Item = &'a f64> + Clone) -> impl Fn(f64) -> f64 {
    let highest = heights.clone().copied().fold(f64::MIN, f64::max);
    let lowest = heights.copied().fold(f64::MAX, f64::min);
    let [bottom, top] = HEIGHTS;
    move |z| {
        if highest > lowest {
            bottom + (z - lowest) / (highest - lowest) * (top - bottom)
        } else {
            (top + bottom) / 2.0
        }
    }
}

/// A spring from the carrier down to a mass.
fn spring([x, end]: Point) -> Vec<Point> {
    let corner = |i: usize| {
        let sideways = if i == 0 || i == CORNERS { 0.0 } else { WINDING * [1.0, -1.0][i % 2] };
        [x + sideways, CARRIER + (end - CARRIER) * i as f64 / CORNERS as f64]
    };
    (0..=CORNERS).map(corner).collect()
}

/// Between the edges of an element's picture and its axes, pixels.
const MARGIN: f64 = 14.0;
/// Radius of a point of the table, pixels.
const POINT: f64 = 2.0;
/// Colours of the lowest and the highest pressure.
const PRESSURES: [Colour; 2] = [Colour([86, 160, 210]), Colour([0, 60, 100])];

/// That of an element: friction coefficients over the logarithm of speed, a line for each pressure; of several
/// temperatures, at the middle one.
pub fn element_icon(table: &FrictionTable) -> Picture {
    let corners = vec![[MARGIN, HEIGHT - MARGIN], [MARGIN, MARGIN], [WIDTH - MARGIN, MARGIN]];
    let count = table.grid.loads.len();
    let of_pressure = |i: usize| {
        let colour = PRESSURES[0].towards(PRESSURES[1], i as f64 / (count.max(2) - 1) as f64);
        [line(points(table, i), colour), discs(points(table, i), POINT, colour)]
    };
    icon([line(corners, STEEL)].into_iter().chain((0..count).flat_map(of_pressure)).collect())
}

/// The points of a pressure, in pixels.
fn points(table: &FrictionTable, pressure: usize) -> Vec<Point> {
    let (speeds, temperature) = (table.grid.speeds.len(), table.grid.temperatures.len() / 2);
    let friction = |load, speed| table.value(Quantity::Friction, Node { temperature, load, speed });
    let all = (0..table.grid.loads.len()).flat_map(|i| (0..speeds).map(move |j| friction(i, j)));
    let largest = all.fold(f64::MIN_POSITIVE, f64::max);
    let point = |j: usize| {
        let share = if speeds > 1 { j as f64 / (speeds - 1) as f64 } else { 0.5 };
        let x = MARGIN + POINT + share * (WIDTH - 2.0 * (MARGIN + POINT));
        [x, MARGIN + friction(pressure, j) / largest * (HEIGHT - 2.0 * MARGIN)]
    };
    (0..speeds).map(point).collect()
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
        let Layer { profile, masses } = Layer::new(&scene);
        assert_eq!(masses, [[40.0, 48.0], [120.0, 48.0], [200.0, 48.0]]);
        assert!(profile.len() == 241 && profile.iter().all(|point| point[1] == 44.0));
    }

    #[test]
    fn heights_fill_their_space() {
        let layer = "masses = 1\nspacing = 1e-3\nclearance = 2e-6\nmass = 1e-6";
        let scene = scene(layer, "kind = 'sinusoid'\namplitude = 1e-6\nwavelength = 1e-3");
        let Layer { profile, masses } = Layer::new(&scene);
        assert_eq!(masses, [[120.0, HEIGHTS[1] + MASS]]);
        let lowest = profile.iter().map(|point| point[1]).fold(f64::MAX, f64::min);
        assert!((lowest - HEIGHTS[0]).abs() < 1e-3, "{lowest}");
    }
}
