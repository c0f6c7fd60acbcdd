//! The arguments of `simulate`, `plot` and `report`.

use std::path::{Path, PathBuf};

use asperity_study::benchmark::BenchmarkOptions;
use asperity_study::csv::Head;
use clap::{ArgGroup, Args};

use super::shared::Set;
use super::values::{Condition, PlotAxis, animation, arrays, count, moment, picture};
use crate::files::default_output;

#[derive(Debug, Args)]
#[command(group(ArgGroup::new("simulated").required(true).args(["scene", "patch"])))]
#[command(after_help = example!("asperity simulate scenes/tread-block/tread-block.toml -o block.csv --plot block.svg"))]
pub(crate) struct Simulate {
    /// The scene file.
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: Option<PathBuf>,
    /// A patch file: moves a contact patch along the motion instead.
    #[arg(long, value_name = "PATCH.toml", requires = "motion")]
    pub(crate) patch: Option<PathBuf>,
    /// The motion of the patch: columns time, x, y, z, roll, pitch, yaw, with a tread transport.speed, and temperature;
    /// one step from row to row.
    #[arg(long, value_name = "MOTION.csv", requires = "patch", conflicts_with = "scene")]
    pub(crate) motion: Option<PathBuf>,
    /// The result file to write; - for standard output. Default: the name of the scene or patch with .csv, in this
    /// folder.
    #[arg(short, long, value_name = "OUT.csv")]
    output: Option<PathBuf>,
    /// Number of result rows for each phase of the excitation.
    #[arg(long, value_name = "N", default_value_t = 50, value_parser = count)]
    #[arg(conflicts_with = "patch")]
    pub(crate) rows: u32,
    #[command(flatten)]
    pub(crate) set: Set,
    /// Plots forces, contacts and dissipation over time, as SVG or PNG according to the file name.
    #[arg(long, value_name = "OUT.svg", value_parser = picture())]
    pub(crate) plot: Option<PathBuf>,
    /// Animates the contact: the layer on its profile, pressure, stick and slip, flash temperature, forces. A page for
    /// a browser (.html), or a row of pictures (.png: OUT-001.png and so on).
    #[arg(long, value_name = "OUT.html", value_parser = animation(), conflicts_with = "patch")]
    pub(crate) animate: Option<PathBuf>,
    /// Draws the layer, the profile and the pressure at a time in s, as SVG or PNG; the result file has a row there
    /// too. May be repeated.
    #[arg(long, value_name = "TIME=OUT.svg", value_parser = moment(), conflicts_with = "patch")]
    pub(crate) contact: Vec<(f64, PathBuf)>,
    /// Writes position, forces, mode and flash temperature of all masses as arrays of numpy, a line for each result
    /// row, and the profile.
    #[arg(long, value_name = "OUT.npz", value_parser = arrays(), conflicts_with = "patch")]
    pub(crate) elements: Option<PathBuf>,
    /// Writes units behind the names of the result file's columns: F_x [N].
    #[arg(long)]
    units: bool,
    /// Also prints what the run cost, and what would make it cheaper.
    #[arg(long, conflicts_with = "patch")]
    pub(crate) stats: bool,
}

impl Simulate {
    /// The result file of a run of what is in the file `simulated`.
    pub(crate) fn output(&self, simulated: &Path) -> PathBuf {
        self.output.clone().unwrap_or_else(|| default_output(simulated, "csv"))
    }

    /// What is above the columns of the result file.
    pub(crate) fn head(&self) -> Head {
        if self.units { Head::NameAndUnit } else { Head::Name }
    }
}

#[derive(Debug, Args)]
#[command(after_help = example!("asperity plot block.csv --y F_x --y F_z -o forces.svg"))]
pub(crate) struct Plot {
    /// Result files, or tables of asperity sweep or converge; each gives one curve for every --y.
    #[arg(value_name = "FILE.csv", required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// The column for the horizontal axis. Units in a header are not a part of a column's name.
    #[arg(long, value_name = "COLUMN", default_value = "time")]
    pub(crate) x: String,
    /// A column for the vertical axis. May be repeated; columns of another unit have a chart of their own below.
    #[arg(long, value_name = "COLUMN", required_unless_present = "compare")]
    pub(crate) y: Vec<String>,
    /// Compares two files: draws the second less the first below the curves, and says how large that gets, and where.
    /// Rows of the second are interpolated to those of the first. Without --y all columns are compared, and that which
    /// differs most is drawn.
    #[arg(long, conflicts_with = "from_motion")]
    pub(crate) compare: bool,
    /// Draws the rows alone in which a column has this value, a number or a text: pressure=2e5, status=steady. May be
    /// repeated.
    #[arg(long = "where", value_name = "COLUMN=VALUE", value_parser = Condition::parse)]
    pub(crate) conditions: Vec<Condition>,
    /// Logarithmic axes: x, y or both.
    #[arg(long, value_name = "x,y", value_delimiter = ',')]
    pub(crate) log: Vec<PlotAxis>,
    /// Marks every row; curves of few rows are marked in any case.
    #[arg(long)]
    pub(crate) markers: bool,
    /// The plot to write, as SVG or PNG according to the file name.
    #[arg(short, long, value_name = "OUT.svg", value_parser = picture())]
    pub(crate) output: PathBuf,
    /// Names of the curves, one for each file. Default: the file names.
    #[arg(long, value_name = "A,B,...", value_delimiter = ',')]
    pub(crate) labels: Vec<String>,
    /// A title above the plot.
    #[arg(long)]
    pub(crate) title: Option<String>,
    /// Plots -y instead of y: F_x, the force on the carrier, is negative where the carrier slides towards +x.
    #[arg(long)]
    pub(crate) negate: bool,
    /// Starts each curve where x begins to change: with x = u this omits a phase that only presses.
    #[arg(long)]
    pub(crate) from_motion: bool,
}

#[derive(Debug, Args)]
#[command(after_help = example!("asperity report scenes/stiff/stiff.toml --tolerances 1e-3..1e-5 --stress 0 -o report"))]
pub(crate) struct Report {
    /// The scene files. Of several, each has its report in a folder of its name, and one table has the errors of all.
    #[arg(value_name = "SCENE.toml", required = true)]
    pub(crate) scenes: Vec<PathBuf>,
    /// The folder to write to; it is created if it does not exist.
    #[arg(short, long, value_name = "FOLDER")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) options: BenchmarkOptions,
    /// Results of other programs, in the format written by benches/peers/run.
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) peers: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) set: Set,
}
