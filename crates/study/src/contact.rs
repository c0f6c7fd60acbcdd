//! Where the rubber touches in steady sliding, and how hard.

use asperity::scene::Scene;
use clap::Args;
use serde::{Deserialize, Serialize};

use crate::Error;
use crate::decimals::rounded;
use crate::implausible::{FoundFriction, implausible};
use crate::picture::{Axis, Colour, ColourScale, Colours, Fit, Mark, Panel, Picture, Row, Shape, fitted, slides};
use crate::steady::{FlowGaps, SlideProblem, SlidingRubber, SteadySlide, SteadySolver, SurfaceGrid};
use crate::sweep::{Method, SlidingOptions, SweepMethod, check_possible};
use crate::values::{pressure, speed};

/// What stands at every point of a surface, row by row along x, and where.
#[derive(Clone, Debug)]
pub struct ContactFields {
    /// Places of the columns along x, m.
    pub x: Vec<f64>,
    /// Places of the rows along y, m; one of a profile.
    pub y: Vec<f64>,
    /// Heights about their mean, m.
    pub heights: Vec<f64>,
    /// Pressures, Pa.
    pub pressures: Vec<f64>,
    /// Gaps between rubber and surface, m.
    pub gaps: Vec<f64>,
    /// Where a fluid leaks along the sliding: 12η|q|/G of the flow per width q under the mean gradient of pressure G, m³, whose
    /// part along the sliding is the leak gap's cube in the mean; of a map, where it is asked for.
    pub leak: Option<Vec<f64>>,
}

/// Steady sliding that was solved for.
#[derive(Clone, Debug)]
pub struct SolvedContact {
    /// The surface, on the points of the solver.
    pub surface: SurfaceGrid,
    /// What the solver found.
    pub slide: SteadySlide,
    /// What stands at every point.
    pub fields: ContactFields,
    /// How a fluid passes the gaps, where it is asked for and the contact was found.
    pub flow: Option<FlowGaps>,
    /// Why not all of the values can be relied on; `None` where they can.
    pub problem: Option<SlideProblem>,
    /// A pressure that is too much for linear rubber; what of it no rubber has, and why.
    pub warnings: Vec<String>,
}

// One state of steady sliding, and how it is found. Not a doc comment: that would be the description of the command.
#[expect(missing_docs, reason = "clap would print it")]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Args)]
pub struct SteadyState {
    /// Mean pressure in Pa.
    #[arg(long, value_name = "PRESSURE", value_parser = pressure, allow_negative_numbers = true)]
    pub pressure: f64,
    /// Sliding speed in m/s.
    #[arg(long, value_name = "SPEED", value_parser = speed, allow_negative_numbers = true)]
    pub speed: f64,
}

// A state, and how it is found.
#[expect(missing_docs, reason = "clap would print it")]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Args)]
pub struct ContactOptions {
    #[command(flatten)]
    #[serde(flatten)]
    pub at: SteadyState,
    #[command(flatten)]
    #[serde(flatten)]
    pub sliding: SlidingOptions,
    /// Solves for how a fluid passes the gaps: prints leak gap and drag gap, and draws over a map where it leaks along the
    /// sliding. Of a profile both are those of the effective medium of its gaps.
    #[arg(long)]
    #[serde(default)]
    pub flow: bool,
}

/// Solves for steady sliding of a scene.
///
/// # Errors
/// Where the scene cannot be solved for, or there is no such state.
pub fn solve_contact(scene: &Scene, options: ContactOptions) -> Result<SolvedContact, Error> {
    let ContactOptions { at, sliding, flow } = options;
    check_possible("speed", "m/s", &[at.speed])?;
    check_possible("pressure", "Pa", &[at.pressure])?;
    let no_material = || Error::scene("the scene has no material or layer.width, so its contact has no pressure");
    if sliding.method == Some(SweepMethod::Layer) {
        return Err(Error::scene("`method`: expected steady, which has pressures at all points"));
    }
    // What is asked for is chosen or refused.
    let asked = SlidingOptions { method: Some(SweepMethod::Steady), ..sliding };
    let (Method::Steady(surface), _) = asked.choose(scene)? else { return Err(no_material()) };
    let rubber = SlidingRubber::new(scene).ok_or_else(no_material)?;
    let mut solver = SteadySolver::new(surface);
    let slide = solver.slide_over(&rubber, at.speed, at.pressure, sliding.way);
    let surface = solver.surface().clone();
    let (mut fields, problem) = (ContactFields::new(&surface, &slide), slide.problem());
    let flow = (flow && slide.is_found()).then(|| fields.solve_flow(&surface));
    let place = format!("at {} m/s, {} Pa", at.speed, at.pressure);
    let area = slide.real_area.unwrap_or(slide.area);
    let rise = slide.flash_mean.map(|flash| flash + slide.surface_rise.unwrap_or(0.0));
    let found = slide.friction().map(|friction| FoundFriction { place, friction, area: Some(area), rise });
    let pressed = scene.hard_pressure("`pressure`", at.pressure, false);
    let warnings = pressed.into_iter().chain(implausible(scene, found)).collect();
    Ok(SolvedContact { surface, slide, fields, flow, problem, warnings })
}

