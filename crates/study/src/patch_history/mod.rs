//! A run of a contact patch as a picture: its wrench over time, and its face at the moment of the largest force and at some
//! others.

mod moment;

use asperity::patch::{FaceLayout, Patch, PatchOutput, PatchRun, PatchVariable};

use crate::decimals::with_prefix;
use crate::picture::{
    Axis, Colour, ColourScale, Colours, Fill, Fit, Frame, Mark, Panel, Picture, Row, Shape, Symbol, fitted,
    rounded_down,
};
use crate::time_history::{ends_of_parts, over_time};
use moment::{Detail, Moment, Tile};

/// A run of a patch: force, moment and energy lost, collected row by row, and its face at some of the rows.
#[derive(Debug)]
pub struct PatchHistory {
    title: String,
    variables: Vec<PatchVariable>,
    times: Vec<f64>,
    rows: Vec<Vec<f64>>,
    face: FaceLayout,
    /// The indices of the rows whose faces are drawn in the strip.
    in_strip: Vec<usize>,
    strip: Vec<Moment>,
    /// The moment of the largest force so far.
    largest: Option<Moment>,
}

/// A panel of a run: the quantity, its unit, and which outputs it shows.
type RunPanel = (&'static str, &'static str, fn(&PatchOutput) -> bool);

const RUN_PANELS: [RunPanel; 3] = [
    ("force", "N", |output| matches!(output, PatchOutput::Force(_) | PatchOutput::TransportForce)),
    ("moment", "N m", |output| matches!(output, PatchOutput::Moment(_))),
    ("energy lost", "J", |output| {
        matches!(
            output,
            PatchOutput::Energy | PatchOutput::SlipEnergy | PatchOutput::ReleaseEnergy | PatchOutput::DamperEnergy
        )
    }),
];
/// Moments in the strip.
const STRIP: usize = 5;

impl PatchHistory {
    /// For a run with rows at `times` (s).
    pub fn new(patch: &Patch, times: &[f64]) -> Self {
        let mut variables = patch.all_variables();
        variables.retain(|variable| RUN_PANELS.iter().any(|(_, _, shows)| shows(&variable.output)));
        Self {
            title: patch.name().to_owned(),
            variables,
            times: Vec::new(),
            rows: Vec::new(),
            face: patch.layout(),
            in_strip: ends_of_parts(times, STRIP),
            strip: Vec::new(),
            largest: None,
        }
    }

    /// Adds the present row of the run.
    pub fn add(&mut self, run: &mut PatchRun) {
        let mut values = vec![0.0; self.variables.len()];
        run.evaluate(&self.variables, &mut values);
        let (force, [large, small]) = (force(&self.variables, &values), details(&self.face));
        if self.largest.as_ref().is_none_or(|largest| force > largest.force) {
            self.largest = Some(Moment::new(run, &self.face, large, force));
        }
        if self.in_strip.contains(&self.rows.len()) {
            self.strip.push(Moment::new(run, &self.face, small, force));
        }
        self.times.push(run.time());
        self.rows.push(values);
    }

    /// The wrench over time, and below it the face: large when the force is largest, and in a strip.
    pub fn picture(&self) -> Picture {
        let panel = |&(quantity, unit, shows): &RunPanel| {
            let shown = self.variables.iter().enumerate().filter(|(_, variable)| shows(&variable.output));
            let shown = shown.map(|(i, variable)| (i, variable.name.as_str()));
            over_time((quantity, unit), &self.times, &self.rows, shown)
        };
        let panels = RUN_PANELS.iter().map(panel).map(Row::from);
        let faces = self.largest.iter().flat_map(|largest| self.faces(largest));
        Picture::of(panels.chain(faces).collect()).titled(&self.title)
    }

    fn faces(&self, largest: &Moment) -> [Row; 2] {
        let faces = Faces::new(&self.face, self.strip.iter().chain([largest]));
        let [time, force, pressure] = [(largest.time, "s"), (largest.force, "N"), (largest.pressure, "Pa")]
            .map(|(value, unit)| with_prefix(value, value, unit));
        let note = format!("At {time}, when the force is largest, {force}: pressure up to {pressure}");
        let last = self.strip.last().map_or(0.0, |last| last.time);
        let small = |moment: &Moment| {
            let [time, force] = [with_prefix(moment.time, last, "s"), with_prefix(moment.force, largest.force, "N")];
            Panel { title: format!("{time}, {force}"), frame: Frame::Line, ..faces.panel(moment, SMALL) }
        };
        let strip = Row { panels: self.strip.iter().map(small).collect(), ..Row::default() };
        [Row { note, ..faces.panel(largest, LARGE).into() }, strip]
    }
}

/// The absolute value of the force, N.
fn force(variables: &[PatchVariable], values: &[f64]) -> f64 {
    let parts = variables.iter().zip(values).filter(|(variable, _)| matches!(variable.output, PatchOutput::Force(_)));
    parts.map(|(_, force)| force * force).sum::<f64>().sqrt()
}

/// Most pixels along and across the face, in the large map and in one of the strip.
const LARGE: [f64; 2] = [620.0, 420.0];
const SMALL: [f64; 2] = [172.0, 240.0];
/// Most tiles along each axis of these.
const TILES: [usize; 2] = [60, 30];
/// The distance of arrows and the length of the longest, pixels; shorter ones than this share of it are left out.
const ARROW: f64 = 30.0;
const MIN_ARROW: f64 = 0.08;
/// The least radius of a point.
const MIN_RADIUS: f64 = 2.5;

