//! The command line: the arguments of every command. [`values`] parses and checks single values.

pub(crate) mod sweep_values;
mod values;

use std::ffi::OsString;
use std::ops::{Deref, RangeInclusive};
use std::path::{Path, PathBuf};

use asperity::scene::{Depth, LengthUnit, Missing, ProfileOptions, ThirdColumn, Tilt};
use asperity_study::calibration::FreeParameter;
use asperity_study::fit::WlfConstants;
use clap::{ArgGroup, Args, Parser, Subcommand};

use super::files::default_output;
use asperity_study::csv::Head;
use asperity_study::settings::Setting;
use asperity_study::sweep::SweepMethod;
use sweep_values::{Shard, Values};
pub(crate) use values::{Condition, FitVertical, FitWeight, PlotAxis};
use values::{
    Frequencies, Tolerances, animation, arrays, column_unit, count, expansion, fit_error, free_parameter, frequency,
    key_and_value, length, moment, picture, picture_or_table, poisson_ratio, powers, pressure, seconds, seeds, share,
    speed, sweep_method, table_or_arrays, temperature, wavelengths, wlf_constants,
};

/// Simulates rubber on a rough surface and packs the simulation as an FMU.
#[derive(Debug, Parser)]
#[command(name = "asperity", version)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
    /// Prints results and warnings alone, neither notes nor progress.
    #[arg(short, long, global = true)]
    pub(crate) quiet: bool,
    /// Prints every note where only some or their number would be printed.
    #[arg(short, long, global = true, conflicts_with = "quiet")]
    pub(crate) verbose: bool,
}

#[derive(Debug, Subcommand)]
#[command(defer = true)]
pub(crate) enum Command {
    /// Simulates a scene along its excitation and writes a result file.
    Simulate(Simulate),
    /// Plots columns of result files and tables.
    Plot(Plot),
    /// Summarises a scene: what it contains, what it leaves out, and the constants derived from it.
    Describe(Describe),
    /// Packs a scene, or a point-contact element or a contact patch from a sweep table, as an FMI 2.0 co-simulation
    /// FMU.
    Pack(Pack),
    /// Fits Prony terms to measured moduli of a compound (DMA data).
    Fit(Fit),
    /// Plots the complex modulus of a scene's compound over frequency, or the complex stiffness of its links.
    Material(Material),
    /// Benchmarks a scene: accuracy, run time and robustness, as tables, plots and an HTML page.
    Report(Report),
    /// Analyses a measured profile or a scene's surface: heights, slopes, spectrum and Hurst exponent.
    Surface(Surface),
    /// Computes the friction coefficient over speed, pressure and temperature, as a table and a plot.
    Sweep(Sweep),
    /// Tests whether friction and contact area depend on a scene's spacing, length and seed. Exit status 0: all within
    /// the error; 3: not all.
    Converge(Converge),
    /// Fits numbers of a scene to measured friction: values, standard errors, what the data cannot tell. Exit status 0:
    /// converged; 3: not converged, or not all identifiable; 1: refused.
    Calibrate(Calibrate),
    /// Compares the table of a sweep with measured friction: curves and points in one picture, and the worst points.
    Compare(Compare),
    /// Draws where the rubber touches in steady sliding, and how hard.
    Contact(Contact),
    /// Prints what completes commands and options in a shell: asperity completions bash >>
    /// ~/.local/share/bash-completion/completions/asperity.
    Completions(Completions),
    /// Writes the manual pages, one for each command.
    Manual(Manual),
    /// Prints all keys of scenes and patches, all outputs and options, as Markdown: docs/reference.md.
    #[command(hide = true)]
    Reference,
}

#[derive(Debug, Args)]
pub(crate) struct Completions {
    /// The shell.
    pub(crate) shell: clap_complete::Shell,
}

#[derive(Debug, Args)]
pub(crate) struct Manual {
    /// The folder to write the pages to; it is created if it does not exist.
    #[arg(short, long, value_name = "FOLDER")]
    pub(crate) output: PathBuf,
}

