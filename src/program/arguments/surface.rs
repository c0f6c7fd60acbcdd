//! The command line of `asperity surface`.

use std::ops::RangeInclusive;
use std::path::PathBuf;

use asperity::scene::{LengthUnit, Missing, ProfileOptions, ThirdColumn, Tilt};
use clap::Args;

use super::{count, ends, picture};

#[derive(Debug, Args)]
pub(crate) struct Surface {
    /// The profile: text with columns x and z, or X3P (ISO 5436-2); or a scene, whose surface is meant.
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,
    /// Draws profile and spectrum, as SVG or PNG by the name.
    #[arg(short, long, value_name = "OUT.svg", value_parser = picture())]
    pub(crate) output: Option<PathBuf>,
    /// Writes the profile as it was read, two columns in m, for a scene.
    #[arg(long, value_name = "OUT.csv")]
    pub(crate) write: Option<PathBuf>,
    /// Prints one JSON object, in SI units, the spectrum's bands included.
    #[arg(long)]
    pub(crate) json: bool,
    /// Wavelengths that the power law is fitted to, m; default: as many as follow one.
    #[arg(long, value_name = "SHORTEST..LONGEST", value_parser = wavelengths)]
    pub(crate) wavelengths: Option<RangeInclusive<f64>>,
    #[command(flatten)]
    pub(crate) reading: Reading,
}

/// The keys of a surface of kind "file".
#[derive(Debug, PartialEq, Default, Args)]
pub(crate) struct Reading {
    /// Unit of x and z: m, mm, um or nm; default: the file's, or else m.
    #[arg(long, value_name = "UNIT")]
    pub(crate) unit: Option<LengthUnit>,
    /// Unit of x alone.
    #[arg(long, value_name = "UNIT")]
    pub(crate) x_unit: Option<LengthUnit>,
    /// Unit of z alone.
    #[arg(long, value_name = "UNIT")]
    pub(crate) z_unit: Option<LengthUnit>,
    /// Missing heights: refused, or filled with straight lines; default: refuse.
    #[arg(long, value_name = "refuse|fill")]
    pub(crate) missing: Option<Missing>,
    /// Tilt: kept, or removed with the least squares line; default: keep.
    #[arg(long, value_name = "keep|remove")]
    pub(crate) tilt: Option<Tilt>,
    /// What a third column marks: points whose height does not count, or those whose height does; or nothing: ignore.
    #[arg(long, value_name = "invalid|valid|ignore")]
    pub(crate) third_column: Option<ThirdColumn>,
    /// The line of an areal measurement, from 1.
    #[arg(long, value_name = "N", value_parser = count)]
    pub(crate) line: Option<u32>,
    /// The profile is repeated for ever: its spectrum needs no window.
    #[arg(long)]
    pub(crate) periodic: bool,
}

impl Reading {
    /// As the reader takes them.
    pub(crate) fn options(&self) -> ProfileOptions {
        ProfileOptions {
            x_unit: self.x_unit.or(self.unit),
            z_unit: self.z_unit.or(self.unit),
            missing: self.missing.unwrap_or_default(),
            tilt: self.tilt.unwrap_or_default(),
            third_column: self.third_column,
            line: self.line.map(|line| line as usize),
            periodic: self.periodic,
        }
    }
}

fn wavelengths(text: &str) -> Result<RangeInclusive<f64>, String> {
    let possible = |(shortest, longest): &(f64, f64)| *shortest > 0.0 && shortest < longest && longest.is_finite();
    let message = || "expected SHORTEST..LONGEST in m, such as 1e-5..1e-3".to_owned();
    ends(text).filter(possible).map(|(shortest, longest)| shortest..=longest).ok_or_else(message)
}
