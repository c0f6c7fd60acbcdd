//! What is allowed: the ranges of numbers and the words to choose from, for the scene file and for parameters alike.

use std::fmt;

use super::profile::{LengthUnit, Missing, ThirdColumn, Tilt};
use super::{Extrapolation, Initial, Method, OutputGroup, Problem};

/// The largest size of a number in SI units that a scene, a carrier or a master may give: m, s, N/m, whatever it is.
///
/// Beyond all physics, and still so small that no product of the model overflows: c e², m κ ẋ² and the like have a
/// handful of factors, and 1e30 to the tenth power is a number.
pub const LARGEST: f64 = 1e30;

/// Whether a carrier or a master may give `number`: it is one, and of a size up to [`LARGEST`].
pub fn is_possible(number: f64) -> bool {
    number.abs() <= LARGEST
}

/// The smallest size of a number that is divided by or has a square that may not be lost in rounding to 0.
pub const SMALLEST: f64 = 1e-30;

/// Numbers whose size lies between two bounds, both included; 0 and negative numbers where they are allowed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Range {
    smallest: f64,
    largest: f64,
    zero: bool,
    negative: bool,
}

/// Whole numbers from `low` to `high`, both included.
#[derive(Clone, Copy, Debug)]
pub(super) struct WholeRange {
    low: i64,
    high: i64,
}

/// Words to choose from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Choices<T: 'static> {
    words: &'static [(&'static str, T)],
}

const POSITIVE: Range = Range { smallest: SMALLEST, largest: LARGEST, zero: false, negative: false };
const NOT_NEGATIVE: Range = Range { zero: true, ..POSITIVE };
const ANY: Range = Range { smallest: 0.0, negative: true, ..NOT_NEGATIVE };

pub(super) const MASSES: WholeRange = WholeRange { low: 1, high: 10_000_000 };
pub(super) const SPACING: Range = POSITIVE;
pub(super) const PLACE: Range = ANY;
pub(super) const HEIGHT: Range = ANY;
pub(super) const MASS: Range = POSITIVE;
pub(super) const THICKNESS: Range = POSITIVE;
pub(super) const WIDTH: Range = POSITIVE;
pub(super) const DENSITY: Range = POSITIVE;
pub(super) const POISSON_RATIO: Range = Range { largest: 0.5, ..NOT_NEGATIVE };
pub(super) const MODULUS: Range = NOT_NEGATIVE;
pub(super) const VISCOSITY: Range = NOT_NEGATIVE;
pub(super) const WLF_C1: Range = NOT_NEGATIVE;
pub(super) const WLF_C2: Range = POSITIVE;
/// Above absolute zero.
pub(super) const TEMPERATURE: Range = POSITIVE;
pub(super) const STIFFNESS: Range = NOT_NEGATIVE;
pub(super) const DAMPING: Range = NOT_NEGATIVE;
pub(super) const RELAXATION_TIME: Range = POSITIVE;
pub(super) const WAVELENGTH: Range = POSITIVE;
pub(super) const POINTS_PER_WAVELENGTH: WholeRange = WholeRange { low: 4, high: 10_000_000 };
pub(super) const LENGTH: Range = POSITIVE;
pub(super) const PROFILE_POINTS: WholeRange = WholeRange { low: 4, high: 4_000_000 };
pub(super) const HURST: Range = Range { largest: 1.0, ..POSITIVE };
pub(super) const RMS: Range = POSITIVE;
pub(super) const SEED: WholeRange = WholeRange { low: 0, high: i64::MAX };
pub(super) const LINE: WholeRange = WholeRange { low: 1, high: 1_000_000_000 };
pub(super) const FRICTION_COEFFICIENT: Range = NOT_NEGATIVE;
pub(super) const SHEAR_FORCE: Range = NOT_NEGATIVE;
pub(super) const SHEAR_STRENGTH: Range = NOT_NEGATIVE;
pub(super) const SPEED: Range = POSITIVE;
pub(super) const SHARPNESS: Range = NOT_NEGATIVE;
pub(super) const RELATIVE_TOLERANCE: Range = Range { largest: 0.1, ..POSITIVE };
pub(super) const REDUCE: Range = Range { largest: 0.1, ..NOT_NEGATIVE };
pub(super) const ABSOLUTE_TOLERANCE: Range = POSITIVE;
/// FMI's Integer has 32 bits.
pub(super) const MAX_STEPS: WholeRange = WholeRange { low: 1, high: i32::MAX as i64 };
pub(super) const DURATION: Range = POSITIVE;
pub(super) const RATE: Range = ANY;
pub(super) const AMPLITUDE: Range = ANY;
pub(super) const FREQUENCY: Range = NOT_NEGATIVE;
pub(super) const FORCE: Range = ANY;
pub(super) const PRESSURE: Range = ANY;

