//! The command line.

mod surface;

use std::f64::consts::TAU;
use std::ffi::OsString;
use std::path::PathBuf;

use asperity::scene::Wlf;
use clap::{Args, Parser, Subcommand};
pub(crate) use surface::{Reading, Surface};

use super::sweep::{Shard, Values};

/// Simulates rubber on a rough surface and packs the simulation as an FMU.
#[derive(Debug, Parser)]
#[command(version, about)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Runs a scene along its excitation and writes a result file.
    Simulate(Simulate),
    /// Draws columns of result files.
    Plot(Plot),
    /// Prints what is in a scene and what is left out.
    Describe(Describe),
    /// Packs a scene, or an element from a sweep's table, as an FMI 2.0 co-simulation FMU.
    Pack(Pack),
    /// Finds the Prony terms of a compound from its measured moduli.
    Fit(Fit),
    /// Draws the moduli of a scene's compound over frequency, or the stiffnesses of its links.
    Material(Material),
    /// Measures how right and how quick a scene's runs are: tables, pictures and a page.
    Report(Report),
    /// Prints heights, slopes and Hurst exponent of a measured profile or a scene's surface, and draws its spectrum.
    Surface(Surface),
    /// Finds the friction coefficient over speed, pressure and temperature: a table and a picture.
    Sweep(Sweep),
}