#[derive(Debug, Args)]
#[command(group(ArgGroup::new("simulated").required(true).args(["scene", "patch"])))]
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
    #[arg(long, value_name = "N", default_value_t = 50, value_parser = count, conflicts_with = "patch")]
    pub(crate) points: u32,
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

// Not a doc comment: that would be the description of the commands that have it.
#[derive(Debug, Args)]
pub(crate) struct Set {
    /// Overrides a key of the scene or patch file: solver.relative_tolerance=1e-9,
    /// layer.vertical.maxwell[1].stiffness=0, friction.coulomb=0.5, surface="{ kind = 'flat' }". What the file does not
    /// have is added. May be repeated.
    #[arg(long, value_name = "KEY=VALUE", value_parser = key_and_value)]
    set: Vec<Setting>,
}

impl Deref for Set {
    type Target = [Setting];

    fn deref(&self) -> &Self::Target {
        &self.set
    }
}

#[derive(Debug, Args)]
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
#[command(group(ArgGroup::new("described").required(true).args(["scene", "patch"])))]
pub(crate) struct Describe {
    /// The scene file.
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: Option<PathBuf>,
    /// A patch file: summarises a contact patch instead.
    #[arg(long, value_name = "PATCH.toml", conflicts_with_all = ["json", "plot"])]
    pub(crate) patch: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) set: Set,
    /// Prints the whole scene as one JSON object in SI units: links as constants, the profile as data points. Absent
    /// entries are null or empty.
    #[arg(long)]
    pub(crate) json: bool,
    /// Plots the stiffness of the links over that of the material's surface, over wavelength, and the friction below the
    /// profile over speed at three temperatures, as SVG or PNG according to the file name.
    #[arg(long, value_name = "OUT.svg", value_parser = picture())]
    pub(crate) plot: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[command(group(ArgGroup::new("input").required(true)))]
pub(crate) struct Pack {
    /// The scene file.
    #[arg(value_name = "SCENE.toml", group = "input")]
    pub(crate) scene: Option<PathBuf>,
    /// A sweep table: packs a point-contact element, which interpolates the table instead of simulating the layer.
    #[arg(long, value_name = "TABLE.csv", group = "input")]
    pub(crate) table: Option<PathBuf>,
    /// A patch file: packs a contact patch of many point-contact elements in three dimensions.
    #[arg(long, value_name = "PATCH.toml", group = "input")]
    pub(crate) patch: Option<PathBuf>,
    /// The scene that was swept: compares the element with its layer between the table's points, or elements of the
    /// patch, tilted over the table's pressures, at three speeds; along a to-and-fro motion; and the patch with one of
    /// twice as many elements along and across. Writes tables and plots to a folder beside the FMU.
    #[arg(long, value_name = "SCENE.toml", conflicts_with = "scene")]
    pub(crate) check: Option<PathBuf>,
    /// Maximum number of points, or of elements of a patch, that --check compares with the layer.
    #[arg(long, value_name = "N", default_value_t = 12, value_parser = count, requires = "check")]
    #[arg(conflicts_with = "scene")]
    pub(crate) points: u32,
    /// The FMU to write.
    #[arg(short, long, value_name = "OUT.fmu")]
    pub(crate) output: PathBuf,
    /// Gives variables names without structure, as transport_speed for transport.speed, for tools that make buses or
    /// folders of points and brackets in names.
    #[arg(long)]
    pub(crate) flat_names: bool,
    /// A shared library; for this platform unless linux64, win64 or darwin64 is given, as in win64=PATH. May be
    /// repeated. Default: the library beside this program.
    #[arg(long, value_name = "[PLATFORM=]PATH")]
    pub(crate) library: Vec<OsString>,
}

