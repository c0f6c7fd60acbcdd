//! The arguments of `fit` and `surface`.

use std::path::PathBuf;

use asperity_study::fit::FitOptions;
use asperity_study::surface::{ProfileReading, SurfaceOptions};
use clap::Args;

use super::values::{example, picture};

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
    #[command(flatten)]
    pub(crate) options: FitOptions,
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
    /// Writes the spectrum of the finer waves, of an isotropic surface with such lines, as two columns, q in 1/m and C
    /// in m⁴, that a scene can use; without --split the isotropic spectrum of a map.
    #[arg(long, value_name = "OUT.csv")]
    pub(crate) spectrum: Option<PathBuf>,
    /// Writes the profile as read, and smoothed or made periodic, as two columns in m that a scene can use; a map made
    /// periodic by --mirror as a matrix of heights; - for standard output.
    #[arg(long, value_name = "OUT.csv")]
    pub(crate) write: Option<PathBuf>,
    /// Prints one JSON object in SI units, including the bands of the spectrum.
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) options: SurfaceOptions,
    #[command(flatten)]
    pub(crate) reading: ProfileReading,
}
