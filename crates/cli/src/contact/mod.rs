//! `asperity contact`: where the rubber touches in steady sliding, and how hard, as a picture and as data.

mod data;
mod picture;

use std::path::PathBuf;

use asperity::element::STEADY;
use asperity::scene::Scene;
use asperity_study::steady::{SlidingRubber, SteadySlide, SteadySolver, SurfaceGrid};
use zip::result::ZipError;

use super::cli::{Contact, SteadyState};
use super::files::{self, FileError, check_outputs, ends_in, load_without_run, named, print_beside};
use super::sweep::{Method, MethodError, SlidingOptions, SweepMethod, solved_status};
use super::terminal::{lines, warn};
use asperity_study::decimals::rounded;

/// `asperity contact` failed.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say what they are")]
pub enum ContactError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Method(#[from] MethodError),
    #[error("cannot write {}: {source}", .path.display())]
    Data { path: PathBuf, source: ZipError },
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
    /// [`STEADY`], or why the values cannot be relied on.
    pub status: String,
}

/// One state of steady sliding, and on how many points it is solved for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactOptions {
    /// Mean pressure, Pa.
    pub pressure: f64,
    /// Sliding speed, m/s.
    pub speed: f64,
    /// Points of a period along x; `None`: as [`SlidingOptions::points`].
    pub points: Option<u32>,
}

/// Solves for steady sliding of a scene.
///
/// # Errors
/// Where the scene cannot be solved for.
pub fn solve_contact(scene: &Scene, options: &ContactOptions) -> Result<SolvedContact, ContactError> {
    let sliding =
        SlidingOptions { method: Some(SweepMethod::Steady), points: options.points, ..SlidingOptions::default() };
    // What is asked for is chosen or refused.
    let (Method::Steady(surface), _) = sliding.choose(scene)? else { return Err(ContactError::NoMaterial) };
    let rubber = SlidingRubber::new(scene).ok_or(ContactError::NoMaterial)?;
    let mut solver = SteadySolver::new(surface);
    let slide = solver.slide(&rubber, options.speed, options.pressure);
    let surface = solver.surface().clone();
    let (fields, status) = (ContactFields::new(&surface, &slide), solved_status(&slide));
    Ok(SolvedContact { surface, slide, fields, status })
}

/// Solves for steady sliding, prints what it is, and writes the picture and the data.
pub(crate) fn contact(command: &Contact) -> Result<(), ContactError> {
    let scene = load_without_run(&command.scene, &command.set, |_| false)?;
    let outputs: Vec<_> = [&command.output].into_iter().chain(&command.data).cloned().collect();
    check_outputs(&outputs, scene.sources(&command.scene))?;
    let SteadyState { pressure, speed } = command.at;
    let solved = solve_contact(&scene, &ContactOptions { pressure, speed, points: command.points })?;
    let SolvedContact { surface, slide, fields, status } = &solved;
    picture::write(surface, fields, slide.area, &command.output)?;
    if let Some(path) = &command.data {
        let bytes = if ends_in(path, "npz") {
            data::npz(fields).map_err(|source| ContactError::Data { path: path.clone(), source })?
        } else {
            data::csv(fields).into_bytes()
        };
        files::write(path, bytes)?;
    }
    if status != STEADY {
        warn(status);
    }
    Ok(print_beside(&outputs, &summary(&scene, command, slide, fields))?)
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

fn summary(scene: &Scene, command: &Contact, slide: &SteadySlide, fields: &ContactFields) -> String {
    let digits = |value: f64| rounded(value, 4);
    let largest = fields.pressures.iter().copied().fold(0.0, f64::max);
    let mut labelled = vec![
        ("Scene", format!("{}, {} Pa at {} m/s", scene.name, command.at.pressure, command.at.speed)),
        ("Contact", format!("{} of the area, pressure up to {} Pa", digits(slide.area), digits(largest))),
        ("Separation", format!("{} m between the mean planes", digits(slide.contact.separation))),
        (
            "Friction",
            format!("{}, of it {} by the slopes of the surface", digits(slide.friction()), {
                digits(slide.profile_hysteresis)
            }),
        ),
    ];
    if let Some(flash) = slide.flash_mean {
        labelled.push(("Flash", format!("{} K above the mean of the surface", digits(flash))));
    }
    let names: Vec<String> = [&command.output].into_iter().chain(&command.data).map(|path| named(path)).collect();
    labelled.push(("Written", names.join(", ")));
    lines(&labelled)
}