#[derive(Debug, Args)]
pub(crate) struct Fit {
    /// The measured moduli, as text or a workbook (xlsx, xls, ods): columns, by their names and units, of frequency, E'
    /// and E'' or tan delta (or G', G''; or |E*| and delta), and temperature if it varies; or of time and E(t). Other
    /// columns are left out.
    #[arg(value_name = "DMA.csv")]
    pub(crate) data: PathBuf,
    /// The file of Prony terms to write, in the format that a scene reads; - for standard output.
    #[arg(short, long, value_name = "OUT.csv")]
    pub(crate) output: PathBuf,
    /// The admissible error of the fit: the root mean square of the relative errors of E' and E'' at all points.
    #[arg(long, value_name = "E", default_value_t = 0.02, value_parser = fit_error)]
    pub(crate) error: f64,
    /// Constants of the Williams-Landel-Ferry equation, which shifts rows at other temperatures to TREF: C1 (1), C2
    /// (K), TREF (K). Default: shift factors are found where the curves overlap, and constants for them.
    #[arg(long, value_name = "C1,C2,TREF", value_parser = wlf_constants)]
    pub(crate) wlf: Option<WlfConstants>,
    /// Also fits a Kelvin-Voigt viscosity in parallel to the terms.
    #[arg(long)]
    pub(crate) viscosity: bool,
    /// A table of shift factors in place of constants: columns temperature and a_T (or log a_T).
    #[arg(long, value_name = "SHIFTS.csv", conflicts_with = "wlf")]
    pub(crate) shifts: Option<PathBuf>,
    /// The temperature in K at which the master curve is made where no constants are given; the measured one that is
    /// nearest. Default: 293.15.
    #[arg(long, value_name = "T", value_parser = temperature, conflicts_with = "wlf")]
    pub(crate) reference: Option<f64>,
    /// Which modulus the error counts: E' alone, E'' alone (each where the other decides what it leaves open), or both.
    #[arg(long, value_enum, default_value_t = FitWeight::Both)]
    pub(crate) weight: FitWeight,
    /// What becomes of the moduli of other temperatures. Default: divided by b_T where the table, or that of --shifts, has
    /// such a column.
    #[arg(long, value_enum, default_value_t = FitVertical::Divide)]
    pub(crate) vertical: FitVertical,
    /// The coefficient of expansion of the volume in 1/K, for --vertical density. Default: 6.6e-4, that of natural rubber.
    #[arg(long, value_name = "A", value_parser = expansion)]
    pub(crate) expansion: Option<f64>,
    /// The frequency of all rows, in rad/s or with its unit, where the table has no column of it.
    #[arg(long, value_name = "F", value_parser = frequency)]
    pub(crate) frequency: Option<f64>,
    /// Poisson's ratio, by which moduli of shear become moduli of tension.
    #[arg(long, value_name = "NU", default_value_t = 0.5, value_parser = poisson_ratio)]
    pub(crate) poisson_ratio: f64,
    /// Storage and loss moduli whose headings have no letter are of shear, G' and G''.
    #[arg(long)]
    pub(crate) shear: bool,
    /// The unit of a column, where its heading names none or another one, as in 'Temperature=°C'. May be repeated.
    #[arg(long, value_name = "COLUMN=UNIT", value_parser = column_unit)]
    pub(crate) unit: Vec<(String, asperity::tables::Unit)>,
    /// The sheet of a workbook. Default: the only one with moduli.
    #[arg(long, value_name = "NAME")]
    pub(crate) sheet: Option<String>,
    /// Ignores the column with this header, written exactly as in the file. May be repeated.
    #[arg(long, value_name = "COLUMN")]
    pub(crate) ignore: Vec<String>,
    /// The plot of data and fit, as SVG or PNG according to the file name. Default: an SVG beside the output.
    #[arg(long, value_name = "OUT.svg", value_parser = picture())]
    pub(crate) plot: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct Material {
    /// The scene file.
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: PathBuf,
    /// A file to write: a table as CSV, or a plot as SVG or PNG, according to its name; - for a table on standard
    /// output. May be repeated. Default: a plot SCENE-material.svg.
    #[arg(short, long, value_name = "OUT", value_parser = picture_or_table())]
    pub(crate) output: Vec<PathBuf>,
    /// The range of the angular frequency in rad/s, or of the frequency if Hz is appended. Default: derived from the
    /// relaxation times.
    #[arg(long, value_name = "A..B[Hz]", value_parser = Frequencies::parse)]
    pub(crate) frequencies: Option<Frequencies>,
    /// The compound's temperature in K, in place of the scene's.
    #[arg(long, value_name = "T", value_parser = temperature, allow_negative_numbers = true)]
    pub(crate) temperature: Option<f64>,
    #[command(flatten)]
    pub(crate) set: Set,
}

#[derive(Debug, Args)]
pub(crate) struct Report {
    /// The scene files. Of several, each has its report in a folder of its name, and one page shows all.
    #[arg(value_name = "SCENE.toml", required = true)]
    pub(crate) scenes: Vec<PathBuf>,
    /// The folder to write to; it is created if it does not exist.
    #[arg(short, long, value_name = "FOLDER")]
    pub(crate) output: PathBuf,
    /// Range of relative tolerances to run at; each is a tenth of the previous one.
    #[arg(long, value_name = "LOOSEST..TIGHTEST", default_value = "1e-2..1e-10", value_parser = Tolerances::parse)]
    pub(crate) tolerances: Tolerances,
    /// Number of rows for each phase of the excitation at which runs are compared.
    #[arg(long, value_name = "N", default_value_t = 50, value_parser = count)]
    pub(crate) points: u32,
    /// Most timings of each run, done for short runs; long ones are timed three times. The least and the spread are
    /// reported.
    #[arg(long, value_name = "N", default_value_t = 25, value_parser = count)]
    pub(crate) repeat: u32,
    /// Robustness test: varies the scene's quantities, singly and in pairs, by up to N powers of ten either way. 0
    /// skips the test.
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = powers)]
    pub(crate) stress: u32,
    /// Approximate time limit in seconds for the pairs of the robustness test; the cheapest pairs run first.
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, value_parser = seconds, allow_negative_numbers = true)]
    pub(crate) stress_time: f64,
    /// Results of other programs, in the format written by benches/peers/run.
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) peers: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) set: Set,
}

