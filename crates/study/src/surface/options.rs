//! What is asked of a surface: how its file is read, and what is done with it.

use asperity::scene::{Depth, LengthUnit, Missing, ProfileOptions, ThirdColumn, Tilt};
use clap::Args;
use serde::Deserialize;

use crate::Error;
use crate::files::given_column;
use crate::values::{count, ends, length};

/// The shortest and the longest of some waves, m.
pub type Wavelengths = [f64; 2];

// What is done with a surface. Not a doc comment: that would be the description of the command.
#[expect(missing_docs, reason = "clap would print it")]
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Args)]
#[serde(default)]
pub struct SurfaceOptions {
    /// Smooths the profile: a Gaussian filter (ISO 16610-21) that halves waves of this length in m and takes away
    /// shorter ones.
    #[arg(long, value_name = "WAVELENGTH", value_parser = length)]
    pub smooth: Option<f64>,
    /// Splits the profile at this wavelength in m: smooths it as --smooth does, and takes the spectrum of the finer
    /// waves, from the whole of it, for the key fine of a scene's surface.
    #[arg(long, value_name = "WAVELENGTH", value_parser = length, conflicts_with = "smooth")]
    pub split: Option<f64>,
    /// Makes the profile periodic: its mirror image follows it, after smoothing. Heights and slopes stay; the period is
    /// twice the length. Of a map, unless --line chooses one of it: its plane is taken out, and its mirror images follow
    /// along x and y.
    #[arg(long, conflicts_with_all = ["taper", "periodic"])]
    pub mirror: bool,
    /// Makes the profile periodic without the kinks of a mirror image: over a tenth of the length its end goes over
    /// into its beginning, by a cosine, after smoothing. The period is nine tenths of the length.
    #[arg(long, conflicts_with = "periodic")]
    pub taper: bool,
    /// Range of wavelengths, in m, to fit the power law to. Default: the widest range that follows a power law.
    #[arg(long, value_name = "SHORTEST..LONGEST", value_parser = wavelengths)]
    pub wavelengths: Option<Wavelengths>,
}

impl SurfaceOptions {
    /// Refuses options that do not go together or with a profile that is periodic already, and lengths that are none.
    ///
    /// # Errors
    /// With the options, and what was expected.
    pub fn check(&self, is_periodic: bool) -> Result<(), Error> {
        if (self.mirror || self.taper) && is_periodic {
            return Err(Error::value("`mirror` and `taper` make a profile periodic, and it is"));
        }
        if self.smooth.is_some() && self.split.is_some() {
            return Err(Error::value("`smooth` and `split`: expected one of them"));
        }
        if self.mirror && self.taper {
            return Err(Error::value("`mirror` and `taper`: expected one of them"));
        }
        let is_length = |length: f64| length > 0.0 && length.is_finite();
        let lengths = [("smooth", self.smooth), ("split", self.split)];
        if let Some((name, found)) = lengths.into_iter().find(|(_, length)| length.is_some_and(|l| !is_length(l))) {
            let found = found.unwrap_or_default();
            return Err(Error::value(format!("`{name}` {found:?}: expected a number above 0, in m")));
        }
        match self.wavelengths {
            Some(found) if !are_wavelengths(&found) => {
                Err(Error::value(format!("`wavelengths` {found:?}: expected the shortest and the longest, in m")))
            }
            _ => Ok(()),
        }
    }
}

fn are_wavelengths([shortest, longest]: &Wavelengths) -> bool {
    *shortest > 0.0 && shortest < longest && longest.is_finite()
}

fn wavelengths(text: &str) -> Result<Wavelengths, String> {
    let message = || "expected SHORTEST..LONGEST in m, such as 1e-5..1e-3".to_owned();
    ends(text).map(<[f64; 2]>::from).filter(are_wavelengths).ok_or_else(message)
}

// How a profile is read: the keys of a surface of kind "file". Not a doc comment: that would be the description of the
// command.
#[expect(missing_docs, reason = "clap would print it")]
#[derive(Clone, Debug, PartialEq, Default, Deserialize, Args)]
#[serde(default)]
pub struct ProfileReading {
    /// Unit of x and z: m, mm, um, nm, cm, Å, in, mil or ft. Default: the unit named in the file, otherwise m.
    #[arg(long, value_name = "UNIT")]
    pub unit: Option<LengthUnit>,
    /// Unit of x only.
    #[arg(long, value_name = "UNIT")]
    pub x_unit: Option<LengthUnit>,
    /// Unit of z only.
    #[arg(long, value_name = "UNIT")]
    pub z_unit: Option<LengthUnit>,
    /// Missing heights: refuse the file, or fill the gaps by linear interpolation. Default: refuse.
    #[arg(long, value_name = "refuse|fill")]
    pub missing: Option<Missing>,
    /// Tilt: keep it, or remove the least squares line. Default: keep.
    #[arg(long, value_name = "keep|remove")]
    pub tilt: Option<Tilt>,
    /// Whether numbers of z are heights or depths, which grow downwards: z is minus them. Default: by the name of their
    /// column, depth or not.
    #[arg(long, value_name = "up|down")]
    pub depth: Option<Depth>,
    /// What the third column marks: invalid points, valid points, or nothing (ignore). Default: taken from its header.
    #[arg(long, value_name = "invalid|valid|ignore")]
    pub third_column: Option<ThirdColumn>,
    /// The columns of x and z, by their names or numbers, as in x,z; one alone holds heights. Default: by their names.
    #[arg(long, value_name = "X,Z", value_delimiter = ',', num_args = 1..=2)]
    pub columns: Vec<String>,
    /// Which column is x, y or z, by its name or number, as in z=Texture. May be repeated.
    #[arg(long = "column", value_name = "AXIS=COLUMN", value_parser = given_column, conflicts_with = "columns")]
    pub column: Vec<(String, String)>,
    /// The distance of points of a file without x, in m, and of the lines of a matrix of heights; a unit may follow, as
    /// in 0.05mm.
    #[arg(long, value_name = "DX[,DY]", value_delimiter = ',', num_args = 1..=2, value_parser = length)]
    pub spacing: Vec<f64>,
    /// The line of an areal measurement, counted from 1. Default: the middle one.
    #[arg(long, value_name = "N", value_parser = count)]
    pub line: Option<u32>,
    /// Treats the profile as periodic; its spectrum then needs no window.
    #[arg(long)]
    pub periodic: bool,
}

impl ProfileReading {
    /// The options of a surface of kind "file".
    pub fn options(&self) -> ProfileOptions {
        ProfileOptions {
            x_unit: self.x_unit.or(self.unit),
            z_unit: self.z_unit.or(self.unit),
            missing: self.missing.unwrap_or_default(),
            tilt: self.tilt.unwrap_or_default(),
            depth: self.depth,
            third_column: self.third_column,
            columns: ProfileOptions::axes(&self.columns).into_iter().chain(self.column.iter().cloned()).collect(),
            spacing: self.spacing.clone(),
            line: self.line.map(|line| line as usize),
            periodic: self.periodic,
        }
    }
}
