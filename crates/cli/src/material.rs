//! `asperity material`: the complex modulus of a scene's compound over frequency, at its temperature; in the direct
//! form, the complex stiffness of its links.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use asperity::scene::Scene;
use asperity_study::Error;
use asperity_study::decimals;
use asperity_study::material::{MaterialOptions, POINTS, Response, Responses, evenly};
use clap::Args;

use super::cli::values::{Set, example, picture_or_table};
use super::files::{self, check_outputs, ends_in, is_standard_output, load_without_run, named, print_beside};
use super::picture;
use super::terminal::{LabelledLine, lines};

#[derive(Debug, Args)]
#[command(after_help = example!("asperity material scenes/road/road.toml --temperature 40°C -o moduli.svg"))]
pub(crate) struct Material {
    /// The scene file.
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: PathBuf,
    /// A file to write: a table as CSV, or a plot as SVG or PNG, according to its name; - for a table on standard
    /// output. May be repeated. Default: a plot SCENE-material.svg.
    #[arg(short, long, value_name = "OUT", value_parser = picture_or_table())]
    pub(crate) output: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) options: MaterialOptions,
    #[command(flatten)]
    pub(crate) set: Set,
}

/// Prints a summary and a table; writes the outputs or, if none is given, a plot.
pub(crate) fn material(command: &Material) -> Result<(), Error> {
    let scene = load_without_run(&command.scene, &command.set, |_| false)?;
    let outputs = if command.output.is_empty() { vec![default_output(&command.scene)] } else { command.output.clone() };
    check_outputs(&outputs, scene.sources(&command.scene))?;
    let responses = Responses::new(scene, &command.options)?;
    for output in &outputs {
        if ends_in(output, "csv") || is_standard_output(output) {
            files::write(output, responses.table().text())?;
        } else {
            picture::write(&responses.picture(&evenly(responses.band, POINTS)).titled(title(&responses)), output)?;
        }
    }
    let names: Vec<String> = outputs.iter().map(|output| named(output)).collect();
    let written = lines(&[("Written", names.join(", "))]);
    print_beside(&outputs, &(summary(&responses) + &written))
}

/// In the working directory, named after the scene file.
fn default_output(scene: &Path) -> PathBuf {
    let stem = scene.file_stem().unwrap_or(scene.as_os_str()).to_string_lossy();
    PathBuf::from(format!("{stem}-material.svg"))
}

/// The summary and a table of some rows.
fn summary(responses: &Responses) -> String {
    let scene = &responses.scene;
    let kind = if responses.is_material() { "Material" } else { "Link" };
    let mut rows: Vec<LabelledLine> = vec![("Scene", scene.name.clone())];
    rows.extend(responses.temperature().map(|text| ("Temperature", text)));
    rows.extend(responses.responses.iter().map(|response| (kind, figures(responses, response))));
    rows.extend(heat(scene).map(|text| ("Heat", text)));
    rows.extend(files::table_lines(scene));
    format!("{}\n{}\n", lines(&rows), table(responses))
}

/// How it takes up the heat of friction.
fn heat(scene: &Scene) -> Option<String> {
    let material = scene.material.as_ref()?;
    let heat = material.heat?;
    let diffusivity = heat.conductivity / (material.density * heat.capacity);
    Some(format!(
        "conductivity {} W/(m K), capacity {} J/(kg K), diffusivity {} m²/s; takes {} of the power of friction",
        short(heat.conductivity),
        short(heat.capacity),
        short(diffusivity),
        short(heat.share)
    ))
}

/// A response in a line.
fn figures(responses: &Responses, response: &Response) -> String {
    let (symbol, unit) = responses.symbol_and_unit();
    let name = if response.name.is_empty() { String::new() } else { format!("{:<12}", response.name) };
    let glassy = if response.damper() > 0.0 {
        "unbounded because of the damper".into()
    } else {
        format!("{} {unit}", short(response.glassy()))
    };
    let loss = response.maximum_loss(responses.band).map_or_else(
        || "no loss".into(),
        |(omega, tangent)| {
            let is_end = omega == responses.band.0 || omega * (1.0 + 1e-9) >= responses.band.1;
            let end = if is_end { ", the end of the range" } else { "" };
            format!("tan δ at most {} at {} rad/s ({} Hz){end}", short(tangent), short(omega), short(omega / TAU))
        },
    );
    format!("{name}equilibrium {symbol} {} {unit}, glassy {symbol} {glassy}, {loss}", short(response.equilibrium()))
}

/// A table of some rows.
fn table(responses: &Responses) -> String {
    let points = match (responses.band.1 / responses.band.0).log10() {
        decades if decades > 8.0 => 1.0,
        decades if decades > 3.0 => 2.0,
        _ => 5.0,
    };
    let names: Vec<String> = responses.columns().into_iter().map(|column| column.name).collect();
    let widths: Vec<usize> = names.iter().map(|name| name.chars().count().max(11) + 2).collect();
    let line = |fields: Vec<String>| {
        let fields = fields.iter().zip(&widths).map(|(field, width)| format!("{field:<width$}"));
        fields.collect::<String>().trim_end().to_owned() + "\n"
    };
    let rows = evenly(responses.band, points)
        .into_iter()
        .map(|omega| line(responses.row(omega).map(|value| format!("{value:.3e}")).collect()));
    std::iter::once(line(names.clone())).chain(rows).collect()
}

/// The title of the picture.
fn title(responses: &Responses) -> String {
    let scene = &responses.scene;
    let wlf = scene.material.as_ref().and_then(|material| material.wlf);
    let temperature = wlf.map_or_else(String::new, |wlf| format!(" at {} K", short(wlf.temperature)));
    format!("{}: {}{temperature}", scene.name, responses.quantity())
}

/// Five digits.
fn short(value: f64) -> String {
    decimals::short(value, 5)
}