/// The size of a face's map, pixels.
fn size(face: &FaceLayout, within: [f64; 2]) -> [f64; 2] {
    fitted(face.extents.map(|(low, high)| high - low), within)
}

/// What the large map and one of the strip can show.
fn details(face: &FaceLayout) -> [Detail; 2] {
    [(TILES[0], LARGE), (TILES[1], SMALL)].map(|(tiles, within)| {
        let pixels = size(face, within);
        let distance = |axis: usize| ARROW * (face.extents[axis].1 - face.extents[axis].0) / pixels[axis];
        Detail { tiles, arrows: [distance(0), distance(1)] }
    })
}

/// How all moments of a face are drawn: with the same colours, and the same length of arrows.
#[derive(Debug)]
struct Faces<'a> {
    face: &'a FaceLayout,
    scale: ColourScale,
    /// The largest of the arrows, Pa.
    traction: f64,
}

impl<'a> Faces<'a> {
    fn new<'m>(face: &'a FaceLayout, moments: impl Iterator<Item = &'m Moment>) -> Self {
        let (mut pressure, mut traction) = (0.0_f64, 0.0_f64);
        for moment in moments {
            pressure = moment.tiles.iter().map(|tile| tile.pressure).fold(pressure, f64::max);
            traction = moment.arrows.iter().map(length).fold(traction, f64::max);
        }
        let axis = Axis::linear(("pressure", "Pa"), [0.0, pressure], Fit::Tight);
        Self { face, scale: ColourScale { axis, colours: Colours::Viridis }, traction }
    }

    /// Both axes have the same scale, unless one side is far longer than the other.
    fn panel(&self, moment: &Moment, within: [f64; 2]) -> Panel {
        let [x, y] = [0, 1].map(|axis| {
            let (low, high) = self.face.extents[axis];
            Axis::linear((self.face.axes[axis], "m"), [low, high], Fit::Tight)
        });
        let pixels = size(self.face, within);
        // Pixels of a metre.
        let per_metre = [pixels[0] / (x.high - x.low), pixels[1] / (y.high - y.low)];
        let tiles = [false, true].into_iter().flat_map(|are_free| tiles(moment, per_metre, are_free));
        let arrows = [false, true].map(|sticks| self.arrows(moment, per_metre, sticks));
        let panel = Panel::new(x, y, tiles.chain(arrows).collect());
        Panel { scale: Some(self.scale.clone()), ..panel }.sized(pixels[0], pixels[1])
    }

    /// The tractions that slip or stick, each arrow with its middle at its place.
    fn arrows(&self, moment: &Moment, per_metre: [f64; 2], sticks: bool) -> Mark {
        let arrow = |tile: &Tile| {
            let half = 0.5 * ARROW * length(tile) / self.traction;
            let [x, y] = [0, 1].map(|axis| half * tile.traction[axis] / length(tile) / per_metre[axis]);
            [tile.place[0] - x, tile.place[1] - y, tile.place[0] + x, tile.place[1] + y]
        };
        let seen = |tile: &&Tile| tile.sticks == sticks && length(tile) > MIN_ARROW * self.traction;
        let unit = rounded_down(self.traction);
        let name = format!("traction of {}, {}", with_prefix(unit, unit, "Pa"), if sticks { "stick" } else { "slip" });
        let arrows = moment.arrows.iter().filter(seen).map(arrow).collect();
        let name = if self.traction > 0.0 { name } else { String::new() };
        let mark = Mark::new(name, 0, Shape::Arrows { arrows, key: ARROW * unit / self.traction });
        mark.coloured(if sticks { Colour::WHITE } else { Colour::INK })
    }
}

/// The tiles in contact, coloured by pressure, or those that are free; single points as discs of their areas.
fn tiles(moment: &Moment, per_metre: [f64; 2], are_free: bool) -> Vec<Mark> {
    let tiles: Vec<&Tile> = moment.tiles.iter().filter(|tile| (tile.pressure <= 0.0) == are_free).collect();
    let values = |tiles: &[&Tile]| if are_free { Vec::new() } else { tiles.iter().map(|tile| tile.pressure).collect() };
    let disc = |tile: &&Tile| {
        let radius = (tile.area * per_metre[0] * per_metre[1] / std::f64::consts::PI).sqrt().max(MIN_RADIUS);
        let (points, values) = (vec![tile.place], values(&[tile]));
        Shape::Points { points, symbol: Symbol::Disc, fill: Fill::Full, radius, labels: Vec::new(), values }
    };
    let of_points = tiles.iter().filter(|_| moment.are_points).map(disc);
    let in_boxes: Vec<&Tile> = tiles.iter().copied().filter(|_| !moment.are_points).collect();
    let boxes = in_boxes.iter().map(|tile| [tile.low[0], tile.low[1], tile.high[0], tile.high[1]]).collect();
    let boxes = Shape::Boxes { boxes, values: values(&in_boxes) };
    let boxes = Mark::new(if are_free { "free" } else { "" }, 0, boxes).coloured(Colour::GRID);
    of_points.map(|shape| Mark::new("", 0, shape).coloured(Colour::GRID)).chain([boxes]).collect()
}

/// Of a traction, Pa.
fn length(tile: &Tile) -> f64 {
    tile.traction[0].hypot(tile.traction[1])
}