#[derive(Debug, Args)]
pub(crate) struct Surface {
    /// The profile: text with columns x and z; an areal file, X3P, SDF, SUR, OpenCRG or text of Gwyddion; or
    /// a scene, whose surface is analysed.
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,
    /// Plots the profile and its spectrum, as SVG or PNG according to the file name.
    #[arg(short, long, value_name = "OUT.svg", value_parser = picture())]
    pub(crate) output: Option<PathBuf>,
    /// Smooths the profile: a Gaussian filter (ISO 16610-21) that halves waves of this length in m and takes away
    /// shorter ones.
    #[arg(long, value_name = "WAVELENGTH", value_parser = length)]
    pub(crate) smooth: Option<f64>,
    /// Splits the profile at this wavelength in m: smooths it as --smooth does, and takes the spectrum of the finer
    /// waves, from the whole of it, for the key fine of a scene's surface.
    #[arg(long, value_name = "WAVELENGTH", value_parser = length, conflicts_with = "smooth")]
    pub(crate) split: Option<f64>,
    /// Writes the spectrum of the finer waves, of an isotropic surface with such lines, as two columns, q in 1/m and C
    /// in m⁴, that a scene can use; without --split the isotropic spectrum of a map.
    #[arg(long, value_name = "OUT.csv")]
    pub(crate) spectrum: Option<PathBuf>,
    /// Makes the profile periodic: its mirror image follows it, after smoothing. Heights and slopes stay; the period is
    /// twice the length. Of a map, unless --line chooses one of it: its plane is taken out, and its mirror images follow
    /// along x and y.
    #[arg(long, conflicts_with_all = ["taper", "periodic"])]
    pub(crate) mirror: bool,
    /// Makes the profile periodic without the kinks of a mirror image: over a tenth of the length its end goes over
    /// into its beginning, by a cosine, after smoothing. The period is nine tenths of the length.
    #[arg(long, conflicts_with = "periodic")]
    pub(crate) taper: bool,
    /// Writes the profile as read, and smoothed or made periodic, as two columns in m that a scene can use; a map made
    /// periodic by --mirror as a matrix of heights; - for standard output.
    #[arg(long, value_name = "OUT.csv")]
    pub(crate) write: Option<PathBuf>,
    /// Prints one JSON object in SI units, including the bands of the spectrum.
    #[arg(long)]
    pub(crate) json: bool,
    /// Range of wavelengths, in m, to fit the power law to. Default: the widest range that follows a power law.
    #[arg(long, value_name = "SHORTEST..LONGEST", value_parser = wavelengths)]
    pub(crate) wavelengths: Option<RangeInclusive<f64>>,
    #[command(flatten)]
    pub(crate) reading: Reading,
}