pub(super) const INITIAL: Choices<Initial> =
    Choices { words: &[("relaxed", Initial::Relaxed), ("undeformed", Initial::Undeformed)] };
pub(super) const METHOD: Choices<Method> =
    Choices { words: &[("event", Method::Event), ("step", Method::Step), ("auto", Method::Auto)] };
pub(super) const EXTRAPOLATION: Choices<Extrapolation> =
    Choices { words: &[("linear", Extrapolation::Linear), ("hold", Extrapolation::Hold)] };
pub(super) const SURFACE: Choices<SurfaceKind> = Choices {
    words: &[
        ("flat", SurfaceKind::Flat),
        ("sinusoid", SurfaceKind::Sinusoid),
        ("self_affine", SurfaceKind::SelfAffine),
        ("points", SurfaceKind::Points),
        ("file", SurfaceKind::File),
    ],
};
pub(super) const LENGTH_UNIT: Choices<LengthUnit> = Choices {
    words: &[
        ("m", LengthUnit::Metre),
        ("mm", LengthUnit::Millimetre),
        ("um", LengthUnit::Micrometre),
        ("nm", LengthUnit::Nanometre),
    ],
};
pub(super) const MISSING: Choices<Missing> = Choices { words: &[("refuse", Missing::Refuse), ("fill", Missing::Fill)] };
pub(super) const TILT: Choices<Tilt> = Choices { words: &[("keep", Tilt::Keep), ("remove", Tilt::Remove)] };
pub(super) const THIRD_COLUMN: Choices<ThirdColumn> = Choices {
    words: &[("invalid", ThirdColumn::Invalid), ("valid", ThirdColumn::Valid), ("ignore", ThirdColumn::Ignore)],
};
pub(super) const OUTPUTS: Choices<OutputGroup> = Choices {
    words: &[
        ("forces", OutputGroup::Forces),
        ("dissipation", OutputGroup::Dissipation),
        ("friction", OutputGroup::Friction),
        ("contact", OutputGroup::Contact),
        ("energy", OutputGroup::Energy),
        ("tangent", OutputGroup::Tangent),
        ("solver", OutputGroup::Solver),
        ("elements", OutputGroup::Elements),
    ],
};

/// Where the heights of a surface come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SurfaceKind {
    Flat,
    Sinusoid,
    SelfAffine,
    Points,
    File,
}

impl Range {
    pub(super) fn holds(&self, number: f64) -> bool {
        let size = number.abs();
        let in_range = self.smallest <= size && size <= self.largest && (self.negative || number > 0.0);
        in_range || (self.zero && number == 0.0)
    }
}

impl WholeRange {
    pub(super) fn holds(&self, number: i64) -> bool {
        (self.low..=self.high).contains(&number)
    }
}

impl<T: Copy + PartialEq> Choices<T> {
    /// What `word` stands for, or what is wrong with it as it was `given`.
    pub(super) fn find(&self, word: &str, given: &str) -> Result<T, Problem> {
        match self.words.iter().find(|(name, _)| *name == word) {
            Some(&(_, choice)) => Ok(choice),
            None => Err(Problem::Value { given: given.to_owned(), expected: self.to_string() }),
        }
    }

    /// The word for `choice`.
    pub(super) fn word(&self, choice: T) -> &'static str {
        self.words.iter().find(|(_, other)| *other == choice).map_or("", |(word, _)| word)
    }
}

impl<T> Choices<T> {
    fn quoted(&self) -> Vec<String> {
        self.words.iter().map(|(word, _)| format!("\"{word}\"")).collect()
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let low = if self.negative { -self.largest } else { self.smallest };
        let zero = if self.zero && !self.negative { "0 or " } else { "" };
        write!(f, "{zero}a number from {low:?} to {:?}", self.largest)
    }
}

impl fmt::Display for WholeRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a whole number from {} to {}", self.low, self.high)
    }
}

impl<T> fmt::Display for Choices<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let quoted = self.quoted();
        let one_of = if quoted.len() > 1 { "one of " } else { "" };
        write!(f, "{one_of}{}", quoted.join(", "))
    }
}
