//! `asperity contact`: where the rubber touches in steady sliding, and how hard, as a picture and as data.

use std::borrow::Cow;
use std::fmt::Write as _;
use std::path::PathBuf;

use asperity::scene::Scene;
use asperity_study::Error;
use asperity_study::contact::{ContactFields, ContactOptions, SolvedContact, solve_contact};
use asperity_study::decimals::rounded;
use asperity_study::steady::{FlowGaps, SteadySlide};
use clap::Args;
use zip::result::ZipResult;

use super::cli::values::{self, Set, example, table_or_arrays};
use super::files::{self, check_outputs, ends_in, load_without_run, named, print_beside};
use super::npz::{self, Array, Values};
use super::picture;
use super::terminal::{lines, warn};

#[derive(Debug, Args)]
#[command(
    override_usage = "asperity contact [OPTIONS] --pressure <PRESSURE> --speed <SPEED>\n       --output <OUT.png> <SCENE.toml>"
)]
#[command(after_help = example!("asperity contact scenes/two-maxima/two-maxima.toml --pressure 2bar --speed 0.1 -o contact.png"))]
pub(crate) struct Contact {
    /// The scene file, in the material form with a foundation "half_space" or "layer" and a periodic surface; its excitation
    /// and outputs are not used.
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: PathBuf,
    #[command(flatten)]
    pub(crate) options: ContactOptions,
    /// The picture to write, as SVG or PNG according to the file name: along a profile heights and pressure; of a map
    /// pressure, gap, where it is touched and, with --flow, where it leaks.
    #[arg(short, long, value_name = "OUT.png", value_parser = values::picture())]
    pub(crate) output: PathBuf,
    /// All points to write: x, y, height, pressure, gap and, of a map with --flow, leak, as a table or, with .npz, as arrays of numpy with a row for each y.
    #[arg(long, value_name = "OUT.csv|.npz", value_parser = table_or_arrays())]
    pub(crate) write: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) set: Set,
}

/// Solves for steady sliding, prints what it is, and writes the picture and the data.
pub(crate) fn contact(command: &Contact) -> Result<(), Error> {
    let scene = load_without_run(&command.scene, &command.set, |_| false)?;
    let outputs: Vec<_> = [&command.output].into_iter().chain(&command.write).cloned().collect();
    check_outputs(&outputs, scene.sources(&command.scene))?;
    let solved = solve_contact(&scene, command.options)?;
    let SolvedContact { fields, problem, warnings, .. } = &solved;
    picture::write(&solved.picture(), &command.output)?;
    if let Some(path) = &command.write {
        let bytes = if ends_in(path, "npz") {
            arrays(fields).map_err(|error| Error::value(format!("cannot write {}: {error}", path.display())))?
        } else {
            csv(fields).into_bytes()
        };
        files::write(path, bytes)?;
    }
    problem.iter().map(ToString::to_string).chain(warnings.iter().cloned()).for_each(|text| warn(&text));
    print_beside(&outputs, &summary(&scene, command, &solved))
}

fn summary(scene: &Scene, command: &Contact, solved: &SolvedContact) -> String {
    let ContactOptions { at, sliding, .. } = command.options;
    let SolvedContact { slide, fields, flow, .. } = solved;
    let digits = |value: f64| rounded(value, 4);
    let largest = fields.pressures.iter().copied().fold(0.0, f64::max);
    let mut labelled = vec![
        ("Scene", format!("{}, {} Pa at {} m/s", scene.name, at.pressure, at.speed)),
        ("Contact", format!("{} of the area, pressure up to {} Pa", digits(slide.area), digits(largest))),
        ("Separation", format!("{} m between the mean planes", digits(slide.contact.separation))),
        ("Friction", friction_line(slide)),
    ];
    if let (Some(rise), Some(way)) = (slide.surface_rise, sliding.way) {
        labelled.push(("Surface", format!("{} K warmer than the rubber was {way} m before", digits(rise))));
    }
    if let Some(flash) = slide.flash_mean {
        labelled.push(("Flash", format!("{} K above the mean of the surface", digits(flash))));
    }
    if let Some(flow) = flow {
        labelled.push(("Flow", flow_line(flow)));
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

/// Of a profile there is nothing to draw: its ridges close every way along the sliding, or none.
fn flow_line(flow: &FlowGaps) -> String {
    let [leak, drag] = [flow.leak, flow.drag].map(|gap| rounded(gap, 4));
    match flow.leak_across.map(|gap| rounded(gap, 4)) {
        Some(across) => format!("leak gap {leak} m, across the sliding {across} m, drag gap {drag} m"),
        None => format!(
            "leak gap {leak} m, drag gap {drag} m, by the effective medium of a profile's gaps, of which no flow is drawn"
        ),
    }
}

/// The fields by their names and units, a value for each point.
fn named_fields(fields: &ContactFields) -> Vec<(&'static str, &'static str, &[f64])> {
    let all = [("height", "m", &fields.heights[..]), ("pressure", "Pa", &fields.pressures), ("gap", "m", &fields.gaps)];
    all.into_iter().chain(fields.leak.as_ref().map(|leak| ("leak", "m^3", &leak[..]))).collect()
}

/// A table with a line for each point.
fn csv(fields: &ContactFields) -> String {
    let named = named_fields(fields);
    let mut text = "x [m],y [m]".to_owned();
    // Writing to a text does not fail.
    named.iter().for_each(|(name, unit, _)| _ = write!(text, ",{name} [{unit}]"));
    let places = fields.y.iter().flat_map(|y| fields.x.iter().map(move |x| (x, y)));
    for (i, (x, y)) in places.enumerate() {
        let _ = write!(text, "\n{x:?},{y:?}");
        named.iter().for_each(|(.., values)| _ = write!(text, ",{:?}", values[i]));
    }
    text + "\n"
}

/// The arrays x and y, and the fields with a row for each y, as `numpy.load` reads them.
fn arrays(fields: &ContactFields) -> ZipResult<Vec<u8>> {
    let shape = vec![fields.y.len(), fields.x.len()];
    let field = |(name, _, values)| Array { name, shape: shape.clone(), values: Values::Reals(Cow::Borrowed(values)) };
    let places = [Array::line("x", &fields.x), Array::line("y", &fields.y)];
    npz::npz(places.into_iter().chain(named_fields(fields).into_iter().map(field)))
}