// How a profile is read: the keys of a surface of kind "file". Not a doc comment: that would be the description of the
// command.
#[derive(Debug, PartialEq, Default, Args)]
pub(crate) struct Reading {
    /// Unit of x and z: m, mm, um, nm, cm, Å, in, mil or ft. Default: the unit named in the file, otherwise m.
    #[arg(long, value_name = "UNIT")]
    pub(crate) unit: Option<LengthUnit>,
    /// Unit of x only.
    #[arg(long, value_name = "UNIT")]
    pub(crate) x_unit: Option<LengthUnit>,
    /// Unit of z only.
    #[arg(long, value_name = "UNIT")]
    pub(crate) z_unit: Option<LengthUnit>,
    /// Missing heights: refuse the file, or fill the gaps by linear interpolation. Default: refuse.
    #[arg(long, value_name = "refuse|fill")]
    pub(crate) missing: Option<Missing>,
    /// Tilt: keep it, or remove the least squares line. Default: keep.
    #[arg(long, value_name = "keep|remove")]
    pub(crate) tilt: Option<Tilt>,
    /// Whether numbers of z are heights or depths, which grow downwards: z is minus them. Default: by the name of their
    /// column, depth or not.
    #[arg(long, value_name = "up|down")]
    pub(crate) depth: Option<Depth>,
    /// What the third column marks: invalid points, valid points, or nothing (ignore). Default: taken from its header.
    #[arg(long, value_name = "invalid|valid|ignore")]
    pub(crate) third_column: Option<ThirdColumn>,
    /// The columns of x and z, by their names or numbers, as in x,z; one alone holds heights. Default: by their names.
    #[arg(long, value_name = "X,Z", value_delimiter = ',', num_args = 1..=2)]
    pub(crate) columns: Vec<String>,
    /// The distance of points of a file without x, in m, and of the lines of a matrix of heights; a unit may follow, as
    /// in 0.05mm.
    #[arg(long, value_name = "DX[,DY]", value_delimiter = ',', num_args = 1..=2, value_parser = length)]
    pub(crate) spacing: Vec<f64>,
    /// The line of an areal measurement, counted from 1. Default: the middle one.
    #[arg(long, value_name = "N", value_parser = count)]
    pub(crate) line: Option<u32>,
    /// Treats the profile as periodic; its spectrum then needs no window.
    #[arg(long)]
    pub(crate) periodic: bool,
}

impl Reading {
    pub(crate) fn options(&self) -> ProfileOptions {
        ProfileOptions {
            x_unit: self.x_unit.or(self.unit),
            z_unit: self.z_unit.or(self.unit),
            missing: self.missing.unwrap_or_default(),
            tilt: self.tilt.unwrap_or_default(),
            depth: self.depth,
            third_column: self.third_column,
            columns: self.columns.clone(),
            spacing: self.spacing.clone(),
            line: self.line.map(|line| line as usize),
            periodic: self.periodic,
        }
    }
}

/// Options of a sweep that --merge does not take.
const OF_A_SCENE: [&str; 12] = [
    "speeds",
    "pressures",
    "forces",
    "temperatures",
    "method",
    "points",
    "error",
    "distance",
    "shard",
    "master",
    "converged",
    "set",
];