#[derive(Debug, Args)]
pub(crate) struct Simulate {
    /// The scene file.
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: PathBuf,
    /// The result file to write.
    #[arg(short, long, value_name = "OUT.csv")]
    pub(crate) output: PathBuf,
    /// Rows per phase of the excitation.
    #[arg(long, value_name = "N", default_value_t = 50, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) points: u32,
    /// Overrides a parameter by its name, such as solver.relative_tolerance=1e-9.
    #[arg(long, value_name = "KEY=VALUE", value_parser = key_and_value)]
    pub(crate) set: Vec<(String, String)>,
    /// Draws forces, contacts and dissipation over time.
    #[arg(long, value_name = "OUT.svg")]
    pub(crate) plot: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct Plot {
    /// The result files, one line each for every y.
    #[arg(value_name = "FILE.csv", required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// The column along the horizontal axis.
    #[arg(long, value_name = "COLUMN", default_value = "time")]
    pub(crate) x: String,
    /// A column to draw; may be given several times.
    #[arg(long, value_name = "COLUMN", required = true)]
    pub(crate) y: Vec<String>,
    /// The picture to write.
    #[arg(short, long, value_name = "OUT.svg")]
    pub(crate) output: PathBuf,
    /// Names of the lines, one for each file; default: the files' names.
    #[arg(long, value_name = "A,B,...", value_delimiter = ',')]
    pub(crate) labels: Vec<String>,
    /// A line above the picture.
    #[arg(long)]
    pub(crate) title: Option<String>,
    /// Draws -y for y: F_x, the force on the carrier, is negative where the carrier slides towards +x.
    #[arg(long)]
    pub(crate) negate: bool,
    /// Starts each line where x begins to change: leaves out a phase that only presses when x is u.
    #[arg(long)]
    pub(crate) from_motion: bool,
}

#[derive(Debug, Args)]
pub(crate) struct Describe {
    /// The scene file.
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: PathBuf,
    /// Prints the whole scene as one JSON object, in SI units: links as constants, the profile as its data points; what
    /// is left out is null or empty.
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct Pack {
    /// The scene file.
    #[arg(value_name = "SCENE.toml", required_unless_present = "table", conflicts_with = "table")]
    pub(crate) scene: Option<PathBuf>,
    /// A sweep's table: packs a point-contact element, which looks the forces up instead of simulating the layer.
    #[arg(long, value_name = "TABLE.csv")]
    pub(crate) table: Option<PathBuf>,
    /// The scene that was swept: compares the element with its layer between the table's points and along a motion to
    /// and fro, and writes tables and pictures of it to a folder beside the FMU.
    #[arg(long, value_name = "SCENE.toml", requires = "table")]
    pub(crate) check: Option<PathBuf>,
    /// Points that --check compares at most.
    #[arg(long, value_name = "N", default_value_t = 12, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) points: u32,
    /// The FMU to write.
    #[arg(short, long, value_name = "OUT.fmu")]
    pub(crate) output: PathBuf,
    /// A shared library, of this platform unless another is named, as in win64=PATH; may be given several times.
    /// Default: the one beside this program.
    #[arg(long, value_name = "[PLATFORM=]PATH")]
    pub(crate) library: Vec<OsString>,
}

#[derive(Debug, Args)]
pub(crate) struct Fit {
    /// The measured moduli: columns of frequency, E', E'' or tan delta, and temperature if it changes, with their units
    /// in a header line; parted by comma, semicolon or tab.
    #[arg(value_name = "DMA.csv")]
    pub(crate) data: PathBuf,
    /// The Prony terms to write, as a scene reads them.
    #[arg(short, long, value_name = "OUT.csv")]
    pub(crate) output: PathBuf,
    /// The error that the terms may have: the root mean square of the relative errors of E' and E'' at all points.
    #[arg(long, value_name = "E", default_value_t = 0.02, value_parser = fit_error)]
    pub(crate) error: f64,
    /// The constants by Williams, Landel and Ferry that shift rows of other temperatures to TREF: C1 (1), C2 (K), TREF
    /// (K).
    #[arg(long, value_name = "C1,C2,TREF", value_parser = WlfConstants::parse)]
    pub(crate) wlf: Option<WlfConstants>,
    /// Allows a Kelvin-Voigt viscosity beside the terms.
    #[arg(long)]
    pub(crate) viscosity: bool,
    /// Leaves out a column, named by its header as it is written; may be given several times.
    #[arg(long, value_name = "COLUMN")]
    pub(crate) ignore: Vec<String>,
    /// The picture of data and fit, as SVG or PNG by its name; default: beside the output, as SVG.
    #[arg(long, value_name = "OUT.svg")]
    pub(crate) plot: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct Material {
    /// The scene file.
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: PathBuf,
    /// A file to write: a table as CSV, a picture as SVG or PNG, by its name; may be given several times. Default: a
    /// picture SCENE-material.svg.
    #[arg(short, long, value_name = "OUT")]
    pub(crate) output: Vec<PathBuf>,
    /// The range of the angular frequency, rad/s, or of the frequency with Hz behind it; default: by the relaxation
    /// times.
    #[arg(long, value_name = "A..B[Hz]", value_parser = Frequencies::parse)]
    pub(crate) frequencies: Option<Frequencies>,
    /// The compound's temperature, K, instead of the scene's.
    #[arg(long, value_name = "T")]
    pub(crate) temperature: Option<f64>,
    /// Overrides a parameter by its name, such as material.poisson_ratio=0.48.
    #[arg(long, value_name = "KEY=VALUE", value_parser = key_and_value)]
    pub(crate) set: Vec<(String, String)>,
}

/// A range of angular frequencies, rad/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Frequencies(pub(crate) (f64, f64));

impl Frequencies {
    fn parse(text: &str) -> Result<Self, String> {
        let (numbers, unit) = text.trim().strip_suffix("Hz").map_or((text, 1.0), |numbers| (numbers, TAU));
        let number = |text: &str| text.trim().trim_end_matches("Hz").trim_end().parse::<f64>().ok();
        let ends = numbers.split_once("..").and_then(|(low, high)| Some((number(low)?, number(high)?)));
        let possible = |(low, high): &(f64, f64)| *low >= 1e-30 && high > low && *high <= 1e30;
        let message =
            || "expected A..B, such as 1..1e5 in rad/s or 0.1..1e4Hz, from 1e-30 to 1e30, A below B".to_owned();
        ends.filter(possible).map(|(low, high)| Self((low * unit, high * unit))).ok_or_else(message)
    }
}

/// Constants of the shift with temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WlfConstants {
    /// C_1, 1.
    pub(crate) c1: f64,
    /// C_2, K.
    pub(crate) c2: f64,
    /// T_ref, K.
    pub(crate) reference_temperature: f64,
}

impl WlfConstants {
    /// The shift at `temperature` (K).
    pub(crate) fn at(&self, temperature: f64) -> Wlf {
        let Self { c1, c2, reference_temperature } = *self;
        Wlf { c1, c2, reference_temperature, temperature }
    }

