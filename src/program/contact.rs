//! `asperity contact`: where the rubber touches in steady sliding, and how hard, as a picture and as data.

use std::fmt::Write as _;

use asperity::scene::Scene;
use asperity::steady::{SlidingRubber, SteadySlide, SteadySolver, SurfaceGrid};

use super::cli::Contact;
use super::figure::{Curve, Figure as _, LinearPanel, LinearStack, Stroke};
use super::files::{self, FileError, check_outputs, load_without_excitation, named, print_beside, sources};
use super::sweep::{Asked, Method, MethodError, SweepMethod, solved_status};
use super::terminal::{lines, rounded, warn};

/// `asperity contact` failed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ContactError {
    #[error(transparent)]
    File(#[from] FileError),
    #[error(transparent)]
    Method(#[from] MethodError),
    #[error("the scene has no material or layer.width, so its contact has no pressure")]
    NoMaterial,
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
    let slide = solver.slide(&rubber, command.speed, command.pressure);
    let surface = solver.surface();
    let pressures = pressures(surface, &slide);
    picture(surface, &slide, &pressures).write(&command.output)?;
    if let Some(path) = &command.data {
        files::write(path, data(surface, &slide, &pressures))?;
    }
    let status = solved_status(&slide);
    if status != asperity::element::STEADY {
        warn(&status);
    }
    Ok(print_beside(&outputs, &summary(&scene, command, &slide, &pressures))?)
}

/// The pressures of all points, Pa.
fn pressures(surface: &SurfaceGrid, slide: &SteadySlide) -> Vec<f64> {
    let mut pressures = vec![0.0; surface.size.points()];
    slide.contact.points.iter().zip(&slide.contact.pressures).for_each(|(&point, p)| pressures[point as usize] = *p);
    pressures
}

/// x and y of a point, m.
fn place(surface: &SurfaceGrid, point: usize) -> [f64; 2] {
    let (nx, ny) = (surface.size.nx, surface.size.ny);
    let part = |index: usize, count: usize| index as f64 / count as f64;
    [surface.length * part(point % nx, nx), surface.width * part(point / nx, ny)]
}

/// The points of the middle line along x.
fn line(surface: &SurfaceGrid) -> std::ops::Range<usize> {
    let (nx, middle) = (surface.size.nx, surface.size.ny / 2);
    middle * nx..(middle + 1) * nx
}

/// A table of all points.
fn data(surface: &SurfaceGrid, slide: &SteadySlide, pressures: &[f64]) -> String {
    let mut text = "x [m],y [m],height [m],pressure [Pa],gap [m]\n".to_owned();
    for (point, (height, (pressure, gap))) in
        surface.heights.iter().zip(pressures.iter().zip(&slide.contact.gaps)).enumerate()
    {
        let [x, y] = place(surface, point);
        // Writing to a text does not fail.
        let _ = writeln!(text, "{x:?},{y:?},{height:?},{pressure:?},{gap:?}");
    }
    text
}

/// The profile, or the middle line of a map, with the rubber's surface above it, and the pressure below.
fn picture(surface: &SurfaceGrid, slide: &SteadySlide, pressures: &[f64]) -> LinearStack {
    let curve = |name: &str, look: usize, values: &dyn Fn(usize) -> f64| Curve {
        name: name.to_owned(),
        look,
        stroke: Stroke::Line,
        points: line(surface).map(|point| (place(surface, point)[0], values(point))).collect(),
    };
    let rubber = |point: usize| surface.heights[point] + slide.contact.gaps[point];
    LinearStack {
        x: ("x", "m"),
        panels: vec![
            LinearPanel {
                quantity: "height",
                unit: "m",
                curves: vec![curve("rubber", 1, &rubber), curve("surface", 0, &|point| surface.heights[point])],
            },
            LinearPanel {
                quantity: "pressure",
                unit: "Pa",
                curves: vec![curve("pressure", 1, &|point| pressures[point])],
            },
        ],
    }
}

fn summary(scene: &Scene, command: &Contact, slide: &SteadySlide, pressures: &[f64]) -> String {
    let digits = |value: f64| rounded(value, 4);
    let largest = pressures.iter().copied().fold(0.0, f64::max);
    let mut labelled = vec![
        ("Scene", format!("{}, {} Pa at {} m/s", scene.name, command.pressure, command.speed)),
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