#[derive(Debug, Args)]
#[command(group(ArgGroup::new("input").required(true)))]
pub(crate) struct Sweep {
    /// The scene file; its excitation and outputs are not used.
    #[arg(value_name = "SCENE.toml", group = "input")]
    pub(crate) scene: Option<PathBuf>,
    /// Speeds in m/s: a..b/n for n values evenly spaced in the logarithm, a list, or both, separated by commas.
    #[arg(long, value_name = "VALUES", value_parser = Values::speeds, required_unless_present = "merge")]
    pub(crate) speeds: Option<Values>,
    /// Mean pressures in Pa, in the format of --speeds. Requires a scene in the material form.
    #[arg(long, value_name = "VALUES", value_parser = Values::pressures, conflicts_with = "forces")]
    pub(crate) pressures: Option<Values>,
    /// Mean normal forces F_z of the whole layer in N, in place of pressures. Works with either form of scene.
    #[arg(long, value_name = "VALUES", value_parser = Values::forces)]
    pub(crate) forces: Option<Values>,
    /// Temperatures in K: a..b/n for n evenly spaced values. Default: the scene's temperature.
    #[arg(long, value_name = "VALUES", value_parser = Values::temperatures)]
    pub(crate) temperatures: Option<Values>,
    /// The table to write, - for standard output; an existing table of the same sweep is continued. Default: the
    /// scene's file name with .sweep.csv.
    #[arg(short, long, value_name = "TABLE.csv")]
    pub(crate) output: Option<PathBuf>,
    /// The plot to write, as SVG or PNG according to the file name. Points that are not steady, or not converged, are
    /// hollow. Default: the table's name with .svg.
    #[arg(long, value_name = "OUT.svg", value_parser = picture(), conflicts_with = "shard")]
    pub(crate) plot: Option<PathBuf>,
    /// Also plots the master curve: friction over a_T v, the speed at the reference temperature of material.wlf.
    #[arg(long, value_name = "OUT.svg", value_parser = picture(), conflicts_with = "shard")]
    pub(crate) master: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) sliding: Sliding,
    /// Several ways in m, in the format of --speeds: the table has a column way [m], and friction is plotted over the way. It
    /// is not to be packed or continued.
    #[arg(long, value_name = "VALUES", value_parser = Values::ways)]
    #[arg(conflicts_with_all = ["way", "shard", "merge", "master", "converged"])]
    pub(crate) ways: Option<Values>,
    /// Computes only share I of N of the points, I from 1 to N.
    #[arg(long, value_name = "I/N", value_parser = Shard::parse)]
    pub(crate) shard: Option<Shard>,
    /// Merges the tables of shards, and the one at --output if it is of the same sweep.
    #[arg(long, value_name = "TABLE.csv", num_args = 1.., group = "input", requires = "output")]
    #[arg(conflicts_with_all = OF_A_SCENE)]
    pub(crate) merge: Vec<PathBuf>,
    /// The table of an asperity converge of the scene: what it found goes into the header. Default: the scene's file
    /// name with .converge.csv, if there is such a file.
    #[arg(long, value_name = "STUDY.csv")]
    pub(crate) converged: Option<PathBuf>,
    /// Replaces an existing table instead of continuing it.
    #[arg(long)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) set: Set,
}

// How the points of a sweep are found. Not a doc comment: that would be the description of the commands that have it.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct Sliding {
    /// How steady sliding is found: by solving for it, or by letting the layer slide until it is. Default: steady where the
    /// foundation is "half_space" or "layer" and the surface periodic and not flat; else layer.
    #[arg(long, value_name = "METHOD", value_parser = sweep_method())]
    pub(crate) method: Option<SweepMethod>,
    /// The way slid so far, in m: the scene's temperature is that of the rubber before it slid, not that of the surface around
    /// its contacts. With --method steady, of a scene with material.heat.
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_negative_numbers = true)]
    pub(crate) way: Option<f64>,
    /// Points of a period along x, with --method steady; of a map with those along y in proportion. Default: the surface's
    /// own, or of a profile 8 to its shortest wave where they are uneven or fewer.
    #[arg(long, value_name = "N", value_parser = count)]
    pub(crate) points: Option<u32>,
    /// Admissible standard error of the friction coefficient, relative to it, with --method layer. Default: 5e-3.
    #[arg(long, value_name = "SHARE", value_parser = share)]
    pub(crate) error: Option<f64>,
    /// Maximum sliding distance in m for a point to become steady, with --method layer. Default: 100 blocks; a block is a
    /// whole number of profile periods or layer lengths.
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_negative_numbers = true)]
    pub(crate) distance: Option<f64>,
}