    fn parse(text: &str) -> Result<Self, String> {
        let numbers: Vec<f64> = text.split(',').filter_map(|number| number.trim().parse().ok()).collect();
        match numbers[..] {
            [c1, c2, reference_temperature]
                if text.split(',').count() == 3 && numbers.iter().all(|number| *number > 0.0 && number.is_finite()) =>
            {
                Ok(Self { c1, c2, reference_temperature })
            }
            _ => {
                Err("expected C1,C2,TREF, three numbers above 0, such as 7.52,119.75,293.15 (C2 and TREF in K)".into())
            }
        }
    }
}

fn fit_error(text: &str) -> Result<f64, String> {
    let number = text.trim().parse().ok().filter(|error| (1e-12..=0.5).contains(error));
    number.ok_or_else(|| "expected a number from 1e-12 to 0.5, such as 0.02 for 2 %".into())
}

#[derive(Debug, Args)]
pub(crate) struct Report {
    /// The scene file.
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: PathBuf,
    /// The folder to write to; it is made if need be.
    #[arg(short, long, value_name = "FOLDER")]
    pub(crate) output: PathBuf,
    /// Relative tolerances to run at, each a tenth of the one before.
    #[arg(long, value_name = "LOOSEST..TIGHTEST", default_value = "1e-2..1e-10", value_parser = Tolerances::parse)]
    pub(crate) tolerances: Tolerances,
    /// Rows per phase of the excitation at which runs are compared.
    #[arg(long, value_name = "N", default_value_t = 50, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) points: u32,
    /// How often each run is timed: the median counts.
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) repeat: u32,
    /// Powers of ten by which the scene is stressed each way, one quantity by one and in pairs; 0: not at all.
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u32).range(..=12))]
    pub(crate) stress: u32,
    /// About how long the stressed pairs may take, s: the cheap ones come first.
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, value_parser = seconds)]
    pub(crate) stress_time: f64,
    /// Lines of other programs, as benches/peers/run writes them.
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) peers: Option<PathBuf>,
    /// Overrides a parameter by its name, such as friction.coulomb=0.5.
    #[arg(long, value_name = "KEY=VALUE", value_parser = key_and_value)]
    pub(crate) set: Vec<(String, String)>,
}

#[derive(Debug, Args)]
pub(crate) struct Sweep {
    /// The scene file; its excitation and outputs do not matter.
    #[arg(value_name = "SCENE.toml", required_unless_present = "merge", conflicts_with = "merge")]
    pub(crate) scene: Option<PathBuf>,
    /// Speeds, m/s: a..b/n for n values evenly in the logarithm, a list, or both joined by commas.
    #[arg(long, value_name = "VALUES", value_parser = Values::in_logarithm, required_unless_present = "merge")]
    pub(crate) speeds: Option<Values>,
    /// Mean pressures, Pa, given as the speeds are; in the material form.
    #[arg(long, value_name = "VALUES", value_parser = Values::in_logarithm, conflicts_with = "forces")]
    pub(crate) pressures: Option<Values>,
    /// Mean F_z of the whole layer, N, in place of pressures; in either form.
    #[arg(long, value_name = "VALUES", value_parser = Values::in_logarithm)]
    pub(crate) forces: Option<Values>,
    /// Temperatures, K: a..b/n for n values evenly; default: the scene's own.
    #[arg(long, value_name = "VALUES", value_parser = Values::in_value)]
    pub(crate) temperatures: Option<Values>,
    /// The table to write, and to go on with where it is there; default: the scene's file name with .sweep.csv.
    #[arg(short, long, value_name = "TABLE.csv")]
    pub(crate) output: Option<PathBuf>,
    /// The picture to draw, SVG or PNG by its name; default: the table's name with .svg.
    #[arg(long, value_name = "OUT.svg")]
    pub(crate) plot: Option<PathBuf>,
    /// The standard error that the friction coefficient may have, as a share of it.
    #[arg(long, value_name = "SHARE", default_value_t = 5e-3, value_parser = share)]
    pub(crate) error: f64,
    /// How far a point may be slid until its means are steady, m; default: 100 blocks, periods of the profile or
    /// lengths of the layer.
    #[arg(long, value_name = "METRES", value_parser = positive)]
    pub(crate) distance: Option<f64>,
    /// Does one share of the points alone, I from 1 to N.
    #[arg(long, value_name = "I/N", value_parser = Shard::parse)]
    pub(crate) shard: Option<Shard>,
    /// Joins tables, of shards, into one.
    #[arg(long, value_name = "TABLE.csv", num_args = 1.., requires = "output")]
    pub(crate) merge: Vec<PathBuf>,
    /// Replaces the table that is there.
    #[arg(long)]
    pub(crate) force: bool,
    /// Overrides a parameter by its name, such as friction.coulomb=0.5.
    #[arg(long, value_name = "KEY=VALUE", value_parser = key_and_value)]
    pub(crate) set: Vec<(String, String)>,
}

fn share(text: &str) -> Result<f64, String> {
    let number = text.trim().parse().ok().filter(|share| *share > 0.0 && *share <= 1.0);
    number.ok_or_else(|| "expected a share above 0, up to 1, such as 5e-3".into())
}

