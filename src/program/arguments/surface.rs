//! The command line of `asperity surface`.

use std::ops::RangeInclusive;
use std::path::PathBuf;

use asperity::scene::{LengthUnit, Missing, ProfileOptions, ThirdColumn, Tilt};
use clap::Args;

#[derive(Debug, Args)]
pub(crate) struct Surface {
    /// The profile: text with columns x and z, or X3P (ISO 5436-2); or a scene, whose surface is meant.
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,
    /// Draws profile and spectrum: PNG where the name ends so, else SVG.
    #[arg(short, long, value_name = "OUT.svg")]
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
    #[arg(long)]
    pub(crate) unit: Option<LengthUnit>,
    /// Unit of x alone.
    #[arg(long)]
    pub(crate) x_unit: Option<LengthUnit>,
    /// Unit of z alone.
    #[arg(long)]
    pub(crate) z_unit: Option<LengthUnit>,
    /// Missing heights: refuse or fill, with straight lines.
    #[arg(long)]
    pub(crate) missing: Option<Missing>,
    /// Tilt: keep or remove, the least squares line.
    #[arg(long)]
    pub(crate) tilt: Option<Tilt>,
    /// What a third column says: invalid or valid points, or nothing: ignore.
    #[arg(long)]
    pub(crate) third_column: Option<ThirdColumn>,
    /// The line of an areal measurement, from 1.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
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
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|length| *length > 0.0 && length.is_finite());
    let ends = text.split_once("..").and_then(|(shortest, longest)| Some((number(shortest)?, number(longest)?)));
    let ends = ends.filter(|(shortest, longest)| shortest < longest);
    ends.map(|(shortest, longest)| shortest..=longest)
        .ok_or_else(|| "expected SHORTEST..LONGEST in m, such as 1e-5..1e-3".into())
}