#[derive(Debug, Args)]
pub(crate) struct Calibrate {
    /// The scene file, in the material form; its excitation and outputs are not used.
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: PathBuf,
    /// The measured friction: columns, by their names and units, of speed, pressure (or force on the whole layer) and
    /// friction; of temperature and of the standard deviation of friction if it has them. Rows of one point are repeats.
    #[arg(long, value_name = "MEASURED.csv")]
    pub(crate) data: PathBuf,
    /// A number of the scene to fit, by its key as for --set, within bounds; its logarithm where they are positive and a
    /// decade apart. May be repeated, up to 12 times.
    #[arg(long, value_name = "KEY=LOW..HIGH", value_parser = free_parameter, required = true)]
    pub(crate) free: Vec<FreeParameter>,
    /// The scene to write with the numbers found, its comments kept; - for standard output. The points found are kept in
    /// a table beside it, from which an interrupted fit goes on. Default: the scene's file with .calibrated.toml.
    #[arg(short, long, value_name = "OUT.toml")]
    pub(crate) output: Option<PathBuf>,
    /// The plot to write, as SVG or PNG according to the file name. Default: the output's name with .svg.
    #[arg(long, value_name = "OUT.svg", value_parser = picture())]
    pub(crate) plot: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) sliding: Sliding,
    /// Also proposes three points to measure that would tell most (D-optimal among a grid).
    #[arg(long)]
    pub(crate) plan: bool,
    /// Speeds of that grid in m/s, in the format of asperity sweep. Default: a decade beyond the data's.
    #[arg(long, value_name = "VALUES", value_parser = Values::speeds, requires = "plan")]
    pub(crate) speeds: Option<Values>,
    /// Pressures of that grid in Pa. Default: a factor of two beyond the data's.
    #[arg(long, value_name = "VALUES", value_parser = Values::pressures, requires = "plan")]
    pub(crate) pressures: Option<Values>,
    /// Temperatures of that grid in K. Default: 20 K beyond the data's.
    #[arg(long, value_name = "VALUES", value_parser = Values::temperatures, requires = "plan")]
    pub(crate) temperatures: Option<Values>,
    /// Replaces an existing table of points instead of going on from it.
    #[arg(long)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) set: Set,
}

#[derive(Debug, Args)]
pub(crate) struct Compare {
    /// The table of asperity sweep, over pressures.
    #[arg(value_name = "TABLE.csv")]
    pub(crate) table: PathBuf,
    /// The measured friction, as for asperity calibrate.
    #[arg(long, value_name = "MEASURED.csv")]
    pub(crate) data: PathBuf,
    /// The plot to write, as SVG or PNG according to the file name. Default: the table's name with .compare.svg.
    #[arg(short, long, value_name = "OUT.svg", value_parser = picture())]
    pub(crate) output: Option<PathBuf>,
}

// One state of steady sliding. Not a doc comment: that would be the description of the commands that have it.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct SteadyState {
    /// Mean pressure in Pa.
    #[arg(long, value_name = "PRESSURE", value_parser = pressure, allow_negative_numbers = true)]
    pub(crate) pressure: f64,
    /// Sliding speed in m/s.
    #[arg(long, value_name = "SPEED", value_parser = speed, allow_negative_numbers = true)]
    pub(crate) speed: f64,
}