fn positive(text: &str) -> Result<f64, String> {
    let number = text.trim().parse().ok().filter(|length: &f64| *length > 0.0 && length.is_finite());
    number.ok_or_else(|| "expected a positive number".into())
}

/// Relative tolerances from loose to tight, at least one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tolerances(pub(crate) Vec<f64>);

impl Tolerances {
    /// The loosest that a scene may have.
    const LOOSEST: f64 = 0.1;
    /// Tighter ones are lost in rounding.
    const TIGHTEST: f64 = 1e-14;

    fn parse(text: &str) -> Result<Self, String> {
        let number = |text: &str| text.trim().parse::<f64>().ok();
        let ends = text.split_once("..").and_then(|(loosest, tightest)| Some((number(loosest)?, number(tightest)?)));
        let inside = |(loosest, tightest): &(f64, f64)| {
            *loosest <= Self::LOOSEST && tightest <= loosest && *tightest >= Self::TIGHTEST
        };
        let Some((loosest, tightest)) = ends.filter(inside) else {
            return Err("expected LOOSEST..TIGHTEST, such as 1e-2..1e-10, from at most 0.1 to at least 1e-14".into());
        };
        let ladder = std::iter::successors(Some(loosest), |&tolerance| Some(tenth(tolerance)));
        /// What rounding may leave of a rung.
        const ROUNDING: f64 = 1e-9;
        Ok(Self(ladder.take_while(|&tolerance| tolerance >= tightest * (1.0 - ROUNDING)).collect()))
    }
}

/// A tenth, rounded as it is written: of 1e-10, 1e-11.
pub(crate) fn tenth(number: f64) -> f64 {
    let written = format!("{number:e}");
    let parts = written.split_once('e').and_then(|(digits, power)| Some((digits, power.parse::<i32>().ok()?)));
    parts.and_then(|(digits, power)| format!("{digits}e{}", power - 1).parse().ok()).unwrap_or(number / 10.0)
}

fn seconds(text: &str) -> Result<f64, String> {
    let number = text.trim().parse().ok().filter(|seconds| (0.0..).contains(seconds));
    number.ok_or_else(|| "expected a number of seconds, 0 or more".into())
}

fn key_and_value(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() => Ok((key.trim().into(), value.trim().into())),
        _ => Err("expected KEY=VALUE, such as solver.relative_tolerance=1e-9".into()),
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_command_line_is_well_formed() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn tolerances_are_tenths_as_they_are_written() {
        let ladder = Tolerances::parse("1e-2..1e-10").unwrap().0;
        assert_eq!(ladder, [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10]);
        assert_eq!(Tolerances::parse("0.05..1e-3").unwrap().0, [0.05, 0.005]);
        assert_eq!(Tolerances::parse("1e-3..1e-3").unwrap().0, [1e-3]);
        for wrong in ["1e-3", "1e-10..1e-2", "1..1e-2", "1e-2..0", "1e-2..NaN", "a..b"] {
            assert!(Tolerances::parse(wrong).unwrap_err().contains("1e-2..1e-10"), "{wrong}");
        }
    }

    #[test]
    fn frequencies_are_angular_unless_in_hertz() {
        assert_eq!(Frequencies::parse("1..1e5"), Ok(Frequencies((1.0, 1e5))));
        for hertz in ["0.5..10Hz", "0.5Hz..10 Hz"] {
            assert_eq!(Frequencies::parse(hertz), Ok(Frequencies((0.5 * TAU, 10.0 * TAU))), "{hertz}");
        }
        for wrong in ["1", "2..1", "0..1", "1..inf", "a..b"] {
            assert!(Frequencies::parse(wrong).unwrap_err().contains("1..1e5"), "{wrong}");
        }
    }

    #[test]
    fn wlf_takes_three_positive_numbers() {
        let constants = WlfConstants::parse("7.52, 119.75,293.15").unwrap();
        assert_eq!((constants.c1, constants.c2, constants.reference_temperature), (7.52, 119.75, 293.15));
        for wrong in ["7.52,119.75", "7.52,x,119.75,293.15", "-1,100,300", "1,2,3,4", ""] {
            assert!(WlfConstants::parse(wrong).unwrap_err().contains("C1,C2,TREF"), "{wrong}");
        }
    }

    #[test]
    fn a_parameter_is_split_at_the_first_equals_sign() {
        assert_eq!(key_and_value("a.b = 1=2"), Ok(("a.b".into(), "1=2".into())));
        assert!(key_and_value("a.b").is_err());
        assert!(key_and_value("=1").is_err());
    }
}
