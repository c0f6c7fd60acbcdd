//! `asperity contact`: where the rubber touches in steady sliding, and how hard, as a picture and as data.

mod data;
mod picture;

use std::path::PathBuf;

use asperity::scene::Scene;
use asperity::steady::{SlidingRubber, SteadySlide, SteadySolver, SurfaceGrid};
use zip::result::ZipError;

use super::cli::Contact;
use super::files::{self, FileError, check_outputs, ends_in, load_without_excitation, named, print_beside, sources};
use super::sweep::{Asked, Method, MethodError, SweepMethod, solved_status};
use super::terminal::{lines, rounded, warn};

/// `asperity contact` failed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ContactError {
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
#[derive(Debug)]
struct Fields {
    /// Of the columns and of the rows, m.
    x: Vec<f64>,
    y: Vec<f64>,
    /// m, about their mean.
    heights: Vec<f64>,
    /// Pa.
    pressures: Vec<f64>,
    /// m.
    gaps: Vec<f64>,
}

/// Solves for steady sliding, prints what it is, and writes the picture and the data.
pub(crate) fn contact(command: &Contact) -> Result<(), ContactError> {
    let scene = load_without_excitation(&command.scene, &command.set)?;
    let outputs: Vec<_> = [&command.output].into_iter().chain(&command.data).cloned().collect();
    check_outputs(&outputs, sources(&command.scene, &scene))?;
    let asked =
        Asked { method: Some(SweepMethod::Steady), points: command.points, has_error: false, has_distance: false };
    let surface = match asked.choose(&scene)? {
        (Method::Steady(surface), _) => surface,
        // What is asked for is chosen or refused.
        (Method::Layer, _) => return Ok(()),
    };
    let rubber = SlidingRubber::new(&scene).ok_or(ContactError::NoMaterial)?;
    let mut solver = SteadySolver::new(surface);
    let slide = solver.slide(&rubber, command.at.speed, command.at.pressure);
    let surface = solver.surface();
    let fields = Fields::new(surface, &slide);
    picture::write(surface, &fields, slide.area, &command.output)?;
    if let Some(path) = &command.data {
        let bytes = if ends_in(path, "npz") {
            data::npz(&fields).map_err(|source| ContactError::Data { path: path.clone(), source })?
        } else {
            data::csv(&fields).into_bytes()
        };
        files::write(path, bytes)?;
    }
    let status = solved_status(&slide);
    if status != asperity::element::STEADY {
        warn(&status);
    }
    Ok(print_beside(&outputs, &summary(&scene, command, &slide, &fields))?)
}

impl Fields {
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

fn summary(scene: &Scene, command: &Contact, slide: &SteadySlide, fields: &Fields) -> String {
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