#[derive(Debug, Args)]
pub(crate) struct Contact {
    /// The scene file, in the material form with a foundation "half_space" or "layer" and a periodic surface; its excitation
    /// and outputs are not used.
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: PathBuf,
    #[command(flatten)]
    pub(crate) at: SteadyState,
    /// The way slid so far, in m: the scene's temperature is that of the rubber before it slid, not that of the surface around
    /// its contacts. Of a scene with material.heat.
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_negative_numbers = true)]
    pub(crate) way: Option<f64>,
    /// Points of a period along x; of a map with those along y in proportion. Default: the surface's own, or of a profile 8
    /// to its shortest wave where they are uneven or fewer.
    #[arg(long, value_name = "N", value_parser = count)]
    pub(crate) points: Option<u32>,
    /// The picture to write, as SVG or PNG according to the file name: along a profile heights and pressure; of a map
    /// pressure, gap and where it is touched.
    #[arg(short, long, value_name = "OUT.png", value_parser = picture())]
    pub(crate) output: PathBuf,
    /// All points to write: x, y, height, pressure, gap, as a table or, with .npz, as arrays of numpy with a row for each y.
    #[arg(long, value_name = "OUT.csv|.npz", value_parser = table_or_arrays())]
    pub(crate) data: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) set: Set,
}

#[derive(Debug, Args)]
pub(crate) struct Converge {
    /// The scene file, in the material form; its excitation and outputs are not used.
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: PathBuf,
    #[command(flatten)]
    pub(crate) at: SteadyState,
    /// Admissible change of friction and area, as a share of them, with the spacing halved, the length doubled or
    /// another seed.
    #[arg(long, value_name = "SHARE", default_value_t = 0.05, value_parser = share)]
    pub(crate) error: f64,
    /// Number of seeds of a self-affine surface or roughness, the scene's own included. Default: 4.
    #[arg(long, value_name = "N", value_parser = seeds)]
    pub(crate) seeds: Option<u32>,
    /// How steady sliding is found, as in a sweep. Default: as a sweep's.
    #[arg(long, value_name = "METHOD", value_parser = sweep_method())]
    pub(crate) method: Option<SweepMethod>,
    /// The way slid so far, in m: the scene's temperature is that of the rubber before it slid, not that of the surface around
    /// its contacts. With --method steady, of a scene with material.heat.
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_negative_numbers = true)]
    pub(crate) way: Option<f64>,
    /// Points of a period along x to begin with, with --method steady. Default: as of a sweep.
    #[arg(long, value_name = "N", value_parser = count)]
    pub(crate) points: Option<u32>,
    /// Most masses, or points of the whole surface with --method steady, that the halved spacing may come to; with twice
    /// the length there are twice as many. Default: 4096 masses, 2097152 points.
    #[arg(long, value_name = "N", visible_alias = "most-masses", value_parser = count)]
    pub(crate) most_points: Option<u32>,
    /// The table to write, - for standard output; an existing table of the same study is continued. Default: the
    /// scene's file name with .converge.csv.
    #[arg(short, long, value_name = "TABLE.csv")]
    pub(crate) output: Option<PathBuf>,
    /// The plot to write, as SVG or PNG according to the file name. Default: the table's name with .svg.
    #[arg(long, value_name = "OUT.svg", value_parser = picture())]
    pub(crate) plot: Option<PathBuf>,
    /// Maximum sliding distance in m for a run to become steady, with --method layer. Default: 100 blocks; a block is a
    /// whole number of profile periods or layer lengths.
    #[arg(long, value_name = "LENGTH", value_parser = length, allow_negative_numbers = true)]
    pub(crate) distance: Option<f64>,
    /// Replaces an existing table instead of continuing it.
    #[arg(long)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) set: Set,
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_program_says_its_own_name() {
        assert_eq!(Arguments::command().render_version(), concat!("asperity ", env!("CARGO_PKG_VERSION"), "\n"));
    }

    #[test]
    fn the_command_line_is_well_formed() {
        Arguments::command().debug_assert();
    }
}
