//! `asperity contact`: where the rubber touches in steady sliding, and how hard, as a picture and as data.

mod data;

use asperity::scene::Scene;
use asperity_study::Error;
use asperity_study::contact::{ContactFields, SolvedContact, solve_contact};
use asperity_study::steady::SteadySlide;

use super::cli::Contact;
use super::files::{self, check_outputs, ends_in, load_without_run, named, print_beside};
use super::picture;
use super::terminal::{lines, warn};
use asperity_study::decimals::rounded;

/// Solves for steady sliding, prints what it is, and writes the picture and the data.
pub(crate) fn contact(command: &Contact) -> Result<(), Error> {
    let scene = load_without_run(&command.scene, &command.set, |_| false)?;
    let outputs: Vec<_> = [&command.output].into_iter().chain(&command.write).cloned().collect();
    check_outputs(&outputs, scene.sources(&command.scene))?;
    let solved = solve_contact(&scene, command.at, command.sliding)?;
    let SolvedContact { slide, fields, problem, warnings, .. } = &solved;
    picture::write(&solved.picture(), &command.output)?;
    if let Some(path) = &command.write {
        let bytes = if ends_in(path, "npz") {
            data::npz(fields).map_err(|error| Error::value(format!("cannot write {}: {error}", path.display())))?
        } else {
            data::csv(fields).into_bytes()
        };
        files::write(path, bytes)?;
    }
    problem.iter().map(ToString::to_string).chain(warnings.iter().cloned()).for_each(|text| warn(&text));
    print_beside(&outputs, &summary(&scene, command, slide, fields))
}

fn summary(scene: &Scene, command: &Contact, slide: &SteadySlide, fields: &ContactFields) -> String {
    let digits = |value: f64| rounded(value, 4);
    let largest = fields.pressures.iter().copied().fold(0.0, f64::max);
    let mut labelled = vec![
        ("Scene", format!("{}, {} Pa at {} m/s", scene.name, command.at.pressure, command.at.speed)),
        ("Contact", format!("{} of the area, pressure up to {} Pa", digits(slide.area), digits(largest))),
        ("Separation", format!("{} m between the mean planes", digits(slide.contact.separation))),
        ("Friction", friction_line(slide)),
    ];
    if let (Some(rise), Some(way)) = (slide.surface_rise, command.sliding.way) {
        labelled.push(("Surface", format!("{} K warmer than the rubber was {way} m before", digits(rise))));
    }
    if let Some(flash) = slide.flash_mean {
        labelled.push(("Flash", format!("{} K above the mean of the surface", digits(flash))));
    }
    let names: Vec<String> = [&command.output].into_iter().chain(&command.write).map(|path| named(path)).collect();
    labelled.push(("Written", names.join(", ")));
    lines(&labelled)
}

fn friction_line(slide: &SteadySlide) -> String {
    let profile = rounded(slide.profile_hysteresis, 4);
    match slide.friction() {
        Some(friction) => format!("{}, of it {profile} by the slopes of the surface", rounded(friction, 4)),
        None if !slide.is_found() => "none, as the contact was not found".to_owned(),
        None => format!("none, as it jams; {profile} by the slopes of the surface"),
    }
}
