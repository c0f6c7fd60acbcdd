//! The arguments of `fit` and `surface`.

use std::ops::RangeInclusive;
use std::path::PathBuf;

use asperity::scene::{Depth, LengthUnit, Missing, ProfileOptions, ThirdColumn, Tilt};
use asperity_study::files::given_column;
use asperity_study::fit::WlfConstants;
use clap::Args;

use super::values::{
    FitVertical, FitWeight, column_unit, count, expansion, fit_error, frequency, length, picture, poisson_ratio,
    temperature, wavelengths, wlf_constants,
};

#[derive(Debug, Args)]
#[command(after_help = example!("asperity fit docs/guide/dma.csv --wlf 7.52,119.75,293.15 -o compound.csv"))]
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
    pub(crate) fit_error: f64,
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
    /// The sheet of a workbook. Default: the only one with moduli, or all of those named by temperatures: 20C, -10 °C.
    #[arg(long, value_name = "NAME")]
    pub(crate) sheet: Option<String>,
    /// Which column is which, by its name or number, as in storage_modulus="E' 1". May be repeated.
    #[arg(long = "column", value_name = "ROLE=COLUMN", value_parser = given_column)]
    pub(crate) columns: Vec<(String, String)>,
    /// Ignores the column with this header, written exactly as in the file. May be repeated.
    #[arg(long, value_name = "COLUMN")]
    pub(crate) ignore: Vec<String>,
    /// The plot of data and fit, as SVG or PNG according to the file name. Default: an SVG beside the output.
    #[arg(long, value_name = "OUT.svg", value_parser = picture())]
    pub(crate) plot: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[command(after_help = example!("asperity surface docs/guide/road.txt --missing fill --tilt remove -o road.svg"))]
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
    /// Which column is x, y or z, by its name or number, as in z=Texture. May be repeated.
    #[arg(long = "column", value_name = "AXIS=COLUMN", value_parser = given_column, conflicts_with = "columns")]
    pub(crate) column: Vec<(String, String)>,
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
    /// The columns by their axes.
    fn all_columns(&self) -> Vec<(String, String)> {
        ProfileOptions::axes(&self.columns).into_iter().chain(self.column.iter().cloned()).collect()
    }

    pub(crate) fn options(&self) -> ProfileOptions {
        ProfileOptions {
            x_unit: self.x_unit.or(self.unit),
            z_unit: self.z_unit.or(self.unit),
            missing: self.missing.unwrap_or_default(),
            tilt: self.tilt.unwrap_or_default(),
            depth: self.depth,
            third_column: self.third_column,
            columns: self.all_columns(),
            spacing: self.spacing.clone(),
            line: self.line.map(|line| line as usize),
            periodic: self.periodic,
        }
    }
}
