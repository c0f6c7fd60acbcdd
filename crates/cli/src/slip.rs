//! `asperity slip`: forces of a patch over slip and slip angle, and tyre models fitted to them.

use std::path::PathBuf;

use asperity::tables::Dimension;
use asperity_study::Error;
use asperity_study::progress::Stop;
use asperity_study::tyre::{Fit, MagicFormula, SlipCurves, SlipOptions};
use asperity_study::values::above_zero;
use clap::Args;

use super::cli::values::{self, Set, example};
use super::files::{check_outputs, default_output, load_patch, named, picture_beside, print_beside, write};
use super::friction_fit::fit_friction;
use super::picture;
use super::terminal::{self, lines, warn};

#[derive(Debug, Args)]
#[command(
    override_usage = "asperity slip [OPTIONS] --loads <VALUES>\n       <--slips <VALUES>|--angles <VALUES>> <PATCH.toml>\n       \
                    asperity slip --fit <stribeck|lugre> [-o <TABLE.csv>] <TABLE.csv>"
)]
#[command(after_help = example!(
    "asperity slip scenes/slip/asphalt.toml --loads 2000,4000,6000 --slips -0.3..0.3/41 \\\n\
    \x20     --angles -12deg..12deg/25 --fit mf -o slip.csv"
))]
pub(crate) struct Slip {
    /// The patch file, with transport = true; for --fit stribeck and lugre a table of friction.
    #[arg(value_name = "PATCH.toml")]
    pub(crate) patch: PathBuf,
    #[command(flatten)]
    pub(crate) options: SlipOptions,
    /// Fits a model to the table; its numbers go beside it, into the table's name with .mf.csv.
    #[arg(long, value_name = "MODEL", value_enum)]
    pub(crate) fit: Option<Fit>,
    /// The load FNOMIN of the coefficients of --fit mf, in N or with its unit. Default: the middle one of --loads.
    #[arg(long, value_name = "LOAD", value_parser = force, requires = "fit")]
    pub(crate) nominal: Option<f64>,
    /// The table to write, - for standard output. Default: the patch's file name with .slip.csv.
    #[arg(short, long, value_name = "TABLE.csv")]
    pub(crate) output: Option<PathBuf>,
    /// The picture to write, as SVG or PNG according to the file name. Default: the table's name with .svg.
    #[arg(long, value_name = "OUT.svg", value_parser = values::picture())]
    pub(crate) plot: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) set: Set,
}

fn force(text: &str) -> Result<f64, String> {
    above_zero(text, Dimension::Force).ok_or_else(|| "expected a force above 0, such as 4000 (in N) or 4kN".into())
}

/// Rolls the tread, fits a model, writes tables and picture; or fits a law of friction.
pub(crate) fn slip(command: &Slip) -> Result<(), Error> {
    if let Some(law) = command.fit.and_then(Fit::friction_law) {
        if command.options != SlipOptions::default() || command.plot.is_some() || !command.set.is_empty() {
            return Err(Error::value("`fit` stribeck and lugre: expected a table and -o, and no other option"));
        }
        return fit_friction(&command.patch, law, command.output.as_deref());
    }
    let patch = load_patch(&command.patch, &command.set)?;
    let output = command.output.clone().unwrap_or_else(|| default_output(&command.patch, "slip.csv"));
    let picture = picture_beside(&output, command.plot.as_ref());
    let fit = command.fit.map(|_| output.with_extension("mf.csv"));
    check_outputs([&output].into_iter().chain(&fit).chain(&picture), patch.sources(&command.patch))?;
    let bar = terminal::bar(command.options.parts(&patch) as u64);
    let found = SlipCurves::new(&patch, &command.options, (&Stop::default(), &|| bar.inc(1)));
    bar.finish_and_clear();
    let found = found?;
    found.warnings(&patch).iter().for_each(|warning| warn(warning));
    write(&output, found.table().text())?;
    let formula = fit.as_ref().map(|_| MagicFormula::new(&found, command.nominal)).transpose()?;
    if let (Some(path), Some(formula)) = (&fit, &formula) {
        write(path, formula.table().text())?;
    }
    picture.as_ref().map_or(Ok(()), |path| picture::write(&found.picture(formula.as_ref()), path))?;
    let files: Vec<String> = [&output].into_iter().chain(&fit).chain(&picture).map(|path| named(path)).collect();
    let mut said = vec![("Points", found.points.len().to_string())];
    said.extend(formula.iter().flat_map(MagicFormula::lines));
    said.push(("Written", files.join(", ")));
    print_beside([&output], &lines(&said))?;
    found.failures().map_or(Ok(()), |(failed, problem)| {
        Err(Error::run(format!("{failed} of {} points have no result: {problem}", found.points.len())))
    })
}
