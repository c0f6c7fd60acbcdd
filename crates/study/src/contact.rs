//! Where the rubber touches in steady sliding, and how hard.

use asperity::scene::Scene;

use crate::implausible::{FoundFriction, implausible};
use crate::steady::{SlideProblem, SlidingRubber, SteadySlide, SteadySolver, SurfaceGrid};
use crate::sweep::{Method, MethodError, NotPossible, SlidingOptions, SweepMethod};

/// The contact of a scene cannot be solved for.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are")]
pub enum ContactError {
    #[error(transparent)]
    Method(#[from] MethodError),
    #[error(transparent)]
    Range(#[from] NotPossible),
    #[error("the scene has no material or layer.width, so its contact has no pressure")]
    NoMaterial,
}

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
    /// Why not all of the values can be relied on; `None` where they can.
    pub problem: Option<SlideProblem>,
    /// What of it no rubber has, and why.
    pub warnings: Vec<String>,
}

/// One state of steady sliding, and on how many points it is solved for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactOptions {
    /// Mean pressure, Pa.
    pub pressure: f64,
    /// Sliding speed, m/s.
    pub speed: f64,
    /// The way that rubber as warm as the scene has slid, m; `None`: its surface is as warm.
    pub way: Option<f64>,
    /// Points of a period along x; `None`: as [`SlidingOptions::points`].
    pub points: Option<u32>,
}

/// Solves for steady sliding of a scene.
///
/// # Errors
/// Where the scene cannot be solved for, or there is no such state.
pub fn solve_contact(scene: &Scene, options: &ContactOptions) -> Result<SolvedContact, ContactError> {
    NotPossible::check("speed", "m/s", &[options.speed])?;
    NotPossible::check("pressure", "Pa", &[options.pressure])?;
    let sliding = SlidingOptions {
        method: Some(SweepMethod::Steady),
        way: options.way,
        points: options.points,
        ..SlidingOptions::default()
    };
    // What is asked for is chosen or refused.
    let (Method::Steady(surface), _) = sliding.choose(scene)? else { return Err(ContactError::NoMaterial) };
    let rubber = SlidingRubber::new(scene).ok_or(ContactError::NoMaterial)?;
    let mut solver = SteadySolver::new(surface);
    let slide = solver.slide_over(&rubber, options.speed, options.pressure, options.way);
    let surface = solver.surface().clone();
    let (fields, problem) = (ContactFields::new(&surface, &slide), slide.problem());
    let place = format!("at {} m/s, {} Pa", options.speed, options.pressure);
    let area = slide.real_area.unwrap_or(slide.area);
    let rise = slide.flash_mean.map(|flash| flash + slide.surface_rise.unwrap_or(0.0));
    let found = slide.friction().map(|friction| FoundFriction { place, friction, area: Some(area), rise });
    let warnings = implausible(scene, found);
    Ok(SolvedContact { surface, slide, fields, problem, warnings })
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
        }
    }
}
