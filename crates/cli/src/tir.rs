//! `asperity tir`: a tyre property file for another road, temperature or compound.

use std::path::PathBuf;

use asperity_study::Error;
use asperity_study::tyre::ScaledTyre;
use asperity_study::values::stiffness;
use clap::Args;

use super::cli::values::example;
use super::files::{self, check_outputs, name_of, named, print_beside};
use super::terminal::{labelled, lines, note};

#[derive(Debug, Args)]
#[command(override_usage = "asperity tir [OPTIONS] --from <A.csv> --to <B.csv>\n       --output <OUT.tir> <BASE.tir>")]
#[command(after_help = example!("asperity tir scenes/slip/tread.tir --from dry.csv --to wet.csv -o wet.tir"))]
pub(crate) struct Tir {
    /// The property file to scale, of the Magic Formula (MF 5.2, MF 6.1, PAC2002).
    #[arg(value_name = "BASE.tir")]
    base: PathBuf,
    /// The table of asperity slip for the road, temperature and compound of the property file, at one speed and temperature,
    /// with loads about its FNOMIN.
    #[arg(long, value_name = "A.csv")]
    from: PathBuf,
    /// The table for those that it is scaled to.
    #[arg(long, value_name = "B.csv")]
    to: PathBuf,
    /// What the carcass yields within the contact, element by element as the tread does and in series with it, in N/m over
    /// the whole contact: along x, and along y if that is another, as in 3e5,2e5. Default: the tread alone.
    #[arg(long, value_name = "N/M[,N/M]", value_delimiter = ',', num_args = 1..=2, value_parser = stiffness)]
    carcass: Vec<f64>,
    /// The property file to write: as the base but for LMUX, LMUY, LKX, LKY and a comment; - for standard output.
    #[arg(short, long, value_name = "OUT.tir")]
    output: PathBuf,
}

/// Scales the file and says what was scaled.
pub(crate) fn tir(command: &Tir) -> Result<(), Error> {
    let Tir { base, from, to, carcass, output } = command;
    check_outputs([output], vec![base.clone(), from.clone(), to.clone()])?;
    let scaled = ScaledTyre::new(base, from, to, carcass)?;
    scaled.notes.iter().for_each(|text| note(text));
    files::write(output, scaled.bytes()?)?;
    let mut rows = vec![("Scaled", scaled.conditions.clone())];
    rows.extend(labelled("Numbers", scaled.scalings.iter().map(ToString::to_string)));
    rows.push(("Base", name_of(base)));
    rows.push(("Written", named(output)));
    print_beside([output], &lines(&rows))
}