impl ContactFields {
    fn new(surface: &SurfaceGrid, slide: &SteadySlide) -> Self {
        let mut pressures = vec![0.0; surface.size.points()];
        for (&point, &pressure) in slide.contact.points.iter().zip(&slide.contact.pressures) {
            pressures[point as usize] = pressure;
        }
        let places = |length: f64, count: usize| (0..count).map(|i| length * (i as f64 / count as f64)).collect();
        Self {
            x: places(surface.length, surface.size.nx),
            y: places(surface.width, surface.size.ny),
            heights: surface.heights.clone(),
            pressures,
            gaps: slide.contact.gaps.clone(),
            leak: None,
        }
    }

    /// How a fluid passes the gaps: on a map as solved for, with where it leaks, else by the effective medium.
    fn solve_flow(&mut self, surface: &SurfaceGrid) -> FlowGaps {
        if surface.size.ny == 1 {
            return FlowGaps::of_medium(&self.gaps);
        }
        let (gaps, leak) = FlowGaps::of_map_with_leak(&self.gaps, surface.size, surface.spacing());
        self.leak = Some(leak);
        gaps
    }
}

impl SolvedContact {
    /// Along a profile the rubber's surface above it and the pressure; over a map pressure, gap, where on the heights
    /// the contact is, and where it leaks.
    pub fn picture(&self) -> Picture {
        if self.surface.size.ny > 1 { self.maps() } else { self.fields.curves() }
    }

    /// Maps side by side, or below each other where the surface is long.
    fn maps(&self) -> Picture {
        /// A surface that is so many times as long as wide is long.
        const LONG: f64 = 1.6;
        let (surface, fields) = (&self.surface, &self.fields);
        let is_long = surface.length > LONG * surface.width;
        let size = fitted([surface.length, surface.width], if is_long { [760.0, 300.0] } else { [320.0, 440.0] });
        let [x, y] = [("x", surface.length), ("y", surface.width)]
            .map(|(name, side)| Axis::linear((name, "m"), [0.0, side], Fit::Tight));
        let is_touched = |i: usize| fields.pressures[i] > 0.0;
        let map = |of: (&str, &str),
                   values: &[f64],
                   colours: Colours,
                   (name, colour): (&str, Colour),
                   is_left_out: &dyn Fn(usize) -> bool| {
            let shown = values.iter().enumerate().map(|(i, value)| Some(*value).filter(|_| !is_left_out(i))).collect();
            let heat = Shape::Heat { columns: surface.size.nx, values: shown };
            let mark = Mark::new(name, 0, heat).coloured(colour);
            let scale = ColourScale { axis: Axis::linear(of, values.iter().copied(), Fit::Tight), colours };
            let panel = Panel::new(x.clone(), y.clone(), vec![mark]).sized(size[0], size[1]);
            Panel { title: of.0.into(), scale: Some(scale), ..panel }
        };
        let contact = format!("contact, {} % of the area", rounded(100.0 * self.slide.area, 3));
        let mut panels = vec![
            map(("pressure", "Pa"), &fields.pressures, Colours::Viridis, ("no contact", Colour::GRID), &|i| {
                !is_touched(i)
            }),
            map(("gap", "m"), &fields.gaps, Colours::Blues, ("", Colour::GRID), &|_| false),
            map(("height", "m"), &fields.heights, Colours::Greys, (&contact, Colour::nth(1)), &is_touched),
        ];
        if let (Some(leak), Some(flow)) = (&fields.leak, &self.flow) {
            let mean = flow.leak.powi(3).max(f64::MIN_POSITIVE);
            let over_mean: Vec<f64> = leak.iter().map(|leak| leak / mean).collect();
            let of = ("leak over its mean", "");
            panels.push(map(of, &over_mean, Colours::Viridis, ("", Colour::nth(1)), &is_touched));
        }
        let note = slides(1.0).trim_start_matches(", ").to_owned();
        let mut rows = match is_long {
            true => panels.into_iter().map(Row::from).collect(),
            false => vec![Row { panels, ..Row::default() }],
        };
        rows.iter_mut().take(1).for_each(|row| row.note.clone_from(&note));
        Picture::of(rows)
    }
}

impl ContactFields {
    /// The profile with the rubber's surface above it, and the pressure below.
    fn curves(&self) -> Picture {
        let line = |name: &str, look: usize, values: &mut dyn Iterator<Item = f64>| {
            Mark::line(name, look, self.x.iter().copied().zip(values).map(|(x, value)| [x, value]).collect())
        };
        let mut rubber = self.heights.iter().zip(&self.gaps).map(|(height, gap)| height + gap);
        let heights = vec![line("rubber", 1, &mut rubber), line("surface", 0, &mut self.heights.iter().copied())];
        let pressure = vec![line("pressure", 1, &mut self.pressures.iter().copied())];
        let mut picture = Picture::over(("x", "m"), vec![(("height", "m"), heights), (("pressure", "Pa"), pressure)]);
        picture.rows[0].note = picture.rows[0].panels[0].exaggeration() + slides(1.0);
        picture
    }
}
