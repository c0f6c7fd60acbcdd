//! How a profile file is to be read.

use std::str::FromStr;

use serde::de::Error as _;
use serde::{Deserialize, Deserializer};

use crate::scene::values::{Word, words};
use crate::tables::Unit;

/// How a file is to be read. What is not given is as the file says, or else as the defaults are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ProfileOptions {
    /// Unit of x; `None`: the one in the file, or else the metre.
    pub x_unit: Option<LengthUnit>,
    /// Unit of z; as for x.
    pub z_unit: Option<LengthUnit>,
    /// What becomes of points without a height.
    pub missing: Missing,
    /// What becomes of the profile's tilt.
    pub tilt: Tilt,
    /// Which way heights grow; `None`: up, but down where their column is called depth and they are not mostly below 0.
    pub depth: Option<Depth>,
    /// What a third column means; `None`: what its name in the header says.
    pub third_column: Option<ThirdColumn>,
    /// The columns of x, y and z, each by its axis and its name or number from 1; those left out: by their names in the
    /// file.
    pub columns: Vec<(String, String)>,
    /// The distance of points along x, and of lines along y, m, of a file without them; none where the file has them.
    pub spacing: Vec<f64>,
    /// The line of an areal measurement, from 1; `None`: the middle one.
    pub line: Option<usize>,
    /// Whether the profile is repeated without end.
    pub periodic: bool,
}

/// A unit of length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LengthUnit {
    /// m
    Metre,
    /// mm
    Millimetre,
    /// µm
    Micrometre,
    /// nm
    Nanometre,
    /// cm
    Centimetre,
    /// Å, 1e-10 m
    Angstrom,
    /// in, 25.4 mm
    Inch,
    /// mil, a thousandth of an inch
    Mil,
    /// ft, 12 in
    Foot,
}

/// What becomes of points without a height.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Missing {
    /// The file is refused.
    #[default]
    Refuse,
    /// They lie on the straight line between their neighbours; at the ends, which have but one, they are left out.
    Fill,
}

/// What becomes of the profile's tilt.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tilt {
    /// It stays, and so does the mean height.
    #[default]
    Keep,
    /// The least squares line is subtracted: it becomes z = 0.
    Remove,
}

/// Which way the heights of a file grow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Depth {
    /// They are heights.
    Up,
    /// They are depths: z is minus them.
    Down,
}

/// What a third column means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ThirdColumn {
    /// It marks the points whose height is not valid.
    Invalid,
    /// It marks those whose height is valid.
    Valid,
    /// Nothing, like the columns to the right of it.
    Ignore,
}

/// A word that is none of those allowed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected {expected}")]
pub struct UnknownWord {
    expected: String,
}

/// The words for an option, on a command line as in a scene.
macro_rules! option_words {
    ($option:ident: $($word:literal $variant:ident),+) => {
        impl Word for $option {
            const WORDS: &'static [(&'static str, Self)] = &[$(($word, Self::$variant)),+];
        }

        impl FromStr for $option {
            type Err = UnknownWord;

            fn from_str(word: &str) -> Result<Self, UnknownWord> {
                Self::parse(word).ok_or_else(|| UnknownWord { expected: words::<Self>() })
            }
        }

        impl<'de> Deserialize<'de> for $option {
            fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
                let word = String::deserialize(from)?;
                word.parse().map_err(|error| D::Error::custom(format!("{word:?}: {error}")))
            }
        }
    };
}

option_words!(LengthUnit: "m" Metre, "mm" Millimetre, "um" Micrometre, "µm" Micrometre, "nm" Nanometre, "cm" Centimetre,
    "Å" Angstrom, "in" Inch, "mil" Mil, "ft" Foot);
option_words!(Missing: "refuse" Refuse, "fill" Fill);
option_words!(Tilt: "keep" Keep, "remove" Remove);
option_words!(Depth: "up" Up, "down" Down);
option_words!(ThirdColumn: "invalid" Invalid, "valid" Valid, "ignore" Ignore);

impl LengthUnit {
    /// The unit itself.
    pub fn unit(self) -> Unit {
        Unit::parse(self.as_word()).unwrap_or(Unit::ONE)
    }
}

impl ProfileOptions {
    /// The columns of a list, x and z, or z alone, by their axes.
    pub fn axes(names: &[String]) -> Vec<(String, String)> {
        let axes: &[&str] = if names.len() == 1 { &["z"] } else { &["x", "z"] };
        axes.iter().map(|axis| (*axis).to_owned()).zip(names.iter().cloned()).collect()
    }

    /// Whether numbers of a file are depths, where the file itself says that they are or not.
    pub fn turns_over(&self, is_depth: bool) -> bool {
        self.depth.map_or(is_depth, |depth| depth == Depth::Down)
    }
}
