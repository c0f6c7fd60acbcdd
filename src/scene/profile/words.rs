//! The words for the options, on a command line as in a scene.

use std::str::FromStr;

use super::{LengthUnit, Missing, ThirdColumn, Tilt};
use crate::scene::allowed::{self, Choices};

/// A word that stands for nothing.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected {expected}")]
pub struct UnknownWord {
    expected: String,
}

fn find<T: Copy + PartialEq>(word: &str, choices: &Choices<T>) -> Result<T, UnknownWord> {
    choices.find(word, word).map_err(|_| UnknownWord { expected: choices.to_string() })
}

impl FromStr for LengthUnit {
    type Err = UnknownWord;

    fn from_str(word: &str) -> Result<Self, UnknownWord> {
        find(word, &allowed::LENGTH_UNIT)
    }
}

impl FromStr for Missing {
    type Err = UnknownWord;

    fn from_str(word: &str) -> Result<Self, UnknownWord> {
        find(word, &allowed::MISSING)
    }
}

impl FromStr for Tilt {
    type Err = UnknownWord;

    fn from_str(word: &str) -> Result<Self, UnknownWord> {
        find(word, &allowed::TILT)
    }
}

impl FromStr for ThirdColumn {
    type Err = UnknownWord;

    fn from_str(word: &str) -> Result<Self, UnknownWord> {
        find(word, &allowed::THIRD_COLUMN)
    }
}
